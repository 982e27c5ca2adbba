// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "frame_source.h"

#include <algorithm>
#include <cstdio>
#include <exception>

#include "rgbd_sfm_fusion/scene/random.h"
#include "rgbd_sfm_fusion/scene/room.h"
#include "virtual_stream.h"

namespace rgbd_sfm_fusion {
namespace {

// Not more, as a frame that is rendered ahead knows nothing of streams that start meanwhile.
constexpr std::chrono::milliseconds kAhead{120};

constexpr std::uint32_t kDropStream = 0x6472, kJitterStream = 0x6a69;

/// Images of a camera that sits beside colour's and looks the same way.
VirtualCameraOptions depthCameraOptions(const DriverSettings& settings) {
  VirtualCameraOptions options = settings.camera;
  options.offset.x() = settings.depth_camera_offset;
  return options;
}

/// A random number in [0, 1) that depends on nothing but the arguments.
double chance(const DriverSettings& settings, std::uint32_t index, std::uint32_t stream,
              OniSensorType sensor) {
  return static_cast<double>(
      CounterRandom(settings.camera.seed, index, stream).uniform(static_cast<std::uint32_t>(sensor)));
}

}  // namespace

const cv::Mat& FrameSource::Frame::image(OniSensorType sensor) const {
  if (sensor == ONI_SENSOR_COLOR) return by_colour.rgb;
  if (sensor == ONI_SENSOR_IR) return by_depth.rgb;
  return by_colour.depth.empty() ? by_depth.depth : by_colour.depth;
}

FrameSource::FrameSource(DriverContext& context, SteadyClock::time_point plugged_at)
    : context_(context), clock_(context.settings(), plugged_at) {}

FrameSource::~FrameSource() {
  unplug();
  joinThreads();
}

OniStatus FrameSource::start(VirtualStream& stream) {
  const std::lock_guard<std::mutex> control(control_);
  if (unplugged_) return ONI_STATUS_NO_DEVICE;
  if (context_.startFails()) return ONI_STATUS_ERROR;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    streams_.push_back(&stream);
    stopping_ = false;
  }
  if (renderer_.joinable()) return ONI_STATUS_OK;
  rendered_ = delivered_ = 0;
  renderer_ = std::thread(&FrameSource::renderFrames, this);
  deliverer_ = std::thread(&FrameSource::deliverFrames, this);
  return ONI_STATUS_OK;
}

void FrameSource::stop(VirtualStream& stream) {
  const std::lock_guard<std::mutex> control(control_);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    streams_.erase(std::remove(streams_.begin(), streams_.end(), &stream), streams_.end());
    stopping_ = streams_.empty();
    if (!stopping_) return;
  }
  changed_.notify_all();
  joinThreads();
}

void FrameSource::joinThreads() {
  if (renderer_.joinable()) renderer_.join();
  if (deliverer_.joinable()) deliverer_.join();
}

void FrameSource::unplug() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    unplugged_ = true;
  }
  changed_.notify_all();
}

void FrameSource::renderFrames() try {
  if (!colour_camera_) {
    colour_camera_.emplace(context_.settings().camera, sharedRoom());
    depth_camera_.emplace(depthCameraOptions(context_.settings()), sharedRoom());
  }
  const Timeline& timeline = context_.timeline();
  std::uint32_t index = timeline.indexFrom(SteadyClock::now());
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait_until(lock, timeline.instantOf(index) - kAhead, [this] { return ended(); });
    changed_.wait(lock, [this] { return ended() || rendered_ - delivered_ < frames_.size(); });
    if (ended()) return;
    const auto begin = SteadyClock::now();
    Frame& frame = frames_[rendered_ % frames_.size()];
    frame.index = index;
    render(lock, frame);
    ++rendered_;
    changed_.notify_all();
    // Cameras deliver in time or not at all: a frame that cannot be ready in time is left out.
    const auto end = SteadyClock::now();
    index = std::max(index + 1, timeline.indexFrom(end + (end - begin)));
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "virtual camera: %s\n", error.what());
}

void FrameSource::deliverFrames() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ended() || delivered_ < rendered_; });
    if (ended()) return;
    deliver(lock, frames_[delivered_ % frames_.size()]);
    ++delivered_;
    changed_.notify_all();
  }
}

void FrameSource::render(std::unique_lock<std::mutex>& lock, Frame& frame) {
  const auto wanted = [this](OniSensorType sensor) {
    return std::any_of(streams_.begin(), streams_.end(), [=](auto* s) { return s->sensor() == sensor; });
  };
  const bool registered = registered_;
  const FrameParts by_colour{wanted(ONI_SENSOR_COLOR), wanted(ONI_SENSOR_DEPTH) && registered, false},
      by_depth{wanted(ONI_SENSOR_IR), wanted(ONI_SENSOR_DEPTH) && !registered, false};
  lock.unlock();
  colour_camera_->render(frame.index, frame.by_colour, by_colour);
  depth_camera_->render(frame.index, frame.by_depth, by_depth);
  lock.lock();
}

std::vector<FrameSource::Delivery> FrameSource::deliveries(std::uint32_t index,
                                                           SteadyClock::time_point due) const {
  const DriverSettings& s = context_.settings();
  std::vector<Delivery> result;
  for (const Stall& stall : s.stalls) {
    const auto begin = context_.afterLoad(stall.time), end = begin + seconds(stall.duration);
    if (due >= begin && due < end) return result;
  }
  for (VirtualStream* stream : streams_) {
    if (chance(s, index, kDropStream, stream->sensor()) < s.drop) continue;
    result.push_back({due + seconds(s.jitter * chance(s, index, kJitterStream, stream->sensor())), stream});
  }
  std::sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  return result;
}

void FrameSource::deliver(std::unique_lock<std::mutex>& lock, const Frame& frame) {
  const auto due = context_.timeline().instantOf(frame.index);
  for (const Delivery& delivery : deliveries(frame.index, due)) {
    changed_.wait_until(lock, delivery.time, [this] { return ended(); });
    if (ended()) return;
    VirtualStream& stream = *delivery.stream;
    // The stream may have been stopped meanwhile, or started after the rendering.
    const bool started = std::find(streams_.begin(), streams_.end(), &stream) != streams_.end();
    if (!started || frame.image(stream.sensor()).empty()) continue;
    const bool is_colour = stream.sensor() == ONI_SENSOR_COLOR;
    const auto taken = is_colour ? due : due + seconds(context_.settings().camera.skew);
    stream.deliver(frame.image(stream.sensor()), frame.index, clock_.at(taken));
    if (is_colour) context_.log().add(frame.index, clock_.at(taken), due);
  }
  changed_.wait_until(lock, due, [this] { return ended(); });  // if there was nothing to deliver
}

}  // namespace rgbd_sfm_fusion
