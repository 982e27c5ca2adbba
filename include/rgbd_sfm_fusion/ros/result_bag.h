// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/pipeline/pipeline.h"
#include "rgbd_sfm_fusion/ros/bag_output.h"
#include "rgbd_sfm_fusion/ros/fusion_messages.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"

namespace rgbd_sfm_fusion {

/// The bag of fused frames, with the messages that the nodelets would have published.
class ResultBag {
 public:
  /// @param more_topics  beyond those that are always written
  /// @throws std::invalid_argument for an unknown topic, listing the known ones
  /// @throws std::runtime_error when the file can't be written
  ResultBag(const std::string& path, const std::vector<std::string>& more_topics,
            BagCompression compression = BagCompression::kNone);

  /// Whether one of the topics shows the colour image.
  bool needsPicture() const;

  /// @param frame_id  of the colour image
  /// @param picture   rectified, 8 bit, RGB or grey; not used unless needsPicture()
  void write(const PipelineResult& result, const PinholeCamera& camera, const std::string& frame_id,
             const cv::Mat& picture);

  void commit() { bag_.commit(); }

 private:
  bool has(const std::string& topic) const { return topics_.count(topic) > 0; }
  void writePictures(const std_msgs::Header& header, const FusedFrame& fused, const PinholeCamera& camera,
                     const cv::Mat& picture);
  void writeTracked(const std_msgs::Header& header, const PinholeCamera& camera,
                    const PipelineResult& result);
  void writeKeyframe(const std_msgs::Header& header, const PinholeCamera& camera,
                     const KeyframeMap& keyframe);

  std::set<std::string> topics_;
  BagOutput bag_;
  FusionTotals totals_;
  VelocityEstimator velocities_;
  std::uint32_t run_ = kFirstRun;
};

}  // namespace rgbd_sfm_fusion
