// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/camera/camera_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::int64_t kPeriod = 33'333;                 // [us]
constexpr Stamp kHostStart = 1'700'000'000'000'000'000;  // [ns]
constexpr std::int64_t kDeviceStart = 123'456'789;       // [us]

/// A device whose clock is faster than the host's by the share `drift`. Its frames take at least `latency` to
/// arrive.
struct Device {
  double drift = 0.0;
  double latency = 0.005;  ///< [s]
  double jitter = 0.0;     ///< [s] mean of an exponential distribution
  std::mt19937 random{7};

  /// [ns] by the host's clock
  Stamp taken(int frame) const { return kHostStart + frame * kPeriod * 1000; }
  std::uint64_t deviceTime(int frame) const {
    return static_cast<std::uint64_t>(kDeviceStart +
                                      std::llround(static_cast<double>(frame * kPeriod) * (1.0 + drift)));
  }
  Stamp arrival(int frame) {
    const double late = jitter > 0.0 ? std::exponential_distribution<>(1.0 / jitter)(random) : 0.0;
    return taken(frame) + static_cast<Stamp>(1e9 * (latency + late));
  }
  /// [s] by which a stamp is later than its frame was taken, less the latency
  double error(int frame, Stamp stamp) const { return toSeconds(stamp - taken(frame)) - latency; }
};

class CameraClockDrift : public ::testing::TestWithParam<double> {};

TEST_P(CameraClockDrift, StampsStayTrueUnderJitterAndDrift) {
  Device device;
  device.drift = GetParam();
  device.jitter = 0.01;
  CameraClock clock;
  Stamp last = 0;
  for (int frame = 0; frame < 30 * 600; ++frame) {
    const Stamp stamp = clock.toHost(device.deviceTime(frame), device.arrival(frame));
    ASSERT_GT(stamp, last) << frame;
    last = stamp;
    const double limit = frame > 150 ? 2e-3 : 0.1;
    ASSERT_LT(std::abs(device.error(frame, stamp)), limit) << frame;
  }
  EXPECT_EQ(clock.jumps(), 0);
}

INSTANTIATE_TEST_SUITE_P(Crystals, CameraClockDrift, ::testing::Values(-1e-4, -1e-6, 0.0, 1e-6, 1e-4));

TEST(CameraClock, EqualDeviceTimesGetEqualStamps) {
  Device device;
  device.jitter = 0.02;
  CameraClock clock;
  for (int frame = 0; frame < 300; ++frame) {
    const Stamp colour = clock.toHost(device.deviceTime(frame), device.arrival(frame));
    const Stamp depth = clock.toHost(device.deviceTime(frame), device.arrival(frame));
    ASSERT_EQ(colour, depth) << frame;
  }
}

TEST(CameraClock, AFirstFrameThatComesLateIsForgottenWithoutGoingBack) {
  Device device;
  CameraClock clock;
  Stamp last = clock.toHost(device.deviceTime(0), device.arrival(0) + 200'000'000);
  for (int frame = 1; frame < 90; ++frame) {
    const Stamp stamp = clock.toHost(device.deviceTime(frame), device.arrival(frame));
    ASSERT_GT(stamp, last) << frame;
    last = stamp;
  }
  EXPECT_LT(std::abs(device.error(89, last)), 1e-4);
}

TEST(CameraClock, DeliveriesThatStallDoNotMoveIt) {
  Device device;
  CameraClock clock;
  for (int frame = 0; frame < 900; ++frame) {
    // From frame 300 to 340 nothing comes, then all frames at once.
    const Stamp arrival = frame >= 300 && frame < 340 ? device.arrival(340) : device.arrival(frame);
    const Stamp stamp = clock.toHost(device.deviceTime(frame), arrival);
    ASSERT_LT(std::abs(device.error(frame, stamp)), 1e-3) << frame;
  }
  EXPECT_EQ(clock.jumps(), 0);
}

TEST(CameraClock, SurvivesAGapInTheFrames) {
  Device device;
  CameraClock clock;
  for (int frame = 0; frame < 100; ++frame) clock.toHost(device.deviceTime(frame), device.arrival(frame));
  const int later = 100 + 30 * 3600;  // nobody subscribed for an hour
  const Stamp stamp = clock.toHost(device.deviceTime(later), device.arrival(later));
  EXPECT_LT(std::abs(device.error(later, stamp)), 1e-3);
}

class CameraClockJump : public ::testing::TestWithParam<double> {};

TEST_P(CameraClockJump, FollowsAHostClockThatIsSet) {
  const auto jump = static_cast<Stamp>(1e9 * GetParam());
  Device device;
  device.jitter = 0.003;
  CameraClock clock;
  Stamp stamp = 0;
  for (int frame = 0; frame < 600; ++frame) {
    const Stamp moved = frame < 300 ? 0 : jump;
    stamp = clock.toHost(device.deviceTime(frame), device.arrival(frame) + moved);
    const bool has_followed = frame < 300 || frame > 450;
    ASSERT_TRUE(!has_followed || std::abs(device.error(frame, stamp - moved)) < 0.012) << frame;
  }
  EXPECT_EQ(clock.jumps(), 1);
}

INSTANTIATE_TEST_SUITE_P(Seconds, CameraClockJump, ::testing::Values(-3600.0, -0.5, 0.2, 1.0, 3600.0));

TEST(CameraClock, FollowsADeviceThatStartsAnew) {
  Device device;
  CameraClock clock;
  for (int frame = 0; frame < 100; ++frame) clock.toHost(device.deviceTime(frame), device.arrival(frame));
  const Stamp stamp = clock.toHost(17, device.arrival(200));
  EXPECT_EQ(stamp, device.arrival(200));
  EXPECT_EQ(clock.jumps(), 1);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
