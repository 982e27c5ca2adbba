// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/rolling_shutter.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Views of a slanted plane with a smooth, nowhere repeating texture, whose brightness and depth are known
/// at every point: z = 2 + 0.3 x - 0.2 y in the world, which is the first camera.
class PlaneScene {
 public:
  explicit PlaneScene(const PinholeCamera& camera) : camera_(camera) {}

  const PinholeCamera& camera() const { return camera_; }

  /// Depth along the ray of pixel (u, v) of a camera at T_camera_world.
  double depth(const SE3& T_camera_world, double u, double v) const {
    return depthFrom(T_camera_world.inverse(), u, v);
  }

  double brightness(const SE3& T_camera_world, double u, double v) const {
    return brightnessFrom(T_camera_world.inverse(), u, v);
  }

  /// @param T_camera_world  at the middle row
  /// @param readout         motion of the camera from the first row to the last
  cv::Mat_<float> image(const SE3& T_camera_world, const ReadoutMotion& readout = {}) const {
    cv::Mat_<float> image(camera_.height, camera_.width);
    for (int v = 0; v < image.rows; ++v) {
      const SE3 T_world_row = (readout.T_row_image(v, camera_.height) * T_camera_world).inverse();
      for (int u = 0; u < image.cols; ++u)
        image(v, u) = static_cast<float>(brightnessFrom(T_world_row, u, v));
    }
    return image;
  }

  DepthImage depthImage(const SE3& T_camera_world, const ReadoutMotion& readout = {}) const {
    DepthImage image(camera_.height, camera_.width);
    for (int v = 0; v < image.rows; ++v) {
      const SE3 T_world_row = (readout.T_row_image(v, camera_.height) * T_camera_world).inverse();
      for (int u = 0; u < image.cols; ++u) image(v, u) = static_cast<float>(depthFrom(T_world_row, u, v));
    }
    return image;
  }

  /// @param noise  [grey levels] standard deviation, repeatable by `seed`
  RgbdFrame frame(Stamp stamp, const SE3& T_camera_world, double noise = 0.0, std::uint64_t seed = 1,
                  const ReadoutMotion& readout = {}) const {
    cv::Mat_<float> noisy = image(T_camera_world, readout);
    cv::Mat_<float> errors(noisy.size());
    cv::RNG random(seed);
    random.fill(errors, cv::RNG::NORMAL, 0.0, noise);
    noisy += errors;
    RgbdFrame frame;
    frame.stamp = frame.depth_stamp = stamp;
    noisy.convertTo(frame.grey, CV_8U);
    frame.depth = depthImage(T_camera_world, readout);
    return frame;
  }

 private:
  double depthFrom(const SE3& T_world_camera, double u, double v) const {
    const Eigen::Vector3d direction = T_world_camera.rotation() * camera_.backProject(u, v, 1.0);
    const Eigen::Vector3d normal(0.3, -0.2, -1.0);
    return -(normal.dot(T_world_camera.translation()) + 2.0) / normal.dot(direction);
  }

  double brightnessFrom(const SE3& T_world_camera, double u, double v) const {
    const Eigen::Vector3d p = T_world_camera * camera_.backProject(u, v, depthFrom(T_world_camera, u, v));
    return 128.0 + 35.0 * std::sin(9.0 * p.x() + 2.0 * std::sin(5.0 * p.y())) +
           35.0 * std::sin(8.0 * p.y() + 2.5 * std::sin(4.0 * p.x() + 1.0)) +
           20.0 * std::sin(23.0 * p.x() + 17.0 * p.y()) + 15.0 * std::sin(37.0 * p.x() - 31.0 * p.y());
  }

  PinholeCamera camera_;
};

inline PinholeCamera smallCamera() {
  return {320, 240, 260.0, 262.0, 158.7, 121.3};
}

/// A rigid motion from a translation and a rotation vector.
inline SE3 motion(double x, double y, double z, double rx = 0.0, double ry = 0.0, double rz = 0.0) {
  Vector6 rotation;
  rotation << 0.0, 0.0, 0.0, rx, ry, rz;
  return SE3(SE3::exp(rotation).rotation(), {x, y, z});
}

}  // namespace rgbd_sfm_fusion
