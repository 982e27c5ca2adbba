// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Images as other drivers send them: in any encoding, compressed, without camera_info of colour, depth of
/// another size, at other rates.
#include <cstring>

#include "input_forms.h"
#include "live_test.h"
#include "rgbd_sfm_fusion/TrackedFrame.h"

namespace rgbd_sfm_fusion {
namespace {

/// Listens from the start.
Console* whole_console = nullptr;

/// The outputs below a namespace.
struct Outputs {
  explicit Outputs(const std::string& ns) : mean(ns + "/fusion/mean"), frame(ns + "/tracker/frame") {}

  bool areConnected() const { return mean.isConnected() && frame.isConnected() && console.isConnected(); }

  bool isTracking(Stamp stamp) {
    const auto tracked = frame.at(stamp);
    return tracked && tracked->state == TrackedFrame::TRACKING;
  }

  /// Expects fused depth to be the wall's.
  void expectFused(const FakeCamera& camera, int index) {
    SCOPED_TRACE(index);
    EXPECT_TRUE(isTracking(camera.stamp(index)));
    const auto fused = mean.at(camera.stamp(index));
    ASSERT_TRUE(fused);
    const cv::Mat_<float> depth = viewImage(fused);
    ASSERT_EQ(depth.size(), cv::Size(320, 240));
    EXPECT_NEAR(depth(140, 160), camera.depth(index, 160), 0.02F);
  }

  Inbox<sensor_msgs::Image> mean;
  Inbox<TrackedFrame> frame;
  Console console;
};

// Runs first: nothing comes yet.
TEST(ACalibrationFromAFile, IsNotSaidToBeMissing) {
  const auto isSaid = [](const std::string& topic) {
    return whole_console->count({"no data for 5 seconds", topic}) > 0;
  };
  // What is missing is said five seconds after the start.
  ASSERT_TRUE(spinUntil([&] { return isSaid("/robot/colour"); }));
  spinUntil([] { return false; }, 0.5);
  EXPECT_TRUE(isSaid("/recorder/colour/camera_info"));
  EXPECT_FALSE(isSaid("/robot/camera_info"));
}

/// Raw images.
class InputFormsTest : public LiveTest {
 protected:
  void SetUp() override {
    start([this] { return outputs_.areConnected(); });
  }

  Stamp send(const SentFrame& frame) {
    live_camera_.sendInfo(frame.info);
    if (frame.depth_info) live_camera_.sendDepthInfo(*frame.depth_info);
    if (frame.depth) live_camera_.sendDepth(frame.depth);
    live_camera_.sendColour(frame.colour);
    return fromRosTime(frame.colour->header.stamp);
  }

  /// Sends some frames one by one, each after the one before was fused. @return fused depth of the last
  std::vector<std::uint8_t> fusedLast(const InputForm& form) {
    camera_.first_stamp = freshStamp();
    // If depth has another size, its camera_info may come after the first image.
    for (int index = 0; index < 100; ++index) {
      SentFrame frame = sentFrame(camera_, index);
      form.change(frame);
      if (outputs_.isTracking(send(frame))) break;
    }
    callReset();
    camera_.first_stamp = freshStamp();
    for (int index = 0; index < kCount; ++index) {
      SentFrame frame = sentFrame(camera_, index);
      form.change(frame);
      send(frame);
      outputs_.expectFused(camera_, index);
    }
    const auto last = outputs_.mean.at(camera_.stamp(kCount - 1));
    if (!last) return {};
    EXPECT_EQ(last->header.frame_id, FakeCamera().frame_id);
    return last->data;
  }

  static constexpr int kCount = 5;
  Outputs outputs_{""};
};

TEST_F(InputFormsTest, EveryFormIsTaken) {
  const auto plain = fusedLast({"plain", [](SentFrame&) {}, true});
  for (const InputForm& form : inputForms()) {
    SCOPED_TRACE(form.name);
    const auto fused = fusedLast(form);
    if (form.has_same_bits) {
      EXPECT_TRUE(fused == plain);
    }
  }
}

TEST_F(InputFormsTest, RatesFrom5To60HzAreTaken) {
  for (const double rate : {5.0, 10.0, 60.0}) {
    SCOPED_TRACE(rate);
    callReset();
    const Stamp first = freshStamp();
    for (int index = 0; index < kCount; ++index) {
      SentFrame frame = sentFrame(camera_, index);
      frame.colour->header.stamp = frame.depth->header.stamp = toRosTime(first + fromSeconds(index / rate));
      EXPECT_TRUE(outputs_.isTracking(send(frame)));
    }
  }
}

TEST_F(InputFormsTest, DepthAtAThirdOfColoursRateIsTaken) {
  std::vector<Stamp> stamps;
  for (int index = 0; index < 10; ++index) {
    SentFrame frame = sentFrame(camera_, index);
    if (index % 3 != 0) frame.depth.reset();
    stamps.push_back(send(frame));
  }
  for (std::size_t index = 0; index < stamps.size(); ++index) {
    const auto tracked = outputs_.frame.at(stamps[index]);
    ASSERT_TRUE(tracked);
    EXPECT_EQ(tracked->state, TrackedFrame::TRACKING);
    EXPECT_EQ(tracked->depth_stamp.isZero(), index % 3 != 0) << index;
    EXPECT_TRUE(outputs_.mean.at(stamps[index]));
  }
}

TEST_F(InputFormsTest, ALateImageIsLeftOut) {
  for (int index = 0; index < 3; ++index) send(sentFrame(camera_, index));
  ASSERT_TRUE(outputs_.mean.at(camera_.stamp(2)));
  const std::uint32_t run = outputs_.frame.messages.back()->run;
  SentFrame late = sentFrame(camera_, 3);
  late.colour->header.stamp = toRosTime(camera_.stamp(1) + 10'000'000);
  const Stamp late_stamp = send(late);
  for (int index = 4; index < 7; ++index) send(sentFrame(camera_, index));
  ASSERT_TRUE(outputs_.mean.at(camera_.stamp(6)));
  EXPECT_EQ(outputs_.frame.messages.back()->run, run);
  for (const auto& tracked : outputs_.frame.messages)
    EXPECT_NE(tracked->header.stamp, toRosTime(late_stamp)) << "left out";
}

/// Compressed images, a calibration from a file, and depth that has only the lower 200 rows.
class CompressedFormsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    camera_.first_stamp = freshStamp();
    ASSERT_TRUE(spinUntil([this] {
      return std::min({colour_.getNumSubscribers(), depth_.getNumSubscribers(),
                       depth_info_.getNumSubscribers()}) > 0 &&
             outputs_.areConnected();
    }));
    // The tracker asks for depth's camera_info once somebody listens to it; when it has it, nobody can see.
    ASSERT_TRUE(spinUntil([this] { return outputs_.isTracking(send(next_++)); }));
    callReset("/robot");
  }

  Stamp send(int index) {
    const sensor_msgs::ImagePtr depth = camera_.depthImage(index);
    depth->height -= 40;
    depth->data.erase(depth->data.begin(), depth->data.begin() + 40 * depth->step);
    sensor_msgs::CameraInfo info = camera_.info(index);
    info.height -= 40;
    info.K[5] -= 40.0;
    depth_info_.publish(info);
    depth_.publish(is_inverse_ ? compressAsInverse(depth) : compress(depth, "16UC1; compressedDepth", 12));
    colour_.publish(compress(camera_.colour(index), "rgb8; png compressed ", 0));
    return camera_.stamp(index);
  }

  ros::NodeHandle handle_;
  ros::Publisher colour_ = handle_.advertise<sensor_msgs::CompressedImage>("/robot/colour/compressed", 100);
  ros::Publisher depth_ =
      handle_.advertise<sensor_msgs::CompressedImage>("/robot/depth/image/compressedDepth", 100);
  ros::Publisher depth_info_ = handle_.advertise<sensor_msgs::CameraInfo>("/robot/depth/camera_info", 100);
  FakeCamera camera_;
  bool is_inverse_ = false;  ///< compressedDepth of 32FC1
  int next_ = 0;             ///< frame
  Outputs outputs_{"/robot"};
};

TEST_F(CompressedFormsTest, AreTrackedAndFused) {
  for (const bool is_inverse : {false, true}) {
    is_inverse_ = is_inverse;
    for (const int end = next_ + 3; next_ < end; ++next_) {
      send(next_);
      outputs_.expectFused(camera_, next_);
    }
  }
}

TEST_F(CompressedFormsTest, ABrokenImageIsNamedAndTheNextIsTaken) {
  ASSERT_TRUE(outputs_.mean.at(send(next_++)));
  sensor_msgs::CompressedImage broken = compress(camera_.colour(next_++), "rgb8; png compressed ", 0);
  broken.data.resize(broken.data.size() / 2);
  colour_.publish(broken);
  EXPECT_TRUE(outputs_.console.waitFor({"/robot/colour/compressed", "PNG of 320x240", "cut off"}));
  EXPECT_TRUE(outputs_.mean.at(send(next_++)));
}

TEST(OneCameraInfo, IsEnoughForRectifiedJpegAndDepthAsPng) {
  ros::NodeHandle handle;
  const FakeCamera camera;
  ros::Publisher info = handle.advertise<sensor_msgs::CameraInfo>("/recorder/colour/camera_info", 1, true);
  ros::Publisher colour =
      handle.advertise<sensor_msgs::CompressedImage>("/recorder/colour/image_rect_color/compressed", 100);
  ros::Publisher depth =
      handle.advertise<sensor_msgs::CompressedImage>("/recorder/depth/image/compressed", 100);
  Outputs outputs("/recorder");
  ASSERT_TRUE(spinUntil([&] {
    return std::min({info.getNumSubscribers(), colour.getNumSubscribers(), depth.getNumSubscribers()}) > 0 &&
           outputs.areConnected();
  }));
  sensor_msgs::CameraInfo raw = camera.info(0);  // as image_proc leaves it beside what it rectifies
  raw.D = {0.26, -0.95, -0.005, 0.003, 1.16};
  raw.K[0] *= 0.95;
  info.publish(raw);
  for (int index = 0; index < 5; ++index) {
    depth.publish(compress(camera.depthImage(index), "16UC1; png compressed ", 0));
    colour.publish(compress(camera.colour(index), "rgb8; jpeg compressed bgr8", 0, ".jpg"));
    outputs.expectFused(camera, index);
  }
  EXPECT_EQ(outputs.console.count({"/recorder/colour/image_rect_color", "these images are rectified"},
                                  rosgraph_msgs::Log::INFO),
            1U);
  // Nodelets look at their inputs every five seconds.
  const auto hasEnded = [&] {
    return outputs.console.count({"/recorder", "input has ended"}, rosgraph_msgs::Log::INFO) >= 2;
  };
  EXPECT_TRUE(spinUntil(hasEnded)) << "images have";
  EXPECT_EQ(
      outputs.console.count({"input has ended", "/recorder/colour/camera_info"}, rosgraph_msgs::Log::INFO),
      0U);
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "input_forms_test");
  ros::NodeHandle handle;
  rgbd_sfm_fusion::Console console;
  rgbd_sfm_fusion::whole_console = &console;
  return RUN_ALL_TESTS();
}
