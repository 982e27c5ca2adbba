# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The numbers that a page shows of a run. Numbers of every frame are from the tables of the run. Images are read of some
frames only, evenly over the run."""

import numpy as np

from ..evaluation.depth_score import surface_variance
from ..evaluation.error_table import ErrorTable
from ..evaluation.truth_errors import TruthErrors
from ..runs import COMPLETED, FUSED, SENSOR_ONLY, SFM_ONLY, SOURCES
from .later import LaterViews

PAPER = {'sensor_only': 63.3, 'sfm_only': 10.3, 'fused': 26.3}  # Table I: % of pixels with any depth, mean of three
ADDED = (SFM_ONLY, COMPLETED)
_STRIDE = 3  # [px] between pixels that are looked at


def evenly(count, wanted):
    """Up to `wanted` indices below `count`, at equal distances, with half of that distance at both ends."""
    wanted = min(count, wanted)
    return [int((i + 0.5) * count / wanted) for i in range(wanted)]


def share(part, whole):
    return part / whole if whole else float('nan')


class Coverage:
    """The number of pixels by source of their depth, for every frame. It is from the tables alone."""

    def __init__(self, run):
        width, height = run.size
        with_depth, table = run.table['pixels_with_depth'], run.table
        self.pixels = width * height
        completed = np.nan_to_num(table.get('completed', np.zeros(len(run))))
        # In Table I, 100 % are the pixels with depth from one of its three sources; for completed, all pixels are.
        self.by_source = {SENSOR_ONLY: table['sensor_only'] * with_depth, SFM_ONLY: table['sfm_only'] * with_depth,
                          FUSED: table['fused'] * with_depth, COMPLETED: completed * self.pixels}
        self.added = sum(self.by_source[source] for source in ADDED)
        measured = self.by_source[SENSOR_ONLY] + self.by_source[FUSED]
        self.without_sensor = self.pixels - measured
        self.has_completed = 'completed' in table

    def refilled(self):
        """For each frame, the share of the pixels without sensor depth that got a depth."""
        return np.divide(self.added, self.without_sensor, out=np.full(len(self.added), np.nan),
                         where=self.without_sensor > 0)

    def total_refilled(self):
        return share(self.added.sum(), self.without_sensor.sum())

    def without_sensor_share(self):
        return float(self.without_sensor.mean() / self.pixels)

    def added_share(self):
        """Of all pixels."""
        return float(self.added.mean() / self.pixels)

    def table_1(self):
        """In % of the pixels with depth from one of the paper's three sources."""
        sums = {name: self.by_source[source].sum()
                for name, source in (('sensor_only', SENSOR_ONLY), ('sfm_only', SFM_ONLY), ('fused', FUSED))}
        whole = sum(sums.values())
        return {name: 100 * share(value, whole) for name, value in sums.items()}

    def completed_share(self):
        """Of all pixels."""
        return float(self.by_source[COMPLETED].mean() / self.pixels)


class Sigmas:
    """The stated standard deviations by source: medians and 90 % quantiles, in metres and of the depth."""

    def __init__(self):
        self._values = {source: ([], []) for source in range(1, len(SOURCES))}

    def add(self, frame):
        label = frame.provenance[::_STRIDE, ::_STRIDE]
        sigma, mean = frame.sigma[::_STRIDE, ::_STRIDE], frame.mean[::_STRIDE, ::_STRIDE]
        for source, (absolute, relative) in self._values.items():
            at = label == source
            absolute.append(sigma[at])
            relative.append(sigma[at] / mean[at])

    def quantiles(self, *sources):
        """{'count', 'median', 'ninth', 'relative_median', 'relative_ninth'}; None where there is nothing."""
        absolute, relative = (np.concatenate([np.concatenate(self._values[source][i]) if self._values[source][i]
                                              else np.array([]) for source in sources]) for i in (0, 1))
        if not absolute.size:
            return None
        return dict(zip(('median', 'ninth', 'relative_median', 'relative_ninth'),
                        [float(value) for values in (absolute, relative) for value in np.quantile(values, (0.5, 0.9))]),
                    count=absolute.size * _STRIDE**2)


class Overlap:
    """Differences where sensor and SfM both have a depth, compared with their stated deviations, by the source that each
    pixel has in the end."""

    SOURCES = (FUSED, SENSOR_ONLY, SFM_ONLY)
    _BINS = np.geomspace(1e-3, 1, 31)  # [m] of stated σ

    def __init__(self, settings):
        self._settings = settings
        self._table = ErrorTable(len(SOURCES))
        self._differences = {source: [[] for _ in self._BINS[1:]] for source in self.SOURCES}
        self.pixels = self.all_pixels = 0

    def add(self, frame, sensor):
        sfm, variance = frame.sfm_depth, frame.sfm_variance + surface_variance(sensor, self._settings)
        both = np.isfinite(sfm) & np.isfinite(variance) & (variance > 0)
        self.pixels += int(both.sum())
        self.all_pixels += both.size
        label = frame.provenance
        e, z, v = (sfm - sensor)[both], sensor[both], variance[both]
        self._table.add(e, z, v, label[both])
        bins = np.digitize(np.sqrt(v), self._BINS) - 1
        for source in self.SOURCES:
            of_source = label[both] == source
            for i, differences in enumerate(self._differences[source]):
                differences.append(np.abs(e[of_source & (bins == i)])[::5].astype(np.float32))

    def summary(self, *sources):
        """As ErrorTable.summary(); of all pixels if no sources are given."""
        return self._table.summary(list(sources) if sources else slice(None))

    def curve(self, *sources, fewest=200):
        """Stated σ [m], and the robust spread [m] of the differences that have it; of all pixels if no sources are given."""
        stated, shown = [], []
        for i in range(len(self._BINS) - 1):
            values = np.concatenate([part for source in sources or self.SOURCES
                                     for part in self._differences[source][i]] or [np.array([])])
            if values.size * 5 >= fewest:
                stated.append(np.sqrt(self._BINS[i] * self._BINS[i + 1]))
                shown.append(1.4826 * np.median(values))
        return np.array(stated), np.array(shown)


class Facts:
    """@param recording  the input of the run, or None
    @param sequence   truth, or None
    @param looked_at  number of frames whose images are read"""

    def __init__(self, run, recording=None, sequence=None, looked_at=80):
        self.run = run
        self.coverage, self.sigmas = Coverage(run), Sigmas()
        can_compare = recording is not None and run.has('sfm_depth') and run.has('sfm_variance') and run.settings
        self.overlap = Overlap(run.settings) if can_compare else None
        self.truth = TruthErrors(sequence) if sequence is not None else None
        self.later = LaterViews(run) if recording is not None else None
        self.looked_at = evenly(len(run), looked_at)
        for index in self.looked_at:
            frame = run.frame(index)
            sensor = recording.depth_of(run, index, frame) if recording else None
            self.sigmas.add(frame)
            if self.overlap and sensor is not None:
                self.overlap.add(frame, sensor)
            if self.truth:
                self.truth.add(frame, sensor)
            if self.later and sensor is not None:
                self.later.add(frame, sensor)

    def states(self):
        """{state: number of frames}"""
        return {state: self.run.states.count(state) for state in ('tracking', 'initialising', 'lost')}

    def frames_per_second(self):
        duration = self.run.seconds()[-1]
        return (len(self.run) - 1) / duration if duration > 0 else float('nan')
