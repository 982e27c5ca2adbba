// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "area_votes.h"

#include <cstring>
#include <opencv2/imgproc.hpp>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kCell = AreaVerdicts::kCell;
constexpr int kLeastPixels = 12;  // with both depths; fewer say nothing of an area

/// Adds up the votes of a row in cells of kCell pixels.
RGBD_SFM_FUSION_MULTIVERSION
void addToCells(const std::uint8_t* votes, int cells, std::uint16_t* __restrict both,
                std::uint16_t* __restrict against) {
  constexpr std::uint32_t kEach = 0x01010101;
  for (int cell = 0; cell < cells; ++cell) {
    std::uint32_t word;
    std::memcpy(&word, votes + kCell * cell, sizeof(word));
    both[cell] = static_cast<std::uint16_t>(both[cell] + ((word & kEach) * kEach >> 24));
    against[cell] = static_cast<std::uint16_t>(against[cell] + ((word >> 1 & kEach) * kEach >> 24));
  }
}

/// Pixels with both depths in the area of each cell, and those of them that are against their being one.
struct AreaVotes {
  cv::Mat_<std::uint16_t> both, against;
};

/// A cell's area is that of the two cells around it on each side, too.
AreaVotes sumAreas(const cv::Mat_<std::uint8_t>& votes) {
  cv::Mat_<std::uint16_t> both(votes.rows / kCell + 1, votes.cols / kCell + 1);
  both.setTo(0.0);
  cv::Mat_<std::uint16_t> against = both.clone();
  for (int y = 0; y < votes.rows; ++y)
    addToCells(votes[y], votes.cols / kCell, both[y / kCell], against[y / kCell]);
  const cv::Size window(5, 5);
  AreaVotes areas;
  cv::boxFilter(both, areas.both, -1, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::boxFilter(against, areas.against, -1, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  return areas;
}

bool isContested(int both, int against) {
  return against >= kLeastPixels && 5 * against >= 2 * both;
}

}  // namespace

AreaVerdicts judgeAreas(const cv::Mat_<std::uint8_t>& votes) {
  const AreaVotes areas = sumAreas(votes);
  AreaVerdicts verdicts;
  verdicts.contested.create(areas.both.size());
  for (int y = 0; y < areas.both.rows; ++y) {
    for (int x = 0; x < areas.both.cols; ++x)
      verdicts.contested(y, x) = isContested(areas.both(y, x), areas.against(y, x)) ? 1 : 0;
  }
  cv::dilate(verdicts.contested, verdicts.contested, cv::Mat());
  cv::inRange(areas.both, 1.0, static_cast<double>(kLeastPixels - 1), verdicts.sparse);
  return verdicts;
}

}  // namespace rgbd_sfm_fusion
