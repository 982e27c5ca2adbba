// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/pipeline/pipeline.h"

#include <utility>

#include "rgbd_sfm_fusion/tools/stopwatch.h"

namespace rgbd_sfm_fusion {
Pipeline::Pipeline(const CameraCalibration& calibration, const OdometryOptions& odometry,
                   const FusionOptions& fusion, const std::optional<CameraCalibration>& depth,
                   bool depth_is_rectified)
    : rectifier_(calibration, depth, depth_is_rectified),
      odometry_(rectifier_.camera(), odometry),
      fusion_(rectifier_.camera(), fusion),
      saturated_depth_(static_cast<double>(fusion.noise.saturated_depth)) {}

MappedFrame Pipeline::map(const RawImage& colour, const RawImage& depth, std::uint32_t run) {
  Stopwatch stopwatch;
  RgbdFrame frame = prepareFrame(rectifier_, colour, depth, saturated_depth_);
  const double preparation_ms = stopwatch.lap();
  MappedFrame mapped = map(track(std::move(frame), run));
  mapped.preparation_ms = preparation_ms;
  return mapped;
}

MappedFrame Pipeline::track(RgbdFrame frame, std::uint32_t run) {
  if (run != tracked_run_) {
    odometry_.waitForAllMaps();
    odometry_.reset();
  }
  tracked_run_ = run;
  odometry_.waitForMap(frame.stamp);
  Stopwatch stopwatch;
  MappedFrame tracked;
  tracked.run = run;
  tracked.frame = std::move(frame);
  tracked.tracked = odometry_.track(tracked.frame);
  tracked.tracking_ms = stopwatch.lap();
  return tracked;
}

MappedFrame Pipeline::map(MappedFrame frame) {
  if (frame.run != mapped_run_) maps_.clear();
  mapped_run_ = frame.run;
  if (frame.tracked.state != TrackingState::kTracking) return frame;
  Stopwatch stopwatch;
  frame.map = odometry_.map();
  frame.mapping_ms = stopwatch.lap();
  if (frame.map) maps_.push_back(frame.map);
  const auto is_named = [&](const std::shared_ptr<const KeyframeMap>& map) {
    return map->stamp == frame.tracked.keyframe_stamp && map->revision == frame.tracked.keyframe_revision;
  };
  // Later frames name this map or a later one.
  while (!maps_.empty() && !is_named(maps_.front())) maps_.pop_front();
  if (!maps_.empty()) frame.keyframe = maps_.front();
  return frame;
}

PipelineResult Pipeline::fuse(MappedFrame mapped) {
  if (mapped.run != fused_run_) fusion_.reset();
  fused_run_ = mapped.run;
  Stopwatch stopwatch;
  FusedFrame fused = fusion_.fuse(mapped.tracked, mapped.keyframe, mapped.frame);
  return {std::move(mapped), std::move(fused), stopwatch.lap()};
}

}  // namespace rgbd_sfm_fusion
