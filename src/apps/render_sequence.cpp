// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Writes what the virtual camera sees, and what is true, as sequences in the TUM RGB-D layout or as a bag.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "rgbd_sfm_fusion/ros/bag_output.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/rgbd_bag.h"
#include "rgbd_sfm_fusion/scene/room.h"
#include "rgbd_sfm_fusion/scene/virtual_camera.h"
#include "rgbd_sfm_fusion/tools/interruption.h"
#include "rgbd_sfm_fusion/tools/number_text.h"
#include "rgbd_sfm_fusion/tools/pending_file.h"
#include "rgbd_sfm_fusion/tools/tum_writer.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kSensorScale = 1000.0;  // [1/m]
constexpr double kTruthScale = 5000.0;   // [1/m] a fifth of a millimetre, and 13 m fit into 16 bits

struct Arguments {
  std::string output;
  std::string truth;
  std::string bag;
  std::string stamps;
  int start = 0;
  int count = -1;
  double skew_milliseconds = 0.0, readout_milliseconds = 0.0;
  VirtualCameraOptions camera;
};

void addOptions(CLI::App& app, Arguments& a) {
  VirtualCameraOptions& c = a.camera;
  app.add_option("OUTPUT", a.output,
                 "folder for the sequence; must not exist. Not needed with "
                 "--truth or --bag");
  app.add_option("--bag", a.bag, "the sequence as a bag");
  app.add_option(
      "--truth", a.truth,
      "second folder: depth/ without noise or holes (5000 per metre), mask/ with the material of each pixel "
      "(0 none, 1 matte, 2 dark, 3 shiny, 4 sunlit, 5 mirror)");
  app.add_option(
      "--stamps", a.stamps,
      "log of a live virtual camera (its setting log=FILE): renders its frames, with the host's stamps, "
      "instead of those from --start on. Give the same --seed and --rate as to the camera");
  app.add_option("--start", a.start, "first frame")->check(CLI::Range(0, 1000000));
  app.add_option("--count", a.count, "number of frames (default: one pass of the trajectory, 20 s)")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--seed", c.seed, "seed of trajectory and noise")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_option("--rate", c.rate, "frames per second [Hz]")->capture_default_str();
  app.add_option("--min-range", c.depth.min_range, "nearest depth that the sensor measures [m]")
      ->capture_default_str();
  app.add_option("--max-range", c.depth.max_range, "farthest depth that the sensor measures [m]")
      ->capture_default_str();
  app.add_option("--depth-scale-sigma", c.depth.scale_sigma, "spread over seeds of the depth sensor's scale")
      ->capture_default_str();
  app.add_flag("--depth-noise,!--no-depth-noise", c.depth.noise,
               "noise and steps of the depth sensor (default on)");
  app.add_flag(
      "--depth-holes,!--no-depth-holes",
      [&c](std::int64_t on) { c.depth.shadow = c.depth.materials = on > 0; },
      "shadows and materials without depth (default on)");
  app.add_option("--colour-noise", c.colour.noise, "noise of colour, standard deviation [grey levels]")
      ->capture_default_str();
  app.add_option("--exposure-drift", c.colour.exposure_drift, "largest relative change of the exposure")
      ->capture_default_str();
  app.add_flag("--blur,!--no-blur", c.colour.blur, "blur of the lens (default on)");
  app.add_option("--registration-x", c.registration_error.x(),
                 "error of registration: depth lies so many pixels too far to the right")
      ->capture_default_str();
  app.add_option("--registration-y", c.registration_error.y(),
                 "error of registration: depth lies so many pixels too far down")
      ->capture_default_str();
  app.add_option("--readout", a.readout_milliseconds,
                 "colour's rows are read one after another, over so many milliseconds")
      ->capture_default_str();
  app.add_option("--skew", a.skew_milliseconds, "depth is taken so many milliseconds after colour")
      ->capture_default_str();
}

cv::Mat scaledDepth(const DepthImage& metres) {
  cv::Mat scaled(metres.size(), CV_16UC1);
  for (int row = 0; row < metres.rows; ++row) {
    for (int x = 0; x < metres.cols; ++x) {
      const double value = kTruthScale * static_cast<double>(metres(row, x)) + 0.5;
      scaled.at<std::uint16_t>(row, x) =
          value >= 1.0 && value < 65536.0 ? static_cast<std::uint16_t>(value) : 0;
    }
  }
  return scaled;
}

void showProgress(int done, int count) {
  if (isatty(STDERR_FILENO) == 0) return;
  std::fprintf(stderr, "\r%d of %d frames%s", done, count, done == count ? "\n" : "");
}

std::string colourDirectorySeenFrom(const std::string& truth, const std::string& output) {
  namespace fs = std::filesystem;
  return fs::absolute(fs::path(output) / "rgb")
      .lexically_relative(fs::absolute(truth))
      .lexically_normal()
      .string();
}

/// A frame to be rendered, and the stamp under which it is written.
struct Wanted {
  std::uint32_t index;
  Stamp stamp;
};

std::vector<Wanted> framesOfLog(const std::string& path) {
  std::ifstream log(path);
  std::vector<Wanted> frames;
  for (std::string line; std::getline(log, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream words = plainStream(line);
    Wanted frame;
    std::uint64_t device_time;
    if (!(words >> frame.index >> device_time >> frame.stamp))
      throw std::runtime_error(path + ": expected lines of \"index device_us host_ns\", got \"" + line +
                               "\"");
    frames.push_back(frame);
  }
  if (frames.empty()) throw std::runtime_error(path + ": no frames of a virtual camera in it");
  return frames;
}

std::vector<Wanted> wantedFrames(const Arguments& a, const VirtualCamera& camera) {
  if (!a.stamps.empty()) return framesOfLog(a.stamps);
  std::vector<Wanted> frames;
  const int count = a.count > 0 ? a.count : camera.framesPerPass();
  for (int i = 0; i < count; ++i) {
    const auto index = static_cast<std::uint32_t>(a.start + i);
    frames.push_back({index, camera.stampOf(index)});
  }
  return frames;
}

/// The files that are asked for.
class Outputs {
 public:
  explicit Outputs(const Arguments& a) : info_(toCameraInfo({}, a.camera.camera)) {
    const std::string remark =
        "rendered scene, seed " + std::to_string(a.camera.seed) + "; images have no distortion.";
    if (!a.output.empty()) sequence_.emplace(a.output, a.camera.camera, kSensorScale, remark);
    if (!a.bag.empty()) bag_.emplace(a.bag);
    if (!a.truth.empty()) {
      truth_.emplace(a.truth, a.camera.camera, kTruthScale, "exact depth of a " + remark);
      if (sequence_) truth_->setColourDirectory(colourDirectorySeenFrom(a.truth, a.output));
    }
    if (!sequence_ && !bag_ && !truth_)
      throw std::invalid_argument("nothing to write: expected OUTPUT, --bag or --truth");
  }

  FrameParts parts() const { return {sequence_ || bag_, sequence_ || bag_, truth_.has_value()}; }

  void add(const VirtualFrame& frame) {
    if (sequence_)
      sequence_->add(frame.stamp, frame.rgb, frame.depth_stamp, frame.depth, frame.T_world_camera);
    if (bag_) {
      writeColour(*bag_, frame.stamp, frame.rgb, info_);
      writeDepth(*bag_, frame.depth_stamp, frame.depth, info_);
    }
    if (truth_) {
      truth_->add(frame.stamp, {}, frame.stamp, scaledDepth(frame.true_depth), frame.T_world_camera);
      truth_->addExtra("mask", frame.stamp, frame.mask);
    }
  }

  void finish() {
    if (sequence_) sequence_->finish();
    if (bag_) bag_->commit();
    if (truth_) truth_->finish();
  }

 private:
  sensor_msgs::CameraInfo info_;
  std::optional<TumWriter> sequence_, truth_;
  std::optional<BagOutput> bag_;
};

void render(const Arguments& a) {
  if (!a.bag.empty() && !a.stamps.empty()) requireNoInput(a.bag, {a.stamps});
  Outputs outputs(a);
  VirtualCamera camera(a.camera, sharedRoom());
  const std::vector<Wanted> frames = wantedFrames(a, camera);
  VirtualFrame frame;
  int done = 0;
  for (const Wanted& wanted : frames) {
    throwIfInterrupted();
    camera.render(wanted.index, frame, outputs.parts());
    frame.depth_stamp += wanted.stamp - frame.stamp;
    frame.stamp = wanted.stamp;
    outputs.add(frame);
    showProgress(++done, static_cast<int>(frames.size()));
  }
  outputs.finish();
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  CLI::App app("Renders the sequence that a hand-held RGB-D camera would record in a furnished room.");
  rgbd_sfm_fusion::Arguments arguments;
  rgbd_sfm_fusion::addOptions(app, arguments);
  CLI11_PARSE(app, argc, argv);
  rgbd_sfm_fusion::catchSignals();
  try {
    arguments.camera.skew = 1e-3 * arguments.skew_milliseconds;
    arguments.camera.readout = 1e-3 * arguments.readout_milliseconds;
    rgbd_sfm_fusion::render(arguments);
  } catch (const rgbd_sfm_fusion::Interrupted& error) {
    std::fprintf(stderr, "render_sequence: %s\n", error.what());
    return rgbd_sfm_fusion::kExitInterrupted;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "render_sequence: %s\n", error.what());
    return 1;
  }
  return 0;
}
