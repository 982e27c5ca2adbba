// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "rgbd_sfm_fusion/fusion/evidence.h"
#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"
#include "rgbd_sfm_fusion/fusion/rough_logarithm.h"
#include "rgbd_sfm_fusion/image/inverse_depth.h"

namespace rgbd_sfm_fusion {

constexpr int kPerSide = 2;  ///< rows and columns of neighbours to each side of a pixel
constexpr int kMostNeighbours = (2 * kPerSide + 1) * (2 * kPerSide + 1) - 1;  ///< 24

/// A pixel's neighbours are the 24 pixels that are 0, 1/2 or 1 times `radius` away by row and column. This
/// counts those whose depth differs by less than kSurfaceStep.
/// @param radius  [px] an even number
int agreeingNeighbours(const DepthImage& depth, const cv::Point& pixel, int radius);

/// [px] Near neighbours tell of wild matches: these have few that agree. They are as far away as published
/// depth has been smoothed.
constexpr int kNearRadius = Evidence::kCell;
/// [px] Wide neighbours tell where a surface ends. Along a contour, SfM has a band of depth: smoothing takes
/// it as far as kNearRadius to either side. Wide neighbours are twice the band's width away. So of a pixel on
/// a contour, those along the contour agree, and of a pixel in the middle of a surface, those all around.
constexpr int kContourBand = 2 * kNearRadius, kWideRadius = 2 * kContourBand;

/// How many neighbours of a pixel agree with it.
struct Agreement {
  int near = 0, wide = 0;
};

Agreement agreementAt(const DepthImage& depth, const cv::Point& pixel);

/// How far SfM depth is off where it is of another surface than the pixel shows: a wild match, or a step.
/// Both sides of an occluding contour get the depth of the surface in front. The contour is known to some
/// pixels only: patterns straddle it, points are rounded to pixels, poses are uncertain, and rows are read
/// while the camera moves. So the depth of a pixel is a mixture of its own surface and others, and its
/// variance contains their second moment about it.
///
/// The moment is learned at pixels that the sensor sees, for each number of near and of wide neighbours that
/// agree.
///
/// A hole of the sensor says more. Where the sensor sees nearly all that SfM has at some depth, SfM's depth
/// in a hole is rather of another surface, and nearly always of one behind: of what is farther, the sensor
/// misses more. Bayes' rule with the shares that the sensor misses, by depth, gives the moment in a hole.
class OtherSurfaces {
 public:
  /// Learns from a frame. Earlier frames count for less.
  /// @param points    of the frame
  /// @param sfm       [m] of the frame, before fusion
  /// @param sensor    depth in range is used
  void observe(const SfmPoints& points, const DepthImage& sfm, const SensorDepth& sensor);

  /// [Z²] Mean square of errors, with those below 3 sigma as 0 and none larger than Z, where the sensor sees.
  double whereSeen(const Agreement& agreement) const;

  /// [Z²] The same in a hole of the sensor.
  /// @param where_seen  [Z²]
  /// @param z           [m] SfM's depth
  float inHole(float where_seen, float z) const {
    const float place = placeOf(z);
    const auto before = static_cast<std::size_t>(place);
    const std::size_t after = std::min(before + 1, kDepths - 1);
    const float share = place - static_cast<float>(before);
    const float likelihood = (1.0F - share) * likelihoods_[before] + share * likelihoods_[after];
    return where_seen * likelihood / (1.0F + where_seen * (likelihood - 1.0F));
  }

 private:
  /// Sums over pixels, by class. What was added before counts less with each frame.
  template <std::size_t kClasses>
  struct Sums {
    std::array<double, kClasses> pixels{}, values{};
    std::array<double, kClasses> frame_pixels{}, frame_values{};

    void add(std::size_t index, double value);
    void endFrame();
  };

  static constexpr std::size_t kDepths = 128;  // steps of depth, 1 m in the middle: 4 cm to 24 m

  /// Place of a depth among the steps of depth.
  static float placeOf(float z) {
    constexpr auto kEnd = static_cast<float>(kDepths - 1);
    return std::min(std::max(roughLogarithm(z) / kSurfaceStep + kEnd / 2.0F, 0.0F), kEnd);
  }
  static std::size_t classOf(const Agreement& agreement) {
    return static_cast<std::size_t>(agreement.near * (kMostNeighbours + 1) + agreement.wide);
  }
  void findLikelihoods();

  Sums<(kMostNeighbours + 1) * (kMostNeighbours + 1)> moments_;
  Sums<kDepths> unseen_;
  /// How much likelier a farther surface makes a hole than a surface at this depth does.
  std::array<float, kDepths> likelihoods_ = [] {
    std::array<float, kDepths> even{};
    even.fill(1.0F);
    return even;
  }();
};

/// Limits of depth that SfM alone has.
struct SfmOnlyLimits {
  double min_probability;     ///< [1] that the depth is of the pixel's own surface: others are taken to be a
                              ///< usual step away
  double max_relative_sigma;  ///< [1] σ / Z
};

/// Adds what other surfaces do to the variance of SfM-only depths, and drops depths beyond the limits. Depth
/// that was kept against a sensor that measures too near (Disagreement::kSfmKept) stays as it is.
/// @param points  that were fused
/// @param sfm     [m] of the frame, before fusion
void judgeSfmOnly(const SfmPoints& points, const DepthImage& sfm, const OtherSurfaces& others,
                  const SfmOnlyLimits& limits, FusedDepth& fused);

/// @param measured  [out] of the same size: 1 where there is depth, else 0
void markMeasured(const DepthImage& depth, cv::Mat_<std::uint8_t>& measured);

/// Marks the rims of the sensor's holes, where SfM's depth may belong to either side: pixels that have no
/// sensor depth, but sensor depth near. Against exact truth, a fifth of this SfM depth is more than 5 sigma
/// off, and no variance tells which.
/// @param measured  1 where the sensor has depth, else 0
/// @param width     [px] from sensor depth within which a pixel is near to it; 0: none is
/// @param marked    of the same size; set to 1 at the rims
void markRims(const cv::Mat_<std::uint8_t>& measured, int width, cv::Mat_<std::uint8_t>& marked);

}  // namespace rgbd_sfm_fusion
