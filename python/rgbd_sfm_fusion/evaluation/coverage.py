# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The share of pixels with SfM depth among those that stereo could measure, but the sensor does not."""

import cv2
import numpy as np

from ..tum import nearest_index

TEXTURE = 8  # [grey level per px] least gradient
IN_VIEW = 1.0  # [s]
PARALLAX = np.radians(1.0)
_STEP = 0.25  # [s] visibility is looked at this often
_STEPS_BACK = 12
_SAME_SURFACE = 0.03  # largest relative difference between depths of one point


def textured(grey):
    """Pixels that have a gradient of at least TEXTURE in their 3 x 3 neighbourhood."""
    values = grey.astype(np.float32)
    gradient = np.hypot(cv2.Sobel(values, -1, 1, 0, ksize=1), cv2.Sobel(values, -1, 0, 1, ksize=1)) / 2
    return cv2.dilate(gradient, np.ones((3, 3), np.uint8)) >= TEXTURE


class Visibility:
    """The time for which points of a frame have been in view, by the true depths and poses of earlier frames."""

    def __init__(self, truth, poses):
        self._truth, self._poses = truth, poses
        self._rays = truth.rays()
        self._depths = {}

    def _depth(self, stamp):
        if stamp not in self._depths:
            if len(self._depths) > 4 * _STEPS_BACK:
                self._depths.pop(next(iter(self._depths)))
            self._depths[stamp] = self._truth[stamp]
        return self._depths[stamp]

    def observable(self, stamp, depth):
        """H x W: whether a pixel was seen for IN_VIEW or longer up to this frame, from directions PARALLAX or more
        apart."""
        at = nearest_index(self._poses.stamps, stamp)
        R, t = self._poses.rotations[at], self._poses.positions[at]
        rows, columns = np.nonzero(~np.isnan(depth))
        points = (self._rays[rows, columns] * depth[rows, columns, None]) @ R.T + t
        seen = np.ones(len(points), bool)
        long_enough = np.zeros(len(points), bool)
        cosine = np.ones(len(points))
        now = points - t
        now /= np.linalg.norm(now, axis=1, keepdims=True)
        for step in range(1, _STEPS_BACK + 1):
            then = stamp - int(step * _STEP * 1e9)
            earlier = nearest_index(self._poses.stamps, then)
            nearest = int(self._poses.stamps[earlier])
            if abs(nearest - then) > 1e9 * _STEP / 2 or nearest not in self._truth:
                break
            seen &= self._sees(earlier, nearest, points)
            if not seen.any():
                break
            way = points - self._poses.positions[earlier]
            way /= np.linalg.norm(way, axis=1, keepdims=True)
            cosine = np.where(seen, np.minimum(cosine, (way * now).sum(axis=1)), cosine)
            if step * _STEP >= IN_VIEW:
                long_enough |= seen
        result = np.zeros(depth.shape, bool)
        result[rows, columns] = long_enough & (cosine <= np.cos(PARALLAX))
        return result

    def _sees(self, pose, stamp, points):
        local = (points - self._poses.positions[pose]) @ self._poses.rotations[pose]
        depth = self._depth(stamp)
        fx, fy, cx, cy = self._truth.intrinsics
        with np.errstate(divide='ignore', invalid='ignore'):
            x = np.rint(local[:, 0] / local[:, 2] * fx + cx)
            y = np.rint(local[:, 1] / local[:, 2] * fy + cy)
        inside = (local[:, 2] > 0) & (x >= 0) & (x < depth.shape[1]) & (y >= 0) & (y < depth.shape[0])
        there = np.full(len(points), np.nan)
        there[inside] = depth[y[inside].astype(int), x[inside].astype(int)]
        with np.errstate(invalid='ignore'):
            return np.abs(there - local[:, 2]) <= _SAME_SURFACE * local[:, 2]


class Coverage:
    """Collects frames. Mirrors do not count as pixels that could be covered. SfM depth in mirrors is counted apart."""

    def __init__(self, visibility):
        self._visibility = visibility
        self.possible = self.covered = self.in_mirrors = 0
        self._errors, self._errors_with_mirrors = [], []

    def add(self, stamp, grey, sensor, mean, provenance, truth, mirror):
        mirror = np.zeros(truth.shape, bool) if mirror is None else mirror
        candidates = textured(grey) & np.isnan(sensor)
        observable = candidates & self._visibility.observable(stamp, np.where(candidates, truth, np.nan))
        possible, covered = observable & ~mirror, observable & (provenance == 2)
        self.possible += int(possible.sum())
        self.covered += int((covered & ~mirror).sum())
        self.in_mirrors += int((covered & mirror).sum())
        error = np.abs(mean - truth) / truth
        self._errors.append(error[covered & ~mirror])
        self._errors_with_mirrors.append(error[covered])

    def summary(self):
        """Share of the pixels that could be covered and are covered; the median relative error of covered pixels; this
        error with mirrors included."""
        def median(errors):
            errors = np.concatenate(errors) if errors else np.array([])
            return float(np.median(errors)) if errors.size else float('nan')
        share = self.covered / self.possible if self.possible else float('nan')
        return share, median(self._errors), median(self._errors_with_mirrors)
