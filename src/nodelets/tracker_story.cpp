// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "tracker_story.h"

#include <cmath>
#include <cstdlib>

#include "rgbd_sfm_fusion/odometry/self_calibration.h"

namespace rgbd_sfm_fusion {
namespace {

// A single frame that does not fit is found again at the next one, and not worth a line.
constexpr Stamp kUnremarkableLoss = 200'000'000;  // [ns]
// A tracker that is lost again and again is one story.
constexpr Stamp kUntilTheNextLoss = 10'000'000'000;  // [ns]

std::string inSeconds(Stamp duration) {
  const Stamp tenths = duration / 100'000'000;
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " s";
}

}  // namespace

std::optional<TrackerStory::Line> TrackerStory::tell(const TrackingResult& tracked, bool has_depth) {
  const std::optional<TrackingState> before = state_;
  state_ = tracked.state;
  if (tracked.state == TrackingState::kLost) return tellOfLoss(tracked.stamp);
  if (tracked.state == TrackingState::kInitialising) {
    if (before == state_) return std::nullopt;
    return Line{false, has_depth ? "waiting for an image with texture where the sensor measures depth"
                                 : "images come; waiting for depth to start from"};
  }
  const Stamp lost_since = lost_since_;
  lost_since_ = kNoStamp;
  if (!was_tracking_) {
    was_tracking_ = true;
    return Line{false, "tracking"};
  }
  if (!has_told_loss_) return tellOfCamera(tracked);
  has_told_loss_ = false;
  return Line{false, "tracking again after " + inSeconds(tracked.stamp - lost_since) +
                         (tracked.relocalised ? ": the pose has jumped" : "")};
}

std::optional<TrackerStory::Line> TrackerStory::tellOfLoss(Stamp stamp) {
  if (lost_since_ == kNoStamp) lost_since_ = stamp;
  if (has_told_loss_ || stamp - lost_since_ < kUnremarkableLoss) return std::nullopt;
  if (last_told_loss_ != kNoStamp && stamp - last_told_loss_ < kUntilTheNextLoss) return std::nullopt;
  has_told_loss_ = true;
  last_told_loss_ = stamp;
  return Line{true,
              "lost: no pose, and the sensor's depth alone, until the scene is recognised or tracking starts "
              "again"};
}

std::optional<TrackerStory::Line> TrackerStory::tellOfCamera(const TrackingResult& tracked) {
  if (const auto line = tellOfShutter(tracked)) return line;
  if (const auto line = tellOfCalibration(tracked)) return line;
  return tellOfDepthDelay(tracked);
}

std::optional<TrackerStory::Line> TrackerStory::tellOfShutter(const TrackingResult& tracked) {
  const bool is_learned = tracked.readout_sigma > 0.0 && tracked.readout_sigma < kKnownReadoutSigma;
  if (has_told_shutter_ || !is_learned) return std::nullopt;
  has_told_shutter_ = true;
  const long milliseconds = std::lround(1e3 * tracked.readout_time);
  return Line{false, milliseconds == 0 ? "the shutter is known: all rows are read at once"
                                       : "the shutter is known: an image is read in " +
                                             std::to_string(std::abs(milliseconds)) + " ms" +
                                             (milliseconds < 0 ? ", from its last row to its first" : "")};
}

std::optional<TrackerStory::Line> TrackerStory::tellOfCalibration(const TrackingResult& tracked) {
  const std::string remark = remarkOnCalibration(tracked);
  if (has_told_calibration_ || remark.empty()) return std::nullopt;
  has_told_calibration_ = true;
  return Line{true, remark};
}

std::optional<TrackerStory::Line> TrackerStory::tellOfDepthDelay(const TrackingResult& tracked) {
  const std::string remark = remarkOnDepthDelay(tracked);
  if (has_told_depth_delay_ || remark.empty()) return std::nullopt;
  has_told_depth_delay_ = true;
  return Line{false, remark};
}

}  // namespace rgbd_sfm_fusion
