// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The messages about a fused frame.
#pragma once

#include <rgbd_sfm_fusion/FusionStatistics.h>
#include <rgbd_sfm_fusion/Scale.h>
#include <sensor_msgs/Image.h>

#include <string>
#include <vector>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"

namespace rgbd_sfm_fusion {

/// An image topic below /fusion, and how its messages are made. That is done only if somebody wants them.
struct FusionImageTopic {
  std::string name;  ///< e.g. `mean`
  bool is_picture;   ///< for people, so it may be compressed with losses; measures and labels may not
  sensor_msgs::ImagePtr (*make)(const std_msgs::Header&, const FusedFrame&);
};

const std::vector<FusionImageTopic>& fusionImageTopics();

/// rgb8 or mono8.
/// @param picture  8 bit, RGB or grey
sensor_msgs::ImagePtr toPictureMessage(const std_msgs::Header& header, const cv::Mat& picture);

Scale toScaleMessage(const std_msgs::Header& header, const ScaleEstimate& scale);

/// Sums over frames for the shares since start.
struct FusionTotals {
  ProvenanceCounts counts;
  std::uint64_t disagreeing = 0;  ///< [px]

  void add(const FusedFrame& fused) {
    counts += fused.counts;
    disagreeing += fused.disagreeing;
  }
};

/// @param totals   including this frame
/// @param latency  [s] NaN offline
/// @param skew     [s] NaN without a depth image
FusionStatistics toStatisticsMessage(const std_msgs::Header& header, const FusedFrame& fused,
                                     const FusionTotals& totals, double latency, double skew);

/// Share of the pixels with any depth; 0 if there are none.
double disagreementShare(std::uint64_t disagreeing, const ProvenanceCounts& counts);

/// [s] NaN if there is no depth image.
double skewSeconds(Stamp colour, Stamp depth);

}  // namespace rgbd_sfm_fusion
