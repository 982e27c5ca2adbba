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

  /// Learns from the frame before, of which the velocity is known now: the mean of the one before it and the
  /// one after it. In the frame's own step, the error of its pose would count as motion.
  /// @param velocity  [1/s] twist of the step to this frame, from the frame before
  void observe(const AlignmentResult& aligned, const Vector6& velocity, const Keyframe& keyframe);

  /// The next frame does not follow on the last one.
  void forgetLast() { last_.stamp = kNoStamp; }

  double delay() const { return belief_.correction()(0); }  ///< [s] 0: no clear sign of any
  double sigma() const { return belief_.sigma()(0); }       ///< [s]

 private:
  void learn(const Vector6& velocity);

  AlignmentResult aligned_;  // of the last frame
  Vector6 velocity_ = Vector6::Zero();
  Keyframe last_;                                               // that it was aligned with; or none
  CalibrationBelief<1> belief_{ReadoutEstimator::kStartSigma};  // as nothing is known of depth's readout
};

}  // namespace rgbd_sfm_fusion
