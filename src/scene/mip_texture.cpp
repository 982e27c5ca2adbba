// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/mip_texture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace rgbd_sfm_fusion {

MipTexture::MipTexture(const cv::Mat& rgb) {
  CV_Assert(rgb.type() == CV_8UC3 && rgb.cols >= 2 && rgb.rows >= 2);
  cv::Mat level = rgb, exact;
  rgb.convertTo(exact, CV_16UC3, 256.0);  // so that rounding does not add up over the levels
  while (true) {
    levels_.push_back({level.cols, level.rows, texels_.size()});
    for (const cv::Vec3b& c : cv::Mat_<cv::Vec3b>(level)) texels_.push_back(texelOf(c[0], c[1], c[2]));
    if (level.cols < 4 || level.rows < 4) break;
    cv::Mat half;
    cv::resize(exact, half, cv::Size((level.cols + 1) / 2, (level.rows + 1) / 2), 0.0, 0.0, cv::INTER_AREA);
    exact = half;
    exact.convertTo(level, CV_8UC3, 1.0 / 256.0);
  }
}

}  // namespace rgbd_sfm_fusion
