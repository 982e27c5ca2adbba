// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// What is drawn of a frame. All images have the same size; any size will do.
struct PreviewFrame {
  cv::Mat picture;    ///< rectified colour image: 8 bit, RGB or grey; empty: it did not come
  DepthImage sensor;  ///< [m] as measured, rectified; empty: none belongs to this frame
  FusedFrame fused;
  TrackingState state = TrackingState::kInitialising;
  double rate = std::numeric_limits<double>::quiet_NaN();     ///< [Hz] of fused frames; NaN: not known yet
  double latency = std::numeric_limits<double>::quiet_NaN();  ///< [s] NaN offline
};

/// Places of the panels in the picture, by rows. Each image lies in the middle of its panel.
struct PreviewLayout {
  static constexpr int kWidth = 1280;  ///< [px]
  static constexpr int kHeight = 720;  ///< [px]
  enum Panel { kPicture, kSensor, kSfm, kFused, kSource, kStandardDeviation };

  static cv::Rect panel(Panel panel);
  /// Part of the panel that an image of `size` fills.
  static cv::Rect imageIn(Panel panel, cv::Size size);
};

/// Draws one picture (RGB) for people who do not know the package: it tells what fusion adds, how sure that
/// is, and how tracking goes. It shows the image, sensor depth, SfM depth, fused depth, its source and its
/// standard deviation, with colour bars, legend, shares, rate and state.
cv::Mat_<cv::Vec3b> drawPreview(const PreviewFrame& frame);

}  // namespace rgbd_sfm_fusion
