// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/preview/colour_scale.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "rgbd_sfm_fusion/preview/source_colours.h"

namespace rgbd_sfm_fusion {

ColourScale::ColourScale(int colour_map, bool backwards, std::vector<Tick> ticks)
    : ticks_(std::move(ticks)),
      log_first_(std::log(ticks_.front().value)),
      log_range_(std::log(ticks_.back().value) - log_first_) {
  cv::Mat_<std::uint8_t> levels(1, static_cast<int>(colours_.size()));
  for (int i = 0; i < levels.cols; ++i)
    levels(i) = static_cast<std::uint8_t>(backwards ? levels.cols - 1 - i : i);
  cv::Mat_<cv::Vec3b> bgr;
  cv::applyColorMap(levels, bgr, colour_map);
  for (int i = 0; i < levels.cols; ++i)
    colours_[static_cast<std::size_t>(i)] = {bgr(i)[2], bgr(i)[1], bgr(i)[0]};
}

const ColourScale& ColourScale::depth() {
  static const ColourScale scale(
      cv::COLORMAP_TURBO, false,
      {{0.4, "0.4 m"}, {0.7, "0.7"}, {1, "1 m"}, {2, "2"}, {3, "3"}, {5, "5"}, {10, "10 m"}});
  return scale;
}

const ColourScale& ColourScale::standardDeviation() {
  static const ColourScale scale(cv::COLORMAP_VIRIDIS, true,
                                 {{0.001, "1 mm"}, {0.01, "1 cm"}, {0.1, "10 cm"}, {1, "1 m"}});
  return scale;
}

double ColourScale::place(double value) const {
  return std::clamp((std::log(value) - log_first_) / log_range_, 0.0, 1.0);
}

cv::Vec3b ColourScale::colour(float value) const {
  if (!(value > 0.0F)) return {0, 0, 0};
  const double level = place(static_cast<double>(value)) * static_cast<double>(colours_.size() - 1);
  return colours_[static_cast<std::size_t>(std::lround(level))];
}

cv::Mat_<cv::Vec3b> ColourScale::paint(const cv::Mat_<float>& values) const {
  cv::Mat_<cv::Vec3b> picture(values.size());
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x) picture(y, x) = colour(values(y, x));
  return picture;
}

cv::Mat_<cv::Vec3b> paintSources(const cv::Mat_<std::uint8_t>& provenance) {
  cv::Mat_<cv::Vec3b> picture(provenance.size());
  for (int y = 0; y < provenance.rows; ++y)
    for (int x = 0; x < provenance.cols; ++x) picture(y, x) = sourceColour(provenance(y, x));
  return picture;
}

}  // namespace rgbd_sfm_fusion
