// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/tum_sequence.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "rgbd_sfm_fusion/tools/number_text.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kSecondDigits = 9;  // 1e9 s are 31 years; ROS 1 stamps end at 4.29e9 s
constexpr std::size_t kNanosecondDigits = 9;

bool allDigits(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

std::ifstream open(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  return file;
}

std::runtime_error badLine(const std::string& path, int number, const std::string& expected) {
  return std::runtime_error(path + ", line " + std::to_string(number) + ": expected '" + expected + "'");
}

void readCalibration(const std::string& path, TumSequence& sequence) {
  std::ifstream file = open(path);
  bool found = false;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::istringstream words = plainStream(line);
    std::string hash, key;
    if (std::istringstream(line) >> hash >> key && hash == "#" && key == "dist") {
      words >> hash >> key;
      for (double& coefficient : sequence.distortion) words >> coefficient;
      if (!words) throw badLine(path, number, "# dist k1 k2 p1 p2 k3");
    } else if (!found && !line.empty() && line[0] != '#') {
      words >> sequence.fx >> sequence.fy >> sequence.cx >> sequence.cy >> sequence.width >>
          sequence.height >> sequence.depth_scale;
      found = words && sequence.fx > 0.0 && sequence.fy > 0.0 && sequence.width > 0 && sequence.height > 0 &&
              sequence.depth_scale > 0.0;
      if (!found) throw badLine(path, number, "fx fy cx cy w h depth_scale");
    }
  }
  if (!found) throw std::runtime_error(path + ": has no line 'fx fy cx cy w h depth_scale'");
}

void readAssociations(const std::string& folder, const std::string& path, TumSequence& sequence) {
  std::ifstream file = open(path);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words = plainStream(line);
    std::string rgb_stamp, rgb_file, depth_stamp, depth_file;
    if (!(words >> rgb_stamp >> rgb_file >> depth_stamp >> depth_file)) {
      throw badLine(path, number, "rgb_stamp rgb_file depth_stamp depth_file");
    }
    sequence.pairs.push_back(
        {parseStamp(rgb_stamp), folder + "/" + rgb_file, parseStamp(depth_stamp), folder + "/" + depth_file});
  }
  if (sequence.pairs.empty()) throw std::runtime_error(path + ": names no images");
}

}  // namespace

Stamp parseStamp(const std::string& seconds) {
  const std::size_t point = seconds.find('.');
  const std::string whole = seconds.substr(0, point);
  std::string fraction = point == std::string::npos ? "" : seconds.substr(point + 1);
  const bool too_large =
      whole.size() > kSecondDigits + 1 || (whole.size() > kSecondDigits && whole > "4294967295");
  if (whole.empty() || !allDigits(whole) || !allDigits(fraction) || too_large) {
    throw std::runtime_error("'" + seconds + "' is no time stamp in seconds");
  }
  fraction.resize(kNanosecondDigits, '0');
  return std::stoll(whole) * 1'000'000'000 + std::stoll(fraction);
}

TumSequence readTumSequence(const std::string& folder) {
  TumSequence sequence;
  readCalibration(folder + "/calib.txt", sequence);
  readAssociations(folder, folder + "/associations.txt", sequence);
  return sequence;
}

}  // namespace rgbd_sfm_fusion
