// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/calibration_equations.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

constexpr int kLevel = 2;  // of the pyramid
constexpr int kEvery = 2;  // of a level's points: neighbours say the same

using Equations = CalibrationEquations;

float bilinear(const cv::Mat_<float>& image, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(pixel.x()), y = static_cast<int>(pixel.y());
  const auto a = static_cast<float>(pixel.x() - x), b = static_cast<float>(pixel.y() - y);
  return (1.0F - b) * ((1.0F - a) * image(y, x) + a * image(y, x + 1)) +
         b * ((1.0F - a) * image(y + 1, x) + a * image(y + 1, x + 1));
}

/// Whether the area has all pixels that bilinear() needs.
bool contains(const cv::Rect& area, const Eigen::Vector2d& pixel) {
  return pixel.x() >= area.x && pixel.y() >= area.y && pixel.x() < area.br().x - 1 &&
         pixel.y() < area.br().y - 1;
}

struct Point {
  double x, y, inverse_depth, inverse_depth_variance, intensity, gradient_x, gradient_y;
};

Point pointAt(const ReferencePoints& points, int index) {
  const auto i = static_cast<std::size_t>(index);
  const auto at = [i](const std::vector<float>& array) { return static_cast<double>(array[i]); };
  return {at(points.x),
          at(points.y),
          at(points.inverse_depth),
          at(points.inverse_depth_variance),
          at(points.intensity),
          at(points.gradient_x),
          at(points.gradient_y)};
}

/// The last alignment, with what all points share.
struct Alignment {
  const PinholeCamera& camera;  // of the level
  Eigen::Matrix3d R;            // of T_frame_keyframe
  Eigen::Vector3d t, t_in_keyframe;
  Vector6 readout;                          // motion of the frame during its readout
  Vector6 step_in_keyframe, keyframe_step;  // motions since the last frame, and of the keyframe in that time
  double gain;
  double pixel;  // of the level, in a pixel of the full image
};

/// How a point of the keyframe moves into the frame.
struct MovedPoint {
  Eigen::Vector3d in_frame;  // times the inverse depth
  double share;              // ReadoutMotion::share() of its row
};

bool isInFront(const MovedPoint& q) {
  return q.in_frame.z() > 0.0;
}

MovedPoint moved(const Point& p, const Alignment& a) {
  MovedPoint q{a.R * Eigen::Vector3d(p.x, p.y, 1.0) + p.inverse_depth * a.t, 0.0};
  if (!isInFront(q)) return q;
  q.share = ReadoutMotion::share(a.camera.project(q.in_frame).y(), a.camera.height);
  q.in_frame += q.share * (a.readout.tail<3>().cross(q.in_frame) + p.inverse_depth * a.readout.head<3>());
  return q;
}

/// Derivative of a pixel of the frame by the keyframe's pixel, at the same depth.
Eigen::Matrix2d pixelByPixel(const Eigen::Vector3d& q, const Alignment& a) {
  const double x = q.x() / q.z(), y = q.y() / q.z(), aspect = a.camera.fx / a.camera.fy;
  Eigen::Matrix2d A;
  A << a.R(0, 0) - x * a.R(2, 0), (a.R(0, 1) - x * a.R(2, 1)) * aspect, (a.R(1, 0) - y * a.R(2, 0)) / aspect,
      a.R(1, 1) - y * a.R(2, 1);
  return A / q.z();
}

Equations::Vector jacobian(const Point& p, const MovedPoint& q, const Alignment& a) {
  const double gx = p.gradient_x * a.gain, gy = p.gradient_y * a.gain;
  const double gu = gx * a.camera.fx, gv = gy * a.camera.fy, along = gu * p.x + gv * p.y;
  Equations::Vector J;
  J.head<8>() << p.inverse_depth * gu, p.inverse_depth * gv, -p.inverse_depth * along, -p.y * along - gv,
      p.x * along + gu, gv * p.x - gu * p.y, p.intensity, 1.0;
  const double share_keyframe = ReadoutMotion::share(a.camera.fy * p.y + a.camera.cy, a.camera.height);
  J(Equations::kReadout) = J.head<6>().dot(q.share * a.step_in_keyframe - share_keyframe * a.keyframe_step);
  // If the principal point is off by c, the point is seen c farther in the keyframe, and in the frame. So the
  // frame's pixel is off by (1 - A) c, and the keyframe's gradient is the frame's times A.
  J.segment<2>(Equations::kPrincipalPoint) =
      a.pixel * (pixelByPixel(q.in_frame, a).inverse() - Eigen::Matrix2d::Identity()).transpose() *
      Eigen::Vector2d(gx, gy);
  J.segment<2>(Equations::kDepthTilt) = J.head<3>().dot(a.t_in_keyframe) * Eigen::Vector2d(p.x, p.y);
  return J;
}

}  // namespace

CalibrationEquations calibrationEquations(const AlignmentProblem& problem, const AlignmentResult& aligned,
                                          const Vector6& keyframe_step) {
  const ImagePyramid& image = problem.image;
  const TrackingOptions& options = problem.options;
  // Coarser than where alignment ends: fewer points, and steps may be larger.
  const int level = std::min(std::max(kLevel, options.finest_level), problem.reference.levels() - 1);
  const ReferencePoints& points = problem.reference.points(level);
  const SE3& T = aligned.T_frame_keyframe;
  const Brightness& brightness = aligned.photometry.brightness;
  const Eigen::Matrix3d R = T.rotationMatrix();
  const Alignment alignment{points.camera,
                            R,
                            T.translation(),
                            R.transpose() * T.translation(),
                            problem.shutter.motion(T).twist,
                            T.inverse().adjoint() * (T * problem.shutter.T_last_keyframe.inverse()).log(),
                            keyframe_step,
                            brightness.gain,
                            std::ldexp(1.0, -level)};
  const auto noise = static_cast<double>(2.0F * options.image_noise * options.image_noise);
  const auto huber = static_cast<double>(options.huber_threshold);
  const int length = points.count / NormalEquations::kStrips + 1;
  CalibrationEquations equations;
  for (int i = 0; i < points.count; i += kEvery) {
    const Point p = pointAt(points, i);
    const MovedPoint q = moved(p, alignment);
    if (!isInFront(q)) continue;
    const Eigen::Vector2d pixel = points.camera.project(q.in_frame);
    if (!contains(image.seen(level), pixel)) continue;
    const Equations::Vector J = jacobian(p, q, alignment);
    const double residual = static_cast<double>(bilinear(image[level], pixel)) -
                            brightness.gain * p.intensity - brightness.offset;
    const double slope = J.head<3>().dot(T.translation()) / p.inverse_depth;
    const double variance = noise + slope * slope * p.inverse_depth_variance;
    const double sigmas = std::abs(residual) / std::sqrt(variance);
    const double weight = (sigmas <= huber ? 1.0 : huber / sigmas) / variance;
    Equations::Part& strip = equations.strips[static_cast<std::size_t>(i / length)];
    strip.H.noalias() += (weight * J) * J.transpose();
    strip.g -= weight * residual * J;
  }
  for (const Equations::Part& strip : equations.strips) {
    equations.H += strip.H;
    equations.g += strip.g;
  }
  return equations;
}

}  // namespace rgbd_sfm_fusion
