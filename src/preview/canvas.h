// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace rgbd_sfm_fusion {

/// Text and boxes on an RGB picture.
class Canvas {
 public:
  /// Which part of a text is at the given point: its left end, middle or right end.
  enum class Align { kLeft, kCentre, kRight };

  struct Font {
    double scale;   ///< capitals are 22 px times this high
    int thickness;  ///< [px]
  };

  Canvas(cv::Size size, const cv::Scalar& background) : image_(size, toPixel(background)) {}

  cv::Mat_<cv::Vec3b>& image() { return image_; }

  void fill(const cv::Rect& area, const cv::Scalar& colour);
  /// One pixel around `area`.
  void frame(const cv::Rect& area, const cv::Scalar& colour);
  /// @param point  at the height of the middle of capitals
  void text(const std::string& words, cv::Point point, Align align, const Font& font,
            const cv::Scalar& colour);

  /// [px] Width of a text.
  static int width(const std::string& words, const Font& font);

 private:
  static cv::Vec3b toPixel(const cv::Scalar& colour);

  cv::Mat_<cv::Vec3b> image_;
};

}  // namespace rgbd_sfm_fusion
