// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Values are those of TrackedFrame.msg.
enum class TrackingState : std::uint8_t { kInitialising = 0, kTracking = 1, kLost = 2 };

/// The state's name in reports and diagnostics.
constexpr const char* toText(TrackingState state) {
  return state == TrackingState::kTracking ? "tracking"
         : state == TrackingState::kLost   ? "lost"
                                           : "initialising";
}

/// Where a colour image was taken. A frame that becomes a keyframe names itself as its keyframe, and its pose
/// there is the identity.
struct TrackingResult {
  Stamp stamp = kNoStamp;
  TrackingState state = TrackingState::kInitialising;
  bool relocalised = false;  ///< the pose jumped: it does not continue from the frame before
  double readout_time =
      0.0;  ///< [s] of a rolling shutter, as set, or as learned up to this frame; < 0: last row first
  double readout_sigma = 0.0;      ///< [s] its standard deviation; 0: it is set
  double depth_delay = 0.0;        ///< [s] by which depth images are taken to be older than their stamps say,
                                   ///< as was learned up to the keyframe
  double depth_delay_sigma = 0.0;  ///< [s] standard deviation of what is learned; 0: it is not learned
  /// [px] to add to the calibration's principal point, as learned up to this frame; 0: no sign that it is
  /// off.
  Eigen::Vector2d principal_point_correction = Eigen::Vector2d::Zero();
  Eigen::Vector2d principal_point_sigma = Eigen::Vector2d::Zero();  ///< [px] its standard deviation

  /// Of the keyframe's points in view: those whose brightness fits, 0 to 1. Also of an alignment that failed.
  double share_of_good_points = 0.0;

  /// Of the image: what stays where it is while the scene moves on, 0 to 1 (FixedInView). Not in messages.
  double share_fixed_in_view = 0.0;

  // Only while tracking:
  Stamp keyframe_stamp = kNoStamp;       ///< of the keyframe that the pose refers to
  std::uint32_t keyframe_revision = 0;   ///< of that keyframe's map, as tracking used it
  SE3 T_frame_keyframe;                  ///< tracker units
  Matrix6 covariance = Matrix6::Zero();  ///< of T_frame_keyframe: left perturbation, axes of the frame. Never
                                         ///< singular; tiny where T_frame_keyframe is the identity
  SE3 T_first_frame;                     ///< pose of the optical frame in that of the first tracked image
  Matrix6 pose_covariance = Matrix6::Zero();  ///< of T_frame_first, in the same way: accumulated since the
                                              ///< start, and larger after a loss
};

}  // namespace rgbd_sfm_fusion
