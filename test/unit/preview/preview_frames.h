// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "rgbd_sfm_fusion/preview/preview.h"

namespace rgbd_sfm_fusion {

/// A frame in vertical stripes, one for each source from 0 to 4, of depth 1 m and sigma 1 cm. The sensor sees
/// stripes 1 and 3, SfM 2 and 3. The image has one colour.
inline PreviewFrame stripedFrame(cv::Size size) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  PreviewFrame frame;
  frame.picture = cv::Mat(size, CV_8UC3, cv::Scalar(200, 100, 50));
  frame.sensor = cv::Mat_<float>(size, nan);
  frame.fused.depth = {cv::Mat_<float>(size, 1.0F), cv::Mat_<float>(size, 1e-4F)};
  frame.fused.sfm = {cv::Mat_<float>(size, nan), cv::Mat_<float>(size, nan)};
  frame.fused.provenance.create(size);
  for (int source = 0; source < 5; ++source) {
    const cv::Rect stripe(source * size.width / 5, 0, (source + 1) * size.width / 5 - source * size.width / 5,
                          size.height);
    frame.fused.provenance(stripe) = static_cast<std::uint8_t>(source);
    if (source == 0) {
      frame.fused.depth.mean(stripe) = nan;
      frame.fused.depth.variance(stripe) = nan;
    }
    if (source == 1 || source == 3) frame.sensor(stripe) = 2.0F;
    if (source == 2 || source == 3) frame.fused.sfm.mean(stripe) = 5.0F;
  }
  frame.fused.scale.alpha = 1.0;
  frame.fused.scale.sigma = 0.002;
  frame.state = TrackingState::kTracking;
  frame.rate = 30.0;
  frame.latency = 0.045;
  return frame;
}

}  // namespace rgbd_sfm_fusion
