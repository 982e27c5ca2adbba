// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/epipolar_stereo.h"

#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/image/brightness.h"
#include "rgbd_sfm_fusion/sampling.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kPattern = 2 * kPatternRadius + 1;
// Two images of a patch differ in brightness by the noise of pixels, and by as much again by a change that
// the whole patch shares: light, vignetting, reflections. With the shared change as an unknown, Σ d² becomes
// Σ d² - (Σ d)² / (n + 1), and an even slope tells little about its own place.
constexpr float kShared = 1.0F / (kPattern + 1);
constexpr int kLead = kPatternRadius + 1;  // samples before the first step: of the pattern, and for a slope

struct MatchLimits {
  float image_variance;       // [grey levels²] of the difference of two pixels
  float max_square_mismatch;  // mean square difference of a match, over image_variance
  float min_distinctness;
  float gain, offset;
};

struct BlockMatches {
  float inverse_depth[kLanes], variance[kLanes];
  bool matched[kLanes];
};

/// Searches for kLanes candidates side by side.
RGBD_SFM_FUSION_MULTIVERSION
void matchBlock(const std::uint8_t* keyframe, int keyframe_stride, const std::uint8_t* view, int view_stride,
                const SegmentBlock& s, const MatchLimits& limits, SearchedLines& lines, BlockMatches& out) {
  float u[kLanes], v[kLanes], before[kLanes], last[kLanes];
  int steps = 0;
  for (int l = 0; l < kLanes; ++l) steps = std::max(steps, s.before[l] + s.after[l] + 1);
  for (int l = 0; l < kLanes; ++l) {
    before[l] = static_cast<float>(s.before[l]);
    last[l] = static_cast<float>(s.before[l] + s.after[l]);
    u[l] = s.u[l] - before[l] * s.du[l], v[l] = s.v[l] - before[l] * s.dv[l];
  }
  float pattern[kPattern][kLanes];
  for (int m = 0; m < kPattern; ++m) {
    const auto step = static_cast<float>(m - kPatternRadius);
    float pu[kLanes], pv[kLanes];
    for (int l = 0; l < kLanes; ++l)
      pu[l] = s.keyframe_u[l] + step * s.eu[l], pv[l] = s.keyframe_v[l] + step * s.ev[l];
    sampleBlock(keyframe, keyframe_stride, pu, pv, pattern[m]);
    for (int l = 0; l < kLanes; ++l) pattern[m][l] = shown(limits.gain * pattern[m][l] + limits.offset);
  }

  // Line samples from one before the first pattern to one behind the last. A shorter segment's lanes stay
  // on their own last sample, which is inside the image.
  SearchedLines::Step* __restrict line = lines.samples.data(), * __restrict error = lines.errors.data();
  for (int k = 0; k < steps + 2 * kLead; ++k) {
    float su[kLanes], sv[kLanes];
    for (int l = 0; l < kLanes; ++l) {
      const float position = lesser(static_cast<float>(k), last[l] + 2.0F * kLead) - kLead;
      su[l] = u[l] + position * s.du[l];
      sv[l] = v[l] + position * s.dv[l];
    }
    sampleBlock(view, view_stride, su, sv, line[k].of);
  }

  float best[kLanes], best_step[kLanes];
  for (int l = 0; l < kLanes; ++l) best[l] = 1e30F, best_step[l] = 0.0F;
  for (int j = 0; j < steps; ++j) {
    const auto step = static_cast<float>(j);
    for (int l = 0; l < kLanes; ++l) {
      float squares = 0.0F, differences = 0.0F;
      for (int m = 0; m < kPattern; ++m) {
        const float difference = line[j + 1 + m].of[l] - pattern[m][l];
        squares += difference * difference;
        differences += difference;
      }
      const float sum = step <= last[l] ? squares - kShared * differences * differences : 1e30F;
      error[j].of[l] = sum;
      best_step[l] = sum < best[l] ? step : best_step[l];
      best[l] = lesser(sum, best[l]);
    }
  }
  float second[kLanes];
  for (int l = 0; l < kLanes; ++l) second[l] = 1e30F;
  for (int j = 0; j < steps; ++j) {
    const auto step = static_cast<float>(j);
    // Unrolled, it would not become vector code.
#pragma GCC unroll 1
    for (int l = 0; l < kLanes; ++l) {
      const float elsewhere = std::abs(step - best_step[l]) > 1.5F ? error[j].of[l] : 1e30F;
      second[l] = lesser(second[l], elsewhere);
    }
  }

  // Two steps of Gauss–Newton find the rest of a pixel: one with the samples at hand, one with new samples.
  float slope[kPattern][kLanes], mean_slope[kLanes], information[kLanes], shift[kLanes];
  for (int l = 0; l < kLanes; ++l) {
    const int first = static_cast<int>(best_step[l]) + 1;
    float square = 0.0F, product = 0.0F, slopes = 0.0F, differences = 0.0F;
    for (int m = 0; m < kPattern; ++m) {
      const float derivative = 0.5F * (line[first + m + 1].of[l] - line[first + m - 1].of[l]);
      const float difference = pattern[m][l] - line[first + m].of[l];
      slope[m][l] = derivative;
      square += derivative * derivative;
      product += derivative * difference;
      slopes += derivative;
      differences += difference;
    }
    mean_slope[l] = kShared * slopes;
    product -= mean_slope[l] * differences;
    information[l] = greater(square - mean_slope[l] * slopes, 1e-3F);
    shift[l] = lesser(greater(product / information[l], -1.0F), 1.0F);
  }
  // The new samples are interpolated between the samples of the line, which saves a quarter of all samples.
  float residual[kPattern][kLanes];
  for (int l = 0; l < kLanes; ++l) {
    const int whole = shift[l] < 0.0F ? -1 : 0;
    const float fraction = shift[l] - static_cast<float>(whole);
    const int first = static_cast<int>(best_step[l]) + 1 + whole;
    for (int m = 0; m < kPattern; ++m) {
      const float near = line[first + m].of[l];
      residual[m][l] = pattern[m][l] - (near + fraction * (line[first + m + 1].of[l] - near));
    }
  }
  for (int l = 0; l < kLanes; ++l) {
    float product = 0.0F;
    for (int m = 0; m < kPattern; ++m) product += (slope[m][l] - mean_slope[l]) * residual[m][l];
    const float correction = product / information[l];
    float squares = 0.0F, rests = 0.0F;
    for (int m = 0; m < kPattern; ++m) {
      const float rest = residual[m][l] - correction * slope[m][l];
      squares += rest * rest;
      rests += rest;
    }
    const float square = squares - kShared * rests * rests;
    const float total_shift = shift[l] + correction;
    // Relative to the centre of the search, along growing inverse depth.
    const float lambda = best_step[l] + total_shift - before[l];
    const float denominator = s.rate[l] * s.z[l] - lambda * s.z_rate[l];
    const float inverse_depth = s.inverse_depth[l] + lambda * s.z[l] / denominator;
    const float per_pixel = s.rate[l] * s.z[l] * s.z[l] / (denominator * denominator);
    const float variance =
        per_pixel * per_pixel * (s.geometric_variance[l] + limits.image_variance / information[l]);
    const float squared_shift = total_shift * total_shift, squared_correction = correction * correction;
    out.inverse_depth[l] = inverse_depth;
    out.variance[l] = variance;
    out.matched[l] = (square <= limits.max_square_mismatch * kPattern * limits.image_variance) &
                     (second[l] > limits.min_distinctness * best[l]) & (squared_shift <= 1.0F) &
                     (squared_correction <= 0.25F) & (best_step[l] > 0.0F) & (best_step[l] < last[l]) &
                     (inverse_depth > 0.0F) & (denominator > 0.0F);
  }
}

}  // namespace

const std::vector<StereoObservation>& EpipolarStereo::observe(const GreyImage& keyframe,
                                                              const CandidatesByBand& candidates,
                                                              const StereoView& view,
                                                              const KnownDepths& known,
                                                              const MappingOptions& options) {
  EpipolarPlan plan(camera_, view, known, options);
  segments_.setLongest(EpipolarPlan::longest(options));
  observations_.clear();
  const auto search = [&](const SearchBlock& block) { match(keyframe, view, options, block); };
  PlannedSegments planned;
  for (std::size_t band = 0; band < candidates.all.bands().size(); ++band) {
    plan.setBand(band);
    const bool has_turn = candidates.bands.has(static_cast<int>(band));
    StereoCandidates::select(
        (has_turn ? candidates.all : candidates.open).bands()[band],
        [&](const StereoCandidates::Block& block, bool* wanted) { plan.markPromising(block, wanted); },
        promising_);
    for (const StereoCandidates::Block& pixels : promising_) {
      plan.plan(pixels, planned);
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        if (!planned.isSearched(lane)) continue;
        const auto number = static_cast<int>(observations_.size());
        observations_.push_back(
            {pixels.pixel[lane], false, 0.0F, 0.0F, planned.by_readout[lane], planned.by_pose[lane]});
        if (const SearchBlock* full = segments_.add(planned.segments, lane, number)) search(*full);
      }
    }
  }
  segments_.empty(search);
  return observations_;
}

/// Searches the segments of a block, and completes their observations.
void EpipolarStereo::match(const GreyImage& keyframe, const StereoView& view, const MappingOptions& options,
                           const SearchBlock& block) {
  MatchLimits limits;
  limits.image_variance = 2.0F * options.image_noise * options.image_noise;
  limits.max_square_mismatch = options.max_mismatch * options.max_mismatch;
  limits.min_distinctness = options.min_distinctness;
  limits.gain = static_cast<float>(view.brightness.gain);
  limits.offset = static_cast<float>(view.brightness.offset);
  const auto steps = static_cast<std::size_t>(EpipolarPlan::longest(options) + 1 + 2 * kLead);
  if (lines_.samples.size() < steps) lines_.samples.resize(steps), lines_.errors.resize(steps);
  BlockMatches matches;
  matchBlock(keyframe[0], static_cast<int>(keyframe.step1()), (*view.image)[0],
             static_cast<int>(view.image->step1()), block.segments, limits, lines_, matches);
  for (std::size_t l = 0; l < block.count; ++l) {
    StereoObservation& observed = observations_[static_cast<std::size_t>(block.number[l])];
    observed.matched = matches.matched[l];
    observed.inverse_depth = matches.inverse_depth[l];
    observed.variance = matches.variance[l];
  }
}

}  // namespace rgbd_sfm_fusion
