// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/geometry/row_points.h"

#include <array>
#include <cstring>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kEight = 8;

/// Which of eight pixels are marked.
struct Marked {
  std::array<std::uint8_t, kEight> positions{};
  std::uint8_t count = 0;
};

/// A table of all combinations of eight marks. It replaces a branch for each pixel, which the processor could
/// not predict.
constexpr std::array<Marked, 1 << kEight> allCombinations() {
  std::array<Marked, 1 << kEight> table{};
  for (std::size_t bits = 0; bits < table.size(); ++bits) {
    for (std::uint8_t i = 0; i < kEight; ++i) {
      if ((bits >> i & 1u) != 0) table[bits].positions[table[bits].count++] = i;
    }
  }
  return table;
}

constexpr auto kCombinations = allCombinations();

RGBD_SFM_FUSION_MULTIVERSION
void mark(const float* row, int width, std::uint8_t* __restrict marks) {
  for (int x = 0; x < width; ++x) marks[x] = row[x] > 0.0f ? 1 : 0;
}

/// Eight marks as the bits of a number. Works on little-endian machines only. The product moves the bit of
/// byte i to bit 56 + i, and no two other terms of the product meet.
inline std::uint64_t toBits(const std::uint8_t* marks) {
  std::uint64_t word;
  std::memcpy(&word, marks, sizeof(word));
  return word * 0x0102040810204080u >> 56;
}

constexpr int roundedUp(int width) {
  return (width + kEight - 1) / kEight * kEight;
}

}  // namespace

RGBD_SFM_FUSION_MULTIVERSION
int findMarks(const std::uint8_t* marks, int begin, int end, int* __restrict places) {
  int found = 0;
  for (int x = begin; x < end; x += kEight) {
    const Marked& marked = kCombinations[toBits(marks + x)];
    for (int i = 0; i < kEight; ++i) places[found + i] = x + marked.positions[static_cast<std::size_t>(i)];
    found += marked.count;
  }
  return found;
}

RowPoints::RowPoints(int width)
    : columns(static_cast<std::size_t>(roundedUp(width) + kEight)),
      values(columns.size()),
      pixels(columns.size()),
      z(columns.size()),
      width_(width),
      marks_(columns.size()) {}

std::size_t RowPoints::find(const float* row, int* found) {
  mark(row, width_, marks_.data());
  return static_cast<std::size_t>(findMarks(marks_.data(), 0, width_, found));
}

void RowPoints::gather(const float* row) {
  count = find(row, columns.data());
  for (std::size_t i = 0; i < count; ++i) values[i] = row[columns[i]];
}

void RowPoints::gather(const float* row, const std::vector<cv::Range>& parts) {
  count = 0;
  for (const cv::Range& part : parts) {
    mark(row + part.start, part.size(), marks_.data() + part.start);
    count += static_cast<std::size_t>(findMarks(marks_.data(), part.start, part.end, columns.data() + count));
  }
  for (std::size_t i = 0; i < count; ++i) values[i] = row[columns[i]];
}

}  // namespace rgbd_sfm_fusion
