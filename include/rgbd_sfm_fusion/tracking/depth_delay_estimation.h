// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/tracking/calibration_belief.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"
#include "rgbd_sfm_fusion/tracking/readout_estimation.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Learns how much older depth images are than their stamps say (method.md 10). Brightness tells where the
/// camera was at the time of the colour images, and the sensor's depth where it was at the time of the depth
/// images. Where a frame moves as its keyframe did, the delays of both cancel; so the difference of their
/// velocities is what tells.
class DepthDelayEstimator {
 public:
  /// What a frame was aligned with.
  struct Keyframe {
    Stamp stamp = kNoStamp;
    Vector6 velocity = Vector6::Zero();  ///< [1/s] twist, in the keyframe's axes
    double delay = 0.0;                  ///< [s] of its own depth, and of the frame's
  };

  /// Learns from the frame before, of which the velocity is known now: that between the frames before it and
  /// after it. The error of its own pose has no part in it; in one of the steps alone, it would count as
  /// motion.
  /// @param step      twist of the motion to this frame, from the frame before
  /// @param interval  [s] of that motion
  void observe(const AlignmentResult& aligned, const Vector6& step, double interval,
               const Keyframe& keyframe);

  /// The next frame does not follow on the last one.
  void forgetLast() { aligned_with_.stamp = kNoStamp; }

  double delay() const { return belief_.correction()(0); }  ///< [s] 0: no clear sign of any
  double sigma() const { return belief_.sigma()(0); }       ///< [s]

 private:
  void learn(const Vector6& velocity);

  // Of the last frame:
  AlignmentResult aligned_;
  Keyframe aligned_with_;  // without a stamp: none
  Vector6 step_ = Vector6::Zero();
  double interval_ = 0.0;
  // A stamp may be that of an image's first row, or of its last: half a readout away.
  CalibrationBelief<1> belief_{ReadoutEstimator::kStartSigma};
};

}  // namespace rgbd_sfm_fusion
