// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "rgbd_sfm_fusion/odometry/frame_tracker.h"
#include "rgbd_sfm_fusion/odometry/keyframe_mapper.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::int64_t kMapLag = 1;  // a frame is tracked against the map as of so many frames before
// [px] of an image that tracking may end on. Half of 320 x 240 doubles the error of the trajectory, half of
// 640 x 480 does not.
constexpr int kFewestPixels = 40000;

/// The level that alignment ends on: a finer one than is set, where the images are small.
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

/// Hands tracked frames to mapping and keyframes to tracking, and sees to it that which keyframe a frame is
/// tracked against does not depend on how fast either is.
class VisualOdometry::Implementation {
 public:
  Implementation(const PinholeCamera& camera, const OdometryOptions& options)
      : camera_(camera), tracker_(camera, checked(options, camera)), mapper_(camera) {}

  TrackingResult track(const RgbdFrame& frame) {
    const FrameTracker::Result result = tracker_.track(frame, keyframe());
    const std::lock_guard<std::mutex> lock(mutex_);
    if (result.to_map) to_map_.push_back({next_frame_, result.to_map});
    if (result.to_map && result.to_map->use == FrameToMap::Use::kStarts) start_ = next_frame_;
    ++next_frame_;
    return result.tracked;
  }

  std::shared_ptr<const KeyframeMap> map() {
    ToMap work;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (to_map_.empty()) return nullptr;
      work = to_map_.front();
      if (!work.frame) {  // it was skipped
        to_map_.pop_front();
        return nullptr;
      }
      is_mapping_ = true;
    }
    const Done done{this};
    KeyframeMapper::Result result = mapper_.map(*work.frame);
    const std::lock_guard<std::mutex> lock(mutex_);
    keyframes_.push_back({work.number, std::move(result.tracking)});
    return result.published;
  }

  void waitForMap() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return hasMap(mapOfNext()); });
  }

  bool isReady() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return hasMap(mapOfNext());
  }

  void waitForAllMaps() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return to_map_.empty(); });
  }

  bool skipMap() {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (std::size_t i = is_mapping_ ? 1 : 0; i < to_map_.size(); ++i) {
      if (!to_map_[i].frame) continue;
      if (to_map_[i].frame->use != FrameToMap::Use::kRefines) return false;
      to_map_[i].frame.reset();
      return true;
    }
    return false;
  }

  void reset() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return !is_mapping_; });
    tracker_.reset();
    to_map_.clear();
    keyframes_.clear();
  }

  void setOptions(const OdometryOptions& options) {
    const OdometryOptions taken = checked(options, camera_);
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return !is_mapping_; });
    if (!tracker_.setOptions(taken)) return;
    for (ToMap& waiting : to_map_) waiting.frame.reset();
    keyframes_.clear();
  }

 private:
  struct ToMap {
    std::int64_t number = 0;                  ///< of the frame
    std::shared_ptr<const FrameToMap> frame;  ///< null: skipped
  };
  struct Mapped {
    std::int64_t number;  ///< of the frame that it was refined with
    std::shared_ptr<const TrackedKeyframe> keyframe;
  };

  /// What map() leaves, whatever happens.
  struct Done {
    Implementation* odometry;
    ~Done() {
      const std::lock_guard<std::mutex> lock(odometry->mutex_);
      odometry->to_map_.pop_front();
      odometry->is_mapping_ = false;
      odometry->changed_.notify_all();
    }
  };

  /// Number of the frame whose map the next frame is tracked against. Right after a start there is none but
  /// its own.
  std::int64_t mapOfNext() const { return start_ == next_frame_ - 1 ? start_ : next_frame_ - kMapLag; }

  bool hasMap(std::int64_t number) const {
    for (const ToMap& waiting : to_map_) {
      if (waiting.frame && waiting.number <= number) return false;
    }
    return true;
  }

  std::shared_ptr<const TrackedKeyframe> keyframe() {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::int64_t number = mapOfNext();
    if (!hasMap(number)) throw std::logic_error("track() before map() of an earlier frame");
    while (keyframes_.size() > 1 && keyframes_[1].number <= number) keyframes_.pop_front();
    return keyframes_.empty() ? nullptr : keyframes_.front().keyframe;
  }

  PinholeCamera camera_;
  FrameTracker tracker_;   // used by track() alone
  KeyframeMapper mapper_;  // used by map() alone

  mutable std::mutex mutex_;  // of all that follows
  std::condition_variable changed_;
  std::int64_t next_frame_ = 0;
  std::int64_t start_ = -1;       // the last frame that started
  std::deque<ToMap> to_map_;      // by age
  bool is_mapping_ = false;       // the first of them
  std::deque<Mapped> keyframes_;  // by age
};

VisualOdometry::VisualOdometry(const PinholeCamera& camera, const OdometryOptions& options)
    : implementation_(std::make_unique<Implementation>(camera, options)) {}
VisualOdometry::~VisualOdometry() = default;

TrackingResult VisualOdometry::track(const RgbdFrame& frame) {
  return implementation_->track(frame);
}
std::shared_ptr<const KeyframeMap> VisualOdometry::map() {
  return implementation_->map();
}
void VisualOdometry::waitForMap() {
  implementation_->waitForMap();
}
bool VisualOdometry::isReady() const {
  return implementation_->isReady();
}
void VisualOdometry::waitForAllMaps() {
  implementation_->waitForAllMaps();
}
bool VisualOdometry::skipMap() {
  return implementation_->skipMap();
}
void VisualOdometry::reset() {
  implementation_->reset();
}
void VisualOdometry::setOptions(const OdometryOptions& options) {
  implementation_->setOptions(options);
}

}  // namespace rgbd_sfm_fusion
