# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Correlation of the errors of two pixels, by the distance between the pixels."""

import numpy as np

DISTANCES = (1, 2, 3, 4, 5, 6, 8, 12, 16, 24)  # [px] along rows and columns


class ErrorCorrelation:
    """Collects the errors of any number of images."""

    def __init__(self):
        self._products, self._squares = np.zeros(len(DISTANCES)), np.zeros(len(DISTANCES))

    def add(self, errors):
        """Adds the errors of one image; NaN = none."""
        for i, distance in enumerate(DISTANCES):
            for image in (errors, errors.T):
                a, b = image[distance:], image[:-distance]
                both = np.isfinite(a) & np.isfinite(b)
                self._products[i] += (a[both] * b[both]).sum()
                self._squares[i] += (a[both]**2 + b[both]**2).sum() / 2

    def by_distance(self):
        """The correlation for each distance; NaN where there are no pairs of pixels."""
        with np.errstate(invalid='ignore'):
            return self._products / self._squares
