// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#include "rgbd_sfm_fusion/mapping/segments_by_length.h"

namespace rgbd_sfm_fusion {
namespace {

void copy(const SegmentBlock& from, std::size_t lane, SegmentBlock& to, std::size_t lane_to) {
  to.keyframe_u[lane_to] = from.keyframe_u[lane], to.keyframe_v[lane_to] = from.keyframe_v[lane];
  to.u[lane_to] = from.u[lane], to.v[lane_to] = from.v[lane];
  to.du[lane_to] = from.du[lane], to.dv[lane_to] = from.dv[lane];
  to.eu[lane_to] = from.eu[lane], to.ev[lane_to] = from.ev[lane];
  to.inverse_depth[lane_to] = from.inverse_depth[lane];
  to.rate[lane_to] = from.rate[lane];
  to.z[lane_to] = from.z[lane], to.z_rate[lane_to] = from.z_rate[lane];
  to.geometric_variance[lane_to] = from.geometric_variance[lane];
  to.before[lane_to] = from.before[lane], to.after[lane_to] = from.after[lane];
}

}  // namespace

const SearchBlock* SegmentsByLength::append(const SegmentBlock& from, std::size_t lane, int number,
                                            SearchBlock& to) {
  to.count = to.waiting();
  copy(from, lane, to.segments, to.count);
  to.number[to.count] = number;
  return ++to.count == kLanes ? &to : nullptr;
}

void SegmentsByLength::fillUp(SearchBlock& block) {
  for (std::size_t lane = block.count; lane < kLanes; ++lane)
    copy(block.segments, block.count - 1, block.segments, lane);
}

}  // namespace rgbd_sfm_fusion
