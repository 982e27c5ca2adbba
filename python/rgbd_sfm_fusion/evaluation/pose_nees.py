# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tests whether the covariances of poses are honest: compares motions over a time with true motions, by the stated
covariance."""

import os
import types

import cv2
import numpy as np

from .. import bags, tum
from .motion_score import interpolated

_TRUTH_ERROR = np.array([0.002] * 3 + [np.radians(0.2)] * 3)  # [m, rad] σ of a motion that motion capture measures
_OFFSETS = np.arange(-40, 41, 4) * 10**6                      # [ns] offsets of the truth's clock that are tried


def second_nees(fused, results, ground_truth, recorded=False):
    """Mean and median of NEES / 6 for motions over 1 s, by the bag's /tracker/frame and the trajectory. For a right
    covariance, the mean is 1 and the median 0.89.

    From one keyframe to the next, the last frame before the next keyframe gives the covariance. The scale error of the
    tracked motion is part of the error.
    @param recorded  the truth is motion capture, which has an error of its own, and another clock"""
    estimate = tum.Trajectory.read(os.path.join(results, 'trajectory.txt'))
    poses = {stamp: (estimate.rotations[i], estimate.positions[i]) for i, stamp in enumerate(estimate.stamps)}
    chain = [frame for frame in _frames(fused) if frame.stamp in poses]
    best = {}
    for offset in _OFFSETS if recorded else [0]:
        found = _nees(chain, poses, ground_truth, offset, recorded)
        if len(found) > 0 and (not best or np.median(found) < best['second_nees_median']):
            best = {'second_nees': float(np.mean(found)), 'second_nees_median': float(np.median(found)),
                    'clock_offset': 1e-9 * offset}
    return best


def _frames(fused):
    """The tracked frames of a bag, oldest first. `broken`: the frame's pose does not continue the pose before."""
    found, broken = [], True
    with bags.open_bag(fused) as bag:
        for _, message, _ in bag.read_messages(topics=['/tracker/frame']):
            if message.state != message.TRACKING:
                broken = True
                continue
            stamp, keyframe = (s.secs * 10**9 + s.nsecs for s in (message.header.stamp, message.keyframe_stamp))
            found.append(types.SimpleNamespace(stamp=stamp, keyframe=keyframe, broken=broken or message.relocalised,
                                               covariance=np.array(message.covariance).reshape(6, 6)))
            broken = False
    return found


def _nees(frames, poses, ground_truth, offset, recorded, seconds=1.0):
    stamps = np.array([frame.stamp for frame in frames])
    truth = interpolated(ground_truth, stamps + offset)
    true_poses = {stamp - offset: (truth.rotations[i], truth.positions[i]) for i, stamp in enumerate(truth.stamps)}
    own = np.diag(_TRUTH_ERROR**2) if recorded else np.zeros((6, 6))
    found = []
    for i, j in enumerate(np.searchsorted(stamps, stamps + int(1e9 * seconds) - 10**7)):
        if j >= len(frames) or stamps[j] - stamps[i] > 1.1e9 * seconds:
            continue
        if any(frame.broken for frame in frames[i + 1:j + 1]):
            continue
        if stamps[i] not in true_poses or stamps[j] not in true_poses:
            continue
        R, t = _motion(poses, stamps[i], stamps[j])
        R_true, t_true = _motion(true_poses, stamps[i], stamps[j])
        turned = R @ R_true.T
        error = np.concatenate([t - turned @ t_true, cv2.Rodrigues(turned)[0].ravel()])
        covariance = _covariance(frames, poses, i, j) + own
        found.append(error @ np.linalg.solve(covariance, error) / 6)
    return np.array(found)


def _motion(poses, first, last):
    """T_last_first: R, t."""
    R = poses[last][0].T
    return R @ poses[first][0], R @ (poses[first][1] - poses[last][1])


def _covariance(frames, poses, i, j):
    """Covariance of T_j_i, through the keyframes between i and j: left perturbation, axes of frame j."""
    links = [i] + [k - 1 for k in range(i + 1, j + 1) if frames[k].keyframe != frames[k - 1].keyframe and k - 1 > i]
    total = frames[j].covariance.copy()
    for k in links:
        if frames[k].keyframe == frames[k].stamp:
            continue
        R, t = _motion(poses, frames[k].stamp, frames[j].stamp)
        adjoint = np.block([[R, _cross(t) @ R], [np.zeros((3, 3)), R]])
        total += adjoint @ frames[k].covariance @ adjoint.T
    return total


def _cross(t):
    return np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]])
