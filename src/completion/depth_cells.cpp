// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/completion/depth_cells.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <utility>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kSize = CellGrid::kSize;
constexpr float kFewestOfSensor = 0.4F * kSize * kSize;  // [px]
constexpr float kFewestOfSfm = 2.0F;                     // [px]
constexpr float kStep = 0.04F;       // of inverse depth, relative: a larger scatter is more than one surface
constexpr float kAgreement = 0.05F;  // of inverse depth, relative: nearer neighbours agree
constexpr int kFewestAgreeing = 3;   // of the eight cells around a depth that is not published
// σ / Z of such a depth, besides its own. 0.1 and 0.12 were compared on recordings.
constexpr float kWithheldSigma = 0.1F;

/// Columns of the image whose cells are handled together: kLanes cells.
constexpr int kChunk = kSize * kLanes;

/// Sums over the rows of cells, for each column of a chunk.
struct ColumnSums {
  float pixels[kChunk], rho[kChunk], square[kChunk], variance[kChunk], row[kChunk];
};

/// A row of pixels, from the first one of a chunk.
struct PixelRow {
  const float *mean, *variance;
  const std::uint8_t* labels;
  float row;  ///< its number
};

/// Whether any of the pixels counts. Most chunks of SfM's depth are told by their labels alone.
/// @param rows  of one row of cells
inline bool anyCounts(const PixelRow (&rows)[kSize], int mask, int value, int width) {
  std::uint8_t labelled = 0;
  for (const PixelRow& row : rows) {
    for (int x = 0; x < width; ++x)
      labelled = static_cast<std::uint8_t>(labelled | ((row.labels[x] & mask) == value ? 1 : 0));
  }
  if (labelled == 0) return false;
  int any = 0;
  for (const PixelRow& row : rows) {
    for (int x = 0; x < width; ++x) any |= row.mean[x] > 0.0F ? 1 : 0;
  }
  return any != 0;
}

inline void addRows(const PixelRow (&rows)[kSize], int mask, int value, int width,
                    ColumnSums* __restrict to) {
  for (int x = 0; x < width; ++x) {
    float sums[5] = {};
    for (const PixelRow& row : rows) {
      // Each selection has a condition of its own: one condition for all would keep the loop scalar.
      const float mean = row.mean[x], own = row.variance[x];
      const float z = mean > 0.0F ? mean : 1.0F, square = own > 0.0F ? own : 0.0F;
      const auto one = static_cast<float>(((row.labels[x] & mask) == value) & (mean > 0.0F));
      const float rho = one / z;
      sums[0] += one;
      sums[1] += rho;
      sums[2] += rho * rho;
      sums[3] += square * rho * rho;
      sums[4] += one * row.row;
    }
    to->pixels[x] = sums[0], to->rho[x] = sums[1], to->square[x] = sums[2];
    to->variance[x] = sums[3], to->row[x] = sums[4];
  }
}

/// Sums over the columns of each cell of a chunk.
inline void acrossCells(const float* __restrict columns, float* __restrict sums) {
  static_assert(kSize == 4, "a term for each column");
  for (int l = 0; l < kLanes; ++l) {
    const float* const at = columns + kSize * l;
    sums[l] = at[0] + at[1] + at[2] + at[3];
  }
}

/// The means of a chunk's cells.
struct ChunkMeans {
  float pixels[kLanes], rho[kLanes], scatter[kLanes], variance[kLanes], x[kLanes], y[kLanes];
};

inline void finishChunk(const CellGrid& grid, const ColumnSums& sums, int first_column, ChunkMeans* to) {
  float at[kChunk], pixels[kLanes], rho[kLanes], square[kLanes], variance[kLanes], x[kLanes], y[kLanes];
  for (int i = 0; i < kChunk; ++i) at[i] = sums.pixels[i] * static_cast<float>(first_column + i);
  acrossCells(sums.pixels, pixels);
  acrossCells(sums.rho, rho);
  acrossCells(sums.square, square);
  acrossCells(sums.variance, variance);
  acrossCells(at, x);
  acrossCells(sums.row, y);
  const float middle_x = 0.5F * static_cast<float>(grid.image.width - 1),
              middle_y = 0.5F * static_cast<float>(grid.image.height - 1);
  for (int l = 0; l < kLanes; ++l) {
    const bool any = pixels[l] > 0.0F;
    const float count = any ? pixels[l] : 1.0F;
    const float scatter = greater(0.0F, square[l] * count / (rho[l] * rho[l]) - 1.0F);
    const float from_left = (x[l] / count - middle_x) / CellGrid::kUnit,
                from_top = (y[l] / count - middle_y) / CellGrid::kUnit;
    to->pixels[l] = pixels[l];
    to->rho[l] = rho[l] / count;
    to->scatter[l] = any ? scatter : 0.0F;
    to->variance[l] = variance[l] / count;
    to->x[l] = any ? from_left : 0.0F;
    to->y[l] = any ? from_top : 0.0F;
  }
}

/// The means of a chunk of a row of cells.
/// @param first  column of the image
/// @param width  [px] at most kChunk
/// @return       whether any pixel counts. If none does, the means are not written
RGBD_SFM_FUSION_MULTIVERSION
bool addUpChunk(const CellGrid& grid, const PixelRow (&rows)[kSize], int mask, int value, int first,
                int width, ChunkMeans* to) {
  ColumnSums sums;
  if (width == kChunk) {  // the usual case, with a number that the compiler knows
    if (!anyCounts(rows, mask, value, kChunk)) return false;
    addRows(rows, mask, value, kChunk, &sums);
  } else {
    if (!anyCounts(rows, mask, value, width)) return false;
    sums = {};
    addRows(rows, mask, value, width, &sums);
  }
  finishChunk(grid, sums, first, to);
  return true;
}

/// The means of a row of cells.
void addUpRow(const CellGrid& grid, const DepthOfCells& of, const cv::Mat_<std::uint8_t>& labels, int row) {
  // Rows below the image have no depth. Without labels, all pixels count.
  static const float nothing[kChunk] = {};
  std::uint8_t counts[kChunk];
  std::fill_n(counts, kChunk, static_cast<std::uint8_t>(of.value));
  CellMeans& means = *of.means;
  for (int column = 0; column < grid.columns; column += kLanes) {
    const int left = kSize * column, width = std::min(grid.image.width - left, kChunk);
    PixelRow rows[kSize];
    for (int i = 0; i < kSize; ++i) {
      const int y = kSize * row + i;
      const bool exists = y < grid.image.height;
      rows[i] = {exists ? of.depth.mean[y] + left : nothing, exists ? of.depth.variance[y] + left : nothing,
                 exists && !labels.empty() ? labels[y] + left : counts, static_cast<float>(y)};
    }
    ChunkMeans chunk;
    if (!addUpChunk(grid, rows, of.mask, of.value, left, width, &chunk)) continue;
    const auto count = static_cast<std::ptrdiff_t>(std::min(grid.columns - column, kLanes));
    const auto first = static_cast<std::ptrdiff_t>(grid.index(row, column));
    std::copy_n(chunk.pixels, count, means.pixels.begin() + first);
    std::copy_n(chunk.rho, count, means.rho.begin() + first);
    std::copy_n(chunk.scatter, count, means.scatter.begin() + first);
    std::copy_n(chunk.variance, count, means.variance.begin() + first);
    std::copy_n(chunk.x, count, means.x.begin() + first);
    std::copy_n(chunk.y, count, means.y.begin() + first);
  }
}

/// CellMeans, as vector code wants them.
struct Columns {
  const float *pixels, *rho, *scatter, *variance, *x, *y;
};

Columns columnsOf(const CellMeans& means) {
  return {means.pixels.data(),   means.rho.data(), means.scatter.data(),
          means.variance.data(), means.x.data(),   means.y.data()};
}

struct CellsToChoose {
  Columns sensor, sfm;
};

/// Takes the sensor's depth, else SfM's, else none.
/// @param sources  [out] values of Supports::Source; the others are 0 where there is none
RGBD_SFM_FUSION_MULTIVERSION
void choose(const CellsToChoose& from, std::size_t count, std::uint8_t* __restrict sources,
            float* __restrict rhos, float* __restrict variances, float* __restrict xs, float* __restrict ys) {
  using Source = Supports::Source;
  const Columns sensor = from.sensor, sfm = from.sfm;
  for (std::size_t i = 0; i < count; ++i) {
    const bool by_sensor = (sensor.pixels[i] >= kFewestOfSensor) & (sensor.scatter[i] < kStep * kStep);
    const bool by_sfm = (sfm.pixels[i] >= kFewestOfSfm) & (sfm.scatter[i] < kStep * kStep);
    // Selections from variables: those from constants or from memory would keep the loop scalar.
    const float sfm_rho = sfm.rho[i], sfm_variance = sfm.variance[i], sfm_x = sfm.x[i], sfm_y = sfm.y[i];
    const float rho = sensor.rho[i], variance = sensor.variance[i], x = sensor.x[i], y = sensor.y[i];
    const float else_rho = by_sfm ? sfm_rho : 0.0F, else_variance = by_sfm ? sfm_variance : 0.0F;
    const float else_x = by_sfm ? sfm_x : 0.0F, else_y = by_sfm ? sfm_y : 0.0F;
    rhos[i] = by_sensor ? rho : else_rho;
    variances[i] = by_sensor ? variance : else_variance;
    xs[i] = by_sensor ? x : else_x;
    ys[i] = by_sensor ? y : else_y;
    const int source = (by_sfm ? static_cast<int>(Source::kSfm) : 0);
    sources[i] = static_cast<std::uint8_t>(by_sensor ? static_cast<int>(Source::kSensor) : source);
  }
}

bool isOneSurface(const CellMeans& means, std::size_t cell, float fewest) {
  return means.pixels[cell] >= fewest && means.scatter[cell] < kStep * kStep;
}

/// Whether SfM's depth in a cell that is not published agrees with SfM's in three of the cells around it.
bool agreesWithOthers(const CellGrid& grid, const CellMeans& sfm, const CellMeans& withheld, int row,
                      int column) {
  const float here = withheld.rho[grid.index(row, column)];
  const auto agrees = [&](float there) { return std::abs(there - here) < kAgreement * here; };
  int agreeing = -1;  // the cell itself
  for (int y = std::max(row - 1, 0); y <= std::min(row + 1, grid.rows - 1); ++y) {
    for (int x = std::max(column - 1, 0); x <= std::min(column + 1, grid.columns - 1); ++x) {
      const std::size_t cell = grid.index(y, x);
      agreeing += agrees(sfm.rho[cell]) || agrees(withheld.rho[cell]) ? 1 : 0;
    }
  }
  return agreeing >= kFewestAgreeing;
}

}  // namespace

void addUpCells(const CellGrid& grid, const cv::Mat_<std::uint8_t>& labels,
                std::initializer_list<DepthOfCells> depths) {
  for (const DepthOfCells& of : depths) {
    for (const auto values : {&CellMeans::pixels, &CellMeans::rho, &CellMeans::scatter, &CellMeans::variance,
                              &CellMeans::x, &CellMeans::y})
      (of.means->*values).assign(grid.size(), 0.0F);
  }
  // One row after the other, as long as it is in the processor's cache.
  for (int row = 0; row < grid.rows; ++row) {
    for (const DepthOfCells& of : depths) {
      if (!of.depth.mean.empty()) addUpRow(grid, of, labels, row);
    }
  }
}

CellMeans cellMeans(const CellGrid& grid, const GaussianDepth& depth) {
  CellMeans means;
  addUpCells(grid, {}, {{depth, 0, 0, &means}});
  return means;
}

Supports chooseSupports(const CellGrid& grid, const CellMeans& sensor, const CellMeans& sfm,
                        const CellMeans& withheld, const CommonVariance& common, Supports buffer) {
  using Source = Supports::Source;
  Supports supports = std::move(buffer);
  supports.source.resize(grid.size());
  for (std::vector<float>* values :
       {&supports.rho, &supports.variance, &supports.own, &supports.x, &supports.y})
    values->resize(grid.size());
  const CellsToChoose from{columnsOf(sensor), columnsOf(sfm)};
  choose(from, grid.size(), reinterpret_cast<std::uint8_t*>(supports.source.data()), supports.rho.data(),
         supports.variance.data(), supports.x.data(), supports.y.data());
  supports.own = supports.variance;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t cell = grid.index(row, column);
      Source& source = supports.source[cell];
      if (source == Source::kNone && isOneSurface(withheld, cell, kFewestOfSfm) &&
          agreesWithOthers(grid, sfm, withheld, row, column)) {
        source = Source::kWithheld;
        supports.rho[cell] = withheld.rho[cell];
        supports.variance[cell] = supports.own[cell] = withheld.variance[cell];
        supports.x[cell] = withheld.x[cell];
        supports.y[cell] = withheld.y[cell];
      }
      if (!supports.isOfSfm(cell)) continue;
      if (common) {
        const double rho = static_cast<double>(supports.rho[cell]),
                     shared =
                         common(rho, grid.column(supports.x[cell]), grid.row(supports.y[cell])) / (rho * rho);
        supports.own[cell] = std::max(supports.variance[cell] - static_cast<float>(shared), 0.0F);
      }
      if (source == Source::kWithheld) supports.variance[cell] += kWithheldSigma * kWithheldSigma;
    }
  }
  return supports;
}

}  // namespace rgbd_sfm_fusion
