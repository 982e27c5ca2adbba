// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <opencv2/core.hpp>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"

namespace rgbd_sfm_fusion {

/// Bytes of a point of the cloud.
struct FusedPoint {
  float x, y, z;            ///< [m] optical frame; NaN = none
  std::uint8_t b, g, r, a;  ///< field `rgb`, as PCL and rviz pack it
  float sigma;              ///< [m] standard deviation of z; NaN = none
  std::uint8_t provenance;  ///< values of /fusion/provenance
  std::uint8_t padding[3];
};

struct PointCloudOptions {
  int decimation = 1;             ///< [px] every n-th pixel of every n-th row is taken; nothing is averaged
  unsigned sources = ~0U;         ///< bit n: pixels of provenance n are taken; others are none
  bool colour_by_source = false;  ///< `rgb` is the legend's colour instead of the image's
};

/// Bits of PointCloudOptions::sources.
constexpr unsigned sourceBit(unsigned provenance) {
  return 1U << provenance;
}

/// x y z rgb sigma as FLOAT32 and provenance as UINT8; organised: a row of points for each row of pixels.
/// @param picture  rectified colour image, 8 bit, RGB or grey; empty: points are black
sensor_msgs::PointCloud2Ptr toPointCloud(const std_msgs::Header& header, const FusedFrame& fused,
                                         const PinholeCamera& camera, const cv::Mat& picture,
                                         const PointCloudOptions& options);

}  // namespace rgbd_sfm_fusion
