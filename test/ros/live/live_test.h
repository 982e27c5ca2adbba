// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// A camera and a listener around the nodelets of a rostest.
#pragma once

#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "fake_camera.h"

namespace rgbd_sfm_fusion {

constexpr double kPatience = 20.0;  // [s] sanitizers and busy machines are slow

/// Handles callbacks until `condition` holds. @return whether it held in the end
inline bool spinUntil(const std::function<bool()>& condition, double patience = kPatience) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(patience);
  while (ros::ok() && ros::WallTime::now() < end) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
    if (condition()) return true;
  }
  return false;
}

/// All messages of a topic, in the order of arrival.
template <class Message>
class Inbox {
 public:
  using Ptr = boost::shared_ptr<const Message>;

  explicit Inbox(const std::string& topic) {
    ros::NodeHandle handle;
    subscriber_ = handle.subscribe<Message>(topic, 1000, [this](const Ptr& m) { messages.push_back(m); });
  }

  bool isConnected() const { return subscriber_.getNumPublishers() > 0; }
  std::string topic() const { return subscriber_.getTopic(); }

  /// Waits for the message with a stamp. @return null if it does not come
  Ptr at(Stamp stamp) {
    Ptr found;
    spinUntil([&] {
      for (const Ptr& message : messages) {
        if (message->header.stamp == toRosTime(stamp)) found = message;
      }
      return found != nullptr;
    });
    return found;
  }

  std::vector<Ptr> messages;

 private:
  ros::Subscriber subscriber_;
};

/// Publishes what a FakeCamera sees.
class LiveCamera {
 public:
  LiveCamera()
      : colour_(handle_.advertise<sensor_msgs::Image>("/camera/rgb/image_raw", 100)),
        info_(handle_.advertise<sensor_msgs::CameraInfo>("/camera/rgb/camera_info", 100)),
        depth_(handle_.advertise<sensor_msgs::Image>("/camera/depth_registered/image_raw", 100)),
        depth_info_(handle_.advertise<sensor_msgs::CameraInfo>("/camera/depth_registered/camera_info", 100)) {
  }

  bool waitForSubscribers() {
    return spinUntil([this] {
      return std::min({colour_.getNumSubscribers(), info_.getNumSubscribers(), depth_.getNumSubscribers(),
                       depth_info_.getNumSubscribers()}) > 0;
    });
  }

  std::uint32_t colourSubscribers() const { return colour_.getNumSubscribers(); }

  void sendInfo(const sensor_msgs::CameraInfo& info) { info_.publish(info); }
  void sendDepthInfo(const sensor_msgs::CameraInfo& info) { depth_info_.publish(info); }
  void sendColour(const sensor_msgs::ImagePtr& image) { colour_.publish(image); }
  void sendDepth(const sensor_msgs::ImagePtr& image) { depth_.publish(image); }

  /// @return the colour image's stamp
  Stamp send(const FakeCamera& camera, int frame) {
    sendInfo(camera.info(frame));
    sendDepth(camera.depthImage(frame));
    sendColour(camera.colour(frame));
    return camera.stamp(frame);
  }

 private:
  ros::NodeHandle handle_;
  ros::Publisher colour_, info_, depth_, depth_info_;
};

/// What the nodelets say on the console. (A rostest has no /rosout_agg.)
class Console {
 public:
  Console() {
    subscriber_ = handle_.subscribe<rosgraph_msgs::Log>(
        "/rosout", 1000, [this](const rosgraph_msgs::LogConstPtr& m) { lines_.push_back(*m); });
  }

  bool isConnected() const { return subscriber_.getNumPublishers() > 0; }

  /// Number of lines that hold all of `parts`: warnings and errors, unless said otherwise.
  std::size_t count(const std::vector<std::string>& parts,
                    rosgraph_msgs::Log::_level_type least = rosgraph_msgs::Log::WARN) const {
    return static_cast<std::size_t>(std::count_if(lines_.begin(), lines_.end(), [&](const auto& line) {
      return line.level >= least && std::all_of(parts.begin(), parts.end(), [&](const auto& part) {
               return line.msg.find(part) != std::string::npos;
             });
    }));
  }

  bool waitFor(const std::vector<std::string>& parts) {
    return spinUntil([&] { return count(parts) > 0; });
  }

 private:
  ros::NodeHandle handle_;
  ros::Subscriber subscriber_;
  std::vector<rosgraph_msgs::Log> lines_;
};

inline void callReset(const std::string& ns = "") {
  std_srvs::Trigger reset;
  const std::string service = ns + "/tracker/reset";
  ASSERT_TRUE(ros::service::waitForService(service, ros::Duration(kPatience)));
  ASSERT_TRUE(ros::service::call(service, reset));
  EXPECT_TRUE(reset.response.success);
}

/// A stamp later than all before, whatever the test; but not by so much that it would have to be confirmed by
/// more images.
inline Stamp freshStamp() {
  static Stamp stamp = 1'000'000'000'000;
  return stamp += 5'000'000'000;
}

/// A camera whose images come to tracker and fusion.
class LiveTest : public ::testing::Test {
 protected:
  /// Waits until the nodelets and the test listen, and lets the tracker start anew.
  /// @param listens  whether the test does
  void start(const std::function<bool()>& listens) {
    camera_.first_stamp = freshStamp();
    ASSERT_TRUE(live_camera_.waitForSubscribers());
    ASSERT_TRUE(spinUntil(listens));
    callReset();
  }

  FakeCamera camera_;
  LiveCamera live_camera_;
};

}  // namespace rgbd_sfm_fusion
