// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/odometry/frame_tracker.h"
#include "rgbd_sfm_fusion/odometry/keyframe_mapper.h"

namespace rgbd_sfm_fusion {
namespace {

// A frame is tracked against the map as of so many frames before, so that mapping has more than a frame's
// time at 30 Hz.
constexpr std::int64_t kMapLag = 2;
// [s] If the frame before is older than this, its mapping has had as much time, and the frame is tracked
// against the map with it: at 15 Hz and less, where the camera moves far from frame to frame.
constexpr double kLongestMapping = 0.06;
// [s] After a start, the map has little but sensor depth, and each frame adds much to it: so long, a frame is
// tracked against the map with the frame before, for which tracking waits. Where the sensor sees near
// surfaces only, turns would be taken for moves, and stereo would keep what it learned from them.
constexpr double kYoung = 0.5;
// [px] Smallest image that alignment may end on. Half of 320 x 240 doubles the error of the trajectory, half
// of 640 x 480 does not.
constexpr int kFewestPixels = 40000;

/// The level that alignment ends on: finer than the set one if the images are small.
int finestLevel(int finest, const PinholeCamera& camera) {
  while (finest > 0 && (camera.width >> finest) * (camera.height >> finest) < kFewestPixels) --finest;
  return finest;
}

OdometryOptions checked(OdometryOptions options, const PinholeCamera& camera) {
  validate(options, camera);
  options.tracking.finest_level = finestLevel(options.tracking.finest_level, camera);
  return options;
}

}  // namespace

/// Hands tracked frames to mapping, and keyframes back to tracking. Which keyframe a frame is tracked against
/// does not depend on how fast the two are.
class VisualOdometry::Implementation {
 public:
  Implementation(const PinholeCamera& camera, const OdometryOptions& options)
      : camera_(camera), tracker_(camera, checked(options, camera)), mapper_(camera) {}

  TrackingResult track(const RgbdFrame& frame) {
    FrameTracker::Result result = tracker_.track(frame, keyframeFor(frame.stamp));
    const std::lock_guard<std::mutex> lock(mutex_);
    const bool is_awaited = mapFor(frame.stamp) > next_frame_ - kMapLag;
    if (result.to_map && result.to_map->use == FrameToMap::Use::kStarts) started_ = frame.stamp;
    if (result.to_map) to_map_.push_back({next_frame_, std::move(result.to_map), is_awaited});
    ++next_frame_;
    last_stamp_ = frame.stamp;
    return result.tracked;
  }

  std::shared_ptr<const KeyframeMap> map(const OnMap& on_map) {
    const std::lock_guard<std::mutex> only_one(mapping_mutex_);
    const std::optional<ToMap> work = oldest();
    if (!work) return nullptr;
    const Done done{this};
    if (!haveBegun(mapper_.begin(*work->frame))) return nullptr;
    KeyframeMapper::Result result = mapper_.map(*work->frame, work->is_awaited);
    if (on_map) on_map(result.published);
    const std::lock_guard<std::mutex> lock(mutex_);
    keyframes_.push_back({work->number, std::move(result.tracking)});
    return result.published;
  }

  void waitForMap(Stamp stamp) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return isReadyFor(stamp); });
  }

  bool waitForMap(Stamp stamp, double seconds) {
    std::unique_lock<std::mutex> lock(mutex_);
    return changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return isReadyFor(stamp); });
  }

  void waitForAllMaps() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return to_map_.empty(); });
  }

  void waitForKeyframe() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return hasKeyframe(); });
  }

  std::size_t skipMaps() {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::size_t skipped = 0;
    for (ToMap& waiting : to_map_) {
      if (waiting.has_begun || waiting.is_skipped || waiting.isKeyframe()) continue;
      waiting.is_skipped = true;
      ++skipped;
    }
    changed_.notify_all();
    return skipped;
  }

  void reset() {
    const std::lock_guard<std::mutex> only_one(mapping_mutex_);
    tracker_.reset();
    forgetMaps();
  }

  void setOptions(const OdometryOptions& options) {
    const OdometryOptions taken = checked(options, camera_);
    const std::lock_guard<std::mutex> only_one(mapping_mutex_);
    if (tracker_.setOptions(taken)) forgetMaps();
  }

 private:
  /// A tracked frame that waits for its mapping, or is being mapped.
  struct ToMap {
    std::int64_t number = 0;  ///< of the frame
    std::shared_ptr<const FrameToMap> frame;
    bool is_awaited = true;   ///< by the next frame, if that is as late as this one
    bool has_begun = false;   ///< as KeyframeMapper::begin() means it
    bool is_skipped = false;  ///< its mapping ends with begin()

    bool isKeyframe() const { return frame->use != FrameToMap::Use::kRefines; }
  };
  /// What tracking needs of a keyframe.
  struct Mapped {
    std::int64_t number;  ///< of the last frame whose map this is
    std::shared_ptr<const TrackedKeyframe> keyframe;
  };

  /// What map() leaves, whatever happens.
  struct Done {
    Implementation* odometry;
    ~Done() {
      const std::lock_guard<std::mutex> lock(odometry->mutex_);
      odometry->to_map_.erase(odometry->to_map_.begin());
      odometry->changed_.notify_all();
    }
  };

  /// The number of the frame whose map the next frame is tracked against.
  std::int64_t mapFor(Stamp stamp) const {
    const bool is_young = started_ != kNoStamp && toSeconds(stamp - started_) < kYoung;
    const bool is_late = toSeconds(stamp - last_stamp_) > kLongestMapping;
    return next_frame_ - (is_young || is_late ? 1 : kMapLag);
  }

  bool isReadyFor(Stamp stamp) const {
    return std::all_of(to_map_.begin(), to_map_.end(), [number = mapFor(stamp)](const ToMap& waiting) {
      return waiting.has_begun && waiting.number > number;
    });
  }

  /// False: the last keyframe has not begun, which the next frame is relative to.
  bool hasKeyframe() const {
    return std::all_of(to_map_.begin(), to_map_.end(),
                       [](const ToMap& waiting) { return waiting.has_begun || !waiting.isKeyframe(); });
  }

  /// The keyframe that a frame is tracked against, as of the newest map that is not too new.
  std::shared_ptr<const TrackedKeyframe> keyframeFor(Stamp stamp) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!hasKeyframe()) throw std::logic_error("track() before map() of the frame that became the keyframe");
    const std::int64_t number = mapFor(stamp);
    while (keyframes_.size() > 1 && keyframes_[1].number <= number) keyframes_.erase(keyframes_.begin());
    return keyframes_.empty() ? nullptr : keyframes_.front().keyframe;
  }

  /// The frame to be mapped next. It stays in the queue until it is done.
  std::optional<ToMap> oldest() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return to_map_.empty() ? std::nullopt : std::optional<ToMap>(to_map_.front());
  }

  /// Hands over what begin() has made for tracking, which is as good as the map of the frame before it.
  /// @return whether the rest of the mapping is to be done
  bool haveBegun(std::shared_ptr<const TrackedKeyframe> keyframe) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ToMap& begun = to_map_.front();
    if (keyframe) keyframes_.push_back({begun.number - 1, std::move(keyframe)});
    begun.has_begun = true;
    changed_.notify_all();
    return !begun.is_skipped;
  }

  void forgetMaps() {
    const std::lock_guard<std::mutex> lock(mutex_);
    to_map_.clear();
    keyframes_.clear();
    started_ = kNoStamp;
    changed_.notify_all();
  }

  PinholeCamera camera_;
  FrameTracker tracker_;      // used by the tracking thread
  std::mutex mapping_mutex_;  // of the mapper; taken before the other one
  KeyframeMapper mapper_;

  mutable std::mutex mutex_;  // of all that follows
  std::condition_variable changed_;
  std::int64_t next_frame_ = 0;
  Stamp last_stamp_ = 0;           // of the frame before
  Stamp started_ = kNoStamp;       // of the last frame that started a map
  std::vector<ToMap> to_map_;      // in order
  std::vector<Mapped> keyframes_;  // in order; the last ones
};

VisualOdometry::VisualOdometry(const PinholeCamera& camera, const OdometryOptions& options)
    : implementation_(std::make_unique<Implementation>(camera, options)) {}
VisualOdometry::~VisualOdometry() = default;

TrackingResult VisualOdometry::track(const RgbdFrame& frame) {
  return implementation_->track(frame);
}
std::shared_ptr<const KeyframeMap> VisualOdometry::map(const OnMap& on_map) {
  return implementation_->map(on_map);
}
void VisualOdometry::waitForMap(Stamp stamp) {
  implementation_->waitForMap(stamp);
}
bool VisualOdometry::waitForMap(Stamp stamp, double seconds) {
  return implementation_->waitForMap(stamp, seconds);
}
void VisualOdometry::waitForAllMaps() {
  implementation_->waitForAllMaps();
}
void VisualOdometry::waitForKeyframe() {
  implementation_->waitForKeyframe();
}
std::size_t VisualOdometry::skipMaps() {
  return implementation_->skipMaps();
}
void VisualOdometry::reset() {
  implementation_->reset();
}
void VisualOdometry::setOptions(const OdometryOptions& options) {
  implementation_->setOptions(options);
}

}  // namespace rgbd_sfm_fusion
