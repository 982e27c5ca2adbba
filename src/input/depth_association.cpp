// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/input/depth_association.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "rgbd_sfm_fusion/option_check.h"

namespace rgbd_sfm_fusion {

void validate(const AssociationOptions& options) {
  requireInRange("max_skew", options.max_skew, 0.0, 1.0);
  requireInRange("min_depth_period", options.min_depth_period, 0.0, 1.0);
  if (options.max_waiting == 0) throw std::invalid_argument("max_waiting is 0, expected at least 1 image");
}

namespace association {

Stamp DepthPeriod::next(Stamp stamp) {
  stamps_.push_back(stamp);
  if (stamps_.size() <= kLearnedFrom) return least_;
  if (stamps_.size() > kLearnedFrom + 1) stamps_.pop_front();
  Stamp shortest = stamps_[1] - stamps_[0];
  for (std::size_t i = 2; i < stamps_.size(); ++i) shortest = std::min(shortest, stamps_[i] - stamps_[i - 1]);
  return std::max(shortest, least_);
}

bool isFromBefore(Stamp stamp, Stamp before_jump, Stamp after_jump) {
  return distance(stamp, before_jump) < distance(stamp, after_jump);
}

Stamp distance(Stamp a, Stamp b) {
  return a < b ? b - a : a - b;
}

Stamp nanoseconds(double seconds) {
  return static_cast<Stamp>(std::llround(seconds * 1e9));
}

}  // namespace association
}  // namespace rgbd_sfm_fusion
