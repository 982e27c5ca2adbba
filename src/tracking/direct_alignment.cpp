// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "rgbd_sfm_fusion/tracking/alignment_errors.h"

namespace rgbd_sfm_fusion {
namespace {

using Vector8 = NormalEquations::Vector;
using Matrix8 = NormalEquations::Matrix;

struct State {
  SE3 T_frame_keyframe;
  Photometry photometry;
};

NormalEquations linearise(const AlignmentProblem& problem, int level, const State& state,
                          const Eigen::Vector3d& variance_translation) {
  AlignmentProblem at_state = problem;
  at_state.photometry = state.photometry;
  return linearise(at_state, level, state.T_frame_keyframe, variance_translation);
}

/// Undoes the keyframe-side step δ: I_keyframe moving by δ is I_frame moving by -δ.
State stepped(const State& state, const Vector8& delta) {
  State result = state;
  result.T_frame_keyframe = state.T_frame_keyframe * SE3::exp(delta.head<6>()).inverse();
  result.photometry.brightness.gain += delta(6);
  result.photometry.brightness.offset += delta(7);
  return result;
}

/// What remains of the gradients after a step.
template <class Part, class Step>
void subtract(Part& part, const Step& step) {
  part.g -= part.H * step;
}

void subtractStep(NormalEquations& equations, const Vector8& delta) {
  subtract(equations, delta);
  for (NormalEquations::Part& strip : equations.strips) subtract(strip, delta);
  subtract(equations.depth, delta.head<6>());
  for (PoseEquations::Part& strip : equations.depth.strips) subtract(strip, delta.head<6>());
}

constexpr double kMaxGain = 2.5;     // of brightness, either way
constexpr double kConverged = 1e-3;  // relative decrease of the cost
// Squares that agree, before depth was looked at: as few squares tell as little of the depth as points do of
// the image, which has up to 1200 squares.
constexpr int kAssumedSquares = kMinPoints;

/// Levenberg–Marquardt on one level; `state` becomes the best found.
/// @param guess  of T_frame_keyframe: the search starts with it, if it fits better than `state`; may be null
NormalEquations alignLevel(const AlignmentProblem& problem, int level, const SE3* guess, State& state) {
  // Variances stay as they are for the motion that the level starts with. If they grew with the motion, a far
  // pose would fit best, where depth's variance explains any difference.
  Eigen::Vector3d at_start = state.T_frame_keyframe.translation();
  NormalEquations current = linearise(problem, level, state, at_start);
  if (guess != nullptr) {
    const State with_guess{*guess, state.photometry};
    const NormalEquations of_guess = linearise(problem, level, with_guess, at_start);
    const bool is_better = current.in_view < kMinPoints || of_guess.meanCost() < current.meanCost();
    if (of_guess.in_view >= kMinPoints && is_better) {
      state = with_guess;
      at_start = state.T_frame_keyframe.translation();
      current = linearise(problem, level, state, at_start);
    }
  }
  double damping = 0.0;
  for (int iteration = 0; iteration < problem.options.max_iterations && current.in_view >= kMinPoints;
       ++iteration) {
    Matrix8 damped = current.H;
    damped.diagonal() *= 1.0 + damping;
    const Vector8 delta = damped.ldlt().solve(current.g);
    if (!delta.allFinite()) break;
    const State candidate = stepped(state, delta);
    // The last step is so small that the linearisation holds: checking its result is not worth the time.
    // Where gradients have one direction only, rounding may turn a large step the wrong way.
    if (damping == 0.0 && 0.5 * std::abs(current.g.dot(delta)) < kConverged * current.cost) {
      state = candidate;
      subtractStep(current, delta);
      break;
    }
    NormalEquations next = linearise(problem, level, candidate, at_start);
    if (next.in_view >= kMinPoints && next.meanCost() < current.meanCost()) {
      const bool converged = next.meanCost() > (1.0 - kConverged) * current.meanCost();
      state = candidate;
      current = std::move(next);
      damping = damping < 1e-3 ? 0.0 : 0.2 * damping;
      if (converged) break;
    } else {
      // A step this small that does not help ends the search.
      if (delta.head<6>().norm() < 1e-6 || damping > 1e3) break;
      damping = damping == 0.0 ? 0.1 : 4.0 * damping;
    }
  }
  return current;
}

constexpr std::size_t kPlaces = 4;  // that are tried below the coarsest level

/// A pose that alignment may end with.
struct Candidate {
  State state;
  NormalEquations equations;                              // of the last level that it was aligned on
  double cost = std::numeric_limits<double>::infinity();  // of that level, to compare candidates by
};

/// @param variance_translation  the same for all candidates. By its own motion, a far one would be forgiven
///                              more than a near one
double costToCompare(const AlignmentProblem& problem, int level, const State& state,
                     const Eigen::Vector3d& variance_translation) {
  const NormalEquations equations = linearise(problem, level, state, variance_translation);
  return equations.in_view >= kMinPoints ? equations.meanCost() : std::numeric_limits<double>::infinity();
}

/// [rad] How far apart a point's images are at two poses, about.
double difference(const Candidate& a, const Candidate& b, double mean_inverse_depth) {
  const Vector6 step = (a.state.T_frame_keyframe * b.state.T_frame_keyframe.inverse()).log();
  return std::hypot(step.head<3>().norm() * mean_inverse_depth, step.tail<3>().norm());
}

/// The best candidates at a few places, the best one first.
class Places {
 public:
  /// One candidate is kept of those that are within a pixel of each other.
  void add(const Candidate& added, const ReferencePoints& points) {
    const double mean_inverse_depth = points.meanInverseDepth(), pixel = 1.0 / points.camera.fx;
    const auto same = std::find_if(begin(), end(), [&](const Candidate& other) {
      return difference(other, added, mean_inverse_depth) < pixel;
    });
    const auto replaced = same != end() || count_ < candidates_.size() ? same : std::prev(end());
    if (replaced == end())
      ++count_;
    else if (added.cost >= replaced->cost)
      return;
    *replaced = added;
    for (auto place = replaced; place != begin() && place->cost < std::prev(place)->cost; --place)
      std::swap(*place, *std::prev(place));
  }

  Candidate* begin() { return candidates_.data(); }
  Candidate* end() { return begin() + count_; }
  std::size_t count() const { return count_; }

 private:
  std::array<Candidate, kPlaces> candidates_;
  std::size_t count_ = 0;
};

}  // namespace

bool isPlausible(const Brightness& brightness) {
  return brightness.gain < kMaxGain && brightness.gain > 1.0 / kMaxGain;
}

AlignmentResult align(const AlignmentProblem& problem, const std::vector<SE3>& starts) {
  const TrackingReference& reference = problem.reference;
  const TrackingOptions& options = problem.options;
  const Photometry& photometry = problem.photometry;
  AlignmentProblem by_brightness = problem;
  by_brightness.depth = {};
  const int coarsest = reference.levels() - 1;
  Places places;
  const Eigen::Vector3d expected = starts.front().translation();
  const ReferencePoints& fewest = reference.points(coarsest);
  for (const SE3& start : starts) {
    Candidate candidate{{start, photometry}, {}, {}};
    candidate.equations = alignLevel(by_brightness, coarsest, nullptr, candidate.state);
    if (candidate.equations.in_view < kMinPoints || !isPlausible(candidate.state.photometry.brightness))
      continue;
    // The pose is found by brightness, as depth may be of the place that the search starts from. Which pose
    // is right is told by both.
    candidate.cost = costToCompare(problem, coarsest, candidate.state, expected);
    places.add(candidate, fewest);
  }
  // The smallest image may lead a good guess away.
  const State guess{starts.front(), photometry};
  if (coarsest > options.finest_level || places.count() == 0)
    places.add({guess, {}, costToCompare(problem, coarsest, guess, expected)}, fewest);
  // The brightness of a small image may fit another place as well as the right one. So other places are tried
  // as well, down to where all points and depth decide.
  for (int level = coarsest - 1; level >= options.finest_level; --level) {
    for (Candidate& candidate : places) {
      // All starts may have been led away from a good guess. The last level is large, and would be the
      // dearest to ask.
      const bool asks = &candidate == places.begin() && level > options.finest_level;
      candidate.equations = alignLevel(problem, level, asks ? &starts.front() : nullptr, candidate.state);
    }
    if (places.count() == 1) continue;
    Places aligned;
    for (Candidate& candidate : places) {
      candidate.cost = costToCompare(problem, level, candidate.state, expected);
      aligned.add(candidate, reference.points(level));
    }
    places = aligned;
  }
  State& state = places.begin()->state;
  const NormalEquations& equations = places.begin()->equations;
  AlignmentResult result;
  result.photometry.noise =
      noiseOf(equations, state.photometry.noise, static_cast<double>(options.huber_threshold));
  const int count = reference.points(options.finest_level).count;
  result.share_in_view = count > 0 ? std::min(1.0, (equations.in_view + equations.white) / count) : 0.0;
  result.share_good = equations.judged > 0.0 ? equations.good / equations.judged : 0.0;
  result.share_of_depth =
      (equations.depth.agreeing + kAssumedSquares) / (equations.depth.compared + kAssumedSquares);
  const Eigen::LDLT<Matrix8> ldlt(equations.H);
  result.is_solvable =
      equations.in_view >= kMinPoints && ldlt.isPositive() && ldlt.vectorD().minCoeff() > 0.0;
  if (result.is_solvable) {
    const StepEstimate last = estimateStep(equations);
    if (equations.depth.compared > 0.0) {
      state = stepped(state, last.step);
      result.depth_information = last.depth_information;
      result.depth_pull = last.depth_pull;
    }
    result.photometry.alike = last.alike;
    const Matrix6 Ad = state.T_frame_keyframe.adjoint();
    result.covariance = Ad * last.covariance * Ad.transpose();
    result.by_readout = Ad * last.by_readout * state.T_frame_keyframe.inverse().adjoint();
  }
  result.T_frame_keyframe = state.T_frame_keyframe;
  result.photometry.brightness = state.photometry.brightness;
  return result;
}

AlignmentResult alignFromFar(const AlignmentProblem& problem, const std::vector<SE3>& starts) {
  const AlignmentResult found = align(problem, starts);
  if (!found.is_solvable || !isPlausible(found.photometry.brightness)) return found;
  AlignmentProblem from_there = problem;
  from_there.photometry.brightness = found.photometry.brightness;
  from_there.photometry.alike = found.photometry.alike;
  const AlignmentResult again = align(from_there, {found.T_frame_keyframe});
  return again.is_solvable ? again : found;
}

}  // namespace rgbd_sfm_fusion
