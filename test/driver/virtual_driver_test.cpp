// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <OpenNI.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "openni2_session.h"
#include "rgbd_sfm_fusion/scene/room.h"
#include "rgbd_sfm_fusion/scene/virtual_camera.h"

namespace rgbd_sfm_fusion {
namespace {

/// A slow device, so that there is time to render all frames on any machine and under any load.
constexpr const char* kSettings = "seed=7 rate=10 ";

cv::Mat image(const openni::VideoFrameRef& frame) {
  const int type = frame.getVideoMode().getPixelFormat() == openni::PIXEL_FORMAT_RGB888 ? CV_8UC3 : CV_16UC1;
  // OpenNI2 gives const data. Nothing writes to the image that is made of it.
  return cv::Mat(frame.getHeight(), frame.getWidth(), type, const_cast<void*>(frame.getData()),
                 static_cast<std::size_t>(frame.getStrideInBytes()))
      .clone();
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

cv::Mat mirrored(const cv::Mat& image) {
  cv::Mat result;
  cv::flip(image, result, 1);
  return result;
}

std::uint32_t indexOf(const openni::VideoFrameRef& frame) {
  return static_cast<std::uint32_t>(frame.getFrameIndex());
}

/// An open device, registered, with streams that are not mirrored.
class VirtualDriver : public ::testing::Test {
 protected:
  void open(const std::string& settings = "") {
    sharedRoom();  // the driver uses it, too; making it takes a second, and more under sanitizers
    session_ = std::make_unique<OpenNI2Session>(kSettings + settings);
    ASSERT_EQ(session_->status, openni::STATUS_OK) << openni::OpenNI::getExtendedError();
    ASSERT_EQ(device_.open(openni::ANY_DEVICE), openni::STATUS_OK) << openni::OpenNI::getExtendedError();
    ASSERT_EQ(device_.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR), openni::STATUS_OK);
    create(colour_, openni::SENSOR_COLOR);
    create(depth_, openni::SENSOR_DEPTH);
  }

  void create(openni::VideoStream& stream, openni::SensorType sensor) {
    ASSERT_EQ(stream.create(device_, sensor), openni::STATUS_OK);
    ASSERT_EQ(stream.setMirroringEnabled(false), openni::STATUS_OK);
  }

  void TearDown() override {
    colour_.destroy();
    depth_.destroy();
    device_.close();
    session_.reset();
  }

  std::unique_ptr<OpenNI2Session> session_;
  openni::Device device_;
  openni::VideoStream colour_, depth_;
};

TEST_F(VirtualDriver, DeliversTheBitsOfTheCameraAlsoAfterARestart) {
  ASSERT_NO_FATAL_FAILURE(open());
  VirtualCamera camera(parseDriverSettings(kSettings).camera, sharedRoom());
  for (int start = 0; start < 2; ++start) {
    ASSERT_EQ(colour_.start(), openni::STATUS_OK);
    ASSERT_EQ(depth_.start(), openni::STATUS_OK);
    for (int i = 0; i < 3; ++i) {
      const auto colour = nextFrame(colour_), depth = nextFrame(depth_);
      ASSERT_TRUE(colour && depth);
      EXPECT_TRUE(same(image(*colour), camera.frame(indexOf(*colour)).rgb)) << colour->getFrameIndex();
      EXPECT_TRUE(same(image(*depth), camera.frame(indexOf(*depth)).depth)) << depth->getFrameIndex();
    }
    colour_.stop();
    depth_.stop();
  }
}

TEST_F(VirtualDriver, ColourAndDepthOfAnInstantHaveOneTimeStamp) {
  ASSERT_NO_FATAL_FAILURE(open("clock_offset=100 jitter=30"));
  ASSERT_EQ(device_.setDepthColorSyncEnabled(true), openni::STATUS_OK);
  ASSERT_EQ(colour_.start(), openni::STATUS_OK);
  ASSERT_EQ(depth_.start(), openni::STATUS_OK);
  std::map<int, std::uint64_t> colour_times, depth_times;
  for (int i = 0; i < 6; ++i) {
    const auto colour = nextFrame(colour_), depth = nextFrame(depth_);
    ASSERT_TRUE(colour && depth);
    EXPECT_GE(colour->getTimestamp(), 100000000U);
    colour_times[colour->getFrameIndex()] = colour->getTimestamp();
    depth_times[depth->getFrameIndex()] = depth->getTimestamp();
  }
  int pairs = 0;
  for (const auto& [index, time] : depth_times) {
    if (colour_times.count(index) == 0) continue;
    EXPECT_EQ(colour_times[index], time) << index;
    ++pairs;
  }
  EXPECT_GE(pairs, 3);
}

TEST_F(VirtualDriver, PropertiesChangeTheImages) {
  ASSERT_NO_FATAL_FAILURE(open("noise=off"));
  ASSERT_EQ(device_.setImageRegistrationMode(openni::IMAGE_REGISTRATION_OFF), openni::STATUS_OK);
  ASSERT_EQ(colour_.setMirroringEnabled(true), openni::STATUS_OK);
  colour_.getCameraSettings()->setAutoExposureEnabled(false);
  colour_.getCameraSettings()->setExposure(50);
  openni::VideoStream infrared;
  ASSERT_NO_FATAL_FAILURE(create(infrared, openni::SENSOR_IR));
  openni::VideoMode half = infrared.getVideoMode();
  half.setResolution(320, 240);
  ASSERT_EQ(infrared.setVideoMode(half), openni::STATUS_OK);
  for (openni::VideoStream* stream : {&colour_, &depth_, &infrared})
    ASSERT_EQ(stream->start(), openni::STATUS_OK);
  const auto colour = nextFrame(colour_), depth = nextFrame(depth_), ir = nextFrame(infrared);
  ASSERT_TRUE(colour && depth && ir);
  infrared.destroy();

  DriverSettings settings = parseDriverSettings(std::string(kSettings) + "noise=off");
  VirtualCamera camera(settings.camera, sharedRoom());
  settings.camera.offset.x() = settings.depth_camera_offset;
  VirtualCamera depth_camera(settings.camera, sharedRoom());
  cv::Mat dark;
  camera.frame(indexOf(*colour)).rgb.convertTo(dark, -1, 0.5);
  EXPECT_TRUE(same(image(*colour), mirrored(dark)));
  EXPECT_TRUE(same(image(*depth), depth_camera.frame(indexOf(*depth)).depth));
  EXPECT_FALSE(same(image(*depth), camera.frame(indexOf(*depth)).depth));
  EXPECT_EQ(image(*ir).size(), cv::Size(320, 240));
  cv::Mat grey;
  cv::cvtColor(depth_camera.frame(indexOf(*ir)).rgb, grey, cv::COLOR_RGB2GRAY);
  EXPECT_NEAR(cv::mean(image(*ir))[0], 4.0 * cv::mean(grey)[0], 8.0);
}

TEST_F(VirtualDriver, RefusesWhatADeviceDoes) {
  ASSERT_NO_FATAL_FAILURE(open("failing_starts=1"));
  EXPECT_NE(colour_.start(), openni::STATUS_OK);
  EXPECT_EQ(colour_.start(), openni::STATUS_OK);
  openni::VideoMode mode = colour_.getVideoMode();
  mode.setResolution(320, 240);
  EXPECT_NE(colour_.setVideoMode(mode), openni::STATUS_OK) << "while it runs";
  mode.setResolution(1280, 1024);
  colour_.stop();
  EXPECT_NE(colour_.setVideoMode(mode), openni::STATUS_OK) << "unknown size";
}

TEST_F(VirtualDriver, ASecondHandleSharesTheDevice) {
  ASSERT_NO_FATAL_FAILURE(open());
  openni::Device second;
  ASSERT_EQ(second.open(openni::ANY_DEVICE), openni::STATUS_OK);
  EXPECT_EQ(second.getImageRegistrationMode(), openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
  second.close();
  EXPECT_EQ(colour_.start(), openni::STATUS_OK);
  EXPECT_TRUE(nextFrame(colour_));
}

TEST(VirtualDriverLock, AnotherProcessCanHoldTheDevice) {
  const std::string path = ::testing::TempDir() + "virtual_driver_lock";
  const int file = ::open(path.c_str(), O_CREAT | O_RDWR, 0600);
  ASSERT_EQ(flock(file, LOCK_EX), 0);
  const OpenNI2Session session("lock=" + path);
  openni::Device device;
  EXPECT_NE(device.open(openni::ANY_DEVICE), openni::STATUS_OK);
  EXPECT_NE(std::string(openni::OpenNI::getExtendedError()).find("another process"), std::string::npos);
  ::close(file);
  EXPECT_EQ(device.open(openni::ANY_DEVICE), openni::STATUS_OK);
  device.close();
}

TEST(VirtualDriverSettings, ABadOneLeavesNoDriver) {
  const OpenNI2Session session("unplugg=3");
  EXPECT_NE(session.status, openni::STATUS_OK);
}

TEST_F(VirtualDriver, ShutsDownWhileStreamsRun) {
  ASSERT_NO_FATAL_FAILURE(open("absent_until=0"));
  ASSERT_EQ(colour_.start(), openni::STATUS_OK);
  ASSERT_TRUE(nextFrame(colour_));
}

TEST_F(VirtualDriver, UnpluggingAndPluggingInIsSeenAndTheDeviceWorksAgain) {
  struct Listener : openni::OpenNI::DeviceConnectedListener, openni::OpenNI::DeviceDisconnectedListener {
    void onDeviceConnected(const openni::DeviceInfo*) override { ++connected; }
    void onDeviceDisconnected(const openni::DeviceInfo*) override { ++disconnected; }
    std::atomic<int> connected{0}, disconnected{0};
  } listener;
  ASSERT_NO_FATAL_FAILURE(open("unplug=1.5 replug=2"));
  openni::OpenNI::addDeviceConnectedListener(&listener);
  openni::OpenNI::addDeviceDisconnectedListener(&listener);
  EXPECT_EQ(colour_.start(), openni::STATUS_OK);
  EXPECT_TRUE(becomesTrue([&] { return listener.connected == 1; }));
  EXPECT_EQ(listener.disconnected, 1);
  EXPECT_NE(depth_.start(), openni::STATUS_OK);
  EXPECT_NE(depth_.setMirroringEnabled(true), openni::STATUS_OK);
  colour_.destroy();
  depth_.destroy();
  device_.close();

  EXPECT_EQ(device_.open(openni::ANY_DEVICE), openni::STATUS_OK);
  create(colour_, openni::SENSOR_COLOR);
  EXPECT_EQ(colour_.start(), openni::STATUS_OK);
  EXPECT_TRUE(nextFrame(colour_));
  openni::OpenNI::removeDeviceConnectedListener(&listener);
  openni::OpenNI::removeDeviceDisconnectedListener(&listener);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
