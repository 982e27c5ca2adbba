// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <vector>

#include "rgbd_sfm_fusion/ros/fusion_messages.h"

namespace rgbd_sfm_fusion {

/// All topics of fusion. Messages that nobody wants are not made.
class FusionPublisher {
 public:
  explicit FusionPublisher(const ros::NodeHandle& private_handle);

  /// @param header       of the colour image
  /// @param depth_stamp  of the depth image that was used, or kNoStamp
  void publish(const std_msgs::Header& header, const FusedFrame& fused, const PinholeCamera& camera,
               Stamp depth_stamp);

  /// Starts the shares since start anew.
  void restart() { totals_ = {}; }

 private:
  std::vector<ros::Publisher> images_;  ///< in the order of fusionImageTopics()
  ros::Publisher camera_info_;
  ros::Publisher scale_;
  ros::Publisher statistics_;
  FusionTotals totals_;
};

}  // namespace rgbd_sfm_fusion
