// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/mapping/epipolar_segments.h"
#include "rgbd_sfm_fusion/mapping/segments_by_length.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {

/// The result of one search.
struct StereoObservation {
  int pixel = 0;         ///< v * width + u, in the keyframe
  bool matched = false;  ///< false: the search found no clear match, and the rest is meaningless
  float inverse_depth = 0.0F;
  float variance = 0.0F;    ///< of the inverse depth
  float by_readout = 0.0F;  ///< [1/s] error of the inverse depth per error of the readout time
  float by_pose = 0.0F;     ///< sigma of the inverse depth by the error of the view's pose alone
};

/// Along several epipolar lines side by side: their samples, and the error of a match at each step.
struct SearchedLines {
  struct Step {
    float of[kLanes];
  };
  std::vector<Step> samples, errors;
};

/// Epipolar search with sub-pixel refinement and the error model of Engel, Sturm, Cremers (ICCV 2013),
/// sections 2.1–2.2. A search compares five samples along the epipolar line. The variance of the disparity
/// has a geometric part (line position over the cosine between gradient and line) and a photometric part
/// (image noise over gradient along the line). Beyond the article, a change of brightness that a whole patch
/// shares is an unknown, too.
class EpipolarStereo {
 public:
  explicit EpipolarStereo(const PinholeCamera& camera) : camera_(camera) {}
  void setCamera(const PinholeCamera& camera) { camera_ = camera; }

  /// Searches the view for the candidates whose estimates a search can improve.
  /// @param keyframe  H x W brightness
  /// The other parameters are told with their types.
  const std::vector<StereoObservation>& observe(const GreyImage& keyframe, const CandidatesByBand& candidates,
                                                const StereoView& view, const KnownDepths& known,
                                                const MappingOptions& options);

 private:
  void match(const GreyImage& keyframe, const StereoView& view, const MappingOptions& options,
             const SearchBlock& block);

  PinholeCamera camera_;
  std::vector<StereoCandidates::Block> promising_;  // of a band
  SegmentsByLength segments_;
  SearchedLines lines_;  // work space
  std::vector<StereoObservation> observations_;
};

}  // namespace rgbd_sfm_fusion
