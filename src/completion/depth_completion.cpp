// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/completion/depth_completion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "rgbd_sfm_fusion/fusion/provenance.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kSize = CellGrid::kSize;
constexpr int kLearnEvery = 8;       // frames
constexpr float kBaseline = 0.075F;  // [m] from projector to camera; the same for Kinect, Xtion and Astra
constexpr int kSensorBit = static_cast<int>(Provenance::kSensor);
constexpr int kAll = 0xff;

/// Mean brightness of each cell.
cv::Mat_<std::uint8_t> cellGrey(const CellGrid& grid, const GreyImage& grey) {
  cv::Mat_<std::uint8_t> cells;
  const cv::Size whole(grid.columns * kSize, grid.rows * kSize);
  if (whole == grey.size()) {
    cv::resize(grey, cells, {grid.columns, grid.rows}, 0.0, 0.0, cv::INTER_AREA);
    return cells;
  }
  cv::Mat_<std::uint8_t> padded;
  cv::copyMakeBorder(grey, padded, 0, whole.height - grey.rows, 0, whole.width - grey.cols,
                     cv::BORDER_REPLICATE);
  cv::resize(padded, cells, {grid.columns, grid.rows}, 0.0, 0.0, cv::INTER_AREA);
  return cells;
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

/// Calls visit(y, x) for the pixels of a cell.
template <typename Visitor>
void forEachPixel(const CellGrid& grid, int row, int column, const Visitor& visit) {
  const int bottom = std::min(grid.image.height, kSize * (row + 1));
  const int right = std::min(grid.image.width, kSize * (column + 1));
  for (int y = kSize * row; y < bottom; ++y) {
    for (int x = kSize * column; x < right; ++x) visit(y, x);
  }
}

}  // namespace

std::uint64_t DepthCompletion::complete(FrameToComplete frame) {
  if (grid_.image != frame.grey.size()) {
    grid_ = CellGrid(frame.grey.size());
    holes_.clear();
    wanted_.assign(grid_.size(), 0);
  }
  grey_ = cellGrey(grid_, frame.grey);
  links_ = linksOf(grid_, grey_);
  sensor_ = cellMeans(grid_, frame.depth, frame.provenance, kSensorBit, kSensorBit, std::move(sensor_));
  meansOfUnseen(grid_, frame.sfm, frame.provenance, &sfm_, &withheld_);
  if (frames_ % kLearnEvery == 0) learn(frame);
  ++frames_;

  for (std::size_t cell = 0; cell < wanted_.size(); ++cell)
    wanted_[cell] = sensor_.pixels[cell] < static_cast<float>(kSize * kSize) ? 1 : 0;
  for (const cv::Rect& mirror : frame.mirrors) erase(grid_, mirror, &wanted_);
  supports_ = chooseSupports(grid_, sensor_, sfm_, withheld_, frame.common_variance, std::move(supports_));
  const Surfaces& surfaces =
      drawing_.draw(grid_, grey_, links_, supports_, wanted_, kBaseline * frame.focal_length);
  const auto limit = static_cast<float>(frame.max_relative_sigma * frame.max_relative_sigma);
  std::uint64_t completed = 0;
  for (int row = 0; row < grid_.rows; ++row) {
    for (int column = 0; column < grid_.columns; ++column) {
      const std::size_t cell = grid_.index(row, column);
      if (surfaces.drawn[cell] == Surfaces::kNot) continue;
      const CompletionEvidence evidence = evidenceOf(surfaces, cell);
      if (!(errors_.cautious(evidence) < limit)) continue;
      const float variance = errors_.variance(evidence);
      const float rho = surfaces.rho[cell], x_middle = grid_.middleX(column), y_middle = grid_.middleY(row);
      const Sides sides = surfaces.sides[cell];
      forEachPixel(grid_, row, column, [&](int y, int x) {
        std::uint8_t& label = frame.provenance(y, x);
        if (label != 0 || !sides.contain(frame.grey(y, x))) return;
        const float at = rho + surfaces.slope_x[cell] * (grid_.x(static_cast<float>(x)) - x_middle) +
                         surfaces.slope_y[cell] * (grid_.y(static_cast<float>(y)) - y_middle);
        if (!(at > 0.5F * rho)) return;
        const float z = 1.0F / at;
        frame.depth.mean(y, x) = z;
        frame.depth.variance(y, x) = variance * z * z;
        label = static_cast<std::uint8_t>(Provenance::kCompleted);
        ++completed;
      });
    }
  }
  return completed;
}

void DepthCompletion::learn(const FrameToComplete& frame) {
  std::vector<std::uint8_t> holes(grid_.size());
  for (std::size_t cell = 0; cell < holes.size(); ++cell) holes[cell] = sensor_.pixels[cell] == 0.0F ? 1 : 0;
  std::swap(holes, holes_);
  if (holes.empty() || frame.sfm.size() == 0) return;
  // The holes are shifted by up to three quarters of the image, and mirrored every other time.
  const int turn = frames_ / kLearnEvery;
  const int shift_x = grid_.columns * (1 + turn % 3) / 4, shift_y = grid_.rows * (turn / 3 % 4) / 4;
  const bool mirrored = turn % 2 == 1;
  const CellMeans measured = cellMeans(grid_, frame.sensor, {}, kAll, kAll);
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
