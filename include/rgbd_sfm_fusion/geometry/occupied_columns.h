// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Where an image of depth has values. Depth of edges leaves about half of the image's blocks empty, and what
/// is done with it need not look at them.
class OccupiedColumns {
 public:
  /// @param image  values of a row count as they are when near() is first asked for the row above
  explicit OccupiedColumns(const DepthImage& image);

  /// The parts of a row in which each pixel is that has a value, or beside which there is one by row or
  /// column. They begin at multiples of kLanes, and end there or with the row. To be called for each row in
  /// turn.
  const std::vector<cv::Range>& near(int y);

 private:
  void markUpTo(int row);

  const DepthImage& image_;
  int blocks_, marked_ = 0;
  std::vector<std::uint8_t> marks_;  ///< 1 for blocks of kLanes columns that have a value, or one beside them
  std::vector<cv::Range> ranges_;
};

}  // namespace rgbd_sfm_fusion
