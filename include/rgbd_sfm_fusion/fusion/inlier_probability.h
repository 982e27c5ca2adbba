// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "rgbd_sfm_fusion/fusion/gaussian_fusion.h"

namespace rgbd_sfm_fusion {

/// A pixel's neighbours are the 24 pixels that are 0, 1 or 2 times `spacing` away by row and column. This
/// counts those whose depth differs by less than 5 %.
/// @param spacing  [px]
int agreeingNeighbours(const DepthImage& depth, const cv::Point& pixel, int spacing);

constexpr int kMostNeighbours = 24;
/// [px] Near neighbours tell of wild matches: these have few that agree, and published depth has been
/// smoothed over them.
constexpr int kNearSpacing = 2;
/// [px] Wide neighbours tell where a surface ends. Along a contour, SfM has a band of depth of some 8 px: the
/// gradient, the pattern and smoothing are a few pixels wide each. So of a pixel on a contour, wide
/// neighbours along the contour agree, and of a pixel in the middle of a surface, those all around. 8 px was
/// chosen among a few values, on recordings.
constexpr int kWideSpacing = 8;

/// How many neighbours of a pixel agree with it.
struct Agreement {
  int near = 0, wide = 0;
};

Agreement agreementAt(const DepthImage& depth, const cv::Point& pixel);

/// How wrong SfM depth is, by the number of neighbours that agree with it. It is learned at pixels that the
/// sensor sees, and used at pixels that the sensor does not see. It depends on the camera's motion, on the
/// calibration and on the scene: of pixels with a single near neighbour that agrees, a quarter is wild in a
/// rendered room, and two thirds at a recorded desk.
///
/// Most large errors are steps to another surface. Both sides of an occluding contour get the depth of the
/// surface in front. The contour is known to some pixels only: patterns straddle it, points are rounded to
/// pixels, poses are uncertain, and rows are read while the camera moves. So the depth of a pixel is a
/// mixture of its own surface and others, and its variance contains their second moment about it.
class AgreementStatistics {
 public:
  static constexpr float kRight = 0.1F;  ///< [1] a depth counts as right if its relative error is smaller

  /// Learns from a frame. Earlier frames count for less.
  /// @param points           of the frame
  /// @param sfm              [m] of the frame, before fusion
  /// @param farthest         [m] of the sensor depth that is used for learning
  /// @param min_probability  less probable pixels tell nothing of steps, as they will be dropped
  void observe(const SfmPoints& points, const DepthImage& sfm, float farthest, double min_probability);

  /// Probability that a depth is right to a tenth.
  double inlierProbability(const Agreement& agreement) const;

  /// [Z²] Mean square of errors, with those below 3 sigma as 0 and none larger than Z.
  double stepVariance(int wide) const;

 private:
  /// Means of a value, by classes of pixels. A class has so many numbers of near neighbours, and so many of
  /// wide ones.
  template <std::size_t kNear, std::size_t kWide>
  class Means {
   public:
    void add(const Agreement& agreement, double value);
    /// What was added before counts less from now on.
    void endFrame();
    /// @param prior_pixels  that the prior counts for
    double mean(const Agreement& agreement, double prior, double prior_pixels) const;

   private:
    struct Sum {
      double pixels = 0.0, value = 0.0;
    };
    static std::size_t classOf(const Agreement& agreement);

    std::array<Sum, (kMostNeighbours / kNear + 1) * (kMostNeighbours / kWide + 1)> before_, frame_;
  };

  Means<3, 6> outliers_;
  Means<kMostNeighbours + 1, 3> steps_;  // all numbers of near neighbours are one class
};

/// Limits of depth that SfM alone has.
struct SfmOnlyLimits {
  double min_probability;     ///< [1] that the depth is right to a tenth
  double max_relative_sigma;  ///< [1] σ / Z
};

/// Drops SfM-only depths beyond the limits. The variance of the others is that of a mixture with other
/// surfaces.
/// @param sfm  [m] of the frame, before fusion
void judgeSfmOnly(const DepthImage& sfm, const AgreementStatistics& statistics, const SfmOnlyLimits& limits,
                  GaussianFusion& fusion);

/// Drops SfM depth at the rims of the sensor's holes, where it may belong to either side: of pixels that have
/// no sensor depth, but sensor depth near. Against exact truth, a fifth of this SfM depth is more than 5
/// sigma off, and no variance tells which.
/// @param sensor  [m], [m^2] H x W, NaN = none
/// @param width   [px] from sensor depth within which a pixel is near to it; 0: none is
/// @param sfm     H x W, NaN = none
void dropAtRims(const GaussianDepth& sensor, int width, GaussianDepth& sfm);

}  // namespace rgbd_sfm_fusion
