// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/pipeline/pipeline.h"

#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>
#include <vector>

#include "fake_camera.h"

namespace rgbd_sfm_fusion {
namespace {

class PipelineTest : public ::testing::Test {
 protected:
  RawImage colour(int frame) const { return raw(camera_.colour(frame)); }
  RawImage depth(int frame) const { return raw(camera_.depthImage(frame)); }

  static RawImage raw(const sensor_msgs::ImageConstPtr& image) {
    return {fromRosTime(image->header.stamp), image->encoding, viewImage(image).clone()};
  }

  FakeCamera camera_;
  Pipeline pipeline_{toCalibration(camera_.info(0)), {}, {}};
};

bool isSame(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

TEST_F(PipelineTest, FramesAreFusedWithTheKeyframeTheyName) {
  int keyframes = 0;
  for (int frame = 0; frame < 60; ++frame) {
    const MappedFrame mapped = pipeline_.process(colour(frame), depth(frame)).mapped;
    ASSERT_EQ(mapped.tracked.state, TrackingState::kTracking) << frame;
    ASSERT_TRUE(mapped.keyframe);
    EXPECT_EQ(mapped.keyframe->stamp, mapped.tracked.keyframe_stamp);
    EXPECT_EQ(mapped.keyframe->revision, mapped.tracked.keyframe_revision);
    const bool is_keyframe = mapped.tracked.keyframe_stamp == mapped.tracked.stamp;
    keyframes += is_keyframe ? 1 : 0;
    EXPECT_EQ(is_keyframe, mapped.map == mapped.keyframe) << "others are fused with an earlier map";
  }
  EXPECT_GE(keyframes, 2) << "the camera went 0.6 m past a wall at 2 m";
}

TEST_F(PipelineTest, MappingAheadOfFusionChangesNothing) {
  Pipeline other(toCalibration(camera_.info(0)), {}, {});
  std::vector<MappedFrame> mapped;
  for (int frame = 0; frame < 12; ++frame) mapped.push_back(other.map(colour(frame), depth(frame)));
  for (int frame = 0; frame < 12; ++frame) {
    const PipelineResult one = pipeline_.process(colour(frame), depth(frame));
    const PipelineResult two = other.fuse(std::move(mapped[static_cast<std::size_t>(frame)]));
    EXPECT_TRUE(isSame(one.fused.depth.mean, two.fused.depth.mean)) << frame;
    EXPECT_TRUE(isSame(one.fused.depth.variance, two.fused.depth.variance)) << frame;
    EXPECT_TRUE(isSame(one.fused.provenance, two.fused.provenance)) << frame;
  }
}

TEST_F(PipelineTest, ANewRunStartsAnewAsIfNothingHadBeen) {
  std::vector<cv::Mat> first;
  for (int frame = 0; frame < 6; ++frame) {
    first.push_back(pipeline_.process(colour(frame), depth(frame)).fused.depth.mean.clone());
  }
  for (int frame = 0; frame < 6; ++frame) {
    const PipelineResult result = pipeline_.process(colour(frame), depth(frame), kFirstRun + 1);
    EXPECT_EQ(result.mapped.run, kFirstRun + 1);
    EXPECT_TRUE(isSame(result.fused.depth.mean, first[static_cast<std::size_t>(frame)])) << frame;
  }
}

TEST_F(PipelineTest, WithoutDepthThereIsNoneOfTheSensors) {
  pipeline_.process(colour(0), depth(0));
  const PipelineResult result = pipeline_.process(colour(1), {});
  EXPECT_EQ(result.mapped.frame.depth_stamp, kNoStamp);
  EXPECT_EQ(result.fused.counts.sensor_only + result.fused.counts.fused, 0U);
}

TEST_F(PipelineTest, ErrorsSayWhichImageIsMeant) {
  const auto errorOf = [this](const RawImage& colour, const RawImage& depth) {
    try {
      pipeline_.process(colour, depth);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  RawImage wrong = colour(0);
  wrong.encoding = "yuv422";
  EXPECT_NE(errorOf(wrong, depth(0)).find("colour image: "), std::string::npos);
  wrong = depth(0);
  wrong.pixels = wrong.pixels.rowRange(0, 100);
  EXPECT_NE(errorOf(colour(0), wrong).find("depth image: "), std::string::npos);
}

TEST(FramePreparation, ImagesOutliveTheirMessages) {
  FakeCamera camera;
  camera.colour_encoding = "mono8";
  camera.depth_encoding = "32FC1";
  const Rectifier rectifier(toCalibration(camera.info(0)));
  ASSERT_TRUE(rectifier.isIdentity()) << "else there is a copy anyway";
  const sensor_msgs::ImagePtr colour = camera.colour(0), depth = camera.depthImage(0);
  const RgbdFrame frame =
      prepareFrame(rectifier, {1, "mono8", viewImage(colour)}, {1, "32FC1", viewImage(depth)});
  const GreyImage grey = frame.grey.clone();
  const DepthImage metres = frame.depth.clone();
  std::fill(colour->data.begin(), colour->data.end(), std::uint8_t{0});
  std::fill(depth->data.begin(), depth->data.end(), std::uint8_t{0});
  EXPECT_TRUE(isSame(frame.grey, grey));
  EXPECT_TRUE(isSame(frame.depth, metres));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
