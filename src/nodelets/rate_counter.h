// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <cstddef>

namespace rgbd_sfm_fusion {

/// Events per second of wall time between two looks.
class RateCounter {
 public:
  void count() { ++events_; }

  double look() {
    const ros::WallTime now = ros::WallTime::now();
    const double seconds = (now - last_).toSec();
    const double rate = seconds > 0.0 ? static_cast<double>(events_) / seconds : 0.0;
    events_ = 0;
    last_ = now;
    return rate;
  }

 private:
  std::size_t events_ = 0;
  ros::WallTime last_ = ros::WallTime::now();
};

}  // namespace rgbd_sfm_fusion
