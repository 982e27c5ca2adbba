// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <std_msgs/Header.h>

#include <atomic>
#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/odometry/keyframe_map.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"

namespace rgbd_sfm_fusion {

/// ~keyframe, for fusion: after every refinement while somebody in this process listens, which costs a
/// pointer; at `rate` to others, which costs 2.4 MB. And ~keyframe/…, for people, at that rate.
class KeyframePublisher {
 public:
  /// What goes out with a keyframe, as of the frame that has refined it.
  struct Context {
    std_msgs::Header header;  ///< of the colour image
    PinholeCamera camera;     ///< as published in camera_info
    std::uint32_t run = 0;    ///< of TrackedFrame
    OdomPlace odom;
    bool is_odom_foreign = false;  ///< somebody else has a frame of odom's name
  };

  explicit KeyframePublisher(const ros::NodeHandle& private_handle);

  void publish(const KeyframeMap& keyframe, const Context& context);

  /// [Hz]; to be called from any thread
  void setRate(double rate) { rate_ = rate; }

 private:
  bool isDue(const KeyframeMap& keyframe);
  void publishForPeople(const std_msgs::Header& header, const KeyframeMap& keyframe, const Context& context);

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
