// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>

#include <thread>

#include "bounded_queue.h"
#include "fusion_output.h"

namespace rgbd_sfm_fusion {

/// Draws previews in a thread of its own, always of the newest frame, and at most ten times a second: people
/// see no more, and nothing that machines need waits for pictures. The very last frame is always drawn.
class PreviewWorker {
 public:
  struct Job {
    FusionOutput output;
    cv::Mat picture;                       ///< rectified colour image; empty: it did not come
    sensor_msgs::ImageConstPtr pixels_of;  ///< `picture` may be a view of this
    double rate;                           ///< [Hz] of fused frames
  };

  /// @param publisher  of this topic; a copy of it is kept
  explicit PreviewWorker(const image_transport::Publisher& publisher);
  ~PreviewWorker();

  PreviewWorker(const PreviewWorker&) = delete;
  PreviewWorker& operator=(const PreviewWorker&) = delete;

  void draw(Job job) { jobs_.push(std::move(job)); }

 private:
  void run();

  image_transport::Publisher publisher_;
  BoundedQueue<Job> jobs_{1};
  std::thread thread_;  ///< last, as it uses the others
};

}  // namespace rgbd_sfm_fusion
