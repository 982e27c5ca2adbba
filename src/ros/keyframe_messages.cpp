// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/keyframe_messages.h"

#include <sensor_msgs/image_encodings.h>

#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

namespace encodings = sensor_msgs::image_encodings;
using std_msgs::Header;

sensor_msgs::ImagePtr makeGrey(const Header& header, const KeyframeMap& keyframe) {
  return toImage(header, encodings::MONO8, keyframe.grey);
}

sensor_msgs::ImagePtr makeDepth(const Header& header, const KeyframeMap& keyframe) {
  return toImage(header, encodings::TYPE_32FC1, keyframe.depth.mean);
}

sensor_msgs::ImagePtr makeVariance(const Header& header, const KeyframeMap& keyframe) {
  return toImage(header, encodings::TYPE_32FC1, keyframe.depth.variance);
}

}  // namespace

const std::vector<KeyframeImageTopic>& keyframeImageTopics() {
  static const std::vector<KeyframeImageTopic> topics = {
      {"image", makeGrey},
      {"depth", makeDepth},
      {"variance", makeVariance},
  };
  return topics;
}

Header keyframeHeader(Header header, const KeyframeMap& keyframe) {
  header.stamp = toRosTime(keyframe.stamp);
  return header;
}

}  // namespace rgbd_sfm_fusion
