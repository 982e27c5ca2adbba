// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

#include <rgbd_sfm_fusion/FusionStatistics.h>
#include <rgbd_sfm_fusion/core.h>
#include <ros/time.h>

#include <iostream>

int main() {
  rgbd_sfm_fusion::FusionStatistics message;
  message.header.stamp = ros::Time(1.0);
  rgbd_sfm_fusion::validate(rgbd_sfm_fusion::FusionOptions());
  std::cout << "message of " << message.header.stamp << " and core found\n";
}
