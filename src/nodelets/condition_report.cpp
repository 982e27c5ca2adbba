// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "condition_report.h"

#include <algorithm>

namespace rgbd_sfm_fusion {
namespace {

constexpr double kUntilTheSame = 120.0;  // [s]

std::string withoutNumbers(std::string sentence) {
  const auto isDigit = [](char c) { return (c >= '0' && c <= '9') || c == '.'; };
  sentence.erase(std::remove_if(sentence.begin(), sentence.end(), isDigit), sentence.end());
  return sentence;
}

}  // namespace

std::vector<std::string> ConditionReport::worthSaying(double time,
                                                      const std::vector<std::string>& sentences) {
  std::vector<std::string> worth;
  for (const std::string& sentence : sentences) {
    const auto [said, is_new] = said_.try_emplace(withoutNumbers(sentence), time);
    if (!is_new && time - said->second < kUntilTheSame) continue;
    said->second = time;
    worth.push_back(sentence);
  }
  return worth;
}

}  // namespace rgbd_sfm_fusion
