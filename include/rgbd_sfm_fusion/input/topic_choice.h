// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Finds a recording's colour, depth and calibration topics, if names and contents leave no doubt.
#pragma once

#include <string>
#include <vector>

namespace rgbd_sfm_fusion {

/// A topic with images, and what its first image says.
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

/// The topic's name without the ending of image_transport's compressed topics.
std::string withoutTransport(const std::string& topic);

/// Whether the name says that the images were rectified by image_proc or a driver: image_rect,
/// image_rect_color, or such an ending. The camera_info of such images still describes the raw images.
bool isRectifiedByName(const std::string& topic);

/// The text that tells the user that images count as rectified by their name.
extern const char* const kAssumedRectified;

/// The topics that may have the camera_info of an image: beside the image, or where RealSense's SDK records
/// it.
std::vector<std::string> cameraInfoTopics(const std::string& image_topic);

/// The one colour topic. Raw images are preferred to compressed ones, colour to grey, and unrectified to
/// rectified ones.
/// @throws std::runtime_error listing the candidates where there is none or more than one
std::string chooseColourTopic(const std::vector<ImageTopic>& topics);

/// The one depth topic. Topics registered to colour are preferred: by their name first, then by their frame,
/// then by their size.
/// @param colour  name of the colour topic, which need not be among `topics`
/// @throws std::runtime_error listing the candidates where there is none or more than one
std::string chooseDepthTopic(const std::vector<ImageTopic>& topics, const std::string& colour);

}  // namespace rgbd_sfm_fusion
