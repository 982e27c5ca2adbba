// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/tum_sequence.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

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
      sequence.fy = std::abs(sequence.fy);  // ICL-NUIM has a y axis that points up
      found = words && sequence.fx > 0.0 && sequence.fy > 0.0 && sequence.width > 0 && sequence.height > 0 &&
              sequence.depth_scale > 0.0;
      if (!found) throw badLine(path, number, "fx fy cx cy w h depth_scale");
    }
  }
  if (!found) throw std::runtime_error(path + ": has no line 'fx fy cx cy w h depth_scale'");
}

constexpr Stamp kMostApart = 20'000'000;           // [ns] between paired images
constexpr Stamp kFirstNumber = 1'000'000'000'000;  // [ns] stamp of image number 0, as a stamp of 0 means none

/// Stamp of an image, from seconds or from its number.
Stamp stampOf(const std::string& text, double rate) {
  if (rate <= 0.0) return parseStamp(text);
  if (text.empty() || text.size() > kSecondDigits || !allDigits(text))
    throw std::runtime_error("'" + text + "' is no number of an image, as --rate expects");
  return kFirstNumber + static_cast<Stamp>(std::llround(1e9 * static_cast<double>(std::stoll(text)) / rate));
}

bool isDepthFile(const std::string& name) {
  return name.find("depth") != std::string::npos;
}

void readAssociations(const std::string& folder, const std::string& path, double rate,
                      TumSequence& sequence) {
  std::ifstream file = open(path);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words = plainStream(line);
    std::string rgb_stamp, rgb_file, depth_stamp, depth_file;
    if (!(words >> rgb_stamp >> rgb_file >> depth_stamp >> depth_file)) {
      throw badLine(path, number, "rgb_stamp rgb_file depth_stamp depth_file");
    }
    if (isDepthFile(rgb_file) && !isDepthFile(depth_file)) {
      std::swap(rgb_stamp, depth_stamp);
      std::swap(rgb_file, depth_file);
    }
    sequence.pairs.push_back({stampOf(rgb_stamp, rate), folder + "/" + rgb_file, stampOf(depth_stamp, rate),
                              folder + "/" + depth_file});
  }
  if (sequence.pairs.empty()) throw std::runtime_error(path + ": names no images");
}

struct ListedImage {
  Stamp stamp;
  std::string path;
};

/// Images of rgb.txt or depth.txt, in order of their stamps.
std::vector<ListedImage> readList(const std::string& folder, const std::string& path, double rate) {
  std::ifstream file = open(path);
  std::vector<ListedImage> images;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words = plainStream(line);
    std::string stamp, name;
    if (!(words >> stamp >> name)) throw badLine(path, number, "stamp file");
    images.push_back({stampOf(stamp, rate), folder + "/" + name});
  }
  if (images.empty()) throw std::runtime_error(path + ": names no images");
  std::stable_sort(images.begin(), images.end(),
                   [](const ListedImage& a, const ListedImage& b) { return a.stamp < b.stamp; });
  return images;
}

void associate(const std::vector<ListedImage>& colour, const std::vector<ListedImage>& depth,
               TumSequence& sequence) {
  std::size_t nearest = 0;
  for (const ListedImage& image : colour) {
    const auto distance = [&](std::size_t i) { return std::abs(depth[i].stamp - image.stamp); };
    while (nearest + 1 < depth.size() && distance(nearest + 1) < distance(nearest)) ++nearest;
    if (distance(nearest) <= kMostApart)
      sequence.pairs.push_back({image.stamp, image.path, depth[nearest].stamp, depth[nearest].path});
  }
  sequence.remarks.push_back("associations.txt is not there: of " + std::to_string(colour.size()) +
                             " colour images " + std::to_string(sequence.pairs.size()) +
                             " have a depth image within 20 ms");
  if (sequence.pairs.empty())
    throw std::runtime_error(
        "no depth image is within 20 ms of a colour image: do rgb.txt and depth.txt belong "
        "together?");
}

void readPairs(const std::string& folder, double rate, TumSequence& sequence) {
  const std::string associations = folder + "/associations.txt", rgb = folder + "/rgb.txt",
                    depth = folder + "/depth.txt";
  if (std::ifstream(associations) || !std::ifstream(rgb) || !std::ifstream(depth)) {
    sequence.files.push_back(associations);
    return readAssociations(folder, associations, rate, sequence);
  }
  sequence.files.insert(sequence.files.end(), {rgb, depth});
  associate(readList(folder, rgb, rate), readList(folder, depth, rate), sequence);
}

void readCamera(const std::string& folder, const TumOptions& options, TumSequence& sequence) {
  const std::string calibration = folder + "/calib.txt";
  std::string camera = options.camera;
  if (camera.empty() && !std::ifstream(calibration)) {
    camera = tumCameraOf(std::filesystem::weakly_canonical(folder).filename().string());
    if (camera.empty())
      throw std::runtime_error("cannot read " + calibration +
                               ": name the camera by --camera freiburg1, freiburg2, freiburg3, icl, or "
                               "fx,fy,cx,cy in pixels");
    sequence.remarks.push_back("calib.txt is not there: the camera is " + camera +
                               "'s, by the folder's name");
  }
  if (camera.empty()) {
    sequence.files.push_back(calibration);
    readCalibration(calibration, sequence);
  } else {
    static_cast<TumCamera&>(sequence) = parseTumCamera(camera);
  }
  if (options.depth_scale > 0.0) sequence.depth_scale = options.depth_scale;
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

TumSequence readTumSequence(const std::string& folder, const TumOptions& options) {
  TumSequence sequence;
  readCamera(folder, options, sequence);
  readPairs(folder, options.rate, sequence);
  return sequence;
}

}  // namespace rgbd_sfm_fusion
