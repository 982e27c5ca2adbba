// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/ros/result_bag.h"

#include <limits>
#include <stdexcept>

#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/keyframe_messages.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"
#include "rgbd_sfm_fusion/ros/point_cloud.h"
#include "rgbd_sfm_fusion/ros/stamp.h"
#include "rgbd_sfm_fusion/ros/tracker_messages.h"

namespace rgbd_sfm_fusion {
namespace {

const std::string kFusionPrefix = "/fusion/";
const std::string kImageRect = "/fusion/image_rect";
const std::string kPoints = "/fusion/points";
const std::string kKeyframe = "/tracker/keyframe";
const std::string kKeyframePrefix = kKeyframe + "/";

std::set<std::string> defaultTopics() {
  return {"/fusion/mean",       "/fusion/variance",    "/fusion/provenance", "/fusion/scale",
          "/fusion/statistics", "/fusion/camera_info", "/tracker/pose",      "/tracker/frame"};
}

std::set<std::string> possibleTopics() {
  std::set<std::string> topics = defaultTopics();
  topics.insert({kImageRect, kPoints, "/tracker/odometry", kKeyframe, kKeyframePrefix + "camera_info",
                 kKeyframePrefix + "pose"});
  for (const FusionImageTopic& topic : fusionImageTopics()) topics.insert(kFusionPrefix + topic.name);
  for (const KeyframeImageTopic& topic : keyframeImageTopics()) topics.insert(kKeyframePrefix + topic.name);
  return topics;
}

std::set<std::string> selectTopics(const std::vector<std::string>& more) {
  const std::set<std::string> possible = possibleTopics();
  std::set<std::string> topics = defaultTopics();
  for (const std::string& topic : more) {
    if (possible.count(topic) == 0) {
      std::string message = "there is no topic " + topic + " to write; there are";
      for (const std::string& name : possible) message += "\n  " + name;
      throw std::invalid_argument(message);
    }
    topics.insert(topic);
  }
  return topics;
}

}  // namespace

ResultBag::ResultBag(const std::string& path, const std::vector<std::string>& more_topics,
                     BagCompression compression)
    : topics_(selectTopics(more_topics)), bag_(path, compression) {}

bool ResultBag::needsPicture() const {
  return has(kImageRect) || has(kPoints);
}

void ResultBag::write(const PipelineResult& result, const PinholeCamera& camera, const std::string& frame_id,
                      const cv::Mat& picture) {
  std_msgs::Header header;
  header.stamp = toRosTime(result.fused.stamp);
  header.frame_id = frame_id;
  if (result.mapped.run != run_) {
    totals_ = {};
    velocities_.restart();
  }
  run_ = result.mapped.run;
  totals_.add(result.fused);

  writeTracked(header, camera, result);
  for (const FusionImageTopic& topic : fusionImageTopics()) {
    if (has(kFusionPrefix + topic.name))
      bag_.write(kFusionPrefix + topic.name, *topic.make(header, result.fused));
  }
  writePictures(header, result.fused, camera, picture);
  bag_.write("/fusion/camera_info", toCameraInfo(header, camera));
  bag_.write("/fusion/scale", toScaleMessage(header, result.fused.scale));
  const double skew = skewSeconds(result.fused.stamp, result.mapped.frame.depth_stamp);
  constexpr double kNoLatency = std::numeric_limits<double>::quiet_NaN();
  bag_.write("/fusion/statistics", toStatisticsMessage(header, result.fused, totals_, kNoLatency, skew));
}

void ResultBag::writePictures(const std_msgs::Header& header, const FusedFrame& fused,
                              const PinholeCamera& camera, const cv::Mat& picture) {
  if (has(kImageRect)) bag_.write(kImageRect, *toPictureMessage(header, picture));
  if (has(kPoints)) bag_.write(kPoints, *toPointCloud(header, fused, camera, picture, {}));
}

void ResultBag::writeTracked(const std_msgs::Header& header, const PinholeCamera& camera,
                             const PipelineResult& result) {
  const TrackingResult& tracked = result.mapped.tracked;
  TrackedFrame frame = toMessage(header, tracked, result.mapped.frame.depth_stamp);
  frame.run = result.mapped.run - kFirstRun;
  bag_.write("/tracker/frame", frame);
  const CameraVelocity velocity = velocities_.next(tracked);
  if (tracked.state == TrackingState::kTracking) {
    const OdomPlace place{kDefaultOdomFrame, header.frame_id, opticalToBodyAxes(), SE3()};
    bag_.write("/tracker/pose",
               toPoseMessage(header, place.odom_frame, place.T_odom_first * tracked.T_first_frame));
    if (has("/tracker/odometry"))
      bag_.write("/tracker/odometry", toOdometryMessage(header, place, tracked, velocity));
  }
  if (result.mapped.map) writeKeyframe(header, camera, *result.mapped.map);
}

void ResultBag::writeKeyframe(const std_msgs::Header& header, const PinholeCamera& camera,
                              const KeyframeMap& keyframe) {
  const std_msgs::Header its_header = keyframeHeader(header, keyframe);
  const SE3 T_odom_first = opticalToBodyAxes();
  if (has(kKeyframe)) bag_.write(kKeyframe, *toMessage(its_header, keyframe, T_odom_first));
  for (const KeyframeImageTopic& topic : keyframeImageTopics()) {
    if (has(kKeyframePrefix + topic.name)) {
      bag_.write(kKeyframePrefix + topic.name, *topic.make(its_header, keyframe));
    }
  }
  if (has(kKeyframePrefix + "camera_info")) {
    bag_.write(kKeyframePrefix + "camera_info", toCameraInfo(its_header, camera));
  }
  if (has(kKeyframePrefix + "pose")) {
    bag_.write(kKeyframePrefix + "pose",
               toPoseMessage(its_header, kDefaultOdomFrame, T_odom_first * keyframe.T_first_keyframe));
  }
}

}  // namespace rgbd_sfm_fusion
