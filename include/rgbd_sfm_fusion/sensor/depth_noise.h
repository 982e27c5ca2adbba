// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Noise of a structured-light sensor's depth: Paper, Eq. 8 (noise models), and what the paper leaves out:
/// the rounding of the depth image, the error of depth that a sideways error makes at slopes and steps, and
/// what all depths have wrong in common (method.md 1).
struct DepthNoiseModel {
  float quadratic = 1.425e-3f;  ///< [1/m] sigma_Z = quadratic * Z^2; Khoshelham & Elberink 2012, Eq. 10
  float floor = 1e-3f;          ///< [m]   rounding to millimetres, and what the sensor's own smoothing leaves
  float lateral_sigma = 0.4f;   ///< [px]  error of registration between depth and colour, in x and in y
  float common_scale_sigma = 0.005f;  ///< [1] scale error of all depths at once: no averaging removes it
  /// [1/m] Offset of all disparities at once: all depths share an error of this value times Z². SfM's depths
  /// are aligned with the sensor's, and carry this error beyond the overlap. A disparity is a code, and so is
  /// the disparity at infinity. A code is 1/8 px, or 2.85e-3 / m (Khoshelham & Elberink 2012), and rounding
  /// to it leaves a sigma of 2.85e-3 / sqrt(12).
  float common_offset_sigma = 0.0008f;
  float min_range = 0.4f;  ///< [m]
  float max_range = 5.0f;  ///< [m] the device is specified up to this depth
  /// [1/m] Beyond max_range depth is biased: all such depth shares an error of this value times Z^2. 0: such
  /// depth is not used.
  float far_bias_sigma = 0.005f;
  /// [m] The device's highest code, which means that there is no depth; 0: it has none.
  float saturated_depth = 10.0f;

  static DepthNoiseModel kinect() { return {}; }
  /// The same chip and pattern as Kinect. The Xtion is specified for 0.8 to 3.5 m, but measures beyond.
  static DepthNoiseModel xtion() { return kinect(); }
  /// Range as in Orbbec's data sheet; noise, bias and highest code are Kinect's, and unverified.
  static DepthNoiseModel astra();
  /// @throws std::invalid_argument unless `name` is `kinect`, `xtion` or `astra`
  static DepthNoiseModel preset(const std::string& name);

  /// [m] Standard deviation of depth along the optical axis by the sensor's disparity noise alone.
  float sigmaZ(float depth) const { return quadratic * depth * depth; }
  /// [m] (sigma_X, sigma_Y) of the point seen at pixel (x, y) at `depth`. Paper, Eq. 8.
  Eigen::Vector2f sigmaXY(const PinholeCamera& camera, float x, float y, float depth) const;
  /// [m^2] Variance of the error that all depth beyond max_range shares; 0 within the range.
  float farVariance(float depth) const {
    const float sigma = depth > max_range ? far_bias_sigma * depth * depth : 0.0f;
    return sigma * sigma;
  }
  /// [m^2] Variance of the errors that all depths share: of scale, and of the offset of disparities.
  float commonVariance(float depth) const {
    const float scale = common_scale_sigma * common_scale_sigma,
                offset = common_offset_sigma * common_offset_sigma;
    return (scale + offset * depth * depth) * depth * depth;
  }
  /// [m^2] Disparity noise, floor and far bias, for a surface that faces the camera; NaN where depth is not
  /// used.
  float variance(float depth) const;
  /// The model without depth beyond max_range, for uses that a bias would mislead.
  DepthNoiseModel withinRange() const;
};

/// @throws std::invalid_argument naming the member that is out of range
void validate(const DepthNoiseModel& noise);

/// Sensor depth with its variance (method.md 1); NaN where depth is not used. The variance includes the far
/// bias. The common scale error is left out of the variance: it is no noise of a pixel, and is added after
/// fusion.
/// @param buffer            the buffer's images, if of the right size, are overwritten and returned
/// @param surface_variance  [out] the variance without the part that a step beside the pixel adds: the
///                          variance on the pixel's own surface. May be null
GaussianDepth withNoise(const DepthImage& depth, const DepthNoiseModel& noise, GaussianDepth buffer = {},
                        cv::Mat_<float>* surface_variance = nullptr);

}  // namespace rgbd_sfm_fusion
