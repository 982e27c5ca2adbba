// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/fusion/shine_through.h"

#include <opencv2/imgproc.hpp>

#include "rgbd_sfm_fusion/multiversion.h"

namespace rgbd_sfm_fusion {
namespace {

/// Stereo begins at 3 grey levels per pixel (MappingOptions::min_gradient), and an edge is two pixels wide at
/// least. An edge may land two pixels beside its point: so far, the image is searched.
constexpr int kLeastContrast = 6;  // [grey levels]
constexpr int kSearched = 5;       // [px] width of the square

RGBD_SFM_FUSION_MULTIVERSION
void dropRow(const std::uint8_t* brightest, const std::uint8_t* darkest, const float* sensor, int width,
             float* __restrict mean, float* __restrict variance) {
  for (int x = 0; x < width; ++x) {
    const bool plain = (brightest[x] - darkest[x] < kLeastContrast) & !(sensor[x] > 0.0f);
    mean[x] = plain ? kNoDepth : mean[x];
    variance[x] = plain ? kNoDepth : variance[x];
  }
}

}  // namespace

void dropShineThrough(const GreyImage& grey, const DepthImage& sensor, GaussianDepth& sfm) {
  const cv::Mat square = cv::Mat::ones(kSearched, kSearched, CV_8U);
  cv::Mat_<std::uint8_t> brightest, darkest;
  cv::dilate(grey, brightest, square);
  cv::erode(grey, darkest, square);
  for (int y = 0; y < sfm.mean.rows; ++y)
    dropRow(brightest[y], darkest[y], sensor[y], sfm.mean.cols, sfm.mean[y], sfm.variance[y]);
}

}  // namespace rgbd_sfm_fusion
