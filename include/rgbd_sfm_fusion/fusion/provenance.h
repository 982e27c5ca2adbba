// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace rgbd_sfm_fusion {

/// Values of /fusion/provenance.
enum class Provenance : std::uint8_t { kNone = 0, kSensor = 1, kSfm = 2, kFused = 3, kCompleted = 4 };

/// Values of /fusion/disagreement.
enum class Disagreement : std::uint8_t { kNone = 0, kSensorKept = 1, kSfmKept = 2 };

/// The paper's Table I: how many pixels of measured depth come from each source. Completed pixels are counted
/// apart. Counts of several frames add up.
struct ProvenanceCounts {
  std::uint64_t sensor_only = 0;  ///< [px]
  std::uint64_t sfm_only = 0;     ///< [px]
  std::uint64_t fused = 0;        ///< [px]
  std::uint64_t completed = 0;    ///< [px]
  std::uint64_t without = 0;      ///< [px] without any depth

  std::uint64_t total() const { return sensor_only + sfm_only + fused; }
  double sensorOnlyShare() const { return share(sensor_only); }  ///< 0 to 1; 0 where there is no depth at all
  double sfmOnlyShare() const { return share(sfm_only); }        ///< 0 to 1
  double fusedShare() const { return share(fused); }             ///< 0 to 1

  std::uint64_t refilled() const { return sfm_only + completed; }  ///< [px] that the sensor has no depth for

  /// Share of the pixels without sensor depth that got a depth; 0 to 1; 0 if the sensor has no holes.
  double refilledShare() const {
    const std::uint64_t holes = refilled() + without;
    return holes == 0 ? 0.0 : static_cast<double>(refilled()) / static_cast<double>(holes);
  }

  /// Share of all pixels; 0 to 1.
  double completedShare() const {
    const std::uint64_t pixels = total() + completed + without;
    return pixels == 0 ? 0.0 : static_cast<double>(completed) / static_cast<double>(pixels);
  }

  ProvenanceCounts& operator+=(const ProvenanceCounts& other) {
    sensor_only += other.sensor_only;
    sfm_only += other.sfm_only;
    fused += other.fused;
    completed += other.completed;
    without += other.without;
    return *this;
  }

 private:
  double share(std::uint64_t part) const {
    return total() == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(total());
  }
};

}  // namespace rgbd_sfm_fusion
