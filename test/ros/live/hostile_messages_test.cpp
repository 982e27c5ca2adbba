// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Sends messages that no camera sends, and good ones after each. Nothing dies or hangs, and output goes on.
#include <sensor_msgs/image_encodings.h>
#include <tf2_msgs/TFMessage.h>

#include <functional>
#include <iostream>
#include <limits>

#include "live_test.h"
#include "rgbd_sfm_fusion/Keyframe.h"
#include "rgbd_sfm_fusion/TrackedFrame.h"

namespace rgbd_sfm_fusion {
namespace {

namespace encodings = sensor_msgs::image_encodings;

constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

const std::vector<std::uint32_t> kSizes = {0,          1,          2,         15,      32767,   32768,
                                           65535,      65536,      65537,     1 << 20, 1 << 24, 0x7fffffff,
                                           0x80000000, 0x80000001, kMost - 1, kMost};

class HostileMessagesTest : public LiveTest {
 protected:
  void SetUp() override {
    start([this] { return mean_.isConnected() && tf_.getNumSubscribers() > 0; });
    expectAlive("the start");
  }

  void TearDown() override {
    std::cout << "longest time until a good image was fused: " << longest_ << " s\n";
  }

  /// Good images are fused, whatever came before them.
  void expectAlive(const std::string& after) {
    if (HasFatalFailure()) return;  // once is enough
    const ros::WallTime begin = ros::WallTime::now();
    const bool is_alive = spinUntil([&] {
      const Stamp stamp = live_camera_.send(camera_, frame_++);
      const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(0.1);
      while (ros::WallTime::now() < end) {
        ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.005));
        if (!mean_.messages.empty() && mean_.messages.back()->header.stamp == toRosTime(stamp)) return true;
      }
      return false;
    });
    mean_.messages.clear();
    longest_ = std::max(longest_, (ros::WallTime::now() - begin).toSec());
    ASSERT_TRUE(is_alive) << "after " << after;
  }

  void sendBoth(const sensor_msgs::Image& image, const std::string& what) {
    live_camera_.sendInfo(camera_.info(frame_));
    live_camera_.sendDepth(camera_.depthImage(frame_));
    live_camera_.sendColour(boost::make_shared<sensor_msgs::Image>(image));
    ++frame_;
    sensor_msgs::Image depth = image;
    depth.header.stamp = camera_.colour(frame_)->header.stamp;
    live_camera_.sendDepth(boost::make_shared<sensor_msgs::Image>(depth));
    live_camera_.sendColour(camera_.colour(frame_++));
    expectAlive(what);
  }

  sensor_msgs::Image good() const { return *camera_.colour(frame_); }

  ros::NodeHandle handle_;
  Inbox<sensor_msgs::Image> mean_{"/fusion/mean"};
  ros::Publisher tf_ = handle_.advertise<tf2_msgs::TFMessage>("/tf", 10);
  ros::Publisher tf_static_ = handle_.advertise<tf2_msgs::TFMessage>("/tf_static", 10);
  ros::Publisher frames_ = handle_.advertise<TrackedFrame>("/tracker/frame", 10);
  ros::Publisher keyframes_ = handle_.advertise<Keyframe>("/tracker/keyframe", 10);
  int frame_ = 0;
  double longest_ = 0.0;
};

TEST_F(HostileMessagesTest, SizesAndStepsOfImages) {
  for (const std::uint32_t size : kSizes) {
    sensor_msgs::Image image = good();
    image.width = size;
    sendBoth(image, "width " + std::to_string(size));
    image = good();
    image.height = size;
    sendBoth(image, "height " + std::to_string(size));
    image.width = size;
    sendBoth(image, "width and height " + std::to_string(size));
    image = good();
    image.step = size;
    sendBoth(image, "step " + std::to_string(size));
  }
  sensor_msgs::Image image = good();
  image.encoding = "mono8";
  image.width = 16, image.height = 65537, image.step = 65536;
  image.data.resize(65536);  // the product of height and step in 32 bits
  sendBoth(image, "16x65537 with step 65536");
}

TEST_F(HostileMessagesTest, DataOfImages) {
  for (const std::size_t size : {0U, 1U, 100U, 320U * 240U * 3U - 1U, 320U * 240U * 3U + 1U, 5'000'000U}) {
    sensor_msgs::Image image = good();
    image.data.resize(size);
    sendBoth(image, std::to_string(size) + " bytes");
  }
}

TEST_F(HostileMessagesTest, EncodingsOfImages) {
  std::vector<std::string> names = {
      encodings::RGB8,         encodings::RGBA8,        encodings::RGB16,        encodings::RGBA16,
      encodings::BGR8,         encodings::BGRA8,        encodings::BGR16,        encodings::BGRA16,
      encodings::MONO8,        encodings::MONO16,       encodings::BAYER_RGGB8,  encodings::BAYER_BGGR8,
      encodings::BAYER_GBRG8,  encodings::BAYER_GRBG8,  encodings::BAYER_RGGB16, encodings::BAYER_BGGR16,
      encodings::BAYER_GBRG16, encodings::BAYER_GRBG16, encodings::YUV422};
  for (const char* bits : {"8U", "8S", "16U", "16S", "32S", "32F", "64F"}) {
    for (int channels = 0; channels <= 5; ++channels)
      names.push_back(bits + ("C" + std::to_string(channels)));
  }
  for (const char* invented : {"", " ", "8UC", "8UC999999999999", "32FC-1", "bayer_", "mono", "jpeg",
                               "rgb8; png", "%s%n", "\xff\xfe"}) {
    names.emplace_back(invented);
  }
  names.emplace_back(1'000'000, 'x');
  for (const std::string& name : names) {
    sensor_msgs::Image image = good();
    image.encoding = name;
    sendBoth(image, "encoding " + name.substr(0, 40));
    image.is_bigendian = 1;
    sendBoth(image, "encoding " + name.substr(0, 40) + " in big endian");
  }
}

TEST_F(HostileMessagesTest, SizesInCameraInfo) {
  const auto send = [this](std::uint32_t width, std::uint32_t height, double distortion) {
    sensor_msgs::CameraInfo info = camera_.info(frame_);
    info.width = width, info.height = height;
    info.D[0] = distortion;
    live_camera_.sendInfo(info);
    live_camera_.sendDepthInfo(info);
    expectAlive("camera_info of " + std::to_string(width) + "x" + std::to_string(height));
  };
  for (const std::uint32_t size : kSizes) {
    send(size, 240, 0.0);
    send(320, size, 0.1);
    send(size, size, 0.1);
  }
  send(30000, 30000, 0.1);
  send(8192, 2048, 0.1);
  send(2048, 8192, -0.1);
  send(16, 65537, 0.1);
  send(0x7fffffff, 1, 0.1);
  sensor_msgs::CameraInfo info = camera_.info(frame_);
  for (const std::uint32_t size : kSizes) {
    for (std::uint32_t* field : {&info.binning_x, &info.binning_y, &info.roi.x_offset, &info.roi.y_offset,
                                 &info.roi.width, &info.roi.height}) {
      const std::uint32_t before = *field;
      *field = size;
      live_camera_.sendInfo(info);
      live_camera_.sendDepthInfo(info);
      *field = before;
      expectAlive("binning or roi of " + std::to_string(size));
    }
  }
}

TEST_F(HostileMessagesTest, NumbersInCameraInfo) {
  using Info = sensor_msgs::CameraInfo;
  const std::vector<std::function<double*(Info&)>> fields = {
      [](Info& i) { return &i.K[0]; }, [](Info& i) { return &i.K[1]; }, [](Info& i) { return &i.K[2]; },
      [](Info& i) { return &i.K[4]; }, [](Info& i) { return &i.K[8]; }, [](Info& i) { return &i.D[0]; },
      [](Info& i) { return &i.D[4]; }, [](Info& i) { return &i.P[0]; }, [](Info& i) { return &i.P[3]; },
      [](Info& i) { return &i.P[6]; }, [](Info& i) { return &i.R[0]; }, [](Info& i) { return &i.R[5]; }};
  for (const auto& field : fields) {
    for (const double value : {0.0, -1.0, -500.0, kNaN, kInf, -kInf, 1e300, -1e300, 1e-300, 1e9}) {
      Info info = camera_.info(frame_);
      *field(info) = value;
      live_camera_.sendInfo(info);
      live_camera_.sendDepthInfo(info);
      expectAlive("a number in camera_info of " + std::to_string(value));
    }
  }
  for (const std::size_t count : {0U, 1U, 3U, 4U, 6U, 8U, 13U, 100000U}) {
    for (const char* model : {"", "plumb_bob", "rational_polynomial", "equidistant", "no such model"}) {
      Info info = camera_.info(frame_);
      info.distortion_model = model;
      info.D.assign(count, 0.01);
      live_camera_.sendInfo(info);
      live_camera_.sendDepthInfo(info);
      expectAlive(std::to_string(count) + " coefficients of " + model);
    }
  }
}

TEST_F(HostileMessagesTest, StampsOfImages) {
  const std::uint32_t now = camera_.colour(0)->header.stamp.sec, year = 365 * 86400;
  for (const std::uint32_t seconds :
       {0U, 1U, now - 1, now - 1000, now + 1, now + 1000, now + year, 0x7fffffffU, 0x80000000U, kMost - 86401,
        kMost - 10, kMost - 1, kMost}) {
    for (const std::uint32_t nanoseconds : {0U, 999'999'999U, 1'000'000'000U, kMost}) {
      const std::string what = "stamp " + std::to_string(seconds) + "." + std::to_string(nanoseconds);
      sensor_msgs::Image image = good();
      image.header.stamp.sec = seconds;
      image.header.stamp.nsec = nanoseconds;
      const auto message = boost::make_shared<sensor_msgs::Image>(image);
      sensor_msgs::Image depth = *camera_.depthImage(frame_);
      depth.header.stamp = image.header.stamp;
      sensor_msgs::CameraInfo info = camera_.info(frame_);
      info.header.stamp = image.header.stamp;
      live_camera_.sendInfo(info);
      live_camera_.sendDepth(boost::make_shared<sensor_msgs::Image>(depth));
      live_camera_.sendColour(message);
      live_camera_.sendColour(message);
      expectAlive(what);
    }
  }
}

TEST_F(HostileMessagesTest, TransformsOfOthers) {
  for (const std::uint32_t seconds : {0U, 1U, 0x7fffffffU, 0x80000000U, kMost - 10, kMost - 1, kMost}) {
    for (const double value : {0.0, 1.0, kNaN, kInf, 1e300}) {
      for (const std::string frame : {"robot_arm", "", "/", "/a//b", "camera_depth_frame"}) {
        geometry_msgs::TransformStamped transform;
        transform.header.stamp.sec = seconds;
        transform.header.stamp.nsec = seconds;
        transform.header.frame_id = "robot";
        transform.child_frame_id = frame;
        transform.transform.translation.x = value;
        transform.transform.rotation.w = value;
        tf2_msgs::TFMessage message;
        message.transforms = {transform, transform};
        tf_.publish(message);
        tf_static_.publish(message);
      }
      expectAlive("a transform of " + std::to_string(seconds) + " s and " + std::to_string(value));
    }
  }
  tf2_msgs::TFMessage loop;
  loop.transforms.resize(2);
  loop.transforms[0].header.frame_id = loop.transforms[1].child_frame_id = "a";
  loop.transforms[1].header.frame_id = loop.transforms[0].child_frame_id = "b";
  loop.transforms[0].transform.rotation.w = loop.transforms[1].transform.rotation.w = 1.0;
  tf_.publish(loop);
  expectAlive("a loop of transforms");
}

/// Messages of another tracker, on our tracker's topics.
TEST_F(HostileMessagesTest, FramesAndKeyframes) {
  const auto sendFrame = [this](const std::function<void(TrackedFrame&)>& spoil, const std::string& what) {
    TrackedFrame frame;
    frame.header.stamp = camera_.colour(frame_)->header.stamp;
    frame.state = TrackedFrame::TRACKING;
    frame.T_frame_keyframe.rotation.w = frame.T_first_frame.rotation.w = 1.0;
    spoil(frame);
    frames_.publish(frame);
    expectAlive(what);
  };
  sendFrame([](TrackedFrame& f) { f.state = 200; }, "an unknown state");
  sendFrame([](TrackedFrame& f) { f.T_frame_keyframe.rotation.w = kNaN; }, "a pose of NaN");
  sendFrame([](TrackedFrame& f) { f.T_frame_keyframe.translation.x = 1e300; }, "a pose far away");
  sendFrame([](TrackedFrame& f) { f.covariance[3] = kInf; }, "an infinite covariance");
  sendFrame([](TrackedFrame& f) { f.header.stamp.sec = f.depth_stamp.sec = f.keyframe_stamp.sec = kMost; },
            "the last stamps");
  sendFrame([](TrackedFrame& f) { f.header.stamp.nsec = f.depth_stamp.nsec = kMost; },
            "nanoseconds of seconds");

  const auto sendKeyframe = [this](const std::function<void(Keyframe&)>& spoil, const std::string& what) {
    Keyframe keyframe;
    keyframe.header.stamp = camera_.colour(frame_)->header.stamp;
    keyframe.K[0] = keyframe.K[4] = 300.0;
    keyframe.T_odom_keyframe.rotation.w = 1.0;
    keyframe.depth = keyframe.variance = *toImage(keyframe.header, "32FC1", cv::Mat_<float>(240, 320, 1.0F));
    TrackedFrame frame;
    frame.header = keyframe.header;
    frame.state = TrackedFrame::TRACKING;
    frame.keyframe_stamp = keyframe.header.stamp;
    frame.T_frame_keyframe.rotation.w = frame.T_first_frame.rotation.w = 1.0;
    spoil(keyframe);
    keyframes_.publish(keyframe);
    frames_.publish(frame);
    expectAlive(what);
  };
  for (const std::uint32_t size : kSizes) {
    sendKeyframe([&](Keyframe& k) { k.depth.width = k.variance.width = size; }, "keyframe's width");
    sendKeyframe([&](Keyframe& k) { k.depth.height = size; }, "keyframe's height");
    sendKeyframe([&](Keyframe& k) { k.depth.step = k.variance.step = size; }, "keyframe's step");
  }
  sendKeyframe([](Keyframe& k) { k.variance.encoding = "8UC0"; }, "keyframe's encoding");
  sendKeyframe([](Keyframe& k) { k.variance.data.resize(100); }, "keyframe's data");
  sendKeyframe([](Keyframe& k) { k.K[0] = 1e300; }, "keyframe's K");
  for (const double value : {0.0, -1.0, kNaN, kInf, 1e30}) {
    sendKeyframe(
        [&](Keyframe& k) {
          k.depth = k.variance =
              *toImage(k.header, "32FC1", cv::Mat_<float>(240, 320, static_cast<float>(value)));
        },
        "keyframe's depth");
  }
  sendKeyframe(
      [](Keyframe& k) {
        k.depth = k.variance = *toImage(k.header, "32FC1", cv::Mat_<float>(480, 640, 1.0F));
      },
      "keyframe of another size");
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "hostile_messages_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
