// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <image_transport/image_transport.h>
#include <nodelet/nodelet.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <pluginlib/class_list_macros.hpp>

#include "camera_diagnostics.h"
#include "camera_publisher.h"
#include "camera_reconfiguration.h"
#include "rgbd_sfm_fusion/camera/camera_supervisor.h"
#include "rgbd_sfm_fusion/ros/stamp.h"

namespace rgbd_sfm_fusion {

/// Publishes what an OpenNI2 device sees. The supervisor's thread does all that may wait for hardware, and
/// calls back with frames; here they become messages, and subscribers become streams that are wanted.
class OpenNI2CameraNodelet : public nodelet::Nodelet {
 public:
  ~OpenNI2CameraNodelet() override {
    std::unique_ptr<CameraSupervisor> supervisor;
    {
      const std::lock_guard<std::mutex> lock(connect_mutex_);
      supervisor = std::move(supervisor_);
    }
    // Its thread ends here, before anything that it calls.
  }

 private:
  void onInit() override {
    ros::NodeHandle& private_handle = getPrivateNodeHandle();
    if (ros::Time::isSimTime())
      NODELET_WARN("/use_sim_time is set, but images of a camera get the time of day");
    reconfiguration_ = std::make_unique<CameraReconfiguration>(
        private_handle, [this] { return status().device; },
        [this](const CameraReconfiguration::Result& result) { configure(result); });
    // Held also while advertising: subscribers are counted when all is there.
    const std::lock_guard<std::mutex> lock(connect_mutex_);
    advertise();
    diagnostics_ = std::make_unique<CameraDiagnostics>(getNodeHandle(), private_handle, getName(),
                                                       [this] { return status(); });
    CameraSupervisor::Options options;
    options.device_id = private_handle.param<std::string>("device_id", "");
    supervisor_ = std::make_unique<CameraSupervisor>(
        options, settings_,
        CameraSupervisor::Callbacks{[this](const DeviceDescription& device) { opened(device); },
                                    [this](const CameraFrame& frame) { publish(frame); },
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
      return std::make_unique<CameraPublisher>(transport_.get(), name, frame, encoding, calibration,
                                               [this] { onSubscribersChanged(); });
    };
    rgb_ = add("rgb", rgb_frame, "rgb8", rgb_calibration_.get());
    registered_ = add("depth_registered", rgb_frame, "16UC1", rgb_calibration_.get());
    depth_ = add("depth", depth_frame, "16UC1", depth_calibration_.get());
    ir_ = add("ir", depth_frame, "mono16", depth_calibration_.get());
  }

  void configure(const CameraReconfiguration::Result& result) {
    rgb_time_offset_ = result.rgb_time_offset;
    depth_time_offset_ = result.depth_time_offset;
    const std::lock_guard<std::mutex> lock(connect_mutex_);
    settings_ = result.settings;
    if (!supervisor_) return;
    supervisor_->setSettings(settings_);
    updateWanted();
  }

  void onSubscribersChanged() {
    const std::lock_guard<std::mutex> lock(connect_mutex_);
    if (supervisor_) updateWanted();
  }

  /// With connect_mutex_ held.
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
    const std::lock_guard<std::mutex> lock(connect_mutex_);
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

  std::mutex connect_mutex_;  ///< of these two
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
