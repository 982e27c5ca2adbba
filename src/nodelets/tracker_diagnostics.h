// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>

#include <cstddef>
#include <mutex>
#include <string>

#include "callback_guard.h"
#include "rate_counter.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

namespace rgbd_sfm_fusion {

/// /diagnostics of the tracker, once a second of wall time.
class TrackerDiagnostics {
 public:
  TrackerDiagnostics(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                     CallbackGuard* guard, const std::string& name);

  /// @param delay  [s] of publishing after the colour image's stamp
  void tracked(const TrackingResult& tracked, double delay);
  void dropped();
  void skippedMappings(std::size_t count);
  void failed(const std::string& reason);

 private:
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

  std::mutex mutex_;
  TrackingResult last_;
  double delay_ = 0.0;
  std::size_t dropped_ = 0, skipped_mappings_ = 0;
  std::string failure_;
  RateCounter rate_;
  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};

}  // namespace rgbd_sfm_fusion
