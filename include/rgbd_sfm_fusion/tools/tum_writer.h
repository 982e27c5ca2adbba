// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <string>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/tools/pending_file.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Writes a sequence in the layout of the TUM RGB-D benchmark. It grows in DIRECTORY.part. finish() gives
/// that its final name; if finish() is never called, it is removed.
///
/// Every function throws std::runtime_error naming the file that can't be written.
class TumWriter {
 public:
  /// @param depth_scale [1/m] of the values in depth images
  TumWriter(const std::filesystem::path& directory, const PinholeCamera& camera, double depth_scale,
            const std::string& remark);
  TumWriter(const TumWriter&) = delete;
  TumWriter& operator=(const TumWriter&) = delete;

  /// @param rgb   CV_8UC3; if empty, `rgb_path` is listed and nothing is written
  /// @param depth CV_16UC1
  void add(Stamp stamp, const cv::Mat& rgb, Stamp depth_stamp, const cv::Mat& depth,
           const SE3& T_world_camera);

  /// Adds another kind of image, which the layout does not define, as SUBDIRECTORY/stamp.png.
  void addExtra(const std::string& subdirectory, Stamp stamp, const cv::Mat& image);

  /// Folder of this sequence's colour images, for sequences that have none of their own.
  void setColourDirectory(const std::string& relative_path) { colour_directory_ = relative_path; }

  void finish();

 private:
  std::string writeImage(const std::string& subdirectory, Stamp stamp, const cv::Mat& image);
  std::ofstream open(const std::string& name) const;
  void close(std::ofstream& file, const std::string& name) const;

  std::filesystem::path final_;
  PendingFolder part_folder_;
  std::filesystem::path part_;
  std::string colour_directory_ = "rgb";
  std::ofstream rgb_, depth_, associations_, groundtruth_;
};

/// Seconds with six decimals.
std::string stampText(Stamp stamp);

}  // namespace rgbd_sfm_fusion
