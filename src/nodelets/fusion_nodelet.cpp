// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>
#include <rgbd_sfm_fusion/FusionConfig.h>
#include <sensor_msgs/CameraInfo.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <utility>

#include "fusion_diagnostics.h"
#include "fusion_inputs.h"
#include "fusion_publisher.h"
#include "input_watch.h"
#include "parameters.h"
#include "reconfiguration.h"
#include "rectification_input.h"
#include "rgbd_sfm_fusion/pipeline/frame_preparation.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"
#include "rgbd_sfm_fusion/ros/tracker_messages.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kFrameQueueSize = 100;
constexpr std::uint32_t kImageQueueSize = 30;
constexpr double kTimeoutPeriod = 0.1;  // [s]

/// A keyframe whose images are those of `message`, which lives as long.
std::shared_ptr<const KeyframeMap> viewOf(const KeyframeConstPtr& message) {
  const auto view = std::make_shared<std::pair<KeyframeConstPtr, KeyframeMap>>(message, fromMessage(message));
  return {view, &view->second};
}

}  // namespace

/// Fuses sensor depth with the tracker's keyframes: one result for every tracked frame.
class FusionNodelet : public nodelet::Nodelet {
 private:
  void onInit() override {
    ros::NodeHandle& handle = getNodeHandle();
    ros::NodeHandle& private_handle = getPrivateNodeHandle();
    settings_ = readParameters(private_handle, {"image_transport"});
    inputs_ = std::make_unique<FusionInputs>(static_cast<std::size_t>(settings_.run.queue_size));
    publisher_ = std::make_unique<FusionPublisher>(handle, private_handle);
    publisher_->setPointsDecimation(settings_.run.points_decimation);
    diagnostics_ = std::make_unique<FusionDiagnostics>(handle, private_handle, getName());
    reconfiguration_ = std::make_unique<Reconfiguration<FusionConfig>>(
        private_handle, SettingScope::kFusion, settings_,
        [this](const Settings& settings) { apply(settings); });
    timeout_timer_ = handle.createWallTimer(ros::WallDuration(kTimeoutPeriod),
                                            [this](const ros::WallTimerEvent&) { fuseWaiting(); });
    subscribe(handle, private_handle);
  }

  void subscribe(ros::NodeHandle& handle, ros::NodeHandle& private_handle) {
    transport_ = std::make_unique<image_transport::ImageTransport>(handle);
    const image_transport::TransportHints hints("raw", ros::TransportHints().tcpNoDelay(), private_handle);
    watch_ = std::make_unique<InputWatch>(handle, getName());
    keyframe_subscriber_ =
        handle.subscribe("tracker/keyframe", kImageQueueSize, &FusionNodelet::onKeyframe, this);
    frame_subscriber_ = handle.subscribe("tracker/frame", kFrameQueueSize, &FusionNodelet::onTracked, this);
    depth_subscriber_ = transport_->subscribe("depth_registered/image_raw", kImageQueueSize,
                                              &FusionNodelet::onDepth, this, hints);
    camera_info_subscriber_ =
        handle.subscribe("rgb/camera_info", kImageQueueSize, &FusionNodelet::onCameraInfo, this);
    // Last, and nobody else subscribes to it: a bag player that waits for subscribers waits for this nodelet.
    depth_info_subscriber_ =
        handle.subscribe("depth_registered/camera_info", kImageQueueSize, &FusionNodelet::onDepthInfo, this);
    watched_frames_ = watch_->add(frame_subscriber_.getTopic(), "nothing is fused",
                                  [this] { return frame_subscriber_.getNumPublishers(); });
    watched_info_ = watch_->add(camera_info_subscriber_.getTopic(), "depth needs the camera's calibration",
                                [this] { return camera_info_subscriber_.getNumPublishers(); });
    watched_depth_ = watch_->add(depth_subscriber_.getTopic(), "there is SfM depth only",
                                 [this] { return depth_subscriber_.getNumPublishers(); });
  }

  void onTracked(const TrackedFrameConstPtr& tracked) {
    watch_->received(watched_frames_);
    if (inputs_->pushTracked(tracked, ros::WallTime::now())) {
      diagnostics_->dropped();
      NODELET_WARN_THROTTLE(5, "frames come faster than they can be fused: some are left out");
    }
    fuseWaiting();
  }

  void onKeyframe(const KeyframeConstPtr& keyframe) {
    inputs_->pushKeyframe(keyframe);
    fuseWaiting();
  }

  void onDepth(const sensor_msgs::ImageConstPtr& depth) {
    watch_->received(watched_depth_);
    inputs_->pushDepth(depth);
    fuseWaiting();
  }

  void onCameraInfo(const sensor_msgs::CameraInfoConstPtr& info) {
    watch_->received(watched_info_);
    try {
      if (!rectification_.update(*info)) return;
      fusion_ = std::make_unique<DepthFusion>(rectification_.rectifier()->camera(), settings_.fusion);
      fuseWaiting();
    } catch (const std::invalid_argument& error) {
      fusion_.reset();
      diagnostics_->failed(error.what());
      NODELET_ERROR_STREAM_THROTTLE(5, camera_info_subscriber_.getTopic() << ": " << error.what());
    }
  }

  void onDepthInfo(const sensor_msgs::CameraInfoConstPtr& info) {
    if (!rectification_.rectifier()) return;
    const auto difference = differenceOfDepthCamera(rectification_.calibration(), toCalibration(*info));
    if (!difference) return;
    NODELET_WARN_STREAM_THROTTLE(30, depth_info_subscriber_.getTopic()
                                         << " is not that of colour, which is used: " << *difference
                                         << ". Is depth registered to colour?");
  }

  void apply(const Settings& settings) {
    if (fusion_) fusion_->setOptions(settings.fusion);
    publisher_->setPointsDecimation(settings.run.points_decimation);
    settings_ = settings;
  }

  /// A new run of the tracker has another unit of length.
  void restartIfNew(const TrackedFrame& tracked) {
    if (tracked.run == run_) return;
    run_ = tracked.run;
    fusion_->reset();
    publisher_->restart();
    NODELET_INFO("the tracker started anew, and so does fusion");
  }

  void fuseWaiting() {
    if (!fusion_) return;
    while (const auto frame = inputs_->pop(ros::WallTime::now())) {
      if (!frame->missing.empty()) {
        NODELET_WARN_STREAM_THROTTLE(
            5, "a frame was fused without " << frame->missing << ", which did not come");
      }
      try {
        fuse(*frame);
      } catch (const std::exception& error) {  // nothing that a message holds may end the process
        diagnostics_->failed(error.what());
        NODELET_ERROR_STREAM_THROTTLE(5, "frame left out: " << error.what());
      }
    }
  }

  void fuse(const FusionInputs::Frame& input) {
    restartIfNew(*input.tracked);
    const std_msgs::Header& header = input.tracked->header;
    const TrackingResult tracked = fromMessage(*input.tracked);
    std::shared_ptr<const KeyframeMap> keyframe;
    if (input.keyframe) keyframe = viewOf(input.keyframe);
    RgbdFrame frame;
    frame.stamp = tracked.stamp;
    frame.depth = sensorDepth(input.depth);
    if (!frame.depth.empty()) frame.depth_stamp = fromRosTime(input.depth->header.stamp);

    const FusedFrame fused = fusion_->fuse(tracked, keyframe, frame);
    publisher_->publish(
        {header, fused, rectification_.rectifier(), tracked.state, frame.depth, frame.depth_stamp});
    diagnostics_->fused(fused, (ros::Time::now() - header.stamp).toSec());
  }

  /// Empty where it can't be used.
  DepthImage sensorDepth(const sensor_msgs::ImageConstPtr& image) {
    if (!image) return {};
    try {
      const RawImage raw{fromRosTime(image->header.stamp), image->encoding, viewImage(image)};
      return prepareDepth(*rectification_.rectifier(), raw);
    } catch (const std::invalid_argument& error) {
      NODELET_ERROR_STREAM_THROTTLE(5, depth_subscriber_.getTopic()
                                           << ": " << error.what() << "; it is not used");
      return {};
    }
  }

  Settings settings_;
  RectificationInput rectification_;
  std::unique_ptr<DepthFusion> fusion_;
  std::unique_ptr<FusionInputs> inputs_;
  std::uint32_t run_ = 0;

  std::unique_ptr<FusionPublisher> publisher_;
  std::unique_ptr<FusionDiagnostics> diagnostics_;
  std::unique_ptr<Reconfiguration<FusionConfig>> reconfiguration_;
  std::unique_ptr<InputWatch> watch_;
  std::size_t watched_frames_ = 0, watched_info_ = 0, watched_depth_ = 0;
  ros::WallTimer timeout_timer_;
  std::unique_ptr<image_transport::ImageTransport> transport_;
  image_transport::Subscriber depth_subscriber_;
  ros::Subscriber frame_subscriber_;
  ros::Subscriber keyframe_subscriber_;
  ros::Subscriber camera_info_subscriber_;
  ros::Subscriber depth_info_subscriber_;
};

}  // namespace rgbd_sfm_fusion

PLUGINLIB_EXPORT_CLASS(rgbd_sfm_fusion::FusionNodelet, nodelet::Nodelet)
