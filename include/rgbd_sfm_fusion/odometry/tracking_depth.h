// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "rgbd_sfm_fusion/geometry/pinhole_camera.h"
#include "rgbd_sfm_fusion/geometry/row_points.h"
#include "rgbd_sfm_fusion/geometry/se3.h"
#include "rgbd_sfm_fusion/image/inverse_depth.h"
#include "rgbd_sfm_fusion/image/row_bands.h"
#include "rgbd_sfm_fusion/odometry/contested_cells.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// The depth that frames are aligned with. It is not the published depth. The base is the keyframe's sensor
/// depth (with feedback, or at a start), and where there is none, the depth of the keyframe before. Base and
/// stereo are averaged; a pixel where the two contradict each other has no depth (method.md 7, 9).
class TrackingDepth {
 public:
  explicit TrackingDepth(const PinholeCamera& camera);

  void clear();

  /// What becomes of the depth that was carried over to a keyframe with sensor depth. Without any, it stays.
  enum class Carried : std::uint8_t {
    kFillsGaps,  ///< it stays where there is no sensor depth
    kIsDropped,  ///< frames are not aligned with it any more
  };

  /// Makes the keyframe's sensor depth the base. An image without any depth is no sensor depth.
  /// @param depth  H x W, in tracker units
  void setSensor(const GaussianDepth& depth, Carried carried = Carried::kFillsGaps);

  /// To be called after setSensor(). Drops the sensor depth in squares where the depth that was carried over
  /// contests it: that rests on the sensor depth of earlier keyframes, without the parts that stereo
  /// contested.
  /// @param parallax  as ContestedCells takes it
  void contestByCarried(double parallax);

  /// Makes random depth the base, with a mean inverse depth of 1: the start without a sensor (method.md 8).
  /// @param size  [px] of the squares that have one depth. If depth changed within a pixel of the pyramid's
  ///              coarsest level, it would average out there
  void setRandom(int size);

  /// Carries all depth over to a new keyframe, moved and with some noise added.
  /// @param warp  from the old keyframe to the new one
  void moveTo(const InverseDepthWarp& warp);

  /// A keyframe's stereo.
  struct Stereo {
    const InverseDepthImage& depth;
    const cv::Mat_<float>& by_pose;  ///< as in SemiDenseMap
    /// [points] So many have an error of the views' poses in common. Where there is sensor depth as well, it
    /// counts so many times in each variance (method.md 9).
    float sharing_points;
  };

  /// Fuses the keyframe's stereo with the base. Squares of sensor depth that stereo contests are dropped.
  /// @param parallax  as ContestedCells takes it
  /// @param bands     in which stereo or base have changed; elsewhere, the result stays as it was
  /// @return the fused inverse depth; valid until the next call
  const InverseDepthImage& fuse(const Stereo& stereo, double parallax,
                                const RowBands& bands = RowBands::all());

  /// Squares that say nothing of the scene: from the next call of setSensor() or fuse() on, they have no
  /// depth wherever that renews it.
  /// @param squares  as forEachMarked() takes them
  void leaveOut(const cv::Mat_<std::uint8_t>& squares) { left_out_ = squares; }

  /// Adds what is expected in squares of which nothing is known (method.md 7), to be called after fuse(). So
  /// a camera that turns away from all that is known can follow its turn, and one whose sensor sees little of
  /// the scene can tell a turn from a move sideways. Nothing of that is carried over.
  /// @param bands  as in fuse()
  /// @return as fuse(), with what is expected
  const InverseDepthImage& expectRest(const RowBands& bands = RowBands::all());

  /// Of the variance of the fused depth: what is a pixel's own, and not its neighbours' as well. Stereo was
  /// averaged over them. Sensor depth has next to no noise, and around it, errors are shared.
  float independentShare() const;

 private:
  /// Whether no depth image is used, and all that tells the scale was carried over from a keyframe with one.
  /// After a random start, nothing tells it, and stereo is all that there is.
  bool restsOnCarried() const { return had_sensor_ && !has_sensor_; }

  void learnExpected(const DepthImage& sensor);
  void dropExpected();
  void dropLeftOut(const RowBands& bands);
  cv::Rect squareAt(int u, int v) const;
  void dropContested(const InverseDepthImage& other, double parallax, const RowBands& bands);

  const InverseDepthImage& base() const { return has_sensor_ ? with_sensor_ : carried_; }

  PinholeCamera camera_;
  InverseDepthImage carried_;      // or random
  InverseDepthImage with_sensor_;  // the sensor's depth, and what was carried where it has none
  InverseDepthImage fused_;
  cv::Mat_<std::uint8_t> is_expected_;  // squares of fused_, as high as a band of rows
  cv::Mat_<std::uint8_t> left_out_;
  cv::Mat_<float> variance_before_;                       // work space of moveTo()
  bool has_sensor_ = false;                               // of this keyframe
  bool had_sensor_ = false;                               // this keyframe, or one before
  double expected_mean_ = 0.0, expected_variance_ = 0.0;  // inverse depth of what is not known
  ContestedCells contested_;
  RowPoints row_;
  WarpedPoints warped_;  // of a row
};

}  // namespace rgbd_sfm_fusion
