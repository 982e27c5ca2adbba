// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <std_msgs/Header.h>

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "bounded_queue.h"
#include "callback_guard.h"
#include "keyframe_publisher.h"
#include "odom_frame.h"
#include "pose_publisher.h"
#include "rgbd_sfm_fusion/input/depth_association.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/settings/settings.h"
#include "rgbd_sfm_fusion/tools/ordered_worker.h"
#include "tracker_diagnostics.h"
#include "tracker_story.h"

namespace rgbd_sfm_fusion {

/// A prepared colour image, with what publishing needs.
struct TrackerInput {
  std_msgs::Header header;  ///< of the colour image
  RgbdFrame frame;
  PinholeCamera camera;
  std::uint32_t run = kFirstRun;  ///< where it changes, time has started anew
};

/// Tracks in one thread, maps in another, and publishes the results. Meanwhile the nodelet's own thread
/// prepares the next frame. A frame is tracked once the map that VisualOdometry asks for is there, so live
/// and offline runs give the same.
///
/// Under load, tracking comes first: if another image waits by then, frames that wait for their mapping are
/// not mapped. If tracking cannot keep up either, the newest images win. One that is left out is published as
/// well, without a pose, so that fusion still has the sensor's depth of it.
class OdometryWorker {
 public:
  /// Names of frames of tf.
  struct FrameNames {
    std::string odom;
    std::string base;
  };

  /// @param guard  of the callbacks, and where images that cannot be worked on are reported
  OdometryWorker(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle, CallbackGuard* guard,
                 const std::string& name, const Settings& settings, const FrameNames& frame_names);
  ~OdometryWorker();

  /// @return whether an older image is left out for it
  bool push(TrackerInput input);

  /// Makes the next image start anew. May be called from any thread, like setSettings().
  void requestReset() { reset_requested_ = true; }

  /// Takes effect with the next image.
  void setSettings(const Settings& settings);

  /// Whether anybody receives the tracked frames.
  bool hasListener() const { return frame_publisher_.getNumSubscribers() > 0; }

  TrackerDiagnostics& diagnostics() { return diagnostics_; }

 private:
  void trackAll();
  void track(const TrackerInput& input);
  void waitForMap(Stamp stamp);
  /// Maps the oldest frame that waits in the odometry. Frames and contexts go in the same order, and no frame
  /// is forgotten while contexts wait: pyramid levels do not change at run time.
  void map(const KeyframePublisher::Context& context);
  /// Of the images that came before `input`.
  void publishLeftOut(const TrackerInput& input);
  void restart();
  /// Makes the odometry, or gives it new settings, if need be.
  void prepareOdometry(const PinholeCamera& camera);
  void publishTracked(const TrackerInput& input, const TrackingResult& tracked);
  void say(const TrackerInput& input, const TrackingResult& tracked);

  CallbackGuard* guard_;
  std::string name_;

  /// An image that is not tracked.
  struct LeftOut {
    std_msgs::Header header;
    Stamp depth_stamp = kNoStamp;
    std::uint32_t run = kFirstRun;  ///< of TrackerInput
  };

  std::mutex left_out_mutex_;
  std::deque<LeftOut> left_out_;  ///< not published yet; in order
  std::mutex settings_mutex_;
  std::optional<Settings> new_settings_;
  std::atomic<bool> reset_requested_{false};

  // Used by the tracking thread. The mapping thread calls the odometry's map() and keyframe_publisher_, and
  // callbacks call what may be called from any thread: odom_frame_ for tf, diagnostics_, the number of
  // frame_publisher_'s subscribers, and keyframe_publisher_'s rate.
  Settings settings_;
  TrackerStory story_;
  std::uint32_t input_run_ = kFirstRun;  ///< of TrackerInput
  PinholeCamera camera_;
  std::unique_ptr<VisualOdometry> odometry_;
  std::uint32_t run_ = 0;  ///< of TrackedFrame
  OdomFrame odom_frame_;
  ros::Publisher frame_publisher_;
  PosePublisher pose_publisher_;
  KeyframePublisher keyframe_publisher_;
  TrackerDiagnostics diagnostics_;

  OrderedWorker<KeyframePublisher::Context> mapping_worker_;
  BoundedQueue<TrackerInput> queue_;
  std::thread tracking_thread_;
};

}  // namespace rgbd_sfm_fusion
