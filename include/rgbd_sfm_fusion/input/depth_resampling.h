// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/input/camera_calibration.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Brings registered depth of another size to the colour image's pixels. The two camera_infos must
/// say that both see along the same rays: the depth image is the colour camera's image, scaled or cut.
class DepthResampling {
 public:
  /// @param colour  valid
  /// @param depth   calibration of the published depth images; none: it is not known
  DepthResampling(const CameraCalibration& colour, const std::optional<CameraCalibration>& depth);

  /// Nearest neighbour; NaN where the depth image shows nothing. Depth of colour's size is returned uncopied,
  /// whatever its camera_info says: some drivers send the infrared camera's calibration with registered
  /// depth.
  /// @param depth  H x W, of any size
  /// @throws std::invalid_argument with both cameras' numbers, if depth has another size and its rays are not
  ///         known to be the colour camera's
  DepthImage operator()(const DepthImage& depth) const;

 private:
  cv::Size colour_size_, depth_size_;
  std::string refusal_;       ///< why depth of another size is not taken; empty: it is taken
  std::vector<int> columns_;  ///< for each column of colour, the column of depth; -1: none
  std::vector<int> rows_;
};

}  // namespace rgbd_sfm_fusion
