// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "tracker_diagnostics.h"

namespace rgbd_sfm_fusion {
namespace {

using diagnostic_msgs::DiagnosticStatus;

}  // namespace

TrackerDiagnostics::TrackerDiagnostics(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                                       CallbackGuard* guard, const std::string& name)
    : updater_(handle, private_handle, name) {
  updater_.setHardwareID("none");
  updater_.add("tracking", this, &TrackerDiagnostics::report);
  ros::NodeHandle timer_handle(handle);
  timer_ = timer_handle.createWallTimer(
      ros::WallDuration(1.0),
      guard->forEvents<ros::WallTimerEvent>("diagnostics", [this] { updater_.force_update(); }));
}

void TrackerDiagnostics::tracked(const TrackingResult& tracked, double delay) {
  const std::lock_guard<std::mutex> lock(mutex_);
  last_ = tracked;
  delay_ = delay;
  failure_.clear();
  rate_.count();
}

void TrackerDiagnostics::dropped() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++dropped_;
}

void TrackerDiagnostics::skippedMappings(std::size_t count) {
  const std::lock_guard<std::mutex> lock(mutex_);
  skipped_mappings_ += count;
}

void TrackerDiagnostics::failed(const std::string& reason) {
  const std::lock_guard<std::mutex> lock(mutex_);
  failure_ = reason;
}

void TrackerDiagnostics::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double rate = rate_.look();
  if (!failure_.empty()) {
    status.summary(DiagnosticStatus::ERROR, failure_);
  } else if (rate <= 0.0) {
    status.summary(DiagnosticStatus::STALE, "no images");
  } else {
    const bool tracking = last_.state == TrackingState::kTracking;
    status.summary(tracking ? DiagnosticStatus::OK : DiagnosticStatus::WARN, toText(last_.state));
  }
  status.add("rate [Hz]", rate);
  status.add("delay [s]", delay_);
  status.add("state", toText(last_.state));
  status.add("share of good points", last_.share_of_good_points);
  status.add("share of the image that stays in place", last_.share_fixed_in_view);
  status.add("depth older than its stamp by [ms]", 1e3 * last_.depth_delay);
  status.add("frames dropped", dropped_);
  status.add("frames tracked, but not mapped", skipped_mappings_);
}

}  // namespace rgbd_sfm_fusion
