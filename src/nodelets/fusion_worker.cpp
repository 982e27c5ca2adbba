// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_worker.h"

#include <optional>
#include <stdexcept>
#include <utility>

#include "rgbd_sfm_fusion/ros/stamp.h"
#include "rgbd_sfm_fusion/ros/tracker_messages.h"
#include "shared_preparation.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kMostWaiting = 30;  // as many as ROS keeps of each topic

/// A keyframe whose images are those of `message`, which lives as long.
std::shared_ptr<const KeyframeMap> viewOf(const KeyframeConstPtr& message, const TrackingResult& tracked) {
  const auto view = std::make_shared<std::pair<KeyframeConstPtr, KeyframeMap>>(
      message, fromMessage(message, T_odom_firstOf(*message, tracked)));
  return {view, &view->second};
}

}  // namespace

FusionWorker::FusionWorker(CallbackGuard* guard, std::string depth, OnResult on_result)
    : guard_(guard),
      depth_topic_(std::move(depth)),
      on_result_(std::move(on_result)),
      queue_(kMostWaiting),
      thread_([this] { run(); }) {}

FusionWorker::~FusionWorker() {
  queue_.close();
  thread_.join();
}

void FusionWorker::run() {
  while (const std::optional<FusionTask> task = queue_.pop()) {
    try {
      const FusionResult result = fuse(*task);
      guard_->run("fusion", [&] { on_result_(result); });
    } catch (const std::exception& error) {  // a frame that cannot be fused does not keep others waiting
      guard_->report("fusion", error.what());
    } catch (...) {
      guard_->report("fusion", "something that is no std::exception was thrown");
    }
  }
}

FusionResult FusionWorker::fuse(const FusionTask& task) {
  FusionResult result;
  result.input = task.input;
  result.rectifier = task.rectifier;
  result.tracked = fromMessage(*task.input.tracked);
  result.is_new_run = prepareFusion(task);
  result.frame.stamp = result.tracked.stamp;
  result.frame.depth = sensorDepth(task);
  if (!result.frame.depth.empty()) result.frame.depth_stamp = fromRosTime(task.input.depth->header.stamp);

  result.is_late = task.is_late;
  result.frame.grey = brightness(task);
  std::shared_ptr<const KeyframeMap> keyframe;
  if (task.input.keyframe) keyframe = viewOf(task.input.keyframe, result.tracked);
  result.fused = fusion_->fuse(result.tracked, keyframe, result.frame);
  return result;
}

/// @return whether the tracker has started anew, with another unit of length
bool FusionWorker::prepareFusion(const FusionTask& task) {
  const PinholeCamera& camera = task.rectifier->camera();
  if (!fusion_ || camera != camera_) {
    fusion_ = std::make_unique<DepthFusion>(camera, task.settings->fusion);
    camera_ = camera;
  } else if (task.settings != settings_) {
    fusion_->setOptions(task.settings->fusion);
  }
  settings_ = task.settings;
  if (task.input.tracked->run == run_) return false;
  run_ = task.input.tracked->run;
  fusion_->reset();
  return true;
}

/// Empty where it can't be used: the tracker says why.
GreyImage FusionWorker::brightness(const FusionTask& task) const {
  const sensor_msgs::ImageConstPtr& image = task.input.colour;
  const FusionOptions& options = task.settings->fusion;
  const bool is_used = options.complete || options.gaussian.min_inlier_probability > 0.0;
  if (!image || !is_used) return {};
  try {
    return sharedGrey(image, task.rectifier);
  } catch (const std::invalid_argument&) {
    return {};
  }
}

/// Empty where it can't be used.
DepthImage FusionWorker::sensorDepth(const FusionTask& task) {
  const sensor_msgs::ImageConstPtr& image = task.input.depth;
  try {
    return sharedDepth(image, task.rectifier, task.settings->run.depth_scale,
                       static_cast<double>(task.settings->fusion.noise.saturated_depth));
  } catch (const std::invalid_argument& error) {
    guard_->report(depth_topic_, std::string(error.what()) + "; this depth is not used");
    return {};
  }
}

}  // namespace rgbd_sfm_fusion
