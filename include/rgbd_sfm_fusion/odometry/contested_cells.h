// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/image/inverse_depth.h"
#include "rgbd_sfm_fusion/image/row_bands.h"

namespace rgbd_sfm_fusion {

/// Squares of 32 px of a keyframe, less at its borders (DepthCells are smaller), in which its sensor depth
/// and its stereo depth differ as a whole. The mean difference over many pixels is larger than the error of
/// the poses explains; that error grows as the parallax shrinks. In such a square the sensor is wrong (a
/// mirror, a bad calibration), or sees something else than the camera. So it gives no depth to the points
/// there, which would pull the poses, and with them all of the stereo depth (method.md 6, leak test). Poses
/// still use how the sensor's depth changes there from frame to frame (DepthCells).
class ContestedCells {
 public:
  /// Compares two depths in some bands of rows. The other bands' squares keep the differences that were found
  /// before.
  /// @param sensor    inverse depth, in tracker units
  /// @param stereo    inverse depth by stereo, in the same unit and of the same size
  /// @param parallax  largest distance from the keyframe to a frame that has refined it, in depths of the
  ///                  scene
  /// @return the contested squares of these bands; valid until the next call
  const std::vector<cv::Rect>& find(const InverseDepthImage& sensor, const InverseDepthImage& stereo,
                                    double parallax, const RowBands& bands = RowBands::all());

 private:
  static constexpr int kCell = RowBands::kRows;  // [px]

  void compare(const InverseDepthImage& sensor, const InverseDepthImage& stereo, const RowBands& bands);

  cv::Mat_<double> differences_;     // per square, as a share of the inverse depth; negative: not known
  std::vector<double> known_;        // work space
  std::vector<cv::Rect> contested_;  // the last result
};

}  // namespace rgbd_sfm_fusion
