// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Input that can't be used gets one clear message, and the nodelets live on.
#include <cmath>
#include <limits>
#include <memory>

#include "live_test.h"
#include "rgbd_sfm_fusion/TrackedFrame.h"

namespace rgbd_sfm_fusion {
namespace {

class BadInputTest : public LiveTest {
 protected:
  void SetUp() override {
    start([this] {
      return mean_.isConnected() && provenance_.isConnected() && frame_.isConnected() &&
             console_.isConnected();
    });
  }

  /// A good image is tracked and fused, whatever came before it.
  void expectAlive(int first_frame) {
    callReset();
    for (int frame = first_frame; frame < first_frame + 2; ++frame) {
      const Stamp stamp = live_camera_.send(camera_, frame);
      ASSERT_TRUE(mean_.at(stamp));
      EXPECT_EQ(frame_.at(stamp)->state, TrackedFrame::TRACKING);
    }
  }

  cv::Mat_<std::uint8_t> provenance(Stamp stamp) {
    const auto image = provenance_.at(stamp);
    return image ? cv::Mat_<std::uint8_t>(viewImage(image)).clone() : cv::Mat_<std::uint8_t>();
  }

  static int pixels(const cv::Mat_<std::uint8_t>& image, int value) {
    return cv::countNonZero(image == value);
  }

  Console console_;
  Inbox<sensor_msgs::Image> mean_{"/fusion/mean"};
  Inbox<sensor_msgs::Image> provenance_{"/fusion/provenance"};
  Inbox<TrackedFrame> frame_{"/tracker/frame"};
};

// Has to run first: after it there is a camera_info.
TEST_F(BadInputTest, A_WithoutCameraInfoItSaysWhatIsMissing) {
  EXPECT_TRUE(spinUntil([this, frame = 0]() mutable {
    spinUntil([] { return false; }, 0.05);
    live_camera_.sendColour(camera_.colour(frame));
    live_camera_.sendDepth(camera_.depthImage(frame++));
    return console_.count({"no data for 5 seconds", "/camera/rgb/camera_info"}) > 0;
  }));
  EXPECT_TRUE(mean_.messages.empty());
}

TEST_F(BadInputTest, ImagesThatCameBeforeTheirCalibrationAreNotLost) {
  live_camera_.sendColour(camera_.colour(0));
  live_camera_.sendDepth(camera_.depthImage(0));
  spinUntil([] { return false; }, 0.3);
  live_camera_.sendInfo(camera_.info(0));
  EXPECT_TRUE(mean_.at(camera_.stamp(0)));
}

TEST_F(BadInputTest, AnUncalibratedCameraIsSaidToBe) {
  sensor_msgs::CameraInfo info = camera_.info(0);
  info.K[0] = info.P[0] = 0.0;
  for (int i = 0; i < 10; ++i) live_camera_.sendInfo(info);
  EXPECT_TRUE(console_.waitFor({"/camera/rgb/camera_info", "K[0]"}));
  spinUntil([] { return false; }, 0.3);
  EXPECT_LE(console_.count({"K[0]"}), 2U) << "one from each nodelet, throttled";
  expectAlive(1);
}

TEST_F(BadInputTest, DepthOfAnotherSizeIsNotUsed) {
  live_camera_.send(camera_, 0);
  sensor_msgs::ImagePtr depth = camera_.depthImage(1);
  depth->height = 120;
  depth->data.resize(depth->data.size() / 2);
  live_camera_.sendDepth(depth);
  live_camera_.sendColour(camera_.colour(1));
  EXPECT_TRUE(console_.waitFor({"/camera/depth_registered/image_raw", "320x120", "320x240"}));
  const auto sources = provenance(camera_.stamp(1));
  ASSERT_FALSE(sources.empty());
  EXPECT_EQ(pixels(sources, 1) + pixels(sources, 3), 0);
  expectAlive(2);
}

TEST_F(BadInputTest, ColourOfAnotherSizeThanItsCalibrationIsSaidToBe) {
  sensor_msgs::ImagePtr colour = camera_.colour(0);
  colour->height = 120;
  colour->data.resize(colour->data.size() / 2);
  live_camera_.sendInfo(camera_.info(0));
  live_camera_.sendDepth(camera_.depthImage(0));
  live_camera_.sendColour(colour);
  EXPECT_TRUE(console_.waitFor({"/camera/rgb/image_raw", "320x120", "320x240"}));
  expectAlive(1);
}

TEST_F(BadInputTest, UnknownEncodingsAreNamedWithThoseThatAreKnown) {
  live_camera_.sendInfo(camera_.info(0));
  int frame = 0;
  EXPECT_TRUE(spinUntil([&] {  // may take seconds, as messages about this topic are throttled
    spinUntil([] { return false; }, 0.05);
    sensor_msgs::ImagePtr colour = camera_.colour(frame);
    colour->encoding = "16UC1";  // depth, by mistake
    live_camera_.sendDepth(camera_.depthImage(frame++));
    live_camera_.sendColour(colour);
    return console_.count({"/camera/rgb/image_raw", "16UC1", "rgb8"}) > 0;
  }));
  spinUntil([] { return false; }, 0.3);
  EXPECT_EQ(console_.count({"/camera/rgb/image_raw", "16UC1"}), 1U);

  EXPECT_TRUE(spinUntil([&] {
    spinUntil([] { return false; }, 0.05);
    sensor_msgs::ImagePtr depth = camera_.depthImage(frame);
    depth->encoding = "32SC1";
    live_camera_.sendDepth(depth);
    live_camera_.sendColour(camera_.colour(frame++));
    return console_.count({"/camera/depth_registered/image_raw", "32SC1", "16UC1"}) > 0;
  }));

  sensor_msgs::ImagePtr nonsense = camera_.colour(frame);
  nonsense->encoding = "no such thing";
  live_camera_.sendDepth(camera_.depthImage(frame));
  live_camera_.sendColour(nonsense);
  expectAlive(frame + 1);
}

TEST_F(BadInputTest, ImagesShorterThanTheySayDoNoHarm) {
  live_camera_.sendInfo(camera_.info(0));
  sensor_msgs::ImagePtr colour = camera_.colour(0);
  colour->data.resize(100);
  live_camera_.sendDepth(camera_.depthImage(0));
  live_camera_.sendColour(colour);
  sensor_msgs::ImagePtr depth = camera_.depthImage(1);
  depth->data.clear();
  live_camera_.sendDepth(depth);
  live_camera_.sendColour(camera_.colour(1));
  EXPECT_TRUE(mean_.at(camera_.stamp(1)));
  expectAlive(2);
}

TEST_F(BadInputTest, ImagesWithoutAStampAreSaidToBe) {
  sensor_msgs::ImagePtr colour = camera_.colour(0);
  colour->header.stamp = ros::Time();
  EXPECT_TRUE(spinUntil([&] {  // may take a second, as messages about this topic are throttled
    spinUntil([] { return false; }, 0.05);
    live_camera_.sendColour(colour);
    return console_.count({"/camera/rgb/image_raw", "no time stamp"}) > 0;
  }));
  expectAlive(1);
}

TEST_F(BadInputTest, DepthWithoutAnyValueGivesFramesWithoutSensorDepth) {
  camera_.hole = 1.0F;
  for (const char* encoding : {"16UC1", "32FC1"}) {
    camera_.depth_encoding = encoding;
    camera_.first_stamp = freshStamp();
    for (int frame = 0; frame < 3; ++frame) {
      const auto sources = provenance(live_camera_.send(camera_, frame));
      ASSERT_FALSE(sources.empty());
      EXPECT_EQ(pixels(sources, 1) + pixels(sources, 3), 0);
    }
  }
  camera_.hole = 0.0F;
  expectAlive(3);
}

TEST_F(BadInputTest, FramesWithoutTextureGiveSensorDepth) {
  camera_.contrast = 0.0;
  for (int frame = 0; frame < 5; ++frame) {
    const auto sources = provenance(live_camera_.send(camera_, frame));
    ASSERT_FALSE(sources.empty());
    EXPECT_GT(pixels(sources, 1) + pixels(sources, 3), 320 * 240 / 2);
  }
  camera_.contrast = 1.0;
  expectAlive(5);
}

TEST_F(BadInputTest, AFirstFrameWithoutDepthWaitsForOneThatHasIt) {
  live_camera_.sendInfo(camera_.info(0));
  live_camera_.sendColour(camera_.colour(0));
  const Stamp second = live_camera_.send(camera_, 1);
  ASSERT_TRUE(frame_.at(second));
  EXPECT_TRUE(frame_.at(camera_.stamp(0))->depth_stamp.isZero());
  EXPECT_EQ(frame_.at(camera_.stamp(0))->state, TrackedFrame::INITIALISING);
  EXPECT_EQ(frame_.at(second)->state, TrackedFrame::TRACKING);
  EXPECT_EQ(pixels(provenance(camera_.stamp(0)), 0), 320 * 240);
}

TEST_F(BadInputTest, NanAndInfinityAreNoDepth) {
  camera_.depth_encoding = "32FC1";
  live_camera_.send(camera_, 0);
  sensor_msgs::ImagePtr depth = camera_.depthImage(1);
  auto* values = reinterpret_cast<float*>(depth->data.data());
  const float none[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                        -std::numeric_limits<float>::infinity(), 0.0F, -1.0F};
  for (int i = 0; i < 320 * 100; ++i) values[i] = none[i % 5];
  live_camera_.sendDepth(depth);
  live_camera_.sendColour(camera_.colour(1));
  const auto sources = provenance(camera_.stamp(1));
  ASSERT_FALSE(sources.empty());
  const auto top = sources.rowRange(0, 100);
  EXPECT_EQ(pixels(top, 1) + pixels(top, 3), 0);
  const auto rest = sources.rowRange(100, 240);
  EXPECT_GT(pixels(rest, 1) + pixels(rest, 3), 10000);
  const cv::Mat_<float> mean = viewImage(mean_.at(camera_.stamp(1)));
  for (const float value : mean) ASSERT_TRUE(std::isnan(value) || (value > 0.0F && std::isfinite(value)));
}

TEST_F(BadInputTest, DepthTooFarFromColourInTimeIsNotUsed) {
  live_camera_.send(camera_, 0);
  camera_.skew = 25'000'000;  // the limit is 20 ms
  live_camera_.sendDepth(camera_.depthImage(5));
  live_camera_.sendColour(camera_.colour(5));
  const auto frame = frame_.at(camera_.stamp(5));
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->depth_stamp.isZero());
  const auto sources = provenance(camera_.stamp(5));
  EXPECT_EQ(pixels(sources, 1) + pixels(sources, 3), 0);
}

TEST_F(BadInputTest, WithoutADepthStreamColourIsStillTracked) {
  live_camera_.send(camera_, 0);
  for (int frame = 1; frame < 4; ++frame) live_camera_.sendColour(camera_.colour(frame));
  EXPECT_TRUE(mean_.at(camera_.stamp(3)));
}

TEST_F(BadInputTest, StampsThatGoBackStartAnew) {
  for (int frame = 0; frame < 3; ++frame) ASSERT_TRUE(mean_.at(live_camera_.send(camera_, frame)));
  const std::uint32_t run = frame_.messages.back()->run;
  camera_.first_stamp -= 3'000'000'000;
  for (int frame = 0; frame < 6; ++frame) live_camera_.send(camera_, frame);
  for (int frame = 0; frame < 6; ++frame) ASSERT_TRUE(mean_.at(camera_.stamp(frame)));
  EXPECT_EQ(frame_.messages.back()->run, run + 1);
  EXPECT_EQ(fromRosTime(frame_.messages.back()->keyframe_stamp), camera_.stamp(0));
  EXPECT_EQ(console_.count({"stamps went back"}), 1U);
}

TEST_F(BadInputTest, AResetBeforeStampsGoBackIsNotMadeTwice) {
  for (int frame = 0; frame < 3; ++frame) ASSERT_TRUE(mean_.at(live_camera_.send(camera_, frame)));
  const std::uint32_t run = frame_.messages.back()->run;
  callReset();
  camera_.first_stamp -= 3'000'000'000;
  for (int frame = 0; frame < 8; ++frame) live_camera_.send(camera_, frame);
  for (int frame = 0; frame < 8; ++frame) ASSERT_TRUE(mean_.at(camera_.stamp(frame)));
  EXPECT_EQ(frame_.messages.back()->run, run + 1);
}

TEST_F(BadInputTest, AnotherCalibrationOfDepthIsWarnedOf) {
  live_camera_.send(camera_, 0);
  sensor_msgs::CameraInfo info = camera_.info(0);
  live_camera_.sendDepthInfo(info);
  info.K[0] = info.P[0] = 1.02 * info.K[0];
  live_camera_.sendDepthInfo(info);
  EXPECT_TRUE(console_.waitFor({"/camera/depth_registered/camera_info", "K[0]"}));
  EXPECT_EQ(console_.count({"/camera/depth_registered/camera_info differs from that of colour"}), 1U);
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "bad_input_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
