// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

#include <memory>
#include <utility>

#include "rgbd_sfm_fusion/odometry/frame_tracker.h"
#include "rgbd_sfm_fusion/odometry/keyframe_mapper.h"

namespace rgbd_sfm_fusion {
namespace {

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

/// Hands tracked frames to mapping, and keyframes back to tracking.
class VisualOdometry::Implementation {
 public:
  Implementation(const PinholeCamera& camera, const OdometryOptions& options)
      : camera_(camera), tracker_(camera, checked(options, camera)), mapper_(camera) {}

  TrackingResult track(const RgbdFrame& frame) {
    FrameTracker::Result result = tracker_.track(frame, keyframe_);
    to_map_ = std::move(result.to_map);
    return result.tracked;
  }

  std::shared_ptr<const KeyframeMap> map() {
    if (!to_map_) return nullptr;
    KeyframeMapper::Result result = mapper_.map(*to_map_);
    to_map_.reset();
    keyframe_ = std::move(result.tracking);
    return result.published;
  }

  void reset() {
    tracker_.reset();
    to_map_.reset();
    keyframe_.reset();
  }

  void setOptions(const OdometryOptions& options) {
    if (!tracker_.setOptions(checked(options, camera_))) return;
    to_map_.reset();
    keyframe_.reset();
  }

 private:
  PinholeCamera camera_;
  FrameTracker tracker_;
  KeyframeMapper mapper_;
  std::shared_ptr<const FrameToMap> to_map_;         // null: nothing is to be mapped
  std::shared_ptr<const TrackedKeyframe> keyframe_;  // as of the last mapping; null: none
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
void VisualOdometry::reset() {
  implementation_->reset();
}
void VisualOdometry::setOptions(const OdometryOptions& options) {
  implementation_->setOptions(options);
}

}  // namespace rgbd_sfm_fusion
