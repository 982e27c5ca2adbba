// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tools/tum_writer.h"

#include <cstdio>
#include <locale>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "rgbd_sfm_fusion/tools/text_format.h"

namespace rgbd_sfm_fusion {
namespace fs = std::filesystem;

std::string stampText(Stamp stamp) {
  const Stamp microseconds = (stamp + 500) / 1000;
  char text[32];
  std::snprintf(text, sizeof text, "%lld.%06lld", static_cast<long long>(microseconds / 1000000),
                static_cast<long long>(microseconds % 1000000));
  return text;
}

namespace {

/// The folder's name without a '/' at its end; it must not exist yet.
fs::path newFolder(fs::path directory) {
  if (!directory.has_filename()) directory = directory.parent_path();
  if (fs::exists(fs::symlink_status(directory)))
    throw std::runtime_error(directory.string() + " exists already: remove it, or choose another name");
  return directory;
}

}  // namespace

TumWriter::TumWriter(const fs::path& directory, const PinholeCamera& camera, double depth_scale,
                     const std::string& remark)
    : final_(newFolder(directory)),
      part_folder_(final_.string() + ".part", PendingFolder::Existing::kRefuse),
      part_(part_folder_.path()) {
  rgb_ = open("rgb.txt");
  depth_ = open("depth.txt");
  associations_ = open("associations.txt");
  groundtruth_ = open("groundtruth.txt");
  groundtruth_ << "# timestamp tx ty tz qx qy qz qw (camera-to-world, optical frame)\n";
  std::ofstream calibration = open("calib.txt");
  calibration << "# fx fy cx cy w h depth_scale   (metres = png / depth_scale)\n"
              << camera.fx << ' ' << camera.fy << ' ' << camera.cx << ' ' << camera.cy << ' ' << camera.width
              << ' ' << camera.height << ' ' << depth_scale << "\n# " << remark << '\n';
  close(calibration, "calib.txt");
}

std::ofstream TumWriter::open(const std::string& name) const {
  std::ofstream file(part_ / name);
  file.imbue(std::locale::classic());
  if (!file) throw std::runtime_error("can't write " + (part_ / name).string());
  return file;
}

void TumWriter::close(std::ofstream& file, const std::string& name) const {
  file.close();
  if (!file) throw std::runtime_error("can't write " + (part_ / name).string() + " (disk full?)");
}

std::string TumWriter::writeImage(const std::string& subdirectory, Stamp stamp, const cv::Mat& image) {
  const std::string name = subdirectory + '/' + stampText(stamp) + ".png";
  const fs::path path = part_ / name;
  fs::create_directories(path.parent_path());
  bool written = false;
  try {
    written = cv::imwrite(path.string(), image, {cv::IMWRITE_PNG_COMPRESSION, 1});
  } catch (const cv::Exception&) {  // the message below says all that this one says
  }
  if (!written) throw std::runtime_error("can't write " + path.string() + " (disk full?)");
  return name;
}

void TumWriter::add(Stamp stamp, const cv::Mat& rgb, Stamp depth_stamp, const cv::Mat& depth,
                    const SE3& T_world_camera) {
  std::string rgb_name = colour_directory_ + '/' + stampText(stamp) + ".png";
  if (!rgb.empty()) {
    cv::Mat bgr;
    cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
    rgb_name = writeImage("rgb", stamp, bgr);
  }
  const std::string depth_name = writeImage("depth", depth_stamp, depth);
  rgb_ << stampText(stamp) << ' ' << rgb_name << '\n';
  depth_ << stampText(depth_stamp) << ' ' << depth_name << '\n';
  associations_ << stampText(stamp) << ' ' << rgb_name << ' ' << stampText(depth_stamp) << ' ' << depth_name
                << '\n';
  const Eigen::Vector3d& t = T_world_camera.translation();
  const Eigen::Quaterniond& q = T_world_camera.rotation();
  groundtruth_ << stampText(stamp);
  for (const double metres : {t.x(), t.y(), t.z()}) groundtruth_ << ' ' << formatNumber(metres, 7);
  for (const double part : {q.x(), q.y(), q.z(), q.w()}) groundtruth_ << ' ' << formatNumber(part, 9);
  groundtruth_ << '\n';
  if (!rgb_ || !depth_ || !associations_ || !groundtruth_) {
    throw std::runtime_error("can't write to " + part_.string() + " (disk full?)");
  }
}

void TumWriter::addExtra(const std::string& subdirectory, Stamp stamp, const cv::Mat& image) {
  writeImage(subdirectory, stamp, image);
}

void TumWriter::finish() {
  close(rgb_, "rgb.txt");
  close(depth_, "depth.txt");
  close(associations_, "associations.txt");
  close(groundtruth_, "groundtruth.txt");
  std::error_code error;
  fs::rename(part_, final_, error);
  if (error)
    throw std::runtime_error("can't rename " + part_.string() + " to " + final_.string() + ": " +
                             error.message());
  part_folder_.keep();
}

}  // namespace rgbd_sfm_fusion
