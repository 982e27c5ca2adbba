# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Scores the depth of a run pixel by pixel, in sums that can be pooled over runs.

With an exact truth every source of depth is compared. Recorded depth is a truth only for depth that was not made from
recorded depth: SfM depth before fusion, and pixels labelled SfM only or completed. The σ of recorded depth is then added
to the stated σ."""

import numpy as np

from .. import bags
from .surface_interior import surface_interior
from .error_table import ErrorTable

SENSOR_SIGMA = 1.425e-3  # [1/m] σ of recorded depth Z is this times Z² (Khoshelham & Elberink 2012)
SOURCES = {'sensor': 1, 'sfm': 2, 'fused': 3, 'completed': 4}
TABLE_1 = ('sensor', 'sfm', 'fused')
IN_HOLES = (2, 4)  # labels that depth may have where the sensor has none
BANDS = 10  # [m] of depth, each 1 m wide
# Surfaces of the rendered room that the sensor does not see, by the values of its masks. What is far is matte.
SURFACES = {'far': 1, 'dark': 2, 'shiny': 3, 'sunlit': 4, 'mirror': 5}
_SURE = 0.1  # [Z] σ of depth that a robot can use
_STEP = 0.03  # of the depth: kStepRatio of lateral_variance.h
TOPICS = ('/fusion/mean', '/fusion/variance', '/fusion/provenance', '/fusion/sfm_depth', '/fusion/sfm_variance')

# Where a pixel is. In a mirror, the truth is the depth of the glass, but images show, and SfM sees, the mirrored scene.
_EDGE, _MIRROR, _PLACES = 1, 2, 4
_INTERIOR, _EDGES, _MIRRORS = [0], [_EDGE], [_MIRROR, _MIRROR + _EDGE]
_OUTSIDE = _INTERIOR + _EDGES
_PARTS = {'': _OUTSIDE, '_interior': _INTERIOR, '_edges': _EDGES, '_mirrors': _MIRRORS,
          '_with_mirrors': _OUTSIDE + _MIRRORS}


def surface_variance(depth, settings):
    """The variance that is stated for the sensor's depth [m] (NaN = none) on the pixel's own surface: the variance of
    withNoise() without steps, plus the variance of the errors that all depth shares."""
    variance = (settings['noise_quadratic'] * depth**2)**2 + settings['noise_floor']**2
    largest = np.maximum((_STEP * depth)**2, 9 * variance)
    steepness = -2 * variance
    for axis in (0, 1):
        differences = np.diff(depth, axis=axis, prepend=np.nan, append=np.nan)
        sides = np.stack([np.delete(differences, side, axis) for side in (0, -1)])
        known = sides**2 <= largest
        steepness += (np.where(known, sides, 0).sum(0) / np.maximum(known.sum(0), 1))**2
    return variance + settings['noise_lateral']**2 * np.maximum(steepness, 0) + (
        settings['common_scale_sigma'] * depth)**2 + (settings.get('common_offset_sigma', 0) * depth**2)**2


class DepthScore:
    def __init__(self, exact):
        self._exact = exact
        self._sources = ErrorTable(len(SOURCES) * _PLACES)
        self._sfm = ErrorTable(_PLACES)
        self._held_out = {label: ErrorTable(_PLACES) for label in IN_HOLES}
        self._labels = np.zeros(len(SOURCES) + 1)
        self._frames = self._pixels = self._with_sfm = 0
        self._holes, self._holes_leaked = np.zeros(_PLACES), 0
        self._holes_filled = {label: np.zeros(_PLACES) for label in IN_HOLES}
        self._unseen = self._refilled = self._refilled_sure = 0
        self._surfaces = np.zeros((3, len(SURFACES)))  # [px] unseen by the sensor; of these, with depth; completed
        # Sums of squares of the fused error, the sensor's error, the stated σ of both, and number of pixels. The second
        # index is 1 at edges, the third is the depth.
        self._bands = np.zeros((5, 2, BANDS))

    def __add__(self, other):
        both = DepthScore(self._exact)
        for name in vars(both):
            if name != '_exact':
                mine, others = getattr(self, name), getattr(other, name)
                setattr(both, name, {label: mine[label] + others[label] for label in mine}
                        if isinstance(mine, dict) else mine + others)
        return both

    def add(self, fused, truth, mirror=None, given=None, settings=None, material=None):
        """Adds one frame.
        @param fused     mean, variance, label, SfM depth, SfM variance
        @param mirror    pixels of a mirror, if known
        @param material  of each pixel, if known: see SURFACES
        @param given     sensor depth that the run was given [m], NaN = none
        @param settings  settings of the run"""
        mean, variance, label, sfm, sfm_variance = fused
        _check(mean, variance, label)
        place = np.where(surface_interior(truth), 0, _EDGE)
        if mirror is not None:
            place += _MIRROR * mirror
        known = np.isfinite(truth)
        own = 0.0 if self._exact else (SENSOR_SIGMA * truth**2)**2  # variance of the truth itself
        self._frames += 1
        self._pixels += label.size
        self._labels += np.bincount(label.ravel(), minlength=self._labels.size)[:self._labels.size]

        def compare(table, at, depth, stated, group):
            table.add(depth[at] - truth[at], truth[at], stated[at], group[at])

        at = known & (label > 0 if self._exact else np.isin(label, IN_HOLES))
        compare(self._sources, at, mean, variance + own, (label.astype(np.int64) - 1) * _PLACES + place)
        with_sfm = np.isfinite(sfm)
        self._with_sfm += int(with_sfm.sum())
        compare(self._sfm, known & with_sfm, sfm, sfm_variance + own, place)
        if given is None:
            return
        self._unseen += int(np.isnan(given).sum())
        self._refilled += int((np.isnan(given) & (label > 0)).sum())
        self._refilled_sure += int((np.isnan(given) & (label > 0) & (variance <= (_SURE * mean)**2)).sum())
        if material is not None:
            self._add_surfaces(np.isnan(given), label, truth, material, settings)
        hole = known & np.isnan(given)
        for kind in IN_HOLES:
            filled = hole & (label == kind)
            compare(self._held_out[kind], filled, mean, variance + own, place)
            self._holes_filled[kind] += np.bincount(place[filled], minlength=_PLACES)
        self._holes += np.bincount(place[hole], minlength=_PLACES)
        self._holes_leaked += int((hole & (label != 0) & ~np.isin(label, IN_HOLES)).sum())
        if self._exact and settings:
            at = known & (label == 3) & ~np.isnan(given) & (place < _MIRROR)
            values = ((mean - truth)**2, (given - truth)**2, variance, surface_variance(given, settings))
            group = (place * BANDS + np.minimum(truth, BANDS - 1))[at].astype(np.int64)
            for total, value in zip(self._bands, (*(value[at] for value in values), None)):
                total += np.bincount(group, value, 2 * BANDS).reshape(2, BANDS)

    def _add_surfaces(self, unseen, label, truth, material, settings):
        beyond = truth > (settings or {}).get('max_range', np.inf)
        for column, (name, value) in enumerate(SURFACES.items()):
            surface = unseen & (material == value)
            if name == 'far':
                surface &= beyond
            self._surfaces[:, column] += [(surface & which).sum() for which in (True, label > 0, label == 4)]

    def results(self):
        """A dictionary of numbers and of dictionaries of numbers; shares are from 0 to 1."""
        found = {'frames_scored': self._frames, 'sfm_density': _ratio(self._with_sfm, self._pixels)}
        measured = self._labels[[SOURCES[source] for source in TABLE_1]]
        for source, share in zip(TABLE_1, _ratio(measured, measured.sum())):
            found['share_' + source] = float(share)
        found['share_completed'] = _ratio(self._labels[SOURCES['completed']], self._pixels)
        found['refilled'] = _ratio(self._refilled, self._unseen)
        found['refilled_sure'] = _ratio(self._refilled_sure, self._unseen)
        for name, (unseen, filled, completed) in zip(SURFACES, self._surfaces.T):
            found['filled_' + name], found['completed_' + name] = _ratio(filled, unseen), _ratio(completed, unseen)
        for name, places in _PARTS.items():
            found['before_fusion' + name] = self._sfm.summary(places)
            for source, label in SOURCES.items():
                if self._exact or label in IN_HOLES:
                    groups = [(label - 1) * _PLACES + place for place in places]
                    found[source + name] = self._sources.summary(groups)
            together = 0.0
            for kind, suffix in zip(IN_HOLES, ('', '_completed')):
                covered = _ratio(self._holes_filled[kind][places].sum(), self._holes[places].sum())
                found['held_out' + suffix + name] = {**self._held_out[kind].summary(places), 'coverage': covered}
                together += covered
            found['held_out' + name]['coverage_together'] = together
        found['held_out']['share_of_pixels'] = _ratio(self._holes.sum(), self._pixels)
        found['held_out']['other_labels'] = _ratio(self._holes_leaked, self._holes.sum())
        edges, interior = found.get('completed_edges', {}), found.get('completed_interior', {})
        if 'rmse' in edges and 'rmse' in interior:
            edges['rmse_over_interior'] = _ratio(edges['rmse'], interior['rmse'])
        found['gain_interior'], found['gain_edges'] = (self._gain(place) for place in (0, _EDGE))
        return found

    def _gain(self, place):
        """Ratio of the RMSE of fused depth to the RMSE of the sensor's depth at the same pixels, by metre: as measured,
        and as the variances state."""
        bands = {}
        for metre in range(BANDS):
            fused, sensor, stated_fused, stated_sensor, count = self._bands[:, place, metre]
            if count >= 1000:
                ratio, stated = np.sqrt(fused / sensor), np.sqrt(stated_fused / stated_sensor)
                bands[f'{metre}_{metre + 1}'] = {
                    'pixels': int(count), 'ratio': float(ratio), 'stated_ratio': float(stated),
                    'share_of_stated_gain': float((1 - ratio) / (1 - stated)) if stated < 0.999 else float('nan')}
        return bands


def _ratio(part, whole):
    return part / whole if whole else part * float('nan')


def _check(mean, variance, label):
    """Checks what every message promises."""
    there = label > 0
    if (np.isfinite(mean) != there).any():
        raise ValueError('provenance and mean disagree about where there is a depth')
    if not ((variance[there] > 0) & np.isfinite(variance[there])).all():
        raise ValueError('a depth has no finite positive variance')


def given_depth(path, sequence, wanted):
    """Yields the rectified sensor depth [m] of an input bag for each of the wanted colour stamps; None if there is no
    depth. The stamps have to rise."""
    topic = '/camera/depth_registered/image_raw'
    with bags.open_bag(path) as bag:
        messages = bag.read_messages(topics=[topic])
        stamp, message = None, None
        for colour in wanted:
            depth_stamp = sequence.depth_stamp.get(colour)
            while depth_stamp is not None and (stamp is None or stamp < depth_stamp):
                _, message, _ = next(messages, (None, None, None))
                if message is None:
                    break
                stamp = bags.stamp_of(message)
            there = message is not None and stamp == depth_stamp
            yield bags.metres(sequence.camera.rectified(bags.image(message))) if there else None


def score(fused, given, sequence, settings, every=1):
    """Compares the bag that fuse_bag wrote with the truth of a sequence.
    @param given  the bag that was fused
    @param every  look at every Nth frame only"""
    result = DepthScore(sequence.exact)
    with bags.open_bag(fused) as bag:
        wanted = [stamp for stamp in bags.stamps(bag, '/tracker/frame')[::every] if stamp in sequence]
        sensor = given_depth(given, sequence, wanted)
        chosen = set(wanted)
        for stamp, messages in bags.synchronised(bag, TOPICS):
            if stamp not in chosen:
                continue
            images = [bags.image(messages[topic]) for topic in TOPICS]
            result.add(images, sequence.true_depth(stamp), sequence.mirror(stamp), next(sensor), settings,
                       sequence.material(stamp))
    if not wanted:
        raise ValueError(f'{fused} has no frame of {sequence.folder}')
    return result
