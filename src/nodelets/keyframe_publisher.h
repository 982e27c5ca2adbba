// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <atomic>
#include <vector>

#include "odom_frame.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

namespace rgbd_sfm_fusion {

/// ~keyframe, for fusion: after every refinement while somebody in this process listens, which costs a
/// pointer; at `rate` to others, which costs 2.4 MB. And ~keyframe/…, for people, at that rate.
class KeyframePublisher {
 public:
  explicit KeyframePublisher(const ros::NodeHandle& private_handle);

  /// @param header  of the colour image of any frame
  /// @param camera  as published in camera_info
  /// @param run     of TrackedFrame
  void publish(const std_msgs::Header& header, const PinholeCamera& camera, const KeyframeMap& keyframe,
               std::uint32_t run, const OdomFrame& odom);

  /// [Hz]; to be called from any thread
  void setRate(double rate) { rate_ = rate; }

 private:
  bool isDue(const KeyframeMap& keyframe);
  void publishForPeople(const std_msgs::Header& header, const PinholeCamera& camera,
                        const KeyframeMap& keyframe, const OdomFrame& odom);

  std::atomic<double> rate_{1.0};
  std::atomic<int> local_subscribers_{0};
  ros::Publisher keyframe_;
  std::vector<ros::Publisher> images_;  ///< in the order of keyframeImageTopics()
  ros::Publisher camera_info_;
  ros::Publisher pose_;
  Stamp last_keyframe_ = kNoStamp;
  ros::WallTime last_time_;
};

}  // namespace rgbd_sfm_fusion
