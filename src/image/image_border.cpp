// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/image/image_border.h"

#include <opencv2/core.hpp>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kEven = 8.0;  // [grey levels] that compression leaves of one brightness
constexpr int kEdge = 8;       // [px] a block of a JPEG file: the border's edge is that wide

bool isEven(const cv::Mat& pixels) {
  double least = 0.0, most = 0.0;
  cv::minMaxLoc(pixels, &least, &most);
  return most - least <= kEven;
}

/// @param side  the n-th row or column from a side of the image
/// @return [px] width of the border there, with its edge
template <class Side>
int width(int rows, const Side& side) {
  int even = 0;
  while (even < rows && isEven(side(even))) ++even;
  return even > 0 ? even + kEdge : 0;
}

}  // namespace

cv::Rect insideBorder(const GreyImage& grey, const cv::Rect& seen) {
  const cv::Mat image = grey(seen);
  const int columns = image.cols, rows = image.rows;
  const int top = width(rows, [&](int n) { return image.row(n); });
  const int bottom = width(rows, [&](int n) { return image.row(rows - 1 - n); });
  const int left = width(columns, [&](int n) { return image.col(n); });
  const int right = width(columns, [&](int n) { return image.col(columns - 1 - n); });
  if (2 * (left + right) > columns || 2 * (top + bottom) > rows) return seen;
  return {seen.x + left, seen.y + top, columns - left - right, rows - top - bottom};
}

}  // namespace rgbd_sfm_fusion
