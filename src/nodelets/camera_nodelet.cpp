// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>

#include <atomic>
#include <memory>
#include <pluginlib/class_list_macros.hpp>

#include "callback_guard.h"
#include "camera_diagnostics.h"
#include "camera_publisher.h"
#include "camera_reconfiguration.h"
#include "rgbd_sfm_fusion/camera/camera_supervisor.h"
#include "rgbd_sfm_fusion/camera/openni_library.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {

/// Publishes what an OpenNI2 device sees. The supervisor's thread does all that may wait for hardware, and
/// calls back with frames; here they become messages, and subscribers become streams that are wanted.
class OpenNI2CameraNodelet : public nodelet::Nodelet {
 public:
  ~OpenNI2CameraNodelet() override {
    if (!guard_) return;  // the nodelet was never initialised
    std::unique_ptr<CameraSupervisor> supervisor;
    {
      const CallbackGuard::Lock lock = guard_->lock();
      supervisor = std::move(supervisor_);
    }
    // The supervisor's thread ends here, before anything that it calls.
  }

 private:
  void onInit() override {
    guard_ = std::make_unique<CallbackGuard>(getName());
    const CallbackGuard::Lock until_all_is_made = guard_->lock();
    ros::NodeHandle& private_handle = getPrivateNodeHandle();
    if (ros::Time::isSimTime())
      NODELET_WARN(
          "/use_sim_time is set, but a camera's images are stamped with the time of day: "
          "'rosparam set use_sim_time false', and start anew");
    reconfiguration_ = std::make_unique<CameraReconfiguration>(
        private_handle, guard_->mutex(), [this] { return status().device; },
        [this](const CameraReconfiguration::Result& result) { configure(result); });
    advertise();
    diagnostics_ = std::make_unique<CameraDiagnostics>(getNodeHandle(), private_handle, guard_.get(),
                                                       getName(), [this] { return status(); });
    const auto library = private_handle.param<std::string>("openni2", "system");
    const std::string other = library == "system" ? "" : OpenNiLibrary::whyNotFrom(library);
    if (!other.empty()) NODELET_ERROR_STREAM(other);
    CameraSupervisor::Options options;
    options.device_id = private_handle.param<std::string>("device_id", "");
    supervisor_ = std::make_unique<CameraSupervisor>(
        options, settings_,
        CameraSupervisor::Callbacks{
            [this](const DeviceDescription& device) { guard_->run("device", [&] { opened(device); }); },
            [this](const CameraFrame& frame) { guard_->run(toText(frame.stream), [&] { publish(frame); }); },
            [this](auto severity, const std::string& text) { say(severity, text); }});
    updateWanted();
  }

  void advertise() {
    ros::NodeHandle& handle = getNodeHandle();
    ros::NodeHandle& private_handle = getPrivateNodeHandle();
    const auto rgb_frame = private_handle.param<std::string>("rgb_frame_id", "camera_rgb_optical_frame");
    const auto depth_frame =
        private_handle.param<std::string>("depth_frame_id", "camera_depth_optical_frame");
    rgb_calibration_ = std::make_unique<CameraCalibrationSource>(
        handle, "rgb", private_handle.param<std::string>("rgb_camera_info_url", ""));
    depth_calibration_ = std::make_unique<CameraCalibrationSource>(
        handle, "depth", private_handle.param<std::string>("depth_camera_info_url", ""));
    transport_ = std::make_unique<image_transport::ImageTransport>(handle);
    const auto add = [this](const char* name, const std::string& frame, const char* encoding,
                            CameraCalibrationSource* calibration) {
      return std::make_unique<CameraPublisher>(transport_.get(), name, frame, encoding, calibration, [this] {
        guard_->run("subscribers", [&] { onSubscribersChanged(); });
      });
    };
    rgb_ = add("rgb", rgb_frame, "rgb8", rgb_calibration_.get());
    registered_ = add("depth_registered", rgb_frame, "16UC1", rgb_calibration_.get());
    depth_ = add("depth", depth_frame, "16UC1", depth_calibration_.get());
    ir_ = add("ir", depth_frame, "mono16", depth_calibration_.get());
  }

  void configure(const CameraReconfiguration::Result& result) {
    rgb_time_offset_ = result.rgb_time_offset;
    depth_time_offset_ = result.depth_time_offset;
    const CallbackGuard::Lock lock = guard_->lock();
    settings_ = result.settings;
    if (!supervisor_) return;
    supervisor_->setSettings(settings_);
    updateWanted();
  }

  void onSubscribersChanged() {
    if (supervisor_) updateWanted();
  }

  /// To be called with the guard's lock held.
  void updateWanted() {
    PerStream<bool> wanted;
    wanted[StreamKind::kColour] = rgb_->isWanted();
    wanted[StreamKind::kDepth] = settings_.registration ? registered_->isWanted() : depth_->isWanted();
    wanted[StreamKind::kInfrared] = ir_->isWanted();
    if (settings_.registration && depth_->isWanted())
      NODELET_WARN_ONCE("depth/image_raw is empty while registration is on");
    supervisor_->setWanted(wanted);
  }

  CameraStatus status() {
    const CallbackGuard::Lock lock = guard_->lock();
    return supervisor_ ? supervisor_->status() : CameraStatus();
  }

  // What follows is called by the supervisor's thread.

  void opened(const DeviceDescription& device) {
    rgb_calibration_->deviceChanged(device.serial);
    depth_calibration_->deviceChanged(device.serial);
  }

  void publish(const CameraFrame& frame) {
    const bool is_colour = frame.stream == StreamKind::kColour;
    if (frame.stream == StreamKind::kDepth && !frame.registered && registered_->isWanted())
      NODELET_ERROR_THROTTLE(30,
                             "depth is not registered to colour: it goes to depth/image_raw, and "
                             "depth_registered/image_raw stays empty");
    publisherOf(frame).publish(frame, is_colour ? rgb_time_offset_ : depth_time_offset_);
    diagnostics_->published(frame.stream, (ros::WallTime::now().toSec() - toSeconds(frame.stamp)));
  }

  CameraPublisher& publisherOf(const CameraFrame& frame) {
    switch (frame.stream) {
      case StreamKind::kColour:
        return *rgb_;
      case StreamKind::kDepth:
        return frame.registered ? *registered_ : *depth_;
      default:
        return *ir_;
    }
  }

  void say(CameraSupervisor::Severity severity, const std::string& text) {
    switch (severity) {
      case CameraSupervisor::Severity::kInfo:
        NODELET_INFO_STREAM(text);
        return;
      case CameraSupervisor::Severity::kWarning:
        NODELET_WARN_STREAM(text);
        return;
      default:
        NODELET_ERROR_STREAM(text);
    }
  }

  std::unique_ptr<CallbackGuard> guard_;
  CameraSettings settings_;
  std::unique_ptr<CameraSupervisor> supervisor_;

  std::atomic<double> rgb_time_offset_{0.0}, depth_time_offset_{0.0};  ///< [s]
  std::unique_ptr<image_transport::ImageTransport> transport_;
  std::unique_ptr<CameraCalibrationSource> rgb_calibration_, depth_calibration_;
  std::unique_ptr<CameraPublisher> rgb_, registered_, depth_, ir_;
  std::unique_ptr<CameraDiagnostics> diagnostics_;
  std::unique_ptr<CameraReconfiguration> reconfiguration_;
};

}  // namespace rgbd_sfm_fusion

PLUGINLIB_EXPORT_CLASS(rgbd_sfm_fusion::OpenNI2CameraNodelet, nodelet::Nodelet)
