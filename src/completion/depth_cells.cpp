// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/completion/depth_cells.h"

#include <algorithm>
#include <utility>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kSize = CellGrid::kSize;
constexpr float kFewestOfSensor = 0.4F * kSize * kSize;  // [px]
constexpr float kFewestOfSfm = 2.0F;                     // [px]
constexpr float kStep = 0.04F;  // of inverse depth, relative: a larger scatter is more than one surface

/// Sums over the rows of a cell, for each column of the image. Columns that fill up the last cell are 0.
struct ColumnSums {
  explicit ColumnSums(std::size_t width)
      : pixels(width), rho(width), square(width), variance(width), row(width) {}

  void clear() {
    for (std::vector<float>* values : {&pixels, &rho, &square, &variance, &row})
      std::fill(values->begin(), values->end(), 0.0F);
  }

  std::vector<float> pixels, rho, square, variance, row;
};

RGBD_SFM_FUSION_MULTIVERSION
void addRow(const float* mean, const float* variance, const std::uint8_t* labels, int mask, int value,
            float row, int width, float* __restrict pixels, float* __restrict rhos, float* __restrict squares,
            float* __restrict variances, float* __restrict row_sums) {
  for (int x = 0; x < width; ++x) {
    // Each selection has a condition of its own: one condition for all would keep the loop scalar.
    const float z = mean[x] > 0.0f ? mean[x] : 1.0f, square = variance[x] > 0.0f ? variance[x] : 0.0f;
    const auto one = static_cast<float>(((labels[x] & mask) == value) & (mean[x] > 0.0f));
    const float rho = one / z;
    pixels[x] += one;
    rhos[x] += rho;
    squares[x] += rho * rho;
    variances[x] += square * rho * rho;
    row_sums[x] += one * row;
  }
}

/// Turns the sums of columns into the means of a row of cells.
void finishRow(const CellGrid& grid, const ColumnSums& sums, std::size_t first, CellMeans* means) {
  for (int column = 0; column < grid.columns; ++column) {
    const std::size_t start = static_cast<std::size_t>(kSize * column);
    float pixels = 0.0F, rho = 0.0F, square = 0.0F, variance = 0.0F, x = 0.0F, y = 0.0F;
    for (std::size_t at = start; at < start + kSize; ++at) {
      pixels += sums.pixels[at];
      rho += sums.rho[at];
      square += sums.square[at];
      variance += sums.variance[at];
      x += sums.pixels[at] * static_cast<float>(at);
      y += sums.row[at];
    }
    if (pixels == 0.0F) continue;
    const std::size_t cell = first + static_cast<std::size_t>(column);
    means->pixels[cell] = pixels;
    means->rho[cell] = rho / pixels;
    means->scatter[cell] = std::max(0.0F, square * pixels / (rho * rho) - 1.0F);
    means->variance[cell] = variance / pixels;
    means->x[cell] = grid.x(x / pixels);
    means->y[cell] = grid.y(y / pixels);
  }
}

bool isOneSurface(const CellMeans& means, std::size_t cell, float fewest) {
  return means.pixels[cell] >= fewest && means.scatter[cell] < kStep * kStep;
}

template <typename SfmOf, typename IsHidden>
Supports choose(const CellMeans& sensor, const SfmOf& sfm_of, const IsHidden& is_hidden, Supports buffer) {
  using Source = Supports::Source;
  const std::size_t count = sensor.pixels.size();
  Supports supports = std::move(buffer);
  supports.source.assign(count, Source::kNone);
  for (std::vector<float>* values : {&supports.rho, &supports.variance, &supports.x, &supports.y})
    values->assign(count, 0.0F);
  for (std::size_t cell = 0; cell < count; ++cell) {
    const CellMeans& sfm = *sfm_of(cell);
    const bool by_sensor = !is_hidden(cell) && isOneSurface(sensor, cell, kFewestOfSensor);
    if (!by_sensor && !isOneSurface(sfm, cell, kFewestOfSfm)) continue;
    const CellMeans& chosen = by_sensor ? sensor : sfm;
    supports.source[cell] = by_sensor ? Source::kSensor : Source::kSfm;
    supports.rho[cell] = chosen.rho[cell];
    supports.variance[cell] = chosen.variance[cell];
    supports.x[cell] = chosen.x[cell];
    supports.y[cell] = chosen.y[cell];
  }
  return supports;
}

}  // namespace

CellMeans cellMeans(const CellGrid& grid, const GaussianDepth& depth, const cv::Mat_<std::uint8_t>& labels,
                    int mask, int value, CellMeans buffer) {
  CellMeans means = std::move(buffer);
  for (std::vector<float>* values :
       {&means.pixels, &means.rho, &means.scatter, &means.variance, &means.x, &means.y})
    values->assign(grid.size(), 0.0F);
  if (depth.mean.empty()) return means;
  const auto width = static_cast<std::size_t>(grid.image.width);
  const std::vector<std::uint8_t> all(width, static_cast<std::uint8_t>(value));
  ColumnSums sums(static_cast<std::size_t>(kSize * grid.columns));
  for (int row = 0; row < grid.rows; ++row) {
    sums.clear();
    const int end = std::min(grid.image.height, kSize * (row + 1));
    for (int y = kSize * row; y < end; ++y) {
      addRow(depth.mean[y], depth.variance[y], labels.empty() ? all.data() : labels[y], mask, value,
             static_cast<float>(y), grid.image.width, sums.pixels.data(), sums.rho.data(), sums.square.data(),
             sums.variance.data(), sums.row.data());
    }
    finishRow(grid, sums, grid.index(row, 0), &means);
  }
  return means;
}

Supports chooseSupports(const CellMeans& sensor, const CellMeans& sfm, Supports buffer) {
  return choose(
      sensor, [&](std::size_t) { return &sfm; }, [](std::size_t) { return false; }, std::move(buffer));
}

Supports chooseSupports(const CellMeans& sensor, const CellMeans& sfm,
                        const std::vector<std::uint8_t>& hidden, const CellMeans& sfm_there,
                        Supports buffer) {
  return choose(
      sensor, [&](std::size_t cell) { return hidden[cell] != 0 ? &sfm_there : &sfm; },
      [&](std::size_t cell) { return hidden[cell] != 0; }, std::move(buffer));
}

}  // namespace rgbd_sfm_fusion
