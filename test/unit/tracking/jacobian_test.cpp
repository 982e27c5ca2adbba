// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// Compares the written Jacobians of brightness with numeric differences. The normal equations of a single
/// point have its Jacobian and its residual, as the Jacobian of the brightness offset is 1.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rgbd_sfm_fusion/tracking/calibration_equations.h"
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"
#include "rgbd_sfm_fusion/tracking/tracking_candidates.h"
#include "synthetic_views.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kLevels = 3;
constexpr int kOffset = CalibrationEquations::kOffset, kReadout = CalibrationEquations::kReadout;
const SE3 kRoll = motion(0.02, 0.01, 0.05, 0.02, -0.03, 0.5);  // tells the sides of a step apart

/// Squared deviation of two Jacobians, summed over many points.
struct Deviation {
  double differences = 0.0, squares = 0.0;
  int points = 0;

  void add(double analytic, double numeric) {
    differences += (analytic - numeric) * (analytic - numeric);
    squares += numeric * numeric;
  }
  double relative() const { return std::sqrt(differences / squares); }
};

class JacobianTest : public testing::Test {
 protected:
  JacobianTest() { options_.finest_level = 0; }

  /// A keyframe that has depth at the pixel (u, v) only.
  TrackingReference referenceOf(int u, int v, const ReadoutMotion& motion = {}) const {
    return referenceOf(u, v, motion, scene_.camera());
  }
  TrackingReference referenceOf(int u, int v, const ReadoutMotion& motion,
                                const PinholeCamera& camera) const {
    const cv::Size size(scene_.camera().width, scene_.camera().height);
    InverseDepthImage depth;
    depth.create(size);
    depth.clear();
    depth.mean(v, u) = static_cast<float>(1.0 / scene_.depth(SE3(), u, v));
    depth.variance(v, u) = 1e-12F;
    TrackingCandidates candidates;
    candidates.setKeyframe(keyframe_, cameraPyramid(camera, kLevels), {options_.min_gradient});
    TrackingReference reference;
    candidates.collect(depth, motion, {}, {}, reference);
    return reference;
  }

  ImagePyramid view(const SE3& T_camera_world) const {
    ImagePyramid pyramid;
    pyramid.build(scene_.frame(1, T_camera_world).grey, kLevels);
    return pyramid;
  }

  /// Pixels far enough from the border, all over the image.
  template <class Visitor>
  static void forEachPixel(const Visitor& visit) {
    for (int v = 60; v < 190; v += 16) {
      for (int u = 80; u < 250; u += 16) visit(u, v);
    }
  }

  PlaneScene scene_{smallCamera()};
  TrackingOptions options_;
  ImagePyramid keyframe_ = view(SE3());
};

/// Jacobian by δ in T_frame_keyframe · exp(δ)⁻¹, by gain and by offset. Deviations are relative to each
/// parameter's own Jacobian.
class BrightnessJacobian : public JacobianTest {
 protected:
  std::vector<Deviation> deviations(const SE3& T, const ImagePyramid& image) const {
    std::vector<Deviation> of_parameters(8);
    forEachPixel([&](int u, int v) {
      const TrackingReference reference = referenceOf(u, v);
      if (reference.points(0).count != 1) return;  // without gradient
      const auto equations = [&](const Vector6& step, double gain) {
        return linearise({reference, image, options_, {{gain, 0.0}, 4.0}, {}, {}}, 0,
                         T * SE3::exp(step).inverse(), T.translation());
      };
      const auto residual = [&](const Vector6& step, double gain) {
        const NormalEquations at = equations(step, gain);
        return at.g(kOffset) / at.H(kOffset, kOffset);
      };
      const NormalEquations here = equations(Vector6::Zero(), 1.0);
      if (here.in_view != 1.0) return;
      constexpr double kStep = 1e-3;  // a fraction of a pixel
      for (int i = 0; i < 8; ++i) {
        const Vector6 step = i < 6 ? Vector6(kStep * Vector6::Unit(i)) : Vector6::Zero();
        const double gain = i == 6 ? kStep : 0.0;
        if (i == kOffset) continue;
        const double change = (residual(step, 1.0 + gain) - residual(-step, 1.0 - gain)) / (2.0 * kStep);
        // A step takes J δ off the residual.
        of_parameters[static_cast<std::size_t>(i)].add(here.H(kOffset, i) / here.H(kOffset, kOffset),
                                                       -change);
        ++of_parameters[static_cast<std::size_t>(i)].points;
      }
    });
    return of_parameters;
  }
};

TEST_F(BrightnessJacobian, IsThatOfNumericDifferencesWhereTheImagesAreOne) {
  const std::vector<Deviation> result = deviations(SE3(), keyframe_);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_GT(result[i].points, 50) << i;
    EXPECT_LT(result[i].relative(), 0.01) << i;
  }
}

TEST_F(BrightnessJacobian, IsThatOfNumericDifferencesAtATurnedCamera) {
  const std::vector<Deviation> result = deviations(kRoll, view(kRoll));
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_GT(result[i].points, 50) << i;
    EXPECT_LT(result[i].relative(), 0.2) << i;  // images of grey levels, which are interpolated
  }
}

/// Jacobian by the readout time of frame and keyframe together.
class ReadoutJacobian : public JacobianTest {
 protected:
  Deviation deviation(const SE3& T, const ImagePyramid& image) const {
    Vector6 keyframe_step, frame_step;
    keyframe_step << 0.01, -0.02, 0.004, 0.003, -0.006, 0.005;
    frame_step << -0.015, 0.01, 0.01, 0.004, 0.005, -0.004;
    AlignmentResult aligned;
    aligned.T_frame_keyframe = T;
    Deviation result;
    forEachPixel([&](int u, int v) {
      const auto equations = [&](double readout) {
        const TrackingReference reference = referenceOf(u, v, {readout * keyframe_step});
        const FrameShutter shutter{SE3::exp(-frame_step) * T, readout};
        return calibrationEquations({reference, image, options_, {}, shutter, {}}, aligned, keyframe_step);
      };
      const auto residual = [&](double readout) {
        const CalibrationEquations at = equations(readout);
        return -at.g(kOffset) / at.H(kOffset, kOffset);
      };
      const CalibrationEquations here = equations(0.0);
      if (!(here.H(kOffset, kOffset) > 0.0)) return;
      constexpr double kStep = 0.05;
      const double change = (residual(kStep) - residual(-kStep)) / (2.0 * kStep);
      if (!std::isfinite(change)) return;
      result.add(here.H(kOffset, kReadout) / here.H(kOffset, kOffset), change);
      ++result.points;
    });
    return result;
  }
};

TEST_F(ReadoutJacobian, IsThatOfNumericDifferencesWhereTheImagesAreOne) {
  const Deviation result = deviation(SE3(), keyframe_);
  EXPECT_GT(result.points, 50);
  EXPECT_LT(result.relative(), 0.03);
}

TEST_F(ReadoutJacobian, IsThatOfNumericDifferencesAtATurnedCamera) {
  const Deviation result = deviation(kRoll, view(kRoll));
  EXPECT_GT(result.points, 50);
  EXPECT_LT(result.relative(), 0.3);  // a quarter of the resolution, and the keyframe's gradients
}

/// Jacobian by the principal point of frame and keyframe together: the images are the same, but read with
/// other cameras.
TEST_F(JacobianTest, ByThePrincipalPointIsThatOfNumericDifferences) {
  const SE3 T = motion(0.02, 0.01, 0.1, 0.15, -0.2, 0.1);
  const ImagePyramid image = view(T);
  AlignmentResult aligned;
  aligned.T_frame_keyframe = T;
  for (int i = 0; i < 2; ++i) {
    Deviation result;
    forEachPixel([&](int u, int v) {
      const auto equations = [&](double off) {
        PinholeCamera camera = scene_.camera();
        (i == 0 ? camera.cx : camera.cy) += off;
        return calibrationEquations({referenceOf(u, v, {}, camera), image, options_, {}, {}, {}}, aligned,
                                    Vector6::Zero());
      };
      const auto residual = [&](double off) {
        const CalibrationEquations at = equations(off);
        return -at.g(kOffset) / at.H(kOffset, kOffset);
      };
      const CalibrationEquations here = equations(0.0);
      if (!(here.H(kOffset, kOffset) > 0.0)) return;
      constexpr double kStep = 4.0;  // [px] of the full image; it moves the pixel by a tenth of that
      const double change = (residual(kStep) - residual(-kStep)) / (2.0 * kStep);
      if (!std::isfinite(change)) return;
      result.add(here.H(kOffset, CalibrationEquations::kPrincipalPoint + i) / here.H(kOffset, kOffset),
                 change);
      ++result.points;
    });
    EXPECT_GT(result.points, 50) << i;
    EXPECT_LT(result.relative(), 0.3) << i;  // as above
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
