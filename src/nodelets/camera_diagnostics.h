// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>

#include <functional>
#include <mutex>
#include <string>

#include "callback_guard.h"
#include "rate_counter.h"
#include "rgbd_sfm_fusion/camera/camera_supervisor.h"

namespace rgbd_sfm_fusion {

/// /diagnostics of the camera, once a second of wall time.
class CameraDiagnostics {
 public:
  CameraDiagnostics(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                    CallbackGuard* guard, const std::string& name, std::function<CameraStatus()> status);

  /// @param delay  [s] of publishing after the stamp
  void published(StreamKind stream, double delay);

 private:
  struct Stream {
    RateCounter rate;
    double delay = 0.0;
  };

  void report(diagnostic_updater::DiagnosticStatusWrapper& message);

  std::function<CameraStatus()> status_;
  std::mutex mutex_;
  PerStream<Stream> streams_;
  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};

}  // namespace rgbd_sfm_fusion
