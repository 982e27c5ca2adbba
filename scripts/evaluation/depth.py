# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Errors of fused depth against exact depth, by where a pixel's depth came from."""

import cv2
import numpy as np

PROVENANCE = {1: 'sensor only', 2: 'SfM only', 3: 'fused', 4: 'completed'}
_TABLE_1 = (1, 2, 3)
PLACES = ('outside mirrors', 'interior', 'in mirrors')
_CAP = 25.0  # of e²/σ²: nothing to a Gaussian, and one wild pixel does not hide all others
_SAMPLE = 11  # every 11th error goes into the median


class Errors:
    """Collects errors e [m] of depths with true value z [m] and stated variance v [m²]."""

    def __init__(self):
        self.count = 0
        self._sums = np.zeros(4)  # of e², capped e²/v, inside 2σ, beyond 5σ
        self._relative = []

    def add(self, e, z, v):
        e, z, v = (np.asarray(values, np.float64) for values in (e, z, v))
        ratio = e * e / v
        self.count += e.size
        self._sums += [(e * e).sum(), np.minimum(ratio, _CAP).sum(), (ratio < 4).sum(), (ratio > 25).sum()]
        self._relative.append((np.abs(e) / z)[::_SAMPLE])

    def summary(self):
        """Root mean square error [m], median relative error, NEES25, shares inside 2 and beyond 5 sigma."""
        if self.count == 0:
            return dict.fromkeys(('rmse', 'median_relative', 'nees25', 'inside_2_sigma', 'beyond_5_sigma'),
                                 float('nan'))
        squares, nees, inside, beyond = self._sums / self.count
        return {'rmse': float(np.sqrt(squares)), 'median_relative': float(np.median(np.concatenate(self._relative))),
                'nees25': float(nees), 'inside_2_sigma': float(inside), 'beyond_5_sigma': float(beyond)}


def interior(truth, margin=5, step=0.05):
    """Pixels farther than a margin [px] from every step of the true depth between neighbours (relative to the nearer
    one), and from holes."""
    filled = np.nan_to_num(truth, nan=0.0)
    edges = (filled == 0).astype(np.uint8)
    for a, b in (((slice(1, None),), (slice(-1),)), ((slice(None), slice(1, None)), (slice(None), slice(-1)))):
        apart = np.abs(filled[a] - filled[b]) > step * np.minimum(filled[a], filled[b])
        edges[a] |= apart
        edges[b] |= apart
    return cv2.dilate(edges, np.ones((2 * margin + 1, 2 * margin + 1), np.uint8)) == 0


class Evaluation:
    """Of all frames of a run: shares of the sources (the paper's Table I), and errors of each."""

    def __init__(self):
        self.frames = 0
        self.pixels = dict.fromkeys(PROVENANCE, 0)
        self.errors = {kind: {place: Errors() for place in PLACES} for kind in PROVENANCE}
        self.sensor_where_fused = {place: Errors() for place in PLACES}

    def add(self, mean, variance, provenance, truth=None, mirror=None, sensor=None,
            sensor_sigma=1.425e-3):
        """One frame. Without truth it only counts; with the sensor's depth of that frame also the sensor's
        own errors are compared, where the result is fused (its sigma = sensor_sigma * Z²)."""
        self.frames += 1
        for kind in PROVENANCE:
            self.pixels[kind] += int((provenance == kind).sum())
        if truth is None:
            return
        known = ~np.isnan(truth) & ~np.isnan(mean)
        outside = known if mirror is None else known & ~mirror
        for place, mask in zip(PLACES, (outside, outside & interior(truth), known & ~outside)):
            for kind in PROVENANCE:
                at = mask & (provenance == kind)
                self.errors[kind][place].add(mean[at] - truth[at], truth[at], variance[at])
            if sensor is not None:
                at = mask & (provenance == 3) & ~np.isnan(sensor)
                z = sensor[at].astype(np.float64)
                self.sensor_where_fused[place].add(z - truth[at], truth[at], (sensor_sigma * z * z)**2)

    def shares(self):
        """Per cent of the pixels with any depth that was measured, in the order of the paper's Table I."""
        total = max(1, sum(self.pixels[kind] for kind in _TABLE_1))
        return [100.0 * self.pixels[kind] / total for kind in _TABLE_1]
