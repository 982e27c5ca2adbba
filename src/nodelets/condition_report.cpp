// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "condition_report.h"

#include <algorithm>
#include <iterator>
#include <set>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kUntilTheSame = 120.0;   // [s]
constexpr double kUntilForgotten = 15.0;  // [s] a condition that comes and goes is no news each time

std::string withoutNumbers(std::string sentence) {
  const auto isDigit = [](char c) { return (c >= '0' && c <= '9') || c == '.'; };
  sentence.erase(std::remove_if(sentence.begin(), sentence.end(), isDigit), sentence.end());
  return sentence;
}

}  // namespace

std::vector<std::string> ConditionReport::worthSaying(double time,
                                                      const std::vector<std::string>& sentences) {
  std::vector<std::string> worth;
  std::set<std::string> holding;
  for (const std::string& sentence : sentences) {
    const std::string key = withoutNumbers(sentence);
    holding.insert(key);
    const auto [said, is_new] = said_.try_emplace(key, time);
    if (!is_new && time - said->second < kUntilTheSame) continue;
    said->second = time;
    worth.push_back(sentence);
  }
  for (auto said = said_.begin(); said != said_.end();) {
    const bool is_over = holding.count(said->first) == 0 && time - said->second > kUntilForgotten;
    said = is_over ? said_.erase(said) : std::next(said);
  }
  return worth;
}

}  // namespace rgbd_sfm_fusion
