// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Time per frame of tracking and mapping, and of OpenCV's rgbd::RgbdOdometry (frame to keyframe, with the
/// same keyframes), which only tracks. Both run in turn on each frame, on one thread, so that what else the
/// machine does falls on both alike.
///
///     odometry_benchmark SEQUENCE_DIR [--frames N]
///
/// SEQUENCE_DIR is in the TUM RGB-D layout. Images are read, rectified and converted outside the clock.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd.hpp>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/tools/tum_sequence.h"

namespace {

using namespace rgbd_sfm_fusion;
using Clock = std::chrono::steady_clock;

double milliseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

void printRow(const char* name, const std::vector<double>& times) {
  std::printf("%-28s median %6.2f ms   p95 %6.2f ms\n", name, percentile(times, 0.5),
              percentile(times, 0.95));
}

int run(const std::string& folder, std::size_t frames) {
  const TumSequence sequence = readTumSequence(folder);
  const PinholeCamera camera{sequence.width, sequence.height, sequence.fx,
                             sequence.fy,    sequence.cx,     sequence.cy};
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  auto distortion = sequence.distortion;
  cv::Mat map_x, map_y;
  cv::initUndistortRectifyMap(K, cv::Mat(1, 5, CV_64F, distortion.data()), cv::noArray(), K,
                              {camera.width, camera.height}, CV_32FC1, map_x, map_y);
  cv::setNumThreads(1);
  VisualOdometry odometry(camera, OdometryOptions());
  cv::rgbd::RgbdOdometry peer{cv::Mat(K)};
  cv::Ptr<cv::rgbd::OdometryFrame> peer_keyframe;
  cv::Mat peer_pose = cv::Mat::eye(4, 4, CV_64F);
  std::vector<double> track, map, both, peer_times;
  for (std::size_t i = 0; i < std::min(frames, sequence.pairs.size()); ++i) {
    const TumSequence::Pair& pair = sequence.pairs[i];
    cv::Mat grey, raw_depth;
    cv::remap(cv::imread(pair.rgb_path, cv::IMREAD_GRAYSCALE), grey, map_x, map_y, cv::INTER_LINEAR);
    cv::remap(cv::imread(pair.depth_path, cv::IMREAD_UNCHANGED), raw_depth, map_x, map_y, cv::INTER_NEAREST);
    cv::Mat depth;
    raw_depth.convertTo(depth, CV_32F, 1.0 / sequence.depth_scale);
    depth.setTo(std::numeric_limits<float>::quiet_NaN(), raw_depth == 0);
    RgbdFrame frame;
    frame.stamp = pair.rgb_stamp;
    frame.depth_stamp = pair.depth_stamp;
    frame.grey = grey;
    frame.depth = depth;

    const auto start = Clock::now();
    const TrackingResult tracked = odometry.track(frame);
    const auto middle = Clock::now();
    odometry.map();
    const auto end = Clock::now();

    const auto peer_start = Clock::now();
    cv::Ptr<cv::rgbd::OdometryFrame> peer_frame = cv::rgbd::OdometryFrame::create(grey, depth);
    if (peer_keyframe) {
      cv::Mat pose;
      if (peer.compute(peer_frame, peer_keyframe, pose, peer_pose)) peer_pose = pose;
    }
    const auto peer_end = Clock::now();
    if (i > 0) {
      track.push_back(milliseconds(start, middle));
      map.push_back(milliseconds(middle, end));
      both.push_back(milliseconds(start, end));
      peer_times.push_back(milliseconds(peer_start, peer_end));
    }
    if (!peer_keyframe || tracked.keyframe_stamp == tracked.stamp) {
      peer_keyframe = cv::rgbd::OdometryFrame::create(grey, depth);
      peer_pose = cv::Mat::eye(4, 4, CV_64F);
    }
  }
  printRow("tracking", track);
  printRow("mapping", map);
  printRow("tracking + mapping", both);
  printRow("OpenCV RgbdOdometry", peer_times);
  std::printf("ratio of medians %.3f   of p95 %.3f\n", percentile(both, 0.5) / percentile(peer_times, 0.5),
              percentile(both, 0.95) / percentile(peer_times, 0.95));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Tracking and mapping against OpenCV's RgbdOdometry, on the same frames");
  std::string folder;
  std::size_t frames = std::numeric_limits<std::size_t>::max();
  app.add_option("sequence", folder, "folder in the TUM RGB-D layout")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--frames", frames, "so many from the start")->check(CLI::Range(2, 1000000));
  CLI11_PARSE(app, argc, argv);
  try {
    return run(folder, frames);
  } catch (const std::exception& error) {
    std::cerr << "odometry_benchmark: " << error.what() << '\n';
    return 1;
  }
}
