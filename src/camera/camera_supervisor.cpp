// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/camera_supervisor.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace rgbd_sfm_fusion {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kPoll(50);  // unplugging, and new wishes while streaming, are seen this late
constexpr int kMaxGap = 1000;      // [frames] a larger gap is no loss: the device counts anew

steady_clock::duration seconds(double duration) {
  return std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(duration));
}

}  // namespace

CameraSupervisor::CameraSupervisor(const Options& options, const CameraSettings& settings,
                                   Callbacks callbacks)
    : options_(options), callbacks_(std::move(callbacks)), settings_(settings) {
  thread_ = std::thread([this] { run(); });
}

CameraSupervisor::~CameraSupervisor() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  change_.notify_all();
  thread_.join();
}

void CameraSupervisor::setWanted(const PerStream<bool>& wanted) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    wanted_ = wanted;
    status_.problem.clear();
  }
  change_.notify_all();
}

void CameraSupervisor::setSettings(const CameraSettings& settings) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    settings_ = settings;
    status_.problem.clear();
  }
  change_.notify_all();
}

CameraStatus CameraSupervisor::status() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return status_;
}

bool CameraSupervisor::isStopping() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return stopping_;
}

void CameraSupervisor::run() {
  double delay = options_.retry_delay;
  while (!isStopping()) {
    const std::uint64_t changes = library_ ? library_->changes() : 0;
    has_delivered_ = false;
    try {
      runSession();
    } catch (const std::exception& error) {  // whatever goes wrong with one device, the next may work
      report(Severity::kError, error.what());
    }
    const bool has_changed = library_ && library_->changes() != changes;
    if (has_delivered_ || has_changed) delay = options_.retry_delay;
    waitBeforeRetry(delay, changes);
    delay = std::min(2.0 * delay, options_.max_retry_delay);
  }
  library_.reset();
}

/// Opens the device and serves it until it is lost, or nobody needs it any more.
void CameraSupervisor::runSession() {
  if (!library_) library_ = OpenNiLibrary::acquire();
  CameraSession session(openCamera(library_, options_.device_id), options_.session,
                        [this](const std::string& problem) { report(Severity::kWarning, problem); });
  last_index_ = {};
  callbacks_.opened(session.description());
  callbacks_.say(Severity::kInfo, "opened " + session.description().name + " (" + session.description().uri +
                                      ", serial " + session.description().serial + ")");
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++status_.connections;
    status_.device = session.description();
    status_.problem.clear();
  }
  last_problem_.clear();
  while (true) {
    PerStream<bool> wanted;
    CameraSettings settings;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (stopping_) return;
      wanted = wanted_;
      settings = settings_;
    }
    if (!settings.frame_sync) frame_sync_failed_ = false;  // when it is switched on again, it is tried again
    settings.frame_sync = settings.frame_sync && !frame_sync_failed_;
    session.update(wanted, settings);
    updateStatus(session);
    if (session.isStreaming()) {
      if (const auto frame = session.read(kPoll)) deliver(*frame);
    } else {
      std::unique_lock<std::mutex> lock(mutex_);
      change_.wait_for(lock, kPoll);
    }
  }
}

void CameraSupervisor::deliver(const CameraFrame& frame) {
  has_delivered_ = true;
  const int gap = frame.index - last_index_[frame.stream];
  const bool counts = last_index_[frame.stream] > 0 && gap > 1 && gap < kMaxGap;
  last_index_[frame.stream] = frame.index;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    CameraStatus::Stream& stream = status_.streams[frame.stream];
    ++stream.frames;
    if (counts) stream.dropped += static_cast<std::uint64_t>(gap - 1);
  }
  callbacks_.frame(frame);
}

void CameraSupervisor::updateStatus(const CameraSession& session) {
  if (session.hasFrameSyncFailed()) frame_sync_failed_ = true;
  const std::lock_guard<std::mutex> lock(mutex_);
  status_.state = session.isStreaming() ? CameraStatus::State::kStreaming : CameraStatus::State::kReady;
  for (const StreamKind stream : kAllStreams) status_.streams[stream].running = session.isRunning(stream);
}

/// Returns earlier when a device comes or goes.
void CameraSupervisor::waitBeforeRetry(double delay, std::uint64_t changes_before) {
  const auto end = steady_clock::now() + seconds(delay);
  std::unique_lock<std::mutex> lock(mutex_);
  status_.state = CameraStatus::State::kWaiting;
  for (const StreamKind stream : kAllStreams) status_.streams[stream].running = false;
  const auto has_changed = [&] { return library_ && library_->changes() != changes_before; };
  while (!stopping_ && !has_changed() && steady_clock::now() < end) change_.wait_for(lock, kPoll);
}

/// Reports a problem once, and from time to time while it lasts.
void CameraSupervisor::report(Severity severity, const std::string& problem) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    status_.problem = problem;
  }
  const auto now = steady_clock::now();
  if (problem == last_problem_ && now - last_said_ < seconds(options_.repeat_after)) return;
  last_problem_ = problem;
  last_said_ = now;
  callbacks_.say(severity, problem);
}

}  // namespace rgbd_sfm_fusion
