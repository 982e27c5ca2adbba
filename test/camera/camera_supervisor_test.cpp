// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// The supervisor on the virtual camera, which is plugged in and out as an environment variable says.
#include "rgbd_sfm_fusion/camera/camera_supervisor.h"

#include <OpenNI.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <map>

namespace rgbd_sfm_fusion {
namespace {

using std::chrono::steady_clock;

constexpr double kPatience = 20.0;  // [s] sanitizers are slow

double secondsSince(steady_clock::time_point start) {
  return std::chrono::duration<double>(steady_clock::now() - start).count();
}

std::ptrdiff_t countThreads() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return std::distance(begin(tasks), end(tasks));
}

/// A supervisor, and all that its callbacks have got.
class Camera {
 public:
  struct Frame {
    Stamp stamp;
    std::uint64_t device_time;
    cv::Size size;
    int type;
    bool registered;
  };

  explicit Camera(const std::string& driver, const CameraSettings& settings = {},
                  const std::vector<StreamKind>& streams = {StreamKind::kColour, StreamKind::kDepth},
                  const std::string& device_id = "") {
    setenv("RGBD_SFM_FUSION_VIRTUAL_CAMERA", driver.c_str(), 1);
    CameraSupervisor::Options options;
    options.device_id = device_id;
    supervisor = std::make_unique<CameraSupervisor>(
        options, settings,
        CameraSupervisor::Callbacks{[](const DeviceDescription&) {},
                                    [this](const CameraFrame& frame) { add(frame); },
                                    [this](CameraSupervisor::Severity, const std::string& text) {
                                      const std::lock_guard<std::mutex> lock(mutex_);
                                      said_ += text + "\n";
                                    }});
    want(streams);
  }

  ~Camera() { supervisor.reset(); }

  void want(const std::vector<StreamKind>& streams) {
    PerStream<bool> wanted;
    for (const StreamKind stream : streams) wanted[stream] = true;
    supervisor->setWanted(wanted);
  }

  std::size_t count(StreamKind stream) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return frames_[stream].size();
  }
  std::vector<Frame> frames(StreamKind stream) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return frames_[stream];
  }
  bool hasSaid(const std::string& text) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return said_.find(text) != std::string::npos;
  }
  std::string said() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return said_;
  }

  template <class Condition>
  bool waitFor(const Condition& condition) const {
    const auto start = steady_clock::now();
    while (!condition()) {
      if (secondsSince(start) > kPatience) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }

  /// Waits for that many more frames of both streams.
  bool waitForFrames(std::size_t more = 5) const {
    const std::size_t colour = count(StreamKind::kColour) + more, depth = count(StreamKind::kDepth) + more;
    return waitFor(
        [&] { return count(StreamKind::kColour) >= colour && count(StreamKind::kDepth) >= depth; });
  }

  std::unique_ptr<CameraSupervisor> supervisor;

 private:
  void add(const CameraFrame& frame) {
    const std::lock_guard<std::mutex> lock(mutex_);
    frames_[frame.stream].push_back(
        {frame.stamp, frame.device_time, frame.image.size(), frame.image.type(), frame.registered});
  }

  mutable std::mutex mutex_;
  PerStream<std::vector<Frame>> frames_;
  std::string said_;
};

/// Reads the driver's settings through a second handle of the device in this process.
struct SettingsInDriver {
  explicit SettingsInDriver(const std::string& uri) {
    openni::Device device;
    openni::VideoStream colour, depth;
    if (device.open(uri.c_str()) != openni::STATUS_OK) return;
    registered = device.getImageRegistrationMode() == openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
    if (colour.create(device, openni::SENSOR_COLOR) == openni::STATUS_OK) {
      mirrored = colour.getMirroringEnabled();
      auto_exposure = colour.getCameraSettings()->getAutoExposureEnabled();
      auto_white_balance = colour.getCameraSettings()->getAutoWhiteBalanceEnabled();
      exposure = colour.getCameraSettings()->getExposure();
    }
    if (depth.create(device, openni::SENSOR_DEPTH) == openni::STATUS_OK)
      mirrored = mirrored && depth.getMirroringEnabled();
    colour.destroy();
    depth.destroy();
    device.close();
  }
  bool registered = false, mirrored = false, auto_exposure = true, auto_white_balance = true;
  int exposure = -1;
};

TEST(CameraSupervisor, DeliversRegisteredPairsOfEqualStamps) {
  Camera camera("jitter=5");
  ASSERT_TRUE(camera.waitForFrames(10)) << camera.said();
  std::map<std::uint64_t, Stamp> colour_stamps;
  for (const Camera::Frame& frame : camera.frames(StreamKind::kColour)) {
    EXPECT_EQ(frame.type, CV_8UC3);
    EXPECT_EQ(frame.size, cv::Size(640, 480));
    colour_stamps[frame.device_time] = frame.stamp;
  }
  std::size_t pairs = 0;
  for (const Camera::Frame& frame : camera.frames(StreamKind::kDepth)) {
    EXPECT_EQ(frame.type, CV_16UC1);
    EXPECT_TRUE(frame.registered);
    const auto colour = colour_stamps.find(frame.device_time);
    if (colour == colour_stamps.end()) continue;
    ++pairs;
    EXPECT_EQ(frame.stamp, colour->second);
  }
  EXPECT_GE(pairs, 8U);
  EXPECT_FALSE(camera.hasSaid("frame sync")) << camera.said();
}

TEST(CameraSupervisor, ComesBackThreeTimesWithAllSettings) {
  CameraSettings settings;
  settings.mirror = true;
  settings.auto_exposure = settings.auto_white_balance = false;
  settings.exposure = 37;
  Camera camera("unplug=1.5,3.5,5.5 replug=2,4,6", settings);
  std::ptrdiff_t threads = 0;
  for (int connection = 1; connection <= 4; ++connection) {
    ASSERT_TRUE(camera.waitFor([&] { return camera.supervisor->status().connections == connection; }));
    const auto start = steady_clock::now();
    ASSERT_TRUE(camera.waitForFrames(3)) << camera.said();
    EXPECT_LT(secondsSince(start), 2.0);
    if (connection == 1) threads = countThreads();
    EXPECT_LE(countThreads(), threads) << connection;  // the driver's own threads may end
    const SettingsInDriver driver(camera.supervisor->status().device.uri);
    EXPECT_TRUE(driver.registered) << connection;
    EXPECT_TRUE(driver.mirrored) << connection;
    EXPECT_FALSE(driver.auto_exposure) << connection;
    EXPECT_FALSE(driver.auto_white_balance) << connection;
    EXPECT_EQ(driver.exposure, settings.exposure) << connection;
  }
  EXPECT_TRUE(camera.hasSaid("was unplugged"));
}

TEST(CameraSupervisor, WaitsForADeviceThatIsAbsentAndSaysWhatItSees) {
  Camera camera("absent_until=1");
  ASSERT_TRUE(camera.waitForFrames()) << camera.said();
  EXPECT_TRUE(camera.hasSaid("Devices seen: none"));
  EXPECT_TRUE(camera.hasSaid("OpenNI2/Drivers"));
  EXPECT_TRUE(camera.hasSaid("2bc5"));
}

TEST(CameraSupervisor, TriesAgainWhenStreamsDoNotStart) {
  Camera camera("failing_starts=3");
  ASSERT_TRUE(camera.waitForFrames()) << camera.said();
  EXPECT_TRUE(camera.hasSaid("cannot start"));
}

TEST(CameraSupervisor, OpensADeviceAnewThatStalls) {
  Camera camera("stall=1:30");
  ASSERT_TRUE(camera.waitFor([&] { return camera.hasSaid("has delivered nothing"); })) << camera.said();
  EXPECT_GE(camera.supervisor->status().connections, 1);
}

TEST(CameraSupervisor, WaitsForADeviceThatAnotherProcessHolds) {
  const std::string path = testing::TempDir() + "/virtual_camera_lock_" + std::to_string(getpid());
  const int descriptor = open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0600);
  ASSERT_EQ(flock(descriptor, LOCK_EX | LOCK_NB), 0);
  Camera camera("lock=" + path);
  EXPECT_TRUE(camera.waitFor([&] { return camera.hasSaid("another process may hold"); })) << camera.said();
  close(descriptor);
  EXPECT_TRUE(camera.waitForFrames()) << camera.said();
  unlink(path.c_str());
}

TEST(CameraSupervisor, StartsOnlyWhatIsWanted) {
  Camera camera("", {}, {});
  ASSERT_TRUE(camera.waitFor([&] { return camera.supervisor->status().connections == 1; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  for (const StreamKind stream : kAllStreams)
    EXPECT_FALSE(camera.supervisor->status().streams[stream].running);

  camera.want({StreamKind::kDepth});
  ASSERT_TRUE(camera.waitFor([&] { return camera.count(StreamKind::kDepth) > 2; })) << camera.said();
  EXPECT_EQ(camera.count(StreamKind::kColour), 0U);

  camera.want({StreamKind::kColour, StreamKind::kDepth});
  ASSERT_TRUE(camera.waitForFrames()) << camera.said();

  camera.want({});
  const auto is_idle = [&] { return camera.supervisor->status().state == CameraStatus::State::kReady; };
  EXPECT_TRUE(camera.waitFor(is_idle));
  const std::size_t frames = camera.count(StreamKind::kColour);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(camera.count(StreamKind::kColour), frames);
}

TEST(CameraSupervisor, ChangesSettingsWhileStreaming) {
  Camera camera("");
  ASSERT_TRUE(camera.waitForFrames()) << camera.said();
  CameraSettings settings;
  settings.registration = settings.frame_sync = false;
  settings.mirror = true;
  settings.modes[StreamKind::kColour] = {320, 240, 30};
  settings.modes[StreamKind::kDepth] = {123, 45, 6};  // the device does not have this mode
  camera.supervisor->setSettings(settings);
  const auto is_unregistered = [&] { return !camera.frames(StreamKind::kDepth).back().registered; };
  ASSERT_TRUE(camera.waitFor(is_unregistered));
  ASSERT_TRUE(camera.waitForFrames()) << camera.said();
  EXPECT_EQ(camera.frames(StreamKind::kColour).back().size, cv::Size(320, 240));
  EXPECT_EQ(camera.frames(StreamKind::kDepth).back().size, cv::Size(640, 480));
  EXPECT_TRUE(camera.hasSaid("depth has no mode 123x45@6"));
  EXPECT_TRUE(SettingsInDriver(camera.supervisor->status().device.uri).mirrored);
}

TEST(CameraSupervisor, StreamsInfraredToo) {
  Camera camera("", {}, {StreamKind::kInfrared, StreamKind::kColour});
  ASSERT_TRUE(camera.waitFor([&] { return camera.count(StreamKind::kInfrared) > 3; })) << camera.said();
  EXPECT_EQ(camera.frames(StreamKind::kInfrared).back().type, CV_16UC1);
  EXPECT_EQ(camera.frames(StreamKind::kInfrared).back().size, cv::Size(640, 480));
}

TEST(CameraSupervisor, CountsFramesThatAreDropped) {
  Camera camera("drop=0.2");
  EXPECT_TRUE(camera.waitForFrames(30)) << camera.said();
  EXPECT_GT(camera.supervisor->status().streams[StreamKind::kColour].dropped, 0U);
  EXPECT_FALSE(camera.hasSaid("frame sync")) << camera.said();
}

TEST(CameraSupervisor, FindsADeviceBySerialNumber) {
  Camera camera("serial=17081234", {}, {StreamKind::kColour}, "17081234");
  ASSERT_TRUE(camera.waitFor([&] { return camera.count(StreamKind::kColour) > 0; })) << camera.said();
  EXPECT_EQ(camera.supervisor->status().device.serial, "17081234");
}

TEST(CameraSupervisor, SaysWhenTheSerialNumberIsAnothers) {
  Camera camera("serial=17081234", {}, {StreamKind::kColour}, "17081235");
  EXPECT_TRUE(camera.waitFor([&] { return camera.hasSaid("no device \"17081235\""); }));
  EXPECT_TRUE(camera.hasSaid("Devices seen: 2bc5/0401"));
}

TEST(CameraSupervisor, EndsAtOnceWhateverItDoes) {
  for (const char* driver : {"", "absent_until=100", "failing_starts=1000", "stall=0:100"}) {
    for (const int delay : {0, 1, 20, 150}) {
      steady_clock::time_point start;
      {
        Camera camera(driver);
        std::this_thread::sleep_for(std::chrono::milliseconds(delay));
        start = steady_clock::now();
      }
      EXPECT_LT(secondsSince(start), kPatience) << driver << " " << delay;
    }
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
