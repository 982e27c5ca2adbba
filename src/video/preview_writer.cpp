// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/video/preview_writer.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <system_error>
#include <vector>

#include "rgbd_sfm_fusion/median.h"

namespace rgbd_sfm_fusion {
namespace {

namespace fs = std::filesystem;

/// Not cv::CAP_ANY: some of its backends take a video's name for a pattern of images' names, or print much.
constexpr std::array<int, 2> kBackends = {cv::CAP_FFMPEG, cv::CAP_OPENCV_MJPEG};
constexpr double kUsualRate = 30.0;  // [Hz]
constexpr std::size_t kFramesForRate = 10;

std::runtime_error cannotWrite(const std::string& path, const std::string& reason) {
  return std::runtime_error("cannot write " + path + ": " + reason);
}

/// Codecs to try for the ending of a name, the best first; none if the name is not a video's.
std::vector<int> codecsFor(const std::string& path) {
  const int mjpg = cv::VideoWriter::fourcc('M', 'J', 'P', 'G'),
            mpeg4 = cv::VideoWriter::fourcc('m', 'p', '4', 'v');
  const std::map<std::string, std::vector<int>> codecs = {
      {".avi", {mjpg}}, {".mp4", {mpeg4}}, {".mov", {mpeg4, mjpg}}, {".mkv", {mpeg4, mjpg}}};
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto found = codecs.find(ending);
  return found == codecs.end() ? std::vector<int>() : found->second;
}

int framesIn(const std::string& video) {
  for (const int backend : kBackends) {
    const cv::VideoCapture capture(video, backend);
    if (capture.isOpened()) return static_cast<int>(capture.get(cv::CAP_PROP_FRAME_COUNT));
  }
  return 0;
}

/// `preview.avi` becomes `preview.partial.avi`, as OpenCV takes the format from the ending.
std::string temporaryVideoPath(const std::string& path) {
  const std::string ending = fs::path(path).extension().string();
  return path.substr(0, path.size() - ending.size()) + ".partial" + ending;
}

std::string withoutSlashes(std::string path) {
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return path;
}

/// Whether a folder holds nothing but what a preview consists of, so that it may be replaced.
bool isPreview(const fs::path& folder) {
  return std::all_of(fs::directory_iterator(folder), fs::directory_iterator(), [](const auto& entry) {
    const std::string name = entry.path().stem().string();
    return entry.path().extension() == ".png" && name.size() == 6 &&
           std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  });
}

}  // namespace

double videoRate(const std::vector<Stamp>& stamps) {
  std::vector<Stamp> gaps;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    if (stamps[i] > stamps[i - 1]) gaps.push_back(stamps[i] - stamps[i - 1]);
  if (gaps.empty()) return kUsualRate;
  return std::clamp(std::round(10.0 / toSeconds(median(gaps))) / 10.0, 1.0, 120.0);
}

PreviewWriter::PreviewWriter(const std::string& path, cv::Size size)
    : path_(withoutSlashes(path)), size_(size) {
  if (codecsFor(path_).empty()) {
    openFolder();
    return;
  }
  file_ = std::make_unique<PendingFile>(path_, temporaryVideoPath(path_));
  if (openVideo(kUsualRate)) return;
  file_.reset();
  used_folder_instead_ = true;
  path_ = fs::path(path_).replace_extension().string();
  openFolder();
}

PreviewWriter::~PreviewWriter() {
  video_.release();
  std::error_code ignored;
  if (!temporary_folder_.empty()) fs::remove_all(temporary_folder_, ignored);
}

bool PreviewWriter::openVideo(double rate) {
  for (const int codec : codecsFor(path_)) {
    for (const int backend : kBackends) {
      try {
        if (video_.open(file_->temporaryPath(), backend, codec, rate, size_, true)) return true;
      } catch (const cv::Exception&) {  // by this some builds of OpenCV tell that they lack the backend
      }
    }
  }
  return false;
}

void PreviewWriter::openFolder() {
  const bool is_there = fs::exists(path_);
  if (is_there && !fs::is_directory(path_))
    throw cannotWrite(path_, "it is a file; a name that ends in .avi would make a video");
  if (is_there && !isPreview(path_))
    throw cannotWrite(path_, "the folder has other files than a preview's in it");
  const std::string temporary_folder = path_ + ".partial";
  std::error_code error;
  fs::remove_all(temporary_folder, error);
  if (!error) fs::create_directory(temporary_folder, error);
  if (error) throw cannotWrite(path_, error.message());
  temporary_folder_ = temporary_folder;
}

void PreviewWriter::write(Stamp stamp, const cv::Mat_<cv::Vec3b>& rgb) {
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  if (!file_) {
    writePng(bgr);
  } else if (first_stamps_.size() < kFramesForRate) {
    first_stamps_.push_back(stamp);
    first_pictures_.push_back(bgr);
    if (first_stamps_.size() == kFramesForRate) startVideo();
  } else {
    video_.write(bgr);
  }
  ++written_;
}

void PreviewWriter::startVideo() {
  video_.release();
  if (!openVideo(videoRate(first_stamps_))) throw cannotWrite(path_, "the video can't be opened again");
  for (const cv::Mat& picture : first_pictures_) video_.write(picture);
  first_pictures_.clear();
}

void PreviewWriter::writePng(const cv::Mat& bgr) {
  std::array<char, 32> name{};
  std::snprintf(name.data(), name.size(), "/%06d.png", written_);
  const std::vector<int> fast = {cv::IMWRITE_PNG_COMPRESSION, 1};
  if (!cv::imwrite(temporary_folder_ + name.data(), bgr, fast))
    throw cannotWrite(path_ + name.data(), "is the disk full?");
}

void PreviewWriter::finish() {
  if (!file_) return;
  if (first_stamps_.size() < kFramesForRate) startVideo();
  video_.release();
  // OpenCV does not tell whether it could write, so look.
  const int found = framesIn(file_->temporaryPath());
  if (found < written_) {
    throw cannotWrite(path_, "the video has only " + std::to_string(found) + " of " +
                                 std::to_string(written_) + " frames; is the disk full?");
  }
}

void PreviewWriter::commit() {
  if (file_) {
    file_->commit();
    return;
  }
  std::error_code error;
  fs::remove_all(path_, error);
  if (!error) fs::rename(temporary_folder_, path_, error);
  if (error) throw cannotWrite(path_, error.message());
  temporary_folder_.clear();
}

}  // namespace rgbd_sfm_fusion
