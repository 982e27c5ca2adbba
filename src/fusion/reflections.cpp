// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/reflections.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "rgbd_sfm_fusion/multiversion.h"
#include "rgbd_sfm_fusion/sensor/lateral_variance.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr int kCell = 8;        // [px] of the grid on which holes are looked for
constexpr int kBand = 3;        // [cells] width of the band around a hole that must be in one plane
constexpr double kRight = 0.1;  // [1] error of depth that is no step, at most
constexpr int kSectors = 8;     // of that band: the sides and the corners of the hole
constexpr double kMost = 0.9;   // share of the cells of the band, or of the points, that have to agree
constexpr auto kFlatness = static_cast<double>(kStepRatio);  // [1] a cell so far off is not in the plane

RGBD_SFM_FUSION_MULTIVERSION
void countColumns(const float* depth, int width, std::int32_t* __restrict counts) {
  for (int x = 0; x < width; ++x) counts[x] += depth[x] > 0.0F ? 1 : 0;
}

/// 1 for each whole cell of the image that the sensor sees less than half of, else 0.
cv::Mat_<std::uint8_t> emptyCells(const DepthImage& sensor) {
  cv::Mat_<std::uint8_t> empty(sensor.rows / kCell, sensor.cols / kCell);
  std::vector<std::int32_t> columns(static_cast<std::size_t>(sensor.cols));
  for (int y = 0; y < empty.rows; ++y) {
    std::fill(columns.begin(), columns.end(), 0);
    for (int row = 0; row < kCell; ++row) countColumns(sensor[kCell * y + row], sensor.cols, columns.data());
    for (int x = 0; x < empty.cols; ++x) {
      const auto first = columns.begin() + kCell * x;
      empty(y, x) = 2 * std::accumulate(first, first + kCell, 0) < kCell * kCell ? 1 : 0;
    }
  }
  return empty;
}

/// [1/m] Mean of a cell that is not empty.
float meanInverseDepth(const DepthImage& sensor, const cv::Point& cell) {
  float sum = 0.0F, count = 0.0F;
  for (int y = cell.y * kCell; y < (cell.y + 1) * kCell; ++y) {
    float row_sum = 0.0F;
    for (int x = cell.x * kCell; x < (cell.x + 1) * kCell; ++x) {
      const float z = sensor(y, x);
      row_sum += z > 0.0F ? 1.0F / z : 0.0F;
      count += z > 0.0F ? 1.0F : 0.0F;
    }
    sum += row_sum;
  }
  return sum / count;
}

/// One cell of the band around a hole.
struct BandCell {
  Eigen::Vector3d ray;   ///< to its middle, at depth 1
  double inverse_depth;  ///< [1/m] 0 = none
  int sector;
};

struct Hole {
  std::vector<cv::Point> cells;  ///< of the hole, and cells that touch it: SfM alone may see something there
  std::vector<BandCell> band;
  bool cut_below = false;  ///< the lower edge of the image cuts the hole off
};

/// The hole with a label.
/// @param box     around it
/// @param centre  of its cells
Hole extractHole(const PinholeCamera& camera, const DepthImage& sensor, const cv::Mat_<std::int32_t>& labels,
                 int label, const cv::Rect& box, const cv::Point2d& centre) {
  const cv::Rect area =
      cv::Rect(box.x - kBand, box.y - kBand, box.width + 2 * kBand, box.height + 2 * kBand) &
      cv::Rect({0, 0}, labels.size());
  cv::Mat_<std::uint8_t> hole, with_rim, with_band;
  cv::compare(labels(area), label, hole, cv::CMP_EQ);
  cv::dilate(hole, with_rim, cv::Mat::ones(3, 3, CV_8U));
  cv::dilate(hole, with_band, cv::Mat::ones(2 * kBand + 1, 2 * kBand + 1, CV_8U));
  Hole result;
  result.cut_below = box.br().y == labels.rows;
  for (int y = 0; y < area.height; ++y) {
    for (int x = 0; x < area.width; ++x) {
      const cv::Point cell = area.tl() + cv::Point(x, y);
      if (with_rim(y, x) != 0) result.cells.push_back(cell);
      if (with_band(y, x) == 0 || hole(y, x) != 0) continue;
      const double turn =
          std::atan2((cell.y - centre.y) * box.width, (cell.x - centre.x) * box.height) / (2.0 * M_PI);
      const double x_image = kCell * (cell.x + 0.5) - 0.5, y_image = kCell * (cell.y + 0.5) - 0.5;
      const float inverse_depth = labels(cell) == 0 ? meanInverseDepth(sensor, cell) : 0.0F;
      result.band.push_back({camera.backProject(x_image, y_image, 1.0), static_cast<double>(inverse_depth),
                             static_cast<int>((turn + 1.0) * kSectors + 0.5) % kSectors});
    }
  }
  return result;
}

/// The vector n [1/m] of a plane n p = 1. The inverse depth along a ray r is n r, since p = Z r.
using Plane = Eigen::Vector3d;

bool isIn(const Plane& plane, const BandCell& cell, double tolerance) {
  const double expected = plane.dot(cell.ray);
  return cell.inverse_depth > 0.0 && std::abs(cell.inverse_depth - expected) <= tolerance * expected;
}

/// Whether a point is farther than the plane, by more than the errors of both.
bool isBehind(const Plane& plane, const Eigen::Vector3d& point) {
  return plane.dot(point) > 1.0 + 2.0 * kRight;
}

/// Least squares, repeated. Each round uses the cells that are near to the plane of the last round, within
/// ever narrower bounds.
Plane fitPlane(const std::vector<BandCell>& band) {
  Plane plane = Plane::Zero();
  for (const double tolerance : {0.0, 4.0 * kFlatness, 2.0 * kFlatness, kFlatness}) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const BandCell& cell : band) {
      const bool first = tolerance == 0.0 && cell.inverse_depth > 0.0;
      if (!first && !isIn(plane, cell, tolerance)) continue;
      H += cell.ray * cell.ray.transpose();
      g += cell.ray * cell.inverse_depth;
    }
    plane = H.ldlt().solve(g);
  }
  return plane;
}

/// Whether most of the band is in the plane, and the greater part of it on each side of the hole, as far as
/// the image shows them. It has to show half of the sides.
bool isFlat(const std::vector<BandCell>& band, const Plane& plane) {
  std::array<int, kSectors> flat{}, all{};
  int measured = 0;
  for (const BandCell& cell : band) {
    const auto sector = static_cast<std::size_t>(cell.sector);
    ++all[sector];
    flat[sector] += isIn(plane, cell, kFlatness) ? 1 : 0;
    measured += cell.inverse_depth > 0.0 ? 1 : 0;
  }
  int sectors = 0, total = 0;
  for (std::size_t sector = 0; sector < kSectors; ++sector) {
    if (2 * flat[sector] < all[sector]) return false;
    sectors += all[sector] > 0 ? 1 : 0;
    total += flat[sector];
  }
  return 2 * sectors >= kSectors && total >= kMost * measured;
}

/// Takes the plane for a mirror, and mirrors a point that is behind it. Returns whether the sensor looks
/// through the mirrored place.
bool wouldBeInFreeSpace(const PinholeCamera& camera, const DepthImage& sensor, const Plane& plane,
                        const Eigen::Vector3d& point) {
  const Eigen::Vector3d real = point - 2.0 * (plane.dot(point) - 1.0) / plane.squaredNorm() * plane;
  if (real.z() <= 0.0) return false;
  const cv::Point2d pixel(camera.fx * real.x() / real.z() + camera.cx,
                          camera.fy * real.y() / real.z() + camera.cy);
  const cv::Rect2d image(0.0, 0.0, sensor.cols - 1.0, sensor.rows - 1.0);
  if (!image.contains(pixel)) return false;
  return real.z() < (1.0 - kRight) * static_cast<double>(sensor(cv::Point(pixel)));  // rounded
}

/// Calls visit(y, x, point) for every pixel of the cells that SfM alone sees.
template <typename Visitor>
void forEachUnseen(const std::vector<cv::Point>& cells, const PinholeCamera& camera, const DepthImage& sensor,
                   const GaussianDepth& sfm, const Visitor& visit) {
  for (const cv::Point& cell : cells) {
    for (int y = cell.y * kCell; y < (cell.y + 1) * kCell; ++y) {
      for (int x = cell.x * kCell; x < (cell.x + 1) * kCell; ++x) {
        const float z = sfm.mean(y, x);
        if (z > 0.0F && !(sensor(y, x) > 0.0F)) visit(y, x, camera.backProject(x, y, static_cast<double>(z)));
      }
    }
  }
}

/// Whether SfM's depth in a hole is behind the plane around the hole, and may be the image of something real.
bool showsReflections(const Hole& hole, const Plane& plane, const PinholeCamera& camera,
                      const DepthImage& sensor, const GaussianDepth& sfm) {
  int seen = 0, behind = 0, free = 0;
  forEachUnseen(hole.cells, camera, sensor, sfm, [&](int, int, const Eigen::Vector3d& point) {
    ++seen;
    if (!isBehind(plane, point)) return;
    ++behind;
    free += wouldBeInFreeSpace(camera, sensor, plane, point) ? 1 : 0;
  });
  return behind > 0 && 2 * behind >= seen && behind - free >= kMost * behind;
}

}  // namespace

std::vector<cv::Rect> removeReflections(const PinholeCamera& camera, const DepthImage& sensor,
                                        GaussianDepth& sfm) {
  std::vector<cv::Rect> mirrors;
  cv::Mat_<std::int32_t> labels, statistics;
  cv::Mat_<double> centroids;
  const int count = cv::connectedComponentsWithStats(emptyCells(sensor), labels, statistics, centroids, 4);
  for (int label = 1; label < count; ++label) {
    const std::int32_t* of = statistics[label];
    if (of[cv::CC_STAT_AREA] < kBand * kBand) continue;
    const cv::Rect box(of[cv::CC_STAT_LEFT], of[cv::CC_STAT_TOP], of[cv::CC_STAT_WIDTH],
                       of[cv::CC_STAT_HEIGHT]);
    const Hole hole =
        extractHole(camera, sensor, labels, label, box, {centroids(label, 0), centroids(label, 1)});
    if (hole.cut_below) continue;
    const Plane plane = fitPlane(hole.band);
    if (!isFlat(hole.band, plane) || !showsReflections(hole, plane, camera, sensor, sfm)) continue;
    forEachUnseen(hole.cells, camera, sensor, sfm, [&](int y, int x, const Eigen::Vector3d& point) {
      if (isBehind(plane, point)) sfm.mean(y, x) = sfm.variance(y, x) = kNoDepth;
    });
    for (const cv::Point& cell : hole.cells) mirrors.emplace_back(kCell * cell, cv::Size(kCell, kCell));
  }
  return mirrors;
}

}  // namespace rgbd_sfm_fusion
