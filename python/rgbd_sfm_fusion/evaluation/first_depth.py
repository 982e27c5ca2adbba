# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""How soon SfM adds depth of its own, once the camera moves."""

import os

import numpy as np

from .. import bags, runs, tum

_MOVED = 0.02       # of the median depth: from then on there is parallax
_LEAST = 500        # [px] of a frame
_SHARE = 0.25       # of the later frames' mean
_SETTLED = 10**9    # [ns] after the camera has moved, frames count as later ones
_MEAN, _LABEL = '/fusion/mean', '/fusion/provenance'


def first_depth(fused, results):
    """'sfm_only_after' [s]: from the moment when the camera has moved by _MOVED of the first image's median depth to the
    first frame with SfM-only depth on _LEAST pixels and _SHARE of what later frames have; missing where none has.
    'sfm_only_later': the later frames' mean share of all pixels."""
    stamps, counts, depth, pixels = _read(fused)
    trajectory = tum.Trajectory.read(os.path.join(results, 'trajectory.txt'))
    return delay(stamps, counts, pixels, trajectory.stamps, trajectory.positions, _MOVED * depth)


def delay(stamps, counts, pixels, pose_stamps, positions, distance):
    """first_depth() of the frames' counts of SfM-only pixels, and of the poses [same unit as distance]."""
    moved = np.linalg.norm(positions - positions[0], axis=1) >= distance
    if not moved.any():
        return {}
    start = pose_stamps[np.argmax(moved)]
    later = counts[stamps >= start + _SETTLED]
    if not len(later):
        return {}
    found = {'sfm_only_later': float(later.mean() / pixels)}
    enough = counts >= max(_LEAST, _SHARE * later.mean())
    if enough.any():
        found['sfm_only_after'] = max(0.0, 1e-9 * float(stamps[np.argmax(enough)] - start))
    return found


def _read(fused):
    """Stamps [ns] and SfM-only pixels of all frames, the first image's median depth, and the number of pixels."""
    stamps, counts, depth, pixels = [], [], np.nan, 1
    with bags.open_bag(fused) as bag:
        for topic, message, _ in bag.read_messages(topics=[_MEAN, _LABEL]):
            if topic == _LABEL:
                label = bags.image(message)
                stamps.append(bags.stamp_of(message))
                counts.append(np.count_nonzero(label == runs.SFM_ONLY))
                pixels = label.size
            elif np.isnan(depth):
                depth = float(np.nanmedian(bags.image(message)))
    return np.array(stamps, np.int64), np.array(counts), depth, pixels
