// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// tum_to_bag SEQUENCE_DIR OUT.bag [--start N] [--count N] [--camera CAMERA] [--rate HZ] …
/// Turns a recording in the layout of the TUM RGB-D benchmark into a bag as an RGB-D camera would have
/// given, with the original stamps of both images.
#include <sensor_msgs/CameraInfo.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "rgbd_sfm_fusion/ros/bag_output.h"
#include "rgbd_sfm_fusion/ros/rgbd_bag.h"
#include "rgbd_sfm_fusion/tools/interruption.h"
#include "rgbd_sfm_fusion/tools/paths.h"
#include "rgbd_sfm_fusion/tools/pending_file.h"
#include "rgbd_sfm_fusion/tools/tum_sequence.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kMillimetresPerMetre = 1000.0;

/// One image of either kind, to be written in the order of stamps.
struct Entry {
  Stamp stamp;
  bool is_depth;
  const std::string* path;
};

std::vector<Entry> selectEntries(const TumSequence& sequence, std::size_t start, std::size_t count) {
  std::vector<Entry> entries;
  const std::size_t end = start + std::min(count, sequence.pairs.size() - start);
  for (std::size_t i = start; i < end; ++i) {
    const TumSequence::Pair& pair = sequence.pairs[i];
    entries.push_back({pair.rgb_stamp, false, &pair.rgb_path});
    entries.push_back({pair.depth_stamp, true, &pair.depth_path});
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.stamp < b.stamp; });
  // Where two colour images share their nearest depth image, associations name it twice.
  const auto same = [](const Entry& a, const Entry& b) {
    return a.stamp == b.stamp && a.is_depth == b.is_depth;
  };
  entries.erase(std::unique(entries.begin(), entries.end(), same), entries.end());
  return entries;
}

cv::Mat readImage(const std::string& path, int flags, int type, const TumSequence& sequence) {
  const cv::Mat image = cv::imread(path, flags);
  if (image.empty()) throw std::runtime_error("cannot read image " + path);
  if (image.type() != type) throw std::runtime_error(path + ": expected 8-bit colour, or depth of 16 bits");
  if (image.cols != sequence.width || image.rows != sequence.height) {
    throw std::runtime_error(path + ": is " + std::to_string(image.cols) + "x" + std::to_string(image.rows) +
                             ", the camera has " + std::to_string(sequence.width) + "x" +
                             std::to_string(sequence.height));
  }
  return image;
}

cv::Mat readColour(const std::string& path, const TumSequence& sequence) {
  cv::Mat rgb;
  cv::cvtColor(readImage(path, cv::IMREAD_COLOR, CV_8UC3, sequence), rgb, cv::COLOR_BGR2RGB);
  return rgb;
}

cv::Mat readDepth(const std::string& path, const TumSequence& sequence) {
  cv::Mat millimetres;
  readImage(path, cv::IMREAD_UNCHANGED, CV_16UC1, sequence)
      .convertTo(millimetres, CV_16U, kMillimetresPerMetre / sequence.depth_scale);
  return millimetres;
}

sensor_msgs::CameraInfo makeCameraInfo(const TumSequence& s) {
  sensor_msgs::CameraInfo info;
  info.width = static_cast<std::uint32_t>(s.width);
  info.height = static_cast<std::uint32_t>(s.height);
  info.distortion_model = "plumb_bob";
  info.D.assign(s.distortion.begin(), s.distortion.end());
  info.K = {s.fx, 0.0, s.cx, 0.0, s.fy, s.cy, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {s.fx, 0.0, s.cx, 0.0, 0.0, s.fy, s.cy, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

/// Takes the size from the images, if only focal lengths and centre are given.
void takeSizeOfImages(TumSequence& sequence) {
  if (sequence.width > 0) return;
  const std::string& path = sequence.pairs.front().rgb_path;
  const cv::Mat image = cv::imread(path, cv::IMREAD_COLOR);
  if (image.empty()) throw std::runtime_error("cannot read image " + path);
  sequence.width = image.cols;
  sequence.height = image.rows;
}

void convert(const std::string& folder, const TumOptions& options, const std::string& output,
             std::size_t start, std::size_t count) {
  TumSequence sequence = readTumSequence(folder, options);
  for (const std::string& remark : sequence.remarks) std::cerr << "tum_to_bag: " << remark << '\n';
  takeSizeOfImages(sequence);
  if (start >= sequence.pairs.size()) {
    throw std::runtime_error("--start " + std::to_string(start) + ": the sequence has only " +
                             std::to_string(sequence.pairs.size()) + " frames");
  }
  const sensor_msgs::CameraInfo info = makeCameraInfo(sequence);
  const std::vector<Entry> entries = selectEntries(sequence, start, count);
  std::vector<std::string> inputs = sequence.files;
  for (const Entry& entry : entries) inputs.push_back(*entry.path);
  requireNoInput(output, inputs);
  BagOutput bag(output);
  for (const Entry& entry : entries) {
    throwIfInterrupted();
    if (entry.is_depth) {
      writeDepth(bag, entry.stamp, readDepth(*entry.path, sequence), info);
    } else {
      writeColour(bag, entry.stamp, readColour(*entry.path, sequence), info);
    }
  }
  bag.commit();
  std::cout << output << ": " << entries.size() << " images\n";
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  CLI::App app("Turns a sequence in the TUM RGB-D layout, or an archive as it is unpacked, into a bag.",
               "tum_to_bag");
  rgbd_sfm_fusion::TumOptions options;
  std::string folder, output;
  std::size_t start = 0;
  std::size_t count = std::string::npos;
  app.add_option("SEQUENCE_DIR", folder,
                 "Folder with associations.txt and calib.txt, or with rgb.txt and depth.txt")
      ->required();
  app.add_option("OUT.bag", output, "Bag to write")->required();
  app.add_option("--start", start, "First pair of images to take, from 0");
  app.add_option("--count", count, "Number of pairs to take (default: all)");
  app.add_option(
      "--camera", options.camera,
      "freiburg1, freiburg2, freiburg3, icl, or fx,fy,cx,cy in pixels (default: from calib.txt, or by "
      "the folder's name)");
  app.add_option("--depth-scale", options.depth_scale,
                 "Counts of depth per metre (default: from calib.txt, or 5000, as in PNGs of TUM and ICL)")
      ->check(CLI::PositiveNumber);
  app.add_option("--rate", options.rate,
                 "For sequences whose stamps are numbers of images: the rate of the images [Hz]")
      ->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  rgbd_sfm_fusion::catchSignals();
  try {
    rgbd_sfm_fusion::convert(rgbd_sfm_fusion::withHome(folder), options, rgbd_sfm_fusion::withHome(output),
                             start, count);
  } catch (const rgbd_sfm_fusion::Interrupted& error) {
    std::cerr << "tum_to_bag: " << error.what() << "\n";
    return rgbd_sfm_fusion::kExitInterrupted;
  } catch (const std::exception& error) {
    std::cerr << "tum_to_bag: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
