# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Errors of a trajectory: Sturm et al., A Benchmark for the Evaluation of RGB-D SLAM Systems, IROS 2012."""

import numpy as np


def matches(estimate, truth, tolerance=10**7):
    """Pairs of indices of poses nearest in time [tolerance: ns]."""
    after = np.clip(np.searchsorted(truth.stamps, estimate.stamps), 1, len(truth.stamps) - 1)
    before = after - 1
    nearer_before = estimate.stamps - truth.stamps[before] <= truth.stamps[after] - estimate.stamps
    nearest = np.where(nearer_before, before, after)
    good = np.abs(truth.stamps[nearest] - estimate.stamps) <= tolerance
    return np.flatnonzero(good), nearest[good]


def align(source, target, with_scale=False):
    """Rotation R, translation t and scale s with target ≈ s R source + t (Umeyama 1991); both N x 3."""
    source_mean, target_mean = source.mean(axis=0), target.mean(axis=0)
    a, b = source - source_mean, target - target_mean
    u, singular, vt = np.linalg.svd(b.T @ a / len(a))
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
    R = u @ np.diag(signs) @ vt
    variance = (a**2).sum() / len(a)
    s = (singular * signs).sum() / variance if with_scale and variance > 0 else 1.0
    return R, target_mean - s * R @ source_mean, s


def absolute_error(estimate, truth, with_scale=False):
    """RMSE of positions after the best alignment [m], and that alignment's scale."""
    e, t = matches(estimate, truth)
    if len(e) < 3:
        raise ValueError('fewer than three poses of the trajectory have a true pose at their time')
    R, translation, s = align(estimate.positions[e], truth.positions[t], with_scale)
    residual = s * estimate.positions[e] @ R.T + translation - truth.positions[t]
    return float(np.sqrt((residual**2).sum(axis=1).mean())), s


def relative_error(estimate, truth, seconds=1.0):
    """RMSE of the motion over a time: metres and degrees; NaN where the trajectory is shorter."""
    e, t = matches(estimate, truth)
    stamps = estimate.stamps[e]
    later = np.searchsorted(stamps, stamps + int(seconds * 1e9) - 10**7)
    errors = [_motion_difference(estimate, e[i], e[j], truth, t[i], t[j])
              for i, j in enumerate(later) if j < len(e) and stamps[j] - stamps[i] < 1.1e9 * seconds]
    return _root_mean_squares(errors)


def step_error(estimate, truth, longest=0.5):
    """RMSE of the motion from each pose to the next: metres and degrees. It shows what each pose has of an error of its
    own, which over a second hides behind drift. NaN without two poses.

    @param truth    at the same stamps as the estimate: the nearest true pose would be off by its own motion
    @param longest  [s] longer steps, as after a loss, are left out"""
    errors = [_motion_difference(estimate, i, i + 1, truth, i, i + 1)
              for i in np.flatnonzero(np.diff(estimate.stamps) <= longest * 1e9)]
    return _root_mean_squares(errors)


def _root_mean_squares(errors):
    """Of metres and degrees; NaN of none."""
    if not errors:
        return float('nan'), float('nan')
    return tuple(np.sqrt((np.array(errors)**2).mean(axis=0)))


def _motion_difference(estimate, e_from, e_to, truth, t_from, t_to):
    R_e, p_e = _motion(estimate, e_from, e_to)
    R_t, p_t = _motion(truth, t_from, t_to)
    cosine = np.clip((np.trace(R_e.T @ R_t) - 1) / 2, -1, 1)
    return np.linalg.norm(p_e - p_t), np.degrees(np.arccos(cosine))


def _motion(trajectory, i, j):
    """Pose j in the camera of pose i."""
    R_i = trajectory.rotations[i]
    return R_i.T @ trajectory.rotations[j], R_i.T @ (trajectory.positions[j] - trajectory.positions[i])
