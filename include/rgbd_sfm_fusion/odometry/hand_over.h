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
  /// @throws std::logic_error if the last frame that becomes the keyframe was not mapped without stereo: the
  ///         next frame is relative to it
  std::shared_ptr<const KeyframeToTrack> keyframeFor(Stamp stamp);
  /// @param frame  null: the frame has no use for mapping
  void addTracked(Stamp stamp, std::shared_ptr<const FrameToMap> frame);

  // For mapping, in this order:
  /// The frame to be mapped next, which stays here until done(). @return null if no frame waits
  std::shared_ptr<const FrameToMap> oldest() const;
  /// The oldest frame was mapped without stereo.
  /// @param keyframe  what KeyframeMapper::mapWithoutStereo() has returned. It takes the place of the map of
  ///                  the frame before; null: it does not
  /// @return whether stereo is to follow
  bool mappedWithoutStereo(std::shared_ptr<const KeyframeToTrack> keyframe);
  /// Whether tracking waits for the oldest frame's map, as far as one can tell: the oldest frame itself was
  /// tracked against the map of the frame before it. Right after a loss that may be wrong, which costs time
  /// alone.
  bool isAwaited() const;
  void mappedByStereo(std::shared_ptr<const KeyframeToTrack> keyframe);
  /// The oldest frame leaves, whether its mapping has come to its end or not.
  void done();

  // For those who wait:
  void waitForMap(Stamp stamp);
  bool waitForMap(Stamp stamp, double seconds);
  void waitForAllMaps();
  void waitForKeyframe();

  std::size_t skipMaps();
  /// Drops the frames that wait, and the keyframes. Frames are numbered on.
  void forgetMaps();

 private:
  /// A tracked frame that waits for its mapping, or is being mapped.
  struct WaitingFrame {
    std::int64_t number = 0;  ///< of the frame
    std::shared_ptr<const FrameToMap> frame;
    bool is_awaited = true;  ///< it was itself tracked against the map of the frame before
    bool is_mapped_without_stereo = false;
    bool is_skipped = false;  ///< it is not mapped by stereo

    bool isKeyframe() const { return frame->use != FrameToMap::Use::kRefines; }
  };
  struct NumberedKeyframe {
    std::int64_t map_number;  ///< of the frame whose map it is, or takes the place of
    std::shared_ptr<const KeyframeToTrack> keyframe;
  };

  // With the mutex held:
  std::int64_t mapNumberFor(Stamp stamp) const;
  bool isReadyFor(Stamp stamp) const;
  bool lastKeyframeIsReady() const;

  mutable std::mutex mutex_;  // of all that follows
  std::condition_variable changed_;
  std::int64_t next_number_ = 0;
  Stamp last_stamp_ = 0;                     // of the frame before
  std::optional<std::int64_t> last_start_;   // number of the last frame that started a map
  std::vector<WaitingFrame> waiting_;        // in order
  std::vector<NumberedKeyframe> keyframes_;  // in order, from the one in use on
};

}  // namespace rgbd_sfm_fusion
