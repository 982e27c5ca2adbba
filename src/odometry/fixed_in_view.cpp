// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/odometry/fixed_in_view.h"

#include <algorithm>
#include <cmath>

#include "rgbd_sfm_fusion/image/image_squares.h"
#include "rgbd_sfm_fusion/image/inverse_depth.h"
#include "rgbd_sfm_fusion/tracking/tracking_candidates.h"

namespace rgbd_sfm_fusion {
namespace {

// That a square is fixed, before anything is known of it: 1 to 90. One point that fits where it was, and not
// at all where the pose moves it, leaves that open.
constexpr float kPriorLogOdds = kOneSurface / 2.0F;

/// Squared residual [σ²], robust.
float misfit(float residual, float variance) {
  return std::min(residual * residual / variance, kOneSurface);
}

/// @return NaN outside of `seen`
float brightnessAt(const cv::Mat_<float>& image, const cv::Rect& seen, const Eigen::Vector2f& at) {
  const bool is_seen = at.x() >= static_cast<float>(seen.x) && at.y() >= static_cast<float>(seen.y) &&
                       at.x() < static_cast<float>(seen.br().x - 1) &&
                       at.y() < static_cast<float>(seen.br().y - 1);
  if (!is_seen) return kNoDepth;
  const int column = static_cast<int>(at.x()), row = static_cast<int>(at.y());
  const float a = at.x() - static_cast<float>(column), b = at.y() - static_cast<float>(row);
  const float *above = image[row] + column, *below = image[row + 1] + column;
  return (1.0F - b) * (above[0] + a * (above[1] - above[0])) + b * (below[0] + a * (below[1] - below[0]));
}

/// Pixel at which a camera that reads its rows one after another shows a point.
class ReadRowByRow {
 public:
  ReadRowByRow(const PinholeCamera& camera, const ReadoutMotion& motion)
      : twist_(motion.twist.cast<float>()),
        fx_(static_cast<float>(camera.fx)),
        fy_(static_cast<float>(camera.fy)),
        cx_(static_cast<float>(camera.cx)),
        cy_(static_cast<float>(camera.cy)),
        height_(static_cast<float>(camera.height)) {}

  /// @param at   the point's ray (x, y, 1) in the camera of the middle row
  /// @param rho  its inverse depth there
  Eigen::Vector2f pixel(const Eigen::Vector2f& at, float rho) const {
    const float x = at.x(), y = at.y(), s = (fy_ * y + cy_ + 0.5F) / height_ - 0.5F;
    const float dz = twist_(3) * y - twist_(4) * x + rho * twist_(2);
    const float dx = twist_(4) - twist_(5) * y + rho * twist_(0),
                dy = twist_(5) * x - twist_(3) + rho * twist_(1);
    return {fx_ * (x + s * (dx - x * dz)) + cx_, fy_ * (y + s * (dy - y * dz)) + cy_};
  }

 private:
  Eigen::Matrix<float, 6, 1> twist_;
  float fx_, fy_, cx_, cy_, height_;
};

/// [grey levels²] of a residual.
float noiseVariance(const AlignmentProblem& problem) {
  const auto noise = static_cast<float>(problem.photometry.noise);
  return 2.0F * noise * noise;
}

/// [px] How far the scene has moved on in the image, about.
float shift(const SE3& step, const ReferencePoints& points) {
  const Vector6 twist = step.log();
  const double angle = std::hypot(twist.head<3>().norm() * points.meanInverseDepth(), twist.tail<3>().norm());
  return static_cast<float>(points.camera.fx * angle);
}

/// [px] How far the middle of a square has moved on in the image, if it is of the scene: at infinity, and at
/// half of the points' mean distance.
struct Shifts {
  Shifts(const ReferencePoints& points, const SE3& T_frame_keyframe, const cv::Rect& square) {
    const PinholeCamera& camera = points.camera;
    const Eigen::Vector2d pixel(square.x + 0.5 * (square.width - 1), square.y + 0.5 * (square.height - 1));
    const Eigen::Vector3d ray((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy, 1.0);
    const auto shiftAt = [&](double rho) -> Eigen::Vector2f {
      Eigen::Vector3d p = T_frame_keyframe.rotationMatrix() * ray + rho * T_frame_keyframe.translation();
      p.z() = std::max(p.z(), 0.05);  // as alignment's points have
      return (camera.project(p) - pixel).cast<float>();
    };
    far = shiftAt(0.0), near = shiftAt(2.0 * points.meanInverseDepth());
  }
  Eigen::Vector2f far, near;
};

}  // namespace

FixedInView::FixedInView(const cv::Size& image) : log_odds_(squaresOf(image)), evidence_(log_odds_.size()) {
  reset();
}

void FixedInView::reset() {
  log_odds_.setTo(static_cast<double>(-kPriorLogOdds));
  squares_ = cv::Mat_<std::uint8_t>();
  T_first_last_ = SE3();
}

double FixedInView::share() const {
  return squares_.empty()
             ? 0.0
             : static_cast<double>(cv::countNonZero(squares_)) / static_cast<double>(squares_.total());
}

void FixedInView::observe(const AlignmentProblem& problem, const AlignmentResult& aligned,
                          const KeyframeToTrack& keyframe, const SE3& T_first_frame) {
  const ReferencePoints& points = problem.reference.points(problem.options.middleLevel());
  if (shift(T_first_frame.inverse() * T_first_last_, points) < 1.0F) return;
  T_first_last_ = T_first_frame;
  std::fill(evidence_.begin(), evidence_.end(), 0.0F);
  compareAtPoints(problem, aligned, {keyframe.step.during(keyframe.reference_readout_time)});
  compareLeftOut(problem, aligned, keyframe.coarse);
  decide();
}

/// Compares how well a square's points fit where they were, and where the pose moves them. A point whose
/// depth leaves open where it goes tells little.
void FixedInView::compareAtPoints(const AlignmentProblem& problem, const AlignmentResult& aligned,
                                  const ReadoutMotion& of_keyframe) {
  const int on = problem.options.middleLevel();
  const ReferencePoints& points = problem.reference.points(on);
  const Eigen::Matrix3f R = aligned.T_frame_keyframe.rotationMatrix().cast<float>();
  const Eigen::Vector3f t = aligned.T_frame_keyframe.translation().cast<float>();
  const ReadRowByRow of_frame(points.camera, problem.shutter.motion(aligned.T_frame_keyframe));
  const ReadRowByRow before(points.camera, of_keyframe);
  const auto fx = static_cast<float>(points.camera.fx), fy = static_cast<float>(points.camera.fy);
  const auto gain = static_cast<float>(aligned.photometry.brightness.gain),
             offset = static_cast<float>(aligned.photometry.brightness.offset);
  const float noise = noiseVariance(problem);
  const auto alike = static_cast<float>(pointsThatCountAsOne(problem, points.count));
  const int side = kSquare >> on;
  for (std::size_t i = 0; i < static_cast<std::size_t>(points.count); ++i) {
    const float rho = points.inverse_depth[i];
    const Eigen::Vector2f ray(points.x[i], points.y[i]);
    const Eigen::Vector3f moved = R * ray.homogeneous() + rho * t;
    if (!(moved.z() > 0.05F)) continue;
    const Eigen::Vector2f there = moved.hnormalized(), was = before.pixel(ray, rho);
    const float expected = shown(gain * points.intensity[i] + offset);
    const float if_fixed = brightnessAt(problem.image[on], problem.image.seen(on), was) - expected;
    const float if_moved =
        brightnessAt(problem.image[on], problem.image.seen(on), of_frame.pixel(there, rho / moved.z())) -
        expected;
    if (!std::isfinite(if_fixed) || !std::isfinite(if_moved)) continue;
    const float slope = (points.gradient_x[i] * fx * (t.x() - there.x() * t.z()) +
                         points.gradient_y[i] * fy * (t.y() - there.y() * t.z())) /
                        moved.z();
    const float variance = noise + slope * slope * points.inverse_depth_variance[i];
    const int row = static_cast<int>(was.y() + 0.5F) / side, column = static_cast<int>(was.x() + 0.5F) / side;
    if (squares_.empty() || squares_(row, column) == 0)
      evidence_(row, column) += 0.5F * (misfit(if_moved, variance) - misfit(if_fixed, noise)) / alike;
  }
}

/// Squares that are left out soon have no points any more. Those that are fixed still look as they did. If
/// they are of the scene, they differ by their gradients and by how far the scene has moved on there, which
/// depends on their depth: the most probable one counts (generalised likelihood ratio).
void FixedInView::compareLeftOut(const AlignmentProblem& problem, const AlignmentResult& aligned,
                                 const cv::Mat_<float>& keyframe) {
  const int on = problem.options.middleLevel();
  const cv::Mat_<float>& image = problem.image[on];
  if (squares_.empty() || keyframe.size() != image.size()) return;
  const ReferencePoints& points = problem.reference.points(on);
  const auto gain = static_cast<float>(aligned.photometry.brightness.gain),
             offset = static_cast<float>(aligned.photometry.brightness.offset);
  const float noise = noiseVariance(problem);
  // A gradient that may be noise does not tell what a move would change.
  const float least_gradient =
      GradientLimit{problem.options.min_gradient, problem.photometry.noise}.onLevel(on);
  const auto alike = static_cast<float>(pointsThatCountAsOne(problem, points.count));
  const cv::Rect inner = problem.image.seen(on) & cv::Rect(1, 1, image.cols - 2, image.rows - 2);
  const int side = kSquare >> on;
  forEachMarked(squares_, squares_.size() * kSquare, [&](const cv::Rect& marked) {
    const cv::Rect square = cv::Rect(marked.x >> on, marked.y >> on, side, side) & inner;
    if (square.empty()) return;
    const Shifts shifts(points, aligned.T_frame_keyframe, square);
    float evidence = 0.0F;
    for (int v = square.y; v < square.br().y; ++v) {
      for (int u = square.x; u < square.br().x; ++u) {
        const Eigen::Vector2f gradient(0.5F * (keyframe(v, u + 1) - keyframe(v, u - 1)),
                                       0.5F * (keyframe(v + 1, u) - keyframe(v - 1, u)));
        if (gradient.squaredNorm() < least_gradient * least_gradient) continue;
        const float residual = image(v, u) - shown(gain * keyframe(v, u) + offset);
        const float squared = residual * residual;
        const float far = gradient.dot(shifts.far), near = gradient.dot(shifts.near);
        const float least = far * near > 0.0F ? std::min(far * far, near * near) : 0.0F;
        const float variance = std::clamp(squared, noise + least, noise + std::max(far * far, near * near));
        const float ratio =
            0.5F * (std::log(variance / noise) + misfit(residual, variance) - misfit(residual, noise));
        // However large its residual, a pixel that does not fit where it was is none that is fixed.
        evidence += squared < kOneSurface * noise ? ratio : std::min(ratio, 0.0F);
      }
    }
    evidence_(marked.y / kSquare, marked.x / kSquare) += evidence / alike;
  });
}

void FixedInView::decide() {
  for (int i = 0; i < static_cast<int>(log_odds_.total()); ++i) {
    if (!std::isfinite(evidence_[0][i])) continue;
    // Within limits, so that what comes into view later, or goes, is learned as fast as at first.
    const float sum = log_odds_[0][i] + std::clamp(evidence_[0][i], -kPriorLogOdds, kPriorLogOdds);
    log_odds_[0][i] = std::clamp(sum, -kPriorLogOdds, kPriorLogOdds);
  }
  const auto is_fixed = [](float odds) -> std::uint8_t { return odds > 0.0F ? 1 : 0; };
  squares_ = cv::Mat_<std::uint8_t>();
  if (std::none_of(log_odds_.begin(), log_odds_.end(), is_fixed)) return;
  squares_ = pool_.take<std::uint8_t>(log_odds_.size());
  std::transform(log_odds_.begin(), log_odds_.end(), squares_.begin(), is_fixed);
}

}  // namespace rgbd_sfm_fusion
