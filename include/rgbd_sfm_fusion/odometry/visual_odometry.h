// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/odometry/keyframe_map.h"
#include "rgbd_sfm_fusion/odometry/odometry_options.h"
#include "rgbd_sfm_fusion/odometry/tracking_result.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

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

  /// Tracks a frame. Never throws because of an image's content.
  /// @throws std::invalid_argument if an image does not have the camera's size, or if the stamp is not later
  ///         than the stamp of the frame before (call reset() first)
  TrackingResult track(const RgbdFrame& frame);

  /// Maps the frame that track() was last called with: refines the keyframe with the frame, or makes it the
  /// new keyframe if its TrackingResult names the frame itself.
  /// @return the map's new revision; null if the frame was not tracked, while the keyframe is kept
  std::shared_ptr<const KeyframeMap> map();

  /// Forgets everything but camera and options.
  void reset();

  /// Takes effect with the next frame; tracking.min_gradient with the next keyframe. The map stays, unless
  /// the levels of the pyramid change. Then the next frame starts a new keyframe, as after a loss.
  /// @throws std::invalid_argument as the constructor does; then nothing changes
  void setOptions(const OdometryOptions& options);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace rgbd_sfm_fusion
