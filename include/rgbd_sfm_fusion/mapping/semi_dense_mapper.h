// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "rgbd_sfm_fusion/image/image_pyramid.h"
#include "rgbd_sfm_fusion/mapping/epipolar_stereo.h"
#include "rgbd_sfm_fusion/mapping/propagation.h"
#include "rgbd_sfm_fusion/mapping/regularisation.h"
#include "rgbd_sfm_fusion/mapping/semi_dense_map.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Depth of the keyframe's textured pixels from parallax alone. It never sees sensor depth (method.md 6).
class SemiDenseMapper {
 public:
  explicit SemiDenseMapper(const PinholeCamera& camera);

  /// Takes another camera for the keyframe that was set last, with images of the same size.
  void setCamera(const PinholeCamera& camera) { search_.setCamera(camera); }

  /// Starts a map without estimates.
  void start(const ImagePyramid& keyframe, const MappingOptions& options);

  /// Makes a tracked frame the keyframe, and carries the estimates over to it.
  /// @param warp        from the old keyframe to the new one
  /// @param brightness  of the new keyframe relative to the old one
  void moveTo(const ImagePyramid& keyframe, const InverseDepthWarp& warp, const Brightness& brightness,
              const MappingOptions& options);

  /// Refines the estimates by stereo with another view of the keyframe's scene.
  /// @param max_inverse_depth  nearest surface to search for where nothing is known of a pixel
  /// @param bands              in which the view is searched for all pixels, and averages are renewed.
  ///                           In the others, it is searched for pixels with few observations or a large σ
  ///                           only
  void observe(const StereoView& view, float max_inverse_depth, const RowBands& bands,
               const MappingOptions& options);

  /// Like observe(), but only for pixels that got no estimate from moveTo(): the estimates that moveTo() has
  /// carried rest on these same views.
  void observeNew(const std::vector<StereoView>& views, float max_inverse_depth,
                  const MappingOptions& options);

  /// From the next call of another function on, there are no estimates in some squares of the image, which
  /// say nothing of the scene. From the next keyframe on, nothing is searched for there.
  /// @param squares  as forEachMarked() takes them
  void leaveOut(const cv::Mat_<std::uint8_t>& squares) { left_out_ = squares; }

  /// Estimates averaged over neighbours of the same surface; and priors in the gaps between them.
  const InverseDepthImage& smoothed() const { return regulariser_.smoothed(); }
  const SemiDenseMap& map() const { return map_; }

  /// The averaged estimates that can be relied on: with enough observations, neighbours that agree, and a
  /// small σ.
  /// @param bands   whose averages observe() has renewed
  /// @param result  overwritten in the bands
  void reliable(const RowBands& bands, const MappingOptions& options, InverseDepthImage& result) const;

  /// The reliable estimates as depth, as it is published. With `smooth_published`, they are averaged over
  /// more neighbours; tracking and stereo need no such average, as they average over many pixels themselves.
  /// With `follow_scatter`, the variance follows the real scatter of observations: the error model of Engel
  /// et al. 2013 knows neither a camera's real noise nor the pixels that are hard to match (occluding
  /// contours, repeated texture). The variance also has the effect of an error of the readout time, which
  /// more observations do not reduce, as all of them have the same error.
  /// @param readout_sigma  [s] standard deviation of the readout time that stereo used; 0: it is exact
  /// @param depth          overwritten in the bands
  void toDepth(const InverseDepthImage& reliable, const RowBands& bands, float readout_sigma,
               const MappingOptions& options, GaussianDepth& depth);

 private:
  void observe(const CandidatesByBand& candidates, const StereoView& view, float max_inverse_depth,
               const MappingOptions& options);
  void forgetContradicted(const std::vector<StereoObservation>& observations, const MappingOptions& options);
  void forgetLeftOut();
  void collectOpen(const RowBands& bands, const MappingOptions& options);
  void setImage(const ImagePyramid& keyframe, const MappingOptions& options);

  EpipolarStereo search_;
  GreyImage image_, previous_image_;
  StereoCandidates candidates_;
  StereoCandidates open_;  // searched for in every view
  StereoCandidates new_;   // of observeNew(), and work space
  cv::Mat_<std::uint8_t> left_out_;
  SemiDenseMap map_, previous_map_;
  Propagation propagation_;
  Regulariser regulariser_;
  InverseDepthImage averaged_;
};

}  // namespace rgbd_sfm_fusion
