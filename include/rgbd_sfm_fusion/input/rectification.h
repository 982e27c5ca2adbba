// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/input/camera_calibration.h"
#include "rgbd_sfm_fusion/input/depth_resampling.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Removes lens distortion from colour images, and from depth images registered to them. The distortion is
/// (δx, δy) of the paper's Eq. 5 and 7. It is removed once per image instead of once per point. Without
/// distortion, and with P = K, images pass through uncopied.
class Rectifier {
 public:
  /// @param depth               calibration of the depth images, which may have another size; none: not known
  /// @param depth_is_rectified  depth images are registered to the rectified colour image, as
  ///                 depth_image_proc does it
  /// @throws std::invalid_argument naming the field of camera_info that cannot be used
  explicit Rectifier(const CameraCalibration& calibration,
                     const std::optional<CameraCalibration>& depth = std::nullopt,
                     bool depth_is_rectified = false);

  /// Camera of the rectified images.
  const PinholeCamera& camera() const { return camera_; }

  /// A rectangle of the rectified image that the raw image shows completely. Pixels outside the rectangle may
  /// repeat the raw image's border. Such pixels do not move with the camera, and tell nothing.
  const cv::Rect& seen() const { return seen_; }

  bool isIdentity() const { return bilinear_coordinates_.empty(); }

  /// Bilinear. Where the raw image shows nothing, its border is repeated.
  /// @param raw  H x W
  /// @throws std::invalid_argument if the size is not the calibration's
  GreyImage rectify(const GreyImage& raw) const;

  /// Rectifies a picture for people in the same way: 8 bit, any number of channels.
  /// @throws std::invalid_argument if the size is not the calibration's
  cv::Mat rectifyPicture(const cv::Mat& raw) const;

  /// Nearest neighbour, since the mean of two surfaces lies on neither. NaN where the raw image shows
  /// nothing.
  /// @param raw  H x W, or empty (no depth image: the result is empty)
  /// @throws std::invalid_argument as DepthResampling, if the size is not the calibration's
  DepthImage rectify(const DepthImage& raw) const;

 private:
  PinholeCamera camera_;
  DepthResampling resampling_;
  bool depth_is_rectified_;
  cv::Rect seen_;
  cv::Mat nearest_;               ///< per rectified pixel, the raw pixel
  cv::Mat bilinear_coordinates_;  ///< per rectified pixel, the place in the raw image, rounded down
  cv::Mat bilinear_weights_;      ///< the fraction that the rounding takes off
};

}  // namespace rgbd_sfm_fusion
