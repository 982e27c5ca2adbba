// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>

#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "synthetic_views.h"

namespace rgbd_sfm_fusion {

constexpr Stamp kPeriod = 33'000'000;

/// A camera that sways in front of a plane.
class VisualOdometryTest : public testing::Test {
 protected:
  VisualOdometryTest() { options_.tracking.pyramid_levels = 4; }

  /// A sway of 12 cm, with some turning.
  static SE3 T_camera_world(int frame) {
    const double phase = 0.1 * frame;
    return motion(0.12 * std::sin(phase), 0.05 * std::sin(0.7 * phase), 0.06 * std::sin(0.5 * phase),
                  0.01 * phase, -0.02 * std::sin(phase), 0.01 * std::sin(phase));
  }

  RgbdFrame frame(int index) const {
    return scene_.frame((index + 1) * kPeriod, T_camera_world(index), 2.0,
                        static_cast<std::uint64_t>(index) + 1);
  }

  PlaneScene scene_{smallCamera()};
  OdometryOptions options_;
};

inline bool sameBits(const cv::Mat_<float>& a, const cv::Mat_<float>& b) {
  return a.size() == b.size() && std::memcmp(a[0], b[0], a.total() * sizeof(float)) == 0;
}

}  // namespace rgbd_sfm_fusion
