// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/bag_input.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <vector>

#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kLongest = 1e9;  // [s] of a recording

/// Runs `function`, and says of which bag an error is.
template <class Function>
auto guarded(const std::string& path, Function function) {
  try {
    return function();
  } catch (const rosbag::BagUnindexedException&) {
    throw std::runtime_error(path + ": is truncated, or was not closed ('rosbag reindex' can repair it)");
  } catch (const rosbag::BagException& error) {
    throw std::runtime_error(path + ": is no bag, or damaged: " + error.what());
  } catch (const ros::serialization::StreamOverrunException&) {
    throw std::runtime_error(path + ": is damaged: a message is shorter than it should be");
  }
}

std::map<std::string, std::string> typesByTopic(const rosbag::Bag& bag) {
  std::map<std::string, std::string> types;
  rosbag::View view(bag);
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    types[connection->topic] = connection->datatype;
  }
  return types;
}

std::string siblingTopic(const std::string& topic, const std::string& name) {
  return topic.substr(0, topic.rfind('/') + 1) + name;
}

}  // namespace

BagInput::BagInput(const std::string& path, const BagSelection& selection,
                   const AssociationOptions& association)
    : path_(path), selection_(selection), associator_(association) {
  guarded(path, [&] {
    bag_.open(path, rosbag::bagmode::Read);
    requireTopic(selection.colour_topic, "sensor_msgs/Image");
    requireTopic(selection.camera_info_topic, "sensor_msgs/CameraInfo");
    requireTopic(selection.depth_topic, "sensor_msgs/Image");
    camera_info_ = firstCameraInfo(selection.camera_info_topic).value();
    depth_camera_info_ = firstCameraInfo(siblingTopic(selection.depth_topic, "camera_info"));

    const ros::Time begin = rosbag::View(bag_).getBeginTime();
    const ros::Time from = begin + ros::Duration(std::clamp(selection.start, 0.0, kLongest));
    const ros::Time to = from + ros::Duration(std::clamp(selection.duration, 0.0, kLongest));
    size_ = rosbag::View(bag_, rosbag::TopicQuery(selection.colour_topic), from, to).size();
    const std::vector<std::string> topics = {selection.colour_topic, selection.depth_topic};
    view_ = std::make_unique<rosbag::View>(bag_, rosbag::TopicQuery(topics), from, to);
    position_ = view_->begin();
  });
  if (size_ == 0)
    throw std::runtime_error(path + ": has no image of " + selection.colour_topic + " in that time");
}

std::optional<BagInput::Pair> BagInput::next() {
  return guarded(path_, [&]() -> std::optional<Pair> {
    for (std::optional<Pair> pair = associator_.pop();; pair = associator_.pop()) {
      if (pair) return pair;
      if (position_ == view_->end()) {
        associator_.finish();
        return associator_.pop();
      }
      const sensor_msgs::ImageConstPtr image = position_->instantiate<sensor_msgs::Image>();
      const Stamp stamp = fromRosTime(image->header.stamp);
      if (position_->getTopic() == selection_.colour_topic) {
        associator_.pushColour(stamp, image);
      } else {
        associator_.pushDepth(stamp, image);
      }
      ++position_;
    }
  });
}

void BagInput::requireTopic(const std::string& topic, const char* type) const {
  const std::map<std::string, std::string> types = typesByTopic(bag_);
  const auto found = types.find(topic);
  if (found != types.end() && found->second == type) return;
  std::string message = path_ + ": has no topic " + topic + " of type " + type + "; it has";
  for (const auto& [name, its_type] : types) message += "\n  " + name + " (" + its_type + ")";
  throw std::runtime_error(types.empty() ? path_ + ": is empty" : message);
}

std::optional<sensor_msgs::CameraInfo> BagInput::firstCameraInfo(const std::string& topic) const {
  rosbag::View view(bag_, rosbag::TopicQuery(topic));
  for (const rosbag::MessageInstance& message : view) {
    if (const auto info = message.instantiate<sensor_msgs::CameraInfo>()) return *info;
  }
  return std::nullopt;
}

}  // namespace rgbd_sfm_fusion
