// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/mapping/epipolar_stereo.h"
#include "rgbd_sfm_fusion/mapping/inverse_depth.h"
#include "rgbd_sfm_fusion/mapping/mapping_options.h"

namespace rgbd_sfm_fusion {

/// A keyframe's stereo estimates: per pixel a Kalman filter of the inverse depth, and counts of its
/// observations.
struct SemiDenseMap {
  InverseDepthImage estimate;
  cv::Mat_<float> by_readout;           ///< [1/s] error of an estimate per error of the readout time
  cv::Mat_<std::uint8_t> observations;  ///< accepted so far
  cv::Mat_<std::uint8_t> rejections;    ///< so far, less one for each later acceptance
  cv::Mat_<float> scatter;  ///< mean square difference of observations from the estimate, over the sum of the
                            ///< two variances; starts at 1

  void create(const cv::Size& size);
  void clear();
  void clearPixel(int pixel);
};

/// Kalman update of each observed pixel (Engel et al. 2013, Eq. 13). An observation that contradicts the
/// estimate, or a search without a match, counts against the pixel. After too many of them, the pixel starts
/// anew.
void update(const std::vector<StereoObservation>& observations, SemiDenseMap& map);

/// The change from one keyframe to the next.
struct KeyframeChange {
  const cv::Mat_<float>&from_image, &to_image;
  cv::Rect seen;  ///< part of `to_image` that the camera has seen
  const InverseDepthWarp& warp;
  Brightness brightness;  ///< of the new keyframe relative to the old one
};

/// Carries a map to a new keyframe (Engel et al. 2013, section 2.3). Each estimate goes to the pixel nearest
/// to its projection, if the brightness there is the same. Where several estimates meet, the nearest surface
/// stays. Rounding leaves gaps: a candidate without an estimate takes the estimate whose projection is
/// nearest to it, within a pixel.
/// @param candidates  of the new keyframe; not at its border
void propagate(const KeyframeChange& change, const SemiDenseMap& from, const StereoCandidates& candidates,
               const MappingOptions& options, SemiDenseMap& to);

}  // namespace rgbd_sfm_fusion
