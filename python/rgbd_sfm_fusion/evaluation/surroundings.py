# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The surroundings of pixels in a depth image [m] (NaN = none), as src/fusion/sfm_only.cpp judges them."""

import numpy as np

NEIGHBOURS = 24
NEAR, WIDE = 2, 8  # [px] spacings of neighbours

_STEP = 0.05  # of depth: a larger step is between two surfaces
_RING = 2     # neighbours to either side


def _same_surface(a, b):
    return np.maximum(a, b) < (1 + _STEP) * np.minimum(a, b)


def agreeing_neighbours(depth, spacing):
    """How many of the 24 pixels that are 0, 1 or 2 times `spacing` [px] away by row and column differ by less than 5 %."""
    margin = _RING * spacing
    padded = np.pad(depth, margin, constant_values=np.nan)
    steps = range(0, 2 * margin + 1, spacing)
    with np.errstate(invalid='ignore'):
        agreeing = sum(_same_surface(padded[down:down + depth.shape[0], right:right + depth.shape[1]],
                                     depth).astype(np.int64) for down in steps for right in steps)
    return np.maximum(agreeing - 1, 0)  # without the pixel itself
