// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_publisher.h"

#include <sensor_msgs/CameraInfo.h>
#include <boost/make_shared.hpp>

#include "picture_transport.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

// As many as images that come at once may be waiting: a subscriber that is slow for a moment gets all of
// them.
constexpr std::uint32_t kQueueSize = 30;

template <class Message>
void publishShared(const ros::Publisher& publisher, const Message& message) {
  if (publisher.getNumSubscribers() > 0) publisher.publish(boost::make_shared<const Message>(message));
}

}  // namespace

FusionPublisher::FusionPublisher(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                                 CallbackGuard* guard)
    : with_colour_(handle, private_handle, guard), display_(private_handle) {
  ros::NodeHandle own(private_handle);
  for (const FusionImageTopic& topic : fusionImageTopics()) {
    if (topic.is_picture) {
      pictures_[topic.name] = advertisePicture(private_handle, topic.name, kQueueSize);
    } else {
      images_[topic.name] = own.advertise<sensor_msgs::Image>(topic.name, kQueueSize);
    }
  }
  camera_info_ = own.advertise<sensor_msgs::CameraInfo>("camera_info", kQueueSize);
  scale_ = own.advertise<Scale>("scale", kQueueSize);
  statistics_ = own.advertise<FusionStatistics>("statistics", kQueueSize);
}

void FusionPublisher::publish(FusionOutput output) {
  const FusedFrame& fused = output.fused;
  output.latency = secondsBetween(output.header.stamp, ros::Time::now());
  totals_.add(fused);
  publishImages(output);
  publishShared(camera_info_, toCameraInfo(output.header, output.rectifier->camera()));
  publishShared(scale_, toScaleMessage(output.header, fused.scale));
  publishShared(statistics_, toStatisticsMessage(output.header, fused, totals_, output.latency,
                                                 skewSeconds(fused.stamp, output.depth_stamp)));
  // For people, and so after what machines wait for.
  display_.publish(output);
  with_colour_.publish(output);
}

void FusionPublisher::publishImages(const FusionOutput& output) {
  for (const FusionImageTopic& topic : fusionImageTopics()) {
    const auto publish = [&](const auto& publisher) {
      if (publisher.getNumSubscribers() > 0) publisher.publish(topic.make(output.header, output.fused));
    };
    topic.is_picture ? publish(pictures_[topic.name]) : publish(images_[topic.name]);
  }
}

}  // namespace rgbd_sfm_fusion
