// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/time_line.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace rgbd_sfm_fusion {
namespace {

constexpr Stamp kSecond = 1'000'000'000;
constexpr Stamp kPeriod = 33'000'000;

/// What a line does with stamps. Each stamp's image is its place in the stream.
struct Outcome {
  std::vector<int> images;      ///< in the order in which they come out
  std::vector<int> went_back;   ///< the first image of each new line
  std::size_t largest_lag = 0;  ///< images that were held at a time
  StreamCounts counts;
};

Outcome run(const std::vector<Stamp>& stamps) {
  TimeLine<int> line;
  Outcome outcome;
  const auto take = [&](const TimeLine<int>::Accepted& accepted) {
    if (accepted.line_before) outcome.went_back.push_back(accepted.images.front().image);
    for (const auto& item : accepted.images) outcome.images.push_back(item.image);
  };
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    take(line.push(stamps[i], static_cast<int>(i)));
    outcome.counts = line.counts();
    outcome.largest_lag =
        std::max(outcome.largest_lag, i + 1 - outcome.counts.accepted - outcome.counts.leftOut());
  }
  take(line.finish());
  outcome.counts = line.counts();
  EXPECT_EQ(outcome.counts.accepted, outcome.images.size());
  EXPECT_EQ(outcome.counts.accepted + outcome.counts.leftOut(), stamps.size())
      << "each image is counted once";
  return outcome;
}

std::vector<Stamp> steadily(Stamp from, int count) {
  std::vector<Stamp> stamps;
  for (int i = 0; i < count; ++i) stamps.push_back(from + i * kPeriod);
  return stamps;
}

std::vector<Stamp> joined(std::vector<Stamp> a, const std::vector<Stamp>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::vector<int> all(std::size_t count) {
  std::vector<int> images(count);
  for (std::size_t i = 0; i < count; ++i) images[i] = static_cast<int>(i);
  return images;
}

TEST(TimeLine, RisingStampsComeOutAtOnce) {
  const Outcome outcome = run(joined(steadily(5 * kSecond, 30), steadily(14 * kSecond, 30)));
  EXPECT_EQ(outcome.images, all(60)) << "gaps of seconds are nothing unusual";
  EXPECT_EQ(outcome.largest_lag, 0u);
}

TEST(TimeLine, OvertakenImagesAreLeftOut) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Stamp> stamps = steadily(1000 * kSecond, 100);
    for (std::size_t i = 0; i + 4 < stamps.size(); ++i) {
      if (random() % 6 == 0) std::swap(stamps[i], stamps[i + 1 + random() % 3]);
    }
    const Outcome outcome = run(stamps);
    EXPECT_TRUE(outcome.went_back.empty());
    for (std::size_t i = 1; i < outcome.images.size(); ++i)
      ASSERT_LT(stamps[static_cast<std::size_t>(outcome.images[i - 1])],
                stamps[static_cast<std::size_t>(outcome.images[i])]);
    EXPECT_GE(outcome.images.size(), 50u);
  }
}

TEST(TimeLine, TimeThatStaysElsewhereIsFollowedWithoutALoss) {
  const Stamp before = 100'000 * kSecond;
  for (const Stamp jump :
       {-200'000'000L, -1 * kSecond, -60 * kSecond, -90'000 * kSecond, 11 * kSecond, 90'000 * kSecond}) {
    const Outcome outcome = run(joined(steadily(before, 30), steadily(before + 30 * kPeriod + jump, 30)));
    EXPECT_EQ(outcome.images, all(60)) << jump;
    EXPECT_EQ(outcome.went_back, jump < 0 ? std::vector<int>{30} : std::vector<int>{}) << jump;
    EXPECT_LT(outcome.largest_lag, time_line::kConfirmations);
  }
}

TEST(TimeLine, AFirstStampThatIsWrongDoesNotSilenceWhatFollows) {
  for (const Stamp first : {Stamp{1}, Stamp{4'294'967'295} * kSecond}) {
    const Outcome outcome = run(joined({first}, steadily(1000 * kSecond, 20)));
    EXPECT_EQ(outcome.images, all(21));
    EXPECT_EQ(outcome.went_back.size(), first == 1 ? 0u : 1u);
  }
}

TEST(TimeLine, SlipsDoNotKeepANewLineFromBeingFollowed) {
  std::vector<Stamp> again = steadily(10 * kSecond, 60);
  for (std::size_t i = 2; i < again.size(); i += 3) again[i] -= 40'000'000;
  const Outcome outcome = run(joined(steadily(1000 * kSecond, 30), again));
  EXPECT_EQ(outcome.went_back, std::vector<int>{30});
  EXPECT_EQ(outcome.counts.late, 20u) << "each third image of the new line";
}

TEST(TimeLine, OfInterleavedClocksOneIsTaken) {
  for (const bool main_goes_on : {true, false}) {
    std::vector<Stamp> stamps = steadily(1000 * kSecond, 5);
    for (int i = 0; i < 60; ++i) {
      if (main_goes_on) stamps.push_back(1000 * kSecond + (5 + i) * kPeriod);
      stamps.push_back(500 * kSecond + i * kPeriod);
      stamps.push_back(100 * kSecond + i * kPeriod);
    }
    const Outcome outcome = run(stamps);
    EXPECT_EQ(outcome.went_back.size(), main_goes_on ? 0u : 1u);
    EXPECT_EQ(outcome.images.size(), 65u);
  }
}

TEST(TimeLine, RepeatedAndMissingStampsAreLeftOut) {
  const Outcome outcome = run({5 * kSecond, 5 * kSecond, kNoStamp, 6 * kSecond, kNoStamp});
  EXPECT_EQ(outcome.images, (std::vector<int>{0, 3}));
  EXPECT_EQ(outcome.counts.repeated, 1u);
  EXPECT_EQ(outcome.counts.unstamped, 2u);
}

TEST(TimeLine, AtTheEndWhatIsAheadIsBelieved) {
  EXPECT_EQ(run({5 * kSecond, 100 * kSecond, 101 * kSecond}).images, all(3));
  EXPECT_EQ(run({5 * kSecond, 1 * kSecond, 2 * kSecond}).images, all(1));
}

}  // namespace
}  // namespace rgbd_sfm_fusion
