// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/fixed_in_view.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <utility>

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
  RgbdFrame withBody(int index, float depth) const { return withBody(frame(index), depth); }

  RgbdFrame withBody(RgbdFrame given, float depth) const {
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
    const FrameTracker::Result result = tracker_->track(given, keyframe_);
    EXPECT_EQ(result.tracked.state, TrackingState::kTracking);
    if (!result.to_map) return {};
    mapper_->mapWithoutStereo(*result.to_map);
    const KeyframeMapper::Result mapped = mapper_->mapByStereo(*result.to_map, true);
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
    forEachMarked(squares, {scene_.camera().width, scene_.camera().height},
                  [&](const cv::Rect& square) { count += ((square & body_) == square) == in_body ? 1 : 0; });
    return count;
  }

  cv::Rect body_{0, 176, 320, 64};  // 80 of 300 squares
  std::optional<FrameTracker> tracker_{std::in_place, scene_.camera(), options_};
  std::optional<KeyframeMapper> mapper_{std::in_place, scene_.camera()};
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

/// The options and images that others have.
struct Variant {
  const char* name;
  int pyramid_levels, finest_level;
  Initialisation init;
  double readout;  // of the time between frames
  cv::Size image;
  int found = 40;  // squares of the body, at least
};

class FixedInViewOf : public FixedInViewTest, public testing::WithParamInterface<Variant> {
 protected:
  FixedInViewOf() {
    PinholeCamera camera = smallCamera();
    camera.width = GetParam().image.width, camera.height = GetParam().image.height;
    scene_ = PlaneScene(camera);
    options_.tracking.pyramid_levels = GetParam().pyramid_levels;
    options_.tracking.finest_level = GetParam().finest_level;
    options_.init = GetParam().init;
    body_ &= cv::Rect(0, 0, camera.width, camera.height);
    tracker_.emplace(camera, options_);
    mapper_.emplace(camera);
  }

  RgbdFrame view(int index) const {
    const double half = 0.5 * GetParam().readout;
    const ReadoutMotion readout{(at(index + half) * at(index - half).inverse()).log()};
    return scene_.frame((index + 1) * kPeriod, T_camera_world(index), 2.0,
                        static_cast<std::uint64_t>(index) + 1, readout);
  }

 private:
  static SE3 at(double index) {
    const int before = static_cast<int>(std::floor(index));
    const SE3 step = T_camera_world(before + 1) * T_camera_world(before).inverse();
    return SE3::exp((index - before) * step.log()) * T_camera_world(before);
  }
};

TEST_P(FixedInViewOf, ItsOwnBodyIsFound) {
  cv::Mat_<std::uint8_t> squares;
  for (int i = 0; i < 40; ++i) squares = squaresAfter(withBody(view(i), 0.6F));
  ASSERT_EQ(squares.size(), squaresOf(GetParam().image));
  EXPECT_GE(marked(squares, true), GetParam().found);
  EXPECT_LT(marked(squares, false), 15);
}

TEST_P(FixedInViewOf, ASceneIsNot) {
  for (int i = 0; i < 60; ++i) {
    const cv::Mat_<std::uint8_t> squares = squaresAfter(view(i));
    EXPECT_LT(marked(squares, true) + marked(squares, false), 10) << i;
  }
}

constexpr auto kByDepth = Initialisation::kDepth;
INSTANTIATE_TEST_SUITE_P(
    Odometry, FixedInViewOf,
    testing::Values(Variant{"RollingShutter", 4, 0, kByDepth, 0.8, {320, 240}},
                    Variant{"ShutterFromBelow", 4, 0, kByDepth, -0.8, {320, 240}},
                    Variant{"OneLevel", 1, 0, kByDepth, 0.0, {320, 240}},
                    Variant{"NoFineLevels", 4, 3, kByDepth, 0.0, {320, 240}, 10},
                    Variant{"RandomStart", 4, 0, Initialisation::kRandom, 0.0, {320, 240}},
                    Variant{"OddImage", 4, 0, kByDepth, 0.0, {309, 233}}),
    [](const testing::TestParamInfo<Variant>& variant) { return std::string(variant.param.name); });

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
  tracker_->reset();
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
