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

}  // namespace
}  // namespace rgbd_sfm_fusion
