// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/default_intrinsics.h"

#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kAstraFov = kPi / 3.0;

}  // namespace

PinholeCamera defaultIntrinsics(int width, int height, double horizontal_fov) {
  const bool is_sensible = horizontal_fov > 0.1 && horizontal_fov < kPi - 0.1;
  const double fov = is_sensible ? horizontal_fov : kAstraFov;
  const double focal_length = 0.5 * width / std::tan(0.5 * fov);
  return {width, height, focal_length, focal_length, 0.5 * width - 0.5, 0.375 * width - 0.5};
}

}  // namespace rgbd_sfm_fusion
