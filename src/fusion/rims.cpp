// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/rims.h"

#include <opencv2/imgproc.hpp>

namespace rgbd_sfm_fusion {

void dropAtRims(const GaussianDepth& sensor, int width, GaussianDepth& sfm) {
  if (width == 0) return;
  const cv::Mat measured = sensor.variance > 0.0;
  cv::Mat near;
  cv::dilate(measured, near, cv::Mat::ones(2 * width + 1, 2 * width + 1, CV_8U));
  const cv::Mat rims = near & ~measured;
  sfm.mean.setTo(static_cast<double>(kNoDepth), rims);
  sfm.variance.setTo(static_cast<double>(kNoDepth), rims);
}

}  // namespace rgbd_sfm_fusion
