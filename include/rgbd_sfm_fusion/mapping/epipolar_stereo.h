// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/mapping/epipolar_segments.h"

namespace rgbd_sfm_fusion {

/// What a search found.
struct StereoObservation {
  int pixel = 0;         ///< v * width + u, in the keyframe
  bool matched = false;  ///< false: searched, but no clear match; the rest is then meaningless
  float inverse_depth = 0.0F;
  float variance = 0.0F;    ///< of the inverse depth
  float by_readout = 0.0F;  ///< [1/s] its error, by that of the readout time
};

/// Epipolar search with sub-pixel refinement and the error model of Engel, Sturm, Cremers (ICCV 2013),
/// sections 2.1–2.2: five samples along the epipolar line are compared; the variance of the disparity is a
/// geometric part (line position over the cosine between gradient and line) plus a photometric one (image
/// noise over gradient along the line). Beyond the article, how much brighter all of a patch has become is an
/// unknown, too.
class EpipolarStereo {
 public:
  explicit EpipolarStereo(const PinholeCamera& camera) : camera_(camera) {}

  /// Searches the view for those candidates where that can improve the estimate.
  /// @param keyframe  H x W brightness
  /// The rest is as in EpipolarSegments::plan().
  const std::vector<StereoObservation>& observe(const cv::Mat_<float>& keyframe,
                                                const StereoCandidates& candidates, const StereoView& view,
                                                const KnownDepths& known, const MappingOptions& options);

 private:
  void match(const cv::Mat_<float>& keyframe, const StereoView& view, const MappingOptions& options);

  PinholeCamera camera_;
  EpipolarSegments segments_;
  std::vector<StereoObservation> observations_;
};

}  // namespace rgbd_sfm_fusion
