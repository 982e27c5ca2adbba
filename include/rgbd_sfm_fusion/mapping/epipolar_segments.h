// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/rolling_shutter.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/image/brightness.h"
#include "rgbd_sfm_fusion/image/inverse_depth.h"
#include "rgbd_sfm_fusion/image/row_bands.h"
#include "rgbd_sfm_fusion/mapping/mapping_options.h"
#include "rgbd_sfm_fusion/mapping/stereo_candidates.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {

/// A second image of the keyframe's scene.
struct StereoView {
  const GreyImage* image = nullptr;
  cv::Rect seen;  ///< part of the image that the camera has seen
  SE3 T_view_keyframe;
  Brightness brightness;                        ///< of the view, relative to the keyframe
  double readout_time = 0.0;                    ///< [s] from the first row to the last
  Vector6 velocity = Vector6::Zero();           ///< [1/s] twist of the camera as it took the view
  Vector6 keyframe_velocity = Vector6::Zero();  ///< [1/s] the same for the keyframe
  Matrix6 covariance = Matrix6::Zero();         ///< of T_view_keyframe: left perturbation, axes of the view
};

/// Where to search the view for the candidates of a block. One array per quantity.
struct SegmentBlock {
  SegmentBlock() {}  // not zeroed: all of it is written

  float keyframe_u[kLanes], keyframe_v[kLanes];  ///< [px]
  float u[kLanes], v[kLanes];                    ///< [px] centre of the search in the view
  float du[kLanes], dv[kLanes];                  ///< unit direction of growing inverse depth
  float eu[kLanes], ev[kLanes];       ///< [px] step in the keyframe that moves the projection by one px
  float inverse_depth[kLanes];        ///< at the centre
  float rate[kLanes];                 ///< [px] by which the projection moves per unit of inverse depth
  float z[kLanes];                    ///< depth in the view over depth in the keyframe, at the centre
  float z_rate[kLanes];               ///< change of z per unit of inverse depth
  float geometric_variance[kLanes];   ///< [px²]
  int before[kLanes], after[kLanes];  ///< [px] from the centre to the ends; may be negative
};

/// A block of candidates, and where to search for them.
struct PlannedSegments {
  SegmentBlock segments;
  float by_pose[kLanes];     ///< sigma of the inverse depth by the error of the view's pose alone
  float by_readout[kLanes];  ///< [1/s] error of the inverse depth per error of the readout time

  /// Whether a search can improve the candidate's estimate. If not, the rest is meaningless.
  bool isSearched(std::size_t lane) const { return segments.before[lane] + segments.after[lane] >= 0; }
};

/// The knowledge about the keyframe's inverse depths before a search.
struct KnownDepths {
  const InverseDepthImage& estimate;           ///< decides whether another measurement is worth its time
  const cv::Mat_<std::uint8_t>& observations;  ///< number behind each estimate; few are to be confirmed
  const InverseDepthImage& prior;              ///< a search covers ± 2 σ around it
  float max_inverse_depth;  ///< without a prior, a search goes from infinity to here, inside the view
};

/// The candidates of a view. Views near to each other say nearly the same, so a view is searched for all
/// candidates in some bands of rows only.
struct CandidatesByBand {
  const StereoCandidates& all;   ///< searched for in `bands`
  const StereoCandidates& open;  ///< those that are searched for in every view; used in the other bands
  RowBands bands;
};

/// The pair's geometry: pixel (u, v) at inverse depth ρ projects to H (u, v, 1) + ρ b.
struct PairGeometry {
  float H[9], b[3];    // row-major K R K⁻¹, and K t
  float dH[9], db[3];  // [1/s] derivatives by the readout time
  float fx, fy, cx, cy;
  // Of the view's pose. Above the diagonal are sums of two equal entries; what is below is not used.
  float covariance[6][6];
};

/// Bounds for all pixels of a band, by which the variance that a search can reach is bounded from below.
struct VarianceBound {
  float epipole[3];         ///< [px] homogeneous: the view's camera in the keyframe
  float most_rate_squared;  ///< of SegmentBlock::rate
  float photometric;        ///< [grey levels²] of photometric variance times (gradient along the line)²
  float epipolar;           ///< [px²] of the line's position
};

/// Plans the searches of a view.
class EpipolarPlan {
 public:
  struct Limits {
    float max_inverse_depth, min_u, min_v, max_u, max_v, max_length, image_variance, epipolar_variance,
        confirm_below_squared;
    int min_observations;
  };

  /// The view and what is known have to outlive the plan.
  EpipolarPlan(const PinholeCamera& camera, const StereoView& view, const KnownDepths& known,
               const MappingOptions& options);

  /// Goes on with the candidates of a band of rows.
  void setBand(std::size_t band);

  /// Marks candidates whose estimate a search may improve, by a bound that is near what plan() finds and
  /// takes a fraction of its time. None is left out that plan() would search for.
  void markPromising(const StereoCandidates::Block& candidates, bool* promising) const;

  void plan(const StereoCandidates::Block& candidates, PlannedSegments& planned) const;

  /// [px] before + after of the longest segment that is ever planned.
  static int longest(const MappingOptions& options) { return options.max_search_length + 3; }

 private:
  PinholeCamera camera_;
  const StereoView& view_;
  const KnownDepths& known_;
  double typical_;  // inverse depth
  Limits limits_;
  PairGeometry pair_;
  VarianceBound bound_;
};

}  // namespace rgbd_sfm_fusion
