// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>

#include "rgbd_sfm_fusion/completion/depth_completion.h"
#include "rgbd_sfm_fusion/fusion/evidence.h"
#include "unit/completion/completion_scene.h"

namespace rgbd_sfm_fusion {
namespace {

using test::completed;
using test::CompletedScene;
using test::CompletionScene;
using test::makeScene;
using test::slantedPlane;

/// Mean of min(e² / σ², 25) over the completed pixels of some frames. As many frames before them are learned
/// from.
double neesOf(const CompletionScene& scene, unsigned frames) {
  DepthCompletion completion;
  double sum = 0.0, count = 0.0;
  for (unsigned frame = 0; frame < 2 * frames; ++frame) {
    CompletedScene made = makeScene(scene, frame);
    test::complete(completion, made);
    if (frame < frames) continue;
    for (int y = 0; y < made.truth.rows; y += 3) {
      for (int x = 0; x < made.truth.cols; x += 3) {
        if (!made.isCompleted(x, y)) continue;
        const auto e = static_cast<double>(made.depth.mean(y, x) - made.truth(y, x));
        sum += std::min(e * e / static_cast<double>(made.depth.variance(y, x)), 25.0);
        count += 1.0;
      }
    }
  }
  EXPECT_GT(count, 1000.0);
  return sum / count;
}

/// Mean σ / Z of completed depth in a part of the image.
/// @param least  so many pixels of it are completed
double meanSigma(const CompletedScene& made, const cv::Rect& area, int least) {
  double sum = 0.0;
  int count = 0;
  for (int y = area.y; y < area.br().y; ++y) {
    for (int x = area.x; x < area.br().x; ++x) {
      if (!made.isCompleted(x, y)) continue;
      sum += static_cast<double>(std::sqrt(made.depth.variance(y, x)) / made.depth.mean(y, x));
      ++count;
    }
  }
  EXPECT_GT(count, least);
  return sum / count;
}

TEST(CompletionVariance, IsNeverSurerThanWhatItsSupportsHaveInCommon) {
  for (const float sigma : {0.01F, 0.03F, 0.08F}) {
    CompletionScene scene = slantedPlane();
    scene.sfm_sigma = sigma;
    const CompletedScene made = completed(scene);
    ASSERT_GT(made.completed, 1000U) << sigma;
    for (int y = 0; y < made.truth.rows; ++y) {
      for (int x = 0; x < made.truth.cols; ++x) {
        if (!made.isCompleted(x, y)) continue;
        const float common = std::sqrt(Evidence::kShare) * sigma;
        ASSERT_GT(std::sqrt(made.depth.variance(y, x)), 0.999F * common * made.depth.mean(y, x));
      }
    }
  }
}

TEST(CompletionVariance, GapsAreNeverSurerThanTheSensorAroundThem) {
  CompletionScene scene = slantedPlane();
  scene.sensor_sigma = 0.06F;  // as for depth far beyond the sensor's range
  const cv::Rect gap(120, 80, 32, 32);
  scene.seen = [gap](int x, int y) {
    return gap.contains({x, y}) ? CompletionScene::kByNone : CompletionScene::kBySensor;
  };
  const CompletedScene made = completed(scene);
  ASSERT_TRUE(made.isCompleted(136, 96));
  EXPECT_GE(std::sqrt(made.depth.variance(96, 136)), 0.06F * made.depth.mean(96, 136));
}

TEST(CompletionVariance, IsLessSureWhereItsSurfaceMayEnd) {
  CompletionScene scene = slantedPlane();
  scene.seen = [](int x, int y) {  // nothing is known to the right
    return x < 160 && (x % 20 < 3 || y % 20 < 3) ? CompletionScene::kBySfm : CompletionScene::kByNone;
  };
  const CompletedScene made = completed(scene);
  const auto sigma = [&made](int x) { return meanSigma(made, {x, 60, 1, 120}, 20); };
  EXPECT_GT(sigma(146), 1.3 * sigma(90));
}

TEST(CompletionVariance, IsLessSureWhereTheImageHasAnEdgeBesideAFartherSurface) {
  const auto sigma = [](int contrast) {
    CompletionScene scene;
    scene.rho = [](int x, int) { return x < 164 ? 0.5F : 0.46F; };
    // The farther surface is behind an edge of its own, so that it does not take part in the plane.
    scene.grey = [contrast](int x, int) { return 100 + (x < 148 ? 0 : contrast) + (x < 164 ? 0 : 60); };
    scene.seen = [](int x, int y) {
      if (x >= 168) return CompletionScene::kBySensor;
      return x < 160 && (x % 20 < 3 || y % 20 < 3) ? CompletionScene::kBySfm : CompletionScene::kByNone;
    };
    return meanSigma(completed(scene), {144, 60, 8, 120}, 200);
  };
  EXPECT_GT(sigma(40), 1.1 * sigma(0));
}

TEST(CompletionVariance, IsLessSureWhereTheImageHasAnEdgeBesideTheUnknown) {
  const auto sigma = [](int contrast) {
    CompletionScene scene;
    scene.grey = [contrast](int x, int) { return x < 148 ? 100 : 100 + contrast; };
    scene.seen = [](int x, int y) {  // nothing is known to the right
      return x < 160 && (x % 20 < 3 || y % 20 < 3) ? CompletionScene::kBySfm : CompletionScene::kByNone;
    };
    return meanSigma(completed(scene), {144, 60, 8, 120}, 200);
  };
  EXPECT_GT(sigma(40), 1.1 * sigma(0));
}

TEST(CompletionVariance, IsLessSureTheFewerDepthsItsPlaneHas) {
  const auto sigma = [](int spacing) {
    CompletionScene scene;  // depths are off the plane by 3 %, every other cell to the other side
    scene.rho = [spacing](int x, int y) { return (x / spacing + y / spacing) % 2 == 0 ? 0.485F : 0.515F; };
    scene.seen = [spacing](int x, int y) {
      return x % spacing < 4 && y % spacing < 4 ? CompletionScene::kBySfm : CompletionScene::kByNone;
    };
    return meanSigma(completed(scene), {140, 100, 40, 40}, 400);
  };
  EXPECT_GT(sigma(100), 1.2 * sigma(20));
}

TEST(CompletionVariance, IsLessSureBesideAFartherSurfaceThanBesideANearerOne) {
  const auto sigma = [](float rho_beside) {
    CompletionScene scene;
    scene.rho = [rho_beside](int x, int) { return x < 164 ? 0.5F : rho_beside; };
    scene.seen = [](int x, int y) {
      if (x >= 168) return CompletionScene::kBySensor;
      return x < 160 && (x % 20 < 3 || y % 20 < 3) ? CompletionScene::kBySfm : CompletionScene::kByNone;
    };
    return meanSigma(completed(scene), {128, 60, 24, 120}, 200);
  };
  EXPECT_GT(sigma(0.4F), 1.2 * sigma(0.65F));
}

TEST(CompletionVariance, LearnsHowRoughSurfacesAre) {
  for (const float relief : {0.02F, 0.03F}) {  // of inverse depth, in cells; no measurement shows it
    CompletionScene scene = slantedPlane();
    const auto plane = scene.rho;
    scene.rho = [plane, relief](int x, int y) {
      const bool raised = (x % 40 >= 8 && y % 40 >= 8) && (x / 40 + y / 40) % 2 == 0;
      return plane(x, y) * (raised ? 1.0F + relief : 1.0F);
    };
    scene.sfm_everywhere = true;
    scene.sfm_sigma = 0.003F;
    scene.sfm_noise = 0.003F;
    const double nees = neesOf(scene, 24);
    EXPECT_GT(nees, 0.1) << relief;
    EXPECT_LT(nees, 2.0) << relief;
  }
}

TEST(CompletionVariance, LearnsThatSfmIsBetterThanItSays) {
  CompletionScene scene = slantedPlane();
  scene.sfm_everywhere = true;
  scene.sfm_sigma = 0.03F;
  scene.sfm_noise = 0.003F;
  DepthCompletion completion;
  std::vector<double> sigmas;
  for (unsigned frame = 0; frame < 48; ++frame) {
    CompletedScene made = makeScene(scene, frame);
    test::complete(completion, made);
    sigmas.push_back(meanSigma(made, {{}, made.truth.size()}, 1000));
  }
  EXPECT_LT(sigmas.back(), 0.6 * sigmas.front());
}

TEST(CompletionVariance, ErrorsThatSupportsShareAreInItsVariance) {
  CompletionScene scene = slantedPlane();
  scene.sfm_sigma = 0.05F;
  scene.sfm_noise = std::sqrt(Evidence::kShare) * scene.sfm_sigma;
  scene.pixel_noise = std::sqrt(1.0F - Evidence::kShare) * scene.sfm_sigma;
  scene.seen = [](int x, int y) {  // no rim of sensor depth, which would settle the planes
    return x % 40 < 3 || y % 40 < 3 ? CompletionScene::kBySfm : CompletionScene::kByNone;
  };
  EXPECT_NEAR(neesOf(scene, 20), 0.9, 0.6);
}

TEST(CompletionVariance, SupportsWeighByWhatIsTheirsAlone) {
  const CellGrid grid({40, 40});
  const cv::Size size(40, 40);
  const GaussianDepth depth{DepthImage(size, 2.0F), cv::Mat_<float>(size, 0.01F)};
  const CellMeans sfm = cellMeans(grid, depth, {}, 0xff, 0xff),
                  none = cellMeans(grid, GaussianDepth(), {}, 0xff, 0xff);
  const CommonVariance common = [](double rho, double x, double y) {
    EXPECT_DOUBLE_EQ(rho, 0.5);
    EXPECT_TRUE(x >= 0.0 && x < 40.0 && y >= 0.0 && y < 40.0);
    return x < 20.0 ? 0.0005 : 1.0;  // of 0.01 / 2^4
  };
  const Supports supports = chooseSupports(grid, none, sfm, none, common);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    EXPECT_EQ(supports.source[cell], Supports::Source::kSfm);
    EXPECT_NEAR(supports.variance[cell], 0.0025F, 1e-6F);
    EXPECT_NEAR(supports.own[cell], supports.x[cell] < 0.0F ? 0.0005F : 0.0F, 1e-6F);
  }
}

}  // namespace
}  // namespace rgbd_sfm_fusion
