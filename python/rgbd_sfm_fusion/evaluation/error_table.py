# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Errors of depths that come with a variance, counted in histograms. Any number of pixels takes little memory. Runs are
pooled by adding their tables."""

import numpy as np

CAP = 25.0  # of e²/σ²: a Gaussian hardly exceeds it, and one wild pixel does not hide all others
_LOWEST, _HIGHEST, _WIDTH = -18.0, 6.0, 0.01  # of the bins of a logarithm: each bin is 1 % wide
_BINS = int(round((_HIGHEST - _LOWEST) / _WIDTH))
_EDGES = np.exp(_LOWEST + _WIDTH * np.arange(_BINS + 1))
_SUMS = ('count', 'e2', 'v', 'capped', 'inside_2', 'beyond_5', 'within_10_percent', 'sigma_over_a_fifth', 'n2',
         'log_sigma', 'log_z', 'relative2', 'nearer')
_FEWEST = 100  # fewer pixels tell nothing


def _bins(logarithm):
    return np.clip((logarithm - _LOWEST) / _WIDTH, 0, _BINS - 1).astype(np.int64)


def _quantile(histogram, share):
    total = np.concatenate([[0.0], np.cumsum(histogram)])
    return float(np.interp(share * total[-1], total, _EDGES))


class ErrorTable:
    """Errors of several groups of pixels, e.g. by where their depth came from."""

    def __init__(self, groups=1):
        self._groups = groups
        self._sums = np.zeros((len(_SUMS), groups))
        self._by_sigma = np.zeros((2, groups, _BINS))  # by σ/Z: number of pixels, and sum of capped e²/σ²
        self._relative = np.zeros((2, groups, _BINS))  # |e|/Z, of negative and of positive e
        self._ratio = np.zeros((groups, _BINS))        # |e|/σ

    def add(self, e, z, v, group=0):
        """Adds errors e [m] of depths with true value z [m] and stated variance v [m²].
        @param group  the group of each error, or one group for all"""
        if np.size(e) == 0:
            return
        e, z, v = (np.asarray(values, np.float64) for values in (e, z, v))
        group = np.broadcast_to(np.asarray(group, np.int64), e.shape)
        n2, absolute = e * e / v, np.abs(e)
        capped, relative = np.minimum(n2, CAP), absolute / z
        log_z, log_sigma = np.log(z), 0.5 * np.log(v)
        log_e = np.log(np.maximum(absolute, 1e-12))
        values = (None, e * e, v, capped, n2 < 4, n2 > 25, relative < 0.1, v > (0.2 * z)**2, n2, log_sigma, log_z,
                  relative * relative, e < -0.1 * z)
        for total, value in zip(self._sums, values):
            total += np.bincount(group, value, self._groups)

        def count(bins, weights=None):
            return np.bincount(group * _BINS + bins, weights, self._groups * _BINS).reshape(self._groups, _BINS)

        by_sigma = _bins(log_sigma - log_z)
        self._by_sigma += count(by_sigma), count(by_sigma, capped)
        by_error = _bins(log_e - log_z)
        positive = count(by_error, e > 0)
        self._relative += count(by_error) - positive, positive
        self._ratio += count(_bins(log_e - log_sigma))

    def __add__(self, other):
        both = ErrorTable(self._groups)
        for name in ('_sums', '_by_sigma', '_relative', '_ratio'):
            setattr(both, name, getattr(self, name) + getattr(other, name))
        return both

    def summary(self, groups=slice(None)):
        """Numbers of some groups together. Relative errors are relative to the true depth. With too few pixels, only the
        count is given.

        nees25 is the mean of min(e²/σ², 25). nees25_by_decile has this mean for each tenth of the pixels, in the order
        of the stated σ/Z. log_likelihood_gain [nats per pixel] compares with a single σ/Z for all pixels, the one that
        would fit best."""
        sums = dict(zip(_SUMS, self._sums[:, groups].sum(axis=1)))
        n = sums['count']
        if n < _FEWEST:
            return {'count': int(n)}
        below, above = self._relative[:, groups].sum(axis=1)
        signed = np.concatenate([below[::-1], above])
        signed_edges = np.concatenate([-_EDGES[:0:-1], [0.0], _EDGES[1:]])
        per_sigma, capped = (np.concatenate([[0.0], np.cumsum(values)]) for values in
                             self._by_sigma[:, groups].sum(axis=1))
        deciles = np.diff(np.interp(np.linspace(0, n, 11), per_sigma, capped)) * 10 / n
        constant = sums['log_z'] / n + 0.5 * np.log(max(sums['relative2'] / n, 1e-30)) + 0.5
        return {
            'count': int(n), 'rmse': float(np.sqrt(sums['e2'] / n)), 'median_relative': _quantile(below + above, 0.5),
            'bias_relative': float(np.interp(0.5 * n, np.concatenate([[0.0], np.cumsum(signed)]), signed_edges)),
            'within_10_percent': sums['within_10_percent'] / n, 'nees25': sums['capped'] / n,
            'inside_2_sigma': sums['inside_2'] / n, 'beyond_5_sigma': sums['beyond_5'] / n,
            'sigma_over_a_fifth': sums['sigma_over_a_fifth'] / n, 'nearer_by_10_percent': sums['nearer'] / n,
            'sigma_ratio': 1.4826 * _quantile(self._ratio[groups].sum(axis=0), 0.5),
            'nees25_by_decile': [round(float(value), 4) for value in deciles],
            'lowest_decile': float(deciles.min()), 'highest_decile': float(deciles.max()),
            'log_likelihood_gain': float(constant - sums['log_sigma'] / n - 0.5 * sums['n2'] / n),
            'stated_rms': float(np.sqrt(sums['v'] / n)),
        }
