// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>

#include <string>
#include <utility>
#include <vector>

#include "callback_guard.h"
#include "rate_counter.h"
#include "rgbd_sfm_fusion/fusion/depth_fusion.h"

namespace rgbd_sfm_fusion {

/// /diagnostics of fusion, once a second of wall time. Used by one thread.
class FusionDiagnostics {
 public:
  FusionDiagnostics(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                    CallbackGuard* guard, const std::string& name);

  /// @param delay  [s] of publishing after the colour image's stamp
  void fused(const FusedFrame& fused, double delay);
  void dropped() { ++dropped_; }
  /// A frame got the sensor's depth alone, because a newer one waited.
  void late() { ++late_; }
  void failed(const std::string& reason) { failure_ = reason; }
  /// Sentences about conditions that were not met in the last seconds.
  void setConditions(std::vector<std::string> sentences) { conditions_ = std::move(sentences); }

 private:
  void report(diagnostic_updater::DiagnosticStatusWrapper& status);

  ScaleEstimate scale_;
  ProvenanceCounts counts_;
  double delay_ = 0.0;
  std::size_t dropped_ = 0, late_ = 0;
  std::string failure_;
  std::vector<std::string> conditions_;
  RateCounter rate_;
  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};

}  // namespace rgbd_sfm_fusion
