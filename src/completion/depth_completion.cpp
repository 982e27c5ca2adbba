// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/completion/depth_completion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rgbd_sfm_fusion/fusion/provenance.h"
#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kSize = CellGrid::kSize;
constexpr int kLearnEvery = 8;       // frames
constexpr float kBaseline = 0.075F;  // [m] from projector to camera; the same for Kinect, Xtion and Astra
constexpr int kSensorBit = static_cast<int>(Provenance::kSensor);
constexpr int kSfm = static_cast<int>(Provenance::kSfm);
constexpr int kNone = static_cast<int>(Provenance::kNone);
constexpr int kAll = 0xff;

/// Sums of the brightness of each column over rows of pixels.
RGBD_SFM_FUSION_MULTIVERSION
void addUpColumns(const std::uint8_t* const (&rows)[kSize], int width, std::uint16_t* __restrict sums) {
  for (int x = 0; x < width; ++x) {
    int sum = 0;
    for (const std::uint8_t* row : rows) sum += row[x];
    sums[x] = static_cast<std::uint16_t>(sum);
  }
}

/// Mean brightness of each cell, to the next even number where it lies between two. Beyond the image, its
/// last row and column go on.
void cellGrey(const CellGrid& grid, const GreyImage& grey, cv::Mat_<std::uint8_t>* cells) {
  static_assert(kSize == 4, "shifts stand for divisions by the number of pixels");
  cells->create(grid.rows, grid.columns);
  std::vector<std::uint16_t> sums(static_cast<std::size_t>(kSize * grid.columns));
  for (int row = 0; row < grid.rows; ++row) {
    const std::uint8_t* rows[kSize];
    for (int i = 0; i < kSize; ++i) rows[i] = grey[std::min(kSize * row + i, grey.rows - 1)];
    addUpColumns(rows, grey.cols, sums.data());
    std::fill(sums.begin() + grey.cols, sums.end(), sums[static_cast<std::size_t>(grey.cols - 1)]);
    std::uint8_t* const to = (*cells)[row];
    for (int column = 0; column < grid.columns; ++column) {
      const std::uint16_t* const of = sums.data() + kSize * column;
      const int sum = of[0] + of[1] + of[2] + of[3];
      to[column] = static_cast<std::uint8_t>((sum + 7 + (sum >> 4 & 1)) >> 4);
    }
  }
}

CompletionEvidence evidenceOf(const Surfaces& surfaces, std::size_t cell) {
  return {surfaces.misfit[cell], surfaces.variance[cell], surfaces.other[cell]};
}

/// Sets the cells of a rectangle to 0.
void erase(const CellGrid& grid, const cv::Rect& pixels, std::vector<std::uint8_t>* cells) {
  for (int row = pixels.y / kSize; row <= (pixels.br().y - 1) / kSize; ++row) {
    for (int column = pixels.x / kSize; column <= (pixels.br().x - 1) / kSize; ++column)
      (*cells)[grid.index(row, column)] = 0;
  }
}

}  // namespace

std::uint64_t DepthCompletion::complete(FrameToComplete frame) {
  if (grid_.image != frame.grey.size()) {
    grid_ = CellGrid(frame.grey.size());
    holes_.clear();
    wanted_.assign(grid_.size(), 0);
  }
  cellGrey(grid_, frame.grey, &grey_);
  links_ = linksOf(grid_, grey_);
  addUpCells(grid_, frame.provenance,
             {{frame.depth, kSensorBit, kSensorBit, &sensor_},
              {frame.sfm, kAll, kSfm, &sfm_},
              {frame.sfm, kAll, kNone, &withheld_}});
  if (frames_ % kLearnEvery == 0) learn(frame);
  ++frames_;

  for (std::size_t cell = 0; cell < wanted_.size(); ++cell)
    wanted_[cell] = sensor_.pixels[cell] < static_cast<float>(kSize * kSize) ? 1 : 0;
  for (const cv::Rect& mirror : frame.mirrors) erase(grid_, mirror, &wanted_);
  supports_ = chooseSupports(grid_, sensor_, sfm_, withheld_, frame.common_variance, std::move(supports_));
  const Surfaces& surfaces =
      drawing_.draw(grid_, grey_, links_, supports_, wanted_, kBaseline * frame.focal_length);
  return paint(surfaces, frame);
}

std::uint64_t DepthCompletion::paint(const Surfaces& surfaces, const FrameToComplete& frame) {
  const auto limit = static_cast<float>(frame.max_relative_sigma * frame.max_relative_sigma);
  std::uint64_t completed = 0;
  for (int row = 0; row < grid_.rows; ++row) {
    const int top = kSize * row, bottom = std::min(grid_.image.height, top + kSize);
    for (int column = 0; column < grid_.columns; ++column) {
      const std::size_t cell = grid_.index(row, column);
      if (surfaces.drawn[cell] == Surfaces::kNot) continue;
      const CompletionEvidence evidence = evidenceOf(surfaces, cell);
      if (!(errors_.cautious(evidence) < limit)) continue;
      const float variance = errors_.variance(evidence), rho = surfaces.rho[cell];
      const Sides sides = surfaces.sides[cell];
      const int left = kSize * column, right = std::min(grid_.image.width, left + kSize);
      float steps[kSize];  // of the plane, from the cell's middle
      for (int x = left; x < right; ++x) {
        const float from_middle = grid_.x(static_cast<float>(x)) - grid_.middleX(column);
        steps[x - left] = surfaces.slope_x[cell] * from_middle;
      }
      for (int y = top; y < bottom; ++y) {
        const float from_middle = grid_.y(static_cast<float>(y)) - grid_.middleY(row);
        const float step = surfaces.slope_y[cell] * from_middle;
        std::uint8_t* const labels = frame.provenance[y];
        for (int x = left; x < right; ++x) {
          if (labels[x] != 0 || !sides.contain(frame.grey(y, x))) continue;
          const float at = rho + steps[x - left] + step;
          if (!(at > 0.5F * rho)) continue;
          const float z = 1.0F / at;
          frame.depth.mean(y, x) = z;
          frame.depth.variance(y, x) = variance * z * z;
          labels[x] = static_cast<std::uint8_t>(Provenance::kCompleted);
          ++completed;
        }
      }
    }
  }
  return completed;
}

void DepthCompletion::learn(const FrameToComplete& frame) {
  std::vector<std::uint8_t> holes(grid_.size());
  for (std::size_t cell = 0; cell < holes.size(); ++cell) holes[cell] = sensor_.pixels[cell] == 0.0F ? 1 : 0;
  std::swap(holes, holes_);
  if (holes.empty() || frame.sfm.mean.empty()) return;
  // The holes are shifted by up to three quarters of the image, and mirrored every other time.
  const int turn = frames_ / kLearnEvery;
  const int shift_x = grid_.columns * (1 + turn % 3) / 4, shift_y = grid_.rows * (turn / 3 % 4) / 4;
  const bool mirrored = turn % 2 == 1;
  const CellMeans measured = cellMeans(grid_, frame.sensor);
  const Supports truth = chooseSupports(grid_, measured, sfm_, withheld_, {});
  std::vector<std::uint8_t> hidden(grid_.size(), 0);
  for (int row = 0; row < grid_.rows; ++row) {
    for (int column = 0; column < grid_.columns; ++column) {
      const int x = (column + shift_x) % grid_.columns, y = (row + shift_y) % grid_.rows;
      const std::size_t cell = grid_.index(row, column);
      hidden[cell] = holes[grid_.index(y, mirrored ? grid_.columns - 1 - x : x)];
      wanted_[cell] = hidden[cell] != 0 && truth.source[cell] == Supports::Source::kSensor ? 1 : 0;
    }
  }
  const CellMeans sfm_there = cellMeans(grid_, frame.sfm);
  CellMeans sensor = sensor_, sfm = sfm_;
  for (std::size_t cell = 0; cell < hidden.size(); ++cell) {
    if (hidden[cell] == 0) continue;
    sensor.pixels[cell] = 0.0F;
    for (const auto values : {&CellMeans::pixels, &CellMeans::rho, &CellMeans::scatter, &CellMeans::variance,
                              &CellMeans::x, &CellMeans::y})
      (sfm.*values)[cell] = (sfm_there.*values)[cell];
  }
  supports_ = chooseSupports(grid_, sensor, sfm, withheld_, frame.common_variance, std::move(supports_));
  const Surfaces& surfaces =
      drawing_.draw(grid_, grey_, links_, supports_, wanted_, kBaseline * frame.focal_length);
  const auto limit = static_cast<float>(frame.max_relative_sigma * frame.max_relative_sigma);
  for (std::size_t cell = 0; cell < grid_.size(); ++cell) {
    const CompletionEvidence evidence = evidenceOf(surfaces, cell);
    if (surfaces.drawn[cell] == Surfaces::kNot || !(CompletionErrors::prior(evidence) < limit)) continue;
    const float rho = truth.rho[cell];
    errors_.observe(evidence, (surfaces.rho[cell] - rho) / rho, truth.variance[cell]);
  }
  errors_.learn();
}

}  // namespace rgbd_sfm_fusion
