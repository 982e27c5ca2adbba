// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rgbd_sfm_fusion/Keyframe.h>
#include <rgbd_sfm_fusion/TrackedFrame.h>
#include <ros/time.h>
#include <sensor_msgs/Image.h>

#include <cstddef>
#include <deque>
#include <optional>
#include <string>

#include "colour_input.h"

namespace rgbd_sfm_fusion {

/// Collects what belongs to a frame: the tracked frame names its depth image and the revision of its
/// keyframe.
///
/// Within one process, everything that a frame names comes before the frame. The exception is the map of a
/// frame that has just become a keyframe. A frame waits for what is missing. Across hosts, keyframes come at
/// a lower rate, so the revision nearest to the named one is taken.
class FusionInputs {
 public:
  struct Frame {
    TrackedFrameConstPtr tracked;
    sensor_msgs::ImageConstPtr depth;   ///< null: none belongs to it, or it did not come
    KeyframeConstPtr keyframe;          ///< null while not tracking, or it did not come
    sensor_msgs::ImageConstPtr colour;  ///< null: it is not wanted, or did not come
    std::string missing;                ///< what did not come in time; empty: nothing
    ros::Time nearest_depth;  ///< stamp of the depth image nearest in time, used or not; zero: none came
  };

  /// @param queue_size  frames that may wait
  explicit FusionInputs(std::size_t queue_size) : queue_size_(queue_size) {}

  /// @return whether an older frame was dropped for it
  /// @param now  of ROS: where /clock stops or is slow, a frame waits longer
  bool pushTracked(const TrackedFrameConstPtr& tracked, const ros::Time& now);
  void pushKeyframe(const KeyframeConstPtr& keyframe);
  void pushDepth(const sensor_msgs::ImageConstPtr& depth);
  /// Frames wait for their colour images once one has come.
  void pushColour(const sensor_msgs::ImageConstPtr& colour) { colour_.push(colour); }
  void forgetColour() { colour_.clear(); }

  /// The oldest frame if it is complete, or has waited too long.
  std::optional<Frame> pop(const ros::Time& now);

 private:
  struct Waiting {
    TrackedFrameConstPtr tracked;
    ros::Time since;
  };

  sensor_msgs::ImageConstPtr findDepth(const ros::Time& stamp) const;
  ros::Time nearestDepth(const ros::Time& stamp) const;
  KeyframeConstPtr findKeyframe(const TrackedFrame& tracked) const;
  void forgetOlderThan(const TrackedFrame& tracked);

  std::size_t queue_size_;
  std::deque<Waiting> waiting_;
  std::deque<KeyframeConstPtr> keyframes_;
  std::deque<sensor_msgs::ImageConstPtr> depth_;
  ColourBuffer colour_;
};

}  // namespace rgbd_sfm_fusion
