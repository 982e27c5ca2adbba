// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"

namespace rgbd_sfm_fusion {

/// @param what      the image, as users know it
/// @param expected  whose size is expected, as the message says it
/// @throws std::invalid_argument if the image does not have the camera's size; the message names the image
///         and both sizes
inline void requireSize(const char* what, const cv::Mat& image, const PinholeCamera& camera,
                        const char* expected = "the camera's") {
  if (image.cols == camera.width && image.rows == camera.height) return;
  const auto text = [](int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
  };
  throw std::invalid_argument(std::string(what) + " is " + text(image.cols, image.rows) + ", expected " +
                              expected + " " + text(camera.width, camera.height));
}

/// @throws std::invalid_argument if the image's rows do not follow each other in memory
inline void requireContinuous(const char* what, const cv::Mat& image) {
  if (!image.empty() && !image.isContinuous())
    throw std::invalid_argument(std::string(what) + " is a part of a larger image: expected its clone()");
}

}  // namespace rgbd_sfm_fusion
