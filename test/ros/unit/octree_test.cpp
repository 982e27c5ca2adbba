// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause

/// @file
/// A planner's map, filled from the cloud by trust: at first only points that the sensor confirms, then all.
#include <gtest/gtest.h>

#ifdef RGBD_SFM_FUSION_HAS_OCTOMAP
#include <octomap/octomap.h>

#include <cmath>

#include "cloud_points.h"
#include "rgbd_sfm_fusion/ros/point_cloud.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kCell = 0.05;  // [m]
const PinholeCamera kCamera{64, 48, 60.0, 60.0, 31.5, 23.5};

/// A wall at 4 m. The sensor sees its left half (1; in every other row 3, fused). On the right half it sees
/// nothing. There, SfM (2) has a pillar at 2 m, and beside that the wall was completed (4).
FusedFrame wallWithPillar() {
  FusedFrame fused;
  const cv::Size size(kCamera.width, kCamera.height);
  fused.depth = {cv::Mat_<float>(size, 4.0F), cv::Mat_<float>(size, 1e-4F)};
  fused.provenance = cv::Mat_<std::uint8_t>(size, 1);
  for (int y = 1; y < size.height; y += 2) fused.provenance.row(y) = 3;
  const cv::Rect hole(32, 0, 32, 48), pillar(40, 0, 8, 48);
  fused.provenance(hole) = 4;
  fused.provenance(pillar) = 2;
  fused.depth.mean(pillar) = 2.0F;
  return fused;
}

void insert(octomap::OcTree& tree, const FusedFrame& fused, unsigned sources) {
  const auto message = toPointCloud({}, fused, kCamera, {}, {});
  const CloudPoints points(*message);
  octomap::Pointcloud cloud;
  for (int y = 0; y < kCamera.height; ++y) {
    for (int x = 0; x < kCamera.width; ++x) {
      if ((sources & sourceBit(points.label("provenance", y, x))) == 0) continue;
      cloud.push_back(points.number("x", y, x), points.number("y", y, x), points.number("z", y, x));
    }
  }
  tree.insertPointCloud(cloud, octomap::point3d(0, 0, 0));
}

enum class Cell { kUnknown, kFree, kOccupied };

/// The cell of the point at `depth` on a pixel's ray.
Cell cell(const octomap::OcTree& tree, int x, int y, double depth) {
  const Eigen::Vector3f place = kCamera.backProject(x, y, depth).cast<float>();
  const octomap::OcTreeNode* node = tree.search(octomap::point3d(place.x(), place.y(), place.z()));
  if (node == nullptr) return Cell::kUnknown;
  return tree.isNodeOccupied(node) ? Cell::kOccupied : Cell::kFree;
}

constexpr unsigned kConfirmed = sourceBit(1) | sourceBit(3);
constexpr unsigned kAll = kConfirmed | sourceBit(2) | sourceBit(4);

TEST(Octree, OfWhatTheSensorConfirmsKnowsNothingOfItsHole) {
  octomap::OcTree tree(kCell);
  insert(tree, wallWithPillar(), kConfirmed);
  for (const int y : {12, 13}) {  // sensor only, and fused
    EXPECT_EQ(cell(tree, 16, y, 4.0), Cell::kOccupied);
    EXPECT_EQ(cell(tree, 16, y, 3.0), Cell::kFree);
    EXPECT_EQ(cell(tree, 16, y, 4.3), Cell::kUnknown) << "behind the wall";
    EXPECT_EQ(cell(tree, 44, y, 2.0), Cell::kUnknown) << "the pillar";
    EXPECT_EQ(cell(tree, 44, y, 1.0), Cell::kUnknown) << "before it";
    EXPECT_EQ(cell(tree, 58, y, 4.0), Cell::kUnknown) << "completed";
  }
}

TEST(Octree, OfAllHasThePillarAndIsFreeBeforeIt) {
  octomap::OcTree tree(kCell);
  insert(tree, wallWithPillar(), kConfirmed);
  insert(tree, wallWithPillar(), kAll);
  EXPECT_EQ(cell(tree, 44, 12, 2.0), Cell::kOccupied);
  EXPECT_EQ(cell(tree, 44, 12, 1.0), Cell::kFree);
  EXPECT_EQ(cell(tree, 44, 12, 3.0), Cell::kUnknown) << "behind the pillar";
  EXPECT_EQ(cell(tree, 58, 12, 4.0), Cell::kOccupied);
  EXPECT_EQ(cell(tree, 58, 12, 3.0), Cell::kFree);
  EXPECT_EQ(cell(tree, 16, 12, 4.0), Cell::kOccupied) << "still";
}

TEST(Octree, IsClearedWhereThePillarHasGone) {
  octomap::OcTree tree(kCell);
  insert(tree, wallWithPillar(), kAll);
  FusedFrame fused = wallWithPillar();
  fused.depth.mean.setTo(4.0F);
  for (int i = 0; i < 3; ++i) insert(tree, fused, kConfirmed);
  EXPECT_EQ(cell(tree, 44, 12, 2.0), Cell::kOccupied) << "the sensor does not see there";
  for (int i = 0; i < 5; ++i) insert(tree, fused, kAll);
  EXPECT_EQ(cell(tree, 44, 12, 2.0), Cell::kFree);
  EXPECT_EQ(cell(tree, 44, 12, 4.0), Cell::kOccupied);
}

}  // namespace
}  // namespace rgbd_sfm_fusion

#else

TEST(Octree, IsFilledByTrust) {
  GTEST_SKIP() << "liboctomap-dev is not installed";
}

#endif
