// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/keyframe_mapper.h"

#include <memory>

#include "visual_odometry_fixture.h"

namespace rgbd_sfm_fusion {
namespace {

class KeyframeMapperTest : public VisualOdometryTest {
 protected:
  /// A frame that came with `step`, as FrameTracker hands it over.
  FrameToMap frameToMap(int index, FrameToMap::Use use, const Step& step) const {
    FrameToMap result;
    result.use = use;
    result.rgbd = frame(index);
    result.camera = scene_.camera();
    result.pyramid.build(result.rgbd.grey, options_.tracking.pyramid_levels);
    result.T_frame_keyframe = T_camera_world(index) * T_camera_world(0).inverse();
    result.pose.T_first_camera = result.T_frame_keyframe.inverse();
    result.step = step;
    result.options = std::make_shared<const OdometryOptions>(options_);
    return result;
  }

  static Step known() {
    Step step;
    step.twist << 0.01, 0.0, 0.0, 0.0, 0.002, 0.0;
    step.interval = 0.033;
    return step;
  }
};

TEST_F(KeyframeMapperTest, AFrameThatIsFoundAgainAfterALossTellsNothingOfTheKeyframesMotion) {
  KeyframeMapper mapper(scene_.camera());
  const FrameToMap keyframe = frameToMap(0, FrameToMap::Use::kStarts, known());
  const auto keyframe_to_track = mapper.mapWithoutStereo(keyframe);
  ASSERT_TRUE(keyframe_to_track);
  ASSERT_TRUE(keyframe_to_track->step.isKnown());
  mapper.mapByStereo(keyframe, true);
  const auto after = mapper.mapWithoutStereo(frameToMap(2, FrameToMap::Use::kRefines, Step()));
  ASSERT_TRUE(after);
  EXPECT_TRUE(after->step.isKnown());
  EXPECT_EQ(after->step.twist, keyframe_to_track->step.twist);
}

TEST_F(KeyframeMapperTest, TheFirstFrameAfterAKeyframeTellsHowTheCameraWentOn) {
  KeyframeMapper mapper(scene_.camera());
  const FrameToMap keyframe = frameToMap(0, FrameToMap::Use::kStarts, Step());
  ASSERT_FALSE(mapper.mapWithoutStereo(keyframe)->step.isKnown());
  mapper.mapByStereo(keyframe, true);
  const auto after = mapper.mapWithoutStereo(frameToMap(1, FrameToMap::Use::kRefines, known()));
  ASSERT_TRUE(after);
  EXPECT_EQ(after->step.twist, known().twist);
}

/// At a low rate, a camera's large steps leave no frame to refine a keyframe.
TEST_F(KeyframeMapperTest, StereoContestsFalseSensorDepthAlsoIfEachFrameBecomesTheKeyframe) {
  const cv::Rect false_depth(96, 64, 96, 96);
  KeyframeMapper mapper(scene_.camera());
  std::shared_ptr<const KeyframeToTrack> to_track;
  for (int i = 0; i < 6; ++i) {
    FrameToMap frame = frameToMap(i, FrameToMap::Use::kBecomesKeyframe, known());
    const auto placeOf = [](int index) { return motion(0.15 * index, 0.0, 0.0); };
    frame.use = i == 0 ? FrameToMap::Use::kStarts : FrameToMap::Use::kBecomesKeyframe;
    frame.rgbd = scene_.frame((i + 1) * kPeriod, placeOf(i), 2.0, static_cast<std::uint64_t>(i) + 1);
    frame.rgbd.depth(false_depth) *= 1.1;
    frame.pyramid.build(frame.rgbd.grey, options_.tracking.pyramid_levels);
    frame.T_frame_keyframe = placeOf(i) * placeOf(i - 1).inverse();
    frame.pose.T_first_camera = placeOf(i).inverse();
    mapper.mapWithoutStereo(frame);
    to_track = mapper.mapByStereo(frame, true).to_track;
  }
  const ReferencePoints& points = to_track->reference.points(options_.tracking.finest_level);
  int inside = 0, wrong = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    const double scale = std::ldexp(1.0, options_.tracking.finest_level);
    const Eigen::Vector2d pixel(points.camera.fx * static_cast<double>(points.x[i]) + points.camera.cx,
                                points.camera.fy * static_cast<double>(points.y[i]) + points.camera.cy);
    const double u = scale * pixel.x(), v = scale * pixel.y();
    if (!false_depth.contains(cv::Point(static_cast<int>(u), static_cast<int>(v)))) continue;
    ++inside;
    const double depth = scene_.depth(motion(0.75, 0.0, 0.0), u, v);
    wrong += std::abs(static_cast<double>(points.inverse_depth[i]) * depth - 1.0) > 0.05 ? 1 : 0;
  }
  EXPECT_GT(inside, 100);
  EXPECT_LT(wrong, inside / 10);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
