// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Whether a matrix may be an information: finite, and positive definite.
template <class Matrix>
bool isPositive(const Matrix& information) {
  return information.allFinite() && information.llt().info() == Eigen::Success;
}

/// What aligned frames say of N numbers that are given with images, as a calibration or stamps (method.md
/// 10). What is given is either right, or off by some amount. Bayes' rule tells which; until it is clear, the
/// given one holds.
template <int N>
class CalibrationBelief {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  /// @param prior_sigma  of each number, if what is given is off
  explicit CalibrationBelief(double prior_sigma)
      : prior_variance_(prior_sigma * prior_sigma), belief_(belief()) {}

  /// Learns from an aligned frame.
  /// @param information  of `measured`; if it is not positive definite, the frame says nothing
  /// @param measured     error of the numbers that the frame was aligned with
  /// @param keyframe     that it was aligned with. Its frames share its errors, so that all of them together
  ///                     say no more than the one that says most
  /// @param correction   that it was aligned with. One keyframe has the same one all its life
  void observe(const Matrix& information, const Vector& measured, Stamp keyframe, const Vector& correction) {
    if (keyframe != keyframe_) {
      keyframes_ = withLatest();
      frames_ = Evidence();
      most_ = 0.0;
      correction_ = correction;
      keyframe_ = keyframe;
    }
    if (!isPositive(information) || !measured.allFinite()) return;
    frames_.add(information, measured);
    most_ = std::max(most_, information.trace());
    belief_ = belief();
  }

  /// To be added to what is given; 0 while there is no clear sign that it is off.
  Vector correction() const {
    return belief_.log_odds > std::log(kClear) ? belief_.mean : Vector(Vector::Zero());
  }

  /// Standard deviations of correction().
  Vector sigma() const {
    const double off = 1.0 / (1.0 + std::exp(-belief_.log_odds));
    const Vector reported = correction(), spread = belief_.covariance.diagonal();
    return (off * (spread + (belief_.mean - reported).cwiseAbs2()) + (1.0 - off) * reported.cwiseAbs2())
        .cwiseSqrt();
  }

  /// What the images leave open, if what is given is off.
  const Matrix& covarianceIfOff() const { return belief_.covariance; }

 private:
  // Keyframes of recordings contradict each other by 1.3 to 4 times the sigma that strips give (rendered ones
  // by 1.1): what is left of the lens's distortion, or a motion that was not even, looks the same in all of
  // an image. So much is assumed at first, and counts as much as a keyframe.
  static constexpr double kInflation = 2.5;
  // So much of what a keyframe says is doubted. Depths that were found with wrong numbers hide some of the
  // error; and what is left of the lens's distortion looks like a principal point that is off: without a
  // doubt, that of a Kinect passed for one. So no keyframe alone makes it clear.
  static constexpr double kDoubt = 0.3;
  static constexpr double kClear = 50.0;  // to 1

  /// A sum of measurements m with the information J.
  struct Evidence {
    Matrix information = Matrix::Zero();  // Σ J
    Vector pull = Vector::Zero();         // Σ J m
    double square = 0.0;                  // Σ m J m
    int count = 0;

    void add(const Matrix& J, const Vector& m) {
      information += J;
      pull += J * m;
      square += m.dot(J * m);
      ++count;
    }
    Vector mean() const { return information.inverse() * pull; }
    /// Mean square of (m - mean) [σ²] each way, for at least two measurements.
    double scatter() const { return std::max(square - pull.dot(mean()), 0.0) / (N * (count - 1.0)); }
  };

  /// What all the frames say if what is given is off: its correction, and how probable that is.
  struct Belief {
    Vector mean;
    Matrix covariance;
    double log_odds;  // of "off", against "right"
  };

  Evidence withLatest() const {
    Evidence keyframes = keyframes_;
    if (!isPositive(frames_.information)) return keyframes;
    const Vector mean = frames_.mean();
    Matrix covariance = (frames_.information.trace() / most_) * frames_.information.inverse();
    covariance.diagonal() += (kDoubt * mean).cwiseAbs2();
    keyframes.add(covariance.inverse(), correction_ + mean);
    return keyframes;
  }

  Belief belief() const {
    const Evidence keyframes = withLatest();
    // How far keyframes contradict each other is learned, too.
    const double more = std::max(keyframes.count - 1, 0);
    const double scatter = more > 0.0 ? keyframes.scatter() : 0.0;
    const double inflation = (kInflation * kInflation + more * scatter) / (1.0 + more);
    const Matrix information = keyframes.information / inflation;
    const Vector pull = keyframes.pull / inflation;
    Belief belief;
    belief.covariance = (information + Matrix::Identity() / prior_variance_).inverse();
    belief.mean = belief.covariance * pull;
    const double spread = (Matrix::Identity() + prior_variance_ * information).determinant();
    belief.log_odds = 0.5 * (pull.dot(belief.mean) - std::log(spread));
    return belief;
  }

  double prior_variance_;               // each way, if what is given is off
  Evidence keyframes_;                  // all but the latest one
  Evidence frames_;                     // of the latest keyframe, each as if it were independent
  double most_ = 0.0;                   // the largest information of one of them, summed over all numbers
  Vector correction_ = Vector::Zero();  // in force for the latest keyframe
  Stamp keyframe_ = kNoStamp;
  Belief belief_;  // of all keyframes
};

}  // namespace rgbd_sfm_fusion
