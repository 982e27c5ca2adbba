// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd_sfm_fusion/image/row_bands.h"
#include "rgbd_sfm_fusion/simd.h"

namespace rgbd_sfm_fusion {

/// [px] A match compares samples along the line, up to this distance to either side.
constexpr int kPatternRadius = 2;

/// Keyframe pixels with enough gradient for stereo, in blocks of one array per quantity. Blocks that are not
/// full are filled up with copies of their last pixel that have no gradient.
class StereoCandidates {
 public:
  /// [px] Room at the edges of both images: for a search's pattern, and a pixel for interpolation. In the
  /// keyframe, the pattern may be twice as long as in the view, where it has one more sample at each end.
  static constexpr int kBorder = 2 * kPatternRadius + 1;

  struct Block {
    Block() {}  // not zeroed: all of it is written

    float u[kLanes], v[kLanes];                    ///< [px]
    float gradient_x[kLanes], gradient_y[kLanes];  ///< [grey levels / px]
    int pixel[kLanes];                             ///< v * width + u
  };

  /// @param image         H x W brightness
  /// @param seen          part of the image that the camera has seen
  /// @param min_gradient  [grey levels / px] of central differences
  void collect(const cv::Mat_<float>& image, const cv::Rect& seen, float min_gradient);

  /// Collects the candidates of `all` in some bands of rows whose pixel `is_wanted(pixel)`. Other bands keep
  /// theirs.
  template <class IsWanted>
  void collectFrom(const StereoCandidates& all, const RowBands& bands, const IsWanted& is_wanted) {
    bands_.resize(all.bands_.size());
    const auto mark = [&](const Block& block, bool* wanted) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) wanted[lane] = is_wanted(block.pixel[lane]);
    };
    for (std::size_t band = 0; band < bands_.size(); ++band) {
      if (bands.has(static_cast<int>(band))) select(all.bands_[band], mark, bands_[band]);
    }
  }

  /// Replaces `selected` by the candidates of `blocks` that `mark(block, wanted)` marks.
  template <class Mark>
  static void select(const std::vector<Block>& blocks, const Mark& mark, std::vector<Block>& selected) {
    Writer writer(selected, blocks.size() * kLanes);
    for (const Block& block : blocks) {
      bool wanted[kLanes];
      mark(block, wanted);
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        writer.put(block.u[lane], block.v[lane], block.gradient_x[lane], block.gradient_y[lane],
                   block.pixel[lane]);
        writer.keepIf(wanted[lane]);
      }
    }
    writer.finish();
  }

  /// The blocks of each band of rows.
  const std::vector<std::vector<Block>>& bands() const { return bands_; }

 private:
  /// Fills the blocks of a band. Values are written for every pixel and kept only for some: there is no
  /// branch to mispredict.
  class Writer {
   public:
    Writer(std::vector<Block>& blocks, std::size_t most) : blocks_(blocks) {
      blocks_.resize(most / kLanes + 1);  // the last one may not be full
    }
    void put(float u, float v, float gradient_x, float gradient_y, int pixel) {
      Block& block = blocks_[next_ / kLanes];
      const std::size_t lane = next_ % kLanes;
      block.u[lane] = u, block.v[lane] = v;
      block.gradient_x[lane] = gradient_x, block.gradient_y[lane] = gradient_y;
      block.pixel[lane] = pixel;
    }
    void keepIf(bool is_wanted) { next_ += is_wanted ? 1 : 0; }
    void finish() {
      fillUp();
      blocks_.resize(next_ / kLanes);
    }

   private:
    void fillUp();

    std::vector<Block>& blocks_;
    std::size_t next_ = 0;  // lane to fill, over all blocks
  };

  std::vector<std::vector<Block>> bands_;
};

}  // namespace rgbd_sfm_fusion
