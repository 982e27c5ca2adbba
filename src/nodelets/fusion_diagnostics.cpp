// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_diagnostics.h"

namespace rgbd_sfm_fusion {

using diagnostic_msgs::DiagnosticStatus;

FusionDiagnostics::FusionDiagnostics(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                                     CallbackGuard* guard, const std::string& name)
    : updater_(handle, private_handle, name) {
  updater_.setHardwareID("none");
  updater_.add("fusion", this, &FusionDiagnostics::report);
  ros::NodeHandle timer_handle(handle);
  timer_ = timer_handle.createWallTimer(
      ros::WallDuration(1.0),
      guard->forEvents<ros::WallTimerEvent>("diagnostics", [this] { updater_.force_update(); }));
}

void FusionDiagnostics::fused(const FusedFrame& fused, double delay) {
  scale_ = fused.scale;
  counts_ = fused.counts;
  delay_ = delay;
  failure_.clear();
  rate_.count();
}

void FusionDiagnostics::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  const double rate = rate_.look();
  if (!failure_.empty()) {
    status.summary(DiagnosticStatus::ERROR, failure_);
  } else if (rate <= 0.0) {
    status.summary(DiagnosticStatus::STALE, "no frames");
  } else if (!conditions_.empty()) {
    status.summary(DiagnosticStatus::WARN, conditions_.front());
  } else {
    status.summary(DiagnosticStatus::OK, "fusing");
  }
  status.add("rate [Hz]", rate);
  status.add("delay [s]", delay_);
  status.add("scale", scale_.alpha);
  status.add("scale standard deviation", scale_.sigma);
  status.add("scale fit refused", scale_.refused ? "yes" : "no");
  status.add("share sensor only", counts_.sensorOnlyShare());
  status.add("share SfM only", counts_.sfmOnlyShare());
  status.add("share fused", counts_.fusedShare());
  status.add("frames dropped", dropped_);
  status.add("frames given the sensor's depth alone", late_);
  for (const std::string& condition : conditions_) status.add("not met", condition);
}

}  // namespace rgbd_sfm_fusion
