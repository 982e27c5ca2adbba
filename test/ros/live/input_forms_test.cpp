// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Images as other drivers send them: compressed, without camera_info of colour, depth of another size.
#include <sensor_msgs/CompressedImage.h>

#include <opencv2/imgcodecs.hpp>

#include "live_test.h"
#include "rgbd_sfm_fusion/TrackedFrame.h"

namespace rgbd_sfm_fusion {
namespace {

sensor_msgs::CompressedImage compress(const sensor_msgs::ImageConstPtr& image, const std::string& format,
                                      std::size_t header) {
  sensor_msgs::CompressedImage compressed;
  compressed.header = image->header;
  compressed.format = format;
  std::vector<std::uint8_t> png;
  cv::imencode(".png", viewImage(image), png);
  compressed.data.assign(header, 0);
  compressed.data.insert(compressed.data.end(), png.begin(), png.end());
  return compressed;
}

class InputFormsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    camera_.first_stamp = freshStamp();
    ASSERT_TRUE(spinUntil([this] {
      return std::min({colour_.getNumSubscribers(), depth_.getNumSubscribers(),
                       depth_info_.getNumSubscribers()}) > 0 &&
             mean_.isConnected() && frame_.isConnected() && console_.isConnected();
    }));
    // The tracker asks for depth's camera_info as soon as it is listened to; nobody sees when it has.
    ASSERT_TRUE(spinUntil([this] {
      const auto tracked = frame_.at(send(next_++));
      return tracked && tracked->state == TrackedFrame::TRACKING;
    }));
    callReset();
  }

  /// The depth image is the lower 200 rows.
  Stamp send(int frame) {
    const sensor_msgs::ImagePtr depth = camera_.depthImage(frame);
    depth->height -= 40;
    depth->data.erase(depth->data.begin(), depth->data.begin() + 40 * depth->step);
    sensor_msgs::CameraInfo info = camera_.info(frame);
    info.height -= 40;
    info.K[5] -= 40.0;
    depth_info_.publish(info);
    depth_.publish(compress(depth, "16UC1; compressedDepth", 12));
    colour_.publish(compress(camera_.colour(frame), "rgb8; png compressed ", 0));
    return camera_.stamp(frame);
  }

  ros::NodeHandle handle_;
  ros::Publisher colour_ = handle_.advertise<sensor_msgs::CompressedImage>("/robot/colour/compressed", 100);
  ros::Publisher depth_ =
      handle_.advertise<sensor_msgs::CompressedImage>("/robot/depth/image/compressedDepth", 100);
  ros::Publisher depth_info_ = handle_.advertise<sensor_msgs::CameraInfo>("/robot/depth/camera_info", 100);
  FakeCamera camera_;
  int next_ = 0;  ///< frame
  Console console_;
  Inbox<sensor_msgs::Image> mean_{"/fusion/mean"};
  Inbox<TrackedFrame> frame_{"/tracker/frame"};
};

TEST_F(InputFormsTest, AreTrackedAndFused) {
  for (const int end = next_ + 3; next_ < end;) {
    const int frame = next_++;
    const Stamp stamp = send(frame);
    const auto tracked = frame_.at(stamp);
    ASSERT_TRUE(tracked);
    EXPECT_EQ(tracked->state, TrackedFrame::TRACKING) << frame;
    const auto mean = mean_.at(stamp);
    ASSERT_TRUE(mean);
    const cv::Mat_<float> depth = viewImage(mean);
    ASSERT_EQ(depth.size(), cv::Size(320, 240));
    EXPECT_NEAR(depth(140, 160), camera_.depth(frame, 160), 0.02F);
  }
}

TEST_F(InputFormsTest, ABrokenImageIsNamedAndTheNextIsTaken) {
  ASSERT_TRUE(mean_.at(send(next_++)));
  sensor_msgs::CompressedImage broken = compress(camera_.colour(next_++), "rgb8; png compressed ", 0);
  broken.data.resize(broken.data.size() / 2);
  colour_.publish(broken);
  EXPECT_TRUE(console_.waitFor({"/robot/colour/compressed", "PNG of 320x240", "cut off"}));
  EXPECT_TRUE(mean_.at(send(next_++)));
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "input_forms_test");
  ros::NodeHandle handle;
  return RUN_ALL_TESTS();
}
