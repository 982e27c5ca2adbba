// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include "fusion_output.h"

namespace rgbd_sfm_fusion {

/// What rviz shows in 3D, as few points as it needs, in the legend's colours: what the sensor sees
/// (`points_sensor`), what was added (`points_added`), and the camera (`frustum`).
class DisplayPublisher {
 public:
  explicit DisplayPublisher(const ros::NodeHandle& private_handle);

  void publish(const FusionOutput& output);

 private:
  ros::Publisher sensor_;
  ros::Publisher added_;
  ros::Publisher frustum_;
};

}  // namespace rgbd_sfm_fusion
