// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "run_summary.h"

#include "rgbd_sfm_fusion/preview/preview_text.h"

namespace rgbd_sfm_fusion {

void RunSummary::add(const FusedFrame& fused, TrackingState state) {
  ++frames_;
  tracked_ += state == TrackingState::kTracking ? 1 : 0;
  counts_ += fused.counts;
  scale_ = fused.scale;
}

std::string RunSummary::take(double seconds) {
  const RunSummary summary = *this;
  *this = RunSummary();
  if (summary.frames_ == 0 || seconds <= 0.0) return "";
  const auto frames = static_cast<double>(summary.frames_);
  const auto tenths = static_cast<long>(10.0 * frames / seconds + 0.5);
  return std::to_string(summary.frames_) + " frames fused, " + std::to_string(tenths / 10) + "." +
         std::to_string(tenths % 10) + " per second, " +
         percentText(static_cast<double>(summary.tracked_) / frames) + " of them tracked; of the depth " +
         percentText(summary.counts_.sensorOnlyShare()) + " is the sensor's alone, " +
         percentText(summary.counts_.sfmOnlyShare()) + " from motion alone, " +
         percentText(summary.counts_.fusedShare()) + " from both; " + scaleText(summary.scale_);
}

}  // namespace rgbd_sfm_fusion
