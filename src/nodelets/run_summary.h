// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

namespace rgbd_sfm_fusion {

/// Half a minute of fusion in a line of the log.
class RunSummary {
 public:
  void add(const FusedFrame& fused, TrackingState state);

  /// Sums up the frames since the last call, and starts anew.
  /// @param seconds  since then
  /// @return empty where there were none
  std::string take(double seconds);

 private:
  std::size_t frames_ = 0, tracked_ = 0;
  ProvenanceCounts counts_;
  ScaleEstimate scale_;
};

}  // namespace rgbd_sfm_fusion
