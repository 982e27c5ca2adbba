// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/scene/trajectory.h"

#include <cmath>

#include "rgbd_sfm_fusion/scene/random.h"

namespace rgbd_sfm_fusion {
namespace {

constexpr double kDegree = M_PI / 180.0;

}  // namespace

HandheldTrajectory::HandheldTrajectory(std::uint64_t seed)
    // offset, then {cycles, amplitude, phase} of stroll, sway, sway, tremor
    : coordinates_{{
          {2.0, {{{1, 0.45, 0.0}, {7, 0.10, 0.0}, {4, 0.07, 0.3}, {97, 0.0008, 0.0}}}},
          {1.6, {{{1, 0.45, -M_PI_2}, {6, 0.05, 0.0}, {3, 0.07, 1.0}, {113, 0.0008, 0.0}}}},
          {1.4, {{{2, 0.04, 0.0}, {9, 0.04, 0.5}, {5, 0.04, 0.0}, {89, 0.0008, 0.0}}}},
          {35 * kDegree,
           {{{1, 55 * kDegree, -M_PI_2},
             {5, 4 * kDegree, 2.5},
             {11, 1.5 * kDegree, 0.0},
             {101, 0.05 * kDegree, 0.0}}}},
          {-8 * kDegree,
           {{{2, 3 * kDegree, 0.0},
             {6, 2.5 * kDegree, 1.0},
             {13, 1 * kDegree, 0.0},
             {107, 0.05 * kDegree, 0.0}}}},
          {0.0,
           {{{1, 2 * kDegree, 0.0},
             {7, 2 * kDegree, 2.0},
             {12, 0.7 * kDegree, 0.0},
             {109, 0.05 * kDegree, 0.0}}}},
      }} {
  const CounterRandom random(seed, 0, 0x7261);
  std::uint32_t counter = 0;
  for (Coordinate& coordinate : coordinates_) {
    // The stroll keeps its phase, so that every seed starts at the same place and looks the same way first.
    for (std::size_t i = 0; i < coordinate.harmonics.size(); ++i) {
      coordinate.harmonics[i].amplitude *= 0.9 + 0.2 * static_cast<double>(random.uniform(counter++));
      if (i > 0) coordinate.harmonics[i].phase += 0.8 * static_cast<double>(random.uniform(counter++)) - 0.4;
    }
  }
}

double HandheldTrajectory::Coordinate::at(double time) const {
  double value = offset;
  for (const Harmonic& h : harmonics)
    value += h.amplitude * std::sin(2.0 * M_PI * h.cycles * time / kPeriod + h.phase);
  return value;
}

SE3 HandheldTrajectory::T_world_camera(double time) const {
  const Eigen::Vector3d position(coordinates_[0].at(time), coordinates_[1].at(time),
                                 coordinates_[2].at(time));
  const double yaw = coordinates_[3].at(time), pitch = coordinates_[4].at(time),
               roll = coordinates_[5].at(time);
  // Optical axes of a level camera that looks along y: right = x, down = -z, forward = y.
  const Eigen::Quaterniond level(Eigen::AngleAxisd(-M_PI_2, Eigen::Vector3d::UnitX()));
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond nod(Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()));
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()));
  return {turn * level * nod * tilt, position};
}

}  // namespace rgbd_sfm_fusion
