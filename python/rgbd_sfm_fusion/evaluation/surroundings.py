# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The surroundings of pixels in a depth image [m] (NaN = none), as src/fusion/evidence.cpp judges them."""

import numpy as np

NEIGHBOURS = 24

_STEP = 0.06              # of depth: a larger step is between two surfaces
_RADIUS, _SPACING = 4, 2  # [px] distances of the neighbours that may agree
_RIM = 4                  # [px] pixels so close to the end of their surface are beside what follows
_REACH = 12               # [px] of a gap between the surface and the one behind it


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
    """How many of the 24 pixels that are 0, 2 or 4 px away by row and column differ by less than 6 %."""
    around = _Around(depth, np.nan)
    steps = range(-_RADIUS, _RADIUS + 1, _SPACING)
    with np.errstate(invalid='ignore'):
        agreeing = sum(_same_surface(around(down, right), depth).astype(np.int64)
                       for down in steps for right in steps)
    return np.maximum(agreeing - 1, 0)  # without the pixel itself


def beside_surface_behind(depth):
    """Whether the surface of each pixel with depth ends within 4 px along the pixel's row or column, and a surface behind
    it follows, at once or across a gap."""
    behind = np.zeros(depth.shape, bool)
    around = _Around(depth, np.nan)
    with np.errstate(invalid='ignore'):
        for down, right in ((0, 1), (0, -1), (1, 0), (-1, 0)):
            goes_on = _same_surface(around(down, right), depth)
            beyond = np.full(depth.shape, np.nan, depth.dtype)  # the first depth on the way
            for step in range(_REACH, 0, -1):
                there = around(step * down, step * right)
                beyond = np.where(np.isnan(there), beyond, there)
            on = _Around(goes_on, False)
            before_behind = _Around(~goes_on & (beyond > (1 + _STEP) * depth), False)
            reached = np.ones(depth.shape, bool)
            for step in range(_RIM):
                at = step * down, step * right
                behind |= reached & before_behind(*at)
                reached &= on(*at)
    return behind
