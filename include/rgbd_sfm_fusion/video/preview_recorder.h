// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "rgbd_sfm_fusion/pipeline/pipeline.h"
#include "rgbd_sfm_fusion/preview/preview.h"
#include "rgbd_sfm_fusion/preview/stamp_rate.h"
#include "rgbd_sfm_fusion/video/preview_writer.h"

namespace rgbd_sfm_fusion {

/// Writes the previews of a run into a file.
class PreviewRecorder {
 public:
  /// @throws std::runtime_error as PreviewWriter
  explicit PreviewRecorder(const std::string& path)
      : writer_(path, {PreviewLayout::kWidth, PreviewLayout::kHeight}) {}

  /// @param picture  rectified colour image, as PreviewFrame has it
  /// @throws std::runtime_error as PreviewWriter
  void add(const PipelineResult& result, const cv::Mat& picture) {
    rate_.add(result.fused.stamp);
    PreviewFrame frame;
    frame.picture = picture;
    frame.sensor = result.mapped.frame.depth;
    frame.fused = result.fused;
    frame.state = result.mapped.tracked.state;
    frame.rate = rate_.rate();
    writer_.write(result.fused.stamp, drawPreview(frame));
  }

  /// @throws std::runtime_error as PreviewWriter
  void finish() { writer_.finish(); }
  /// @throws std::runtime_error as PreviewWriter
  void commit() { writer_.commit(); }

  const PreviewWriter& writer() const { return writer_; }

 private:
  StampRate rate_;
  PreviewWriter writer_;
};

}  // namespace rgbd_sfm_fusion
