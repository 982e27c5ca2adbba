// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/keyframe_mapper.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rgbd_sfm_fusion/sensor/skew_compensation.h"
#include "rgbd_sfm_fusion/sensor/stray_depth.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kMostParts = 3.0;  // a frame renews a third of the bands at least

ImagePose imagePose(const FrameToMap& frame, const Brightness& brightness) {
  return {frame.pose.T_first_camera, frame.step.velocity(), brightness, frame.covariance};
}

}  // namespace

KeyframeMapper::KeyframeMapper(const PinholeCamera& camera)
    : size_(camera.width, camera.height), semi_dense_(camera), tracking_depth_(camera) {}

std::shared_ptr<const KeyframeToTrack> KeyframeMapper::mapWithoutStereo(const FrameToMap& frame) {
  tracking_depth_.leaveOut(frame.fixed);
  if (frame.use == FrameToMap::Use::kRefines) {
    if (keyframe_.knows_step_after) return nullptr;
    const bool has_changed = learnStep(frame);
    if (has_changed || carried_stereo_waits_) fuse(RowBands::all(), keyframe_);
    last_to_track_ = toTrack(frame, RowBands::all(), keyframe_);
    return last_to_track_;
  }
  if (carried_stereo_waits_) fuse(RowBands::all(), keyframe_);
  makeKeyframe(frame);
  stereo_depth_.create(size_);
  stereo_depth_.clear();  // none of the new keyframe's until mapByStereo()
  fuse(RowBands::all(), next_);
  last_to_track_ = toTrack(frame, RowBands::all(), next_);
  return last_to_track_;
}

KeyframeMapper::Result KeyframeMapper::mapByStereo(const FrameToMap& frame, bool is_awaited) {
  semi_dense_.leaveOut(frame.fixed);
  RowBands renewed = RowBands::all();
  const bool refines = frame.use == FrameToMap::Use::kRefines;
  if (refines) {
    renewed = refine(frame);
  } else {
    makeStereo(frame);
    keyframe_ = std::move(next_);
  }
  semi_dense_.reliable(renewed, frame.options->mapping, stereo_depth_);
  carried_stereo_waits_ = !refines && !is_awaited;
  if (!carried_stereo_waits_) {
    fuse(renewed, keyframe_);
    last_to_track_ = toTrack(frame, renewed, keyframe_);
  }
  last_map_ = toPublish(frame, renewed);
  return {last_map_, last_to_track_};
}

void KeyframeMapper::makeKeyframe(const FrameToMap& frame) {
  Keyframe next;
  next.stamp = frame.rgbd.stamp;
  next.grey = frame.rgbd.grey;
  next.coarse = frame.pyramid[frame.options->tracking.middleLevel()].clone();
  next.camera = frame.camera;
  next.depth_delay = frame.depth_delay;
  next.pose = frame.pose;
  next.step = frame.step;
  next.views.setKeyframe(frame.pyramid,
                         {frame.pose.T_first_camera, frame.step.velocity(), Brightness(), Matrix6::Zero()});
  if (frame.use == FrameToMap::Use::kStarts) {
    tracking_depth_.clear();
    if (frame.options->init == Initialisation::kRandom)
      tracking_depth_.setRandom(1 << (frame.pyramid.levels() - 1));
  } else {
    tracking_depth_.moveTo(warpTo(frame));
  }
  useSensorDepth(frame, next);
  next_ = std::move(next);
  candidates_.setKeyframe(frame.pyramid, cameraPyramid(next_.camera, frame.pyramid.levels()),
                          {frame.options->tracking.min_gradient, frame.pixel_noise},
                          frame.options->tracking.finest_level);
}

/// Stereo of the next keyframe; keyframe_ is still the one before.
void KeyframeMapper::makeStereo(const FrameToMap& frame) {
  if (frame.use == FrameToMap::Use::kBecomesKeyframe) {
    carryStereo(frame);
  } else {
    semi_dense_.start(frame.pyramid, frame.options->mapping);
  }
  // Estimates are of pixels, which are the same with another camera.
  semi_dense_.setCamera(next_.camera);
}

InverseDepthWarp KeyframeMapper::warpTo(const FrameToMap& frame) const {
  return {keyframe_.camera, frame.T_frame_keyframe, frame.motionDuringReadout(keyframe_.step),
          frame.motionDuringReadout(frame.step)};
}

void KeyframeMapper::carryStereo(const FrameToMap& frame) {
  const MappingOptions& options = frame.options->mapping;
  const bool has_few_views = keyframe_.revision < kEnoughViews;
  if (has_few_views) observe(frame, RowBands::all());
  next_.parallax_before = keyframe_.parallax;
  semi_dense_.moveTo(frame.pyramid, warpTo(frame), frame.brightness, options);
  if (!has_few_views) return;
  // Stereo for the new parts of the scene, with the views of the keyframe before.
  semi_dense_.observeNew(keyframe_.views.from(imagePose(frame, frame.brightness), frame.readout_time),
                         maxInverseDepth(frame), options);
}

/// Gives a new keyframe sensor depth: at a start with Initialisation::kDepth, later with feedback.
void KeyframeMapper::useSensorDepth(const FrameToMap& frame, Keyframe& next) {
  const bool starts = frame.use == FrameToMap::Use::kStarts;
  const bool asks_sensor =
      starts ? frame.options->init == Initialisation::kDepth : frame.options->feedsBack();
  if (!asks_sensor || frame.rgbd.depth.empty()) return;
  next.sensor_frame = frame.rgbd;
  const bool afresh = frame.use == FrameToMap::Use::kBecomesKeyframeAfresh;
  next.carried = afresh ? TrackingDepth::Carried::kIsDropped : TrackingDepth::Carried::kFillsGaps;
  setSensorDepth(frame, keyframe_.knownParallax(), next);
}

/// Sets the keyframe's sensor depth, moved to the camera's place when it took the colour image. What stereo
/// contests of the sensor depth of the keyframe before it contests here as well, from the first frame on.
/// @param parallax  of the depth that was carried over, or of the keyframe's own, as ContestedCells takes it
void KeyframeMapper::setSensorDepth(const FrameToMap& frame, double parallax, Keyframe& keyframe) {
  const OdometryOptions& options = *frame.options;
  const RgbdFrame& sensor = keyframe.sensor_frame;
  const double age = toSeconds(sensor.stamp - sensor.depth_stamp) + keyframe.depth_delay;
  const SE3 T_colour_depth = SE3::exp(keyframe.step.during(age));
  const cv::Size size = sensor.depth.size();
  const DepthImage measured =
      options.compensate_skew
          ? compensateSkew(sensor.depth, keyframe.camera, T_colour_depth, images_.take<float>(size))
          : sensor.depth;
  const SortedDepth depth =
      sortStrays(measured, options.noise, {images_.take<float>(size), images_.take<float>(size)});
  const GaussianDepth with_noise =
      withNoise(depth, options.noise.withinRange(), {images_.take<float>(size), images_.take<float>(size)});
  tracking_depth_.setSensor(with_noise, keyframe.carried);
  tracking_depth_.contestByCarried(parallax);
  keyframe.cells = DepthCells();  // tracking may still use the old ones
  keyframe.cells.compute(depth.confirmed, keyframe.camera, options.noise);
  keyframe.cells.leaveOut(frame.fixed);
}

/// @return the bands of rows whose averages were renewed
RowBands KeyframeMapper::refine(const FrameToMap& frame) {
  const RowBands bands = bandsToRefine(frame);
  observe(frame, bands);
  const double reach =
      static_cast<double>(frame.options->keyframe.max_distance) / keyframe_.mean_inverse_depth;
  keyframe_.views.add(frame.pyramid, imagePose(frame, frame.brightness), reach);
  ++keyframe_.revision;
  return bands;
}

RowBands KeyframeMapper::bandsToRefine(const FrameToMap& frame) const {
  // The keyframe will have so many frames in all.
  const double frames = (keyframe_.revision + 1) / std::max(frame.progress, 1e-3);
  const auto parts =
      static_cast<std::uint32_t>(std::lround(std::clamp(frames / kEnoughViews, 1.0, kMostParts)));
  return {static_cast<int>(keyframe_.revision % parts), static_cast<int>(parts)};
}

/// The first frame after a keyframe tells how the camera went on from there. If no frame came before the
/// keyframe, nothing else tells the keyframe's motion. A frame that is tracked after a loss tells nothing.
/// @return whether the keyframe's sensor depth, if it has any, was set anew
bool KeyframeMapper::learnStep(const FrameToMap& frame) {
  const bool is_new = frame.step.isKnown() && !keyframe_.step.isKnown();
  if (is_new) {
    keyframe_.step = frame.step;
    if (!keyframe_.sensor_frame.depth.empty()) setSensorDepth(frame, keyframe_.knownParallax(), keyframe_);
  } else if (frame.step.isKnown()) {
    keyframe_.step.twist = 0.5 * (keyframe_.step.twist + frame.step.during(keyframe_.step.interval));
  }
  keyframe_.knows_step_after = true;
  keyframe_.sensor_frame = RgbdFrame();
  keyframe_.views.setKeyframeVelocity(keyframe_.step.velocity());
  return is_new;
}

/// Stereo between the keyframe and the frame.
void KeyframeMapper::observe(const FrameToMap& frame, const RowBands& bands) {
  keyframe_.parallax = std::max(keyframe_.parallax,
                                frame.T_frame_keyframe.translation().norm() * keyframe_.mean_inverse_depth);
  semi_dense_.observe(
      {&frame.pyramid.grey(), frame.pyramid.seen(0), frame.T_frame_keyframe, frame.brightness,
       frame.readout_time, frame.step.velocity(), keyframe_.step.velocity(), frame.covariance},
      maxInverseDepth(frame), bands, frame.options->mapping);
}

/// Fuses stereo into the depth for tracking. After that, none waits.
/// @param bands  in which either has changed
void KeyframeMapper::fuse(const RowBands& bands, Keyframe& keyframe) {
  // An error of a pose moves all points, in one of as many ways as a pose has parameters.
  const auto sharing_points = static_cast<float>(candidates_.count() / Matrix6::RowsAtCompileTime);
  const InverseDepthImage& depth = tracking_depth_.fuse(
      {stereo_depth_, semi_dense_.map().by_pose, sharing_points}, keyframe.knownParallax(), bands);
  if (keyframe.revision == 0) {
    const double mean = depth.meanInverseDepth();
    keyframe.mean_inverse_depth = mean > 0.0 ? mean : 1.0;
  }
  carried_stereo_waits_ = false;
}

/// Makes what the next frames need of the keyframe, from the depth as it was fused last.
/// @param bands  whose depth has changed; the others are taken from the last one
std::shared_ptr<const KeyframeToTrack> KeyframeMapper::toTrack(const FrameToMap& frame, const RowBands& bands,
                                                               const Keyframe& keyframe) {
  const std::shared_ptr<KeyframeToTrack> next = to_track_pool_.take();
  next->stamp = keyframe.stamp;
  next->revision = keyframe.revision;
  next->camera = keyframe.camera;
  next->depth_delay = keyframe.depth_delay;
  next->coarse = keyframe.coarse;
  next->pose = keyframe.pose;
  next->step = keyframe.step;
  next->reference_readout_time = frame.readout_time;
  next->mean_inverse_depth = keyframe.mean_inverse_depth;
  next->cells = keyframe.cells;
  next->reference.independent_share = tracking_depth_.independentShare();
  candidates_.collect(tracking_depth_.expectRest(bands), frame.motionDuringReadout(keyframe.step), bands,
                      last_to_track_->reference, next->reference);
  return next;
}

/// @param bands  as for toTrack()
std::shared_ptr<const KeyframeMap> KeyframeMapper::toPublish(const FrameToMap& frame, const RowBands& bands) {
  const std::shared_ptr<KeyframeMap> map = map_pool_.take();
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
      last_map_->depth.mean.rowRange(first, end).copyTo(map->depth.mean.rowRange(first, end));
      last_map_->depth.variance.rowRange(first, end).copyTo(map->depth.variance.rowRange(first, end));
    });
  }
  semi_dense_.toDepth(stereo_depth_, bands, static_cast<float>(frame.readout_sigma), frame.options->mapping,
                      map->depth);
  return map;
}

float KeyframeMapper::maxInverseDepth(const FrameToMap& frame) const {
  return static_cast<float>(keyframe_.mean_inverse_depth) / frame.options->mapping.min_depth;
}

}  // namespace rgbd_sfm_fusion
