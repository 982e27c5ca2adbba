// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/input/camera_calibration.h"
#include "rgbd_sfm_fusion/input/depth_resampling.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Takes lens distortion out of colour images, and of depth images registered to them: the (δx, δy) of the
/// paper's Eq. 5 and 7, once per image instead of once per point. Without distortion, and with P = K, images
/// pass through uncopied.
class Rectifier {
 public:
  /// @param depth               of the depth images, which may be of another size; none: it is not known
  /// @param depth_is_rectified  depth images are registered to the rectified colour image,
  ///                            as depth_image_proc does it
  /// @throws std::invalid_argument naming the field of camera_info that cannot be used
  explicit Rectifier(const CameraCalibration& calibration,
                     const std::optional<CameraCalibration>& depth = std::nullopt,
                     bool depth_is_rectified = false);

  /// Camera of the images returned.
  const PinholeCamera& camera() const { return camera_; }

  /// A rectangle of the rectified image all of which the raw image shows. What is beyond it stays where it is
  /// while the camera moves, and tells nothing.
  const cv::Rect& seen() const { return seen_; }

  bool isIdentity() const { return bilinear_coordinates_.empty(); }

  /// Bilinear. What the raw image does not show repeats its border.
  /// @param raw  H x W
  /// @throws std::invalid_argument if the size is not that of the calibration
  GreyImage rectify(const GreyImage& raw) const;

  /// The same of a picture for people: 8 bit, of any number of channels. Its border where the raw image shows
  /// nothing, too.
  /// @throws std::invalid_argument if the size is not that of the calibration
  cv::Mat rectifyPicture(const cv::Mat& raw) const;

  /// Nearest neighbour, as a mean of two surfaces lies on neither. NaN where the raw image shows nothing.
  /// @param raw  H x W, or empty (no depth image: the result is empty)
  /// @throws std::invalid_argument if the size is not that of the calibration, as DepthResampling
  DepthImage rectify(const DepthImage& raw) const;

 private:
  PinholeCamera camera_;
  DepthResampling resampling_;
  bool depth_is_rectified_;
  cv::Rect seen_;
  cv::Mat nearest_;               ///< per rectified pixel, the raw pixel
  cv::Mat bilinear_coordinates_;  ///< the same, rounded down …
  cv::Mat bilinear_weights_;      ///< … and the rest
};

}  // namespace rgbd_sfm_fusion
