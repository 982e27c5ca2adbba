// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/bag_input.h"

#include <sensor_msgs/CompressedImage.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "rgbd_sfm_fusion/ros/bag_messages.h"
#include "rgbd_sfm_fusion/ros/calibration_file.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::CompressedImage;
using sensor_msgs::Image;

constexpr double kLongest = 1e9;       // [s] of a recording
constexpr std::size_t kMostTries = 5;  // messages of a topic, to see what it holds

template <class Message>
std::string typeName() {
  return ros::message_traits::datatype<Message>();
}

template <class Message>
std::string md5sum() {
  return ros::message_traits::md5sum<Message>();
}

std::vector<std::size_t> joined(std::vector<std::size_t> a, const std::vector<std::size_t>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const std::vector<const char*> kColourTransports = {"", "/compressed"};
const std::vector<const char*> kDepthTransports = {"", "/compressedDepth", "/compressed"};

}  // namespace

std::string describe(const BagSelection& selection) {
  const bool has_file = !selection.calibration_file.empty();
  return "colour " + selection.colour_topic + ", depth " + selection.depth_topic + ", calibration " +
         (has_file ? selection.calibration_file : selection.camera_info_topic);
}

BagInput::BagInput(const std::vector<std::string>& paths, const BagSelection& selection,
                   const AssociationOptions& association, OnUnreadable on_unreadable)
    : selection_(selection),
      on_unreadable_(std::move(on_unreadable)),
      bags_(paths),
      associator_(association) {
  chooseTopics();
  const Connections colour =
      requireImages(selection_.colour_topic, kColourTransports, &selection_.colour_topic);
  const Connections depth = requireImages(selection_.depth_topic, kDepthTransports, &selection_.depth_topic);
  findCalibration();
  selectPlaces(colour, depth);
}

/// Looks for those that are not given.
void BagInput::chooseTopics() {
  if (!selection_.colour_topic.empty() && !selection_.depth_topic.empty()) return;
  const std::vector<ImageTopic> topics = imageTopics();
  if (topics.empty()) refuseMissing("", typeName<Image>());
  try {
    if (selection_.colour_topic.empty()) selection_.colour_topic = chooseColourTopic(topics);
    if (selection_.depth_topic.empty())
      selection_.depth_topic = chooseDepthTopic(topics, selection_.colour_topic);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(bags_.name() + ": " + error.what());
  }
}

std::vector<ImageTopic> BagInput::imageTopics() {
  std::set<std::string> names;
  for (const BagFile::Connection& connection : bags_.connections()) {
    if (connection.type == typeName<Image>() || connection.type == typeName<CompressedImage>())
      names.insert(connection.topic);
  }
  std::vector<ImageTopic> topics;
  for (const std::string& name : names) {
    const Connections connections = imagesOf(name);
    if (connections.empty()) {
      requireSameDefinition<Image>(name);
      requireSameDefinition<CompressedImage>(name);
    }
    ImageTopic topic = describe(name, connections);
    if (!bags_.places(connections).empty()) topics.push_back(std::move(topic));
  }
  return topics;
}

ImageTopic BagInput::describe(const std::string& name, const Connections& connections) {
  ImageTopic topic;
  topic.name = name;
  std::size_t tries = 0;
  for (const BagSet::Place& place : bags_.places(connections)) {
    if (++tries > kMostTries) break;
    topic.is_compressed = bags_.connections()[place.connection].type == typeName<CompressedImage>();
    try {
      const sensor_msgs::ImageConstPtr image = readImageAt(place);
      const cv::Mat pixels = viewImage(image);
      topic.encoding = image->encoding;
      topic.width = pixels.cols;
      topic.height = pixels.rows;
      topic.frame_id = withoutSlash(image->header.frame_id);
      break;
    } catch (const std::invalid_argument&) {  // the next one may be readable
    }
  }
  return topic;
}

void BagInput::findCalibration() {
  std::string& topic = selection_.camera_info_topic;
  if (!selection_.calibration_file.empty()) {
    topic.clear();
    calibration_ = readCalibrationFile(selection_.calibration_file);
  } else {
    const auto info = firstCameraInfo(findCameraInfo(&topic));
    if (!info)
      throw std::runtime_error(bags_.name() + ": has no message of " + topic +
                               " that can be read, and so no calibration: give one by --calibration FILE");
    try {
      calibration_ = toCalibration(*info);
      validate(calibration_);
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(bags_.name() + ", " + topic + ": " + error.what());
    }
  }
  if (isRectifiedByName(selection_.colour_topic)) {
    const CameraCalibration rectified = ofRectifiedImages(calibration_);
    if (!(rectified == calibration_)) assumption_ = selection_.colour_topic + ": " + kAssumedRectified;
    calibration_ = rectified;
  }
  Connections depth;
  for (const std::string& name : cameraInfoTopics(selection_.depth_topic)) {
    const Connections found = connectionsOf<CameraInfo>(name);
    if (!found.empty() && depth_camera_info_topic_.empty()) depth_camera_info_topic_ = name;
    depth = joined(std::move(depth), found);
  }
  if (const auto info = firstCameraInfo(depth)) {
    try {
      const CameraCalibration calibration = toCalibration(*info);
      depth_calibration_ = depthIsRectified() ? ofRectifiedImages(calibration) : calibration;
    } catch (const std::invalid_argument& error) {  // not needed, but for depth of another size
      depth_calibration_problem_ = error.what();
    }
  }
}

bool BagInput::depthIsRectified() const {
  return isRectifiedByName(selection_.depth_topic);
}

/// @param topic  as given; else what was found
BagInput::Connections BagInput::findCameraInfo(std::string* topic) const {
  if (!topic->empty()) {
    const Connections found = connectionsOf<CameraInfo>(*topic);
    requireSameDefinition<CameraInfo>(*topic);
    if (found.empty()) refuseMissing(*topic, typeName<CameraInfo>());
    return found;
  }
  std::set<std::string> all;
  for (const BagFile::Connection& connection : bags_.connections()) {
    if (connection.type == typeName<CameraInfo>()) all.insert(connection.topic);
  }
  std::vector<std::string> names = cameraInfoTopics(selection_.colour_topic);
  if (all.size() == 1) names.push_back(*all.begin());
  for (const std::string& name : names) {
    requireSameDefinition<CameraInfo>(name);
    const Connections found = connectionsOf<CameraInfo>(name);
    if (found.empty()) continue;
    *topic = name;
    return found;
  }
  std::string message = bags_.name() + ": has no " + names.front() + ", and so no calibration of " +
                        selection_.colour_topic +
                        ": give one by --calibration FILE (YAML, as camera_calibration "
                        "writes it)";
  if (!all.empty()) message += ", or name one by --camera-info TOPIC; there are";
  for (const std::string& name : all) message += "\n  " + name;
  throw std::runtime_error(message);
}

void BagInput::selectPlaces(const Connections& colour, const Connections& depth) {
  const std::vector<BagSet::Place> all = bags_.places(joined(colour, depth));
  // Other messages do not tell when the bag begins: those from before the first /clock are of 1970.
  const Stamp begin = all.empty() ? 0 : all.front().entry.time;
  const Stamp from = begin + fromSeconds(std::clamp(selection_.start, 0.0, kLongest));
  const Stamp to = from + fromSeconds(std::clamp(selection_.duration, 0.0, kLongest));
  for (const BagSet::Place& place : all) {
    if (place.entry.time < from || place.entry.time > to) continue;
    places_.push_back(place);
    if (bags_.connections()[place.connection].topic == selection_.colour_topic) ++size_;
  }
  if (size_ == 0)
    throw std::runtime_error(bags_.name() + ": has no image of " + selection_.colour_topic + " in that time");
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

void BagInput::take(const BagSet::Place& place) {
  const std::string& topic = bags_.connections()[place.connection].topic;
  sensor_msgs::ImagePtr image;
  try {
    image = readImageAt(place);
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

sensor_msgs::ImagePtr BagInput::readImageAt(const BagSet::Place& place) {
  const std::vector<std::uint8_t> bytes = bags_.read(place);
  if (bags_.connections()[place.connection].type == typeName<CompressedImage>())
    return decompress(readCompressedImage(bytes));
  return readImage(bytes);
}

template <class Message>
BagInput::Connections BagInput::connectionsOf(const std::string& topic) const {
  Connections result;
  for (std::size_t i = 0; i < bags_.connections().size(); ++i) {
    const BagFile::Connection& connection = bags_.connections()[i];
    if (connection.topic == topic && connection.type == typeName<Message>() &&
        connection.md5sum == md5sum<Message>())
      result.push_back(i);
  }
  return result;
}

bool BagInput::isCompressed(const std::string& topic) const {
  return !connectionsOf<CompressedImage>(topic).empty();
}

BagInput::Connections BagInput::imagesOf(const std::string& topic) const {
  return joined(connectionsOf<Image>(topic), connectionsOf<CompressedImage>(topic));
}

/// @param found  the topic that has them: that one, or its first transport that is there
BagInput::Connections BagInput::requireImages(const std::string& topic,
                                              const std::vector<const char*>& transports,
                                              std::string* found) const {
  for (const char* transport : transports) {
    const std::string name = topic + transport;
    Connections connections = imagesOf(name);
    if (connections.empty()) continue;
    *found = name;
    return connections;
  }
  requireSameDefinition<Image>(topic);
  requireSameDefinition<CompressedImage>(topic);
  refuseMissing(topic, typeName<Image>());
}

template <class Message>
void BagInput::requireSameDefinition(const std::string& topic) const {
  if (!connectionsOf<Message>(topic).empty()) return;
  for (const BagFile::Connection& connection : bags_.connections()) {
    if (connection.topic != topic || connection.type != typeName<Message>()) continue;
    throw std::runtime_error(
        bags_.name() + ": its " + connection.type + " of " + topic + " are of another definition (md5sum " +
        connection.md5sum + ", expected " + md5sum<Message>() +
        "): they were recorded by another version of ROS, or the bag is damaged; 'rosbag check' tells, and "
        "'rosbag fix' can convert it");
  }
}

void BagInput::refuseMissing(const std::string& topic, const std::string& type) const {
  std::set<std::string> lines;
  for (const BagFile::Connection& connection : bags_.connections())
    lines.insert("\n  " + connection.topic + " (" + connection.type + ")");
  if (lines.empty()) throw std::runtime_error(bags_.name() + ": is a bag without any topic");
  std::string message =
      bags_.name() + ": has no topic " + (topic.empty() ? "" : topic + " ") + "of type " + type + "; it has";
  for (const std::string& line : lines) message += line;
  throw std::runtime_error(message);
}

std::optional<CameraInfo> BagInput::firstCameraInfo(const Connections& connections) {
  for (const BagSet::Place& place : bags_.places(connections)) {
    try {
      return readCameraInfo(bags_.read(place));
    } catch (const std::invalid_argument& error) {
      on_unreadable_(bags_.connections()[place.connection].topic, place.entry.time, error.what());
    }
  }
  return std::nullopt;
}

}  // namespace rgbd_sfm_fusion
