// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "rgbd_sfm_fusion/completion/depth_cells.h"
#include "rgbd_sfm_fusion/completion/edge_aware_sums.h"

namespace rgbd_sfm_fusion {

/// The surface that is drawn through the supports around each cell: a plane, which is linear in inverse
/// depth.
struct Surfaces {
  enum Drawn : std::uint8_t {
    kNot = 0,
    kBetweenSfm = 1,  ///< between SfM's depths that agree on it
    kInGap = 2,       ///< across a gap in one plane that the sensor sees
    kInShadow = 3,  ///< the farther side of a step, continued behind the nearer one: see continueInShadows()
  };

  std::vector<float> rho;               ///< [1/m] at the cell's middle; 0 = none
  std::vector<float> slope_x, slope_y;  ///< [1/m] per unit of CellGrid
  std::vector<float> misfit;        ///< [1] of the supports: mean square deviation relative to rho's square
  std::vector<float> variance;      ///< [1] of SfM's supports, relative to rho's square: their mean; in
                                    ///< gaps, of all supports if that is more
  std::vector<float> distance;      ///< [px] to the nearest support
  std::vector<std::uint8_t> drawn;  ///< values of Drawn
};

/// Draws surfaces, in three steps of sums along links (edge_aware_sums.h):
/// 1. a plane is fitted to what is around each cell, by weighted least squares;
/// 2. the same twice, with less weight for supports that are off the plane before, and with links cut between
///    cells whose planes make a step;
/// 3. the supports of each quadrant are compared with the plane. It is drawn where SfM has some in three of
///    four, so that the cell is between them, and no quadrant mean is off it. Without SfM it is drawn across
///    gaps of up to 48 px in one plane that is seen on all sides, with no edge in the image.
///
/// 4. what is still empty may lie in a shadow: a sensor that projects a pattern sees nothing where a near
///    surface keeps the pattern from a farther one. Such holes are as wide as the two surfaces' disparities
///    differ, and lie on the farther one, whose plane is continued into them. The window that disparities are
///    matched in adds a rim of its size, with a step or without.
///
/// Neighbours that are off by a step are an occlusion: nothing is drawn there. Nor is it beside a cell whose
/// surface is not known: what is drawn may have ended before.
class SurfaceDrawing {
 public:
  /// @param wanted     not 0: cells whose surface is wanted
  /// @param disparity  [px m] of the sensor, per inverse depth; 0: not known
  /// @return           valid until the next call
  const Surfaces& draw(const CellGrid& grid, const CellLinks& image_links, const Supports& supports,
                       const std::vector<std::uint8_t>& wanted, float disparity);

 private:
  void fit(const CellGrid& grid, const CellLinks& links, const Supports& supports);
  void doubt(const CellGrid& grid, const CellLinks& image_links, const Supports& supports);
  void judge(const CellGrid& grid, const Supports& supports);
  void keepOffEnds(const CellGrid& grid, const Supports& supports);
  void continueInShadows(const CellGrid& grid, const Supports& supports,
                         const std::vector<std::uint8_t>& wanted, float disparity);
  void continueInRun(const CellGrid& grid, const Supports& supports, const std::vector<std::uint8_t>& wanted,
                     float disparity, int row, int left, int right);

  Surfaces surfaces_;
  std::vector<std::uint8_t> near_;   // 1: cells that are wanted, and what is around them
  std::vector<std::uint8_t> known_;  // 1: cells that are drawn, or may be, or are supports
  std::vector<float> weights_;       // of the supports
  std::vector<float> spread_;        // squared distance of a cell from its supports' middle, in their own
  CellLinks links_;                  // of the image, without steps
  std::vector<float> moments_, work_, values_, quadrants_[4];  // work space
};

}  // namespace rgbd_sfm_fusion
