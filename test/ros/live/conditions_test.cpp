// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// If there is no output, or a part of it is missing, the log and diagnostics say so.
#include <diagnostic_msgs/DiagnosticArray.h>

#include "live_test.h"

namespace rgbd_sfm_fusion {
namespace {

class ConditionsTest : public LiveTest {
 protected:
  void SetUp() override {
    start([this] { return console_.isConnected() && diagnostics_.isConnected(); });
  }

  /// Sends images, about as fast as a camera does, until the log has a line with all of these parts.
  bool isSaid(const std::vector<std::string>& parts, const std::function<void(int frame)>& send) {
    int frame = 0;
    return spinUntil([&] {
      spinUntil([] { return false; }, 0.03);
      send(frame++);
      return console_.count(parts) > 0;
    });
  }

  bool isDiagnosed(const std::string& part) {
    return spinUntil([&] {
      for (const auto& array : diagnostics_.messages) {
        for (const auto& status : array->status) {
          if (status.message.find(part) != std::string::npos) return true;
        }
      }
      return false;
    });
  }

  Console console_;
  Inbox<diagnostic_msgs::DiagnosticArray> diagnostics_{"/diagnostics"};
};

TEST_F(ConditionsTest, DepthThatIsNeverNearColourInTime) {
  camera_.skew = 45'000'000;
  // A slow camera: at 30 Hz the depth of another colour image would be near enough.
  EXPECT_TRUE(isSaid({"/camera/depth_registered/image_raw", "max_skew (20 ms)", "45", "raise it"},
                     [this](int frame) { live_camera_.send(camera_, 4 * frame); }));
  EXPECT_TRUE(isDiagnosed("max_skew"));
}

TEST_F(ConditionsTest, ImagesWithoutStamps) {
  EXPECT_TRUE(isSaid({"/camera/rgb/image_raw", "no time stamp"}, [this](int frame) {
    live_camera_.sendInfo(camera_.info(frame));
    for (const auto& image : {camera_.colour(frame), camera_.depthImage(frame)}) {
      image->header.stamp = ros::Time();
      image->encoding == "rgb8" ? live_camera_.sendColour(image) : live_camera_.sendDepth(image);
    }
  }));
}

TEST_F(ConditionsTest, DepthInAnotherUnit) {
  EXPECT_TRUE(isSaid({"/camera/depth_registered/image_raw", "depth_scale"}, [this](int frame) {
    const sensor_msgs::ImagePtr depth = camera_.depthImage(frame);
    auto* values = reinterpret_cast<std::uint16_t*>(depth->data.data());
    for (std::size_t i = 0; i < depth->data.size() / 2; ++i)
      values[i] = static_cast<std::uint16_t>(5 * values[i]);  // TUM's 1/5000 m
    live_camera_.sendInfo(camera_.info(frame));
    live_camera_.sendDepth(depth);
    live_camera_.sendColour(camera_.colour(frame));
  }));
}

TEST_F(ConditionsTest, DepthThatIsNotRegistered) {
  EXPECT_TRUE(isSaid({"/camera/depth_registered/image_raw", "camera_depth_optical_frame", "not registered"},
                     [this](int frame) {
                       const sensor_msgs::ImagePtr depth = camera_.depthImage(frame);
                       depth->header.frame_id = "camera_depth_optical_frame";
                       live_camera_.sendInfo(camera_.info(frame));
                       live_camera_.sendDepth(depth);
                       live_camera_.sendColour(camera_.colour(frame));
                     }));
  EXPECT_TRUE(isDiagnosed("not registered"));
}

TEST_F(ConditionsTest, NoDepthAtAll) {
  EXPECT_TRUE(isSaid({"/camera/depth_registered/image_raw", "no image came"}, [this](int frame) {
    live_camera_.sendInfo(camera_.info(frame));
    live_camera_.sendColour(camera_.colour(frame));
  }));
}

TEST_F(ConditionsTest, WhatIsAsItShouldBeIsNotSaid) {
  diagnostics_.messages.clear();
  for (int frame = 0; frame < 40; ++frame) {
    live_camera_.send(camera_, frame);
    spinUntil([] { return false; }, 0.1);
  }
  EXPECT_EQ(console_.count({"max_skew"}) + console_.count({"unit"}) + console_.count({"not registered"}) +
                console_.count({"no time stamp"}) + console_.count({"no image came"}),
            0U);
}

}  // namespace
}  // namespace rgbd_sfm_fusion

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "conditions_test");
  ros::NodeHandle keep_alive;
  return RUN_ALL_TESTS();
}
