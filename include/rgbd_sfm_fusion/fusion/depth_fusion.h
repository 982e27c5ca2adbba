// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "rgbd_sfm_fusion/completion/depth_completion.h"
#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"
#include "rgbd_sfm_fusion/fusion/learned_mean.h"
#include "rgbd_sfm_fusion/fusion/provenance.h"
#include "rgbd_sfm_fusion/fusion/reprojection.h"
#include "rgbd_sfm_fusion/fusion/scale_estimator.h"
#include "rgbd_sfm_fusion/fusion/sfm_only.h"
#include "rgbd_sfm_fusion/fusion/sfm_state.h"
#include "rgbd_sfm_fusion/image_pool.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/sensor/skew_compensation.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Everything published for one colour image. Images have the camera's size.
struct FusedFrame : FusedDepth {
  Stamp stamp = kNoStamp;  ///< of the colour image
  GaussianDepth sfm;       ///< [m] before fusion: reprojected, corrected by `state`, and without what is
                           ///< known not to be of the pixel's surface; empty without pose or scale
  SfmState state;          ///< the error that all SfM depths share
  ScaleEstimate scale;     ///< scale of the state, with the fit of this frame
  double sigma_twice_as_far =
      std::numeric_limits<double>::quiet_NaN();  ///< [1] see SfmState::sigmaTwiceAsFar()
  bool sfm_rejected = false;                     ///< too many pixels disagreed: no SfM depth is used
};

/// Eq. 5 to 12 for one frame after the other (method.md 1, 3 to 5, 11 and 12): measure the sensor (8),
/// reproject (5 to 7), fit the scale and what else SfM's depths have wrong in common (9, 10), fuse (11, 12),
/// judge what SfM alone has, complete. A variance belongs to one pixel alone: errors of neighbours and of
/// successive frames are correlated.
class DepthFusion {
 public:
  /// @throws std::invalid_argument naming the option or camera parameter that is out of range
  DepthFusion(const PinholeCamera& camera, const FusionOptions& options);
  DepthFusion(DepthFusion&&) = default;  // a copy would share the work space
  DepthFusion& operator=(DepthFusion&&) = default;

  /// @param tracked   pose of this frame; while not tracking the result is sensor only
  /// @param keyframe  the keyframe that `tracked` names; null, or another keyframe, counts as not tracking.
  ///                  The last keyframe is kept until a frame names another one
  /// @param frame     brings the sensor depth; `grey` shows which SfM depth is hidden, and guides the
  ///                  completion: nothing is completed if `grey` is empty
  /// @throws std::invalid_argument when the size of an image differs from the camera's
  FusedFrame fuse(const TrackingResult& tracked, const std::shared_ptr<const KeyframeMap>& keyframe,
                  const RgbdFrame& frame);

  /// Forgets everything but camera and options: scale, motion, and what was learned.
  void reset();

  /// Takes effect with the next frame; the scale stays.
  /// @throws std::invalid_argument as the constructor does; then nothing is changed
  void setOptions(const FusionOptions& options);

 private:
  void updateSensorDepth(const TrackingResult& tracked, const RgbdFrame& frame);
  void complete(const GreyImage& grey, const std::vector<cv::Rect>& mirrors, FusedFrame* fused);
  ScaleEstimate updateState(Stamp keyframe, Stamp stamp);
  SensorOffsetGain gainOfSensorOffset() const;
  FusedDepth takeBuffer();
  void alignPoints();
  /// Marks where SfM depth is not to be relied on: rims of holes, and holes without texture.
  cv::Mat_<std::uint8_t> markUnsupported(const GreyImage& grey, const cv::Mat_<std::uint8_t>& measured);

  PinholeCamera camera_;
  FusionOptions options_;
  SfmStateFilter state_filter_;
  LearnedMean squared_spread_;  ///< [1] of the frames that had a fit: see ScaleEstimate
  StampedPose last_pose_;
  OtherSurfaces other_surfaces_;
  DepthCompletion completion_;

  PreviousKeyframe previous_keyframe_;
  SensorDepth sensor_;  ///< [m] of this frame
  DepthImage moved_;    ///< [m] sensor depth at the colour stamp
  SfmPoints points_;    ///< of this frame
  ImagePool pool_;
};

}  // namespace rgbd_sfm_fusion
