// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/readout_estimation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace rgbd_sfm_fusion {
namespace {

// These numbers were found on recordings of a Kinect (28 ms) and on rendered ones (0).
constexpr int kLevel = 2;              // of the pyramid
constexpr int kEvery = 2;              // of a level's points: neighbours say the same
constexpr double kInflation = 10.5;    // of a frame's sigma: its pixels' errors are alike
constexpr double kFrameSigma = 0.004;  // [s] sigma of the best frames
constexpr double kMaxSigma = 0.015;    // [s] a frame with a larger sigma is not used: the camera hardly moved
constexpr double kStationary = 0.00073;  // [s] sigma that remains, so that the filter forgets in 30 frames
constexpr double kShortest = 0.0065;     // [s] less is noise
constexpr double kFastest = 0.010, kSlowest = 0.033;  // [s] of real rolling shutters

constexpr int kReadout = 8;  // after pose (0 to 5), gain and offset of the brightness
using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

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

/// Jacobian of a residual by pose and brightness, as direct alignment has it; 0 for the readout.
Vector9 jacobian(const Point& p, const PinholeCamera& camera, double gain) {
  const double gu = p.gradient_x * gain * camera.fx, gv = p.gradient_y * gain * camera.fy;
  const double along = gu * p.x + gv * p.y;
  Vector9 J;
  J << p.inverse_depth * gu, p.inverse_depth * gv, -p.inverse_depth * along, -p.y * along - gv,
      p.x * along + gu, gv * p.x - gu * p.y, p.intensity, 1.0, 0.0;
  return J;
}

}  // namespace

ReadoutEquations linearise(const AlignmentProblem& problem, const AlignmentResult& aligned,
                           const Vector6& keyframe_step) {
  const ImagePyramid& image = problem.image;
  const FrameShutter& shutter = problem.shutter;
  const TrackingOptions& options = problem.options;
  // Coarser than where alignment ends: fewer points, and steps may be larger.
  const int level = std::min(std::max(kLevel, options.finest_level), problem.reference.levels() - 1);
  const ReferencePoints& points = problem.reference.points(level);
  const PinholeCamera& camera = points.camera;
  const SE3& T = aligned.T_frame_keyframe;
  const Eigen::Matrix3d R = T.rotationMatrix();
  const Vector6 twist = shutter.motion(T).twist;
  const Vector6 step_in_keyframe = T.inverse().adjoint() * (T * shutter.T_last_keyframe.inverse()).log();
  const auto noise = static_cast<double>(2.0F * options.image_noise * options.image_noise);
  const auto huber = static_cast<double>(options.huber_threshold);
  Matrix9 H = Matrix9::Zero();
  Vector9 g = Vector9::Zero();
  for (int i = 0; i < points.count; i += kEvery) {
    const Point p = pointAt(points, i);
    Eigen::Vector3d q = R * Eigen::Vector3d(p.x, p.y, 1.0) + p.inverse_depth * T.translation();
    if (q.z() < 0.05) continue;
    const double s = ReadoutMotion::share(camera.project(q).y(), camera.height);
    q += s * (twist.tail<3>().cross(q) + p.inverse_depth * twist.head<3>());
    const Eigen::Vector2d pixel = camera.project(q);
    if (!contains(image.seen(level), pixel)) continue;
    Vector9 J = jacobian(p, camera, aligned.photometry.brightness.gain);
    const double s_keyframe = ReadoutMotion::share(camera.fy * p.y + camera.cy, camera.height);
    J(kReadout) = J.head<6>().dot(s * step_in_keyframe - s_keyframe * keyframe_step);
    const double residual = static_cast<double>(bilinear(image[level], pixel)) -
                            aligned.photometry.brightness.gain * p.intensity -
                            aligned.photometry.brightness.offset;
    const double slope = J.head<3>().dot(T.translation()) / p.inverse_depth;
    const double variance = noise + slope * slope * p.inverse_depth_variance;
    const double sigmas = std::abs(residual) / std::sqrt(variance);
    const double weight = (sigmas <= huber ? 1.0 : huber / sigmas) / variance;
    H.noalias() += (weight * J) * J.transpose();
    g -= weight * residual * J;
  }
  return {H, g};
}

void ReadoutEstimator::observe(const AlignmentProblem& problem, const AlignmentResult& aligned,
                               const Vector6& keyframe_step, double interval) {
  const ReadoutEquations equations = linearise(problem, aligned, keyframe_step);
  const Eigen::LDLT<Matrix9> ldlt(equations.H);
  const double deviation = ldlt.solve(equations.g)(kReadout) * interval;
  const double scatter = ldlt.solve(Vector9::Unit(kReadout))(kReadout) * interval * interval;
  const double variance = kInflation * kInflation * scatter + kFrameSigma * kFrameSigma;
  if (!(scatter > 0.0 && variance < kMaxSigma * kMaxSigma && std::isfinite(deviation))) return;
  const double gain = variance_ / (variance_ + variance);
  // The deviation is from the time that the alignment has used, which may be an older estimate.
  const double change = problem.shutter.readout * interval - readoutTime() + deviation;
  time_ = std::clamp(time_ + gain * change, 0.0, interval);
  variance_ = std::max((1.0 - gain) * variance_, kStationary * kStationary);
}

double ReadoutEstimator::readoutTime() const {
  return time_ < kShortest ? 0.0 : time_;
}

double ReadoutEstimator::sigma() const {
  const double slowest = std::max(kSlowest, time_), reported = readoutTime();
  // What the frames alone say, without the filter's start.
  const double information = std::max(1.0 / variance_ - 1.0 / kStartVariance, 0.0);
  const double weighted = time_ / variance_ - start_ / kStartVariance;
  const double mean = information > 0.0 ? std::clamp(weighted / information, 0.0, slowest) : 0.0;
  const auto likelihood = [=](double time) {
    return std::exp(-0.5 * information * (time - mean) * (time - mean));
  };
  constexpr double kStep = 0.00025;  // [s]
  double rolling = 0.0, square = 0.0;
  int steps = 0;
  for (double time = kFastest; time <= slowest; time += kStep, ++steps) {
    const double weight = likelihood(time);
    rolling += weight;
    square += weight * (time - reported) * (time - reported);
  }
  // Before the first frame, both kinds of shutter are equally probable, and so are all times of a rolling
  // one.
  const double global = steps * likelihood(0.0);
  return std::sqrt((square + global * reported * reported) / (rolling + global));
}

}  // namespace rgbd_sfm_fusion
