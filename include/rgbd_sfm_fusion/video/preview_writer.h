// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/tools/pending_file.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Writes pictures of one size into a video, or into a folder as 000000.png, 000001.png and so on. The video
/// or folder appears under its name only when it is complete.
class PreviewWriter {
 public:
  /// @param path  With the ending .avi, .mp4, .mkv or .mov a video, if OpenCV has a codec for it; see
  ///              usedFolderInstead(). Otherwise a folder, which may be there already if it is empty or an
  ///              earlier preview.
  /// @throws std::runtime_error naming the path and the reason when it can't be written
  PreviewWriter(const std::string& path, cv::Size size);
  ~PreviewWriter();

  PreviewWriter(const PreviewWriter&) = delete;
  PreviewWriter& operator=(const PreviewWriter&) = delete;

  /// Where the video or folder will appear.
  const std::string& path() const { return path_; }
  /// True if a video was asked for, but there is no codec: path() has lost its ending, and is a folder.
  bool usedFolderInstead() const { return used_folder_instead_; }

  /// @param stamp  of the frame; the first stamps decide on the rate of the video
  /// @param rgb    of the size that was given at first
  /// @throws std::runtime_error naming the path when it can't be written, e.g. when the disk is full
  void write(Stamp stamp, const cv::Mat_<cv::Vec3b>& rgb);

  /// To be called after the last picture. @throws as write()
  void finish();
  /// Gives the file or folder its name. @throws as write()
  void commit();

 private:
  bool openVideo(double rate);
  void openFolder();
  void startVideo();
  void writePng(const cv::Mat& bgr);

  std::string path_;
  cv::Size size_;
  bool used_folder_instead_ = false;

  std::unique_ptr<PendingFile> file_;  ///< the video; null for a folder
  cv::VideoWriter video_;
  std::vector<Stamp> first_stamps_;
  std::vector<cv::Mat> first_pictures_;  ///< BGR, until the rate is known

  std::string temporary_folder_;
  int written_ = 0;  ///< number of pictures
};

/// [Hz] Rate of a video whose frames have these stamps, by the median time between them; 30 if they are too
/// few.
double videoRate(const std::vector<Stamp>& stamps);

}  // namespace rgbd_sfm_fusion
