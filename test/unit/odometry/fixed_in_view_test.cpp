// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/fixed_in_view.h"

#include <opencv2/imgproc.hpp>

#include "rgbd_sfm_fusion/image/image_squares.h"
#include "rgbd_sfm_fusion/odometry/frame_tracker.h"
#include "rgbd_sfm_fusion/odometry/keyframe_mapper.h"
#include "visual_odometry_fixture.h"

namespace rgbd_sfm_fusion {
namespace {

/// A robot whose camera sees a part of the robot itself.
class FixedInViewTest : public VisualOdometryTest {
 protected:
  /// @return the frame with the robot's body in it
  RgbdFrame withBody(int index, float depth) const {
    RgbdFrame given = frame(index);
    GreyImage texture(body_.size());
    cv::RNG(7).fill(texture, cv::RNG::UNIFORM, 0, 256);
    cv::blur(texture, texture, {5, 5});
    given.grey = given.grey.clone();
    given.depth = given.depth.clone();
    texture.copyTo(given.grey(body_));
    given.depth(body_).setTo(depth);
    return given;
  }

  /// Tracks and maps a frame. @return the squares that are said to be fixed
  cv::Mat_<std::uint8_t> squaresAfter(const RgbdFrame& given) {
    const FrameTracker::Result result = tracker_.track(given, keyframe_);
    EXPECT_EQ(result.tracked.state, TrackingState::kTracking);
    if (!result.to_map) return {};
    mapper_.mapWithoutStereo(*result.to_map);
    const KeyframeMapper::Result mapped = mapper_.mapByStereo(*result.to_map, true);
    keyframe_ = mapped.to_track;
    map_ = mapped.map;
    T_first_frame_ = result.tracked.T_first_frame;
    const double share = result.to_map->fixed.empty() ? 0.0 : cv::mean(result.to_map->fixed > 0)[0] / 255.0;
    EXPECT_NEAR(result.tracked.share_fixed_in_view, share, 1e-9);
    return result.to_map->fixed;
  }

  double errorOfPose(int index) const {
    return (T_first_frame_.inverse() * T_camera_world(0) * T_camera_world(index).inverse()).log().norm();
  }

  int marked(const cv::Mat_<std::uint8_t>& squares, bool in_body) const {
    int count = 0;
    forEachMarked(squares, frame(0).grey.size(),
                  [&](const cv::Rect& square) { count += ((square & body_) == square) == in_body ? 1 : 0; });
    return count;
  }

  cv::Rect body_{0, 176, 320, 64};  // 80 of 300 squares
  FrameTracker tracker_{scene_.camera(), options_};
  KeyframeMapper mapper_{scene_.camera()};
  std::shared_ptr<const KeyframeToTrack> keyframe_;
  std::shared_ptr<const KeyframeMap> map_;
  SE3 T_first_frame_;
};

TEST_F(FixedInViewTest, ItsOwnBodyHoldsNoRobotBack) {
  cv::Mat_<std::uint8_t> squares;
  for (int i = 0; i < 40; ++i) squares = squaresAfter(withBody(i, 0.6F));
  EXPECT_GT(marked(squares, true), 60);
  EXPECT_LT(marked(squares, false), 10);
  EXPECT_LT(errorOfPose(39), 0.02);
  const cv::Rect inside(body_.x + 16, body_.y + 16, body_.width - 32, body_.height - 32);
  EXPECT_LT(cv::countNonZero(map_->depth.mean(inside) > 0.0F), 300) << "of the body, stereo knows nothing";
}

TEST_F(FixedInViewTest, ABodyWithoutDepthIsFoundAsWell) {
  cv::Mat_<std::uint8_t> squares;
  for (int i = 0; i < 40; ++i) squares = squaresAfter(withBody(i, kNoDepth));
  EXPECT_GT(marked(squares, true), 40);
  EXPECT_LT(errorOfPose(39), 0.02);
}

TEST_F(FixedInViewTest, WhatLeavesTheViewIsForgotten) {
  for (int i = 0; i < 30; ++i) squaresAfter(withBody(i, 0.6F));
  cv::Mat_<std::uint8_t> squares;
  for (int i = 30; i < 80; ++i) squares = squaresAfter(frame(i));
  EXPECT_LT(marked(squares, true) + marked(squares, false), 10);
}

/// Where there is no texture, nothing can be compared, and nothing is aligned either.
TEST_F(FixedInViewTest, APlainWallTellsNothingAboutABodyThatWent) {
  for (int i = 0; i < 30; ++i) squaresAfter(withBody(i, 0.6F));
  cv::Mat_<std::uint8_t> squares;
  for (int i = 30; i < 80; ++i) {
    RgbdFrame given = frame(i);
    given.grey = given.grey.clone();
    given.grey.rowRange(208, 240) = given.grey.rowRange(208, 240) * 0.02 + 120;  // plain, with its noise
    squares = squaresAfter(given);
  }
  EXPECT_LT(marked(squares, true), 45) << "all but the 40 squares of the wall came back";
}

TEST_F(FixedInViewTest, ANewStartKnowsOfNoBody) {
  for (int i = 0; i < 30; ++i) squaresAfter(withBody(i, 0.6F));
  tracker_.reset();
  keyframe_.reset();
  EXPECT_TRUE(squaresAfter(withBody(30, 0.6F)).empty());
}

TEST_F(FixedInViewTest, ASceneIsNotFixed) {
  for (int i = 0; i < 80; ++i) {
    const cv::Mat_<std::uint8_t> squares = squaresAfter(frame(i));
    EXPECT_LT(marked(squares, true) + marked(squares, false), 10) << i;
  }
}

/// All stays where it is, and nothing tells a body from the scene.
TEST_F(FixedInViewTest, ACameraAtRestTellsNothing) {
  for (int i = 0; i < 30; ++i) {
    RgbdFrame given =
        scene_.frame((i + 1) * kPeriod, T_camera_world(0), 2.0, static_cast<std::uint64_t>(i) + 1);
    EXPECT_TRUE(squaresAfter(given).empty()) << i;
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
