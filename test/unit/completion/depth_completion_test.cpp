// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/completion/depth_completion.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "unit/completion/completion_scene.h"

namespace rgbd_sfm_fusion {
namespace {

using test::completed;
using test::CompletedScene;
using test::CompletionScene;
using test::makeScene;
using test::slantedPlane;

const cv::Rect kHole(60, 40, 200, 160);

/// Largest relative error of completed depth.
double largestError(const CompletedScene& made) {
  double largest = 0.0;
  for (int y = 0; y < made.truth.rows; ++y) {
    for (int x = 0; x < made.truth.cols; ++x) {
      if (!made.isCompleted(x, y)) continue;
      const float z = made.truth(y, x);
      largest = std::max(largest, static_cast<double>(std::abs(made.depth.mean(y, x) - z) / z));
    }
  }
  return largest;
}

TEST(DepthCompletion, FillsAPlaneBetweenItsSupports) {
  const CompletedScene made = completed(slantedPlane());
  EXPECT_GT(made.completedShare(kHole), 0.8);
  EXPECT_LT(largestError(made), 1e-3);
  std::uint64_t labelled = 0;
  for (int y = 0; y < made.truth.rows; ++y) {
    for (int x = 0; x < made.truth.cols; ++x) {
      labelled += made.isCompleted(x, y) ? 1U : 0U;
      ASSERT_EQ(made.provenance(y, x) != 0, made.depth.mean(y, x) > 0.0F);
      ASSERT_EQ(made.provenance(y, x) != 0, made.depth.variance(y, x) > 0.0F);
    }
  }
  EXPECT_EQ(made.completed, labelled);
}

TEST(DepthCompletion, LeavesMeasuredDepthAsItIs) {
  CompletedScene before = makeScene(slantedPlane());
  const CompletedScene after = completed(slantedPlane());
  for (int y = 0; y < before.truth.rows; ++y) {
    for (int x = 0; x < before.truth.cols; ++x) {
      if (before.provenance(y, x) == 0) continue;
      ASSERT_EQ(after.provenance(y, x), before.provenance(y, x));
      ASSERT_EQ(after.depth.mean(y, x), before.depth.mean(y, x));
      ASSERT_EQ(after.depth.variance(y, x), before.depth.variance(y, x));
    }
  }
}

TEST(DepthCompletion, NothingIsCompletedWithoutSupport) {
  CompletionScene none;
  EXPECT_EQ(completed(none).completed, 0U);
  CompletionScene rim = slantedPlane();
  rim.seen = [](int x, int y) {
    return kHole.contains({x, y}) ? CompletionScene::kByNone : CompletionScene::kBySensor;
  };
  EXPECT_EQ(completed(rim).completed, 0U);
  rim.seen = [](int x, int y) {  // a doorway: its edge runs through cells that the sensor sees in part
    return kHole.contains({x - 2, y - 2}) ? CompletionScene::kByNone : CompletionScene::kBySensor;
  };
  EXPECT_EQ(completed(rim).completed, 0U);
  CompletionScene all = slantedPlane();
  all.seen = [](int, int) { return CompletionScene::kBySensor; };
  EXPECT_EQ(completed(all).completed, 0U);
}

TEST(DepthCompletion, GapsInOnePlaneNeedNoSfm) {
  CompletionScene scene = slantedPlane();
  const cv::Rect gap(120, 80, 32, 32);
  scene.seen = [gap](int x, int y) {
    return gap.contains({x, y}) ? CompletionScene::kByNone : CompletionScene::kBySensor;
  };
  EXPECT_GT(completed(scene).completedShare(gap), 0.99);
  EXPECT_LT(largestError(completed(scene)), 1e-3);
  CompletionScene framed = scene;  // another colour may be another surface
  framed.grey = [gap](int x, int y) { return gap.contains({x, y}) ? 250 : 100; };
  EXPECT_EQ(completed(framed).completed, 0U);
  CompletionScene folded = scene;  // the rim lies in two planes
  folded.rho = [](int x, int) { return 0.5F + 1e-3F * std::abs(static_cast<float>(x - 136)); };
  EXPECT_EQ(completed(folded).completed, 0U);
}

/// A near surface in front of a far one. The sensor does not see the far surface in some columns to the left
/// of the near one.
CompletionScene shadowed(int width) {
  CompletionScene scene;
  scene.rho = [](int x, int y) {
    return x >= 200 ? 0.8F : 0.4F + 2e-4F * static_cast<float>(x) + 1e-4F * static_cast<float>(y);
  };
  scene.grey = [](int x, int) { return x >= 200 ? 200 : 100; };
  scene.seen = [width](int x, int) {
    return x >= 200 - width && x < 200 ? CompletionScene::kByNone : CompletionScene::kBySensor;
  };
  return scene;
}

TEST(DepthCompletion, ShadowsLieOnTheFartherSurface) {
  // 525 px x 0.075 m x 0.36 / m = 14 px of disparity between the two.
  const CompletedScene made = completed(shadowed(16));
  EXPECT_GT(made.completedShare({184, 0, 12, 240}), 0.99);
  EXPECT_LT(largestError(made), 0.01);  // no depth on the near surface, nor between the two
  // Wider holes are no shadows of that step. With a camera whose disparity is not known, no hole is a shadow.
  EXPECT_EQ(completed(shadowed(32)).completed, 0U);
  DepthCompletion completion;
  CompletedScene unknown = makeScene(shadowed(16));
  completion.complete(
      {unknown.grey, unknown.sensor, SfmPoints(), {}, 0.12, 0.0F, {}, unknown.depth, unknown.provenance});
  EXPECT_EQ(cv::countNonZero(unknown.provenance == 4), 0);
}

TEST(DepthCompletion, ShadowsAreNotContinuedBesideAStillFartherSurface) {
  CompletionScene scene = shadowed(16);
  const auto rho = scene.rho;
  scene.rho = [rho](int x, int y) { return x < 200 && y >= 120 ? 0.15F : rho(x, y); };
  const CompletedScene made = completed(scene);
  EXPECT_GT(made.completedShare({184, 0, 12, 80}), 0.99);
  EXPECT_LT(made.completedShare({184, 104, 12, 16}), 0.1);
}

TEST(DepthCompletion, ShadowsAreLeftToSfmThatContradicts) {
  CompletionScene scene = shadowed(16);
  const auto rho = scene.rho;
  scene.rho = [rho](int x, int y) { return x >= 188 && x < 192 ? 0.6F : rho(x, y); };  // a third surface
  scene.seen = [](int x, int) {
    if (x < 184 || x >= 200) return CompletionScene::kBySensor;
    return x >= 188 && x < 192 ? CompletionScene::kBySfm : CompletionScene::kByNone;
  };
  EXPECT_EQ(completed(scene).completedShare({184, 8, 16, 224}), 0.0);
}

TEST(DepthCompletion, NothingIsContinuedInFrontOfANearerSurface) {
  CompletionScene scene = shadowed(8);
  scene.rho = [](int x, int) {  // continued, the far surface would come out in front of the near one
    return x >= 200 ? 0.42F : std::max(0.1F, 0.4F - 6e-3F * static_cast<float>(192 - x));
  };
  scene.seen = [](int x, int) {
    return x >= 152 && (x < 192 || x >= 200) ? CompletionScene::kBySensor : CompletionScene::kByNone;
  };
  EXPECT_EQ(completed(scene).completed, 0U);
}

TEST(DepthCompletion, NothingIsCompletedBesideItsSupports) {
  CompletionScene scene = slantedPlane();
  scene.seen = [](int x, int y) {  // a few columns to the left; beyond them is sky
    return x < 40 && (x % 8 < 3 || y % 8 < 3) ? CompletionScene::kBySfm : CompletionScene::kByNone;
  };
  const CompletedScene made = completed(scene);
  EXPECT_GT(made.completedShare({8, 8, 24, 220}), 0.3);
  EXPECT_EQ(made.completedShare({48, 0, 272, 240}), 0.0);
}

TEST(DepthCompletion, SfmInAHoleDecidesAgainstANearerRim) {
  CompletionScene scene = slantedPlane();  // a window: the sensor sees its frame only
  scene.rho = [](int x, int y) { return cv::Rect(60, 40, 200, 160).contains({x, y}) ? 0.4F : 0.8F; };
  const CompletedScene made = completed(scene);
  EXPECT_GT(made.completedShare({100, 80, 120, 80}), 0.7);
  EXPECT_LT(largestError(made), 0.05);
}

TEST(DepthCompletion, NeverMakesADepthBetweenTwoSurfaces) {
  for (const bool has_edge : {true, false}) {  // with and without an edge in the image
    CompletionScene scene = slantedPlane();
    const auto is_near = [](int x, int y) { return x + y / 8 > 165; };
    scene.rho = [is_near](int x, int y) { return is_near(x, y) ? 0.8F : 0.4F; };
    scene.grey = [is_near, has_edge](int x, int y) { return has_edge && is_near(x, y) ? 160 : 100; };
    const CompletedScene made = completed(scene);
    EXPECT_GT(made.completedShare(kHole), has_edge ? 0.25 : 0.0) << has_edge;
    int between = 0;
    for (int y = 0; y < made.truth.rows; ++y) {
      for (int x = 0; x < made.truth.cols; ++x) {
        const float z = made.depth.mean(y, x);
        between += made.isCompleted(x, y) && z > 1.35F && z < 2.3F ? 1 : 0;  // more than 8 % off both
      }
    }
    EXPECT_EQ(between, 0) << has_edge;
  }
}

TEST(DepthCompletion, TakesAGapForClosedOnlyInsideTheImage) {
  CompletionScene scene = slantedPlane();
  const cv::Rect gap(0, 80, 24, 32);
  scene.seen = [gap](int x, int y) {
    return gap.contains({x, y}) ? CompletionScene::kByNone : CompletionScene::kBySensor;
  };
  const CompletedScene made = completed(scene);
  EXPECT_EQ(made.completedShare({0, 80, 4, 32}), 0.0);
  EXPECT_GT(made.completedShare({12, 84, 8, 24}), 0.9);
}

TEST(DepthCompletion, KeepsAwayFromAnOcclusion) {
  CompletionScene scene = slantedPlane();
  scene.rho = [](int x, int) { return x > 162 ? 0.8F : 0.4F; };
  scene.grey = [](int x, int) { return x > 162 ? 160 : 100; };
  EXPECT_LT(largestError(completed(scene)), 0.05);
}

// SfM's pixels at a contour are of the nearer side, but reach over to the other one, of which nothing is
// known.
TEST(DepthCompletion, EndsAtAContourThatSfmStraddles) {
  constexpr int kContour = 162, kStraddled = 5;
  CompletionScene scene = slantedPlane();
  scene.grey = [](int x, int) { return x >= kContour ? 160 : 100; };
  scene.seen = [](int x, int y) {
    if (x >= 240 || (x >= kContour && (y < 40 || y >= 200))) return CompletionScene::kBySensor;
    return x >= kContour - kStraddled && (x < kContour + 3 || y % 20 < 3) ? CompletionScene::kBySfm
                                                                          : CompletionScene::kByNone;
  };
  const CompletedScene made = completed(scene);
  EXPECT_GT(made.completedShare({kContour + 4, 60, 60, 120}), 0.6);
  EXPECT_EQ(made.completedShare({0, 60, kContour, 120}), 0.0);
}

TEST(DepthCompletion, NothingIsCompletedAcrossAMirror) {
  const cv::Rect mirror(96, 80, 64, 64);
  const CompletedScene made = completed(slantedPlane(), {mirror});
  EXPECT_EQ(made.completedShare(mirror), 0.0);
  EXPECT_GT(made.completed, 5000U);
}

TEST(DepthCompletion, IsTheSameWhateverTheNumberOfThreads) {
  const int threads = cv::getNumThreads();
  std::vector<CompletedScene> results;
  for (const int count : {1, 4}) {
    cv::setNumThreads(count);
    DepthCompletion completion;
    CompletionScene scene = slantedPlane();
    scene.pixel_noise = 0.02F;
    for (unsigned frame = 0; frame < 6; ++frame) {
      CompletedScene made = makeScene(scene, frame);
      test::complete(completion, made);
      if (frame == 5) results.push_back(made);
    }
  }
  cv::setNumThreads(threads);
  EXPECT_EQ(cv::countNonZero(results[0].provenance != results[1].provenance), 0);
  EXPECT_EQ(cv::countNonZero((results[0].depth.mean != results[1].depth.mean) & (results[0].provenance != 0)),
            0);
  EXPECT_EQ(cv::countNonZero((results[0].depth.variance != results[1].depth.variance) &
                             (results[0].provenance != 0)),
            0);
}

/// A dark screen before a farther wall. The sensor sees the wall only; SfM sees the screen's contour, but is
/// too uncertain of it to be published.
CompletedScene darkScreen() {
  CompletionScene scene;
  const cv::Rect screen(80, 60, 160, 120), inside(90, 70, 140, 100);
  scene.rho = [=](int x, int y) { return screen.contains({x, y}) ? 1.0F : 0.6F; };
  scene.grey = [=](int x, int y) { return screen.contains({x, y}) ? 20 : 40; };
  scene.seen = [=](int x, int y) {
    if (inside.contains({x, y})) return CompletionScene::kByNone;
    return screen.contains({x, y}) ? CompletionScene::kBySfm : CompletionScene::kBySensor;
  };
  CompletedScene made = makeScene(scene);
  const cv::Mat sfm_only = made.provenance == static_cast<int>(Provenance::kSfm);
  made.provenance.setTo(0, sfm_only);
  made.depth.mean.setTo(kNoDepth, sfm_only);
  made.depth.variance.setTo(kNoDepth, sfm_only);
  return made;
}

TEST(DepthCompletion, WithheldDepthsThatAgreeShowTheSurface) {
  CompletedScene made = darkScreen();
  DepthCompletion completion;
  complete(completion, made);
  const cv::Rect middle(110, 85, 100, 70);
  EXPECT_GT(made.completedShare(middle), 0.7);
  for (int y = middle.y; y < middle.br().y; ++y) {
    for (int x = middle.x; x < middle.br().x; ++x) {
      if (made.isCompleted(x, y)) {
        ASSERT_NEAR(made.depth.mean(y, x), 1.0F, 0.05F);
      }
    }
  }
}

TEST(DepthCompletion, WildWithheldDepthsShowNothing) {
  CompletedScene made = darkScreen();
  std::mt19937 random(3);
  std::uniform_real_distribution<float> depth(0.5F, 5.0F);
  for (float& z : made.sfm.mean) z = z == z ? depth(random) : z;
  DepthCompletion completion;
  complete(completion, made);
  EXPECT_EQ(made.completed, 0U);
}

TEST(DepthCompletion, TakesImagesOfAnySize) {
  DepthCompletion completion;
  for (const cv::Size size : {cv::Size(321, 243), cv::Size(8, 8), cv::Size(9, 17), cv::Size(64, 48)}) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    const GreyImage grey(size, std::uint8_t{100});
    GaussianDepth depth{DepthImage(size, kNone), cv::Mat_<float>(size, kNone)};
    cv::Mat_<std::uint8_t> provenance(size, std::uint8_t{0});
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        if ((x + y) % 6 >= 2) continue;
        depth.mean(y, x) = 2.0F;
        depth.variance(y, x) = 1e-3F;
        provenance(y, x) = 2;
      }
    }
    SensorDepth sensor;
    sensor.depth = {DepthImage(size, kNone), cv::Mat_<float>(size, kNone)};
    SfmPoints points;
    points.collect(depth, sensor);
    for (int frame = 0; frame < 5; ++frame) {
      GaussianDepth copy{depth.mean.clone(), depth.variance.clone()};
      cv::Mat_<std::uint8_t> labels = provenance.clone();
      completion.complete({grey, sensor.depth, points, {}, 0.12, 525.0F, {}, copy, labels});
      for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
          if (labels(y, x) != 4) continue;
          ASSERT_NEAR(copy.mean(y, x), 2.0F, 1e-3F) << size;
        }
      }
    }
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
