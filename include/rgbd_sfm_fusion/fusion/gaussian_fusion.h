// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/fusion/provenance.h"
#include "rgbd_sfm_fusion/fusion/sensor_depth.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Two depth images made into one. All images have the same size.
struct GaussianFusion {
  GaussianDepth depth;
  cv::Mat_<std::uint8_t> provenance;    ///< values of Provenance
  cv::Mat_<std::uint8_t> disagreement;  ///< values of Disagreement
  ProvenanceCounts counts;
  std::uint64_t disagreeing = 0;  ///< [px]
};

/// By what an offset of the sensor's inverse depths moves SfM's of a pixel (x, y), which were aligned with
/// them elsewhere: base + x_gain x + y_gain y + relative / Z.
struct SensorOffsetGain {
  float base = 1.0f, x_gain = 0.0f, y_gain = 0.0f;  ///< [1], [1/px], [1/px]
  float relative = 0.0f;                            ///< [m]
};

/// Product of Gaussians per pixel (paper, Eq. 11 and 12); where there is one depth only, that one.
///
/// With `align_locally` and `test_agreement`, what SfM's errors of inverse depth have in common around a
/// pixel is taken off its depth before, and off its variance as far as it is known, by the sensor's depth of
/// some 100 pixels around (evidence.h). An error that the sensor has in all of them is taken over.
///
/// With `test_agreement` each pixel with both depths has a probability that they are of one surface: that of
/// the pixels around (evidence.h), times how much likelier their difference is between two depths of one
/// surface than between depths of two, which may be anywhere within Z. So a depth that is too uncertain to
/// contradict its neighbours says little, and many that agree around outweigh a few σ.
///
/// - From `min_inlier_probability` on the two are averaged. At a step the sensor's variance allows for the
///   other side of it, too; here it is that of the pixel's own surface, since a depth between the two sides
///   would be a halo.
/// - Less probable, the sensor's depth is taken. It is measured now and by a method of its own at each pixel,
///   while SfM's rests on matches and on a scene that has not moved since: its rare errors are gross, and
///   come in areas.
/// - Below one half, the step allowed for, the two contradict each other, which is flagged. The sensor's is
///   kept, or SfM's where the sensor's depth is nearer than it can measure.
///
/// What both have wrong in common, the scale and the offset that SfM takes from the sensor, is added to the
/// variance afterwards. The bias of the sensor's depth beyond its range counts when the two are weighted, and
/// is in the variance afterwards as a whole: all such depth has it, so that averaging does not end it.
///
/// @param sfm     [m]; empty = no SfM depth in this frame
/// @param buffer  its images, where of the right size, are overwritten and returned
/// @param gain    of what SfM alone has; without, it has the sensor's offset as the sensor has
GaussianFusion fuse(const SensorDepth& sensor, const GaussianDepth& sfm, const GaussianFusionOptions& options,
                    GaussianFusion buffer = {}, const SensorOffsetGain& gain = {});

}  // namespace rgbd_sfm_fusion
