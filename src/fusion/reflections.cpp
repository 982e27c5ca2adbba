// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/reflections.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kCell = 8;                // [px] of the grid on which holes are looked for
constexpr float kLeastFilled = 0.25F;   // share of a cell that is not one of a hole
constexpr int kSmallestHole = 12;       // [cells]
constexpr double kFlatness = 0.03;      // largest RMS deviation of the rim from a plane, relative
constexpr float kInRange = 0.9F;        // of the sensor's range: what it surely sees
constexpr double kLeastMissing = 0.25;  // of SfM's pixels in a hole, that lie behind its rim, but in range
constexpr float kBehind = 0.85F;        // inverse depth over the plane's, below which it is behind

/// Sums of inverse depth and of pixels that have any, cell by cell of a row of cells.
RGBD_SFM_FUSION_MULTIVERSION
void addRow(const float* depth, int cells, float* __restrict sum, float* __restrict count) {
  for (int cell = 0; cell < cells; ++cell) {
    float cell_sum = 0.0F, cell_count = 0.0F;
    for (int x = 0; x < kCell; ++x) {
      const float z = depth[kCell * cell + x];
      cell_sum += z > 0.0F ? 1.0F / z : 0.0F;
      cell_count += z > 0.0F ? 1.0F : 0.0F;
    }
    sum[cell] += cell_sum;
    count[cell] += cell_count;
  }
}

/// Mean inverse depth of each whole cell of the image; 0 in holes.
cv::Mat_<float> cellMeans(const DepthImage& sensor) {
  const cv::Size size(sensor.cols / kCell, sensor.rows / kCell);
  cv::Mat_<float> mean(size, 0.0F), count(size, 0.0F);
  for (int y = 0; y < size.height * kCell; ++y)
    addRow(sensor[y], size.width, mean[y / kCell], count[y / kCell]);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x)
      mean(y, x) = count(y, x) >= kLeastFilled * kCell * kCell ? mean(y, x) / count(y, x) : 0.0F;
  }
  return mean;
}

/// Inverse depth over cells, which is affine on a plane: a + b x + c y.
using Plane = Eigen::Vector3d;

double at(const Plane& plane, int x, int y) {
  return plane(0) + plane(1) * x + plane(2) * y;
}

/// The cells around a hole; empty where the image's edge cuts it off.
std::vector<cv::Point> rimOf(const cv::Mat_<std::uint8_t>& hole) {
  cv::Mat_<std::uint8_t> grown;
  cv::dilate(hole, grown, cv::Mat::ones(3, 3, CV_8U));
  std::vector<cv::Point> rim;
  for (int y = 0; y < hole.rows; ++y) {
    for (int x = 0; x < hole.cols; ++x) {
      const bool at_edge = x == 0 || y == 0 || x == hole.cols - 1 || y == hole.rows - 1;
      if (at_edge && hole(y, x) != 0) return {};
      if (grown(y, x) != 0 && hole(y, x) == 0) rim.emplace_back(x, y);
    }
  }
  return rim;
}

/// Whether the rim is flat, and then its plane.
bool fitPlane(const cv::Mat_<float>& means, const std::vector<cv::Point>& rim, Plane& plane) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  for (const cv::Point& cell : rim) {
    const Eigen::Vector3d J(1.0, cell.x, cell.y);
    H += J * J.transpose();
    g += J * static_cast<double>(means(cell));
  }
  plane = H.ldlt().solve(g);
  double square = 0.0;
  for (const cv::Point& cell : rim) {
    const double expected = at(plane, cell.x, cell.y);
    const double deviation = static_cast<double>(means(cell)) / expected - 1.0;
    square += expected > 0.0 ? deviation * deviation : 1.0;
  }
  return square <= kFlatness * kFlatness * static_cast<double>(rim.size());
}

/// Calls visit(y, x) for the pixels of cells that SfM alone sees, with the plane's depth there.
template <typename Visitor>
void forEachUnseen(const std::vector<cv::Point>& cells, const Plane& plane, const DepthImage& sensor,
                   const GaussianDepth& sfm, const Visitor& visit) {
  for (const cv::Point& cell : cells) {
    const double inverse_depth = at(plane, cell.x, cell.y);
    if (inverse_depth <= 0.0) continue;
    const auto depth = static_cast<float>(1.0 / inverse_depth);
    for (int y = cell.y * kCell; y < (cell.y + 1) * kCell; ++y) {
      for (int x = cell.x * kCell; x < (cell.x + 1) * kCell; ++x) {
        if (sfm.mean(y, x) > 0.0F && !(sensor(y, x) > 0.0F)) visit(y, x, depth);
      }
    }
  }
}

void removeBehind(const std::vector<cv::Point>& cells, const Plane& plane, const DepthImage& sensor,
                  float max_range, GaussianDepth& sfm) {
  int pixels = 0, missing = 0;
  forEachUnseen(cells, plane, sensor, sfm, [&](int y, int x, float depth) {
    const float z = sfm.mean(y, x);
    ++pixels;
    missing += kBehind * z > depth && z < kInRange * max_range ? 1 : 0;
  });
  if (missing == 0 || missing < kLeastMissing * pixels) return;
  forEachUnseen(cells, plane, sensor, sfm, [&](int y, int x, float depth) {
    if (kBehind * sfm.mean(y, x) > depth)
      sfm.mean(y, x) = sfm.variance(y, x) = std::numeric_limits<float>::quiet_NaN();
  });
}

}  // namespace

void removeReflections(const DepthImage& sensor, float max_range, GaussianDepth& sfm) {
  const cv::Mat_<float> means = cellMeans(sensor);
  cv::Mat_<std::int32_t> labels;
  cv::Mat statistics, centroids;
  const int count = cv::connectedComponentsWithStats(means == 0.0, labels, statistics, centroids, 4);
  for (int label = 1; label < count; ++label) {
    if (statistics.at<std::int32_t>(label, cv::CC_STAT_AREA) < kSmallestHole) continue;
    cv::Mat_<std::uint8_t> hole;
    cv::compare(labels, label, hole, cv::CMP_EQ);
    const std::vector<cv::Point> rim = rimOf(hole);
    Plane plane;
    if (rim.empty() || !fitPlane(means, rim, plane)) continue;
    cv::Mat_<std::uint8_t> with_rim;
    cv::dilate(hole, with_rim, cv::Mat::ones(3, 3, CV_8U));
    std::vector<cv::Point> cells;
    cv::findNonZero(with_rim, cells);
    removeBehind(cells, plane, sensor, max_range, sfm);
  }
}

}  // namespace rgbd_sfm_fusion
