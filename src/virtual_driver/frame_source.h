// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
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

/// While streams run, renders each frame once for all of them, and delivers it when it is due. It renders a
/// little ahead, so that one frame may take longer than usual. Its two threads run from the first start() to
/// the last stop().
class FrameSource {
 public:
  FrameSource(DriverContext& context, SteadyClock::time_point plugged_at);
  ~FrameSource();
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  OniStatus start(VirtualStream& stream);

  /// After it returns, nothing is delivered to the stream any more.
  void stop(VirtualStream& stream);

  /// From now on there are no images, and nothing starts.
  void unplug();
  bool unplugged() const { return unplugged_; }

  void setRegistered(bool on) { registered_ = on; }
  bool registered() const { return registered_; }

 private:
  struct Frame {
    std::uint32_t index;
    VirtualFrame by_colour, by_depth;  ///< seen from colour's place, and from depth's

    /// Empty where no stream wanted it.
    const cv::Mat& image(OniSensorType sensor) const;
  };
  struct Delivery {
    SteadyClock::time_point time;
    VirtualStream* stream;
  };

  void renderFrames();
  void deliverFrames();
  bool ended() const { return stopping_ || unplugged_; }
  void render(std::unique_lock<std::mutex>& lock, Frame& frame);
  void deliver(std::unique_lock<std::mutex>& lock, const Frame& frame);
  std::vector<Delivery> deliveries(std::uint32_t index, SteadyClock::time_point due) const;
  void joinThreads();

  DriverContext& context_;
  const DeviceClock clock_;
  std::atomic<bool> unplugged_{false};
  std::atomic<bool> registered_{false};

  std::mutex control_;  ///< lets one start() or stop() run at a time
  std::thread renderer_, deliverer_;

  std::mutex mutex_;  ///< guards what follows; held during deliveries
  std::condition_variable changed_;
  std::vector<VirtualStream*> streams_;
  bool stopping_ = false;
  std::size_t rendered_ = 0;   ///< frames since the threads were started
  std::size_t delivered_ = 0;  ///< frames since then

  // The frame that is rendered next belongs to the renderer. Rendered frames that are not delivered yet
  // belong to the deliverer.
  std::array<Frame, 4> frames_;
  std::optional<VirtualCamera> colour_camera_, depth_camera_;  ///< only the renderer uses them
};

}  // namespace rgbd_sfm_fusion
