// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Shows whether processors of different kinds get the same results.
///
///     fuse_rendered render DIR FRAMES   writes images of the virtual camera
///     fuse_rendered fuse DIR            fuses them, and prints a line for each frame
///
/// A line has the position [m], the pixels of the sensor alone, of SfM alone, fused and completed, and the
/// mean depth [m].
#include <fstream>
#include <iomanip>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>

#include "rgbd_sfm_fusion/core.h"
#include "rgbd_sfm_fusion/scene/room.h"
#include "rgbd_sfm_fusion/scene/virtual_camera.h"

using namespace rgbd_sfm_fusion;

namespace {

std::string file(const std::string& folder, int frame, const char* what) {
  return folder + "/" + std::to_string(frame) + what;
}

void render(const std::string& folder, int frames) {
  VirtualCamera device({}, sharedRoom());
  std::ofstream stamps(folder + "/stamps.txt");
  for (int i = 0; i < frames; ++i) {
    const VirtualFrame image = device.frame(static_cast<std::uint32_t>(i));
    cv::imwrite(file(folder, i, "_rgb.png"), image.rgb);
    cv::imwrite(file(folder, i, "_depth.png"), image.depth);
    stamps << image.stamp << ' ' << image.depth_stamp << '\n';
  }
  if (!stamps) throw std::runtime_error("cannot write to " + folder);
}

/// @param change  relative, of the focal length
void fuse(const std::string& folder, double change) {
  const PinholeCamera view = VirtualCameraOptions().camera;
  CameraCalibration calibration;
  calibration.width = view.width;
  calibration.height = view.height;
  const double fx = view.fx * (1.0 + change), fy = view.fy * (1.0 + change);
  calibration.K = {fx, 0.0, view.cx, 0.0, fy, view.cy, 0.0, 0.0, 1.0};
  Pipeline pipeline(calibration, OdometryOptions(), FusionOptions());
  std::ifstream stamps(folder + "/stamps.txt");
  Stamp stamp, depth_stamp;
  for (int i = 0; stamps >> stamp >> depth_stamp; ++i) {
    const cv::Mat rgb = cv::imread(file(folder, i, "_rgb.png"), cv::IMREAD_UNCHANGED);
    const cv::Mat depth = cv::imread(file(folder, i, "_depth.png"), cv::IMREAD_UNCHANGED);
    const PipelineResult result = pipeline.process({stamp, "rgb8", rgb}, {depth_stamp, "16UC1", depth});
    const ProvenanceCounts& counts = result.fused.counts;
    const cv::Mat_<float>& mean = result.fused.depth.mean;
    const double mean_depth = cv::mean(mean, mean > 0.0F)[0];
    std::cout << std::setprecision(9) << result.mapped.tracked.T_first_frame.translation().transpose() << ' '
              << counts.sensor_only << ' ' << counts.sfm_only << ' ' << counts.fused << ' '
              << counts.completed << ' ' << mean_depth << '\n';
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 2 ? argv[1] : "";
  if (what == "render" && argc == 4) {
    render(argv[2], std::stoi(argv[3]));
  } else if (what == "fuse" && (argc == 3 || argc == 4)) {
    fuse(argv[2], argc == 4 ? std::stod(argv[3]) : 0.0);
  } else {
    std::cerr << "usage: fuse_rendered render DIR FRAMES | fuse_rendered fuse DIR [CHANGE_OF_FOCAL_LENGTH]\n";
    return 2;
  }
  return 0;
}
