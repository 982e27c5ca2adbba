// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "rgbd_sfm_fusion/odometry/keyframe.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// What lies between tracking and mapping: frames that wait to be mapped, and the keyframe as of the last
/// mappings. Decides which of these a frame is tracked against, by numbers of frames and by stamps alone, so
/// that it does not depend on how fast the two are. May be called by several threads.
class HandOver {
 public:
  // For tracking:
  /// The keyframe that a frame is tracked against, as of the newest map that is not too new.
  /// @return null: there is none yet
  /// @throws std::logic_error if KeyframeMapper::begin() was not called for the last frame that becomes the
  ///         keyframe, which the next frame is relative to
  std::shared_ptr<const KeyframeToTrack> keyframeFor(Stamp stamp);
  /// @param to_map  null: the frame has no use for mapping
  void addTracked(Stamp stamp, std::shared_ptr<const FrameToMap> to_map);

  // For mapping, in this order:
  /// The frame to be mapped next, which stays here until done(). @return null if no frame waits
  std::shared_ptr<const FrameToMap> oldest() const;
  /// Whether the frame after the oldest one is tracked against the latter's map, as the oldest one was
  /// against the map of the frame before it.
  bool isAwaited() const;
  /// The oldest frame's mapping has begun.
  /// @param keyframe  what KeyframeMapper::begin() has made for tracking, which is as good as the map of the
  ///                  frame before; may be null
  /// @return whether the rest of the mapping is to be done
  bool begun(std::shared_ptr<const KeyframeToTrack> keyframe);
  void mapped(std::shared_ptr<const KeyframeToTrack> keyframe);
  /// The oldest frame leaves, whether its mapping has come to its end or not.
  void done();

  // For those who wait:
  void waitForMap(Stamp stamp);
  bool waitForMap(Stamp stamp, double seconds);
  void waitForAllMaps();
  void waitForKeyframe();

  std::size_t skipMaps();
  /// Drops the frames that wait, and the keyframes. The next frame has the next number.
  void forgetMaps();

 private:
  /// A tracked frame that waits for its mapping, or is being mapped.
  struct ToMap {
    std::int64_t number = 0;  ///< of the frame
    std::shared_ptr<const FrameToMap> frame;
    bool is_awaited = true;   ///< as isAwaited() says
    bool has_begun = false;   ///< as KeyframeMapper::begin() means it
    bool is_skipped = false;  ///< its mapping ends with begin()

    bool isKeyframe() const { return frame->use != FrameToMap::Use::kRefines; }
  };
  struct Mapped {
    std::int64_t number;  ///< of the last frame whose map this is
    std::shared_ptr<const KeyframeToTrack> keyframe;
  };

  // With the mutex held:
  std::int64_t mapFor(Stamp stamp) const;
  bool isReadyFor(Stamp stamp) const;
  bool hasKeyframe() const;

  mutable std::mutex mutex_;  // of all that follows
  std::condition_variable changed_;
  std::int64_t next_frame_ = 0;
  Stamp last_stamp_ = 0;                 // of the frame before
  std::optional<std::int64_t> started_;  // number of the last frame that started a map
  std::vector<ToMap> to_map_;            // in order
  std::vector<Mapped> keyframes_;        // in order; the last ones
};

}  // namespace rgbd_sfm_fusion
