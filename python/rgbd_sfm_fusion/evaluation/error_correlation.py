# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""How alike the errors of pixels are, by how far these are from each other."""

import numpy as np

DISTANCES = (1, 2, 3, 4, 5, 6, 8, 12, 16, 24)  # [px] along rows and columns


class ErrorCorrelation:
    """Of any number of images."""

    def __init__(self):
        self._products, self._squares = np.zeros(len(DISTANCES)), np.zeros(len(DISTANCES))

    def add(self, errors):
        """One image; NaN = none."""
        for i, distance in enumerate(DISTANCES):
            for image in (errors, errors.T):
                a, b = image[distance:], image[:-distance]
                both = np.isfinite(a) & np.isfinite(b)
                self._products[i] += (a[both] * b[both]).sum()
                self._squares[i] += (a[both]**2 + b[both]**2).sum() / 2

    def by_distance(self):
        """Correlations, as far as there are pairs of pixels; NaN elsewhere."""
        with np.errstate(invalid='ignore'):
            return self._products / self._squares
