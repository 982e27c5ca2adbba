// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/keyframe_mapper.h"

#include <algorithm>
#include <utility>

#include "rgbd_sfm_fusion/sensor/skew_compensation.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kMostParts = 3.0;  // each band is renewed in every third frame at least

double meanInverseDepth(const InverseDepthImage& depth) {
  const int count = cv::countNonZero(depth.mean);
  return count > 0 ? cv::sum(depth.mean)[0] / count : 1.0;
}

ImagePose imagePose(const FrameToMap& frame, const Brightness& brightness) {
  return {frame.pose.T_first_camera, frame.step.during(1.0), brightness};
}

}  // namespace

KeyframeMapper::KeyframeMapper(const PinholeCamera& camera)
    : size_(camera.width, camera.height), semi_dense_(camera), tracking_depth_(camera) {}

std::shared_ptr<const KeyframeToTrack> KeyframeMapper::begin(const FrameToMap& frame) {
  if (frame.use == FrameToMap::Use::kRefines) {
    if (keyframe_.knows_step_after) return nullptr;
    const bool has_changed = learnStep(frame);
    tracking_ = has_changed || !has_fused_stereo_ ? forTracking(frame, RowBands::all(), keyframe_)
                                                  : collectTracking(frame, RowBands::all(), keyframe_);
    return tracking_;
  }
  if (!has_fused_stereo_) fuse(RowBands::all(), keyframe_);
  makeKeyframe(frame);
  stereo_depth_.create(size_);
  stereo_depth_.clear();
  tracking_ = forTracking(frame, RowBands::all(), next_);
  return tracking_;
}

KeyframeMapper::Result KeyframeMapper::map(const FrameToMap& frame, bool is_awaited) {
  RowBands renewed = RowBands::all();
  const bool refines = frame.use == FrameToMap::Use::kRefines;
  if (refines) {
    renewed = refine(frame);
  } else {
    makeStereo(frame);
    keyframe_ = std::move(next_);
  }
  semi_dense_.reliable(renewed, frame.options->mapping, stereo_depth_);
  has_fused_stereo_ = false;
  if (refines || is_awaited) tracking_ = forTracking(frame, renewed, keyframe_);
  published_ = published(frame, renewed);
  return {published_, tracking_};
}

void KeyframeMapper::makeKeyframe(const FrameToMap& frame) {
  Keyframe next;
  next.stamp = frame.frame.stamp;
  next.grey = frame.frame.grey;
  next.camera = frame.camera;
  next.pose = frame.pose;
  next.step = frame.step;
  next.views.setKeyframe(frame.pyramid, imagePose(frame, Brightness()));
  next.readout_time =
      frame.use == FrameToMap::Use::kBecomesKeyframe ? keyframe_.readout_time : frame.readout_time;
  if (frame.use == FrameToMap::Use::kStarts) {
    tracking_depth_.clear();
    if (frame.options->init == Initialisation::kRandom)
      tracking_depth_.setRandom(1 << (frame.pyramid.levels() - 1));
  } else {
    next.parallax_before = keyframe_.parallax;
    tracking_depth_.moveTo(warpTo(frame));
  }
  setDepth(frame, next);
  next_ = std::move(next);
  candidates_.setKeyframe(frame.pyramid, cameraPyramid(next_.camera, frame.pyramid.levels()),
                          frame.options->tracking.min_gradient, frame.options->tracking.finest_level);
}

/// Stereo of a new keyframe, by what is known of the one before.
void KeyframeMapper::makeStereo(const FrameToMap& frame) {
  if (frame.use == FrameToMap::Use::kBecomesKeyframe) {
    carryStereo(frame);
  } else {
    semi_dense_.start(frame.pyramid, frame.options->mapping);
  }
  // What was carried is of pixels, which are the same with another camera.
  semi_dense_.setCamera(next_.camera);
}

InverseDepthWarp KeyframeMapper::warpTo(const FrameToMap& frame) const {
  return {keyframe_.camera, frame.T_frame_keyframe, frame.readout(keyframe_.step), frame.readout(frame.step)};
}

void KeyframeMapper::carryStereo(const FrameToMap& frame) {
  const MappingOptions& options = frame.options->mapping;
  const bool has_few_views = keyframe_.revision < kEnoughViews;
  if (has_few_views) observe(frame, RowBands::all());
  semi_dense_.moveTo(frame.pyramid, warpTo(frame), frame.brightness, options);
  if (!has_few_views) return;
  // Stereo for the new parts of the scene, with the views of the keyframe before.
  semi_dense_.observeNew(keyframe_.views.from(imagePose(frame, frame.brightness), frame.readout_time),
                         maxInverseDepth(frame), options);
}

/// Gives a new keyframe sensor depth: at a start with Initialisation::kDepth, later with feedback.
void KeyframeMapper::setDepth(const FrameToMap& frame, Keyframe& next) {
  const bool asks_sensor = frame.use == FrameToMap::Use::kStarts
                               ? frame.options->init == Initialisation::kDepth
                               : frame.options->sensor_feedback;
  if (!asks_sensor || frame.frame.depth.empty()) return;
  next.sensor = frame.frame;
  const bool afresh = frame.use == FrameToMap::Use::kBecomesKeyframeAfresh;
  const bool starts = frame.use == FrameToMap::Use::kStarts;
  if (afresh) tracking_depth_.setAside();
  setSensorDepth(frame, next);
  if (!afresh && !starts) tracking_depth_.keepAside();
  // What stereo contests of the last keyframe's sensor depth it contests here as well, from the first frame
  // on.
  if (!starts) tracking_depth_.contestBySetAside(keyframe_.knownParallax());
}

/// Sets the keyframe's sensor depth, moved to the camera's place when it took the colour image.
void KeyframeMapper::setSensorDepth(const FrameToMap& frame, Keyframe& keyframe) {
  const OdometryOptions& options = *frame.options;
  const RgbdFrame& sensor = keyframe.sensor;
  const SE3 T_colour_depth = SE3::exp(keyframe.step.during(toSeconds(sensor.stamp - sensor.depth_stamp)));
  const cv::Size size = sensor.depth.size();
  const DepthImage depth = options.compensate_skew ? compensateSkew(sensor.depth, keyframe.camera,
                                                                    T_colour_depth, images_.take<float>(size))
                                                   : sensor.depth;
  tracking_depth_.setSensor(
      withNoise(depth, options.noise.withinRange(), {images_.take<float>(size), images_.take<float>(size)}));
  keyframe.cells = DepthCells();  // tracking may still use the old ones
  keyframe.cells.compute(depth, keyframe.camera, options.noise);
}

/// @return the bands of rows whose depth has changed
RowBands KeyframeMapper::refine(const FrameToMap& frame) {
  const RowBands bands = turnOf(frame);
  observe(frame, bands);
  const double far = static_cast<double>(frame.options->keyframe.max_distance) / keyframe_.inverse_depth;
  keyframe_.views.add(frame.pyramid, imagePose(frame, frame.brightness), far);
  keyframe_.parallax =
      std::max(keyframe_.parallax, frame.T_frame_keyframe.translation().norm() * keyframe_.inverse_depth);
  ++keyframe_.revision;
  return bands;
}

RowBands KeyframeMapper::turnOf(const FrameToMap& frame) const {
  const double frames = (keyframe_.revision + 1) / std::max(frame.progress, 1e-3);  // until the next keyframe
  const auto parts = static_cast<std::uint32_t>(std::clamp(frames / kEnoughViews, 1.0, kMostParts));
  return {static_cast<int>(keyframe_.revision % parts), static_cast<int>(parts)};
}

/// The first frame after a keyframe tells how the camera went on from there. If no frame came before the
/// keyframe, nothing else tells the keyframe's motion. A frame that is tracked after a loss tells nothing.
/// @return whether the keyframe's depth has changed, too
bool KeyframeMapper::learnStep(const FrameToMap& frame) {
  const bool is_new = frame.step.isKnown() && !keyframe_.step.isKnown();
  if (is_new) {
    keyframe_.step = frame.step;
    if (!keyframe_.sensor.depth.empty()) setSensorDepth(frame, keyframe_);
  } else if (frame.step.isKnown()) {
    keyframe_.step.twist = 0.5 * (keyframe_.step.twist + frame.step.during(keyframe_.step.interval));
  }
  keyframe_.knows_step_after = true;
  keyframe_.sensor = RgbdFrame();
  keyframe_.views.setKeyframeVelocity(keyframe_.step.during(1.0));
  return is_new;
}

/// Stereo between the keyframe and the frame.
void KeyframeMapper::observe(const FrameToMap& frame, const RowBands& bands) {
  semi_dense_.observe({&frame.pyramid.grey(), frame.pyramid.seen(0), frame.T_frame_keyframe, frame.brightness,
                       frame.readout_time, frame.step.during(1.0), keyframe_.step.during(1.0)},
                      maxInverseDepth(frame), bands, frame.options->mapping);
}

/// Makes what the next frames need of the keyframe.
/// @param bands  whose depth has changed; the others' is taken from the last map
std::shared_ptr<const KeyframeToTrack> KeyframeMapper::forTracking(const FrameToMap& frame,
                                                                   const RowBands& bands,
                                                                   Keyframe& keyframe) {
  fuse(bands, keyframe);
  return collectTracking(frame, bands, keyframe);
}

void KeyframeMapper::fuse(const RowBands& bands, Keyframe& keyframe) {
  const InverseDepthImage& depth = tracking_depth_.fuse(stereo_depth_, keyframe.knownParallax(), bands);
  if (keyframe.revision == 0) keyframe.inverse_depth = meanInverseDepth(depth);
  has_fused_stereo_ = true;
}

/// The same, from the depth as it was fused last.
std::shared_ptr<const KeyframeToTrack> KeyframeMapper::collectTracking(const FrameToMap& frame,
                                                                       const RowBands& bands,
                                                                       const Keyframe& keyframe) {
  const std::shared_ptr<KeyframeToTrack> next = for_tracking_.take();
  next->stamp = keyframe.stamp;
  next->revision = keyframe.revision;
  next->camera = keyframe.camera;
  next->pose = keyframe.pose;
  next->step = keyframe.step;
  next->readout_time = keyframe.readout_time;
  next->rows_readout_time = frame.readout_time;
  next->inverse_depth = keyframe.inverse_depth;
  next->cells = keyframe.cells;
  candidates_.collect(tracking_depth_.fused(), frame.readout(keyframe.step), bands, tracking_->reference,
                      next->reference);
  return next;
}

/// @param bands  as for forTracking()
std::shared_ptr<const KeyframeMap> KeyframeMapper::published(const FrameToMap& frame, const RowBands& bands) {
  const std::shared_ptr<KeyframeMap> map = maps_.take();
  *map = KeyframeMap();  // its last images go back to their pool
  map->stamp = keyframe_.stamp;
  map->revision = keyframe_.revision;
  map->camera = keyframe_.camera;
  map->T_first_keyframe = keyframe_.pose.T_first_camera;
  map->grey = keyframe_.grey;
  map->depth = {images_.take<float>(size_), images_.take<float>(size_)};
  for (int part = 0; part < bands.parts; ++part) {
    if (part == bands.part) continue;
    RowBands{part, bands.parts}.forEach(size_.height, [&](int first, int end) {
      published_->depth.mean.rowRange(first, end).copyTo(map->depth.mean.rowRange(first, end));
      published_->depth.variance.rowRange(first, end).copyTo(map->depth.variance.rowRange(first, end));
    });
  }
  semi_dense_.publish(stereo_depth_, bands, static_cast<float>(frame.readout_sigma), frame.options->mapping,
                      map->depth);
  return map;
}

float KeyframeMapper::maxInverseDepth(const FrameToMap& frame) const {
  return static_cast<float>(keyframe_.inverse_depth) / frame.options->mapping.min_depth;
}

}  // namespace rgbd_sfm_fusion
