// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>

#include "rgbd_sfm_fusion/completion/depth_completion.h"
#include "rgbd_sfm_fusion/fusion/provenance.h"

namespace rgbd_sfm_fusion::test {

/// A frame that is given by functions of the pixel: true inverse depth, brightness, and which sources see it.
struct CompletionScene {
  static constexpr int kWidth = 320, kHeight = 240;
  enum Seen { kByNone, kBySensor, kBySfm };

  std::function<float(int, int)> rho = [](int, int) { return 0.5F; };
  std::function<int(int, int)> grey = [](int, int) { return 100; };
  std::function<Seen(int, int)> seen = [](int, int) { return kByNone; };
  float sensor_sigma = 0.0F;    ///< [1] stated, relative; 0: a Kinect's
  bool sfm_everywhere = false;  ///< SfM has depth also where the sensor sees, on the lines of a grid
  float sfm_sigma = 0.03F;      ///< [1] stated, relative
  float sfm_noise = 0.0F;       ///< [1] relative error that all pixels share
  float pixel_noise = 0.0F;     ///< [1] relative error of each pixel
};

struct CompletedScene {
  GreyImage grey = GreyImage(CompletionScene::kHeight, CompletionScene::kWidth);
  GaussianDepth sensor, sfm, depth;
  cv::Mat_<std::uint8_t> provenance = GreyImage(CompletionScene::kHeight, CompletionScene::kWidth);
  DepthImage truth = DepthImage(CompletionScene::kHeight, CompletionScene::kWidth);
  std::uint64_t completed = 0;

  bool isCompleted(int x, int y) const {
    return provenance(y, x) == static_cast<std::uint8_t>(Provenance::kCompleted);
  }
  /// Share of a rectangle's pixels.
  double completedShare(const cv::Rect& area) const {
    return cv::countNonZero(provenance(area) == static_cast<int>(Provenance::kCompleted)) /
           static_cast<double>(area.area());
  }
};

inline CompletedScene makeScene(const CompletionScene& scene, unsigned seed = 1) {
  CompletedScene made;
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  const cv::Size size(CompletionScene::kWidth, CompletionScene::kHeight);
  for (GaussianDepth* images : {&made.sensor, &made.sfm, &made.depth})
    *images = {DepthImage(size, kNoDepth), cv::Mat_<float>(size, kNoDepth)};
  const float common = scene.sfm_noise * normal(random);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const float z = 1.0F / scene.rho(x, y);
      const float sigma = scene.sensor_sigma > 0.0F ? scene.sensor_sigma * z : 1.425e-3F * z * z;
      const float sfm = z * (1.0F + common + scene.pixel_noise * normal(random));
      const CompletionScene::Seen seen = scene.seen(x, y);
      made.truth(y, x) = z;
      made.grey(y, x) = static_cast<std::uint8_t>(scene.grey(x, y));
      made.provenance(y, x) = static_cast<std::uint8_t>(seen);
      if (seen == CompletionScene::kBySensor) {
        made.sensor.mean(y, x) = made.depth.mean(y, x) = z;
        made.sensor.variance(y, x) = made.depth.variance(y, x) = sigma * sigma;
      } else if (seen == CompletionScene::kBySfm) {
        made.depth.mean(y, x) = sfm;
        made.depth.variance(y, x) = std::pow(scene.sfm_sigma * sfm, 2.0F);
      }
      const bool on_grid = x % 40 < 3 || y % 40 < 3;
      if (seen == CompletionScene::kBySfm || (scene.sfm_everywhere && on_grid)) {
        made.sfm.mean(y, x) = sfm;
        made.sfm.variance(y, x) = std::pow(scene.sfm_sigma * sfm, 2.0F);
      }
    }
  }
  return made;
}

inline void complete(DepthCompletion& completion, CompletedScene& made,
                     const std::vector<cv::Rect>& mirrors = {}) {
  SfmPoints points;
  SensorDepth sensor;
  sensor.depth = made.sensor;
  points.collect(made.sfm, sensor);
  made.completed = completion.complete(
      {made.grey, made.sensor, points, mirrors, 0.12, 525.0F, {}, made.depth, made.provenance});
}

inline CompletedScene completed(const CompletionScene& scene, const std::vector<cv::Rect>& mirrors = {}) {
  DepthCompletion completion;
  CompletedScene made = makeScene(scene);
  complete(completion, made, mirrors);
  return made;
}

/// A slanted plane with a hole in its middle, in which SfM sees the lines of a grid.
inline CompletionScene slantedPlane() {
  CompletionScene scene;
  scene.rho = [](int x, int y) {
    return 0.4F + 4e-4F * static_cast<float>(x) + 2e-4F * static_cast<float>(y);
  };
  scene.seen = [](int x, int y) {
    if (x < 60 || x >= 260 || y < 40 || y >= 200) return CompletionScene::kBySensor;
    return x % 40 < 3 || y % 40 < 3 ? CompletionScene::kBySfm : CompletionScene::kByNone;
  };
  return scene;
}

}  // namespace rgbd_sfm_fusion::test
