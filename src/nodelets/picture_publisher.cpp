// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "picture_publisher.h"

#include <ros/console.h>
#include <sensor_msgs/PointCloud2.h>

#include <cmath>
#include <stdexcept>

#include "picture_transport.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/fusion_messages.h"
#include "rgbd_sfm_fusion/ros/picture.h"
#include "rgbd_sfm_fusion/ros/point_cloud.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kQueueSize = 10;
constexpr double kPatience = 1.0;         // [s] that a frame waits for its image
constexpr std::size_t kMostWaiting = 30;  // frames

}  // namespace

PicturePublisher::PicturePublisher(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                                   CallbackGuard* guard)
    : colour_input_(handle, private_handle, guard, [this](const sensor_msgs::ImageConstPtr& image) {
        colour_.push(image);
        publishWaiting();
      }) {
  // Subscribers may come while publishers are still being made: they wait for the guard.
  const auto changed = [this, guard] { guard->run("subscribers", [this] { subscribeIfWanted(); }); };
  image_rect_ = advertisePicture(private_handle, "image_rect", kQueueSize, changed);
  preview_ = advertisePicture(private_handle, "preview", kQueueSize, changed);
  preview_worker_ = std::make_unique<PreviewWorker>(preview_);
  const ros::SubscriberStatusCallback points_changed = [changed](const ros::SingleSubscriberPublisher&) {
    changed();
  };
  points_ = ros::NodeHandle(private_handle)
                .advertise<sensor_msgs::PointCloud2>("points", kQueueSize, points_changed, points_changed);
}

bool PicturePublisher::isWanted() const {
  return image_rect_.getNumSubscribers() > 0 || preview_.getNumSubscribers() > 0 ||
         points_.getNumSubscribers() > 0;
}

void PicturePublisher::subscribeIfWanted() {
  const bool wanted = isWanted();
  colour_input_.setWanted(wanted);
  if (wanted) return;
  colour_.clear();
  waiting_.clear();
}

void PicturePublisher::publish(const FusionOutput& output) {
  rate_.add(output.fused.stamp);
  if (!isWanted()) return;
  waiting_.push_back({output, rate_.rate(), ros::Time::now()});
  publishWaiting();
}

void PicturePublisher::publishWaiting() {
  while (!waiting_.empty()) {
    const Waiting frame = waiting_.front();
    const ros::Time stamp = frame.output.header.stamp;
    const sensor_msgs::ImageConstPtr colour = colour_.find(stamp);
    const double waited = std::abs(secondsBetween(frame.since, ros::Time::now()));
    const bool waits = !colour && colour_.mayCome(stamp) && waited < kPatience;
    if (waits && waiting_.size() <= kMostWaiting) return;
    waiting_.pop_front();
    publishWith(colour, frame);
    colour_.forgetOlderThan(stamp);
  }
}

void PicturePublisher::publishWith(const sensor_msgs::ImageConstPtr& colour, const Waiting& frame) {
  const FusionOutput& output = frame.output;
  const cv::Mat picture = rectifiedPicture(colour, output);
  if (image_rect_.getNumSubscribers() > 0 && !picture.empty())
    image_rect_.publish(toPictureMessage(output.header, picture));
  if (preview_.getNumSubscribers() > 0) preview_worker_->draw({output, picture, colour, frame.rate});
  if (points_.getNumSubscribers() > 0) {
    PointCloudOptions options;
    options.decimation = points_decimation_;
    points_.publish(toPointCloud(output.header, output.fused, output.rectifier->camera(), picture, options));
  }
}

cv::Mat PicturePublisher::rectifiedPicture(const sensor_msgs::ImageConstPtr& colour,
                                           const FusionOutput& output) const {
  if (!colour) return {};
  try {
    return output.rectifier->rectifyPicture(toPicture(toRawImage(colour, fromRosTime(colour->header.stamp))));
  } catch (const std::exception& error) {  // the tracker reports an image that nobody can use
    ROS_WARN_STREAM_THROTTLE(30, "a colour image can't be shown: " << error.what());
    return {};
  }
}

}  // namespace rgbd_sfm_fusion
