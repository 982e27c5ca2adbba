// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstdlib>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/completion/depth_cells.h"
#include "rgbd_sfm_fusion/completion/edge_aware_sums.h"

namespace rgbd_sfm_fusion {

/// Brightness of the two sides of contours through a cell: one between its left and right neighbour, and one
/// between its upper and lower neighbour. A pixel is of the cell's surface if it is no more like the other
/// side than like the surface's own.
struct Sides {
  std::uint8_t own[2] = {0, 0}, other[2] = {0, 0};  ///< [grey levels] equal if there is no contour

  bool contain(int grey) const {
    return std::abs(grey - own[0]) <= std::abs(grey - other[0]) &&
           std::abs(grey - own[1]) <= std::abs(grey - other[1]);
  }
};

/// The surface that is drawn through the supports around each cell: a plane, which is linear in inverse
/// depth.
struct Surfaces {
  enum Drawn : std::uint8_t {
    kNot = 0,
    kBetweenSfm = 1,  ///< between SfM's depths that agree on the surface
    kInGap = 2,       ///< across a gap in one plane that the sensor sees
    kInShadow = 3,  ///< the farther side of a step, continued behind the nearer one: see continueInShadows()
  };

  std::vector<float> rho;               ///< [1/m] at the cell's middle; 0 = none
  std::vector<float> slope_x, slope_y;  ///< [1/m] per unit of CellGrid
  /// [1] Mean square deviation of the surface from the plane at the cell's middle, relative to rho's square:
  /// that of n supports, times 1 + (1 + d²) / n, as the plane is known from n supports only. d is the
  /// distance from their middle, in units of their spread.
  std::vector<float> misfit;
  /// [1] Variance that the supports have in common, relative to rho's square, and that their mean does not
  /// reduce: half (Evidence::kShare) of SfM's; in gaps all of the mean over all supports, if larger; in
  /// shadows all of the far side's.
  std::vector<float> variance;
  /// [1] Second moment of the step to another surface, relative: of which the cell may be.
  std::vector<float> other;
  std::vector<std::uint8_t> drawn;  ///< values of Drawn
  std::vector<Sides> sides;         ///< of drawn cells
};

/// Draws surfaces in five steps. The first three use sums along links (edge_aware_sums.h):
/// 1. a plane is fitted to the supports around each cell, by weighted least squares. Here SfM decides: the
///    sensor's depth at the rim of a hole is often of a nearer surface, and has hardly a say where SfM sees
///    into the hole;
/// 2. the fit is repeated three times, with all supports. Those that are off the last plane by more than
///    their σ weigh less, and links are cut between cells whose planes make a step;
/// 3. the supports of each quadrant are compared with the plane. The plane is drawn if SfM has supports in
///    three of the four quadrants, so that the cell is between them, and if no quadrant's mean is off the
///    plane. Without SfM, it is drawn across gaps of up to 48 px that have supports on all sides, with no
///    strong edge of the image between, and nothing unknown beside them, as the outside of the image is;
/// 4. cells that are still empty may lie in a shadow: a sensor that projects a pattern sees nothing where a
///    near surface keeps the pattern from a farther one. Such a hole lies on the farther surface, whose plane
///    is continued into the hole. It is as wide as the difference of the two disparities. The window in which
///    the sensor matches adds its own width, even without a step. A strong edge of the image ends it;
/// 5. surfaces end at contours, which are edges of the image. SfM's pixels straddle contours, and cells do
///    too. So where a surface is drawn on one side of a cell only, and an edge lies between the two sides,
///    the cell is given up if it looks like the other side; else Surfaces::sides divides its pixels. Where
///    there is no edge, a surface between SfM's depths is continued by up to two cells.
///
/// Steps 1 to 3 draw nothing beside a step of neighbouring cells, which is an occlusion. Errors of what is
/// drawn are nearly always too near: a plane goes on where a farther surface has begun. So each cell is told
/// what farther depth is known around it, by distance and by the contrast of the image at the cell, and how
/// many of the cells around are not known.
class SurfaceDrawing {
 public:
  /// @param grey       mean brightness of each cell
  /// @param wanted     not 0: cells whose surface is wanted
  /// @param disparity  [px m] of the sensor, per inverse depth; 0: not known
  /// @return           valid until the next call
  const Surfaces& draw(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey, const CellLinks& image_links,
                       const Supports& supports, const std::vector<std::uint8_t>& wanted, float disparity);

 private:
  void fit(const CellGrid& grid, const CellLinks& links, const Supports& supports, bool is_last);
  void doubt(const CellGrid& grid, const CellLinks& image_links, const Supports& supports);
  void judge(const CellGrid& grid, const Supports& supports);
  void keepOffSteps(const CellGrid& grid);
  void lookAround(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey);
  void continueInShadows(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey, const Supports& supports,
                         const std::vector<std::uint8_t>& wanted, float disparity);
  void continueInRun(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey, const Supports& supports,
                     const std::vector<std::uint8_t>& wanted, float disparity, int row, int left, int right);
  void keepToContours(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey, const Supports& supports,
                      const std::vector<std::uint8_t>& wanted);
  void joinCells(const CellGrid& grid);
  template <typename Visitor>
  void forEachEnd(const CellGrid& grid, const Visitor& visit) const;
  Sides sidesOf(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey, int row, int column) const;
  void giveUpOtherSides(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey);
  void grow(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey,
            const std::vector<std::uint8_t>& wanted);
  void growInto(const CellGrid& grid, const cv::Mat_<std::uint8_t>& grey, int row, int column,
                std::vector<std::pair<std::size_t, std::size_t>>* grown) const;
  float planeAt(const CellGrid& grid, std::size_t cell, int row, int column) const;

  Surfaces surfaces_;
  std::vector<std::uint8_t> near_;   // 1: cells that are wanted, and cells around them
  std::vector<std::uint8_t> known_;  // 1: supports, and cells whose plane their supports confirm
  std::vector<float> weights_;       // of the supports
  std::vector<float> levers_;  // [1] squared distance from the middle of a plane's supports: see Surfaces
  cv::Mat_<std::uint8_t> unknown_;  // 1: cells that are neither, near wanted ones
  cv::Mat_<float> depth_;           // [m] in known cells, else 0; with a border
  std::vector<float> middle_;  // [1/m] at the cell's middle, from the cell's published support if it has one
  std::vector<float> ends_;    // [1/m] likewise, of drawn cells and published supports; else 0
  std::vector<std::uint8_t> joined_right_, joined_below_;  // 1: the cell and that neighbour are one surface
  CellLinks links_;                                        // of the image, cut at steps
  LinkedSums sums_;
};

}  // namespace rgbd_sfm_fusion
