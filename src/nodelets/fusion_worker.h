// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "bounded_queue.h"
#include "callback_guard.h"
#include "fusion_inputs.h"
#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "rgbd_sfm_fusion/input/rectification.h"
#include "rgbd_sfm_fusion/settings/settings.h"

namespace rgbd_sfm_fusion {

/// A frame to be fused, with what was in force when it was complete.
struct FusionTask {
  FusionInputs::Frame input;
  std::shared_ptr<const Rectifier> rectifier;
  std::shared_ptr<const Settings> settings;
  bool is_late = false;  ///< a newer frame waits as well, so this one gets the sensor's depth alone

  /// The images that are not needed any more go at once: many frames may wait.
  void overtake() {
    is_late = true;
    input.keyframe.reset();
    input.colour.reset();
  }
};

/// A frame that was fused.
struct FusionResult {
  FusionInputs::Frame input;
  std::shared_ptr<const Rectifier> rectifier;
  RgbdFrame frame;         ///< rectified
  TrackingResult tracked;  ///< as its message says
  FusedFrame fused;
  bool is_late = false;     ///< as for the task
  bool is_new_run = false;  ///< the tracker has started anew with this frame
};

/// Prepares and fuses frames in a thread of its own, so that the nodelet's callbacks, and those of other
/// nodelets, go on meanwhile.
///
/// Under load the newest frame comes first: if another one waits already, a frame gets the sensor's depth
/// alone, which takes a fraction of the time.
class FusionWorker {
 public:
  using OnResult = std::function<void(const FusionResult&)>;

  /// @param guard      reports errors; it is not held while a frame is prepared and fused
  /// @param depth      name of the depth images' topic, for messages
  /// @param on_result  called inside the guard with every frame that was fused
  FusionWorker(CallbackGuard* guard, std::string depth, OnResult on_result);
  ~FusionWorker();

  /// @return whether an older frame was dropped for it
  bool push(FusionTask task) {
    return queue_.push(std::move(task), [](FusionTask& waiting) { waiting.overtake(); }).has_value();
  }

 private:
  void run();
  FusionResult fuse(const FusionTask& task);
  bool prepareFusion(const FusionTask& task);
  GreyImage brightness(const FusionTask& task) const;
  DepthImage sensorDepth(const FusionTask& task);

  CallbackGuard* guard_;
  std::string depth_topic_;
  OnResult on_result_;

  // Used by the thread alone:
  std::unique_ptr<DepthFusion> fusion_;
  PinholeCamera camera_;  ///< of fusion_
  std::shared_ptr<const Settings> settings_;
  std::uint32_t run_ = 0;  ///< of TrackedFrame

  BoundedQueue<FusionTask> queue_;
  std::thread thread_;
};

}  // namespace rgbd_sfm_fusion
