// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/mapping/inverse_depth.h"
#include "rgbd_sfm_fusion/mapping/mapping_options.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// Keyframe pixels with enough gradient for stereo, one array per quantity.
struct StereoCandidates {
  std::vector<float> u, v;                    ///< [px]
  std::vector<float> gradient_x, gradient_y;  ///< [grey levels / px]
  std::vector<int> pixel;                     ///< v * width + u

  int count() const { return static_cast<int>(pixel.size()); }
  void collect(const cv::Mat_<float>& gradient_x, const cv::Mat_<float>& gradient_y, float min_gradient);
};

/// A second image of what the keyframe shows.
struct StereoView {
  const cv::Mat_<float>* image = nullptr;
  SE3 T_view_keyframe;
  Brightness brightness;  ///< of the view, relative to the keyframe
};

/// What a search found.
struct StereoObservation {
  int pixel = 0;         ///< v * width + u, in the keyframe
  bool matched = false;  ///< false: searched, but no clear match; the rest is then meaningless
  float inverse_depth = 0.0F;
  float variance = 0.0F;  ///< of the inverse depth
};

/// Where to search the view, one array per quantity.
struct EpipolarSegments {
  std::vector<float> u, v;                ///< [px] centre of the search in the view
  std::vector<float> du, dv;              ///< unit direction of growing inverse depth
  std::vector<float> eu, ev;              ///< [px] step in the keyframe that moves by one px in the view
  std::vector<float> inverse_depth;       ///< at the centre
  std::vector<float> rate;                ///< [px] by which the projection moves per unit of inverse depth
  std::vector<float> z, z_rate;           ///< depth in the view over that in the keyframe, and its derivative
  std::vector<float> geometric_variance;  ///< [px²]
  std::vector<int> before, after;         ///< [px] to search either side of the centre; after < 0: not at all

  void resize(std::size_t size);
};

/// Epipolar search with sub-pixel refinement and the error model of Engel, Sturm, Cremers (ICCV 2013),
/// sections 2.1–2.2: five samples along the epipolar line are compared; the variance of the disparity is a
/// geometric part (line position over the cosine between gradient and line) plus a photometric one (image
/// noise over gradient along the line).
class EpipolarStereo {
 public:
  explicit EpipolarStereo(const PinholeCamera& camera) : camera_(camera) {}

  /// Searches the view for those candidates where that can improve the estimate.
  /// @param keyframe  H x W brightness
  /// @param estimate  H x W current estimates; decide whether another measurement is worth its time
  /// @param prior     H x W; searched within ± 2 σ. Where there is none, from infinity to `max_inverse_depth`
  const std::vector<StereoObservation>& observe(const cv::Mat_<float>& keyframe,
                                                const StereoCandidates& candidates, const StereoView& view,
                                                const InverseDepthImage& estimate,
                                                const InverseDepthImage& prior, float max_inverse_depth,
                                                const MappingOptions& options);

 private:
  void plan(const StereoCandidates& candidates, const StereoView& view, const InverseDepthImage& estimate,
            const InverseDepthImage& prior, float max_inverse_depth, const MappingOptions& options);
  void match(const cv::Mat_<float>& keyframe, const StereoCandidates& candidates, const StereoView& view,
             const MappingOptions& options);

  PinholeCamera camera_;
  EpipolarSegments segments_;
  std::vector<std::vector<int>> by_length_;  ///< candidates to search for, by the length of the segment
  std::vector<StereoObservation> observations_;
};

}  // namespace rgbd_sfm_fusion
