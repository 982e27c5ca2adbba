// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/odometry/keyframe_map.h"
#include "rgbd_sfm_fusion/odometry/odometry_options.h"
#include "rgbd_sfm_fusion/odometry/tracking_result.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// The structure from motion of docs/method.md 7 to 9: tracks each frame against a keyframe, and refines that
/// keyframe's depth with each tracked frame. Frame n is tracked against the map as of frame n - 2, so mapping
/// has time to go on beside tracking. There are two exceptions where the map of frame n - 1 is used: if that
/// frame is more than 0.06 s older than frame n, as mapping had as much time then; and for six frames
/// after a start, as the map is poor then. What mapping gets from a frame's pose alone is used at once: a new
/// keyframe with sensor depth and the depth that was known before it.
///
/// Call track() and map() in turn; or let a second thread call map(), and waitForMap() before each track().
/// Both give the same. Deterministic: the same frames and options give the same bits, unless frames are
/// tracked without waiting.
class VisualOdometry {
 public:
  /// @throws std::invalid_argument naming the option or camera parameter that is out of range
  VisualOdometry(const PinholeCamera& camera, const OdometryOptions& options);
  ~VisualOdometry();

  /// Tracks a frame, against the newest map that is there and is not newer than said above. Never throws
  /// because of an image's content.
  /// @throws std::invalid_argument if an image does not have the camera's size, or if the stamp is not later
  ///         than the stamp of the frame before (call reset() first)
  /// @throws std::logic_error if the last frame has become the keyframe, and map() was not called
  TrackingResult track(const RgbdFrame& frame);

  using OnMap = std::function<void(const std::shared_ptr<const KeyframeMap>&)>;

  /// Maps the oldest frame that track() has tracked and that is not mapped yet: refines the keyframe with the
  /// frame, or makes it the new keyframe if its TrackingResult names the frame itself.
  /// @param on_map  called with the map's new revision, before tracking gets it with stereo. Frames may name
  ///                a new keyframe's revision 0 before that; what they are tracked against has no stereo of
  ///                its own
  /// @return the new revision; null if no frame waits, or if it was skipped
  std::shared_ptr<const KeyframeMap> map(const OnMap& on_map = nullptr);

  /// Waits until another thread has made the map that the next frame is to be tracked against.
  /// @param stamp  of the next frame
  void waitForMap(Stamp stamp);
  /// @param seconds  how long to wait at most
  /// @return whether the map is there
  bool waitForMap(Stamp stamp, double seconds);
  /// Waits until map() was called for all tracked frames.
  void waitForAllMaps();

  /// Under load: frames that wait for map() will not refine the map, and are no views for later keyframes.
  /// Tracking gives other results then. Call waitForKeyframe() before the next track().
  /// @return how many frames are skipped; keyframes are not, nor a frame whose stereo has begun
  std::size_t skipMaps();

  /// Waits until the last frame that became the keyframe can be tracked against, which takes some
  /// milliseconds once the mapping of the frame before is done.
  void waitForKeyframe();

  /// Forgets everything but camera and options. To be called by the thread that tracks, like setOptions().
  void reset();

  /// Takes effect with the next frame; what a keyframe is made with (min_gradient, its sensor depth) with the
  /// next keyframe. The map stays, unless the levels of the pyramid change. Then the next frame that can
  /// start a keyframe does so, as uncertain as after a loss.
  /// @throws std::invalid_argument as the constructor does; then nothing changes
  void setOptions(const OdometryOptions& options);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace rgbd_sfm_fusion
