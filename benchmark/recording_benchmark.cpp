// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// What each stage costs on the frames of a recording, beside two functions of OpenCV: rgbd::RgbdOdometry,
/// which only tracks (frame to keyframe, with the same keyframes), and rgbd::registerDepth, which only
/// reprojects. All run in turn on each frame, one after the other, and what is measured is this process's
/// processor time. So what else the machine does falls on all alike.
///
///     recording_benchmark RECORDING.bag [--frames N] [--json FILE] [--trajectories DIR]
///
/// Reading the bag is outside the clock. Trajectories are in the format of the TUM RGB-D benchmark.
#include <malloc.h>
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <opencv2/rgbd.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/pipeline/frame_preparation.h"
#include "rgbd_sfm_fusion/pipeline/pipeline.h"
#include "rgbd_sfm_fusion/ros/bag_input.h"
#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/settings/settings.h"
#include "rgbd_sfm_fusion/tools/text_format.h"

namespace {

using namespace rgbd_sfm_fusion;

/// [ms] of this process, whichever of its threads works.
double processorTime() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// [ms] that a call takes.
template <class Call>
double timeOf(const Call& call) {
  const double start = processorTime();
  call();
  return processorTime() - start;
}

/// Milliseconds of every frame.
struct Series {
  std::string name;
  std::vector<double> times;

  double percentile(double share) const {
    std::vector<double> sorted = times;
    std::sort(sorted.begin(), sorted.end());
    return sorted.at(static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1)));
  }
  double median() const { return percentile(0.5); }
};

/// What a frame takes [ms].
struct FrameTimes {
  double preparation = 0.0, tracking = 0.0, mapping = 0.0, fusion = 0.0;
  double rgbd_odometry = 0.0, register_depth = 0.0;
  bool has_depth = false;

  double odometry() const { return tracking + mapping; }
  double whole() const { return preparation + odometry() + fusion; }
};

struct Times {
  Series preparation{"preparation", {}}, tracking{"tracking", {}}, mapping{"mapping", {}},
      odometry{"tracking + mapping", {}}, fusion{"fusion", {}}, whole{"the whole", {}},
      rgbd_odometry{"OpenCV RgbdOdometry", {}}, register_depth{"OpenCV registerDepth", {}};
  // Frame by frame: what else the machine does at the time is in both parts of such a ratio.
  Series odometry_ratio{"tracking + mapping / RgbdOdometry", {}}, whole_ratio{"the whole / RgbdOdometry", {}},
      fusion_ratio{"fusion / registerDepth", {}};

  void add(const FrameTimes& frame) {
    preparation.times.push_back(frame.preparation);
    tracking.times.push_back(frame.tracking);
    mapping.times.push_back(frame.mapping);
    odometry.times.push_back(frame.odometry());
    fusion.times.push_back(frame.fusion);
    whole.times.push_back(frame.whole());
    rgbd_odometry.times.push_back(frame.rgbd_odometry);
    odometry_ratio.times.push_back(frame.odometry() / frame.rgbd_odometry);
    whole_ratio.times.push_back(frame.whole() / frame.rgbd_odometry);
    if (!frame.has_depth) return;
    register_depth.times.push_back(frame.register_depth);
    fusion_ratio.times.push_back(frame.fusion / frame.register_depth);
  }

  std::vector<const Series*> all() const {
    return {&preparation, &tracking, &mapping, &odometry, &fusion, &whole, &rgbd_odometry, &register_depth};
  }
};

/// Lines of a TUM trajectory: where each frame is, seen from the first one.
struct Trajectories {
  std::string package, rgbd_odometry;
};

std::string poseLine(Stamp stamp, const SE3& T_first_frame) {
  return formatStamp(stamp) + " " + formatPose(T_first_frame, ' ') + "\n";
}

/// The peers' part. They make fresh images in every call.
class Peers {
 public:
  explicit Peers(const PinholeCamera& camera)
      : size_(camera.width, camera.height),
        K_(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1),
        odometry_(cv::Mat(K_)) {}

  /// [ms] of tracking, from the keyframe of the last makeKeyframe().
  double track(const RgbdFrame& frame) {
    return timeOf([&] {
      cv::Ptr<cv::rgbd::OdometryFrame> image = cv::rgbd::OdometryFrame::create(frame.grey, depthOf(frame));
      cv::Mat pose;
      if (keyframe_ && odometry_.compute(image, keyframe_, pose, pose_)) pose_ = pose;
    });
  }

  /// Where RgbdOdometry has the last tracked frame. A frame that it fails on stays where the one before was.
  SE3 T_first_frame() const {
    const cv::Matx44d T(pose_);
    const cv::Matx33d R = T.get_minor<3, 3>(0, 0);
    const Eigen::Matrix3d rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.val);
    return T_first_keyframe_ * SE3(Eigen::Quaterniond(rotation), {T(0, 3), T(1, 3), T(2, 3)});
  }

  void makeKeyframe(const RgbdFrame& frame) {
    T_first_keyframe_ = T_first_frame();
    keyframe_ = cv::rgbd::OdometryFrame::create(frame.grey, depthOf(frame));
    pose_ = cv::Mat::eye(4, 4, CV_64F);
  }
  bool hasKeyframe() const { return static_cast<bool>(keyframe_); }

  /// [ms] of reprojecting a depth image.
  double registerDepth(const SE3& T_target_source, const DepthImage& depth) const {
    const Eigen::Matrix3d R = T_target_source.rotationMatrix();
    const Eigen::Vector3d t = T_target_source.translation();
    const cv::Matx44d Rt(R(0, 0), R(0, 1), R(0, 2), t(0), R(1, 0), R(1, 1), R(1, 2), t(1), R(2, 0), R(2, 1),
                         R(2, 2), t(2), 0, 0, 0, 1);
    return timeOf([&] {
      cv::Mat result;
      cv::rgbd::registerDepth(K_, K_, cv::noArray(), Rt, depth, size_, result);
    });
  }

 private:
  cv::Mat depthOf(const RgbdFrame& frame) const {
    return frame.depth.empty() ? cv::Mat(size_, CV_32F, std::numeric_limits<double>::quiet_NaN())
                               : cv::Mat(frame.depth);
  }

  cv::Size size_;
  cv::Matx33d K_;
  cv::rgbd::RgbdOdometry odometry_;
  cv::Ptr<cv::rgbd::OdometryFrame> keyframe_;
  cv::Mat pose_ = cv::Mat::eye(4, 4, CV_64F);  // from the frame to the keyframe
  SE3 T_first_keyframe_;
};

/// Tracked frames alone are counted, but for the first: what it does, no later one does.
Times measure(BagInput& bag, const Settings& settings, std::size_t frames, Trajectories& trajectories) {
  Pipeline pipeline(bag.calibration(), settings.odometry, settings.fusion, bag.depthCalibration(),
                    bag.depthIsRectified());
  Peers peers(pipeline.camera());
  Times times;
  for (std::size_t i = 0; i < frames; ++i) {
    const auto pair = bag.next();
    if (!pair) break;
    const RawImage colour = toRawImage(pair->colour, pair->stamp);
    const RawImage depth = toRawImage(pair->depth, pair->depth_stamp);
    MappedFrame mapped;
    RgbdFrame frame;
    FrameTimes took;
    took.preparation = timeOf([&] { frame = prepareFrame(pipeline.rectifier(), colour, depth); });
    took.tracking = timeOf([&] { mapped = pipeline.track(frame, pair->run); });
    took.mapping = timeOf([&] { mapped = pipeline.map(std::move(mapped)); });
    const bool is_counted = mapped.tracked.state == TrackingState::kTracking && peers.hasKeyframe();
    const bool is_keyframe = mapped.tracked.keyframe_stamp == mapped.tracked.stamp;
    const SE3 T_frame_keyframe = mapped.tracked.T_frame_keyframe;
    if (mapped.tracked.state == TrackingState::kTracking)
      trajectories.package += poseLine(frame.stamp, mapped.tracked.T_first_frame);
    took.fusion = timeOf([&] { pipeline.fuse(std::move(mapped)); });
    took.rgbd_odometry = peers.track(frame);
    took.has_depth = !frame.depth.empty();
    if (took.has_depth) took.register_depth = peers.registerDepth(T_frame_keyframe, frame.depth);
    if (is_counted) times.add(took);
    if (peers.hasKeyframe() || is_keyframe)
      trajectories.rgbd_odometry += poseLine(frame.stamp, peers.T_first_frame());
    if (!peers.hasKeyframe() || is_keyframe) peers.makeKeyframe(frame);
  }
  if (times.whole.times.empty())
    throw std::runtime_error("no frame was tracked, so there is nothing to measure");
  return times;
}

struct Ratio {
  std::string name;
  double value;
};

std::vector<Ratio> ratiosOf(const Times& times) {
  std::vector<Ratio> ratios;
  for (const Series* series : {&times.odometry_ratio, &times.whole_ratio, &times.fusion_ratio}) {
    if (!series->times.empty()) ratios.push_back({series->name, series->median()});
  }
  for (const Series* series : {&times.tracking, &times.mapping, &times.fusion, &times.whole})
    ratios.push_back({"p99 / median of " + series->name, series->percentile(0.99) / series->median()});
  return ratios;
}

void print(const Times& times) {
  std::printf("%zu frames, milliseconds of processor time\n", times.whole.times.size());
  for (const Series* series : times.all()) {
    if (series->times.empty()) continue;
    std::printf("%-22s median %6.2f   p95 %6.2f   p99 %6.2f\n", series->name.c_str(), series->median(),
                series->percentile(0.95), series->percentile(0.99));
  }
  for (const Ratio& ratio : ratiosOf(times)) std::printf("%-34s %.3f\n", ratio.name.c_str(), ratio.value);
}

void write(const Times& times, const std::string& path) {
  std::ofstream file(path);
  file << "{\"frames\": " << times.whole.times.size();
  for (const Series* series : times.all()) {
    if (series->times.empty()) continue;
    file << ",\n \"" << series->name << "\": {\"median\": " << series->median()
         << ", \"p95\": " << series->percentile(0.95) << ", \"p99\": " << series->percentile(0.99) << "}";
  }
  for (const Ratio& ratio : ratiosOf(times)) file << ",\n \"" << ratio.name << "\": " << ratio.value;
  file << "\n}\n";
  file.close();
  if (!file) throw std::runtime_error("can't write " + path);
}

void write(const std::string& text, const std::filesystem::path& path) {
  std::ofstream file(path);
  file << "# timestamp tx ty tz qx qy qz qw\n" << text;
  file.close();
  if (!file) throw std::runtime_error("can't write " + path.string());
}

void run(const std::string& path, const std::vector<std::string>& assignments, std::size_t frames,
         const std::string& json, const std::string& folder) {
  Settings settings;
  for (const std::string& assignment : assignments) applyAssignment(assignment, &settings);
  validate(settings);
  cv::setNumThreads(1);
  BagInput bag({path}, {}, settings.association,
               [](const std::string& topic, Stamp, const std::string& reason) {
                 std::cerr << "recording_benchmark: " << topic << ": left out: " << reason << '\n';
               });
  Trajectories trajectories;
  const Times times = measure(bag, settings, frames, trajectories);
  print(times);
  if (!json.empty()) write(times, json);
  if (folder.empty()) return;
  std::filesystem::create_directories(folder);
  write(trajectories.package, std::filesystem::path(folder) / "package.txt");
  write(trajectories.rgbd_odometry, std::filesystem::path(folder) / "rgbd_odometry.txt");
}

/// Memory that was freed stays with the process. By glibc's rules it does once something larger was freed, so
/// OpenCV's functions, whose images are new in each frame, would cost twice as much or not by what this
/// package has freed before.
void keepFreedMemory() {
  constexpr int kMost = 32 << 20;  // as much as glibc allows
  mallopt(M_MMAP_THRESHOLD, kMost);
  mallopt(M_TRIM_THRESHOLD, 2 * kMost);
}

}  // namespace

int main(int argc, char** argv) {
  keepFreedMemory();
  CLI::App app("What each stage costs on a recording, beside OpenCV's RgbdOdometry and registerDepth");
  std::string bag, json, trajectories;
  std::vector<std::string> assignments;
  std::size_t frames = std::numeric_limits<std::size_t>::max();
  app.add_option("RECORDING.bag", bag, "Bag as fuse_bag takes it")->required()->check(CLI::ExistingFile);
  app.add_option("--frames", frames, "So many from the start (default: all)")->check(CLI::Range(2, 1000000));
  app.add_option("--set", assignments, "Settings as key=value");
  app.add_option("--json", json, "File for the figures");
  app.add_option("--trajectories", trajectories,
                 "Folder for package.txt and rgbd_odometry.txt: where each has the frames");
  CLI11_PARSE(app, argc, argv);
  try {
    run(bag, assignments, frames, json, trajectories);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "recording_benchmark: " << error.what() << '\n';
    return 1;
  }
}
