// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/registration.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace rgbd_sfm_fusion {
namespace {

constexpr std::size_t kFrameStep = 3, kFramesToJudge = 60;
constexpr int kRowStep = 4;             // [px]
constexpr int kWidestHole = 16;         // [px] at a step, where the near surface throws a shadow
constexpr float kLeastStep = 0.1F;      // [1] of depth, between two surfaces
constexpr float kSteepest = 20.0F;      // [grey levels / px] a stronger edge counts no more
constexpr std::size_t kFewEdges = 500;  // of each half
constexpr int kNear = 6;                // [px] error of registration, skew and the sensor's own edges
constexpr int kAgreement = 2;           // [px]
// Recordings with registered depth have a peak near 0 of 1.2 to 3 times the median gradient. If depth is
// moved by 12 or 20 px, or has another focal length, the peak is elsewhere, and there is none near 0.
constexpr double kPeak = 1.2;
constexpr double kPeakOverNear = 2.0;  // ratio of heights above the median

const char kCure[] =
    "switch registration on in the driver (depth_registration), or let depth_image_proc/register do it "
    "(register_depth:=true of the launch files)";

double gradient(const GreyImage& grey, int y, int x) {
  const float left = static_cast<float>(grey(y, x - 1)), right = static_cast<float>(grey(y, x + 1));
  return static_cast<double>(std::min(0.5F * std::abs(right - left), kSteepest));
}

/// Calls function(x) for each step along a row, where x is the last pixel of the nearer surface. The edge in
/// the image is the edge of the nearer surface.
template <class Function>
void forSteps(const float* depth, int width, Function function) {
  int last = -1;
  for (int x = 0; x < width; ++x) {
    if (!(depth[x] > 0.0F)) continue;
    if (last >= 0 && x - last <= kWidestHole &&
        std::abs(depth[x] - depth[last]) > kLeastStep * std::min(depth[x], depth[last]))
      function(depth[x] < depth[last] ? x : last);
    last = x;
  }
}

}  // namespace

std::string doubtOfRegistration(const std::string& colour_frame, const std::string& depth_frame) {
  if (colour_frame.empty() || depth_frame.empty() || colour_frame == depth_frame) return "";
  return "depth is in frame " + depth_frame + " and colour in " + colour_frame +
         ", so depth is not registered to colour, and fused with the wrong pixels: " + kCure;
}

void RegistrationWatch::add(const GreyImage& grey, const DepthImage& depth) {
  if (depth.empty() || depth.size() != grey.size()) return;
  const std::size_t frame = frames_++;
  if (frame % kFrameStep == 0) vote(grey, depth, &halves_[frame / kFrameStep % halves_.size()]);
  if (frames_ % kFramesToJudge == 0) judge();
}

void RegistrationWatch::vote(const GreyImage& grey, const DepthImage& depth, Votes* votes) {
  for (int y = kRowStep; y < grey.rows; y += kRowStep) {
    forSteps(depth[y], depth.cols, [&](int at) {
      if (at < kReach + 1 || at >= grey.cols - kReach - 1) return;
      ++votes->edges;
      for (int offset = -kReach; offset <= kReach; ++offset)
        votes->gradients[static_cast<std::size_t>(offset + kReach)] += gradient(grey, y, at + offset);
    });
  }
}

int RegistrationWatch::offsetOf(const Votes& votes) {
  if (votes.edges < kFewEdges) return 0;
  const auto& gradients = votes.gradients;
  std::array<double, 2 * kReach + 1> sorted = gradients;
  std::nth_element(sorted.begin(), sorted.begin() + kReach, sorted.end());
  const double median = sorted[kReach];
  const auto peak = std::max_element(gradients.begin(), gradients.end());
  const double near =
      *std::max_element(gradients.begin() + kReach - kNear, gradients.begin() + kReach + kNear + 1);
  const bool is_peak = *peak >= kPeak * median && *peak - median >= kPeakOverNear * (near - median);
  // The gradient at `offset` from depth's edge is the image's edge.
  return is_peak ? kReach - static_cast<int>(peak - gradients.begin()) : 0;
}

void RegistrationWatch::judge() {
  const int first = offsetOf(halves_[0]), second = offsetOf(halves_[1]);
  const std::size_t edges = halves_[0].edges + halves_[1].edges;
  halves_ = {};
  doubt_.clear();
  if (std::abs(first) <= kNear || std::abs(second) <= kNear || std::abs(first - second) > kAgreement) return;
  doubt_ =
      "edges of depth lie " + std::to_string(std::abs(first)) + " px " + (first > 0 ? "right" : "left") +
      " of those of the image (at " + std::to_string(edges) +
      " steps of depth), so depth is not registered to colour, and fused with the wrong pixels: " + kCure;
}

}  // namespace rgbd_sfm_fusion
