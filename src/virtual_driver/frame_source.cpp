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

constexpr std::uint32_t kDropStream = 0x6472, kJitterStream = 0x6a69;

/// Images of a camera that sits beside colour's and looks the same way.
VirtualCameraOptions depthCameraOptions(const DriverSettings& settings) {
  VirtualCameraOptions options = settings.camera;
  options.offset.x() = settings.depth_camera_offset;
  return options;
}

/// In [0, 1): the same for the same frame and sensor.
double chance(const DriverSettings& settings, std::uint32_t index, std::uint32_t stream,
              OniSensorType sensor) {
  return static_cast<double>(
      CounterRandom(settings.camera.seed, index, stream).uniform(static_cast<std::uint32_t>(sensor)));
}

}  // namespace

const cv::Mat& FrameSource::Images::of(OniSensorType sensor) const {
  return sensor == ONI_SENSOR_COLOR ? colour : sensor == ONI_SENSOR_DEPTH ? depth : infrared;
}

FrameSource::FrameSource(DriverContext& context, SteadyClock::time_point plugged_at)
    : context_(context), clock_(context.settings(), plugged_at) {}

FrameSource::~FrameSource() {
  unplug();
  if (thread_.joinable()) thread_.join();
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
  if (!thread_.joinable()) thread_ = std::thread(&FrameSource::run, this);
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
  if (thread_.joinable()) thread_.join();
}

void FrameSource::unplug() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    unplugged_ = true;
  }
  changed_.notify_all();
}

void FrameSource::run() {
  try {
    produce();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "virtual camera: %s\n", error.what());
  }
}

void FrameSource::produce() {
  if (!colour_camera_) {
    colour_camera_.emplace(context_.settings().camera, sharedRoom());
    depth_camera_.emplace(depthCameraOptions(context_.settings()), sharedRoom());
  }
  const Timeline& timeline = context_.timeline();
  SteadyClock::duration expected{0};  // of a rendering
  std::uint32_t index = timeline.indexFrom(SteadyClock::now());
  std::unique_lock<std::mutex> lock(mutex_);
  while (!ended()) {
    const bool colour = wanted(ONI_SENSOR_COLOR), depth = wanted(ONI_SENSOR_DEPTH),
               infrared = wanted(ONI_SENSOR_IR);
    lock.unlock();
    const auto begin = SteadyClock::now();
    const Images images = render(index, colour, depth, infrared);
    expected = std::max(SteadyClock::now() - begin, expected - expected / 16);
    lock.lock();
    deliver(lock, index, images);
    // Cameras deliver in time or not at all: a frame that can't be ready when it is due is left out.
    index = std::max(index + 1, timeline.indexFrom(SteadyClock::now() + expected));
  }
}

bool FrameSource::wanted(OniSensorType sensor) const {
  return std::any_of(streams_.begin(), streams_.end(), [=](auto* s) { return s->sensor() == sensor; });
}

FrameSource::Images FrameSource::render(std::uint32_t index, bool colour, bool depth, bool infrared) {
  const bool registered = registered_;
  const FrameParts by_colour{colour, depth && registered, false},
      by_depth{infrared, depth && !registered, false};
  if (by_colour.colour || by_colour.depth) colour_camera_->render(index, colour_frame_, by_colour);
  if (by_depth.colour || by_depth.depth) depth_camera_->render(index, depth_frame_, by_depth);
  Images images;
  if (colour) images.colour = colour_frame_.rgb;
  if (depth) images.depth = registered ? colour_frame_.depth : depth_frame_.depth;
  if (infrared) images.infrared = depth_frame_.rgb;
  return images;
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

void FrameSource::deliver(std::unique_lock<std::mutex>& lock, std::uint32_t index, const Images& images) {
  const auto due = context_.timeline().instantOf(index);
  for (const Delivery& delivery : deliveries(index, due)) {
    changed_.wait_until(lock, delivery.time, [this] { return ended(); });
    if (ended()) return;
    VirtualStream& stream = *delivery.stream;
    // It may have been stopped meanwhile, or started after the rendering.
    const bool started = std::find(streams_.begin(), streams_.end(), &stream) != streams_.end();
    if (!started || images.of(stream.sensor()).empty()) continue;
    const bool is_colour = stream.sensor() == ONI_SENSOR_COLOR;
    const auto taken = is_colour ? due : due + seconds(context_.settings().camera.skew);
    stream.deliver(images.of(stream.sensor()), index, clock_.at(taken));
    if (is_colour) context_.log().add(index, clock_.at(taken), due);
  }
  changed_.wait_until(lock, due, [this] { return ended(); });  // where there was nothing to deliver
}

}  // namespace rgbd_sfm_fusion
