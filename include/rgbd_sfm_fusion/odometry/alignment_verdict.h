// SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rgbd_sfm_fusion/tracking/direct_alignment.h"

namespace rgbd_sfm_fusion {

/// Whether an aligned frame shows what the keyframe shows: the brightness of most points fits, with a
/// plausible gain, and on average most of the points and of the DepthCells do.
bool fits(const AlignmentResult& result, const TrackingOptions& options);

/// Like fits(), but stricter, for use after a loss: the light has to be about the same, most of the keyframe
/// in view, and most of its points and of the sensor depth have to fit.
bool isRecognised(const AlignmentResult& result, const TrackingOptions& options);

/// [1] How much of the keyframe the frame shows: of its points in view, and of those the share that fits, by
/// brightness and by depth alike. To compare poses of one frame.
double agreement(const AlignmentResult& result);

/// Whether neither enough points fit nor enough depth: something is in front, or the pose is wrong. Only
/// where both have sensor depth can this be told.
bool isDoubtful(const AlignmentResult& result);

/// Whether an aligned frame shows much that the keyframe does not, though the keyframe is in view: a person
/// who passes, for instance. If it became the keyframe, the next frames would be aligned with the person.
/// Only where both have sensor depth can this be told.
bool isObstructed(const AlignmentResult& result);

}  // namespace rgbd_sfm_fusion
