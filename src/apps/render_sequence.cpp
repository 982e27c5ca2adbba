// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Writes what the virtual camera sees, and what is true, as sequences in the TUM RGB-D layout.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "rgbd_sfm_fusion/scene/room.h"
#include "rgbd_sfm_fusion/scene/virtual_camera.h"
#include "rgbd_sfm_fusion/tools/tum_writer.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kSensorScale = 1000.0;  // [1/m]
constexpr double kTruthScale = 5000.0;   // [1/m] a fifth of a millimetre, and 13 m fit into 16 bits

struct Arguments {
  std::string output;
  std::string truth;
  int start = 0;
  int count = -1;
  double skew_milliseconds = 0.0;
  VirtualCameraOptions camera;
};

void addOptions(CLI::App& app, Arguments& a) {
  VirtualCameraOptions& c = a.camera;
  app.add_option("OUTPUT", a.output, "folder for the sequence; must not exist")->required();
  app.add_option(
      "--truth", a.truth,
      "second folder: depth/ without noise or holes (5000 per metre), mask/ with the material of each pixel "
      "(0 none, 1 matte, 2 dark, 3 shiny, 4 sunlit, 5 mirror)");
  app.add_option("--start", a.start, "first frame")->check(CLI::Range(0, 1000000));
  app.add_option("--count", a.count, "number of frames (default: one pass of the trajectory, 20 s)")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--seed", c.seed, "of trajectory and noise")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  app.add_option("--rate", c.rate, "frames per second [Hz]")->capture_default_str();
  app.add_option("--min-range", c.depth.min_range, "of the depth sensor [m]")->capture_default_str();
  app.add_option("--max-range", c.depth.max_range, "of the depth sensor [m]")->capture_default_str();
  app.add_flag("--depth-noise,!--no-depth-noise", c.depth.noise,
               "noise and steps of the depth sensor (default on)");
  app.add_flag(
      "--depth-holes,!--no-depth-holes",
      [&c](std::int64_t on) { c.depth.shadow = c.depth.materials = on > 0; },
      "shadows and materials without depth (default on)");
  app.add_option("--colour-noise", c.colour.noise, "standard deviation [grey level]")->capture_default_str();
  app.add_option("--exposure-drift", c.colour.exposure_drift, "largest relative change")
      ->capture_default_str();
  app.add_flag("--blur,!--no-blur", c.colour.blur, "of the lens (default on)");
  app.add_option("--registration-x", c.registration_error.x(), "depth too far right by [px]")
      ->capture_default_str();
  app.add_option("--registration-y", c.registration_error.y(), "depth too far down by [px]")
      ->capture_default_str();
  app.add_option("--skew", a.skew_milliseconds, "depth later than colour by [ms]")->capture_default_str();
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

void render(const Arguments& a) {
  VirtualCamera camera(a.camera, std::make_shared<const Scene>(makeRoom()));
  const std::string remark =
      "rendered scene, seed " + std::to_string(a.camera.seed) + "; images have no distortion.";
  TumWriter sequence(a.output, a.camera.camera, kSensorScale, remark);
  std::optional<TumWriter> truth;
  if (!a.truth.empty()) {
    truth.emplace(a.truth, a.camera.camera, kTruthScale, "exact depth of a " + remark);
    truth->setColourDirectory(colourDirectorySeenFrom(a.truth, a.output));
  }
  const int count = a.count > 0 ? a.count : camera.framesPerPass();
  VirtualFrame frame;
  for (int i = 0; i < count; ++i) {
    camera.render(static_cast<std::uint32_t>(a.start + i), frame);
    sequence.add(frame.stamp, frame.rgb, frame.depth_stamp, frame.depth, frame.T_world_camera);
    if (truth) {
      truth->add(frame.stamp, {}, frame.stamp, scaledDepth(frame.true_depth), frame.T_world_camera);
      truth->addExtra("mask", frame.stamp, frame.mask);
    }
    showProgress(i + 1, count);
  }
  sequence.finish();
  if (truth) truth->finish();
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  CLI::App app("Renders the sequence that a hand-held RGB-D camera would record in a furnished room.");
  rgbd_sfm_fusion::Arguments arguments;
  rgbd_sfm_fusion::addOptions(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    arguments.camera.skew = 1e-3 * arguments.skew_milliseconds;
    rgbd_sfm_fusion::render(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "render_sequence: %s\n", error.what());
    return 1;
  }
  return 0;
}
