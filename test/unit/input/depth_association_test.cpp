// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/depth_association.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <random>
#include <stdexcept>
#include <tuple>
#include <vector>

namespace rgbd_sfm_fusion {
namespace {

/// The payload of an image is its own stamp, so that a mix-up shows.
using Associator = DepthAssociator<Stamp, Stamp>;
using Pairs = std::vector<Associator::Pair>;

constexpr Stamp kMillisecond = 1000000;

/// What can be compared.
std::vector<std::tuple<Stamp, Stamp, Stamp, Stamp, bool>> rows(const Pairs& pairs) {
  std::vector<std::tuple<Stamp, Stamp, Stamp, Stamp, bool>> result;
  for (const auto& pair : pairs)
    result.emplace_back(pair.stamp, pair.colour, pair.depth_stamp, pair.depth, pair.starts_anew);
  return result;
}

void popAll(Associator& associator, Pairs& pairs) {
  while (auto pair = associator.pop()) pairs.push_back(*pair);
}

/// Merges the two streams in a random order.
Pairs runInterleaved(const std::vector<Stamp>& colour, const std::vector<Stamp>& depth, std::mt19937& random,
                     const AssociationOptions& options) {
  Associator associator(options);
  Pairs pairs;
  std::size_t c = 0, d = 0;
  while (c < colour.size() || d < depth.size()) {
    const bool take_colour = d == depth.size() || (c < colour.size() && random() % 2 == 0);
    if (take_colour) {
      associator.pushColour(colour[c], colour[c]);
      ++c;
    } else {
      associator.pushDepth(depth[d], depth[d]);
      ++d;
    }
    popAll(associator, pairs);
  }
  associator.flush();
  popAll(associator, pairs);
  return pairs;
}

/// A stream with jitter, dropouts and bursts.
std::vector<Stamp> stamps(std::mt19937& random, int count) {
  std::vector<Stamp> result;
  Stamp stamp = static_cast<Stamp>(random() % 40) * kMillisecond;
  for (int i = 0; i < count; ++i) {
    const auto kind = random() % 10;
    const Stamp step = kind == 0 ? 150 : kind == 1 ? 3 : 25 + static_cast<Stamp>(random() % 17);
    stamp += step * kMillisecond;
    result.push_back(stamp);
  }
  return result;
}

/// The rule as the class states it, without a thought for streaming.
Pairs pairsByDefinition(const std::vector<Stamp>& colour, const std::vector<Stamp>& depth, Stamp max_skew,
                        Stamp min_depth_period) {
  std::vector<Stamp> used;
  for (const Stamp d : depth) {
    if (used.empty() || d - used.back() >= min_depth_period) used.push_back(d);
  }
  Pairs pairs;
  for (const Stamp c : colour) {
    Associator::Pair pair{c, c, kNoStamp, 0, false};
    Stamp best = max_skew + 1;
    for (const Stamp d : used) {
      if (std::abs(d - c) >= best) continue;
      best = std::abs(d - c);
      pair.depth_stamp = pair.depth = d;
    }
    pairs.push_back(pair);
  }
  return pairs;
}

TEST(DepthAssociator, AnyInterleavingGivesThePairsOfTheDefinition) {
  AssociationOptions options;
  options.max_waiting = 1000;
  std::mt19937 random(1);
  for (int run = 0; run < 300; ++run) {
    options.max_skew = 1e-3 * static_cast<double>(random() % 45);
    options.min_depth_period = 1e-3 * static_cast<double>(random() % 45);
    const auto colour = stamps(random, 60), depth = stamps(random, 60);
    const Pairs expected = pairsByDefinition(colour, depth, association::nanoseconds(options.max_skew),
                                             association::nanoseconds(options.min_depth_period));
    for (int order = 0; order < 10; ++order)
      ASSERT_EQ(rows(runInterleaved(colour, depth, random, options)), rows(expected)) << "run " << run;
  }
}

TEST(DepthAssociator, WithinItsQueuesTheOrderOfArrivalDoesNotMatter) {
  AssociationOptions options;
  std::vector<Stamp> colour, depth;
  for (Stamp i = 0; i < 200; ++i) {
    colour.push_back(i * 33 * kMillisecond);
    depth.push_back(i * 33 * kMillisecond + 12 * kMillisecond);
  }
  const Pairs expected = pairsByDefinition(colour, depth, 20 * kMillisecond, 20 * kMillisecond);
  for (const std::size_t lag : {0u, 1u, 5u, 29u}) {
    for (const bool colour_lags : {false, true}) {
      Associator associator(options);
      Pairs pairs;
      for (std::size_t i = 0; i < colour.size() + lag; ++i) {
        const std::size_t late = i - lag;  // wraps to a huge number before the late stream starts
        const std::size_t c = colour_lags ? late : i, d = colour_lags ? i : late;
        if (c < colour.size()) associator.pushColour(colour[c], colour[c]);
        if (d < depth.size()) associator.pushDepth(depth[d], depth[d]);
        popAll(associator, pairs);
        EXPECT_LE(associator.waiting(), options.max_waiting);
      }
      associator.flush();
      popAll(associator, pairs);
      EXPECT_EQ(rows(pairs), rows(expected)) << "lag " << lag << (colour_lags ? " of colour" : " of depth");
    }
  }
}

TEST(DepthAssociator, ReleasesAsSoonAsNoLaterDepthCanBeNearer) {
  Associator associator;
  associator.pushDepth(91 * kMillisecond, 1);
  associator.pushColour(100 * kMillisecond, 2);  // 9 ms is less than half of 20 ms
  ASSERT_TRUE(associator.pop());
  associator.pushDepth(123 * kMillisecond, 3);
  associator.pushColour(133 * kMillisecond, 4);  // 10 ms is not
  EXPECT_FALSE(associator.pop());
  associator.pushDepth(143 * kMillisecond, 5);
  const auto pair = associator.pop();
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->depth, 3) << "of two as near, the earlier";
}

TEST(DepthAssociator, FlushAndFullQueuesReleaseWhatWaits) {
  AssociationOptions options;
  options.max_waiting = 3;
  Associator associator(options);
  Pairs pairs;
  for (Stamp i = 1; i <= 10; ++i) {
    associator.pushColour(i * 33 * kMillisecond, i);
    EXPECT_LE(associator.waiting(), 3u);
  }
  popAll(associator, pairs);
  EXPECT_EQ(pairs.size(), 7u);
  associator.flush();
  popAll(associator, pairs);
  ASSERT_EQ(pairs.size(), 10u);
  for (Stamp i = 1; i <= 10; ++i) {
    EXPECT_EQ(pairs[static_cast<std::size_t>(i - 1)].colour, i);
    EXPECT_EQ(pairs[static_cast<std::size_t>(i - 1)].depth_stamp, kNoStamp);
  }
}

TEST(DepthAssociator, IgnoresRepeatedStampsAndTooQuickDepth) {
  Associator associator;
  EXPECT_EQ(associator.pushColour(0, 1), Arrival::kAccepted);
  EXPECT_EQ(associator.pushColour(0, 2), Arrival::kIgnored);
  EXPECT_EQ(associator.pushDepth(0, 1), Arrival::kAccepted);
  EXPECT_EQ(associator.pushDepth(0, 2), Arrival::kIgnored);
  EXPECT_EQ(associator.pushDepth(19 * kMillisecond, 3), Arrival::kIgnored);
  EXPECT_EQ(associator.pushDepth(20 * kMillisecond, 4), Arrival::kAccepted);
}

/// Two rounds of the same bag. Whichever stream is the first to go back: no pair across the jump, no colour
/// image lost or repeated, one new start, and depth missing only while the streams are in different rounds.
TEST(DepthAssociator, StartsAnewWhenABagLoops) {
  constexpr Stamp kCount = 20, kPeriod = 33 * kMillisecond, kOffset = 1000 * kMillisecond;
  for (const int colour_lead : {-3, -1, 0, 1, 3}) {
    Associator associator;
    Pairs pairs;
    int went_back = 0;
    const auto stamp = [&](int i) { return kOffset + (i % kCount) * kPeriod; };
    for (int i = -3; i < 2 * kCount + 3; ++i) {
      const int c = i + std::max(0, colour_lead), d = i + std::max(0, -colour_lead);
      if (c >= 0 && c < 2 * kCount) went_back += associator.pushColour(stamp(c), c) == Arrival::kWentBack;
      if (d >= 0 && d < 2 * kCount) went_back += associator.pushDepth(stamp(d), d) == Arrival::kWentBack;
      popAll(associator, pairs);
    }
    associator.flush();
    popAll(associator, pairs);
    EXPECT_EQ(went_back, 2);
    ASSERT_EQ(pairs.size(), 2u * kCount);
    int without_depth = 0;
    for (int i = 0; i < 2 * kCount; ++i) {
      const auto& pair = pairs[static_cast<std::size_t>(i)];
      EXPECT_EQ(pair.colour, i);
      EXPECT_EQ(pair.starts_anew, i == kCount);
      if (pair.depth_stamp == kNoStamp) {
        ++without_depth;
      } else {
        EXPECT_EQ(pair.depth, i) << "lead " << colour_lead;
      }
    }
    EXPECT_LE(without_depth, colour_lead == 0 ? 0 : 2 * std::abs(colour_lead) + 1);
  }
}

TEST(DepthAssociator, DepthGoesOnAfterColourAloneHasGoneBack) {
  Associator associator;
  Pairs pairs;
  Stamp depth = 0;
  for (const Stamp colour : {100, 133, 120, 153, 186, 219}) {
    associator.pushColour(colour * kMillisecond, colour);
    depth += 33;
    associator.pushDepth((depth + 67) * kMillisecond, depth);
    popAll(associator, pairs);
  }
  associator.flush();
  popAll(associator, pairs);
  ASSERT_EQ(pairs.size(), 6u);
  EXPECT_TRUE(pairs[2].starts_anew);
  EXPECT_NE(pairs[5].depth_stamp, kNoStamp);
}

TEST(DepthAssociator, ResetForgetsStampsAndImages) {
  Associator associator;
  associator.pushColour(1000 * kMillisecond, 1);
  associator.reset();
  EXPECT_EQ(associator.waiting(), 0u);
  EXPECT_EQ(associator.pushColour(1, 2), Arrival::kAccepted);
  associator.pushDepth(1, 3);
  const auto pair = associator.pop();
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->colour, 2);
  EXPECT_FALSE(pair->starts_anew);
}

TEST(DepthAssociator, RefusesOptionsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {-1e-9, 1.1, nan, std::numeric_limits<double>::infinity()}) {
    AssociationOptions options;
    options.max_skew = bad;
    EXPECT_THROW(Associator{options}, std::invalid_argument);
    options = {};
    options.min_depth_period = bad;
    EXPECT_THROW(Associator{options}, std::invalid_argument);
  }
  AssociationOptions options;
  options.max_waiting = 0;
  EXPECT_THROW(Associator{options}, std::invalid_argument);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
