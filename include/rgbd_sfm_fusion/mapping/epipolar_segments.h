// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/rolling_shutter.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/image/brightness.h"
#include "rgbd_sfm_fusion/image/inverse_depth.h"
#include "rgbd_sfm_fusion/image/row_bands.h"
#include "rgbd_sfm_fusion/mapping/mapping_options.h"
#include "rgbd_sfm_fusion/mapping/stereo_candidates.h"

namespace rgbd_sfm_fusion {

/// [px] A match compares samples along the line, up to this distance to either side.
constexpr int kPatternRadius = 2;

/// A second image of the keyframe's scene.
struct StereoView {
  const GreyImage* image = nullptr;
  cv::Rect seen;  ///< part of the image that the camera has seen
  SE3 T_view_keyframe;
  Brightness brightness;                        ///< of the view, relative to the keyframe
  double readout_time = 0.0;                    ///< [s] from the first row to the last
  Vector6 velocity = Vector6::Zero();           ///< [1/s] twist of the camera as it took the view
  Vector6 keyframe_velocity = Vector6::Zero();  ///< [1/s] the same for the keyframe
};

/// Where to search the view for one candidate.
struct EpipolarSegment {
  int pixel;                     ///< v * width + u, in the keyframe
  float keyframe_u, keyframe_v;  ///< [px]
  float u, v;                    ///< [px] centre of the search in the view
  float du, dv;                  ///< unit direction of growing inverse depth
  float eu, ev;                  ///< [px] step in the keyframe that moves the projection by one px
  float inverse_depth;           ///< at the centre
  float rate;                    ///< [px] by which the projection moves per unit of inverse depth
  float z;                       ///< depth in the view over depth in the keyframe, at the centre
  float z_rate;                  ///< change of z per unit of inverse depth
  float geometric_variance;      ///< [px²]
  float by_readout;              ///< [1/s] error of the inverse depth per error of the readout time
  int before, after;             ///< [px] from the centre to the ends; may be negative
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
struct CandidatesInTurn {
  const StereoCandidates& all;   ///< searched for in the turn's bands
  const StereoCandidates& open;  ///< those that are searched for in every view; used in the other bands
  RowBands turn;
};

/// The segments of the candidates whose estimates a search can improve.
class EpipolarSegments {
 public:
  void plan(const PinholeCamera& camera, const CandidatesInTurn& candidates, const StereoView& view,
            const KnownDepths& known, const MappingOptions& options);

  /// The segments in image order.
  const std::vector<EpipolarSegment>& all() const { return segments_; }

  /// Indices of all segments, short segments first. Segments of one length are in image order.
  const std::vector<int>& byLength() const { return by_length_; }

 private:
  void sort(std::size_t longest);

  std::vector<EpipolarSegment> segments_;
  std::vector<int> by_length_;
  std::vector<int> ends_;  // work space: per length, where the next segment of that length goes
};

}  // namespace rgbd_sfm_fusion
