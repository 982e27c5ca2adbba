// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/odometry/odometry_options.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Values are those of TrackedFrame.msg.
enum class TrackingState : std::uint8_t { kInitialising = 0, kTracking = 1, kLost = 2 };

/// As reports and diagnostics say it.
constexpr const char* toText(TrackingState state) {
  return state == TrackingState::kTracking ? "tracking"
         : state == TrackingState::kLost   ? "lost"
                                           : "initialising";
}

/// Where a colour image was taken. A frame that becomes a keyframe names itself, with the identity.
struct TrackingResult {
  Stamp stamp = kNoStamp;
  TrackingState state = TrackingState::kInitialising;
  bool relocalised = false;    ///< the pose jumped: it does not continue that of the frame before
  double readout_time = 0.0;   ///< [s] of a rolling shutter, as set, or as learned up to this frame
  double readout_sigma = 0.0;  ///< [s] its standard deviation; 0: it is set

  // Only while tracking:
  Stamp keyframe_stamp = kNoStamp;       ///< of the keyframe that the pose refers to
  std::uint32_t keyframe_revision = 0;   ///< of that keyframe's map, as tracking used it
  SE3 T_frame_keyframe;                  ///< tracker units
  Matrix6 covariance = Matrix6::Zero();  ///< of T_frame_keyframe: left perturbation, axes of the frame. Never
                                         ///< singular; tiny where T_frame_keyframe is the identity
  SE3 T_odom_frame;                      ///< pose of the optical frame; odom here is the first optical frame
  Matrix6 odom_covariance = Matrix6::Zero();  ///< of its inverse, in the same way: accumulated since the
                                              ///< start, with what a loss leaves unknown
  double share_of_good_points = 0.0;          ///< keyframe points in view whose brightness fits, 0 to 1
};

/// What tracking and mapping know of a keyframe, as published. Immutable once made.
struct KeyframeMap {
  Stamp stamp = kNoStamp;
  std::uint32_t revision = 0;  ///< counts refinements of the same keyframe, from 0
  PinholeCamera camera;
  SE3 T_first_keyframe;  ///< pose in the optical frame of the first tracked image; tracker units
  GreyImage grey;
  GaussianDepth depth;  ///< tracker units; from stereo alone, never from sensor depth (method.md 6). Under a
                        ///< rolling shutter that of each row as it was read; poses are those of middle rows.
                        ///< What is not known of the readout time is part of the variance
};

/// The structure from motion of docs/method.md 7 to 9: tracks each frame against a keyframe, and refines that
/// keyframe's depth with each tracked frame. Call track() and map() in turn, from one thread or from two
/// that wait for each other: frame n is tracked against the map as of frame n - 1.
///
/// Deterministic: the same frames and options give the same bits.
class VisualOdometry {
 public:
  /// @throws std::invalid_argument naming the option or camera parameter that is out of range
  VisualOdometry(const PinholeCamera& camera, const OdometryOptions& options);
  ~VisualOdometry();

  /// Pose of a frame; never throws for what an image shows.
  /// @throws std::invalid_argument when an image has not the camera's size, or the stamp is not later than
  ///         that of the frame before (reset() first)
  TrackingResult track(const RgbdFrame& frame);

  /// Refines the keyframe with the frame that track() was last called with, or makes that frame the new
  /// keyframe if its TrackingResult names itself.
  /// @return the map's new revision; null while there is no keyframe (initialising or lost)
  std::shared_ptr<const KeyframeMap> map();

  /// Forgets everything but camera and options.
  void reset();

  /// Takes effect with the next frame; the map stays.
  /// @throws std::invalid_argument as the constructor, and then changes nothing
  void setOptions(const OdometryOptions& options);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace rgbd_sfm_fusion
