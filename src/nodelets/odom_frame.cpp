// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "odom_frame.h"

#include <ros/console.h>
#include <ros/this_node.h>
#include <tf2/exceptions.h>

#include <stdexcept>
#include <utility>

#include "rgbd_sfm_fusion/ros/conversions.h"
#include "rgbd_sfm_fusion/ros/odometry_messages.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kMostFrames = 10000;  // of foreign transforms that are remembered

}  // namespace

OdomFrame::OdomFrame(const ros::NodeHandle& handle, CallbackGuard* guard, std::string odom_frame,
                     std::string base_frame, bool publish_tf)
    : odom_frame_(withoutSlash(std::move(odom_frame))),
      base_frame_(withoutSlash(std::move(base_frame))),
      publish_tf_(publish_tf),
      listener_(handle, guard, &buffer_,
                [this](const geometry_msgs::TransformStamped& transform, const std::string& publisher) {
                  observe(transform, publisher);
                }) {}

bool OdomFrame::isForeign() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return moves_odom_.has_value();
}

OdomPlace OdomFrame::place() const {
  return {odom_frame_, child_frame_, T_odom_first_.value_or(SE3()), T_base_camera_.value_or(SE3())};
}

void OdomFrame::restart() {
  T_odom_first_.reset();
  has_said_axes_ = false;
}

/// Our own transforms come back, too. What else this process sends may be another nodelet's.
void OdomFrame::observe(const geometry_msgs::TransformStamped& transform, const std::string& publisher) {
  const std::string parent = withoutSlash(transform.header.frame_id);
  const std::string child = withoutSlash(transform.child_frame_id);
  const bool is_of_this_process = publisher == ros::this_node::getName();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (is_of_this_process && parent == odom_frame_ && moved_.count(child) > 0) return;
  if (foreign_.size() < kMostFrames) foreign_[child] = {parent, publisher};
  if (parent == odom_frame_) moves_odom_ = publisher;
}

void OdomFrame::update(const std_msgs::Header& header, const SE3& T_first_camera) {
  findPlace(withoutSlash(header.frame_id), T_first_camera);
  sayWhoElse();
  if (!publish_tf_ || child_frame_.empty() || isForeign() || foreignParentOf(child_frame_)) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    moved_.insert(child_frame_);
  }
  const OdomPlace here = place();
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = header.stamp;
  transform.header.frame_id = odom_frame_;
  transform.child_frame_id = child_frame_;
  transform.transform = toTransform(here.T_odom_first * T_first_camera * here.T_base_camera.inverse());
  broadcaster_.sendTransform(transform);
}

void OdomFrame::findPlace(const std::string& optical_frame, const SE3& T_first_camera) {
  const bool placed_on_base = T_odom_first_ && T_base_camera_;
  if (placed_on_base) return;
  T_base_camera_ = lookUpBase(optical_frame);
  if (hasBodyAxes(optical_frame, base_frame_, T_base_camera_)) {
    if (!has_said_axes_)
      ROS_WARN_STREAM(
          "images are in tf frame "
          << optical_frame << ", which has a body's axes (x forward). They are taken to look along its "
          << "x axis. Clouds and depth in that frame will look turned: set an optical frame (z forward) "
          << "where images are published, e.g. frameName of Gazebo's plug-ins");
    has_said_axes_ = true;
    T_base_camera_ = T_base_camera_.value_or(SE3()) * opticalToBodyAxes();
  }
  if (T_odom_first_ && !T_base_camera_) return;
  if (T_odom_first_) {
    ROS_WARN_STREAM("tf from " << base_frame_ << " to " << optical_frame << " came late: the " << odom_frame_
                               << " frame is moved to the base frame's pose");
  }
  const SE3 T_odom_camera = T_base_camera_ ? *T_base_camera_ : opticalToBodyAxes();
  T_odom_first_ = T_odom_camera * T_first_camera.inverse();
  child_frame_ = T_base_camera_ ? base_frame_ : optical_frame;
  if (child_frame_.empty()) ROS_WARN("images have no frame_id: no tf is published");
}

void OdomFrame::sayWhoElse() {
  if (has_said_odom_ || child_frame_.empty()) return;
  if (isForeign()) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ROS_WARN_STREAM(
        *moves_odom_ << " moves frames in tf frame " << odom_frame_
                     << ". That is taken to be the robot's own frame: neither tf nor poses are "
                        "published in it. To get a frame of our own, set odom_frame:=visual_odom");
    has_said_odom_ = true;
    return;
  }
  const std::optional<ForeignParent> parent = foreignParentOf(child_frame_);
  if (!parent || !publish_tf_ || said_parent_of_ == child_frame_) return;
  const std::string unknown = " (tf does not lead from " + base_frame_ + " to the images' frame)";
  ROS_WARN_STREAM(
      "tf frame " << child_frame_ << (T_base_camera_ ? "" : unknown) << " has a parent already, "
                  << parent->parent << " (from " << parent->publisher << "): no tf from " << odom_frame_
                  << " is published. If our tf should move the camera, set base_frame to "
                  << "the root of the camera's tf tree. If the robot moves it, set publish_tf:=false, and "
                  << "odom_frame:=visual_odom for poses in a frame of our own");
  said_parent_of_ = child_frame_;
}

std::optional<SE3> OdomFrame::lookUpBase(const std::string& optical_frame) const {
  if (base_frame_.empty() || optical_frame.empty()) return std::nullopt;
  try {
    return fromTransform(buffer_.lookupTransform(base_frame_, optical_frame, ros::Time(0)).transform);
  } catch (const tf2::TransformException&) {  // the usual case with bags
    return std::nullopt;
  } catch (const std::invalid_argument& error) {
    ROS_WARN_STREAM_THROTTLE(5, "tf from " << base_frame_ << " to " << optical_frame << ": " << error.what());
    return std::nullopt;
  }
}

std::optional<OdomFrame::ForeignParent> OdomFrame::foreignParentOf(const std::string& frame) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = foreign_.find(frame);
  return found == foreign_.end() ? std::nullopt : std::make_optional(found->second);
}

}  // namespace rgbd_sfm_fusion
