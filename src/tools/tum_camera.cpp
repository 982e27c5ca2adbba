// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/tum_camera.h"

#include <cmath>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {
namespace {

struct Preset {
  const char* name;
  TumCamera camera;
};

// https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats, "Intrinsic Camera Calibration of the
// Kinect". ICL: as on its page, but with the y axis turned down.
const Preset kPresets[] = {
    {"freiburg1", {517.3, 516.5, 318.6, 255.3, 640, 480, 5000.0, {0.2624, -0.9531, -0.0054, 0.0026, 1.1633}}},
    {"freiburg2",
     {520.9, 521.0, 325.1, 249.7, 640, 480, 5000.0, {0.2312, -0.7849, -0.0033, -0.0001, 0.9172}}},
    {"freiburg3", {535.4, 539.2, 320.1, 247.6, 640, 480, 5000.0, {}}},
    {"icl", {481.2, 480.0, 319.5, 239.5, 640, 480, 5000.0, {}}},
};

std::vector<double> numbersOf(const std::string& text) {
  std::vector<double> numbers;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) {
    const std::optional<double> number = readNumber(part);
    if (!number) return {};
    numbers.push_back(*number);
  }
  return numbers;
}

}  // namespace

TumCamera parseTumCamera(const std::string& text) {
  std::string names;
  for (const Preset& preset : kPresets) {
    if (text == preset.name) return preset.camera;
    names += std::string(preset.name) + ", ";
  }
  const std::vector<double> numbers = numbersOf(text);
  if (numbers.size() != 4 || !(numbers[0] > 0.0) || numbers[1] == 0.0)
    throw std::runtime_error("camera '" + text + "': expected " + names + "or fx,fy,cx,cy in pixels");
  TumCamera camera;
  camera.fx = numbers[0];
  camera.fy = std::abs(numbers[1]);
  camera.cx = numbers[2];
  camera.cy = numbers[3];
  return camera;
}

std::string tumCameraOf(const std::string& folder_name) {
  for (const char* name : {"freiburg1", "freiburg2", "freiburg3"}) {
    if (folder_name.find(name) != std::string::npos) return name;
  }
  return "";
}

}  // namespace rgbd_sfm_fusion
