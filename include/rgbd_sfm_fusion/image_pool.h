// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/idle_takes.h"

namespace rgbd_sfm_fusion {

/// Images for results that are handed out. The pool uses an image again once nobody else holds it: fresh
/// memory would cost more time than the computation. Any thread may release an image. What a burst has added
/// goes again, one image after the other: the first ones are taken first, so the last one is in use only
/// while all of them are needed.
class ImagePool {
 public:
  template <typename T>
  cv::Mat_<T> take(const cv::Size& size) {
    forgetWhatIsNotNeeded();
    for (const cv::Mat& image : images_) {
      if (!isUnused(image) || image.type() != cv::traits::Type<T>::value || image.size() != size) continue;
      if (&image == &images_.back()) idle_takes_.restart();
      return image;
    }
    cv::Mat_<T> image(size);
    if (images_.size() < kMostImages && !size.empty()) images_.push_back(image);
    return image;
  }

  std::size_t size() const { return images_.size(); }

 private:
  static constexpr std::size_t kMostImages = 64;  // ten frames under way

  static bool isUnused(const cv::Mat& image) {
    return __atomic_load_n(&image.u->refcount, __ATOMIC_ACQUIRE) == 1;
  }

  void forgetWhatIsNotNeeded() {
    if (images_.empty() || !idle_takes_.isSurplus(isUnused(images_.back()))) return;
    images_.pop_back();
    idle_takes_.restart();
  }

  std::vector<cv::Mat> images_;
  IdleTakes idle_takes_;
};

}  // namespace rgbd_sfm_fusion
