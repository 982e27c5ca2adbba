// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "rgbd_sfm_fusion/fusion/depth_fusion.h"
#include "rgbd_sfm_fusion/odometry/visual_odometry.h"
#include "rgbd_sfm_fusion/types.h"

namespace rgbd_sfm_fusion {

/// Statistics of the values of depth images, which can be added up.
struct DepthValues {
  std::uint64_t pixels = 0;       ///< pixels that were looked at
  std::uint64_t with_depth = 0;   ///< of these, pixels with depth
  std::uint64_t too_near = 0;     ///< of those with depth, pixels below min_range
  std::uint64_t too_far = 0;      ///< pixels beyond max_range
  std::uint64_t implausible = 0;  ///< pixels beyond the reach of any such sensor
  double sum_of_logs = 0.0;       ///< ln(m), of the pixels with depth
  std::uint64_t step = 0;         ///< [mm] all depths are multiples of it; 0 without depth

  /// [m] geometric mean; NaN without depth
  double typical() const;
  DepthValues& operator+=(const DepthValues& other);
};

/// Looks at some of the pixels. @param min_range, max_range [m]
DepthValues valuesOf(const DepthImage& depth, double min_range, double max_range);

/// Finds the condition that was not met where a stage produces nothing, or nothing of one kind. Names the
/// condition with the numbers and the cure. Takes every image, and answers for the whole run or for the last
/// seconds.
class RunWatch {
 public:
  struct Limits {
    double max_skew = 0.020;        ///< [s]
    double min_range = 0.4;         ///< [m]
    double max_range = 5.0;         ///< [m]
    double depth_scale = 1e-3;      ///< [m] of a count of 16UC1
    double window = 5.0;            ///< [s] of recentSentences()
    std::string colour = "colour";  ///< name of the topic
    std::string depth = "depth";    ///< name of the topic
  };

  /// What is known of a colour image. A stage gives what it knows.
  struct Frame {
    std::optional<double> skew;        ///< [s] the nearest depth image minus this one, used or not
    std::optional<DepthValues> depth;  ///< of the depth image that is used
    std::optional<TrackingState> state;
    std::optional<ScaleEstimate> scale;
    ProvenanceCounts counts;  ///< valid if `scale` is given
    bool sfm_rejected = false;

    void setFused(const FusedFrame& fused);
  };

  /// Why an image did not become a Frame, or a depth image was not used.
  enum class LeftOut { kUnstamped, kLate, kUnusable };

  explicit RunWatch(Limits limits) : limits_(std::move(limits)) {}

  /// @param time [s] on any clock; where it goes back, the last seconds begin anew
  void add(double time, const Frame& frame);
  void leftOutColour(double time, LeftOut why, std::uint64_t images = 1);
  void leftOutDepth(double time, LeftOut why, std::uint64_t images = 1);

  /// The conditions that were not met since the start. Empty if all were met.
  std::vector<std::string> sentences() const;
  /// The same for the last seconds before `time`. If no images came at all, this is not said here: the
  /// subscriber knows better.
  std::vector<std::string> recentSentences(double time) const;

  /// Nothing was tracked, or nothing came out.
  bool hasNothing() const;

 private:
  struct LeftOutCounts {
    std::uint64_t unstamped = 0, late = 0, unusable = 0;

    std::uint64_t total() const { return unstamped + late + unusable; }
    void add(LeftOut why, std::uint64_t images);
    LeftOutCounts& operator+=(const LeftOutCounts& other);
    std::string text() const;
  };

  struct Counts {
    std::uint64_t frames = 0;
    LeftOutCounts colour_left_out, depth_left_out;
    std::uint64_t with_skew = 0, with_depth = 0;
    double smallest_skew = std::numeric_limits<double>::infinity();  ///< [s] absolute
    double largest_skew = 0.0;                                       ///< [s] absolute
    DepthValues values;
    std::uint64_t with_state = 0, tracked = 0, lost = 0;
    std::uint64_t fused = 0;  ///< frames of which the fusion is known
    std::uint64_t tracked_and_fused = 0, with_scale = 0, rejected = 0;
    ProvenanceCounts pixels;

    Counts& operator+=(const Counts& other);
  };

  void record(double time, const Counts& counts);
  std::vector<std::string> sentencesOf(const Counts& counts) const;
  std::string aboutColour(const Counts& counts) const;
  std::string aboutDepth(const Counts& counts) const;
  std::string aboutDepthValues(const DepthValues& values) const;
  std::string aboutTracking(const Counts& counts) const;
  std::string aboutFusion(const Counts& counts) const;

  Limits limits_;
  Counts whole_;
  std::deque<std::pair<double, Counts>> recent_;
};

}  // namespace rgbd_sfm_fusion
