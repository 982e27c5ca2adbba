# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The surroundings of pixels in a depth image [m] (NaN = none), as src/fusion/inlier_probability.cpp judges them."""

import numpy as np

NEIGHBOURS = 24

_STEP = 0.05              # of depth: a larger step is between two surfaces
_RADIUS, _SPACING = 4, 2  # [px] distances of the neighbours that may agree
_RIM = 4                  # [px] pixels so close to the end of their surface are beside what follows
_REACH = 12               # [px] of a gap between the surface and the one behind it

BESIDE, OPEN, NEITHER = 0, range(1, _RIM + 1), _RIM + 1


class _Around:
    """Shifts an image, so that each pixel holds the value that is some pixels away."""

    def __init__(self, image, none):
        self._shape, self._margin = image.shape, _RIM + _REACH
        self._padded = np.pad(image, self._margin, constant_values=none)

    def __call__(self, down, right):
        rows, columns = (slice(self._margin + step, self._margin + step + size)
                         for step, size in zip((down, right), self._shape))
        return self._padded[rows, columns]


def _same_surface(a, b):
    return np.maximum(a, b) < (1 + _STEP) * np.minimum(a, b)


def agreeing_neighbours(depth):
    """How many of the 24 pixels that are 0, 2 or 4 px away by row and column differ by less than 5 %."""
    around = _Around(depth, np.nan)
    steps = range(-_RADIUS, _RADIUS + 1, _SPACING)
    with np.errstate(invalid='ignore'):
        agreeing = sum(_same_surface(around(down, right), depth).astype(np.int64)
                       for down in steps for right in steps)
    return np.maximum(agreeing - 1, 0)  # without the pixel itself


def ends(depth):
    """How the surface of each pixel with depth ends within 4 px along the pixel's row or column. BESIDE: a surface behind
    the pixel's surface follows, at once or across a gap. One of OPEN: nothing is known beyond the end; the value is the
    distance to the end [px]. NEITHER: the surface does not end."""
    behind, open_end = np.zeros(depth.shape, bool), np.full(depth.shape, NEITHER)
    around = _Around(depth, np.nan)
    inside = _Around(np.ones(depth.shape, bool), False)
    with np.errstate(invalid='ignore'):
        for down, right in ((0, 1), (0, -1), (1, 0), (-1, 0)):
            goes_on = _same_surface(around(down, right), depth)
            beyond = np.full(depth.shape, np.nan, depth.dtype)  # the first depth on the way
            for step in range(_REACH, 0, -1):
                there = around(step * down, step * right)
                beyond = np.where(np.isnan(there), beyond, there)
            ended = inside(down, right) & ~goes_on
            on = _Around(goes_on, False)
            before_behind = _Around(ended & (beyond > (1 + _STEP) * depth), False)
            before_unknown = _Around(ended & np.isnan(beyond), False)
            reached = np.ones(depth.shape, bool)
            for step in range(_RIM):
                at = step * down, step * right
                behind |= reached & before_behind(*at)
                open_end[reached & before_unknown(*at) & (open_end > step)] = step + 1
                reached &= on(*at)
    return np.where(behind, BESIDE, open_end)
