// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_publisher.h"

#include <sensor_msgs/CameraInfo.h>
#include <boost/make_shared.hpp>

#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kQueueSize = 10;

template <class Message>
void publishShared(const ros::Publisher& publisher, const Message& message) {
  if (publisher.getNumSubscribers() > 0) publisher.publish(boost::make_shared<const Message>(message));
}

}  // namespace

FusionPublisher::FusionPublisher(const ros::NodeHandle& private_handle) {
  ros::NodeHandle handle(private_handle);
  for (const FusionImageTopic& topic : fusionImageTopics()) {
    images_.push_back(handle.advertise<sensor_msgs::Image>(topic.name, kQueueSize));
  }
  camera_info_ = handle.advertise<sensor_msgs::CameraInfo>("camera_info", kQueueSize);
  scale_ = handle.advertise<Scale>("scale", kQueueSize);
  statistics_ = handle.advertise<FusionStatistics>("statistics", kQueueSize);
}

void FusionPublisher::publish(const std_msgs::Header& header, const FusedFrame& fused,
                              const PinholeCamera& camera, Stamp depth_stamp) {
  totals_.add(fused);
  for (std::size_t i = 0; i < images_.size(); ++i) {
    if (images_[i].getNumSubscribers() > 0) images_[i].publish(fusionImageTopics()[i].make(header, fused));
  }
  publishShared(camera_info_, toCameraInfo(header, camera));
  publishShared(scale_, toScaleMessage(header, fused.scale));
  const double latency = secondsBetween(header.stamp, ros::Time::now());
  publishShared(statistics_,
                toStatisticsMessage(header, fused, totals_, latency, skewSeconds(fused.stamp, depth_stamp)));
}

}  // namespace rgbd_sfm_fusion
