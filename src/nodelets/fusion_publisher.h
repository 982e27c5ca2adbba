// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <map>
#include <string>

#include "display_publisher.h"
#include "fusion_output.h"
#include "picture_publisher.h"
#include "rgbd_sfm_fusion/ros/fusion_messages.h"

namespace rgbd_sfm_fusion {

/// All topics of fusion. Messages that nobody wants are not made.
class FusionPublisher {
 public:
  /// @param handle  resolves the colour image, for the topics that show it
  /// @param guard   of the callbacks
  FusionPublisher(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle, CallbackGuard* guard);

  /// Sets the latency.
  void publish(FusionOutput output);

  /// Starts the shares since start anew.
  void restart() { totals_ = {}; }

  /// @param decimation  [px] of the points
  void setPointsDecimation(int decimation) { with_colour_.setPointsDecimation(decimation); }

 private:
  void publishImages(const FusionOutput& output);

  std::map<std::string, image_transport::Publisher> pictures_;
  std::map<std::string, ros::Publisher> images_;  ///< measures and labels, which no transport may change
  ros::Publisher camera_info_;
  ros::Publisher scale_;
  ros::Publisher statistics_;
  PicturePublisher with_colour_;
  DisplayPublisher display_;
  FusionTotals totals_;
};

}  // namespace rgbd_sfm_fusion
