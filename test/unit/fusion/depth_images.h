// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion::test {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

inline PinholeCamera smallCamera() {
  return {160, 120, 131.0, 129.0, 80.3, 58.7};
}

/// Depth of the plane n · p = distance (optical frame) at every pixel.
inline DepthImage plane(const PinholeCamera& camera, const Eigen::Vector3d& n, double distance) {
  DepthImage depth(camera.height, camera.width);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x)
      depth(y, x) = static_cast<float>(distance / n.dot(camera.backProject(x, y, 1.0)));
  }
  return depth;
}

inline DepthImage constant(const cv::Size& size, float value) {
  return DepthImage(size, value);
}

/// Adds a variance, with the same relative standard deviation everywhere.
inline GaussianDepth withRelativeSigma(const DepthImage& mean, float sigma) {
  GaussianDepth depth{mean, cv::Mat_<float>(mean.size())};
  for (int y = 0; y < mean.rows; ++y) {
    for (int x = 0; x < mean.cols; ++x) depth.variance(y, x) = std::pow(sigma * mean(y, x), 2.0f);
  }
  return depth;
}

inline bool sameBits(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  for (int y = 0; y < a.rows; ++y) {
    if (std::memcmp(a.ptr(y), b.ptr(y), static_cast<std::size_t>(a.cols) * a.elemSize()) != 0) return false;
  }
  return true;
}

/// The invariant of GaussianDepth: a pixel has a variance if and only if it has a mean.
inline bool isConsistent(const GaussianDepth& depth) {
  for (int y = 0; y < depth.mean.rows; ++y) {
    for (int x = 0; x < depth.mean.cols; ++x) {
      const float z = depth.mean(y, x), v = depth.variance(y, x);
      const bool there = std::isfinite(z) && z > 0.0f && std::isfinite(v) && v > 0.0f;
      if (!there && !(std::isnan(z) && std::isnan(v))) return false;
    }
  }
  return true;
}

}  // namespace rgbd_sfm_fusion::test
