// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "odometry_worker.h"

#include <ros/console.h>
#include <sys/resource.h>
#include <boost/make_shared.hpp>

#include <exception>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/ros/stamp.h"
#include "rgbd_sfm_fusion/ros/tracker_messages.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr std::uint32_t kFrameQueueSize = 100;  // small messages, none of which fusion should miss
constexpr std::size_t kMostToMap = 4;           // frames, of which the odometry holds 4 MB each
constexpr double kLookAgain = 0.002;            // [s] while tracking waits for mapping
constexpr int kNicer = 5;  // is mapping than the rest: a third of the time that tracking or fusion gets

/// Makes the calling thread give way to tracking and fusion where they need all of the processor.
void giveWay() {
  // On Linux, these are of the thread alone.
  static thread_local const int result = setpriority(PRIO_PROCESS, 0, getpriority(PRIO_PROCESS, 0) + kNicer);
  static_cast<void>(result);  // a process that may not do it runs as well
}

}  // namespace

OdometryWorker::OdometryWorker(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle,
                               CallbackGuard* guard, const std::string& name, const Settings& settings,
                               const FrameNames& frame_names)
    : guard_(guard),
      name_(name),
      settings_(settings),
      odom_frame_(handle, guard, frame_names.odom, frame_names.base, settings.run.publish_tf),
      frame_publisher_(ros::NodeHandle(private_handle).advertise<TrackedFrame>("frame", kFrameQueueSize)),
      pose_publisher_(private_handle),
      keyframe_publisher_(private_handle),
      diagnostics_(handle, private_handle, guard, name),
      mapping_worker_(kMostToMap, [this](const KeyframePublisher::Context& context) { map(context); }),
      queue_(static_cast<std::size_t>(settings.run.queue_size)) {
  keyframe_publisher_.setRate(settings.run.keyframe_rate);
  tracking_thread_ = std::thread([this] { trackAll(); });
}

OdometryWorker::~OdometryWorker() {
  queue_.close();
  tracking_thread_.join();
  mapping_worker_.finish();
}

void OdometryWorker::setSettings(const Settings& settings) {
  const std::lock_guard<std::mutex> lock(settings_mutex_);
  new_settings_ = settings;
  keyframe_publisher_.setRate(settings.run.keyframe_rate);
}

bool OdometryWorker::push(TrackerInput input) {
  // Locked for both steps, so that the thread that takes the next image finds the one that was left out for
  // it.
  const std::lock_guard<std::mutex> lock(left_out_mutex_);
  const std::optional<TrackerInput> dropped = queue_.push(std::move(input));
  if (dropped) left_out_.push_back({dropped->header, dropped->frame.depth_stamp, dropped->run});
  return dropped.has_value();
}

void OdometryWorker::trackAll() {
  while (const std::optional<TrackerInput> input = queue_.pop()) {
    try {
      publishLeftOut(*input);
      track(*input);
    } catch (const std::exception& error) {  // no image and no setting may end the process
      guard_->report("tracking", std::string("image left out: ") + error.what());
    } catch (...) {
      guard_->report("tracking", "image left out: something that is no std::exception was thrown");
    }
  }
}

void OdometryWorker::track(const TrackerInput& input) {
  const bool time_starts_anew = input.run != input_run_;
  input_run_ = input.run;
  if (time_starts_anew) ROS_WARN_STREAM(name_ << ": stamps went back, so it starts anew");
  if (reset_requested_.exchange(false) || time_starts_anew) restart();
  prepareOdometry(input.camera);

  waitForMap(input.frame.stamp);
  const TrackingResult tracked = odometry_->track(input.frame);
  std::exception_ptr unpublished;
  try {
    if (tracked.state == TrackingState::kTracking) odom_frame_.update(input.header, tracked.T_first_frame);
    publishTracked(input, tracked);
    say(input, tracked);
  } catch (...) {
    unpublished = std::current_exception();
  }
  // Whatever happens, each frame that waits for its mapping has its context.
  if (tracked.state == TrackingState::kTracking)
    mapping_worker_.push({input.header, camera_, run_, odom_frame_.place(), odom_frame_.isForeign()});
  if (unpublished) std::rethrow_exception(unpublished);
}

/// Waits, but not while the next image waits as well, unless mapping has nothing to leave out.
void OdometryWorker::waitForMap(Stamp stamp) {
  while (!odometry_->waitForMap(stamp, kLookAgain)) {
    if (queue_.empty()) continue;
    const std::size_t skipped = odometry_->skipMaps();
    if (skipped == 0) continue;
    diagnostics_.skippedMappings(skipped);
    return odometry_->waitForKeyframe();
  }
}

/// Runs in the mapping thread.
void OdometryWorker::map(const KeyframePublisher::Context& context) {
  giveWay();
  try {
    odometry_->map([&](const auto& map) { keyframe_publisher_.publish(*map, context); });
  } catch (const std::exception& error) {
    guard_->report("mapping", std::string("frame left out: ") + error.what());
  } catch (...) {
    guard_->report("mapping", "frame left out: something that is no std::exception was thrown");
  }
}

void OdometryWorker::publishLeftOut(const TrackerInput& input) {
  const auto isBefore = [&](const LeftOut& image) {
    return image.run < input.run || (image.run == input.run && image.header.stamp < input.header.stamp);
  };
  std::vector<LeftOut> left_out;
  {
    const std::lock_guard<std::mutex> lock(left_out_mutex_);
    for (; !left_out_.empty() && isBefore(left_out_.front()); left_out_.pop_front())
      left_out.push_back(left_out_.front());
  }
  for (const LeftOut& image : left_out) {
    if (image.run != input_run_) continue;  // its run begins with an image that is tracked
    TrackingResult nowhere;
    nowhere.stamp = fromRosTime(image.header.stamp);
    nowhere.state = TrackingState::kLost;
    auto message = boost::make_shared<TrackedFrame>(toMessage(image.header, nowhere, image.depth_stamp));
    message->run = run_;
    message->left_out = true;
    frame_publisher_.publish(message);
  }
}

void OdometryWorker::restart() {
  mapping_worker_.waitForAllBut(0);
  if (odometry_) odometry_->reset();
  odom_frame_.restart();
  pose_publisher_.restart();
  story_.restart();
  ++run_;
}

void OdometryWorker::prepareOdometry(const PinholeCamera& camera) {
  std::optional<Settings> settings;
  {
    const std::lock_guard<std::mutex> lock(settings_mutex_);
    settings.swap(new_settings_);
  }
  if (settings) {
    if (odometry_) odometry_->setOptions(settings->odometry);
    settings_ = *settings;
  }
  if (odometry_ && camera == camera_) return;
  if (odometry_) {
    ROS_WARN_STREAM(name_ << ": another camera_info came, so it starts anew");
    restart();
  }
  mapping_worker_.waitForAllBut(0);
  odometry_ = std::make_unique<VisualOdometry>(camera, settings_.odometry);
  camera_ = camera;
}

void OdometryWorker::publishTracked(const TrackerInput& input, const TrackingResult& tracked) {
  auto message = boost::make_shared<TrackedFrame>(toMessage(input.header, tracked, input.frame.depth_stamp));
  message->run = run_;
  frame_publisher_.publish(message);
  pose_publisher_.publish(input.header, tracked, odom_frame_);
  diagnostics_.tracked(tracked, secondsBetween(input.header.stamp, ros::Time::now()));
}

void OdometryWorker::say(const TrackerInput& input, const TrackingResult& tracked) {
  const auto line = story_.tell(tracked, !input.frame.depth.empty());
  if (!line) return;
  if (line->is_warning) {
    ROS_WARN_STREAM(name_ << ": " << line->text);
  } else {
    ROS_INFO_STREAM(name_ << ": " << line->text);
  }
}

}  // namespace rgbd_sfm_fusion
