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

constexpr int kCell = 8;  // [px] of the grid on which holes are looked for
constexpr int kBand = 3;  // [cells] width of the band around a hole that must be in one plane
constexpr auto kLargestError =
    static_cast<double>(kSurfaceStep);  // [1] error of depth that is no step, at most
constexpr int kSectors = 8;             // of that band: the sides and the corners of the hole
constexpr double kMost = 0.9;  // share of the cells of the band, or of the points, that have to agree
constexpr auto kFlatness = static_cast<double>(kStepRatio);  // [1] a cell so far off is not in the plane

/// The sums of eight rows.
RGBD_SFM_FUSION_MULTIVERSION
void addRows(const std::uint8_t* rows, std::size_t stride, int width, std::uint8_t* __restrict sums) {
  for (int x = 0; x < width; ++x) sums[x] = rows[x];
  for (std::size_t row = 1; row < kCell; ++row) {
    for (int x = 0; x < width; ++x)
      sums[x] = static_cast<std::uint8_t>(sums[x] + rows[row * stride + static_cast<std::size_t>(x)]);
  }
}

/// 1 for each whole cell of the image that the sensor sees less than half of, else 0.
cv::Mat_<std::uint8_t> emptyCells(const cv::Mat_<std::uint8_t>& measured) {
  cv::Mat_<std::uint8_t> empty(measured.rows / kCell, measured.cols / kCell);
  std::vector<std::uint8_t> columns(static_cast<std::size_t>(measured.cols));
  for (int y = 0; y < empty.rows; ++y) {
    addRows(measured[kCell * y], measured.step1(), measured.cols, columns.data());
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
  int label;
  cv::Rect box;        ///< around it
  cv::Point2d centre;  ///< of its cells
};

/// A hole's mask, grown to each side by some cells: not 0 in the hole and in the rim that it has grown by.
struct GrownHole {
  cv::Rect area;
  cv::Mat_<std::uint8_t> hole, grown;

  GrownHole(const cv::Mat_<std::int32_t>& labels, const Hole& of, int cells)
      : area(cv::Rect(of.box.x - cells, of.box.y - cells, of.box.width + 2 * cells,
                      of.box.height + 2 * cells) &
             cv::Rect({0, 0}, labels.size())) {
    cv::compare(labels(area), of.label, hole, cv::CMP_EQ);
    cv::dilate(hole, grown, cv::Mat::ones(2 * cells + 1, 2 * cells + 1, CV_8U));
  }

  /// Calls visit(cell, is_in_hole) for the cells of the grown hole.
  template <typename Visitor>
  void forEach(const Visitor& visit) const {
    for (int y = 0; y < area.height; ++y) {
      for (int x = 0; x < area.width; ++x) {
        if (grown(y, x) != 0) visit(area.tl() + cv::Point(x, y), hole(y, x) != 0);
      }
    }
  }
};

/// The cells of a hole, and cells that touch it: SfM alone may see something there.
std::vector<cv::Point> cellsOf(const cv::Mat_<std::int32_t>& labels, const Hole& hole) {
  std::vector<cv::Point> cells;
  GrownHole(labels, hole, 1).forEach([&](const cv::Point& cell, bool) { cells.push_back(cell); });
  return cells;
}

std::vector<BandCell> bandAround(const PinholeCamera& camera, const DepthImage& sensor,
                                 const cv::Mat_<std::int32_t>& labels, const Hole& hole) {
  std::vector<BandCell> band;
  GrownHole(labels, hole, kBand).forEach([&](const cv::Point& cell, bool is_in_hole) {
    if (is_in_hole) return;
    const double turn =
        std::atan2((cell.y - hole.centre.y) * hole.box.width, (cell.x - hole.centre.x) * hole.box.height) /
        (2.0 * M_PI);
    const double x_image = kCell * (cell.x + 0.5) - 0.5, y_image = kCell * (cell.y + 0.5) - 0.5;
    const float inverse_depth = labels(cell) == 0 ? meanInverseDepth(sensor, cell) : 0.0F;
    band.push_back({camera.backProject(x_image, y_image, 1.0), static_cast<double>(inverse_depth),
                    static_cast<int>((turn + 1.0) * kSectors + 0.5) % kSectors});
  });
  return band;
}

/// The vector n [1/m] of a plane n p = 1. The inverse depth along a ray r is n r, since p = Z r.
using Plane = Eigen::Vector3d;

bool isIn(const Plane& plane, const BandCell& cell, double tolerance) {
  const double expected = plane.dot(cell.ray);
  return cell.inverse_depth > 0.0 && std::abs(cell.inverse_depth - expected) <= tolerance * expected;
}

/// Whether a point is farther than the plane, by more than the errors of both.
bool isBehind(const Plane& plane, const Eigen::Vector3d& point) {
  return plane.dot(point) > 1.0 + 2.0 * kLargestError;
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
  return real.z() < (1.0 - kLargestError) * static_cast<double>(sensor(cv::Point(pixel)));  // rounded
}

/// A point that SfM alone sees, and where.
struct UnseenPoint {
  std::size_t index;      ///< in the list of points
  Eigen::Vector3d point;  ///< [m]
};

std::vector<UnseenPoint> unseenPoints(const std::vector<cv::Point>& cells, const PinholeCamera& camera,
                                      const SfmPoints& sfm) {
  std::vector<UnseenPoint> points;
  for (const cv::Point& cell : cells) {
    for (int y = cell.y * kCell; y < (cell.y + 1) * kCell; ++y) {
      const int *const first = sfm.columns.data() + sfm.begin(y), *const end =
                                                                      sfm.columns.data() + sfm.end(y);
      for (const int* x = std::lower_bound(first, end, cell.x * kCell); x < end && *x < (cell.x + 1) * kCell;
           ++x) {
        const auto i = static_cast<std::size_t>(x - sfm.columns.data());
        const float z = sfm.sfm[i];
        if (z > 0.0F && !(sfm.sensor[i] > 0.0F))
          points.push_back({i, camera.backProject(*x, y, static_cast<double>(z))});
      }
    }
  }
  return points;
}

/// Whether SfM's depth in a hole is behind the plane around the hole, and may be the image of something real.
bool showsReflections(const std::vector<UnseenPoint>& points, const Plane& plane, const PinholeCamera& camera,
                      const DepthImage& sensor) {
  std::size_t behind = 0, free = 0;
  for (const UnseenPoint& seen : points) {
    if (!isBehind(plane, seen.point)) continue;
    ++behind;
    free += wouldBeInFreeSpace(camera, sensor, plane, seen.point) ? 1u : 0u;
  }
  return behind > 0 && 2 * behind >= points.size() &&
         static_cast<double>(behind - free) >= kMost * static_cast<double>(behind);
}

}  // namespace

std::vector<cv::Rect> dropReflections(const PinholeCamera& camera, const DepthImage& sensor,
                                      const cv::Mat_<std::uint8_t>& measured, SfmPoints& sfm) {
  std::vector<cv::Rect> mirrors;
  cv::Mat_<std::int32_t> labels, statistics;
  cv::Mat_<double> centroids;
  const int count = cv::connectedComponentsWithStats(emptyCells(measured), labels, statistics, centroids, 4);
  for (int label = 1; label < count; ++label) {
    const std::int32_t* of = statistics[label];
    const Hole hole{
        label,
        {of[cv::CC_STAT_LEFT], of[cv::CC_STAT_TOP], of[cv::CC_STAT_WIDTH], of[cv::CC_STAT_HEIGHT]},
        {centroids(label, 0), centroids(label, 1)}};
    const bool cut_below = hole.box.br().y == labels.rows;
    if (of[cv::CC_STAT_AREA] < kBand * kBand || cut_below) continue;
    const std::vector<cv::Point> cells = cellsOf(labels, hole);
    const std::vector<BandCell> band = bandAround(camera, sensor, labels, hole);
    const Plane plane = fitPlane(band);
    if (!isFlat(band, plane)) continue;
    const std::vector<UnseenPoint> points = unseenPoints(cells, camera, sfm);
    if (!showsReflections(points, plane, camera, sensor)) continue;
    for (const UnseenPoint& seen : points) {
      if (isBehind(plane, seen.point)) sfm.sfm[seen.index] = sfm.sfm_variance[seen.index] = kNoDepth;
    }
    for (const cv::Point& cell : cells) mirrors.emplace_back(kCell * cell, cv::Size(kCell, kCell));
  }
  return mirrors;
}

}  // namespace rgbd_sfm_fusion
