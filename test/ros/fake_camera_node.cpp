// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// A FakeCamera that publishes at 30 Hz, whether anybody listens or not, and goes to and fro along its wall.
/// Parameter ~round: after so many images, stamps begin anew, as in a bag that loops; 0: never.
#include <ros/ros.h>

#include "fake_camera.h"

int main(int argc, char** argv) {
  using namespace rgbd_sfm_fusion;
  ros::init(argc, argv, "fake_camera");
  ros::NodeHandle handle;
  const int round = ros::NodeHandle("~").param("round", 0);
  const auto colour = handle.advertise<sensor_msgs::Image>("/camera/rgb/image_raw", 10);
  const auto info = handle.advertise<sensor_msgs::CameraInfo>("/camera/rgb/camera_info", 10);
  const auto depth = handle.advertise<sensor_msgs::Image>("/camera/depth_registered/image_raw", 10);

  constexpr int kFrames = 20;
  FakeCamera camera;
  std::vector<sensor_msgs::ImagePtr> colours, depths;
  for (int frame = 0; frame < kFrames; ++frame) {
    colours.push_back(camera.colour(frame));
    depths.push_back(camera.depthImage(frame));
  }
  const ros::Time start = ros::Time::now();
  ros::Rate rate(30.0);
  for (int count = 0; ros::ok(); ++count, rate.sleep()) {
    const int there_and_back = count % (2 * kFrames - 2);
    const auto frame = static_cast<std::size_t>(there_and_back < kFrames ? there_and_back
                                                                         : 2 * kFrames - 2 - there_and_back);
    const int count_in_round = round > 0 ? count % round : count;
    const ros::Time stamp = start + ros::Duration(count_in_round / 30.0);
    sensor_msgs::CameraInfo its_info = camera.info(0);
    auto its_colour = boost::make_shared<sensor_msgs::Image>(*colours[frame]);
    auto its_depth = boost::make_shared<sensor_msgs::Image>(*depths[frame]);
    its_info.header.stamp = its_colour->header.stamp = its_depth->header.stamp = stamp;
    info.publish(its_info);
    depth.publish(its_depth);
    colour.publish(its_colour);
  }
}
