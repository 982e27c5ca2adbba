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
/// keyframe's depth with each tracked frame.
///
/// Frame n is tracked against the map as of frame n - 2 (a frame that starts: n - 1), so that mapping of one
/// frame may go on beside tracking of the next. Call track() and map() in turn; or track() in one thread,
/// which calls waitForMap() before it, and map() in another, once for each frame that is tracked. Both give
/// the same bits: the same frames and options always do.
class VisualOdometry {
 public:
  /// @throws std::invalid_argument naming the option or camera parameter that is out of range
  VisualOdometry(const PinholeCamera& camera, const OdometryOptions& options);
  ~VisualOdometry();

  /// Pose of a frame; never throws for what an image shows. Its images must not change until it is mapped.
  /// @throws std::invalid_argument when an image has not the camera's size, or the stamp is not later than
  ///         that of the frame before (reset() first)
  /// @throws std::logic_error where the map that it needs is not there yet
  TrackingResult track(const RgbdFrame& frame);

  /// Refines the keyframe with the oldest tracked frame that was not mapped yet, or makes that frame the new
  /// keyframe if its TrackingResult names itself.
  /// @return the map's new revision; null where there is no such frame, or it was skipped
  std::shared_ptr<const KeyframeMap> map();

  /// Until the map that the next track() needs is there. Where map() runs in no other thread: for ever.
  void waitForMap();
  bool isReady() const;  ///< waitForMap() would not wait

  /// Until map() has been called for all tracked frames.
  void waitForAllMaps();

  /// Takes the oldest frame that waits for map() out of the keyframe's views, so that tracking need not wait
  /// for it. The results are then other ones than without.
  /// @return false: nothing waits, or it is a keyframe, which cannot be done without
  bool skipMap();

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
