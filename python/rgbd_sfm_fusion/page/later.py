# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Points whose depth was added where the sensor measured nothing, compared with what it measures there from nearby."""

import dataclasses

import numpy as np

from ..evaluation.depth_score import SENSOR_SIGMA
from ..evaluation.error_table import ErrorTable
from ..runs import COMPLETED, SFM_ONLY

_STRIDE = 4        # [px] between points that are kept
_FRAMES = 80       # kept at most, each with its added points and its sensor depth
_PARALLAX = 2.0    # [°] between the viewpoints: from farther away, the sensor mostly measures something else
_IN_FRONT = 0.1    # share of the depth: something that is so much nearer hides the point


@dataclasses.dataclass
class _View:
    points: np.ndarray    # N x 3, in tracker units and the world
    depth: np.ndarray     # [m]
    variance: np.ndarray  # [m²]
    pose: np.ndarray      # 4 x 4, camera to world
    alpha: float
    sensor: np.ndarray    # [m]


class LaterViews:
    """Keeps added points of some frames, and looks for them in the sensor depth of the others, by the run's own poses.
    The sensor's noise is added to the stated variances."""

    def __init__(self, run):
        self._K = run.K
        self._views = []
        self._result = None

    def add(self, frame, sensor):
        if frame.T_world_camera is None:
            return
        at = np.zeros(frame.mean.shape, bool)
        at[::_STRIDE, ::_STRIDE] = True
        at &= np.isin(frame.provenance, (SFM_ONLY, COMPLETED)) & np.isnan(sensor)
        alpha = frame.alpha if np.isfinite(frame.alpha) else 1.0
        points = frame.points(self._K)[at] / alpha
        pose = frame.T_world_camera
        self._views.append(_View(points @ pose[:3, :3].T + pose[:3, 3], frame.mean[at], frame.variance[at], pose, alpha,
                                 sensor.astype(np.float32)))
        if len(self._views) > _FRAMES:
            self._views = self._views[::2]

    def compared(self):
        """@return ErrorTable of the differences; share of the added points that were measured; share that had something
        in front of them instead. The latter are not compared"""
        if self._result is None:
            self._result = self._compare()
        return self._result

    def _compare(self):
        table, measured, hidden, count = ErrorTable(), 0, 0, 0
        for view in self._views:
            count += len(view.points)
            error, least = np.full(len(view.points), np.nan), np.full(len(view.points), np.radians(_PARALLAX))
            for other in self._views:
                if other is view or not len(view.points):
                    continue
                parallax = _parallax(view, other)
                difference = self._difference(view.points, other)
                closer = np.isfinite(difference) & (parallax < least)
                error[closer], least[closer] = difference[closer], parallax[closer]
            with np.errstate(invalid='ignore'):
                in_front = error > _IN_FRONT * view.depth
            at = np.isfinite(error) & ~in_front
            measured, hidden = measured + int(at.sum()), hidden + int(in_front.sum())
            own = (SENSOR_SIGMA * view.depth[at]**2)**2
            table.add(error[at], view.depth[at], view.variance[at] + own)
        return table, measured / max(1, count), hidden / max(1, count)

    def _difference(self, points, other):
        """By how much [m] another frame's sensor depth is nearer than the points; NaN where it has none."""
        local = (points - other.pose[:3, 3]) @ other.pose[:3, :3]
        depth = other.alpha * local[:, 2]
        height, width = other.sensor.shape
        with np.errstate(divide='ignore', invalid='ignore'):
            x = np.rint(local[:, 0] / local[:, 2] * self._K[0, 0] + self._K[0, 2])
            y = np.rint(local[:, 1] / local[:, 2] * self._K[1, 1] + self._K[1, 2])
        inside = (depth > 0) & (x >= 0) & (x < width) & (y >= 0) & (y < height)
        seen = np.full(len(points), np.nan)
        seen[inside] = other.sensor[y[inside].astype(int), x[inside].astype(int)]
        return depth - seen


def _parallax(view, other):
    """Angle [rad] at each point of the first view between both viewpoints."""
    ways = [view.points - each.pose[:3, 3] for each in (view, other)]
    lengths = [np.linalg.norm(way, axis=1) for way in ways]
    with np.errstate(divide='ignore', invalid='ignore'):
        cosine = (ways[0] * ways[1]).sum(axis=1) / (lengths[0] * lengths[1])
    return np.arccos(np.clip(np.nan_to_num(cosine, nan=-1), -1, 1))
