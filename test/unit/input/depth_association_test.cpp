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
constexpr Stamp kSecond = 1000 * kMillisecond;

/// The pairs in a form that can be compared.
std::vector<std::tuple<Stamp, Stamp, Stamp, Stamp, std::uint32_t>> rows(const Pairs& pairs) {
  std::vector<std::tuple<Stamp, Stamp, Stamp, Stamp, std::uint32_t>> result;
  for (const auto& pair : pairs)
    result.emplace_back(pair.stamp, pair.colour, pair.depth_stamp, pair.depth, pair.run);
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
  associator.finish();
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

/// The rule as the class states it, for streams that are known as a whole.
Pairs pairsByDefinition(const std::vector<Stamp>& colour, const std::vector<Stamp>& depth, Stamp max_skew,
                        Stamp min_depth_period) {
  std::vector<Stamp> used;
  for (const Stamp d : depth) {
    if (used.empty() || d - used.back() >= min_depth_period) used.push_back(d);
  }
  // The least time to the next one, as the ten times before tell.
  std::vector<Stamp> periods(used.size(), min_depth_period);
  for (std::size_t i = 10; i < used.size(); ++i) {
    Stamp shortest = used[i] - used[i - 1];
    for (std::size_t j = i - 9; j < i; ++j) shortest = std::min(shortest, used[j] - used[j - 1]);
    periods[i] = std::max(min_depth_period, shortest);
  }
  Pairs pairs;
  for (const Stamp c : colour) {
    Associator::Pair pair{c, c, kNoStamp, 0, kNoStamp, kFirstRun};
    Stamp best = max_skew + 1;
    for (std::size_t i = 0; i < used.size() && used[i] <= c; ++i) {
      if (c - used[i] > max_skew || 2 * (c - used[i]) >= periods[i]) continue;
      pair.depth_stamp = pair.depth = used[i];
      best = 0;
      break;
    }
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

/// A camera whose depth comes 14 ms before colour, and at times not at all, as freiburg1_xyz.
TEST(DepthAssociator, LearnsThePeriodOfDepthAndDoesNotWaitForOneThatIsFarther) {
  Associator associator;
  for (int i = 0; i < 100; ++i) {
    if (i % 7 != 6) associator.pushDepth(33 * i * kMillisecond, i);
    associator.pushColour((33 * i + 14) * kMillisecond, i);
    if (i < 20 || i % 7 == 6) continue;
    Pairs pairs;
    popAll(associator, pairs);
    ASSERT_FALSE(pairs.empty()) << i;
    EXPECT_EQ(pairs.back().stamp, (33 * i + 14) * kMillisecond);
    EXPECT_EQ(pairs.back().depth_stamp, 33 * i * kMillisecond);
  }
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

TEST(DepthAssociator, CountsWhatItLeavesOut) {
  Associator associator;
  for (const Stamp stamp : {100, 100, 133, 93, 166, -1})
    associator.pushColour(stamp < 0 ? kNoStamp : stamp * kMillisecond, stamp);
  for (const Stamp stamp : {100, 119, 120, 110, 160}) associator.pushDepth(stamp * kMillisecond, stamp);
  const StreamCounts colour = associator.colourCounts(), depth = associator.depthCounts();
  EXPECT_EQ(colour.accepted, 3u);
  EXPECT_EQ(colour.repeated, 1u);
  EXPECT_EQ(colour.late, 1u);
  EXPECT_EQ(colour.unstamped, 1u);
  EXPECT_EQ(depth.accepted, 3u);
  EXPECT_EQ(depth.too_soon, 1u) << "19 ms after the one before";
  EXPECT_EQ(depth.late, 1u);
}

/// Colour and depth of kCount images, with one image of either stream given another stamp.
TEST(DepthAssociator, OneWrongStampCostsOneImage) {
  constexpr int kCount = 60, kWrong = 30;
  const auto right = [](int i) { return 1000 * kSecond + i * 33 * kMillisecond; };
  for (const Stamp wrong : {right(kWrong) - 40 * kMillisecond, right(kWrong) - 3 * kSecond, 1 * kMillisecond,
                            right(kWrong) + 3600 * kSecond, (Stamp{1} << 32) * kSecond - 1, kNoStamp}) {
    for (const bool in_colour : {true, false}) {
      Associator associator;
      Pairs pairs;
      for (int i = 0; i < kCount; ++i) {
        const Stamp stamp = i == kWrong ? wrong : right(i);
        associator.pushColour(in_colour ? stamp : right(i), i);
        associator.pushDepth(in_colour ? right(i) : stamp, i);
        popAll(associator, pairs);
      }
      EXPECT_GE(pairs.size(), kCount - 2u) << "nothing waits for long";
      associator.finish();
      popAll(associator, pairs);
      ASSERT_EQ(pairs.size(), in_colour ? kCount - 1u : kCount);
      int without_depth = 0;
      for (const auto& pair : pairs) {
        EXPECT_EQ(pair.run, kFirstRun);
        EXPECT_EQ(pair.stamp, right(static_cast<int>(pair.colour)));
        without_depth += pair.depth_stamp == kNoStamp;
        EXPECT_TRUE(pair.depth_stamp == kNoStamp || pair.depth == pair.colour) << "stamped " << wrong;
      }
      EXPECT_EQ(without_depth, in_colour ? 0 : 1) << "stamped " << wrong;
      const StreamCounts counts = in_colour ? associator.colourCounts() : associator.depthCounts();
      EXPECT_EQ(counts.late + counts.unstamped, 1u);
    }
  }
}

/// Two rounds of the same bag. Whichever stream goes back first, there is no pair across the jump, no image
/// is lost or repeated, and one new run begins.
TEST(DepthAssociator, ANewRunBeginsWhenABagLoops) {
  constexpr Stamp kCount = 20, kPeriod = 33 * kMillisecond, kOffset = 1000 * kMillisecond;
  for (const int colour_lead : {-3, -1, 0, 1, 3}) {
    Associator associator;
    Pairs pairs;
    const auto stamp = [&](int i) { return kOffset + (i % kCount) * kPeriod; };
    for (int i = -3; i < 2 * kCount + 3; ++i) {
      const int c = i + std::max(0, colour_lead), d = i + std::max(0, -colour_lead);
      if (c >= 0 && c < 2 * kCount) associator.pushColour(stamp(c), c);
      if (d >= 0 && d < 2 * kCount) associator.pushDepth(stamp(d), d);
      popAll(associator, pairs);
    }
    associator.finish();
    popAll(associator, pairs);
    ASSERT_EQ(pairs.size(), 2u * kCount);
    for (int i = 0; i < 2 * kCount; ++i) {
      const auto& pair = pairs[static_cast<std::size_t>(i)];
      EXPECT_EQ(pair.colour, i);
      EXPECT_EQ(pair.run, i < kCount ? kFirstRun : kFirstRun + 1);
      EXPECT_EQ(pair.depth_stamp, pair.stamp) << "lead " << colour_lead;
      EXPECT_EQ(pair.depth, i) << "lead " << colour_lead;
    }
    EXPECT_EQ(associator.colourCounts().leftOut() + associator.depthCounts().leftOut(), 0u);
  }
}

/// A clock is set back by so little that the newest stamps alone do not tell it.
TEST(DepthAssociator, AClockThatIsSetBackLosesNoImage) {
  for (const Stamp step : {200 * kMillisecond, 300 * kMillisecond, 2 * kSecond, 3600 * kSecond}) {
    constexpr int kCount = 60, kSet = 30;
    Associator associator;
    Pairs pairs;
    for (int i = 0; i < kCount; ++i) {
      const Stamp stamp = 5000 * kSecond + i * 33 * kMillisecond - (i >= kSet ? step : 0);
      associator.pushColour(stamp, i);
      associator.pushDepth(stamp + 5 * kMillisecond, i);
      popAll(associator, pairs);
    }
    associator.finish();
    popAll(associator, pairs);
    ASSERT_EQ(pairs.size(), 1u * kCount);
    for (const auto& pair : pairs) {
      EXPECT_EQ(pair.run, pair.colour < kSet ? kFirstRun : kFirstRun + 1);
      EXPECT_EQ(pair.depth, pair.colour) << "step " << step;
    }
  }
}

TEST(DepthAssociator, DepthGoesOnAfterColourAloneHasGoneBack) {
  Associator associator;
  Pairs pairs;
  for (int i = 0; i < 40; ++i) {
    associator.pushColour((1000 + 33 * i) * kMillisecond - (i < 20 ? 0 : 15 * kMillisecond), i);
    associator.pushDepth((1000 + 33 * i) * kMillisecond, i);
    popAll(associator, pairs);
  }
  associator.finish();
  popAll(associator, pairs);
  ASSERT_EQ(pairs.size(), 40u) << "every stamp is after the one before";
  for (const auto& pair : pairs) EXPECT_EQ(pair.depth, pair.colour);
}

TEST(DepthAssociator, ResetForgetsStampsAndImages) {
  Associator associator;
  associator.pushColour(1000 * kMillisecond, 1);
  associator.reset();
  EXPECT_EQ(associator.waiting(), 0u);
  associator.pushColour(1, 2);
  associator.pushDepth(1, 3);
  const auto pair = associator.pop();
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->colour, 2);
  EXPECT_EQ(pair->run, kFirstRun + 1);
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
