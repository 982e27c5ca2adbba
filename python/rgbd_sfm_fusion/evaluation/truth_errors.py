# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Errors of a run's depth against a truth, by where a pixel's depth came from."""

import numpy as np

from ..runs import COMPLETED, FUSED, SFM_ONLY, SOURCES
from .surface_interior import surface_interior
from .depth_score import SENSOR_SIGMA
from .error_table import ErrorTable

_EDGE, _INTERIOR, _MIRROR, _PLACES = range(4)
PLACES = {'outside mirrors': (_EDGE, _INTERIOR), 'interior': (_INTERIOR,), 'in mirrors': (_MIRROR,)}
SENSOR_WHERE_FUSED = 'the sensor, where fused'
_ADDED = (SFM_ONLY, COMPLETED)


class TruthErrors:
    """Collects frames. An exact truth judges every source. Recorded sensor depth cannot judge results that were made from
    recorded depth. Recorded depth judges only added depth, at pixels for which the run was given no depth. The sensor's
    own variance is then added to the stated one.

    @param sequence  sequence.Sequence"""

    def __init__(self, sequence):
        self.sequence, self.frames = sequence, 0
        self._table = ErrorTable((len(SOURCES) + 1) * _PLACES)

    def add(self, frame, sensor=None):
        """@param frame  runs.Frame. @param sensor  depth that the run was given [m], if known"""
        if frame.stamp not in self.sequence:
            return
        truth, mirror = self.sequence.true_depth(frame.stamp), self.sequence.mirror(frame.stamp)
        if truth.shape != frame.mean.shape:
            raise ValueError(f'{self.sequence.folder} has depth of {truth.shape[1]}x{truth.shape[0]} pixels, the run of '
                             f'{frame.mean.shape[1]}x{frame.mean.shape[0]}: expected the truth of this run')
        self.frames += 1
        place = np.where(surface_interior(truth), _INTERIOR, _EDGE)
        if mirror is not None:
            place[mirror] = _MIRROR
        label = frame.provenance.astype(np.int64)
        known = np.isfinite(truth) & (label > 0) & (label < len(SOURCES))
        variance = frame.variance
        if not self.sequence.exact:
            known &= np.isin(label, _ADDED)
            if sensor is not None:
                known &= np.isnan(sensor)
            variance = variance + _sensor_variance(truth)
        self._compare(known, frame.mean, truth, variance, label * _PLACES + place)
        if self.sequence.exact and sensor is not None:
            both = known & (label == FUSED) & np.isfinite(sensor)
            self._compare(both, sensor, truth, _sensor_variance(sensor), len(SOURCES) * _PLACES + place)

    def _compare(self, at, depth, truth, variance, group):
        self._table.add((depth - truth)[at], truth[at], variance[at], group[at])

    def summary(self, *sources, place='outside mirrors'):
        """ErrorTable.summary() of several sources together. len(SOURCES) stands for the sensor's depth of fused
        pixels."""
        return self._table.summary([source * _PLACES + where for source in sources for where in PLACES[place]])

    def of_added(self):
        return self.summary(*_ADDED)

    def rows(self):
        """[(source, place, summary)] for each source and place with enough pixels."""
        names = SOURCES[1:] + (SENSOR_WHERE_FUSED,)
        found = [(name, place, self.summary(source, place=place))
                 for source, name in enumerate(names, 1) for place in PLACES]
        return [row for row in found if 'rmse' in row[2]]


def _sensor_variance(depth):
    return (SENSOR_SIGMA * depth**2)**2
