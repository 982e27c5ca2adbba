// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Which of a recording's topics are colour, depth and calibration, where names and contents leave no doubt.
#pragma once

#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

/// A topic with images, and what the first of them says.
struct ImageTopic {
  std::string name;
  std::string encoding;       ///< of the image, once decoded; empty: it cannot be read
  int width = 0, height = 0;  ///< [px]
  std::string frame_id;       ///< without a leading '/'
  bool is_compressed = false;

  bool isDepth() const;
  /// E.g. `/camera/rgb/image_raw: rgb8 of 640x480 px in camera_rgb_optical_frame`
  std::string describe() const;
};

/// The image's topic without what image_transport appends for compressed ones.
std::string withoutTransport(const std::string& topic);

/// Whether the images were rectified by image_proc or a driver, as ROS names them then: image_rect,
/// image_rect_color, and with such an end. Their camera_info is still that of the raw images.
bool isRectifiedByName(const std::string& topic);

/// What is said then.
extern const char* const kAssumedRectified;

/// Where the camera_info of an image may be: beside it, or where RealSense's SDK records it.
std::vector<std::string> cameraInfoTopics(const std::string& image_topic);

/// The one colour topic. Raw is preferred to compressed, colour to grey, and what is not rectified yet.
/// @throws std::runtime_error listing the candidates where there is none or more than one
std::string chooseColourTopic(const std::vector<ImageTopic>& topics);

/// The one depth topic. Preferred are, in this order, one that is registered to colour by its name, by its
/// frame, and by its size.
/// @param colour  name of the colour topic, which need not be among `topics`
/// @throws std::runtime_error listing the candidates where there is none or more than one
std::string chooseDepthTopic(const std::vector<ImageTopic>& topics, const std::string& colour);

}  // namespace rgbd_sfm_fusion
