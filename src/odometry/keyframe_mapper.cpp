// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/keyframe_mapper.h"

#include <algorithm>
#include <utility>

#include "rgbd_sfm_fusion/sensor/skew_compensation.h"

namespace rgbd_sfm_fusion {
namespace {

// If a keyframe has fewer frames than this, its frames are far apart, and none may be wasted. Then the next
// keyframe is a view of this one, and this one's views are views of the next one.
constexpr std::uint32_t kFewViews = 8;
constexpr double kViewSpacing = 0.25;  // of the distance that makes a new keyframe

double meanInverseDepth(const InverseDepthImage& depth) {
  const int count = cv::countNonZero(depth.mean);
  return count > 0 ? cv::sum(depth.mean)[0] / count : 1.0;
}

ImagePose imagePose(const FrameToMap& frame, const Brightness& brightness) {
  return {frame.pose.T_odom_camera, frame.step.during(1.0), brightness};
}

}  // namespace

KeyframeMapper::KeyframeMapper(const PinholeCamera& camera)
    : camera_(camera), mapper_(camera), tracking_depth_(camera) {}

KeyframeMapper::Result KeyframeMapper::map(const FrameToMap& frame) {
  if (frame.use == FrameToMap::Use::kRefines) {
    refine(frame);
  } else {
    makeKeyframe(frame);
  }
  updateReference(frame);
  return {published(frame), forTracking()};
}

void KeyframeMapper::makeKeyframe(const FrameToMap& frame) {
  Keyframe next;
  next.stamp = frame.frame.stamp;
  next.grey = frame.frame.grey.clone();
  next.pose = frame.pose;
  next.step = frame.step;
  next.views.setKeyframe(frame.pyramid, imagePose(frame, Brightness()));
  const InverseDepthWarp warp(camera_, frame.T_frame_keyframe, frame.readout(keyframe_.step),
                              frame.readout(frame.step));
  if (frame.use == FrameToMap::Use::kBecomesKeyframe) {
    next.readout_time = keyframe_.readout_time;
    carryStereo(frame, warp);
  } else {
    next.readout_time = frame.readout_time;
    mapper_.start(frame.pyramid, frame.options->mapping);
  }
  if (frame.use == FrameToMap::Use::kStarts) {
    tracking_depth_.clear();
    if (frame.options->init == Initialisation::kRandom) tracking_depth_.setRandom();
  } else {
    next.parallax_before = keyframe_.parallax;
    tracking_depth_.moveTo(warp);
  }
  setDepth(frame, next);
  keyframe_ = std::move(next);
  reference_.setKeyframe(frame.pyramid, cameraPyramid(camera_, frame.pyramid.levels()));
}

void KeyframeMapper::carryStereo(const FrameToMap& frame, const InverseDepthWarp& warp) {
  const MappingOptions& options = frame.options->mapping;
  const bool has_few_views = keyframe_.revision < kFewViews;
  if (has_few_views) observe(frame);
  mapper_.moveTo(frame.pyramid, warp, frame.brightness, options);
  if (!has_few_views) return;
  // Stereo for the new parts of the scene, with the views of the keyframe before.
  for (const StereoView& view : keyframe_.views.from(imagePose(frame, frame.brightness), frame.readout_time))
    mapper_.observeNew(view, maxInverseDepth(frame), options);
}

/// Gives a new keyframe sensor depth: at a start with Initialisation::kDepth, later with feedback.
void KeyframeMapper::setDepth(const FrameToMap& frame, Keyframe& keyframe) {
  const bool asks_sensor = frame.use == FrameToMap::Use::kStarts
                               ? frame.options->init == Initialisation::kDepth
                               : frame.options->sensor_feedback;
  if (!asks_sensor || frame.frame.depth.empty()) return;
  keyframe.sensor = frame.frame;
  const bool afresh = frame.use == FrameToMap::Use::kBecomesKeyframeAfresh;
  if (afresh) tracking_depth_.setAside();
  setSensorDepth(frame, keyframe);
  if (afresh) tracking_depth_.contestBySetAside(keyframe_.knownParallax());
}

/// Sets the keyframe's sensor depth, moved to the camera's place when it took the colour image.
void KeyframeMapper::setSensorDepth(const FrameToMap& frame, Keyframe& keyframe) {
  const OdometryOptions& options = *frame.options;
  const RgbdFrame& sensor = keyframe.sensor;
  const SE3 T_colour_depth = SE3::exp(keyframe.step.during(toSeconds(sensor.stamp - sensor.depth_stamp)));
  const DepthImage depth =
      options.compensate_skew ? compensateSkew(sensor.depth, camera_, T_colour_depth) : sensor.depth;
  tracking_depth_.setSensor(withNoise(depth, options.noise.withinRange()));
  keyframe.cells = DepthCells();  // tracking may still use the old ones
  keyframe.cells.compute(depth, camera_, options.noise);
}

void KeyframeMapper::refine(const FrameToMap& frame) {
  if (keyframe_.revision == 0) learnStep(frame);
  observe(frame);
  const double far = static_cast<double>(frame.options->keyframe.max_distance) / keyframe_.inverse_depth;
  keyframe_.views.add(frame.pyramid, imagePose(frame, frame.brightness), kViewSpacing * far);
  keyframe_.parallax =
      std::max(keyframe_.parallax, frame.T_frame_keyframe.translation().norm() * keyframe_.inverse_depth);
  ++keyframe_.revision;
}

/// The first frame after a keyframe tells how the camera went on from there. If no frame came before the
/// keyframe, nothing else tells the keyframe's motion.
void KeyframeMapper::learnStep(const FrameToMap& frame) {
  if (keyframe_.step.isKnown() && frame.step.isKnown()) {
    keyframe_.step.twist = 0.5 * (keyframe_.step.twist + frame.step.during(keyframe_.step.interval));
  } else {
    keyframe_.step = frame.step;
    if (!keyframe_.sensor.depth.empty()) setSensorDepth(frame, keyframe_);
  }
  keyframe_.sensor = RgbdFrame();
  keyframe_.views.setKeyframeVelocity(keyframe_.step.during(1.0));
}

/// Stereo between the keyframe and the frame.
void KeyframeMapper::observe(const FrameToMap& frame) {
  mapper_.observe({&frame.pyramid[0], frame.pyramid.seen(0), frame.T_frame_keyframe, frame.brightness,
                   frame.readout_time, frame.step.during(1.0), keyframe_.step.during(1.0)},
                  maxInverseDepth(frame), frame.options->mapping);
}

void KeyframeMapper::updateReference(const FrameToMap& frame) {
  mapper_.reliable(frame.options->mapping, stereo_);
  const InverseDepthImage& depth = tracking_depth_.fuse(stereo_, keyframe_.knownParallax());
  if (keyframe_.revision == 0) keyframe_.inverse_depth = meanInverseDepth(depth);
  reference_.setDepth(depth, frame.readout(keyframe_.step), frame.options->tracking.min_gradient,
                      frame.options->tracking.finest_level);
}

std::shared_ptr<const KeyframeMap> KeyframeMapper::published(const FrameToMap& frame) {
  const MappingOptions& options = frame.options->mapping;
  auto map = std::make_shared<KeyframeMap>();
  map->stamp = keyframe_.stamp;
  map->revision = keyframe_.revision;
  map->camera = camera_;
  map->T_first_keyframe = keyframe_.pose.T_odom_camera;
  map->grey = keyframe_.grey;
  map->depth = toDepth(mapper_.published(stereo_, options), images_);
  if (options.follow_scatter) mapper_.followScatter(map->depth.variance);
  if (frame.options->estimate_readout) mapper_.addReadoutVariance(frame.readout_sigma, map->depth);
  return map;
}

std::shared_ptr<const TrackedKeyframe> KeyframeMapper::forTracking() const {
  auto keyframe = std::make_shared<TrackedKeyframe>();
  keyframe->stamp = keyframe_.stamp;
  keyframe->revision = keyframe_.revision;
  keyframe->pose = keyframe_.pose;
  keyframe->step = keyframe_.step;
  keyframe->readout_time = keyframe_.readout_time;
  keyframe->inverse_depth = keyframe_.inverse_depth;
  keyframe->cells = keyframe_.cells;
  keyframe->reference = reference_.pointsOnly();
  return keyframe;
}

float KeyframeMapper::maxInverseDepth(const FrameToMap& frame) const {
  return static_cast<float>(keyframe_.inverse_depth) / frame.options->mapping.min_depth;
}

}  // namespace rgbd_sfm_fusion
