// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/tracker_messages.h"

#include <sensor_msgs/image_encodings.h>
#include <boost/make_shared.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"
#include "rgbd_sfm_fusion/sensor/skew_compensation.h"

namespace rgbd_sfm_fusion {
namespace {

using RowMajorMatrix6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// A view of an image inside `owner`, which is to outlive it.
cv::Mat view(const KeyframeConstPtr& owner, const sensor_msgs::Image& image, const char* name) {
  if (image.encoding != sensor_msgs::image_encodings::TYPE_32FC1) {
    throw std::invalid_argument(std::string("keyframe ") + name + ": expected 32FC1, got " + image.encoding);
  }
  return viewImage(sensor_msgs::ImageConstPtr(owner, &image));
}

PinholeCamera cameraOf(const Keyframe& message) {
  const PinholeCamera camera{static_cast<int>(message.depth.width),
                             static_cast<int>(message.depth.height),
                             message.K[0],
                             message.K[4],
                             message.K[2],
                             message.K[5]};
  if (!(camera.fx > 0.0 && camera.fy > 0.0)) throw std::invalid_argument("keyframe K: expected fx, fy > 0");
  return camera;
}

}  // namespace

TrackedFrame toMessage(const std_msgs::Header& header, const TrackingResult& tracked, Stamp depth_stamp) {
  TrackedFrame message;
  message.header = header;
  message.state = static_cast<std::uint8_t>(tracked.state);
  message.relocalised = tracked.relocalised;
  message.depth_stamp = toRosTime(depth_stamp);
  message.keyframe_stamp = toRosTime(tracked.keyframe_stamp);
  message.keyframe_revision = tracked.keyframe_revision;
  message.T_frame_keyframe = toTransform(tracked.T_frame_keyframe);
  Eigen::Map<RowMajorMatrix6>(message.covariance.data()) = tracked.covariance;
  message.T_first_frame = toTransform(tracked.T_first_frame);
  message.share_of_good_points = tracked.share_of_good_points;
  message.depth_delay = tracked.depth_delay;
  return message;
}

TrackingResult fromMessage(const TrackedFrame& message) {
  if (message.state > static_cast<std::uint8_t>(TrackingState::kLost)) {
    throw std::invalid_argument("tracked frame: state " + std::to_string(message.state) + " is not defined");
  }
  TrackingResult tracked;
  tracked.stamp = fromRosTime(message.header.stamp);
  tracked.state = static_cast<TrackingState>(message.state);
  if (tracked.state != TrackingState::kTracking) return tracked;
  tracked.relocalised = message.relocalised != 0;
  tracked.keyframe_stamp = fromRosTime(message.keyframe_stamp);
  tracked.keyframe_revision = message.keyframe_revision;
  tracked.T_frame_keyframe = fromTransform(message.T_frame_keyframe);
  tracked.covariance = Eigen::Map<const RowMajorMatrix6>(message.covariance.data());
  if (!tracked.covariance.allFinite()) throw std::invalid_argument("tracked frame: covariance is not finite");
  tracked.T_first_frame = fromTransform(message.T_first_frame);
  tracked.share_of_good_points = message.share_of_good_points;
  tracked.depth_delay = message.depth_delay;
  if (!(std::abs(tracked.depth_delay) <= kLongestMotion))
    throw std::invalid_argument("tracked frame: depth_delay is " + std::to_string(tracked.depth_delay) +
                                " s: expected at most " + std::to_string(kLongestMotion) + " s");
  return tracked;
}

KeyframePtr toMessage(const std_msgs::Header& header, const KeyframeMap& keyframe, const SE3& T_odom_first) {
  auto message = boost::make_shared<Keyframe>();
  message->header = header;
  message->header.stamp = toRosTime(keyframe.stamp);
  message->revision = keyframe.revision;
  message->K = toCameraInfo(header, keyframe.camera).K;
  message->T_odom_keyframe = toTransform(T_odom_first * keyframe.T_first_keyframe);
  fillImage(message->header, sensor_msgs::image_encodings::TYPE_32FC1, keyframe.depth.mean, &message->depth);
  fillImage(message->header, sensor_msgs::image_encodings::TYPE_32FC1, keyframe.depth.variance,
            &message->variance);
  return message;
}

KeyframeMap fromMessage(const KeyframeConstPtr& message, const SE3& T_odom_first) {
  KeyframeMap keyframe;
  keyframe.stamp = fromRosTime(message->header.stamp);
  keyframe.revision = message->revision;
  keyframe.camera = cameraOf(*message);
  keyframe.T_first_keyframe = T_odom_first.inverse() * fromTransform(message->T_odom_keyframe);
  keyframe.depth.mean = view(message, message->depth, "depth");
  keyframe.depth.variance = view(message, message->variance, "variance");
  if (keyframe.depth.mean.size() != keyframe.depth.variance.size()) {
    throw std::invalid_argument("keyframe: depth and variance differ in size");
  }
  return keyframe;
}

SE3 T_odom_firstOf(const Keyframe& keyframe, const TrackingResult& tracked) {
  const SE3 T_first_keyframe = tracked.T_first_frame * tracked.T_frame_keyframe;
  return fromTransform(keyframe.T_odom_keyframe) * T_first_keyframe.inverse();
}

}  // namespace rgbd_sfm_fusion
