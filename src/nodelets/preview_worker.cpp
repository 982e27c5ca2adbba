// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "preview_worker.h"

#include <ros/console.h>

#include <chrono>
#include <exception>

#include "rgbd_sfm_fusion/preview/preview.h"
#include "rgbd_sfm_fusion/ros/fusion_messages.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::chrono::milliseconds kPeriod(100);

sensor_msgs::ImagePtr makePreview(const PreviewWorker::Job& job) {
  PreviewFrame frame;
  frame.picture = job.picture;
  frame.sensor = job.output.sensor;
  frame.fused = job.output.fused;
  frame.state = job.output.state;
  frame.rate = job.rate;
  frame.latency = job.output.latency;
  return toPictureMessage(job.output.header, drawPreview(frame));
}

}  // namespace

PreviewWorker::PreviewWorker(const image_transport::Publisher& publisher)
    : publisher_(publisher), thread_([this] { run(); }) {}

PreviewWorker::~PreviewWorker() {
  jobs_.close();
  thread_.join();
}

void PreviewWorker::run() {
  while (const auto job = jobs_.pop()) {
    const auto next = std::chrono::steady_clock::now() + kPeriod;
    try {
      publisher_.publish(makePreview(*job));
    } catch (const std::exception& error) {  // a picture for people may not end what machines need
      ROS_ERROR_STREAM_THROTTLE(30, "no preview could be drawn: " << error.what());
    }
    std::this_thread::sleep_until(next);
  }
}

}  // namespace rgbd_sfm_fusion
