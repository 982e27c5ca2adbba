// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "canvas.h"

#include <opencv2/imgproc.hpp>

namespace rgbd_sfm_fusion {
namespace {

constexpr int kFace = cv::FONT_HERSHEY_SIMPLEX;

}  // namespace

cv::Vec3b Canvas::toPixel(const cv::Scalar& colour) {
  return {cv::saturate_cast<std::uint8_t>(colour[0]), cv::saturate_cast<std::uint8_t>(colour[1]),
          cv::saturate_cast<std::uint8_t>(colour[2])};
}

void Canvas::fill(const cv::Rect& area, const cv::Scalar& colour) {
  image_(area & cv::Rect({}, image_.size())).setTo(colour);
}

void Canvas::frame(const cv::Rect& area, const cv::Scalar& colour) {
  cv::rectangle(image_, area + cv::Size(2, 2) - cv::Point(1, 1), colour);
}

void Canvas::text(const std::string& words, cv::Point point, Align align, const Font& font,
                  const cv::Scalar& colour) {
  int baseline = 0;
  const cv::Size size = cv::getTextSize(words, kFace, font.scale, font.thickness, &baseline);
  if (align == Align::kCentre) point.x -= size.width / 2;
  if (align == Align::kRight) point.x -= size.width;
  point.y += size.height / 2;
  cv::putText(image_, words, point, kFace, font.scale, colour, font.thickness, cv::LINE_AA);
}

int Canvas::width(const std::string& words, const Font& font) {
  int baseline = 0;
  return cv::getTextSize(words, kFace, font.scale, font.thickness, &baseline).width;
}

}  // namespace rgbd_sfm_fusion
