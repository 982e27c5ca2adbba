// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/odometry/earlier_keyframes.h"
#include "rgbd_sfm_fusion/odometry/fixed_in_view.h"
#include "rgbd_sfm_fusion/odometry/keyframe.h"
#include "rgbd_sfm_fusion/odometry/self_calibration.h"
#include "rgbd_sfm_fusion/odometry/tracking_result.h"
#include "rgbd_sfm_fusion/shared_pool.h"
#include "rgbd_sfm_fusion/tracking/image_noise.h"

namespace rgbd_sfm_fusion {

/// Finds where the camera is. Owns all that goes from frame to frame: state, pose, velocity, brightness, the
/// learned calibration and noise of the camera, and the keyframes to come back to. The states are those of
/// TrackingState:
///   initialising  no keyframe: the first frame to start from becomes one
///   tracking      each frame is aligned with the keyframe, and may become the next one
///   lost          the keyframe, and those before it, are looked for; after a while a new one is started
class FrameTracker {
 public:
  FrameTracker(const PinholeCamera& camera, const OdometryOptions& options);

  struct Result {
    TrackingResult tracked;
    std::shared_ptr<const FrameToMap> to_map;  ///< the frame, for mapping; null unless tracking
  };

  /// @param keyframe  that of HandOver::keyframeFor(), often the same as for the frame before; null: none
  Result track(const RgbdFrame& frame, const std::shared_ptr<const KeyframeToTrack>& keyframe);

  /// Forgets everything but camera and options.
  void reset();

  /// @return whether earlier keyframes are of no use any more; then pass null with the next frame
  bool setOptions(const OdometryOptions& options);

 private:
  /// The frame that is being worked on.
  struct Current {
    TrackingResult tracked;
    std::shared_ptr<FrameToMap> to_map;
  };

  void check(const RgbdFrame& frame) const;
  Current prepare(const RgbdFrame& frame);
  void adopt(const std::shared_ptr<const KeyframeToTrack>& keyframe);
  void computeCells(const RgbdFrame& frame);

  bool follow(Current& current);
  void lookAround(const AlignmentProblem& problem, const SE3& T_last_keyframe, AlignmentResult& result) const;
  void accept(const AlignmentProblem& problem, const AlignmentResult& result, Current& current);
  void startIfPossible(Current& current);
  bool startAtEarlierPlace(Current& current);
  bool keepLooking(Stamp now);
  void startAnew(Current& current);
  void startAt(const CameraPose& pose, Current& current);
  void markAsKeyframe(FrameToMap::Use use, Current& current);
  void setPose(const CameraPose& pose, Current& current);

  bool canStart(const Current& current) const;
  bool hasJumped(const SE3& T_first_frame) const;
  double progress(const AlignmentResult& result) const;
  bool waitsForClearView(const AlignmentResult& result) const;
  bool hasPose() const { return pose_stamp_ != kNoStamp; }
  Vector6 unknownSinceLoss() const;
  bool mayHaveTurned() const;
  const std::vector<SE3>& guesses(const SE3& T_last_keyframe, double interval);
  double scaleSigma() const;
  float depthPairSigma() const;
  double depthDelay() const;
  DepthPair depthPair(const RgbdFrame& frame, double interval) const;

  PinholeCamera camera_;  // as given
  std::shared_ptr<const OdometryOptions> options_;
  SharedPool<FrameToMap> frames_;
  DepthCells cells_;  // of the current frame's sensor depth; empty: it is not aligned with sensor depth
  std::vector<SE3> guesses_;  // work space

  TrackingState state_ = TrackingState::kInitialising;
  Stamp last_stamp_ = kNoStamp;
  CameraPose pose_;  // the last one
  Stamp pose_stamp_ = kNoStamp;
  double scene_depth_ = 1.0;        // [tracker units] of the last keyframe, also once there is none
  Step step_;                       // to the last pose
  Stamp looking_since_ = kNoStamp;  // first usable image after a loss
  SelfCalibration calibration_;
  ImageNoise noise_{static_cast<double>(TrackingOptions().image_noise)};
  double alike_ = Photometry().alike;  // of the last frame that was aligned
  FixedInView fixed_;

  std::shared_ptr<const KeyframeToTrack> keyframe_;  // frames are aligned with it
  Brightness brightness_;                            // of the last frame, relative to the keyframe
  EarlierKeyframes earlier_keyframes_;
};

}  // namespace rgbd_sfm_fusion
