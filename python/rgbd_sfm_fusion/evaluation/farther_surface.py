# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""How often completed depth should have been that of a farther surface beside it, for src/completion/surroundings.cpp."""

import numpy as np

DISTANCES = (4, 8, 12, 16, 24, 32)  # [px], along eight rays
_RAYS = [(down, right) for down in (-1, 0, 1) for right in (-1, 0, 1) if (down, right) != (0, 0)]
_STEP = 0.2  # of depth: smaller ones may be the slope of the surface itself


def nearest_farther(depth):
    """@param depth  H x W [m], NaN = none
    @return two images: the distance [px] to the nearest depth that is much farther, NaN where there is none, and how much
            farther it is, relative"""
    reach = DISTANCES[-1]
    padded = np.pad(depth, reach, constant_values=np.nan)
    rows, columns = depth.shape
    distance, step = np.full(depth.shape, np.nan), np.full(depth.shape, np.nan)
    for length in DISTANCES[::-1]:
        farthest = np.full(depth.shape, 0.0)
        for down, right in _RAYS:
            there = padded[reach + length * down:reach + length * down + rows,
                           reach + length * right:reach + length * right + columns]
            with np.errstate(invalid='ignore', divide='ignore'):
                farthest = np.fmax(farthest, there / depth - 1)
        found = farthest > _STEP
        distance[found], step[found] = length, farthest[found]
    return distance, step


class FartherSurface:
    """Counts completed pixels by the distance to the nearest farther surface."""

    def __init__(self):
        self._sums = {key: np.zeros(3) for key in DISTANCES + (None,)}

    def add(self, depth, truth, completed):
        """@param completed  the pixels to count. NaN in `truth` is not known"""
        distance, step = nearest_farther(depth)
        known = completed & np.isfinite(truth)
        too_near = np.maximum(truth / depth - 1, 0)
        for key, sums in self._sums.items():
            at = known & (np.isnan(distance) if key is None else distance == key)
            moment = np.minimum(too_near[at] / step[at], 1)**2 if key else np.zeros(0)
            sums += at.sum(), (np.abs(depth / truth - 1)[at] > 0.1).sum(), moment.sum()

    def rows(self):
        """[(distance [px] or None, pixels, share more than 10 % off, probability of the farther surface)]. The probability
        is the mean square of the error over the step."""
        return [(key, int(count), wrong / max(1, count), moment / max(1, count))
                for key, (count, wrong, moment) in self._sums.items()]

    def fit(self):
        """@return a, l [px] of a * exp(-distance / l) for the probability, or None"""
        rows = [(key, count, moment) for key, count, _, moment in self.rows() if key and count > 100 and moment > 0]
        if len(rows) < 3:
            return None
        distance, count, moment = np.array(rows).T
        slope, at_zero = np.polyfit(distance, np.log(moment), 1, w=np.sqrt(count))
        return float(np.exp(at_zero)), float(-1 / slope)
