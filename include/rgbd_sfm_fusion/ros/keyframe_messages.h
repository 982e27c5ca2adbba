// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/Image.h>

#include <string>
#include <vector>

#include "rgbd_sfm_fusion/odometry/visual_odometry.h"

namespace rgbd_sfm_fusion {

/// An image topic below /tracker/keyframe, for people and other packages, and how its messages are made.
struct KeyframeImageTopic {
  std::string name;  ///< e.g. `depth`
  sensor_msgs::ImagePtr (*make)(const std_msgs::Header&, const KeyframeMap&);
};

const std::vector<KeyframeImageTopic>& keyframeImageTopics();

/// @param header  of the colour image of any frame
/// @return the same with the keyframe's stamp
std_msgs::Header keyframeHeader(std_msgs::Header header, const KeyframeMap& keyframe);

}  // namespace rgbd_sfm_fusion
