// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

namespace rgbd_sfm_fusion {

/// Tells the tracker's states in lines for the log: one line for each change.
class TrackerStory {
 public:
  struct Line {
    bool is_warning;
    std::string text;
  };

  /// @param has_depth  whether sensor depth belongs to the frame
  /// @return nothing where there is nothing new to tell
  std::optional<Line> tell(const TrackingResult& tracked, bool has_depth);

  /// All starts anew: the next frame is the first.
  void restart() { *this = TrackerStory(); }

 private:
  std::optional<Line> tellOfLoss(Stamp stamp);
  std::optional<Line> tellOfCamera(const TrackingResult& tracked);
  std::optional<Line> tellOfShutter(const TrackingResult& tracked);
  std::optional<Line> tellOfCalibration(const TrackingResult& tracked);
  std::optional<Line> tellOfDepthDelay(const TrackingResult& tracked);

  std::optional<TrackingState> state_;
  bool was_tracking_ = false;    ///< ever
  Stamp lost_since_ = kNoStamp;  ///< kNoStamp: it is not lost
  bool has_told_loss_ = false;
  Stamp last_told_loss_ = kNoStamp;
  bool has_told_shutter_ = false, has_told_calibration_ = false, has_told_depth_delay_ = false;
};

}  // namespace rgbd_sfm_fusion
