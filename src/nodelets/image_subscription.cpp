// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "image_subscription.h"

#include <ros/console.h>
#include <sensor_msgs/CompressedImage.h>

#include <utility>

#include "rgbd_sfm_fusion/ros/conversions.h"

namespace rgbd_sfm_fusion {
namespace {

std::string transportOf(const ros::NodeHandle& private_handle, const std::string& parameter) {
  const auto transport = private_handle.param<std::string>(parameter, "raw");
  if (transport == "raw" || transport == "compressed" || transport == "compressedDepth") return transport;
  ROS_ERROR_STREAM("parameter " << private_handle.resolveName(parameter) << " is \"" << transport
                                << "\", expected raw, compressed or compressedDepth; raw is used");
  return "raw";
}

}  // namespace

void ImageSubscription::subscribe(ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                                  const std::string& parameter, const std::string& topic,
                                  std::uint32_t queue_size, CallbackGuard* guard, OnImage on_image) {
  const std::string transport = transportOf(private_handle, parameter);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  if (transport == "raw") {
    subscriber_ = handle.subscribe<sensor_msgs::Image>(
        topic, queue_size, guard->forMessages<sensor_msgs::Image>(topic, std::move(on_image)), nullptr,
        hints);
    return;
  }
  const std::string compressed = topic + "/" + transport;
  subscriber_ = handle.subscribe<sensor_msgs::CompressedImage>(
      compressed, queue_size,
      guard->forMessages<sensor_msgs::CompressedImage>(
          compressed,
          [on_image = std::move(on_image)](const auto& message) { on_image(decompress(*message)); }),
      nullptr, hints);
}

}  // namespace rgbd_sfm_fusion
