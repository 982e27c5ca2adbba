// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/depth_fusion.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <stdexcept>

#include "unit/fusion/fusion_sequence.h"

namespace rgbd_sfm_fusion {
namespace {

using test::expectConsistent;
using test::forSmallImages;
using test::kFrame;
using test::kNone;
using test::kSfmSigma;
using test::options;
using test::Sequence;

TEST(DepthFusion, FusesWhatBothSeeAndKeepsWhatOneSees) {
  const Sequence sequence(2.0);
  DepthFusion fusion(sequence.camera(), options());
  for (int n = 0; n < 5; ++n) {
    const FusedFrame fused = sequence.fuse(fusion, n);
    EXPECT_EQ(fused.stamp, n * kFrame);
    expectConsistent(fused);
    EXPECT_NEAR(fused.scale.alpha, 2.0, 0.01);
    EXPECT_FALSE(fused.scale.refused);
    EXPECT_GT(fused.counts.sensor_only, 5000u);
    EXPECT_GT(fused.counts.sfm_only, 300u);  // beyond five metres
    EXPECT_GT(fused.counts.fused, 2000u);
    EXPECT_LT(fused.disagreeing, fused.counts.fused / 25u) << "2.5 % by chance";
    const DepthImage truth = sequence.trueDepth(Sequence::pose(n));
    double squares = 0.0, pixels = 0.0;
    for (int y = 0; y < truth.rows; ++y) {
      for (int x = 0; x < truth.cols; ++x) {
        if (fused.provenance(y, x) != static_cast<int>(Provenance::kSfm)) continue;
        const double error = static_cast<double>(fused.depth.mean(y, x) / truth(y, x)) - 1.0;
        squares += error * error;
        pixels += 1.0;
      }
    }
    EXPECT_LT(std::sqrt(squares / pixels), 1.3 * static_cast<double>(kSfmSigma)) << n;
  }
}

TEST(DepthFusion, TheUnitOfSfmMakesNoDifference) {
  const Sequence reference(1.0);
  DepthFusion reference_fusion(reference.camera(), options());
  std::vector<FusedFrame> expected;
  for (int n = 0; n < 4; ++n) expected.push_back(reference.fuse(reference_fusion, n));
  for (const double unit : {0.1, 10.0}) {
    const Sequence other(unit);
    DepthFusion fusion(other.camera(), options());
    for (int n = 0; n < 4; ++n) {
      const FusedFrame fused = other.fuse(fusion, n);
      const FusedFrame& same = expected[static_cast<std::size_t>(n)];
      ASSERT_GT(same.counts.fused, 1000u);
      EXPECT_NEAR(fused.scale.alpha / unit / same.scale.alpha, 1.0, 1e-4);
      int different = 0;
      for (int y = 0; y < fused.depth.mean.rows; ++y) {
        for (int x = 0; x < fused.depth.mean.cols; ++x) {
          // Points on the border between two pixels may fall on either pixel.
          if (fused.provenance(y, x) != same.provenance(y, x)) {
            ++different;
          } else if (fused.provenance(y, x) != 0) {
            different += std::abs(fused.depth.mean(y, x) / same.depth.mean(y, x) - 1.0f) < 1e-4f ? 0 : 1;
            different +=
                std::abs(fused.depth.variance(y, x) / same.depth.variance(y, x) - 1.0f) < 1e-3f ? 0 : 1;
          }
        }
      }
      EXPECT_LE(different, 4) << n;
    }
  }
}

TEST(DepthFusion, IsSensorOnlyWhileNotTracking) {
  const Sequence sequence(2.0);
  DepthFusion fusion(sequence.camera(), options());
  const auto expectSensorOnly = [&](const FusedFrame& fused) {
    expectConsistent(fused);
    EXPECT_GT(fused.counts.sensor_only, 8000u);
    EXPECT_EQ(fused.counts.total(), fused.counts.sensor_only);
    EXPECT_TRUE(fused.sfm.mean.empty());
    EXPECT_TRUE(fused.scale.refused);
  };
  TrackingResult initialising = sequence.tracked(0);
  initialising.state = TrackingState::kInitialising;
  const FusedFrame first = fusion.fuse(initialising, nullptr, sequence.frame(0));
  expectSensorOnly(first);
  EXPECT_FALSE(first.scale.hasScale());

  const double alpha = sequence.fuse(fusion, 1).scale.alpha;
  TrackingResult lost = sequence.tracked(2);
  lost.state = TrackingState::kLost;
  const FusedFrame second = fusion.fuse(lost, sequence.keyframe(), sequence.frame(2));
  expectSensorOnly(second);
  EXPECT_EQ(second.scale.alpha, alpha) << "held";

  TrackingResult of_another_keyframe = sequence.tracked(3);
  of_another_keyframe.keyframe_stamp = 1;
  expectSensorOnly(fusion.fuse(of_another_keyframe, sequence.keyframe(), sequence.frame(3)));
  TrackingResult not_finite = sequence.tracked(4);
  not_finite.covariance(2, 2) = std::numeric_limits<double>::quiet_NaN();
  expectSensorOnly(fusion.fuse(not_finite, sequence.keyframe(), sequence.frame(4)));
}

/// A new keyframe that knows nothing of the image's right half.
struct NewKeyframe {
  explicit NewKeyframe(const Sequence& sequence) : map(std::make_shared<KeyframeMap>(*sequence.keyframe())) {
    map->stamp = 2 * kFrame;
    const cv::Rect right(map->camera.width / 2, 0, map->camera.width / 2, map->camera.height);
    map->depth = {map->depth.mean.clone(), map->depth.variance.clone()};
    map->depth.mean(right).setTo(static_cast<double>(kNone));
    map->depth.variance(right).setTo(static_cast<double>(kNone));
  }

  /// How many pixels of the image's right quarter have SfM depth.
  std::size_t carriedInto(const FusedFrame& fused) const {
    const int width = map->camera.width / 4;
    const cv::Mat_<float> quarter = fused.sfm.mean({3 * width, 0, width, map->camera.height});
    return static_cast<std::size_t>(cv::countNonZero(quarter > 0.0));
  }

  std::shared_ptr<KeyframeMap> map;
};

TEST(DepthFusion, KnowsTheKeyframeBeforeThoughAnImageWasNotTracked) {
  const Sequence sequence(2.0);
  const NewKeyframe next(sequence);
  for (const bool jumps : {false, true}) {
    DepthFusion fusion(sequence.camera(), options());
    sequence.fuse(fusion, 0);
    TrackingResult left_out;
    left_out.stamp = kFrame;
    left_out.state = TrackingState::kLost;
    fusion.fuse(left_out, nullptr, sequence.frame(1));
    TrackingResult tracked = sequence.tracked(2);
    tracked.keyframe_stamp = next.map->stamp;
    tracked.relocalised = jumps;
    const std::size_t carried = next.carriedInto(fusion.fuse(tracked, next.map, sequence.frame(2)));
    EXPECT_EQ(carried > 500u, !jumps) << carried;
  }
}

TEST(DepthFusion, PublishesNoSfmBeforeItHasAScaleAndAllOfItWithoutSensor) {
  const Sequence sequence(2.0);
  DepthFusion fusion(sequence.camera(), options());
  RgbdFrame blind = sequence.frame(0);
  blind.depth.release();
  blind.depth_stamp = kNoStamp;
  const FusedFrame first = fusion.fuse(sequence.tracked(0), sequence.keyframe(), blind);
  EXPECT_EQ(first.counts.total(), 0u);
  EXPECT_EQ(first.depth.mean.size(), cv::Size(160, 120));
  expectConsistent(first);
  sequence.fuse(fusion, 1);
  blind.stamp = 2 * kFrame;
  const FusedFrame third = fusion.fuse(sequence.tracked(2), sequence.keyframe(), blind);
  expectConsistent(third);
  EXPECT_GT(third.counts.sfm_only, 3000u);
  EXPECT_EQ(third.counts.total(), third.counts.sfm_only);
  EXPECT_TRUE(third.scale.refused);
}

TEST(DepthFusion, AWrongPoseDoesNotSpoilTheSensor) {
  const Sequence sequence(1.0);
  DepthFusion fusion(sequence.camera(), options());
  sequence.fuse(fusion, 0);
  TrackingResult wrong = sequence.tracked(1);
  wrong.T_frame_keyframe =
      SE3(Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitY())), {0, 0, 0.2});
  const FusedFrame fused = fusion.fuse(wrong, sequence.keyframe(), sequence.frame(1));
  expectConsistent(fused);
  const DepthImage truth = sequence.trueDepth(Sequence::pose(1));
  int off = 0, of = 0;
  for (int y = 0; y < truth.rows; ++y) {
    for (int x = 0; x < truth.cols; ++x) {
      if (!(truth(y, x) < 4.9f)) continue;
      ++of;
      off += std::abs(fused.depth.mean(y, x) / truth(y, x) - 1.0f) > 0.1f ? 1 : 0;
    }
  }
  EXPECT_LT(off, of / 50);
}

TEST(DepthFusion, KeepsNoKeyframeForLaterWhileItIsNotToUseOneBefore) {
  const Sequence sequence(1.0);
  KeyframeMap next = *sequence.keyframe();  // knows nothing on the left
  next.stamp = kFrame;
  next.depth.mean = next.depth.mean.clone();
  const cv::Rect left(0, 0, sequence.camera().width / 2, sequence.camera().height);
  next.depth.mean(left).setTo(static_cast<double>(kNone));
  TrackingResult tracked = sequence.tracked(2);
  tracked.keyframe_stamp = next.stamp;
  for (const bool pauses : {false, true}) {
    FusionOptions chosen = options();
    DepthFusion fusion(sequence.camera(), chosen);
    sequence.fuse(fusion, 1);
    for (const bool on : {!pauses, true}) {
      chosen.recent_keyframe = on;
      fusion.setOptions(chosen);
    }
    const FusedFrame fused = fusion.fuse(tracked, std::make_shared<KeyframeMap>(next), sequence.frame(2));
    const int known = cv::countNonZero(fused.sfm.mean({0, 0, left.width / 2, left.height}) > 0.0);
    EXPECT_EQ(known == 0, pauses);
  }
}

TEST(DepthFusion, OfExactDataRoundingTellsNothing) {
  const PinholeCamera camera{640, 480, 525.0, 525.0, 319.5, 239.5};
  const cv::Size size(camera.width, camera.height);
  RgbdFrame frame;
  frame.depth = DepthImage(size, 2.0F);
  frame.depth.colRange(400, 640) = kNone;
  auto keyframe = std::make_shared<KeyframeMap>();
  keyframe->stamp = frame.stamp;
  keyframe->camera = camera;
  keyframe->depth = {DepthImage(size, 0.5F), cv::Mat_<float>(size, 0.005F * 0.005F)};
  TrackingResult tracked;
  tracked.stamp = tracked.keyframe_stamp = frame.stamp;
  tracked.state = TrackingState::kTracking;
  const FusedFrame fused = DepthFusion(camera, FusionOptions()).fuse(tracked, keyframe, frame);
  EXPECT_NEAR(fused.scale.alpha, 4.0, 1e-4);
  EXPECT_NEAR(fused.depth.mean(240, 520), 2.0F, 1e-4F);  // SfM only
}

TEST(DepthFusion, FindsThatSfmStatesTooSmallVariances) {
  Sequence sequence(1.0);
  KeyframeMap optimistic = *sequence.keyframe();
  optimistic.depth.variance = optimistic.depth.variance.clone();
  for (float& variance : optimistic.depth.variance) variance /= 100.0f;
  const auto fuse = [&](bool calibrate) {
    FusionOptions chosen = options();
    chosen.calibrate_sfm_variance = calibrate;
    DepthFusion fusion(sequence.camera(), chosen);
    return fusion.fuse(sequence.tracked(1), std::make_shared<KeyframeMap>(optimistic), sequence.frame(1));
  };
  const FusedFrame stated = fuse(false), found = fuse(true);
  double ratios = 0.0, pixels = 0.0;
  for (int y = 0; y < stated.provenance.rows; ++y) {
    for (int x = 0; x < stated.provenance.cols; ++x) {
      const float ratio = found.sfm.variance(y, x) / stated.sfm.variance(y, x);
      if (std::isnan(ratio)) continue;
      ratios += static_cast<double>(ratio);
      pixels += 1.0;
    }
  }
  EXPECT_GT(pixels, 100.0);
  EXPECT_GT(ratios / pixels, 1.1);
}

TEST(DepthFusion, AFrameWithoutAFitKeepsTheSpreadOfTheLastFit) {
  const Sequence sequence(1.0);
  KeyframeMap optimistic = *sequence.keyframe();
  optimistic.depth.variance = optimistic.depth.variance.clone();
  for (float& variance : optimistic.depth.variance) variance /= 100.0f;
  const auto keyframe = std::make_shared<KeyframeMap>(optimistic);
  DepthFusion fusion(sequence.camera(), options());
  const FusedFrame fitted = fusion.fuse(sequence.tracked(1), keyframe, sequence.frame(1));
  RgbdFrame blind = sequence.frame(2);
  blind.depth = DepthImage();
  const FusedFrame held = fusion.fuse(sequence.tracked(2), keyframe, blind);
  EXPECT_TRUE(held.scale.refused);
  const auto meanVariance = [](const FusedFrame& fused) {
    return cv::mean(fused.sfm.variance, fused.sfm.mean > 0.0)[0];
  };
  EXPECT_GT(meanVariance(held), 0.7 * meanVariance(fitted));
}

TEST(DepthFusion, OneFramesSpreadIsOneOfMany) {
  const Sequence sequence(1.0);
  KeyframeMap optimistic = *sequence.keyframe();
  optimistic.depth.variance = optimistic.depth.variance.clone();
  for (float& variance : optimistic.depth.variance) variance /= 100.0f;
  DepthFusion fusion(sequence.camera(), options());
  const auto meanVariance = [&](const KeyframeMap& map) {
    const FusedFrame fused =
        fusion.fuse(sequence.tracked(1), std::make_shared<KeyframeMap>(map), sequence.frame(1));
    return cv::mean(fused.sfm.variance, fused.sfm.mean > 0.0)[0];
  };
  double usual = 0.0;
  for (int n = 0; n < 20; ++n) usual = meanVariance(*sequence.keyframe());
  // Its spread is ten times as large, which alone would make up for its variances.
  EXPECT_LT(meanVariance(optimistic), 0.5 * usual);
}

TEST(DepthFusion, HowManyPixelsAScaleNeedsDoesNotChangeVariances) {
  const Sequence sequence(1.0);
  const auto sigmas = [&](int min_pixels) {
    FusionOptions chosen = options();
    chosen.scale.min_pixels = min_pixels;
    DepthFusion fusion(sequence.camera(), chosen);
    const FusedFrame fused = sequence.fuse(fusion, 1);
    EXPECT_FALSE(fused.scale.refused) << min_pixels;
    return fused.sfm.variance;
  };
  // 4000 is more than the fit's samples of the overlap, and fewer than the overlap's pixels.
  EXPECT_TRUE(test::sameBits(sigmas(200), sigmas(4000)));
}

TEST(DepthFusion, PaperOptionsAreThePapersMethod) {
  const Sequence sequence(2.0);
  FusionOptions paper = FusionOptions::paper();
  paper.scale.min_pixels = 100;
  DepthFusion fusion(sequence.camera(), paper);
  for (int n = 0; n < 3; ++n) {
    const FusedFrame fused = sequence.fuse(fusion, n);
    expectConsistent(fused);
    EXPECT_EQ(fused.scale.sigma, 0.0);
    EXPECT_EQ(fused.disagreeing, 0u);
    const RgbdFrame frame = sequence.frame(n);
    EXPECT_GT(fused.counts.sensor_only, 100u);
    double ratios = 0.0, pixels = 0.0;
    for (int y = 0; y < frame.depth.rows; ++y) {
      for (int x = 0; x < frame.depth.cols; ++x) {
        const float d = frame.depth(y, x);
        if (fused.provenance(y, x) == 1) {
          ASSERT_FLOAT_EQ(fused.depth.variance(y, x), std::pow(1.425e-3f * d * d, 2.0f));
        }
        if (fused.provenance(y, x) != 3) continue;
        ratios += static_cast<double>(d) / (static_cast<double>(fused.sfm.mean(y, x)) / fused.scale.alpha);
        pixels += 1.0;
      }
    }
    EXPECT_NEAR(fused.scale.alpha, ratios / pixels, 1e-6) << "mean ratio of this frame alone";
  }
}

TEST(DepthFusion, SameInputGivesTheSameBitsAndResetForgets) {
  const Sequence sequence(3.0);
  DepthFusion fusion(sequence.camera(), options());
  std::vector<FusedFrame> first;
  for (int n = 0; n < 3; ++n) first.push_back(sequence.fuse(fusion, n));
  fusion.reset();
  for (int n = 0; n < 3; ++n) {
    const FusedFrame again = sequence.fuse(fusion, n);
    EXPECT_TRUE(test::sameBits(again.depth.mean, first[static_cast<std::size_t>(n)].depth.mean));
    EXPECT_TRUE(test::sameBits(again.depth.variance, first[static_cast<std::size_t>(n)].depth.variance));
    EXPECT_TRUE(test::sameBits(again.provenance, first[static_cast<std::size_t>(n)].provenance));
  }
}

std::string message(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(DepthFusion, BadArgumentsAreNamed) {
  const Sequence sequence(1.0);
  FusionOptions bad;
  bad.gaussian.max_disagreement = 1.5;
  EXPECT_EQ(message([&] { DepthFusion(sequence.camera(), bad); }), "max_disagreement = 1.5: expected 0 to 1");
  DepthFusion fusion(sequence.camera(), options());
  EXPECT_EQ(message([&] { fusion.setOptions(bad); }), "max_disagreement = 1.5: expected 0 to 1");
  EXPECT_EQ(message([&] { fusion.setOptions(FusionOptions::paper()); }), "no error");
  PinholeCamera no_camera = sequence.camera();
  no_camera.fx = 0.0;
  EXPECT_NE(message([&] { DepthFusion(no_camera, options()); }).find("camera fx = 0"), std::string::npos);
  RgbdFrame small = sequence.frame(0);
  small.depth = DepthImage(60, 80, 1.0f);
  EXPECT_EQ(message([&] { fusion.fuse(sequence.tracked(0), sequence.keyframe(), small); }),
            "sensor depth is 80x60, expected the camera's 160x120");
  RgbdFrame part = sequence.frame(0);
  part.grey = GreyImage(cv::Size(176, 120), std::uint8_t{0}).colRange(0, 160);
  EXPECT_EQ(message([&] { fusion.fuse(sequence.tracked(0), sequence.keyframe(), part); }),
            "brightness is a part of a larger image: expected its clone()");
  const auto odd = std::make_shared<KeyframeMap>(*sequence.keyframe());
  odd->depth.variance.release();
  EXPECT_EQ(message([&] { fusion.fuse(sequence.tracked(0), odd, sequence.frame(0)); }),
            "keyframe variance is 0x0, expected the camera's 160x120");
  const auto of_another_camera = std::make_shared<KeyframeMap>(*sequence.keyframe());
  of_another_camera->camera.width = 320;
  EXPECT_EQ(message([&] { fusion.fuse(sequence.tracked(0), of_another_camera, sequence.frame(0)); }),
            "keyframe depth is 160x120, expected its camera's 320x120");
}

}  // namespace
}  // namespace rgbd_sfm_fusion
