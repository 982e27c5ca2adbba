// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/fusion/provenance.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Two depth images made into one. All images have the same size.
struct GaussianFusion {
  GaussianDepth depth;
  cv::Mat_<std::uint8_t> provenance;    ///< values of Provenance
  cv::Mat_<std::uint8_t> disagreement;  ///< values of Disagreement
  ProvenanceCounts counts;
  std::uint64_t disagreeing = 0;  ///< [px]
  bool sfm_rejected = false;      ///< too much of the overlap disagrees: pose or scale is wrong
  cv::Mat_<std::uint8_t> votes;   ///< work space
};

/// Sensor depth of a frame, with what tells whether SfM's may contradict it.
struct SensorDepth {
  GaussianDepth depth;               ///< [m]; NaN = none
  cv::Mat_<float> surface_variance;  ///< [m^2] as if no step were near; empty: that of `depth`. NaN beside a
                                     ///< mean: its surface is in doubt, and it is averaged with nothing
  DepthImage raw;                    ///< [m] as measured, in range or not; empty: not known
  DepthNoiseModel noise;             ///< of it; what is nearer than its range is no measurement

  /// Of the pixel's own surface.
  const cv::Mat_<float>& surfaceVariance() const {
    return surface_variance.empty() ? depth.variance : surface_variance;
  }
};

/// Product of Gaussians per pixel (paper, Eq. 11 and 12); where there is one depth only, that one.
///
/// With `align_locally` and `test_agreement`, what SfM's errors of inverse depth have in common around a
/// pixel is taken off its depth before, and off its variance as far as it is known, by the sensor's depth of
/// some 100 pixels around (common_errors.h). An error that the sensor has in all of them is taken over.
///
/// Two depths are averaged where SfM's agrees (`max_chi_squared`) with the surface that the sensor sees in
/// that pixel. At a step the sensor's variance allows for the other side of it, too: a depth that only this
/// makes likely is not averaged, which would put a halo between two surfaces; the sensor's is taken.
///
/// Agreement by chance or by ignorance is none: the sensor's depth is taken, too, where SfM's is so uncertain
/// that it would not contradict a surface a tenth nearer, and where fewer than 12 pixels of an area of 20 x
/// 20 have both depths. Such handfuls contradict the sensor three times as often as others.
///
/// Depths that differ by more than chance allows, steps included, contradict each other: one of them is
/// wrong, and is flagged. Where two fifths of an area of 20 x 20 pixels do so, its middle and what is around
/// that count as contradicting, since the rest of it agrees by chance or by large variance. Which one is
/// kept:
/// - the sensor's. It is measured now and by a method of its own at each pixel, while SfM's rests on matches
///   and on a scene that has not moved since: its rare errors are gross, and come in areas;
/// - SfM's, where the sensor's depth is nearer than it can measure.
///
/// What both have wrong in common, the scale that SfM takes from the sensor, is added to the variance
/// afterwards. The bias of the sensor's depth beyond its range counts when the two are weighted, and is in
/// the variance afterwards as a whole: all such depth has it, so that averaging does not end it.
///
/// @param sfm     [m]; empty = no SfM depth in this frame
/// @param buffer  its images, where of the right size, are overwritten and returned
GaussianFusion fuse(const SensorDepth& sensor, const GaussianDepth& sfm, const GaussianFusionOptions& options,
                    GaussianFusion buffer = {});

}  // namespace rgbd_sfm_fusion
