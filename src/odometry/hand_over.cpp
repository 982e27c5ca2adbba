// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/hand_over.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace rgbd_sfm_fusion {
namespace {

// A frame is tracked against the map as of so many frames before, so that mapping has more than a frame's
// time at 30 Hz.
constexpr std::int64_t kMapLag = 2;

}  // namespace

std::shared_ptr<const KeyframeToTrack> HandOver::keyframeFor(Stamp stamp) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!lastKeyframeIsReady())
    throw std::logic_error("track() before map() of the frame that became the keyframe");
  const std::int64_t map_number = mapNumberFor(stamp);
  while (keyframes_.size() > 1 && keyframes_[1].map_number <= map_number)
    keyframes_.erase(keyframes_.begin());
  return keyframes_.empty() ? nullptr : keyframes_.front().keyframe;
}

void HandOver::addTracked(Stamp stamp, std::shared_ptr<const FrameToMap> frame) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool is_awaited = mapNumberFor(stamp) > next_number_ - kMapLag;
  if (frame && frame->use == FrameToMap::Use::kStarts) last_start_ = next_number_;
  if (frame) waiting_.push_back({next_number_, std::move(frame), is_awaited});
  ++next_number_;
  last_stamp_ = stamp;
}

std::shared_ptr<const FrameToMap> HandOver::oldest() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return waiting_.empty() ? nullptr : waiting_.front().frame;
}

bool HandOver::isAwaited() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return waiting_.front().is_awaited;
}

bool HandOver::mappedWithoutStereo(std::shared_ptr<const KeyframeToTrack> keyframe) {
  const std::lock_guard<std::mutex> lock(mutex_);
  WaitingFrame& oldest = waiting_.front();
  // As if of the frame before, so that the next frame gets it.
  if (keyframe) keyframes_.push_back({oldest.number - 1, std::move(keyframe)});
  oldest.is_mapped_without_stereo = true;
  changed_.notify_all();
  return !oldest.is_skipped;
}

void HandOver::mappedByStereo(std::shared_ptr<const KeyframeToTrack> keyframe) {
  const std::lock_guard<std::mutex> lock(mutex_);
  keyframes_.push_back({waiting_.front().number, std::move(keyframe)});
}

void HandOver::done() {
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_.erase(waiting_.begin());
  changed_.notify_all();
}

void HandOver::waitForMap(Stamp stamp) {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [&] { return isReadyFor(stamp); });
}

bool HandOver::waitForMap(Stamp stamp, double seconds) {
  std::unique_lock<std::mutex> lock(mutex_);
  return changed_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return isReadyFor(stamp); });
}

void HandOver::waitForAllMaps() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [&] { return waiting_.empty(); });
}

void HandOver::waitForKeyframe() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [&] { return lastKeyframeIsReady(); });
}

std::size_t HandOver::skipMaps() {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::size_t skipped = 0;
  for (WaitingFrame& waiting : waiting_) {
    if (waiting.is_mapped_without_stereo || waiting.is_skipped || waiting.isKeyframe()) continue;
    waiting.is_skipped = true;
    ++skipped;
  }
  changed_.notify_all();
  return skipped;
}

void HandOver::forgetMaps() {
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_.clear();
  keyframes_.clear();
  last_start_.reset();
  changed_.notify_all();
}

/// The number of the frame whose map the next frame is tracked against. That of the frame before, if there
/// was time for it since: at 16 Hz and less, where the camera moves far from frame to frame. And after a
/// start, until the keyframe has had enough views: the map has little but sensor depth then, and each frame
/// adds much to it, for which tracking waits. Where the sensor sees near surfaces only, turns would be taken
/// for moves, and stereo would keep what it learned from them.
std::int64_t HandOver::mapNumberFor(Stamp stamp) const {
  const bool is_young = last_start_ && next_number_ - *last_start_ <= kEnoughViews;
  const bool had_time = toSeconds(stamp - last_stamp_) > Step::kShort;
  return next_number_ - (is_young || had_time ? 1 : kMapLag);
}

bool HandOver::isReadyFor(Stamp stamp) const {
  return std::all_of(waiting_.begin(), waiting_.end(),
                     [map_number = mapNumberFor(stamp)](const WaitingFrame& waiting) {
                       return waiting.is_mapped_without_stereo && waiting.number > map_number;
                     });
}

/// False: the last frame that becomes the keyframe was not mapped without stereo yet, and the next frame is
/// relative to it.
bool HandOver::lastKeyframeIsReady() const {
  return std::all_of(waiting_.begin(), waiting_.end(), [](const WaitingFrame& waiting) {
    return waiting.is_mapped_without_stereo || !waiting.isKeyframe();
  });
}

}  // namespace rgbd_sfm_fusion
