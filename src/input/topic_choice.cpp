// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/topic_choice.h"

#include <algorithm>
#include <functional>
#include <stdexcept>

namespace rgbd_sfm_fusion {
namespace {

using Topics = std::vector<ImageTopic>;
using Predicate = std::function<bool(const ImageTopic&)>;

bool contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::string folder(const std::string& topic) {
  const std::size_t slash = topic.rfind('/');
  return slash == std::string::npos ? "" : topic.substr(0, slash);
}

bool isInfrared(const ImageTopic& topic) {
  return contains(topic.name, "infra") || contains(topic.name + "/", "/ir/") ||
         contains(topic.name, "/ir_") || contains(topic.name, "amplitude");
}

bool isGrey(const ImageTopic& topic) {
  return topic.encoding.rfind("mono", 0) == 0 || topic.encoding == "8UC1";
}

/// Whether this package or another one has made the images from other images.
bool isDerived(const ImageTopic& topic) {
  return contains(topic.name, "/fusion/") || contains(topic.name, "/tracker/") ||
         contains(topic.name, "rect") || contains(topic.name, "confidence");
}

bool isRegisteredByName(const ImageTopic& topic) {
  return contains(topic.name, "regist") || contains(topic.name, "aligned") ||
         contains(topic.name, "depth_to_rgb") || contains(topic.name, "depth_to_color") ||
         contains(topic.name, "depth2rgb");
}

/// The preferred topics; all topics, if none is preferred.
Topics preferred(const Topics& topics, const Predicate& is_preferred) {
  Topics kept;
  std::copy_if(topics.begin(), topics.end(), std::back_inserter(kept), is_preferred);
  return kept.empty() ? topics : kept;
}

/// One topic of each image: the raw one, if there is one.
Topics withoutDuplicates(const Topics& topics) {
  return preferred(topics, [&](const ImageTopic& topic) {
    return std::none_of(topics.begin(), topics.end(), [&](const ImageTopic& other) {
      const bool is_same = withoutTransport(other.name) == withoutTransport(topic.name);
      const bool is_better = other.is_compressed != topic.is_compressed
                                 ? !other.is_compressed
                                 : endsWith(other.name, "/compressedDepth");
      return &other != &topic && is_same && is_better && other.name != topic.name;
    });
  });
}

std::string lines(const Topics& topics) {
  std::string text;
  for (const ImageTopic& topic : topics) text += "\n  " + topic.describe();
  return text;
}

std::string theOneOf(const Topics& candidates, const Topics& all, const std::string& kind,
                     const std::string& option) {
  if (candidates.size() == 1) return candidates.front().name;
  if (candidates.empty())
    throw std::runtime_error("no topic has " + kind + " images" +
                             (all.empty() ? "" : "; those with images are" + lines(all)));
  throw std::runtime_error(std::to_string(candidates.size()) + " topics have " + kind +
                           " images: name one by " + option + lines(candidates));
}

}  // namespace

const char* const kAssumedRectified =
    "by their name these images are rectified, so that P of camera_info is used without its distortion";

bool ImageTopic::isDepth() const {
  if (encoding == "16UC1" || encoding == "32FC1") return true;
  // Depth has the encoding mono16 if it was taken for any image of 16 bits, and no encoding if nothing could
  // be read.
  return (encoding == "mono16" || encoding.empty()) && !isInfrared(*this) &&
         (contains(name, "depth") || contains(name, "Depth"));
}

std::string ImageTopic::describe() const {
  if (encoding.empty()) return name + ": not readable";
  return name + ": " + encoding + " of " + std::to_string(width) + "x" + std::to_string(height) + " px" +
         (frame_id.empty() ? "" : " in " + frame_id);
}

std::string withoutTransport(const std::string& topic) {
  for (const char* transport : {"/compressed", "/compressedDepth"}) {
    if (endsWith(topic, transport)) return folder(topic);
  }
  return topic;
}

bool isRectifiedByName(const std::string& topic) {
  const std::string image = withoutTransport(topic);
  const std::string name = image.substr(image.rfind('/') + 1) + "_";
  return contains(name, "_rect_");
}

std::vector<std::string> cameraInfoTopics(const std::string& image_topic) {
  const std::string beside = folder(withoutTransport(image_topic));
  return {beside + "/camera_info", folder(beside) + "/info/camera_info"};
}

std::string chooseColourTopic(const std::vector<ImageTopic>& topics) {
  Topics candidates;
  std::copy_if(topics.begin(), topics.end(), std::back_inserter(candidates),
               [](const ImageTopic& topic) { return !topic.isDepth(); });
  candidates = withoutDuplicates(candidates);
  for (const Predicate& is_preferred :
       std::initializer_list<Predicate>{[](const ImageTopic& topic) { return !topic.encoding.empty(); },
                                        [](const ImageTopic& topic) { return !isInfrared(topic); },
                                        [](const ImageTopic& topic) { return !isDerived(topic); },
                                        [](const ImageTopic& topic) { return !isGrey(topic); }})
    candidates = preferred(candidates, is_preferred);
  // A camera may also publish the image before its colours were made from a Bayer pattern.
  const std::string camera = candidates.empty() ? "" : folder(withoutTransport(candidates.front().name));
  const bool is_one_camera = std::all_of(candidates.begin(), candidates.end(), [&](const ImageTopic& topic) {
    return folder(withoutTransport(topic.name)) == camera;
  });
  if (is_one_camera)
    candidates = preferred(candidates, [](const ImageTopic& topic) {
      return endsWith(withoutTransport(topic.name), "image_color");
    });
  return theOneOf(candidates, topics, "colour", "--rgb TOPIC");
}

std::string chooseDepthTopic(const std::vector<ImageTopic>& topics, const std::string& colour) {
  Topics candidates;
  std::copy_if(topics.begin(), topics.end(), std::back_inserter(candidates),
               [&](const ImageTopic& topic) { return topic.isDepth() && topic.name != colour; });
  candidates = withoutDuplicates(candidates);
  const auto colour_topic = std::find_if(topics.begin(), topics.end(),
                                         [&](const ImageTopic& topic) { return topic.name == colour; });
  for (const Predicate& is_preferred : std::initializer_list<Predicate>{
           [](const ImageTopic& topic) { return !topic.encoding.empty(); },
           [](const ImageTopic& topic) { return !isDerived(topic); }, isRegisteredByName,
           [&](const ImageTopic& topic) {
             return colour_topic != topics.end() && topic.frame_id == colour_topic->frame_id;
           },
           [&](const ImageTopic& topic) {
             return colour_topic != topics.end() && topic.width == colour_topic->width &&
                    topic.height == colour_topic->height;
           },
           [](const ImageTopic& topic) { return topic.encoding != "32FC1"; }})
    candidates = preferred(candidates, is_preferred);
  return theOneOf(candidates, topics, "depth", "--depth TOPIC");
}

}  // namespace rgbd_sfm_fusion
