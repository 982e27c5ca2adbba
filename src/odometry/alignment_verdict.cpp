// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/alignment_verdict.h"

#include <algorithm>

namespace rgbd_sfm_fusion {
namespace {

// To recognise a keyframe, so much of it has to be in view. Of its points in view so much has to have the
// right brightness, and of the squares with sensor depth the right depth. One of many starts may end where
// half of the points fit by chance. Of the squares, a wrong place has 0.0 to 0.55, the right one 0.8 to 1.0,
// less what a person hides.
constexpr double kRecognised = 0.6;
// If less fits, something is in front. Of the points in view, recordings have 0.62 to 0.99, and 0.80 or more
// in nine of ten frames. With a person in front of a tenth of the image it is 0.75 (each point counted once),
// as clothes have more points than a room. Half of a keyframe in view, from another side, has as few, but not
// so of the squares with depth.
constexpr double kUnobstructed = 0.8;
constexpr double kUnobstructedByDepth = (1.0 + kUnobstructed) / 2.0;  // half as many need not fit

}  // namespace

bool fits(const AlignmentResult& result, const TrackingOptions& options) {
  const auto least = static_cast<double>(options.min_share_of_good_points);
  return result.is_solvable && result.share_good >= least &&
         0.5 * (result.share_good + result.share_of_depth) >= least &&
         isPlausible(result.photometry.brightness);
}

bool isRecognised(const AlignmentResult& result, const TrackingOptions& options) {
  // In another light, more points fit by chance: here the gain may be half as far from 1, in logarithms.
  Brightness twice_as_far = result.photometry.brightness;
  twice_as_far.gain *= twice_as_far.gain;
  return fits(result, options) && isPlausible(twice_as_far) &&
         std::min({result.share_in_view, result.share_good, result.share_of_depth}) >= kRecognised;
}

double agreement(const AlignmentResult& result) {
  return result.is_solvable ? result.share_in_view * (result.share_good + result.share_of_depth) / 2.0 : 0.0;
}

bool isDoubtful(const AlignmentResult& result) {
  return result.share_good < kUnobstructed && result.share_of_depth < kUnobstructedByDepth;
}

bool isObstructed(const AlignmentResult& result) {
  return isDoubtful(result) && result.share_in_view >= kRecognised;
}

}  // namespace rgbd_sfm_fusion
