// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/fusion/fusion_options.h"
#include "rgbd_sfm_fusion/fusion/provenance.h"
#include "rgbd_sfm_fusion/fusion/sensor_depth.h"
#include "rgbd_sfm_fusion/fusion/sfm_points.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Two depth images made into one. All images have the same size.
struct FusedDepth {
  GaussianDepth depth;                  ///< [m], [m^2]
  cv::Mat_<std::uint8_t> provenance;    ///< values of Provenance
  cv::Mat_<std::uint8_t> disagreement;  ///< values of Disagreement
  ProvenanceCounts counts;
  std::uint64_t disagreeing = 0;  ///< [px]
};

/// SfM's inverse depths are aligned with the sensor's in the overlap. So an offset of the sensor's inverse
/// depths moves SfM's, too: at pixel (x, y), by base + x_gain x + y_gain y + relative / Z times the offset.
struct SensorOffsetGain {
  float base = 1.0f, x_gain = 0.0f, y_gain = 0.0f;  ///< [1], [1/px], [1/px]
  float relative = 0.0f;                            ///< [m]
};

/// Product of Gaussians per pixel (paper, Eq. 11 and 12). Where a pixel has one depth only, that depth is
/// taken.
///
/// With `align_locally` and `test_agreement`, SfM's depth is corrected before the two are averaged; the test
/// compares it uncorrected. The sensor's depth of some 100 pixels around shows the error that SfM's inverse
/// depths share there (evidence.h). The variance becomes smaller by what is known of this error. If the
/// sensor errs alike in all of these pixels, SfM's depth takes over the sensor's error.
///
/// With `test_agreement`, each pixel with both depths has a probability that the two are of one surface. The
/// odds of the pixels around (evidence.h) are multiplied by a likelihood ratio: how likely the difference of
/// the two depths is on one surface, over how likely it is if SfM's depth is of another surface, anywhere
/// within Z. So a depth that is too uncertain to contradict the other one says little, and many pixels that
/// agree around outweigh a difference of a few σ.
///
/// - From `min_inlier_probability` on (at least 1/2), the two are averaged. At a step, the sensor's variance
///   allows for the other side of the step, too. This comparison and the average leave that part out, since a
///   depth between the two sides would be a halo.
/// - Below it, the sensor's depth is taken. The sensor measures now, and at each pixel by itself. SfM's depth
///   rests on matches, and on a scene that has not moved since: errors of SfM are rare, but gross, and come
///   in areas.
/// - Below 1/2, with the step allowed for, the two contradict each other, and the pixel is flagged.
///   The sensor's depth is kept; SfM's is kept where the sensor's depth is nearer than the sensor can
///   measure.
///
/// SfM takes its scale and its offset from the sensor, so both depths share the errors of these two. They are
/// added to the variance afterwards. The sensor's depth beyond its range is biased. The bias counts when the
/// two depths are weighted, and the fused variance has the whole of it, even if SfM's alone is smaller: the
/// two are averaged only where they agree, so what is averaged is biased alike. With Eq. 12 alone, NEES25 in
/// a hallway is 4.1 instead of 2.7 at 8 m.
///
/// @param sfm     collected with `sensor`, and aligned to metres; empty = no SfM depth in this frame
/// @param buffer  images of the right size are overwritten and returned
/// @param gain    for pixels that SfM alone sees; by default, the sensor's offset moves them as it moves the
///                sensor's depth
FusedDepth fuse(const SensorDepth& sensor, const SfmPoints& sfm, const GaussianFusionOptions& options,
                FusedDepth buffer = {}, const SensorOffsetGain& gain = {});

/// The sensor's depth alone, flagged where SfM contradicts it. Pixels where the sensor's depth is too near
/// stay empty.
/// @param contradicting  what fuse() made of the two
/// @param buffer         as fuse() takes it
FusedDepth sensorAlone(const SensorDepth& sensor, const FusedDepth& contradicting, FusedDepth buffer = {});

/// Where nothing else has depth, takes strays that may be right, with a sigma that says how little they tell.
/// So whatever else has depth wins, and is not averaged with them.
/// @param fused  with all of its counts, those of the pixels without depth as well
void takeStrays(const SensorDepth& sensor, FusedDepth* fused);

}  // namespace rgbd_sfm_fusion
