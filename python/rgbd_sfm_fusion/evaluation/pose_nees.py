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
_TURN_SIGMA = np.radians(1.0)  # of the camera in the body that motion capture tracks
_LARGE_NEES = 3.0              # / 6; motions with a larger one count less when the turn is fitted


def second_nees(fused, results, ground_truth, recorded=False):
    """Mean and median of NEES / 6 for motions over 1 s, by the bag's /tracker/frame and the trajectory. For a right
    covariance, the mean is 1 and the median 0.89.

    From one keyframe to the next, the last frame before the next keyframe gives the covariance. The scale error of the
    tracked motion is part of the error. Motion capture sees a body, and where the camera looks in it is known to a
    degree or so: the NEES is given as it is, and with that turn fitted ('second_nees_turned').
    @param recorded  the truth is motion capture, which has an error of its own, and another clock"""
    estimate = tum.Trajectory.read(os.path.join(results, 'trajectory.txt'))
    poses = {stamp: (estimate.rotations[i], estimate.positions[i]) for i, stamp in enumerate(estimate.stamps)}
    chain = [frame for frame in _frames(fused) if frame.stamp in poses]
    if not recorded:
        return _numbers('second_nees', _nees(_motions(chain, poses, ground_truth)))
    best = _at_best_offset(chain, poses, ground_truth)
    if best is None:
        return {}
    turn = camera_turn(best[1])
    turned = _at_best_offset(chain, poses, ground_truth, turn)
    return {**_numbers('second_nees', _nees(best[1])), **_numbers('second_nees_turned', _nees(turned[1])),
            'clock_offset': 1e-9 * best[0], 'truth_turn': float(np.degrees(np.linalg.norm(turn))),
            'truth_turn_axes': np.degrees(turn).tolist()}


def _at_best_offset(chain, poses, ground_truth, turn=None):
    """The offset [ns] of the truth's clock with the least median, and the motions with it; None without motions."""
    tried = [(offset, _motions(chain, poses, ground_truth, offset, turn, _TRUTH_ERROR)) for offset in _OFFSETS]
    return min((each for each in tried if each[1]), key=lambda each: np.median(_nees(each[1])), default=None)


def camera_turn(motions, steps=8):
    """The rotation vector [rad] by which the true poses' camera is turned in itself, as far as motions tell. The prior is
    _TURN_SIGMA for each axis. Motions over the same second say the same, and count as one."""
    turn = np.zeros(3)
    alike = max(1.0, np.median([motion.overlapping for motion in motions]))
    for _ in range(steps):
        information = np.eye(3) / _TURN_SIGMA**2
        gradient = information @ turn
        for motion in motions:
            error, R, t = motion.with_turn(turn)
            J = np.vstack([_cross(t) @ (np.eye(3) - R) - _cross(t), np.eye(3) - R])
            weighted = np.linalg.solve(motion.covariance, J).T
            weight = 1 / alike / max(1.0, error @ np.linalg.solve(motion.covariance, error) / 6 / _LARGE_NEES)
            information += weight * weighted @ J
            gradient += weight * weighted @ error
        turn = turn - np.linalg.solve(information, gradient)
    return turn


def _nees(motions):
    return [motion.error @ np.linalg.solve(motion.covariance, motion.error) / 6 for motion in motions]


def _numbers(name, nees):
    return {name: float(np.mean(nees)), name + '_median': float(np.median(nees))} if len(nees) else {}


class _Motion:
    """A motion over a time: the estimate and the truth as (R, t) of T_later_earlier. `error` is the left perturbation that
    leads from the true motion to the estimate, and `covariance` is its covariance.
    @param overlapping  number of motions that begin before this one ends"""

    def __init__(self, estimate, truth, covariance, overlapping, turn=None):
        self._estimate, self._truth = estimate, truth
        self.covariance, self.overlapping = covariance, overlapping
        self.error = self.with_turn(np.zeros(3) if turn is None else turn)[0]

    def with_turn(self, turn):
        """Error, and the true motion R, t, if the true poses' camera is turned by a rotation vector."""
        X = cv2.Rodrigues(np.asarray(turn, float))[0]
        R, t = X.T @ self._truth[0] @ X, X.T @ self._truth[1]
        turned = self._estimate[0] @ R.T
        return np.concatenate([self._estimate[1] - turned @ t, cv2.Rodrigues(turned)[0].ravel()]), R, t


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


def _motions(frames, poses, ground_truth, offset=0, turn=None, truth_error=None, seconds=1.0):
    """@param offset [ns] of the truth's clock
    @param turn  of the true poses' camera; None: none
    @param truth_error  σ of a true motion; None: it is exact"""
    stamps = np.array([frame.stamp for frame in frames])
    truth = interpolated(ground_truth, stamps + offset)
    true_poses = {stamp - offset: (truth.rotations[i], truth.positions[i]) for i, stamp in enumerate(truth.stamps)}
    own = np.zeros((6, 6)) if truth_error is None else np.diag(truth_error**2)
    found = []
    for i, j in enumerate(np.searchsorted(stamps, stamps + int(1e9 * seconds) - 10**7)):
        if j >= len(frames) or stamps[j] - stamps[i] > 1.1e9 * seconds:
            continue
        if any(frame.broken for frame in frames[i + 1:j + 1]):
            continue
        if stamps[i] not in true_poses or stamps[j] not in true_poses:
            continue
        found.append(_Motion(_motion(poses, stamps[i], stamps[j]), _motion(true_poses, stamps[i], stamps[j]),
                             _covariance(frames, poses, i, j) + own, j - i, turn))
    return found


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
