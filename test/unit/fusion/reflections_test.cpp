// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/reflections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "rgbd_sfm_fusion/fusion/sfm_only.h"

namespace rgbd_sfm_fusion {
namespace {

using Eigen::Vector3d;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double kMaxRange = 5.0;      // [m]
constexpr double kCameraHeight = 1.4;  // [m]
const PinholeCamera kCamera{640, 480, 525.0, 525.0, 319.5, 239.5};

/// A wall n p = 1 that stands on a floor, with a hole in which the sensor sees nothing.
class Reflections : public testing::Test {
 protected:
  double wallDepth(int x, int y) const { return 1.0 / wall_.dot(kCamera.backProject(x, y, 1.0)); }
  double floorDepth(int y) const {
    const double slope = (y - kCamera.cy) / kCamera.fy;
    return slope > 0.0 ? kCameraHeight / slope : 1e9;
  }

  void forEachPixel(const std::function<void(int, int)>& visit) const {
    for (int y = 0; y < kCamera.height; ++y) {
      for (int x = 0; x < kCamera.width; ++x) visit(x, y);
    }
  }

  /// @param behind  depth that SfM sees in the hole, over the wall's depth
  int removedFromMirror(double behind) {
    forEachPixel([&](int x, int y) {
      sensor_(y, x) = static_cast<float>(std::min(wallDepth(x, y), floorDepth(y)));
      if (!hole_.contains({x, y})) return;
      sensor_(y, x) = kNaN;
      see(x, y, behind * wallDepth(x, y));
    });
    return removed();
  }

  /// The hole is an opening, whose walls reach down to the floor, with a room behind it.
  /// @param depth  [m] of the room behind the wall
  int removedFromDoorway(double depth) {
    forEachPixel([&](int x, int y) {
      const double through = hole_.contains({x, y}) ? depth : 0.0;
      const double z = std::min(wallDepth(x, y) + through, floorDepth(y));
      sensor_(y, x) = z <= kMaxRange ? static_cast<float>(z) : kNaN;
      if (hole_.contains({x, y})) see(x, y, z);
    });
    return removed();
  }

  int removed() {
    cv::Mat_<std::uint8_t> measured(sensor_.size());
    markMeasured(sensor_, measured);
    SfmPoints points;
    points.collect({sfm_, sfm_}, {{sensor_, {}}, {}, {}, {}});
    dropReflections(kCamera, sensor_, measured, points);
    int removed = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!std::isnan(points.sfm[i])) continue;
      EXPECT_TRUE(std::isnan(points.sensor[i]));
      ++removed;
    }
    return removed;
  }

  void see(int x, int y, double depth) { sfm_(y, x) = static_cast<float>(depth); }

  Vector3d wall_{0.1, 0.0, 0.4};  ///< [1/m] slanted, at 2.5 m
  cv::Rect hole_{200, 100, 160, 200};
  DepthImage sensor_ = DepthImage(480, 640);
  DepthImage sfm_ = DepthImage(480, 640, kNaN);
};

TEST_F(Reflections, WhatAMirrorShowsIsRemovedWhateverItsDistance) {
  for (const double behind : {1.9, 2.1, 4.0, 40.0})
    EXPECT_EQ(removedFromMirror(behind), hole_.area()) << behind;
}

TEST_F(Reflections, WhatLiesInTheWallOrBeforeItStays) {
  for (const double behind : {0.5, 0.9, 1.0, 1.1}) EXPECT_EQ(removedFromMirror(behind), 0) << behind;
}

TEST_F(Reflections, AMirrorThatTheImageCutsOffIsOne) {
  for (const cv::Rect& hole : {cv::Rect(200, 0, 160, 200), cv::Rect(0, 100, 160, 200),
                               cv::Rect(480, 100, 160, 200), cv::Rect(440, 0, 200, 280)}) {
    hole_ = hole;
    EXPECT_EQ(removedFromMirror(2.1), hole_.area()) << hole;
  }
}

TEST_F(Reflections, WhatTheImageCutsOffBelowMayBeADoorway) {
  hole_ = {200, 100, 160, 380};
  EXPECT_EQ(removedFromMirror(2.1), 0);
}

TEST_F(Reflections, WhatADoorwayShowsStays) {
  for (const double distance : {1.6, 2.5, 3.5, 4.3, 4.9}) {
    for (const double depth : {1.0, 3.0, 20.0}) {
      wall_ = Vector3d(0.0, 0.0, 1.0) / distance;
      hole_ = {220, 40, 180, 440};
      EXPECT_EQ(removedFromDoorway(depth), 0) << distance << " " << depth;
    }
  }
}

TEST_F(Reflections, WhatIsSeenThroughAHatchStaysIfTheSensorLooksThroughItsMirroredPlace) {
  wall_ = {0.0, 0.0, 0.25};
  hole_ = {240, 170, 160, 140};
  EXPECT_EQ(removedFromMirror(1.3), 0);
  EXPECT_EQ(removedFromMirror(1.5), 0);             // 2 m in front of the camera
  EXPECT_EQ(removedFromMirror(2.1), hole_.area());  // behind it
}

TEST_F(Reflections, ARimThatIsNotFlatOnOneSideIsNoMirrors) {
  for (const double step : {0.8, 1.3}) {
    const cv::Rect beside(hole_.x + hole_.width, hole_.y, 40, hole_.height);
    forEachPixel([&](int x, int y) {
      sensor_(y, x) = static_cast<float>(wallDepth(x, y) * (beside.contains({x, y}) ? step : 1.0));
      if (!hole_.contains({x, y})) return;
      sensor_(y, x) = kNaN;
      see(x, y, 2.1 * wallDepth(x, y));
    });
    EXPECT_EQ(removed(), 0) << step;
  }
}

TEST_F(Reflections, WithoutSensorDepthNothingIsRemoved) {
  sensor_.setTo(kNaN);
  forEachPixel([&](int x, int y) { see(x, y, 3.0); });
  EXPECT_EQ(removed(), 0);
}

}  // namespace
}  // namespace rgbd_sfm_fusion
