// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/image/inverse_depth.h"
#include "rgbd_sfm_fusion/mapping/epipolar_stereo.h"
#include "rgbd_sfm_fusion/mapping/mapping_options.h"

namespace rgbd_sfm_fusion {

/// A keyframe's stereo estimates: per pixel a Kalman filter of the inverse depth, and counts of its
/// observations.
struct SemiDenseMap {
  InverseDepthImage estimate;
  cv::Mat_<float> by_readout;  ///< [1/s] error of an estimate per error of the readout time;
                               ///< meaningless without one
  cv::Mat_<float> by_pose;     ///< sigma of an estimate by the errors of its views' poses. These have much in
                               ///< common, so they are averaged as if they were one; meaningless without one
  cv::Mat_<std::uint8_t> observations;  ///< accepted so far
  cv::Mat_<std::uint8_t> rejections;    ///< so far, less one for each later acceptance; without an estimate:
                                        ///< searches in vain
  cv::Mat_<float> scatter;  ///< mean square difference of observations from the estimate, over the sum of the
                            ///< two variances; starts at 1; meaningless without an estimate

  /// Makes a map without estimates.
  void create(const cv::Size& size);
  /// Forgets all estimates.
  void clear();
  void clearPixel(int pixel);
};

/// Kalman update of each observed pixel: estimate and observation are multiplied (Engel et al. 2013). An
/// observation that contradicts the estimate, or a search without a match, counts against the pixel. With
/// more of them than observations that agree, the pixel starts anew.
void update(const std::vector<StereoObservation>& observations, SemiDenseMap& map);

}  // namespace rgbd_sfm_fusion
