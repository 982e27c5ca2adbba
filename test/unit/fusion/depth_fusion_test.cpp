// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/depth_fusion.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <stdexcept>

#include "unit/fusion/depth_images.h"

namespace rgbd_sfm_fusion {
namespace {

using test::kNone;

constexpr Stamp kFrame = 33'333'333;
constexpr float kSfmSigma = 0.03f;

/// A slanted wall, partly beyond the sensor's range, and a moving camera; SfM sees a third of it, in a unit
/// of its own.
class Sequence {
 public:
  explicit Sequence(double alpha) : alpha_(alpha) {
    keyframe_.stamp = 0;
    keyframe_.camera = camera_;
    std::mt19937 random(7);
    std::normal_distribution<float> normal;
    const DepthImage truth = trueDepth(SE3());
    keyframe_.depth = {DepthImage(truth.size(), kNone), cv::Mat_<float>(truth.size(), kNone)};
    for (int y = 0; y < truth.rows; ++y) {
      for (int x = 0; x < truth.cols; ++x) {
        if (std::sin(0.5 * x + 2.0 * std::sin(0.1 * y)) < 0.3) continue;
        const float rho = static_cast<float>(alpha) / truth(y, x);
        const float noisy = rho * (1.0f + kSfmSigma * normal(random));
        keyframe_.depth.mean(y, x) = 1.0f / noisy;
        keyframe_.depth.variance(y, x) = std::pow(kSfmSigma * rho / (noisy * noisy), 2.0f);
      }
    }
  }

  static SE3 pose(int n) {  // T_world_camera [m], with the first camera as world
    Vector6 xi;
    xi << 0.01 * n, -0.004 * n, 0.006 * n, 0.002 * n, 0.004 * n, -0.003 * n;
    return SE3::exp(xi);
  }

  DepthImage trueDepth(const SE3& T_world_camera) const {
    const Eigen::Vector3d n = Eigen::Vector3d(-0.8, 0.1, 1.0).normalized();
    const Eigen::Vector3d there = T_world_camera.rotation().conjugate() * n;
    return test::plane(camera_, there, 3.0 - n.dot(T_world_camera.translation()));
  }

  TrackingResult tracked(int n) const {
    TrackingResult frame;
    frame.stamp = n * kFrame;
    frame.state = TrackingState::kTracking;
    frame.keyframe_stamp = keyframe_.stamp;
    const SE3 T_frame_keyframe = pose(n).inverse();
    frame.T_frame_keyframe = {T_frame_keyframe.rotation(), T_frame_keyframe.translation() / alpha_};
    frame.T_odom_frame = frame.T_frame_keyframe.inverse();
    return frame;
  }

  RgbdFrame frame(int n) const {
    RgbdFrame frame;
    frame.stamp = frame.depth_stamp = n * kFrame;
    frame.depth = trueDepth(pose(n));
    std::mt19937 random(static_cast<unsigned>(n));
    std::normal_distribution<float> normal;
    for (float& depth : frame.depth) depth += DepthNoiseModel().sigmaZ(depth) * normal(random);
    return frame;
  }

  FusedFrame fuse(DepthFusion& fusion, int n) const { return fusion.fuse(tracked(n), keyframe(), frame(n)); }

  std::shared_ptr<const KeyframeMap> keyframe() const { return std::make_shared<KeyframeMap>(keyframe_); }
  const PinholeCamera& camera() const { return camera_; }

 private:
  double alpha_;
  PinholeCamera camera_ = test::smallCamera();
  KeyframeMap keyframe_;
};

ScaleOptions forSmallImages() {
  ScaleOptions options;
  options.min_pixels = 100;
  return options;
}

FusionOptions options() {
  FusionOptions result;
  result.scale = forSmallImages();
  return result;
}

void expectConsistent(const FusedFrame& fused) {
  EXPECT_TRUE(test::isConsistent(fused.depth));
  ProvenanceCounts counts;
  for (int y = 0; y < fused.depth.mean.rows; ++y) {
    for (int x = 0; x < fused.depth.mean.cols; ++x) {
      const int source = fused.provenance(y, x);
      ASSERT_LE(source, 3);
      ASSERT_EQ(source == 0, std::isnan(fused.depth.mean(y, x)));
      ASSERT_FALSE(std::sqrt(fused.depth.variance(y, x)) > 0.2f * fused.depth.mean(y, x));
      counts += ProvenanceCounts{source == 1 ? 1u : 0u, source == 2 ? 1u : 0u, source == 3 ? 1u : 0u};
    }
  }
  EXPECT_EQ(counts.sensor_only, fused.counts.sensor_only);
  EXPECT_EQ(counts.sfm_only, fused.counts.sfm_only);
  EXPECT_EQ(counts.fused, fused.counts.fused);
}

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
    EXPECT_GT(fused.counts.sfm_only, 500u);  // beyond five metres
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
      EXPECT_NEAR(fused.scale.alpha / unit / same.scale.alpha, 1.0, 1e-4);
      int different = 0;
      for (int y = 0; y < fused.depth.mean.rows; ++y) {
        for (int x = 0; x < fused.depth.mean.cols; ++x) {
          // Points on the border between two pixels may fall to either.
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

TEST(DepthFusion, CompensatesSkewByTheTrackedMotion) {
  const Sequence sequence(2.0);  // poses are in units of two metres
  for (const bool compensate : {false, true}) {
    FusionOptions chosen = options();
    chosen.compensate_skew = compensate;
    DepthFusion fusion(sequence.camera(), chosen);
    double error = 0.0;
    for (int n = 0; n < 6; ++n) {
      RgbdFrame frame = sequence.frame(n);
      frame.depth = sequence.trueDepth(Sequence::pose(n - 1));  // a frame late
      frame.depth_stamp = (n - 1) * kFrame;
      const FusedFrame fused = fusion.fuse(sequence.tracked(n), sequence.keyframe(), frame);
      expectConsistent(fused);
      error = std::abs(
          static_cast<double>(fused.depth.mean(60, 60) / sequence.trueDepth(Sequence::pose(n))(60, 60)) -
          1.0);
    }
    if (compensate) {
      EXPECT_LT(error, 0.002);
    } else {
      EXPECT_GT(error, 0.003);
    }
  }
}

TEST(DepthFusion, AveragesNothingWhereAStepHasPassedSinceTheDepth) {
  const Sequence sequence(1.0);
  constexpr int kLate = 3;             // [frames]
  const cv::Rect post(70, 0, 4, 120);  // too narrow to make its area a contested one
  FusionOptions chosen = options();
  chosen.reject_reflections = false;
  chosen.rim_width = 0;  // where the step is now, there would be none anyway
  DepthFusion fusion(sequence.camera(), chosen);
  for (int n = 0; n < 3; ++n) sequence.fuse(fusion, n);
  RgbdFrame frame = sequence.frame(3);
  frame.depth = sequence.trueDepth(Sequence::pose(3 - kLate));
  frame.depth_stamp = (3 - kLate) * kFrame;
  frame.depth(post) *= 0.5;
  const FusedFrame fused = fusion.fuse(sequence.tracked(3), sequence.keyframe(), frame);
  expectConsistent(fused);
  const DepthImage wall = sequence.trueDepth(Sequence::pose(3));
  int passed = 0;
  for (int y = 0; y < post.height; ++y) {
    for (int x = post.x; x < post.br().x; ++x) {
      if (std::isnan(fused.sfm.mean(y, x)) || fused.depth.mean(y, x) < 0.9f * wall(y, x)) continue;
      ++passed;
      EXPECT_NE(fused.provenance(y, x), static_cast<int>(Provenance::kFused));
    }
  }
  EXPECT_GT(passed, 20) << "pixels have become the wall's";
  EXPECT_GT(fused.counts.fused, 2000u);
}

TEST(DepthFusion, DropsSfmInHolesBesideWhatTheSensorSees) {
  const Sequence sequence(1.0);
  const cv::Rect hole(40, 30, 60, 50);
  for (const int width : {0, 3, 7}) {
    FusionOptions chosen = options();
    chosen.rim_width = width;
    chosen.reject_reflections = false;
    chosen.min_inlier_probability = 0.0;
    DepthFusion fusion(sequence.camera(), chosen);
    RgbdFrame frame = sequence.frame(1);
    frame.depth(hole).setTo(kNone);
    const FusedFrame fused = fusion.fuse(sequence.tracked(1), sequence.keyframe(), frame);
    expectConsistent(fused);
    const cv::Rect inside(hole.x + width, hole.y + width, hole.width - 2 * width, hole.height - 2 * width);
    cv::Mat sfm_only = fused.provenance == static_cast<int>(Provenance::kSfm);
    const int in_hole = cv::countNonZero(sfm_only(hole)), in_middle = cv::countNonZero(sfm_only(inside));
    EXPECT_GT(in_middle, 0) << width;
    EXPECT_EQ(in_hole, width == 0 ? in_hole : in_middle) << width;
    EXPECT_EQ(cv::countNonZero(fused.sfm.mean(hole) > 0.0F), in_hole) << width;
  }
}

TEST(DepthFusion, AveragesNothingNearTheSensorsHolesAndSteps) {
  const Sequence sequence(1.0);
  const cv::Rect hole(20, 30, 10, 50), step(60, 0, 4, 120);
  for (const int width : {0, 3, 7}) {
    const auto near = [&](const cv::Rect& pixels) {
      return cv::Rect(pixels.x - width, pixels.y - width, pixels.width + 2 * width,
                      pixels.height + 2 * width) &
             cv::Rect(0, 0, sequence.camera().width, sequence.camera().height);
    };
    for (const bool test_agreement : {true, false}) {
      FusionOptions chosen = options();
      chosen.rim_width = width;
      chosen.gaussian.test_agreement = test_agreement;
      DepthFusion fusion(sequence.camera(), chosen);
      RgbdFrame frame = sequence.frame(1);
      frame.depth(hole).setTo(kNone);
      frame.depth(step) *= 0.95;
      const FusedFrame fused = fusion.fuse(sequence.tracked(1), sequence.keyframe(), frame);
      expectConsistent(fused);
      const cv::Mat averaged = fused.provenance == static_cast<int>(Provenance::kFused);
      EXPECT_EQ(cv::countNonZero(averaged(hole)), 0);
      EXPECT_EQ(cv::countNonZero(averaged(near(hole))) == 0, width == 0 || test_agreement) << width;
      EXPECT_EQ(cv::countNonZero(averaged(near(step))) == 0, width > 0 && test_agreement) << width;
      EXPECT_GT(fused.counts.fused, 1000U);
    }
  }
}

TEST(DepthFusion, PublishesNothingFromSfmAloneWhileTheShutterIsUnknown) {
  const Sequence sequence(1.0);
  KeyframeMap map = *sequence.keyframe();
  for (const bool unknown : {false, true}) {
    map.shutter_unknown = unknown;
    DepthFusion fusion(sequence.camera(), options());
    RgbdFrame frame = sequence.frame(1);
    frame.depth(cv::Rect(40, 30, 60, 50)).setTo(kNone);
    const FusedFrame fused = fusion.fuse(sequence.tracked(1), std::make_shared<KeyframeMap>(map), frame);
    expectConsistent(fused);
    EXPECT_EQ(fused.counts.sfm_only == 0, unknown);
    EXPECT_EQ(fused.sfm_only_withheld, unknown);
    EXPECT_GT(fused.counts.fused, 1000U);
  }
}

TEST(DepthFusion, LearnsThatSfmStatesTooSmallVariances) {
  Sequence sequence(1.0);
  KeyframeMap optimistic = *sequence.keyframe();
  optimistic.depth.variance = optimistic.depth.variance.clone();
  for (float& variance : optimistic.depth.variance) variance /= 16.0f;
  for (const bool calibrate : {false, true}) {
    FusionOptions chosen = options();
    chosen.calibrate_sfm_variance = calibrate;
    chosen.min_inlier_probability = 0.0;  // which would change the variances, too
    DepthFusion fusion(sequence.camera(), chosen);
    const FusedFrame fused =
        fusion.fuse(sequence.tracked(1), std::make_shared<KeyframeMap>(optimistic), sequence.frame(1));
    const DepthImage truth = sequence.trueDepth(Sequence::pose(1));
    double sum = 0.0, pixels = 0.0;
    for (int y = 0; y < truth.rows; ++y) {
      for (int x = 0; x < truth.cols; ++x) {
        if (fused.provenance(y, x) != 2) continue;
        const double error = static_cast<double>(fused.depth.mean(y, x) - truth(y, x));
        sum += std::min(error * error / static_cast<double>(fused.depth.variance(y, x)), 25.0);
        pixels += 1.0;
      }
    }
    if (calibrate) {
      EXPECT_NEAR(sum / pixels, 1.0, 0.35);
    } else {
      EXPECT_GT(sum / pixels, 2.0);
    }
  }
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
  EXPECT_EQ(message([&] { DepthFusion(sequence.camera(), bad); }),
            "max_disagreement = 1.5: must be in [0, 1]");
  DepthFusion fusion(sequence.camera(), options());
  EXPECT_EQ(message([&] { fusion.setOptions(bad); }), "max_disagreement = 1.5: must be in [0, 1]");
  EXPECT_EQ(message([&] { fusion.setOptions(FusionOptions::paper()); }), "no error");
  PinholeCamera no_camera = sequence.camera();
  no_camera.fx = 0.0;
  EXPECT_NE(message([&] { DepthFusion(no_camera, options()); }).find("camera fx = 0"), std::string::npos);
  RgbdFrame small = sequence.frame(0);
  small.depth = DepthImage(60, 80, 1.0f);
  EXPECT_EQ(message([&] { fusion.fuse(sequence.tracked(0), sequence.keyframe(), small); }),
            "sensor depth is 80x60, the camera 160x120");
  const auto odd = std::make_shared<KeyframeMap>(*sequence.keyframe());
  odd->depth.variance.release();
  EXPECT_EQ(message([&] { fusion.fuse(sequence.tracked(0), odd, sequence.frame(0)); }),
            "keyframe variance is 0x0, the camera 160x120");
}

}  // namespace
}  // namespace rgbd_sfm_fusion
