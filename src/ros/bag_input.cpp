// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/bag_input.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "rgbd_sfm_fusion/ros/bag_messages.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kLongest = 1e9;  // [s] of a recording

template <class Message>
const char* typeName() {
  return ros::message_traits::datatype<Message>();
}

template <class Message>
const char* md5sum() {
  return ros::message_traits::md5sum<Message>();
}

std::vector<std::size_t> joined(std::vector<std::size_t> a, const std::vector<std::size_t>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::string siblingTopic(const std::string& topic, const std::string& name) {
  return topic.substr(0, topic.rfind('/') + 1) + name;
}

}  // namespace

BagInput::BagInput(const std::string& path, const BagSelection& selection,
                   const AssociationOptions& association, OnUnreadable on_unreadable)
    : path_(path),
      selection_(selection),
      on_unreadable_(std::move(on_unreadable)),
      bag_(path),
      associator_(association) {
  using sensor_msgs::CameraInfo;
  using sensor_msgs::Image;
  const auto colour = requireTopic(selection.colour_topic, typeName<Image>(), md5sum<Image>());
  const auto info = requireTopic(selection.camera_info_topic, typeName<CameraInfo>(), md5sum<CameraInfo>());
  const auto depth = requireTopic(selection.depth_topic, typeName<Image>(), md5sum<Image>());
  const auto camera_info = firstCameraInfo(info);
  if (!camera_info)
    throw std::runtime_error(path + ": has no message of " + selection.camera_info_topic +
                             " that can be read, and so no calibration");
  camera_info_ = *camera_info;
  depth_camera_info_ = firstCameraInfo(connectionsOf(siblingTopic(selection.depth_topic, "camera_info"),
                                                     typeName<CameraInfo>(), md5sum<CameraInfo>()));

  const Stamp from = bag_.begin() + fromSeconds(std::clamp(selection.start, 0.0, kLongest));
  const Stamp to = from + fromSeconds(std::clamp(selection.duration, 0.0, kLongest));
  const auto isWanted = [&](const Place& place) {
    return place.entry.time >= from && place.entry.time <= to;
  };
  for (const Place& place : placesOf(joined(colour, depth))) {
    if (!isWanted(place)) continue;
    places_.push_back(place);
    if (bag_.connections()[place.connection].topic == selection.colour_topic) ++size_;
  }
  if (size_ == 0)
    throw std::runtime_error(path + ": has no image of " + selection.colour_topic + " in that time");
}

std::optional<BagInput::Pair> BagInput::next() {
  for (std::optional<Pair> pair = associator_.pop();; pair = associator_.pop()) {
    if (pair) return pair;
    if (position_ == places_.size()) {
      associator_.finish();
      return associator_.pop();
    }
    take(places_[position_++]);
  }
}

void BagInput::take(const Place& place) {
  const std::string& topic = bag_.connections()[place.connection].topic;
  sensor_msgs::ImagePtr image;
  try {
    image = readImage(bag_.read(place.connection, place.entry));
  } catch (const std::invalid_argument& error) {
    return on_unreadable_(topic, place.entry.time, error.what());
  }
  const Stamp stamp = fromRosTime(image->header.stamp);
  if (topic == selection_.colour_topic) {
    associator_.pushColour(stamp, image);
  } else {
    associator_.pushDepth(stamp, image);
  }
}

std::vector<std::size_t> BagInput::connectionsOf(const std::string& topic, const char* type,
                                                 const char* md5sum) const {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < bag_.connections().size(); ++i) {
    const BagFile::Connection& connection = bag_.connections()[i];
    if (connection.topic == topic && connection.type == type && connection.md5sum == md5sum)
      result.push_back(i);
  }
  return result;
}

std::vector<std::size_t> BagInput::requireTopic(const std::string& topic, const char* type,
                                                const char* md5sum) const {
  std::vector<std::size_t> found = connectionsOf(topic, type, md5sum);
  if (!found.empty()) return found;
  std::set<std::string> lines;
  for (const BagFile::Connection& connection : bag_.connections()) {
    if (connection.topic == topic && connection.type == type) {
      throw std::runtime_error(
          path_ + ": its " + type + " of " + topic + " are of another definition (md5sum " +
          connection.md5sum + ", expected " + md5sum +
          "): they were recorded by another version of ROS, or the bag is damaged; 'rosbag "
          "check' tells, and 'rosbag fix' can convert it");
    }
    lines.insert("\n  " + connection.topic + " (" + connection.type + ")");
  }
  if (lines.empty()) throw std::runtime_error(path_ + ": is a bag without any topic");
  std::string message = path_ + ": has no topic " + topic + " of type " + type + "; it has";
  for (const std::string& line : lines) message += line;
  throw std::runtime_error(message);
}

std::vector<BagInput::Place> BagInput::placesOf(const std::vector<std::size_t>& connections) const {
  std::vector<Place> places;
  for (const std::size_t connection : connections) {
    for (const BagFile::Entry& entry : bag_.entries(connection)) places.push_back({connection, entry});
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.entry.time < b.entry.time; });
  return places;
}

std::optional<sensor_msgs::CameraInfo> BagInput::firstCameraInfo(
    const std::vector<std::size_t>& connections) {
  for (const auto& [connection, entry] : placesOf(connections)) {
    try {
      return readCameraInfo(bag_.read(connection, entry));
    } catch (const std::invalid_argument& error) {
      on_unreadable_(bag_.connections()[connection].topic, entry.time, error.what());
    }
  }
  return std::nullopt;
}

}  // namespace rgbd_sfm_fusion
