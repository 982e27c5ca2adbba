// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_inputs.h"

#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kPatience = 1.0;       // [s] that a frame waits
constexpr std::size_t kMostDepth = 60;  // two seconds
constexpr std::size_t kMostKeyframes = 30;

}  // namespace

bool FusionInputs::pushTracked(const TrackedFrameConstPtr& tracked, const ros::Time& now) {
  waiting_.push_back({tracked, now});
  if (waiting_.size() <= queue_size_) return false;
  waiting_.pop_front();
  return true;
}

void FusionInputs::pushKeyframe(const KeyframeConstPtr& keyframe) {
  keyframes_.push_back(keyframe);
  if (keyframes_.size() > kMostKeyframes) keyframes_.pop_front();
}

void FusionInputs::pushDepth(const sensor_msgs::ImageConstPtr& depth) {
  depth_.push_back(depth);
  if (depth_.size() > kMostDepth) depth_.pop_front();
}

std::optional<FusionInputs::Frame> FusionInputs::pop(const ros::Time& now) {
  if (waiting_.empty()) return std::nullopt;
  const TrackedFrameConstPtr tracked = waiting_.front().tracked;
  const bool needs_depth = !tracked->depth_stamp.isZero();
  const bool needs_keyframe = tracked->state == TrackedFrame::TRACKING;
  Frame frame{tracked,
              needs_depth ? findDepth(tracked->depth_stamp) : nullptr,
              needs_keyframe ? findKeyframe(*tracked) : nullptr,
              colour_.find(tracked->header.stamp),
              "",
              nearestDepth(tracked->header.stamp)};
  if (needs_depth && !frame.depth) frame.missing = "its depth image";
  if (needs_keyframe && !frame.keyframe)
    frame.missing += frame.missing.empty() ? "its keyframe" : " and keyframe";
  const bool waits_for_colour = !frame.colour && !colour_.empty() && colour_.mayCome(tracked->header.stamp);
  if (waits_for_colour) frame.missing += frame.missing.empty() ? "its colour image" : " and its colour image";
  const double waited = secondsBetween(waiting_.front().since, now);
  // After the clock has gone back, a frame waits in vain.
  if (!frame.missing.empty() && waited >= 0.0 && waited < kPatience) return std::nullopt;
  waiting_.pop_front();
  forgetOlderThan(*tracked);
  return frame;
}

sensor_msgs::ImageConstPtr FusionInputs::findDepth(const ros::Time& stamp) const {
  const auto found = std::find_if(depth_.begin(), depth_.end(),
                                  [&](const auto& depth) { return depth->header.stamp == stamp; });
  return found == depth_.end() ? nullptr : *found;
}

ros::Time FusionInputs::nearestDepth(const ros::Time& stamp) const {
  ros::Time nearest;
  const auto distance = [&](const ros::Time& time) { return std::abs(secondsBetween(stamp, time)); };
  for (const auto& depth : depth_) {
    if (nearest.isZero() || distance(depth->header.stamp) < distance(nearest)) nearest = depth->header.stamp;
  }
  return nearest;
}

/// The newest revision up to the named one; if there is none, the first after it.
KeyframeConstPtr FusionInputs::findKeyframe(const TrackedFrame& tracked) const {
  KeyframeConstPtr best;
  for (const KeyframeConstPtr& keyframe : keyframes_) {
    if (keyframe->run != tracked.run || keyframe->header.stamp != tracked.keyframe_stamp) continue;
    const bool later = keyframe->revision > tracked.keyframe_revision;
    if (!best || (!later && keyframe->revision >= best->revision)) best = keyframe;
  }
  return best;
}

/// Frames to come may name later depth images, this one once more, and later revisions of this keyframe.
void FusionInputs::forgetOlderThan(const TrackedFrame& tracked) {
  colour_.keepFrom(tracked.header.stamp);
  forgetBefore(tracked.depth_stamp, 0, &depth_);
  const auto isOld = [&](const Keyframe& keyframe) {
    return keyframe.run != tracked.run || keyframe.header.stamp < tracked.keyframe_stamp ||
           (keyframe.header.stamp == tracked.keyframe_stamp &&
            keyframe.revision <= tracked.keyframe_revision);
  };
  while (keyframes_.size() > 1 && isOld(*keyframes_[0]) && isOld(*keyframes_[1])) keyframes_.pop_front();
}

}  // namespace rgbd_sfm_fusion
