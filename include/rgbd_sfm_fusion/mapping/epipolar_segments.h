// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/rolling_shutter.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/mapping/inverse_depth.h"
#include "rgbd_sfm_fusion/mapping/mapping_options.h"
#include "rgbd_sfm_fusion/mapping/stereo_candidates.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// [px] A match compares samples along the line up to so far either side.
constexpr int kPatternRadius = 2;

/// A second image of what the keyframe shows.
struct StereoView {
  const cv::Mat_<float>* image = nullptr;
  cv::Rect seen;  ///< part of the image that the camera has seen
  SE3 T_view_keyframe;
  Brightness brightness;               ///< of the view, relative to the keyframe
  ReadoutMotion motion = {};           ///< of the camera while the view was read out
  ReadoutMotion keyframe_motion = {};  ///< and the keyframe
};

/// Where to search the view for one candidate.
struct EpipolarSegment {
  int pixel;                     ///< v * width + u, in the keyframe
  float keyframe_u, keyframe_v;  ///< [px]
  float u, v;                    ///< [px] centre of the search in the view
  float du, dv;                  ///< unit direction of growing inverse depth
  float eu, ev;                  ///< [px] step in the keyframe that moves by one px in the view
  float inverse_depth;           ///< at the centre
  float rate;                    ///< [px] by which the projection moves per unit of inverse depth
  float z;                       ///< depth in the view over that in the keyframe, at the centre
  float z_rate;                  ///< by which z changes per unit of inverse depth
  float geometric_variance;      ///< [px²]
  int before, after;             ///< [px] to search either side of the centre
};

/// Segments of those candidates where a search can improve the estimate.
class EpipolarSegments {
 public:
  /// @param estimate  H x W current estimates; decide whether another measurement is worth its time
  /// @param prior     H x W; searched within ± 2 σ. Where there is none, from infinity to `max_inverse_depth`
  void plan(const PinholeCamera& camera, const StereoCandidates& candidates, const StereoView& view,
            const InverseDepthImage& estimate, const InverseDepthImage& prior, float max_inverse_depth,
            const MappingOptions& options);

  /// In lists by before + after.
  const std::vector<std::vector<EpipolarSegment>>& byLength() const { return by_length_; }

 private:
  std::vector<std::vector<EpipolarSegment>> by_length_;
};

}  // namespace rgbd_sfm_fusion
