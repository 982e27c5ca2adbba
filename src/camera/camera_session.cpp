// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/camera_session.h"

#include <algorithm>
#include <utility>

namespace rgbd_sfm_fusion {
namespace {

using Clock = std::chrono::steady_clock;

Clock::duration seconds(double duration) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(duration));
}

Stamp hostTime() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

CameraSession::CameraSession(std::unique_ptr<CameraDevice> device, const Options& options, Report report)
    : device_(std::move(device)), options_(options), report_(std::move(report)) {}

bool CameraSession::isStreaming() const {
  return std::any_of(kAllStreams.begin(), kAllStreams.end(),
                     [this](StreamKind stream) { return device_->isRunning(stream); });
}

void CameraSession::update(const PerStream<bool>& wanted, const CameraSettings& settings) {
  if (device_->isLost()) throw CameraError("device " + description().uri + " was unplugged");
  if (!(settings == settings_)) settings_are_new_ = true;
  settings_ = settings;
  if (reconcileStreams(wanted, settings)) settings_are_new_ = true;
  if (!settings_are_new_ || !isStreaming()) return;
  applySettings(settings);
  settings_are_new_ = false;
}

/// @return whether any was started or stopped
bool CameraSession::reconcileStreams(const PerStream<bool>& wanted, const CameraSettings& settings) {
  bool changed = false;
  for (const StreamKind stream : kAllStreams) {
    const bool stays = wanted[stream] && running_modes_[stream] == chooseMode(stream, settings);
    if (!device_->isRunning(stream) || stays) continue;
    device_->stop(stream);
    changed = true;
  }
  for (const StreamKind stream : kAllStreams) {
    const bool is_due = Clock::now() >= streams_[stream].next_try;
    if (wanted[stream] && !device_->isRunning(stream) && is_due) changed |= start(stream, settings);
  }
  return changed;
}

bool CameraSession::start(StreamKind stream, const CameraSettings& settings) {
  StreamState& state = streams_[stream];
  try {
    const StreamMode mode = chooseMode(stream, settings);
    device_->start(stream, mode);
    running_modes_[stream] = mode;
    state = {false, Clock::now(), {}};
    return true;
  } catch (const CameraError& error) {
    if (!isStreaming()) throw;  // opening the device anew may help
    state.next_try = Clock::now() + seconds(options_.restart_delay);
    report_(error.what());
    return false;
  }
}

StreamMode CameraSession::chooseMode(StreamKind stream, const CameraSettings& settings) const {
  const std::vector<StreamMode>& modes = description().modes[stream];
  for (const StreamMode& mode : {settings.modes[stream], StreamMode()}) {
    if (std::find(modes.begin(), modes.end(), mode) != modes.end()) return mode;
  }
  return modes.empty() ? settings.modes[stream] : modes.front();
}

void CameraSession::applySettings(const CameraSettings& settings) {
  attempt([&] { device_->setRegistration(settings.registration); });
  for (const StreamKind stream : kAllStreams) {
    if (!device_->isRunning(stream)) continue;
    attempt([&] { device_->setMirror(stream, settings.mirror); });
    if (running_modes_[stream] != settings.modes[stream]) reportMode(stream, settings.modes[stream]);
  }
  if (device_->isRunning(StreamKind::kColour)) attempt([&] { device_->setExposure(settings); });
  applyFrameSync(settings);
}

void CameraSession::reportMode(StreamKind stream, const StreamMode& wanted) const {
  report_(std::string(toText(stream)) + " has no mode " + toText(wanted) + ", but " +
          toText(description().modes[stream]) + "; " + toText(running_modes_[stream]) + " is used");
}

/// Waits until both streams deliver: before, a slow start cannot be told from frames that do not pair.
void CameraSession::applyFrameSync(const CameraSettings& settings) {
  const auto delivers = [this](StreamKind stream) {
    return device_->isRunning(stream) && streams_[stream].has_delivered;
  };
  const bool on = settings.frame_sync && delivers(StreamKind::kColour) && delivers(StreamKind::kDepth);
  if (sync_ == Sync::kFailed && on) return;
  const bool worked = sync_ == Sync::kWorks;
  sync_ = Sync::kOff;
  attempt([&] {
    device_->setFrameSync(on);
    if (on) sync_ = worked ? Sync::kWorks : Sync::kWaiting;
    sync_start_ = Clock::now();
  });
}

std::optional<CameraFrame> CameraSession::read(std::chrono::milliseconds timeout) {
  checkStalls();
  std::optional<CameraFrame> frame = device_->read(timeout);
  if (!frame) return frame;
  frame->stamp = clock_.toHost(frame->device_time, hostTime());
  StreamState& state = streams_[frame->stream];
  if (!state.has_delivered) settings_are_new_ = true;  // some devices ignore settings until they stream
  if (sync_ == Sync::kWaiting && frame->stream != StreamKind::kInfrared) sync_ = Sync::kWorks;
  state.last_frame = Clock::now();
  state.has_delivered = true;
  return frame;
}

void CameraSession::checkStalls() {
  const Time now = Clock::now();
  if (sync_ == Sync::kWaiting && now - sync_start_ > seconds(options_.sync_timeout)) {
    report_("colour and depth do not come as pairs: frame sync is switched off");
    attempt([&] { device_->setFrameSync(false); });
    sync_ = Sync::kFailed;
  }
  for (const StreamKind stream : kAllStreams) {
    const StreamState& state = streams_[stream];
    const double limit = state.has_delivered ? options_.stall_timeout : options_.start_timeout;
    if (!device_->isRunning(stream) || now - state.last_frame <= seconds(limit)) continue;
    throw CameraError(
        cv::format("%s has delivered nothing for %.1f s: the device is opened anew", toText(stream), limit));
  }
}

/// If a setting is refused, everything else still works.
void CameraSession::attempt(const std::function<void()>& setting) const {
  try {
    setting();
  } catch (const CameraError& error) {
    report_(error.what());
  }
}

}  // namespace rgbd_sfm_fusion
