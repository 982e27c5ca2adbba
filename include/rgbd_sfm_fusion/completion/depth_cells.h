// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "rgbd_sfm_fusion/fusion/sfm_points.h"
#include "rgbd_sfm_fusion/image/inverse_depth.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// The image in cells of kSize x kSize pixels, row by row. Positions are in units of 100 px from the image's
/// middle.
struct CellGrid {
  /// [px] Cells of 5 and 6 px would save a third and a half of completion's time. But where contours are
  /// thin, a larger cell is rather of two surfaces, and tells of none: a monitor in freiburg1_xyz that the
  /// sensor does not see is then filled with what is behind it (within 10 %: 95.5 % with 4 px, 93.6 with
  /// 5, 91.2 with 6).
  static constexpr int kSize = 4;
  static constexpr float kUnit = 100.0F;                                ///< [px]
  static constexpr float kSpacing = static_cast<float>(kSize) / kUnit;  ///< between neighbouring cells

  cv::Size image;  ///< [px]
  int rows = 0, columns = 0;

  CellGrid() = default;
  explicit CellGrid(const cv::Size& image_size)
      : image(image_size),
        rows((image_size.height + kSize - 1) / kSize),
        columns((image_size.width + kSize - 1) / kSize) {}

  std::size_t size() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns); }
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(column);
  }
  /// Position of a pixel's centre.
  float x(float pixel) const { return (pixel - 0.5F * static_cast<float>(image.width - 1)) / kUnit; }
  float y(float pixel) const { return (pixel - 0.5F * static_cast<float>(image.height - 1)) / kUnit; }
  /// The pixel at a position.
  float column(float x) const { return kUnit * x + 0.5F * static_cast<float>(image.width - 1); }
  float row(float y) const { return kUnit * y + 0.5F * static_cast<float>(image.height - 1); }
  float middleX(int column) const {
    return x(static_cast<float>(kSize * column) + 0.5F * static_cast<float>(kSize - 1));
  }
  float middleY(int row) const {
    return y(static_cast<float>(kSize * row) + 0.5F * static_cast<float>(kSize - 1));
  }
};

/// Means over those pixels of each cell that have a depth. Without such pixels, `pixels` and `rho` are 0, and
/// the others mean nothing.
struct CellMeans {
  std::vector<float> pixels;    ///< [px] how many have a depth
  std::vector<float> rho;       ///< [1/m] inverse depth
  std::vector<float> scatter;   ///< [1] mean square deviation from `rho`, relative to its square
  std::vector<float> variance;  ///< [1] mean variance of the pixels' inverse depth, relative to its square
  std::vector<float> x, y;      ///< position
};

/// @param labels  H x W; pixels count where (label & mask) == value. Empty: all pixels count
/// @param buffer  is overwritten and returned
CellMeans cellMeans(const CellGrid& grid, const GaussianDepth& depth, const cv::Mat_<std::uint8_t>& labels,
                    int mask, int value, CellMeans buffer = {});

/// Means over all points that are not dropped.
CellMeans cellMeans(const CellGrid& grid, const SfmPoints& points);

/// Means over the points that the sensor does not see.
/// @param labels     values of Provenance
/// @param published  [out] of points whose pixel has a label other than 0; its memory is used again
/// @param withheld   [out] of the other ones, likewise
void meansOfUnseen(const CellGrid& grid, const SfmPoints& points, const cv::Mat_<std::uint8_t>& labels,
                   CellMeans* published, CellMeans* withheld);

/// [1/m²] What the variances of all SfM depths have in common, at an inverse depth [1/m] and a pixel.
using CommonVariance = std::function<double(double rho, double x, double y)>;

/// Depths that a surface may be drawn through, at most one in each cell.
struct Supports {
  enum class Source : std::uint8_t {
    kNone,
    kSensor,
    kSfm,
    kWithheld,  ///< SfM's, but not published: too uncertain by itself
  };

  std::vector<Source> source;
  std::vector<float> rho, variance, x, y;  ///< as in CellMeans; 0 in cells without a support
  std::vector<float> own;  ///< [1] part of `variance` that the support does not share with all others

  bool isPublished(std::size_t cell) const {
    return source[cell] == Source::kSensor || source[cell] == Source::kSfm;
  }
  bool isOfSfm(std::size_t cell) const { return source[cell] >= Source::kSfm; }
};

/// Takes the sensor's depth where the sensor has two fifths of a cell, else SfM's where SfM has two pixels of
/// it. Depth of a source that has a step inside the cell is not taken.
///
/// SfM's depth along a contour is often not published, as it may be of either side, or wild. But where three
/// of the cells around agree with it, it is a support: several of them show which surface they are of. By
/// itself, it is known to a tenth.
/// @param sensor    as published
/// @param sfm       as published
/// @param withheld  of SfM's depth that is not published
/// @param common    empty: nothing
/// @param buffer    is overwritten and returned
Supports chooseSupports(const CellGrid& grid, const CellMeans& sensor, const CellMeans& sfm,
                        const CellMeans& withheld, const CommonVariance& common, Supports buffer = {});

}  // namespace rgbd_sfm_fusion
