// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <image_transport/image_transport.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <deque>
#include <memory>

#include "colour_input.h"
#include "fusion_output.h"
#include "preview_worker.h"
#include "rgbd_sfm_fusion/preview/stamp_rate.h"

namespace rgbd_sfm_fusion {

/// The topics of fusion that show the colour image: image_rect, preview and points. The colour image is
/// subscribed to while one of them is; what has been fused waits for it here, and nothing else does.
class PicturePublisher {
 public:
  /// Made, like all that is called back, while the guard is locked.
  PicturePublisher(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                   CallbackGuard* guard);

  void publish(const FusionOutput& output);

  /// @param decimation  [px] of the points
  void setPointsDecimation(int decimation) { points_decimation_ = decimation; }

 private:
  struct Waiting {
    FusionOutput output;
    double rate;  ///< [Hz] of fused frames, this one included
    ros::Time since;
  };

  bool isWanted() const;
  void subscribeIfWanted();
  void publishWaiting();
  void publishWith(const sensor_msgs::ImageConstPtr& colour, const Waiting& frame);
  /// May be a view of `colour`. Empty where there is no image, or none that can be shown.
  cv::Mat rectifiedPicture(const sensor_msgs::ImageConstPtr& colour, const FusionOutput& output) const;

  ColourInput colour_input_;
  ColourBuffer colour_;
  image_transport::Publisher image_rect_;
  image_transport::Publisher preview_;
  std::unique_ptr<PreviewWorker> preview_worker_;
  ros::Publisher points_;
  int points_decimation_ = 1;
  StampRate rate_;
  std::deque<Waiting> waiting_;
};

}  // namespace rgbd_sfm_fusion
