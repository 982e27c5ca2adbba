// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/fusion/sensor_depth.h"
#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/row_points.h"
#include "rgbd_sfm_fusion/image/inverse_depth.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// The pixels of a frame that have SfM depth, in the order of the image, with the depths that are compared
/// there. Most pixels have none, so that what concerns SfM's depth is quicker on the list than on images.
class SfmPoints {
 public:
  /// Takes the place of the points before. Memory is allocated for the first frame only.
  /// @param depth   SfM's, of any unit
  /// @param sensor  of the same size
  void collect(const GaussianDepth& depth, const SensorDepth& sensor);

  /// This frame has no points.
  void clear();

  /// Drops the points on marked pixels, and writes the others into the images as they are now.
  /// @param marked  other than 0 where SfM's depth is dropped
  /// @param depth   images that the points were collected from
  void dropAndWrite(const cv::Mat_<std::uint8_t>& marked, GaussianDepth* depth);

  /// The points of row `y` are those from begin(y) up to, and without, end(y). None before collect().
  std::size_t begin(int y) const { return rows_.empty() ? 0 : rows_[static_cast<std::size_t>(y)]; }
  std::size_t end(int y) const { return begin(y + 1); }
  std::size_t size() const { return rows_.empty() ? 0 : rows_.back(); }

  /// Calls visit(i) for the points of row `y` that the sensor does not see, and that are not dropped.
  template <typename Visitor>
  void forEachUnseen(int y, const Visitor& visit) const {
    if (rows_.empty()) return;
    const auto row = static_cast<std::size_t>(y);
    for (std::size_t k = unseen_rows_[row]; k < unseen_rows_[row + 1]; ++k) {
      const std::size_t i = rows_[row] + static_cast<std::size_t>(unseen_[k]);
      if (sfm[i] > 0.0f) visit(i);
    }
  }

  /// Vectors are longer than the list, by a full block of lanes at least (simd.h): so loops may go over full
  /// blocks.
  std::vector<int> columns;
  /// As collected, or [m], [m²] once they are aligned; NaN = dropped since.
  std::vector<float> sfm, sfm_variance;
  std::vector<float> sensor;                             ///< [m] NaN = none
  std::vector<float> sensor_variance, surface_variance;  ///< [m²] see SensorDepth; NaN = none
  std::vector<float> of_any_range;                       ///< [m] see SensorDepth; NaN = not known

 private:
  void grow(const cv::Size& size);

  int width_ = 0;  // of row_
  RowPoints row_{0};
  std::vector<float> none_;  // a row without values
  std::vector<std::size_t> rows_;
  std::vector<std::size_t> unseen_rows_;  // likewise, of unseen_
  std::vector<int> unseen_;               // points without sensor depth, counted from their row's first
  std::vector<std::uint8_t> marks_;       // work space of a row
};

/// Pixels that have both depths: the paper's V, or an even sample of it. One entry per pixel in each array.
struct Overlap {
  static constexpr int kTileColumns = 8;
  static constexpr int kTileRows = 6;
  static constexpr std::size_t kTiles = kTileColumns * kTileRows;

  /// [σ] Tukey's biweight vanishes so far off. The width is small because outliers are asymmetric. At
  /// Gaussian errors, it costs a quarter of the efficiency; there are plenty of pixels.
  static constexpr double kTukeyWidth = static_cast<double>(kLargestByChance);
  static constexpr int kRounds = 6;                 ///< of reweighting, and of learning priors
  static constexpr std::size_t kMaxSamples = 4096;  ///< [px] enough, as errors of 10^5 pixels are correlated
  static constexpr double kOutlierSquare = 25.0;    ///< [σ²] chance does not make errors of 5 σ
  static constexpr double kMemory = 0.95;  ///< share of what was learned that a new frame (keyframe) leaves
  static constexpr double kPixelsOfOneError = 9.0;  ///< [px] that err alike: stereo and sensors match windows
  /// A tile with fewer is left out: all of them may have one error.
  static constexpr auto kMinTileSamples = static_cast<std::size_t>(kPixelsOfOneError);

  std::vector<float> sfm;              ///< μ, tracker units
  std::vector<float> sfm_variance;     ///< σ², tracker units squared
  std::vector<float> sensor;           ///< d [m]
  std::vector<float> sensor_variance;  ///< [m^2]
  std::vector<float> x, y;             ///< ray (x, y, 1) of the pixel
  std::vector<std::uint8_t> tile;      ///< tile of the image, counted row by row
  std::size_t pixels = 0;              ///< [px] |V|, estimated where the arrays are a sample

  std::size_t size() const { return sfm.size(); }

  /// How alike the errors of two tiles may be: 1 for a tile and itself, 1/2 for tiles side by side, 1/4
  /// across a corner, else 0.
  static double adjacency(std::size_t i, std::size_t j);

  /// [1/unit] Mean σ_ρ = σ/μ² of each tile's SfM depths; 0 where there are none.
  std::array<double, kTiles> meanInverseDepthSigma() const;
};

/// Sensor depth beyond its range is left out: it is biased, and has no say in the scale.
/// @param points       in tracker units
/// @param max_samples  largest number of points that are looked at; 0 = all
Overlap collectOverlap(const SfmPoints& points, const SensorDepth& sensor, const PinholeCamera& camera,
                       std::size_t max_samples);

}  // namespace rgbd_sfm_fusion
