// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <thread>
#include <vector>

#include "driver_context.h"
#include "oni_driver_api.h"
#include "rgbd_sfm_fusion/scene/virtual_camera.h"

namespace rgbd_sfm_fusion {

class VirtualStream;

/// Renders frames while streams are started, one rendering for all of them, and delivers them when they are
/// due. Its thread runs from the first start() to the last stop().
class FrameSource {
 public:
  FrameSource(DriverContext& context, SteadyClock::time_point plugged_at);
  ~FrameSource();
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  OniStatus start(VirtualStream& stream);

  /// When it returns, nothing is delivered to the stream any more.
  void stop(VirtualStream& stream);

  /// From now on there are no images, and nothing starts.
  void unplug();
  bool unplugged() const { return unplugged_; }

  void setRegistered(bool on) { registered_ = on; }
  bool registered() const { return registered_; }

 private:
  /// Of one frame, by sensor; empty where no stream wants them.
  struct Images {
    cv::Mat colour, depth, infrared;
    const cv::Mat& of(OniSensorType sensor) const;
  };
  struct Delivery {
    SteadyClock::time_point time;
    VirtualStream* stream;
  };

  void run();
  void produce();
  bool ended() const { return stopping_ || unplugged_; }
  bool wanted(OniSensorType sensor) const;
  Images render(std::uint32_t index, bool colour, bool depth, bool infrared);
  std::vector<Delivery> deliveries(std::uint32_t index, SteadyClock::time_point due) const;
  void deliver(std::unique_lock<std::mutex>& lock, std::uint32_t index, const Images& images);

  DriverContext& context_;
  const DeviceClock clock_;
  std::atomic<bool> unplugged_{false};
  std::atomic<bool> registered_{false};

  std::mutex control_;  ///< lets one start() or stop() run at a time
  std::thread thread_;

  std::mutex mutex_;  ///< of what follows; held during deliveries
  std::condition_variable changed_;
  std::vector<VirtualStream*> streams_;
  bool stopping_ = false;

  // Of the thread.
  std::optional<VirtualCamera> colour_camera_, depth_camera_;
  VirtualFrame colour_frame_, depth_frame_;
};

}  // namespace rgbd_sfm_fusion
