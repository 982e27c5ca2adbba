// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/fusion/sfm_points.h"

namespace rgbd_sfm_fusion {

/// Mean over frames, or keyframes. Earlier ones count for less.
struct LearnedMean {
  double sum = 0.0, count = 0.0;

  bool isKnown() const { return count > 0.0; }
  double mean() const { return sum / count; }
  double with(double current) const { return (sum + current) / (count + 1.0); }
  void remember(double current) {
    sum = Overlap::kMemory * sum + current;
    count = Overlap::kMemory * count + 1.0;
  }
};

}  // namespace rgbd_sfm_fusion
