// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

namespace rgbd_sfm_fusion {

/// Images for results that are handed out. The pool uses an image again once nobody else holds it: fresh
/// memory would cost more time than the computation. Any thread may release an image.
class ImagePool {
 public:
  template <typename T>
  cv::Mat_<T> take(const cv::Size& size) {
    for (cv::Mat& image : images_) {
      const bool unused = __atomic_load_n(&image.u->refcount, __ATOMIC_ACQUIRE) == 1;
      if (unused && image.type() == cv::traits::Type<T>::value && image.size() == size) return image;
    }
    cv::Mat_<T> image(size);
    if (images_.size() < kMostImages && !size.empty()) images_.push_back(image);
    return image;
  }

 private:
  static constexpr std::size_t kMostImages = 64;  // ten frames under way
  std::vector<cv::Mat> images_;
};

}  // namespace rgbd_sfm_fusion
