// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <nodelet/nodelet.h>
#include <rgbd_sfm_fusion/TrackerConfig.h>
#include <sensor_msgs/CameraInfo.h>
#include <std_srvs/Trigger.h>

#include <deque>
#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <utility>

#include "callback_guard.h"
#include "image_subscription.h"
#include "input_watch.h"
#include "odometry_worker.h"
#include "parameters.h"
#include "reconfiguration.h"
#include "rectification_input.h"
#include "rgbd_sfm_fusion/input/registration.h"
#include "rgbd_sfm_fusion/input/topic_choice.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"
#include "rgbd_sfm_fusion/ros/stamp.h"
#include "shared_preparation.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kSubscriptionQueueSize = 30;
constexpr double kDepthTimeout = 1.0;   // [s] without depth, after which nothing waits for it
constexpr double kTimeoutPeriod = 0.1;  // [s] of wall time

}  // namespace

/// Pairs colour and depth images, prepares them, and hands them to the worker that tracks and maps.
class TrackerNodelet : public nodelet::Nodelet {
 private:
  using Associator = DepthAssociator<sensor_msgs::ImageConstPtr, sensor_msgs::ImageConstPtr>;

  void onInit() override {
    guard_ = std::make_unique<CallbackGuard>(getName());
    const CallbackGuard::Lock until_all_is_made = guard_->lock();
    ros::NodeHandle& handle = getNodeHandle();
    ros::NodeHandle& private_handle = getPrivateNodeHandle();
    settings_ =
        readParameters(private_handle, SettingScope::kTracker,
                       {"odom_frame", "base_frame", "rgb_transport", "depth_transport", "camera_info_url"});
    associator_ = std::make_unique<Associator>(settings_.association);
    const OdometryWorker::FrameNames frame_names{
        private_handle.param<std::string>("odom_frame", kDefaultOdomFrame),
        private_handle.param<std::string>("base_frame", "camera_link")};
    worker_ = std::make_unique<OdometryWorker>(handle, private_handle, guard_.get(), getName(), settings_,
                                               frame_names);
    guard_->setFailureHandler([this](const std::string& reason) { worker_->diagnostics().failed(reason); });
    reconfiguration_ = std::make_unique<Reconfiguration<TrackerConfig>>(
        private_handle, guard_->mutex(), SettingScope::kTracker, settings_,
        [this](const Settings& settings) { worker_->setSettings(settings); });
    reset_service_ = private_handle.advertiseService("reset", &TrackerNodelet::reset, this);
    timeout_timer_ = handle.createWallTimer(
        ros::WallDuration(kTimeoutPeriod),
        guard_->forEvents<ros::WallTimerEvent>("timeout", [this] { giveUpOnDepth(); }));
    subscribe(handle, private_handle);
    guard_->run("camera_info_url", [&] {
      if (!rectification_.load(private_handle.param<std::string>("camera_info_url", ""))) return;
      watch_->received(watched_info_);
      describeCamera();
    });
  }

  void subscribe(ros::NodeHandle& handle, ros::NodeHandle& private_handle) {
    const std::string colour = handle.resolveName("rgb/image_raw");
    const std::string info = handle.resolveName("rgb/camera_info");
    const std::string depth = handle.resolveName("depth_registered/image_raw");
    rectification_.setTopics(colour, depth);
    watch_ = std::make_unique<InputWatch>(handle, guard_.get(), getName());
    watched_colour_ =
        watch_->add(colour, "nothing is tracked", [this] { return colour_subscriber_.getNumPublishers(); });
    watched_info_ = watch_->addNeededOnce(
        info, "images need their camera's calibration; camera_info_url gives it from a file",
        [this] { return camera_info_subscriber_.getNumPublishers(); });
    watched_depth_ = watch_->add(depth, "colour images are used without depth",
                                 [this] { return depth_subscriber_.getNumPublishers(); });
    camera_info_subscriber_ = handle.subscribe<sensor_msgs::CameraInfo>(
        info, kSubscriptionQueueSize,
        guard_->forMessages<sensor_msgs::CameraInfo>(info, [this](const auto& m) { onCameraInfo(*m); }));
    depth_subscriber_.subscribe(handle, private_handle, "depth_transport", depth, kSubscriptionQueueSize,
                                guard_.get(), [this](const auto& m) { onDepth(m); });
    colour_subscriber_.subscribe(handle, private_handle, "rgb_transport", colour, kSubscriptionQueueSize,
                                 guard_.get(), [this](const auto& m) { onColour(m); });
  }

  void onColour(const sensor_msgs::ImageConstPtr& image) {
    watch_->received(watched_colour_);
    requireStamp(*image);
    associator_->pushColour(fromRosTime(image->header.stamp), image);
    giveUpOnDepth();
    takePairs();
  }

  void onDepth(const sensor_msgs::ImageConstPtr& image) {
    watch_->received(watched_depth_);
    requireStamp(*image);
    last_depth_time_ = ros::Time::now();
    associator_->pushDepth(fromRosTime(image->header.stamp), image);
    takePairs();
  }

  static void requireStamp(const sensor_msgs::Image& image) {
    const ros::Time& stamp = image.header.stamp;
    if (stamp.isZero())
      throw std::invalid_argument(
          "images have no time stamp (0), so that colour and depth cannot be paired: set header.stamp "
          "where they are published");
    if (!isUsable(stamp))
      throw std::invalid_argument("an image is stamped " + std::to_string(stamp.sec) + " s and " +
                                  std::to_string(stamp.nsec) + " ns: " + describeUsableStamps());
  }

  void onCameraInfo(const sensor_msgs::CameraInfo& info) {
    watch_->received(watched_info_);
    if (rectification_.update(info)) describeCamera();
    takePairs();
  }

  /// Depth of another size needs it. It is not subscribed to at once: a bag player that waits for subscribers
  /// of this topic then waits for fusion, which is the only subscriber until it listens to this nodelet.
  void subscribeToDepthInfo() {
    if (depth_info_subscriber_) return;
    const std::string topic = getNodeHandle().resolveName("depth_registered/camera_info");
    depth_info_subscriber_ = getNodeHandle().subscribe<sensor_msgs::CameraInfo>(
        topic, kSubscriptionQueueSize,
        guard_->forMessages<sensor_msgs::CameraInfo>(
            topic, [this](const auto& m) { rectification_.updateDepth(*m); }));
  }

  bool isOfAnotherSize(const sensor_msgs::Image& depth) const {
    const CameraCalibration& colour = rectification_.calibration();
    return depth.width != static_cast<std::uint32_t>(colour.width) ||
           depth.height != static_cast<std::uint32_t>(colour.height);
  }

  void describeCamera() {
    const PinholeCamera& camera = rectification_.rectifier()->camera();
    const std::string unused = unusedParts(rectification_.calibration());
    if (rectification_.colourIsRectified())
      NODELET_INFO_STREAM(colour_subscriber_.getTopic() << ": " << kAssumedRectified);
    NODELET_INFO_STREAM(
        "camera of " << camera.width << "x" << camera.height << " px, focal length " << camera.fx << " px, "
                     << (rectification_.rectifier()->isIdentity() ? "nothing to rectify"
                                                                  : "images are rectified")
                     << (unused.empty() ? "" : "; " + unused + " of camera_info is not used"));
  }

  /// Where depth fails to come, colour goes on without it. By ROS's clock: a bag that is paused, or played
  /// slowly, loses nothing.
  void giveUpOnDepth() {
    if (worker_->hasListener()) subscribeToDepthInfo();
    const ros::Time now = ros::Time::now();
    if (last_depth_time_.isZero() || now < last_depth_time_) last_depth_time_ = now;
    if (associator_->waiting() == 0 || secondsBetween(last_depth_time_, now) <= kDepthTimeout) return;
    associator_->flush();
    takePairs();
  }

  bool reset(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response) {
    worker_->requestReset();
    response.success = 1;
    response.message = "the tracker will start anew with the next image";
    return true;
  }

  /// Images that come before their calibration wait for it.
  void takePairs() {
    while (auto pair = associator_->pop()) {
      waiting_.push_back(std::move(*pair));
      if (waiting_.size() > static_cast<std::size_t>(settings_.run.queue_size)) waiting_.pop_front();
      prepareWaiting();
    }
    prepareWaiting();
  }

  void prepareWaiting() {
    while (rectification_.rectifier() && !waiting_.empty()) {
      const Associator::Pair pair = std::move(waiting_.front());
      waiting_.pop_front();
      prepare(pair);
    }
  }

  void prepare(const Associator::Pair& pair) {
    const std::shared_ptr<const Rectifier> rectifier = rectification_.rectifier();
    TrackerInput input;
    input.header = pair.colour->header;
    input.header.frame_id = withoutSlash(input.header.frame_id);
    input.camera = rectifier->camera();
    input.run = pair.run;
    input.frame.stamp = pair.stamp;
    input.frame.seen = rectifier->seen();
    try {
      input.frame.grey = sharedGrey(pair.colour, rectifier);
    } catch (const std::invalid_argument& error) {
      guard_->report(colour_subscriber_.getTopic(), error.what());
      return;
    }
    if (pair.depth && isOfAnotherSize(*pair.depth)) subscribeToDepthInfo();
    try {
      input.frame.depth = sharedDepth(pair.depth, rectifier, settings_.run.depth_scale,
                                      static_cast<double>(settings_.odometry.noise.saturated_depth));
      if (!input.frame.depth.empty()) input.frame.depth_stamp = pair.depth_stamp;
    } catch (const std::invalid_argument& error) {
      guard_->report(depth_subscriber_.getTopic(), std::string(error.what()) + "; this depth is not used");
    }
    doubtRegistration(input.frame);
    if (!worker_->push(std::move(input))) return;
    worker_->diagnostics().dropped();
    NODELET_WARN_THROTTLE(5, "images come faster than they can be worked on: some are left out");
  }

  void doubtRegistration(const RgbdFrame& frame) {
    if (has_doubted_) return;
    registration_.add(frame.grey, frame.depth);
    const std::string& doubt = registration_.doubt();
    if (doubt.empty()) return;
    NODELET_WARN_STREAM(depth_subscriber_.getTopic() << ": " << doubt);
    has_doubted_ = true;
  }

  // The order matters: members that are called are destroyed after those that call them.
  std::unique_ptr<CallbackGuard> guard_;
  Settings settings_;
  std::unique_ptr<Associator> associator_;
  std::deque<Associator::Pair> waiting_;
  RectificationInput rectification_;
  RegistrationWatch registration_;
  bool has_doubted_ = false;
  ros::Time last_depth_time_;

  std::unique_ptr<OdometryWorker> worker_;
  std::unique_ptr<Reconfiguration<TrackerConfig>> reconfiguration_;
  std::unique_ptr<InputWatch> watch_;
  std::size_t watched_colour_ = 0, watched_info_ = 0, watched_depth_ = 0;
  ros::Subscriber depth_info_subscriber_;  // made by the timer and by images: these end before it does
  ros::ServiceServer reset_service_;
  ros::WallTimer timeout_timer_;
  ImageSubscription colour_subscriber_;
  ImageSubscription depth_subscriber_;
  ros::Subscriber camera_info_subscriber_;
};

}  // namespace rgbd_sfm_fusion

PLUGINLIB_EXPORT_CLASS(rgbd_sfm_fusion::TrackerNodelet, nodelet::Nodelet)
