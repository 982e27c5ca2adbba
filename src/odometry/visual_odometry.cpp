// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

#include <memory>
#include <mutex>
#include <utility>

#include "rgbd_sfm_fusion/odometry/frame_tracker.h"
#include "rgbd_sfm_fusion/odometry/hand_over.h"
#include "rgbd_sfm_fusion/odometry/keyframe_mapper.h"

namespace rgbd_sfm_fusion {
namespace {

const OdometryOptions& checked(const OdometryOptions& options, const PinholeCamera& camera) {
  validate(options, camera);
  return options;
}

}  // namespace

/// The tracker, the mapper, and what they hand to each other.
struct VisualOdometry::Parts {
  PinholeCamera camera;
  FrameTracker tracker;  // used by the tracking thread
  // Held during map(), so that nothing is forgotten meanwhile. Taken before the hand-over's.
  std::mutex mapping_mutex;
  KeyframeMapper mapper;
  HandOver hand_over;
};

VisualOdometry::VisualOdometry(const PinholeCamera& camera, const OdometryOptions& options)
    : parts_(new Parts{camera, {camera, checked(options, camera)}, {}, KeyframeMapper(camera), {}}) {}
VisualOdometry::~VisualOdometry() = default;

TrackingResult VisualOdometry::track(const RgbdFrame& frame) {
  FrameTracker::Result result = parts_->tracker.track(frame, parts_->hand_over.keyframeFor(frame.stamp));
  parts_->hand_over.addTracked(frame.stamp, std::move(result.to_map));
  return result.tracked;
}

std::shared_ptr<const KeyframeMap> VisualOdometry::map(const OnMap& on_map) {
  const std::lock_guard<std::mutex> only_one(parts_->mapping_mutex);
  HandOver& hand_over = parts_->hand_over;
  const std::shared_ptr<const FrameToMap> frame = hand_over.oldest();
  if (!frame) return nullptr;
  // Whatever happens, the frame does not wait any more afterwards.
  struct Done {
    HandOver* hand_over;
    ~Done() { hand_over->done(); }
  };
  const Done done{&hand_over};
  if (!hand_over.mappedWithoutStereo(parts_->mapper.mapWithoutStereo(*frame))) return nullptr;
  KeyframeMapper::Result result = parts_->mapper.mapByStereo(*frame, hand_over.isAwaited());
  if (on_map) on_map(result.map);
  hand_over.mappedByStereo(std::move(result.to_track));
  return result.map;
}

void VisualOdometry::reset() {
  const std::lock_guard<std::mutex> only_one(parts_->mapping_mutex);
  parts_->tracker.reset();
  parts_->hand_over.forgetMaps();
}

void VisualOdometry::setOptions(const OdometryOptions& options) {
  validate(options, parts_->camera);
  const std::lock_guard<std::mutex> only_one(parts_->mapping_mutex);
  if (parts_->tracker.setOptions(options)) parts_->hand_over.forgetMaps();
}

void VisualOdometry::waitForMap(Stamp stamp) {
  parts_->hand_over.waitForMap(stamp);
}
bool VisualOdometry::waitForMap(Stamp stamp, double seconds) {
  return parts_->hand_over.waitForMap(stamp, seconds);
}
void VisualOdometry::waitForAllMaps() {
  parts_->hand_over.waitForAllMaps();
}
void VisualOdometry::waitForKeyframe() {
  parts_->hand_over.waitForKeyframe();
}
std::size_t VisualOdometry::skipMaps() {
  return parts_->hand_over.skipMaps();
}

}  // namespace rgbd_sfm_fusion
