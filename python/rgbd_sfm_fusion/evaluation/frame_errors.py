# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The error against the truth that all of SfM's inverse depths of a frame share."""

import numpy as np

_TILES = 8, 6
_FEWEST_PIXELS, _FEWEST_TILES = 30, 12
_WILD = 0.2  # of inverse depth: a larger error is not one that all of a frame shares


def _tiles(shape):
    rows, columns = np.indices(shape)
    return rows * _TILES[1] // shape[0] * _TILES[0] + columns * _TILES[0] // shape[1]


def _robust_fit(J, z, weights):
    """Least squares with Tukey's weights. The returned σ is the robust σ of the last round's residuals."""
    w = np.ones(len(z))
    for _ in range(20):
        root = np.sqrt(w) * weights
        fit = np.linalg.lstsq(J * root[:, None], z * root, rcond=None)[0]
        residuals = (z - J @ fit) * weights
        sigma = 1.4826 * np.median(np.abs(residuals)) + 1e-9
        w = np.maximum(0, 1 - (residuals / (4.685 * sigma)) ** 2) ** 2
    return fit, sigma


class FrameErrors:
    """Fits 1/Z_true = a / Z_sfm + b + c · (x, y) to the means of an image's tiles, frame by frame."""

    def __init__(self):
        self.rows = []

    def add(self, inverse_sfm, truth, chosen, K):
        """@param inverse_sfm  [1/m] before the frame's b and c are taken off
        @param chosen       pixels to look at"""
        with np.errstate(invalid='ignore', divide='ignore'):
            good = chosen & (np.abs(inverse_sfm * truth - 1) < _WILD)
        tile = _tiles(truth.shape)[good]
        rows, columns = np.nonzero(good)
        values = np.stack([1 / truth[good], inverse_sfm[good], np.ones(len(rows)),
                           (columns - K[0, 2]) / K[0, 0], (rows - K[1, 2]) / K[1, 1]])
        means = [values[:, tile == t].mean(1) for t in range(_TILES[0] * _TILES[1])
                 if (tile == t).sum() >= _FEWEST_PIXELS]
        if len(means) < _FEWEST_TILES:
            return
        means = np.array(means)
        fit, sigma = _robust_fit(means[:, 1:], means[:, 0], 1 / means[:, 0])
        self.rows.append([*fit, sigma])

    def spread(self):
        """Robust standard deviations over frames of ln a, b, c_x, c_y; and the median of the relative deviation of tiles
        from the fit."""
        rows = np.array(self.rows)
        logs = np.log(rows[:, 0])
        return [1.4826 * np.median(np.abs(logs - np.median(logs)))] + \
               [1.4826 * np.median(np.abs(rows[:, i])) for i in (1, 2, 3)] + [np.median(rows[:, 4])]
