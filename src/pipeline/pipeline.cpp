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
  MappedFrame mapped = map(std::move(frame), run);
  mapped.preparation_ms = preparation_ms;
  return mapped;
}

MappedFrame Pipeline::map(RgbdFrame frame, std::uint32_t run) {
  MappedFrame mapped;
  mapped.run = run;
  if (run != mapped_run_) {
    odometry_.reset();
    map_.reset();
  }
  mapped_run_ = run;

  Stopwatch stopwatch;
  mapped.frame = std::move(frame);
  mapped.tracked = odometry_.track(mapped.frame);
  mapped.tracking_ms = stopwatch.lap();
  if (mapped.tracked.state == TrackingState::kTracking) mapped.keyframe = map_;
  mapped.map = odometry_.map();
  if (mapped.map) map_ = mapped.map;  // else it stays, as the next frame may find its keyframe again
  mapped.mapping_ms = stopwatch.lap();
  const bool is_keyframe = mapped.tracked.keyframe_stamp == mapped.tracked.stamp;
  if (mapped.tracked.state == TrackingState::kTracking && is_keyframe) mapped.keyframe = map_;
  return mapped;
}

PipelineResult Pipeline::fuse(MappedFrame mapped) {
  if (mapped.run != fused_run_) fusion_.reset();
  fused_run_ = mapped.run;
  Stopwatch stopwatch;
  FusedFrame fused = fusion_.fuse(mapped.tracked, mapped.keyframe, mapped.frame);
  return {std::move(mapped), std::move(fused), stopwatch.lap()};
}

}  // namespace rgbd_sfm_fusion
