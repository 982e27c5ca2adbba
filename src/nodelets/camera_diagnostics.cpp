// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "camera_diagnostics.h"

#include <utility>

namespace rgbd_sfm_fusion {
namespace {

using diagnostic_msgs::DiagnosticStatus;

void summarise(const CameraStatus& status, diagnostic_updater::DiagnosticStatusWrapper* message) {
  switch (status.state) {
    case CameraStatus::State::kWaiting:
      message->summary(DiagnosticStatus::ERROR,
                       status.problem.empty() ? "looking for the device" : status.problem);
      return;
    case CameraStatus::State::kReady:
      message->summary(DiagnosticStatus::OK, "ready; nobody subscribes");
      return;
    default:
      message->summary(status.problem.empty() ? DiagnosticStatus::OK : DiagnosticStatus::WARN,
                       status.problem.empty() ? "streaming" : status.problem);
  }
}

}  // namespace

CameraDiagnostics::CameraDiagnostics(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                                     CallbackGuard* guard, const std::string& name,
                                     std::function<CameraStatus()> status)
    : status_(std::move(status)), updater_(handle, private_handle, name) {
  updater_.setHardwareID("none");
  updater_.add("camera", this, &CameraDiagnostics::report);
  ros::NodeHandle timer_handle(handle);
  timer_ = timer_handle.createWallTimer(
      ros::WallDuration(1.0),
      guard->forEvents<ros::WallTimerEvent>("diagnostics", [this] { updater_.force_update(); }));
}

void CameraDiagnostics::published(StreamKind stream, double delay) {
  const std::lock_guard<std::mutex> lock(mutex_);
  streams_[stream].rate.count();
  streams_[stream].delay = delay;
}

void CameraDiagnostics::report(diagnostic_updater::DiagnosticStatusWrapper& message) {
  const CameraStatus status = status_();
  updater_.setHardwareID(status.device.serial.empty() ? "none" : status.device.serial);
  summarise(status, &message);
  message.add("device", status.device.name);
  message.add("URI", status.device.uri);
  message.add("serial number", status.device.serial);
  message.add("connections", status.connections);
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const StreamKind kind : kAllStreams) {
    const std::string name = toText(kind);
    const double rate = streams_[kind].rate.look();
    if (!status.streams[kind].running) continue;
    message.add(name + " rate [Hz]", rate);
    message.add(name + " delay [s]", streams_[kind].delay);
    message.add(name + " frames dropped", status.streams[kind].dropped);
  }
}

}  // namespace rgbd_sfm_fusion
