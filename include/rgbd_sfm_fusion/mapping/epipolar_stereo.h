// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/mapping/inverse_depth.h"
#include "rgbd_sfm_fusion/mapping/mapping_options.h"
#include "rgbd_sfm_fusion/simd.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// Keyframe pixels with enough gradient for stereo, in blocks of one array per quantity.
struct StereoCandidates {
  struct Block {
    float u[kLanes], v[kLanes];                    ///< [px]
    float gradient_x[kLanes], gradient_y[kLanes];  ///< [grey levels / px]; 0 in the last block's padding
    int pixel[kLanes];                             ///< v * width + u
  };
  std::vector<Block> blocks;
  int count = 0;  ///< before padding

  /// @param seen  part of the image that the camera has seen
  void collect(const ImageGradient& gradient, const cv::Rect& seen, float min_gradient);
  int pixel(int index) const {
    return blocks[static_cast<std::size_t>(index / kLanes)].pixel[index % kLanes];
  }
};

/// A second image of what the keyframe shows.
struct StereoView {
  const cv::Mat_<float>* image = nullptr;
  cv::Rect seen;  ///< part of the image that the camera has seen
  SE3 T_view_keyframe;
  Brightness brightness;               ///< of the view, relative to the keyframe
  ReadoutMotion motion = {};           ///< of the camera while the view was read out
  ReadoutMotion keyframe_motion = {};  ///< and the keyframe
};

/// What a search found.
struct StereoObservation {
  int pixel = 0;         ///< v * width + u, in the keyframe
  bool matched = false;  ///< false: searched, but no clear match; the rest is then meaningless
  float inverse_depth = 0.0F;
  float variance = 0.0F;  ///< of the inverse depth
};

/// Where to search the view for a block of candidates.
struct EpipolarSegments {
  float u[kLanes], v[kLanes];         ///< [px] centre of the search in the view
  float du[kLanes], dv[kLanes];       ///< unit direction of growing inverse depth
  float eu[kLanes], ev[kLanes];       ///< [px] step in the keyframe that moves by one px in the view
  float inverse_depth[kLanes];        ///< at the centre
  float rate[kLanes];                 ///< [px] by which the projection moves per unit of inverse depth
  float z[kLanes];                    ///< depth in the view over that in the keyframe, at the centre
  float z_rate[kLanes];               ///< by which z changes per unit of inverse depth
  float geometric_variance[kLanes];   ///< [px²]
  int before[kLanes], after[kLanes];  ///< [px] to search either side of the centre; after < 0: not at all
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
  std::vector<EpipolarSegments> segments_;
  std::vector<std::vector<int>> by_length_;  ///< candidates to search for, by the length of the segment
  std::vector<StereoObservation> observations_;
};

}  // namespace rgbd_sfm_fusion
