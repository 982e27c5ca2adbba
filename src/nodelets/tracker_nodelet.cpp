// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>
#include <rgbd_sfm_fusion/TrackerConfig.h>
#include <sensor_msgs/CameraInfo.h>
#include <std_srvs/Trigger.h>

#include <deque>
#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>

#include "input_watch.h"
#include "odometry_worker.h"
#include "parameters.h"
#include "reconfiguration.h"
#include "rectification_input.h"
#include "rgbd_sfm_fusion/pipeline/frame_preparation.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kSubscriptionQueueSize = 30;
constexpr double kDepthTimeout = 1.0;   // [s] of wall time without depth, after which nothing waits for it
constexpr double kTimeoutPeriod = 0.1;  // [s]

RawImage toRawImage(const sensor_msgs::ImageConstPtr& image, Stamp stamp) {
  if (!image) return {};
  return {stamp, image->encoding, viewImage(image)};
}

}  // namespace

/// Pairs colour and depth images, prepares them, and hands them to the worker that tracks and maps.
class TrackerNodelet : public nodelet::Nodelet {
 private:
  using Associator = DepthAssociator<sensor_msgs::ImageConstPtr, sensor_msgs::ImageConstPtr>;

  void onInit() override {
    ros::NodeHandle& handle = getNodeHandle();
    ros::NodeHandle& private_handle = getPrivateNodeHandle();
    settings_ = readParameters(private_handle, {"odom_frame", "base_frame", "image_transport"});
    associator_ = std::make_unique<Associator>(settings_.association);
    const OdometryWorker::Frames frames{private_handle.param<std::string>("odom_frame", kDefaultOdomFrame),
                                        private_handle.param<std::string>("base_frame", "camera_link")};
    worker_ = std::make_unique<OdometryWorker>(handle, private_handle, getName(), settings_, frames);
    reconfiguration_ = std::make_unique<Reconfiguration<TrackerConfig>>(
        private_handle, SettingScope::kTracker, settings_,
        [this](const Settings& settings) { worker_->setSettings(settings); });
    reset_service_ = private_handle.advertiseService("reset", &TrackerNodelet::reset, this);
    timeout_timer_ =
        handle.createWallTimer(ros::WallDuration(kTimeoutPeriod), &TrackerNodelet::onTimer, this);
    subscribe(handle, private_handle);  // last, as what comes in goes through all of the above
  }

  void subscribe(ros::NodeHandle& handle, ros::NodeHandle& private_handle) {
    transport_ = std::make_unique<image_transport::ImageTransport>(handle);
    const image_transport::TransportHints hints("raw", ros::TransportHints().tcpNoDelay(), private_handle);
    watch_ = std::make_unique<InputWatch>(handle, getName());
    camera_info_subscriber_ =
        handle.subscribe("rgb/camera_info", kSubscriptionQueueSize, &TrackerNodelet::onCameraInfo, this);
    depth_subscriber_ = transport_->subscribe("depth_registered/image_raw", kSubscriptionQueueSize,
                                              &TrackerNodelet::onDepth, this, hints);
    colour_subscriber_ = transport_->subscribe("rgb/image_raw", kSubscriptionQueueSize,
                                               &TrackerNodelet::onColour, this, hints);
    watched_colour_ = watch_->add(colour_subscriber_.getTopic(), "nothing is tracked",
                                  [this] { return colour_subscriber_.getNumPublishers(); });
    watched_info_ = watch_->add(camera_info_subscriber_.getTopic(), "images need their camera's calibration",
                                [this] { return camera_info_subscriber_.getNumPublishers(); });
    watched_depth_ = watch_->add(depth_subscriber_.getTopic(), "colour images are used without depth",
                                 [this] { return depth_subscriber_.getNumPublishers(); });
  }

  void onColour(const sensor_msgs::ImageConstPtr& image) {
    watch_->received(watched_colour_);
    if (image->header.stamp.isZero()) {
      NODELET_ERROR_STREAM_THROTTLE(5, colour_subscriber_.getTopic() << ": images have no time stamp");
      return;
    }
    const ros::WallTime now = ros::WallTime::now();
    if (last_depth_time_.isZero()) last_depth_time_ = now;
    associator_->pushColour(fromRosTime(image->header.stamp), image);
    if ((now - last_depth_time_).toSec() > kDepthTimeout) associator_->flush();
    takePairs();
  }

  void onDepth(const sensor_msgs::ImageConstPtr& image) {
    watch_->received(watched_depth_);
    last_depth_time_ = ros::WallTime::now();
    associator_->pushDepth(fromRosTime(image->header.stamp), image);
    takePairs();
  }

  void onCameraInfo(const sensor_msgs::CameraInfoConstPtr& info) {
    watch_->received(watched_info_);
    try {
      rectification_.update(*info);
      takePairs();
    } catch (const std::invalid_argument& error) {
      worker_->diagnostics().failed(error.what());
      NODELET_ERROR_STREAM_THROTTLE(5, camera_info_subscriber_.getTopic() << ": " << error.what());
    }
  }

  void onTimer(const ros::WallTimerEvent&) {
    if (associator_->waiting() == 0) return;
    if ((ros::WallTime::now() - last_depth_time_).toSec() > kDepthTimeout) {
      associator_->flush();
      takePairs();
    }
  }

  bool reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    worker_->requestReset();
    response.success = 1;
    response.message = "starts anew with the next image";
    return true;
  }

  /// Images that come before their calibration wait for it.
  void takePairs() {
    while (auto pair = associator_->pop()) {
      waiting_.push_back(std::move(*pair));
      if (waiting_.size() > static_cast<std::size_t>(settings_.run.queue_size)) waiting_.pop_front();
      if (rectification_.rectifier()) prepareWaiting();
    }
    if (rectification_.rectifier()) prepareWaiting();
  }

  void prepareWaiting() {
    for (; !waiting_.empty(); waiting_.pop_front()) prepare(waiting_.front());
  }

  void prepare(const Associator::Pair& pair) {
    const Rectifier& rectifier = *rectification_.rectifier();
    TrackerInput input;
    input.header = pair.colour->header;
    input.camera = rectifier.camera();
    input.run = pair.run;
    try {
      input.frame = prepareFrame(rectifier, toRawImage(pair.colour, pair.stamp), {});
    } catch (const std::invalid_argument& error) {
      worker_->diagnostics().failed(error.what());
      NODELET_ERROR_STREAM_THROTTLE(5, colour_subscriber_.getTopic() << ": " << error.what());
      return;
    }
    try {
      input.frame.depth = prepareDepth(rectifier, toRawImage(pair.depth, pair.depth_stamp));
      if (!input.frame.depth.empty()) input.frame.depth_stamp = pair.depth_stamp;
    } catch (const std::invalid_argument& error) {
      NODELET_ERROR_STREAM_THROTTLE(5, depth_subscriber_.getTopic()
                                           << ": " << error.what() << "; depth is not used");
    }
    if (!worker_->push(std::move(input))) return;
    worker_->diagnostics().dropped();
    NODELET_WARN_THROTTLE(5, "images come faster than they can be worked on: some are left out");
  }

  Settings settings_;
  std::unique_ptr<Associator> associator_;
  std::deque<Associator::Pair> waiting_;
  RectificationInput rectification_;
  ros::WallTime last_depth_time_;

  std::unique_ptr<OdometryWorker> worker_;
  std::unique_ptr<Reconfiguration<TrackerConfig>> reconfiguration_;
  std::unique_ptr<InputWatch> watch_;
  std::size_t watched_colour_ = 0, watched_info_ = 0, watched_depth_ = 0;
  ros::ServiceServer reset_service_;
  ros::WallTimer timeout_timer_;
  std::unique_ptr<image_transport::ImageTransport> transport_;
  image_transport::Subscriber colour_subscriber_;
  image_transport::Subscriber depth_subscriber_;
  ros::Subscriber camera_info_subscriber_;
};

}  // namespace rgbd_sfm_fusion

PLUGINLIB_EXPORT_CLASS(rgbd_sfm_fusion::TrackerNodelet, nodelet::Nodelet)
