// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/completion/depth_cells.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kSize = CellGrid::kSize;
constexpr float kFewestOfSensor = 0.4F * kSize * kSize;  // [px]
constexpr float kFewestOfSfm = 2.0F;                     // [px]
constexpr float kStep = 0.04F;      // of inverse depth, relative: a larger scatter is more than one surface
constexpr int kFewestAgreeing = 3;  // of the eight cells around a depth that is not published
// σ / Z of such a depth, besides its own. 0.1 and 0.12 were compared on recordings.
constexpr float kWithheldSigma = 0.1F;

/// Sums over a cell's pixels.
struct CellSums {
  float pixels = 0.0F, rho = 0.0F, square = 0.0F, variance = 0.0F, x = 0.0F, y = 0.0F;

  void add(float pixel_x, float pixel_y, float mean, float own_variance) {
    const float own_rho = 1.0F / mean;
    pixels += 1.0F;
    rho += own_rho;
    square += own_rho * own_rho;
    variance += own_variance * own_rho * own_rho;
    x += pixel_x;
    y += pixel_y;
  }
};

/// Sums over the rows of a cell, for each column of the image. Columns that fill up the last cell are 0.
struct ColumnSums {
  explicit ColumnSums(std::size_t width)
      : pixels(width), rho(width), square(width), variance(width), row(width) {}

  std::vector<float> pixels, rho, square, variance, row;
};

/// A cell's pixels in a row of the image.
struct PixelRow {
  const float *mean, *variance;
  const std::uint8_t* labels;
  float row;  ///< its number
};

template <std::size_t Rows>
inline void addUp(const PixelRow* rows, int mask, int value, int width, float* __restrict pixels,
                  float* __restrict rhos, float* __restrict squares, float* __restrict variances,
                  float* __restrict row_sums) {
  for (int x = 0; x < width; ++x) {
    float sums[5] = {};
    for (std::size_t i = 0; i < Rows; ++i) {
      // Each selection has a condition of its own: one condition for all would keep the loop scalar.
      const float mean = rows[i].mean[x], own = rows[i].variance[x];
      const float z = mean > 0.0f ? mean : 1.0f, square = own > 0.0f ? own : 0.0f;
      const auto one = static_cast<float>(((rows[i].labels[x] & mask) == value) & (mean > 0.0f));
      const float rho = one / z;
      sums[0] += one;
      sums[1] += rho;
      sums[2] += rho * rho;
      sums[3] += square * rho * rho;
      sums[4] += one * rows[i].row;
    }
    pixels[x] = sums[0], rhos[x] = sums[1], squares[x] = sums[2];
    variances[x] = sums[3], row_sums[x] = sums[4];
  }
}

/// @param count  of the rows: kSize, or fewer at the lower edge of the image
RGBD_SFM_FUSION_MULTIVERSION
void addRows(const PixelRow* from, int count, int mask, int value, int width, float* __restrict pixels,
             float* __restrict rhos, float* __restrict squares, float* __restrict variances,
             float* __restrict row_sums) {
  static_assert(kSize == 4, "a case for each number of rows");
  PixelRow rows[kSize];
  for (int i = 0; i < count; ++i) rows[i] = from[i];
  switch (count) {
    case 4:
      return addUp<4>(rows, mask, value, width, pixels, rhos, squares, variances, row_sums);
    case 3:
      return addUp<3>(rows, mask, value, width, pixels, rhos, squares, variances, row_sums);
    case 2:
      return addUp<2>(rows, mask, value, width, pixels, rhos, squares, variances, row_sums);
    default:
      return addUp<1>(rows, mask, value, width, pixels, rhos, squares, variances, row_sums);
  }
}

void setMeans(const CellGrid& grid, const CellSums& sums, std::size_t cell, CellMeans* means) {
  const float share = 1.0F / sums.pixels;
  means->pixels[cell] = sums.pixels;
  means->rho[cell] = sums.rho * share;
  means->scatter[cell] = std::max(0.0F, sums.square * sums.pixels / (sums.rho * sums.rho) - 1.0F);
  means->variance[cell] = sums.variance * share;
  means->x[cell] = grid.x(sums.x * share);
  means->y[cell] = grid.y(sums.y * share);
}

/// Turns the sums of columns into the means of a row of cells.
RGBD_SFM_FUSION_MULTIVERSION
void finishColumns(const CellGrid& grid, const float* pixels, const float* rhos, const float* squares,
                   const float* variances, const float* row_sums, float* __restrict counts,
                   float* __restrict rho_means, float* __restrict scatters, float* __restrict variance_means,
                   float* __restrict x_means, float* __restrict y_means) {
  const auto sum = [](const float* of, int cell) {
    const float* const first = of + kSize * cell;
    return first[0] + first[1] + first[2] + first[3];
  };
  for (int cell = 0; cell < grid.columns; ++cell) {
    const float count = sum(pixels, cell), share = count > 0.0F ? 1.0F / count : 0.0F;
    const float* const first = pixels + kSize * cell;
    const float rho = sum(rhos, cell), x = first[1] + 2.0F * first[2] + 3.0F * first[3];
    const float scatter = sum(squares, cell) * count / (rho * rho) - 1.0F;
    counts[cell] = count;
    rho_means[cell] = rho * share;
    scatters[cell] = greater(0.0F, scatter);
    variance_means[cell] = sum(variances, cell) * share;
    x_means[cell] = grid.x(static_cast<float>(kSize * cell) + x * share);
    y_means[cell] = grid.y(sum(row_sums, cell) * share);
  }
}

/// Turns a row's sums into means, and starts anew.
void finishRow(const CellGrid& grid, std::size_t first, std::vector<CellSums>* sums, CellMeans* means) {
  for (std::size_t column = 0; column < sums->size(); ++column) {
    if ((*sums)[column].pixels > 0.0F) setMeans(grid, (*sums)[column], first + column, means);
    (*sums)[column] = {};
  }
}

/// The rows of the image that are in a row of cells.
cv::Range pixelRows(const CellGrid& grid, int row) {
  return {kSize * row, std::min(kSize * (row + 1), grid.image.height)};
}

CellMeans emptyMeans(const CellGrid& grid, CellMeans buffer) {
  CellMeans means = std::move(buffer);
  means.pixels.assign(grid.size(), 0.0F);
  means.rho.assign(grid.size(), 0.0F);
  for (std::vector<float>* values : {&means.scatter, &means.variance, &means.x, &means.y})
    values->resize(grid.size());
  return means;
}

bool isOneSurface(const CellMeans& means, std::size_t cell, float fewest) {
  return means.pixels[cell] >= fewest && means.scatter[cell] < kStep * kStep;
}

/// Whether SfM's depth in a cell that is not published agrees with SfM's in three of the cells around it.
bool agreesWithOthers(const CellGrid& grid, const CellMeans& sfm, const CellMeans& withheld, int row,
                      int column) {
  const float here = withheld.rho[grid.index(row, column)];
  const auto agrees = [&](float there) { return std::abs(there - here) < kSurfaceStep * here; };
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

CellMeans cellMeans(const CellGrid& grid, const SfmPoints& points) {
  CellMeans means = emptyMeans(grid, {});
  std::vector<CellSums> sums(static_cast<std::size_t>(grid.columns));
  for (int row = 0; row < grid.rows; ++row) {
    const cv::Range rows = pixelRows(grid, row);
    for (int y = rows.start; y < rows.end; ++y) {
      for (std::size_t i = points.begin(y); i < points.end(y); ++i) {
        const auto x = static_cast<std::size_t>(points.columns[i]);
        if (points.sfm[i] > 0.0F)
          sums[x / kSize].add(static_cast<float>(x), static_cast<float>(y), points.sfm[i],
                              points.sfm_variance[i]);
      }
    }
    finishRow(grid, grid.index(row, 0), &sums, &means);
  }
  return means;
}

void meansOfUnseen(const CellGrid& grid, const SfmPoints& points, const cv::Mat_<std::uint8_t>& labels,
                   CellMeans* published, CellMeans* withheld) {
  CellMeans* const means[2] = {withheld, published};
  for (CellMeans* of : means) *of = emptyMeans(grid, std::move(*of));
  std::vector<CellSums> sums[2];
  for (std::vector<CellSums>& of : sums) of.resize(static_cast<std::size_t>(grid.columns));
  for (int row = 0; row < grid.rows; ++row) {
    const cv::Range rows = pixelRows(grid, row);
    for (int y = rows.start; y < rows.end; ++y) {
      const std::uint8_t* const of_row = labels[y];
      points.forEachUnseen(y, [&](std::size_t i) {
        const auto x = static_cast<std::size_t>(points.columns[i]);
        const std::size_t is_published = of_row[x] != 0 ? 1 : 0;
        sums[is_published][x / kSize].add(static_cast<float>(x), static_cast<float>(y), points.sfm[i],
                                          points.sfm_variance[i]);
      });
    }
    for (std::size_t i = 0; i < 2; ++i) finishRow(grid, grid.index(row, 0), &sums[i], means[i]);
  }
}

CellMeans cellMeans(const CellGrid& grid, const GaussianDepth& depth, const cv::Mat_<std::uint8_t>& labels,
                    int mask, int value, CellMeans buffer) {
  CellMeans means = emptyMeans(grid, std::move(buffer));
  if (depth.mean.empty()) return means;
  const auto width = static_cast<std::size_t>(grid.image.width);
  const std::vector<std::uint8_t> all(width, static_cast<std::uint8_t>(value));
  ColumnSums sums(static_cast<std::size_t>(kSize * grid.columns));
  for (int row = 0; row < grid.rows; ++row) {
    const cv::Range range = pixelRows(grid, row);
    const int count = range.size();
    PixelRow rows[kSize];
    for (int i = 0; i < count; ++i) {
      const int y = range.start + i;
      rows[i] = {depth.mean[y], depth.variance[y], labels.empty() ? all.data() : labels[y],
                 static_cast<float>(y)};
    }
    addRows(rows, count, mask, value, grid.image.width, sums.pixels.data(), sums.rho.data(),
            sums.square.data(), sums.variance.data(), sums.row.data());
    const std::size_t first = grid.index(row, 0);
    finishColumns(grid, sums.pixels.data(), sums.rho.data(), sums.square.data(), sums.variance.data(),
                  sums.row.data(), means.pixels.data() + first, means.rho.data() + first,
                  means.scatter.data() + first, means.variance.data() + first, means.x.data() + first,
                  means.y.data() + first);
  }
  return means;
}

Supports chooseSupports(const CellGrid& grid, const CellMeans& sensor, const CellMeans& sfm,
                        const CellMeans& withheld, const CommonVariance& common, Supports buffer) {
  using Source = Supports::Source;
  Supports supports = std::move(buffer);
  supports.source.assign(grid.size(), Source::kNone);
  for (std::vector<float>* values :
       {&supports.rho, &supports.variance, &supports.own, &supports.x, &supports.y})
    values->assign(grid.size(), 0.0F);
  const auto take = [&](const CellMeans& means, std::size_t cell, Source source) {
    supports.source[cell] = source;
    supports.rho[cell] = means.rho[cell];
    supports.variance[cell] = supports.own[cell] = means.variance[cell];
    supports.x[cell] = means.x[cell];
    supports.y[cell] = means.y[cell];
    if (source == Source::kSensor) return;
    if (common) {
      const double rho = static_cast<double>(means.rho[cell]),
                   shared = common(rho, grid.column(means.x[cell]), grid.row(means.y[cell])) / (rho * rho);
      supports.own[cell] = std::max(means.variance[cell] - static_cast<float>(shared), 0.0F);
    }
    if (source == Source::kWithheld) supports.variance[cell] += kWithheldSigma * kWithheldSigma;
  };
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t cell = grid.index(row, column);
      if (isOneSurface(sensor, cell, kFewestOfSensor)) {
        take(sensor, cell, Source::kSensor);
      } else if (isOneSurface(sfm, cell, kFewestOfSfm)) {
        take(sfm, cell, Source::kSfm);
      } else if (isOneSurface(withheld, cell, kFewestOfSfm) &&
                 agreesWithOthers(grid, sfm, withheld, row, column)) {
        take(withheld, cell, Source::kWithheld);
      }
    }
  }
  return supports;
}

}  // namespace rgbd_sfm_fusion
