// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <nodelet/nodelet.h>
#include <rgbd_sfm_fusion/FusionConfig.h>
#include <sensor_msgs/CameraInfo.h>

#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "callback_guard.h"
#include "colour_input.h"
#include "condition_report.h"
#include "fusion_diagnostics.h"
#include "fusion_inputs.h"
#include "fusion_publisher.h"
#include "fusion_worker.h"
#include "image_subscription.h"
#include "input_watch.h"
#include "parameters.h"
#include "reconfiguration.h"
#include "rectification_input.h"
#include "rgbd_sfm_fusion/input/registration.h"
#include "rgbd_sfm_fusion/pipeline/run_watch.h"
#include "rgbd_sfm_fusion/preview/preview_text.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/stamp.h"
#include "run_summary.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kFrameQueueSize = 100;
constexpr std::uint32_t kImageQueueSize = 30;
constexpr double kTimeoutPeriod = 0.1;    // [s] of wall time, as the next
constexpr double kConditionPeriod = 5.0;  // [s]
constexpr double kSummaryPeriod = 30.0;   // [s]

}  // namespace

/// Fuses sensor depth with the tracker's keyframes: one result for every tracked frame. Collects what belongs
/// to a frame, hands it to the worker that fuses, and publishes the result.
class FusionNodelet : public nodelet::Nodelet {
 private:
  void onInit() override {
    guard_ = std::make_unique<CallbackGuard>(getName());
    const CallbackGuard::Lock until_all_is_made = guard_->lock();
    ros::NodeHandle& handle = getNodeHandle();
    ros::NodeHandle& private_handle = getPrivateNodeHandle();
    settings_ = std::make_shared<const Settings>(readParameters(
        private_handle, SettingScope::kFusion, {"rgb_transport", "depth_transport", "camera_info_url"}));
    inputs_ = std::make_unique<FusionInputs>(static_cast<std::size_t>(settings_->run.queue_size));
    colour_input_ =
        std::make_unique<ColourInput>(handle, private_handle, guard_.get(), [this](const auto& image) {
          inputs_->pushColour(image);
          fuseWaiting();
        });
    publisher_ = std::make_unique<FusionPublisher>(handle, private_handle, guard_.get());
    publisher_->setPointsDecimation(settings_->run.points_decimation);
    diagnostics_ = std::make_unique<FusionDiagnostics>(handle, private_handle, guard_.get(), getName());
    guard_->setFailureHandler([this](const std::string& reason) { diagnostics_->failed(reason); });
    reconfiguration_ = std::make_unique<Reconfiguration<FusionConfig>>(
        private_handle, guard_->mutex(), SettingScope::kFusion, *settings_,
        [this](const Settings& settings) { apply(settings); });
    timeout_timer_ =
        handle.createWallTimer(ros::WallDuration(kTimeoutPeriod),
                               guard_->forEvents<ros::WallTimerEvent>("timeout", [this] { fuseWaiting(); }));
    condition_timer_ = handle.createWallTimer(
        ros::WallDuration(kConditionPeriod),
        guard_->forEvents<ros::WallTimerEvent>("conditions", [this] { sayConditions(); }));
    summary_timer_ =
        handle.createWallTimer(ros::WallDuration(kSummaryPeriod),
                               guard_->forEvents<ros::WallTimerEvent>("summary", [this] { summarise(); }));
    worker_ = std::make_unique<FusionWorker>(guard_.get(), handle.resolveName("depth_registered/image_raw"),
                                             [this](const FusionResult& result) { onResult(result); });
    subscribe(handle, private_handle);
    guard_->run("camera_info_url", [&] {
      if (!rectification_.load(private_handle.param<std::string>("camera_info_url", ""))) return;
      watch_->received(watched_info_);
      fuseWaiting();
    });
  }

  void subscribe(ros::NodeHandle& handle, ros::NodeHandle& private_handle) {
    const std::string frames = handle.resolveName("tracker/frame");
    const std::string keyframes = handle.resolveName("tracker/keyframe");
    const std::string info = handle.resolveName("rgb/camera_info");
    const std::string depth = handle.resolveName("depth_registered/image_raw");
    const std::string depth_info = handle.resolveName("depth_registered/camera_info");
    rectification_.setTopics(handle.resolveName("rgb/image_raw"), depth);
    watch_ = std::make_unique<InputWatch>(handle, guard_.get(), getName());
    watched_frames_ =
        watch_->add(frames, "nothing is fused", [this] { return frame_subscriber_.getNumPublishers(); });
    watched_info_ = watch_->addNeededOnce(
        info, "depth needs the camera's calibration; camera_info_url gives it from a file",
        [this] { return camera_info_subscriber_.getNumPublishers(); });
    watched_depth_ = watch_->add(depth, "there is SfM depth only",
                                 [this] { return depth_subscriber_.getNumPublishers(); });
    RunWatch::Limits limits;
    limits.max_skew = settings_->association.max_skew;
    limits.min_range = static_cast<double>(settings_->fusion.noise.min_range);
    limits.max_range = static_cast<double>(settings_->fusion.noise.max_range);
    limits.depth_scale = settings_->run.depth_scale;
    limits.window = kConditionPeriod;
    limits.depth = depth;
    run_watch_ = std::make_unique<RunWatch>(limits);
    keyframe_subscriber_ = handle.subscribe<Keyframe>(
        keyframes, kImageQueueSize,
        guard_->forMessages<Keyframe>(keyframes, [this](const auto& m) { onKeyframe(m); }));
    frame_subscriber_ = handle.subscribe<TrackedFrame>(
        frames, kFrameQueueSize,
        guard_->forMessages<TrackedFrame>(frames, [this](const auto& m) { onTracked(m); }));
    depth_subscriber_.subscribe(handle, private_handle, "depth_transport", depth, kImageQueueSize,
                                guard_.get(), [this](const auto& m) { onDepth(m); });
    subscribeToColourIfNeeded();
    camera_info_subscriber_ = handle.subscribe<sensor_msgs::CameraInfo>(
        info, kImageQueueSize,
        guard_->forMessages<sensor_msgs::CameraInfo>(info, [this](const auto& m) { onCameraInfo(*m); }));
    // Last, and nobody else subscribes to it: a bag player that waits for subscribers waits for this nodelet.
    depth_info_subscriber_ = handle.subscribe<sensor_msgs::CameraInfo>(
        depth_info, kImageQueueSize,
        guard_->forMessages<sensor_msgs::CameraInfo>(depth_info, [this](const auto& m) { onDepthInfo(*m); }));
  }

  /// Completion is guided by the image; nothing else here needs it.
  void subscribeToColourIfNeeded() {
    colour_input_->setWanted(settings_->fusion.complete);
    if (!settings_->fusion.complete) inputs_->forgetColour();
  }

  void onTracked(const TrackedFrameConstPtr& tracked) {
    watch_->received(watched_frames_);
    if (inputs_->pushTracked(tracked, ros::Time::now())) dropped();
    fuseWaiting();
  }

  void onKeyframe(const KeyframeConstPtr& keyframe) {
    inputs_->pushKeyframe(keyframe);
    fuseWaiting();
  }

  void onDepth(const sensor_msgs::ImageConstPtr& depth) {
    watch_->received(watched_depth_);
    last_depth_ = ros::SteadyTime::now();
    inputs_->pushDepth(depth);
    fuseWaiting();
  }

  void onCameraInfo(const sensor_msgs::CameraInfo& info) {
    watch_->received(watched_info_);
    if (rectification_.update(info)) fuseWaiting();
  }

  void onDepthInfo(const sensor_msgs::CameraInfo& info) {
    rectification_.updateDepth(info);
    const auto difference = rectification_.differenceOfDepth();
    if (!difference) return;
    NODELET_WARN_STREAM_ONCE(depth_info_subscriber_.getTopic()
                             << " differs from that of colour, which is used: " << *difference);
  }

  void apply(const Settings& settings) {
    publisher_->setPointsDecimation(settings.run.points_decimation);
    settings_ = std::make_shared<const Settings>(settings);
    subscribeToColourIfNeeded();
  }

  /// Hands over the frames that are complete.
  void fuseWaiting() {
    if (!rectification_.rectifier()) return;
    while (auto frame = inputs_->pop(ros::Time::now())) {
      if (!frame->missing.empty()) {
        NODELET_WARN_STREAM_THROTTLE(
            5, "a frame was fused without " << frame->missing << ", which did not come");
      }
      if (worker_->push({std::move(*frame), rectification_.rectifier(), settings_})) dropped();
    }
  }

  void dropped() {
    diagnostics_->dropped();
    NODELET_WARN_THROTTLE(5, "frames come faster than they can be fused: some are left out");
  }

  /// Called by the worker's thread, inside the guard.
  void onResult(const FusionResult& result) {
    if (result.is_new_run) {
      publisher_->restart();
      NODELET_INFO("the tracker started anew, and so does fusion");
    }
    if (result.is_late) {
      diagnostics_->late();
      NODELET_WARN_THROTTLE(5,
                            "frames come faster than they can be fused: some get the sensor's depth alone");
    }
    const std_msgs::Header& header = result.input.tracked->header;
    publisher_->publish({header, result.fused, result.rectifier, result.tracked.state, result.frame.depth,
                         result.frame.depth_stamp});
    diagnostics_->fused(result.fused, secondsBetween(header.stamp, ros::Time::now()));
    watch(result);
  }

  /// Remembers which conditions this frame meets.
  void watch(const FusionResult& result) {
    const FusionInputs::Frame& input = result.input;
    const FusedFrame& fused = result.fused;
    RunWatch::Frame watched;
    const ros::SteadyTime now = ros::SteadyTime::now();
    // One that came long ago is not near, whatever its stamp.
    if (!input.nearest_depth.isZero() && (now - last_depth_).toSec() < kConditionPeriod)
      watched.skew = secondsBetween(input.tracked->header.stamp, input.nearest_depth);
    const DepthNoiseModel& noise = settings_->fusion.noise;
    if (!result.frame.depth.empty())
      watched.depth = valuesOf(result.frame.depth, static_cast<double>(noise.min_range),
                               static_cast<double>(noise.max_range));
    const bool left_out = input.tracked->left_out || result.is_late;
    if (!left_out) watched.state = result.tracked.state;
    watched.setFused(fused);
    run_watch_->add(now.toSec(), watched);
    if (!left_out) summary_.add(fused, result.tracked.state);
    if (!knows_scale_ && fused.scale.hasScale())
      NODELET_INFO_STREAM(scaleText(fused.scale) << ", known from now on");
    knows_scale_ = fused.scale.hasScale();
    if (input.depth)
      doubt_ =
          doubtOfRegistration(input.tracked->header.frame_id, withoutSlash(input.depth->header.frame_id));
  }

  void summarise() {
    const std::string summary = summary_.take(kSummaryPeriod);
    if (!summary.empty()) NODELET_INFO_STREAM(summary);
  }

  void sayConditions() {
    const double now = ros::SteadyTime::now().toSec();
    std::vector<std::string> conditions = run_watch_->recentSentences(now);
    if (!doubt_.empty()) conditions.insert(conditions.begin(), depth_subscriber_.getTopic() + ": " + doubt_);
    for (const std::string& condition : condition_report_.worthSaying(now, conditions))
      NODELET_WARN_STREAM(condition);
    diagnostics_->setConditions(std::move(conditions));
  }

  // In this order: what is called goes after what calls it.
  std::unique_ptr<CallbackGuard> guard_;
  std::shared_ptr<const Settings> settings_;
  RectificationInput rectification_;
  std::unique_ptr<FusionInputs> inputs_;

  std::unique_ptr<RunWatch> run_watch_;
  ConditionReport condition_report_;
  RunSummary summary_;
  bool knows_scale_ = false;
  ros::SteadyTime last_depth_;  ///< when it came
  std::string doubt_;           ///< of the last depth image's registration; empty: none

  std::unique_ptr<FusionPublisher> publisher_;
  std::unique_ptr<FusionDiagnostics> diagnostics_;
  std::unique_ptr<FusionWorker> worker_;
  std::unique_ptr<InputWatch> watch_;
  std::size_t watched_frames_ = 0, watched_info_ = 0, watched_depth_ = 0;
  ros::WallTimer timeout_timer_, condition_timer_, summary_timer_;
  ImageSubscription depth_subscriber_;
  std::unique_ptr<ColourInput> colour_input_;
  ros::Subscriber frame_subscriber_;
  ros::Subscriber keyframe_subscriber_;
  ros::Subscriber camera_info_subscriber_;
  ros::Subscriber depth_info_subscriber_;
  std::unique_ptr<Reconfiguration<FusionConfig>> reconfiguration_;
};

}  // namespace rgbd_sfm_fusion

PLUGINLIB_EXPORT_CLASS(rgbd_sfm_fusion::FusionNodelet, nodelet::Nodelet)
