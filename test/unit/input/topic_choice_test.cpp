// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/topic_choice.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <vector>

namespace rgbd_sfm_fusion {
namespace {

ImageTopic topic(const std::string& name, const std::string& encoding, int width = 640,
                 const std::string& frame = "optical") {
  ImageTopic topic{name, encoding, width, width * 3 / 4, frame, false};
  topic.is_compressed = withoutTransport(name) != name;
  return topic;
}

struct Choice {
  std::string colour, depth;
};

Choice choose(const std::vector<ImageTopic>& topics) {
  const std::string colour = chooseColourTopic(topics);
  return {colour, chooseDepthTopic(topics, colour)};
}

std::string refusalOf(const std::vector<ImageTopic>& topics) {
  try {
    choose(topics);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(TopicChoice, TakesWhatRecordingsHave) {
  const struct {
    std::vector<ImageTopic> topics;
    std::string colour, depth;
  } cases[] = {
      // openni and astra drivers, with more than is needed
      {{topic("/camera/rgb/image_raw", "rgb8"), topic("/camera/depth/image_raw", "16UC1", 640, "depth"),
        topic("/camera/depth_registered/image_raw", "16UC1"), topic("/camera/ir/image_raw", "mono16")},
       "/camera/rgb/image_raw",
       "/camera/depth_registered/image_raw"},
      // TUM's bags
      {{topic("/camera/rgb/image_color", "rgb8"), topic("/camera/depth/image", "32FC1")},
       "/camera/rgb/image_color",
       "/camera/depth/image"},
      // all transports of one camera
      {{topic("/rgb/image_raw", "rgb8"), topic("/rgb/image_raw/compressed", "bgr8"),
        topic("/depth/image_raw", "16UC1"), topic("/depth/image_raw/compressed", "mono16"),
        topic("/depth/image_raw/compressedDepth", "16UC1")},
       "/rgb/image_raw",
       "/depth/image_raw"},
      {{topic("/rgb/image_raw/compressed", "bgr8"), topic("/depth/image_raw/compressed", "mono16"),
        topic("/depth/image_raw/compressedDepth", "16UC1")},
       "/rgb/image_raw/compressed",
       "/depth/image_raw/compressedDepth"},
      // RealSense: infrared beside colour, depth aligned or not
      {{topic("/camera/color/image_raw", "rgb8"), topic("/camera/infra1/image_rect_raw", "mono8"),
        topic("/camera/depth/image_rect_raw", "16UC1", 848, "depth"),
        topic("/camera/aligned_depth_to_color/image_raw", "16UC1")},
       "/camera/color/image_raw",
       "/camera/aligned_depth_to_color/image_raw"},
      // RealSense's SDK
      {{topic("/device_0/sensor_1/Color_0/image/data", "rgb8"),
        topic("/device_0/sensor_0/Depth_0/image/data", "mono16")},
       "/device_0/sensor_1/Color_0/image/data",
       "/device_0/sensor_0/Depth_0/image/data"},
      // before and after the colours were made, and what is rectified already
      {{topic("/camera/rgb/image_raw", "bayer_grbg8"), topic("/camera/rgb/image_color", "rgb8"),
        topic("/camera/rgb/image_mono", "mono8"), topic("/camera/rgb/image_rect_color", "rgb8"),
        topic("/camera/depth/image_raw", "16UC1")},
       "/camera/rgb/image_color",
       "/camera/depth/image_raw"},
      // by size, and by frame
      {{topic("/rgb", "rgb8"), topic("/a/depth", "16UC1", 320), topic("/b/depth", "16UC1", 640)},
       "/rgb",
       "/b/depth"},
      {{topic("/rgb", "rgb8"), topic("/a/depth", "16UC1", 320), topic("/b/depth", "16UC1", 640, "other")},
       "/rgb",
       "/a/depth"},
      // results of this package in the same recording
      {{topic("/camera/rgb/image_raw", "rgb8"), topic("/camera/depth_registered/image_raw", "16UC1"),
        topic("/fusion/mean", "32FC1"), topic("/fusion/provenance_color", "rgb8"),
        topic("/tracker/keyframe/depth", "32FC1")},
       "/camera/rgb/image_raw",
       "/camera/depth_registered/image_raw"},
      // images that cannot be read are said to be so later
      {{topic("/rgb/image_raw", ""), topic("/depth/image_raw", "")}, "/rgb/image_raw", "/depth/image_raw"},
      // a grey camera
      {{topic("/cam/image_raw", "mono8"), topic("/cam/depth", "16UC1")}, "/cam/image_raw", "/cam/depth"},
  };
  for (const auto& each : cases) {
    SCOPED_TRACE(each.colour);
    EXPECT_EQ(refusalOf(each.topics), "");
    const Choice choice = choose(each.topics);
    EXPECT_EQ(choice.colour, each.colour);
    EXPECT_EQ(choice.depth, each.depth);
  }
}

TEST(TopicChoice, InDoubtTheCandidatesAreListed) {
  const std::string two_cameras =
      refusalOf({topic("/left/rgb/image_raw", "rgb8"), topic("/right/rgb/image_raw", "rgb8"),
                 topic("/depth/image_raw", "16UC1")});
  EXPECT_NE(two_cameras.find("2 topics have colour images: name one by --rgb"), std::string::npos);
  EXPECT_NE(two_cameras.find("/left/rgb/image_raw: rgb8 of 640x480 px in optical"), std::string::npos);
  EXPECT_EQ(two_cameras.find("/depth"), std::string::npos);
  const std::string two_depths =
      refusalOf({topic("/rgb", "rgb8"), topic("/a/depth", "16UC1"), topic("/b/depth", "16UC1")});
  EXPECT_NE(two_depths.find("2 topics have depth images: name one by --depth"), std::string::npos);
  const std::string no_depth = refusalOf({topic("/rgb", "rgb8")});
  EXPECT_NE(no_depth.find("no topic has depth images; those with images are"), std::string::npos);
}

TEST(TopicChoice, CameraInfoIsBesideItsImages) {
  EXPECT_EQ(cameraInfoTopics("/camera/rgb/image_raw/compressed").front(), "/camera/rgb/camera_info");
  EXPECT_EQ(cameraInfoTopics("/camera/depth/image").front(), "/camera/depth/camera_info");
  EXPECT_EQ(cameraInfoTopics("/image_raw").front(), "/camera_info");
  EXPECT_EQ(cameraInfoTopics("/device_0/sensor_1/Color_0/image/data").back(),
            "/device_0/sensor_1/Color_0/info/camera_info");
}

TEST(TopicChoice, RectifiedImagesAreToldByTheirName) {
  for (const char* topic :
       {"/rgb/image_rect", "/rgb/image_rect_color", "/depth/image_rect_raw", "/a/image_color_rect",
        "/rgb/image_rect_color/compressed", "/depth/image_rect/compressedDepth"})
    EXPECT_TRUE(isRectifiedByName(topic)) << topic;
  for (const char* topic : {"/rgb/image_raw", "/rect/image_raw", "/my_rect/image", "/rgb/image_direct",
                            "/a/correct", "/rgb/image_raw/compressed", "image", ""})
    EXPECT_FALSE(isRectifiedByName(topic)) << topic;
}

}  // namespace
}  // namespace rgbd_sfm_fusion
