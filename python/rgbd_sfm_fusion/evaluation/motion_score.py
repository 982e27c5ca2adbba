# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Reads the files of a run: the trajectory against the true one, states of the frames, times of the stages."""

import csv
import json
import os
import types

import cv2
import numpy as np

from .. import bags, trajectory, tum

_WINDOWS = 5  # parts of a run, each with a scale of its own
_LONGEST_GAP = 60 * 10**6  # [ns] between two true poses with interpolation between them


def interpolated(truth, stamps):
    """The true poses at those stamps [ns] that have a true pose close before and close after."""
    after = np.searchsorted(truth.stamps, stamps).clip(1, len(truth.stamps) - 1)
    gap = truth.stamps[after] - truth.stamps[after - 1]
    inside = (stamps >= truth.stamps[0]) & (stamps <= truth.stamps[-1]) & (gap <= _LONGEST_GAP)
    stamps, after, gap = stamps[inside], after[inside], gap[inside]
    share = (stamps - truth.stamps[after - 1]) / gap
    before, step = truth.positions[after - 1], truth.positions[after] - truth.positions[after - 1]
    rotations = [_turn(truth.rotations[i - 1], truth.rotations[i], s) for i, s in zip(after, share)]
    return types.SimpleNamespace(stamps=stamps, positions=before + share[:, None] * step,
                                 rotations=np.array(rotations).reshape(-1, 3, 3))


def at_the_same_stamps(estimate, truth):
    """The estimated poses that have a true pose close before and close after, and the true poses at their stamps."""
    truth = interpolated(truth, estimate.stamps)
    there = np.isin(estimate.stamps, truth.stamps)
    return types.SimpleNamespace(stamps=estimate.stamps[there], positions=estimate.positions[there],
                                 rotations=estimate.rotations[there]), truth


def _turn(first, second, share):
    """The rotation that is a share of the way from the first rotation to the second."""
    vector, _ = cv2.Rodrigues(first.T @ second)
    return first @ cv2.Rodrigues(share * vector)[0]


def scales_over_time(estimate, truth, seconds=1.0, windows=_WINDOWS):
    """The factor from estimated to true motion over a time. The run is divided evenly into windows, each with a factor of
    its own; NaN for a window without pairs of poses. Needs no alignment, as motions are in the camera's own axes."""
    pairs = [(i, j) for i, j in enumerate(np.searchsorted(truth.stamps, truth.stamps + int(1e9 * seconds) - 10**7))
             if j < len(truth.stamps) and truth.stamps[j] - truth.stamps[i] < 1.1e9 * seconds]
    if not pairs:
        return [float('nan')] * windows
    motion = [np.array([source.rotations[i].T @ (source.positions[j] - source.positions[i]) for i, j in pairs])
              for source in (estimate, truth)]
    start = truth.stamps[[i for i, _ in pairs]]
    window = ((start - start[0]) * windows // (start[-1] - start[0] + 1)).astype(int)
    product, square = (np.bincount(window, (motion[0] * other).sum(axis=1), windows) for other in motion[::-1])
    return [float(p / s) if s > 0 else float('nan') for p, s in zip(product, square)]


def alpha_slope(stamps, alphas):
    """Slope of ln α over time [1/s], by least squares. It is the drift of a monocular tracker's unit, and needs no true
    poses. NaN without two frames with a scale.
    @param stamps  [s]"""
    stamps, alphas = np.asarray(stamps, float), np.asarray(alphas, float)
    there = np.isfinite(alphas) & (alphas > 0)
    if there.sum() < 2:
        return float('nan')
    return float(np.polyfit(stamps[there] - stamps[there][0], np.log(alphas[there]), 1)[0])


def _alpha_slope_of(results):
    with open(os.path.join(results, 'frames.csv')) as file:
        rows = list(csv.DictReader(file))
    first = tum.nanoseconds(rows[0]['stamp']) if rows else 0
    return alpha_slope([1e-9 * (tum.nanoseconds(row['stamp']) - first) for row in rows],
                       [float(row['alpha'] or 'nan') for row in rows])


def motion_score(results, ground_truth):
    """Numbers of a folder of results of fuse_bag. Lengths are in metres as tracked, and not scaled, unless the name has
    sim3."""
    with open(os.path.join(results, 'summary.json')) as file:
        summary = json.load(file)
    found = {'frames': summary['frames'], 'tracked': summary['frames_tracked'], 'lost': summary['frames_lost'],
             'keyframes': summary['keyframes']}
    for stage, values in summary['timing_ms'].items():
        found[stage + '_ms'] = values['p50']
    try:
        estimate = tum.Trajectory.read(os.path.join(results, 'trajectory.txt'))
    except ValueError:  # no frame was tracked
        return found
    estimate, truth = at_the_same_stamps(estimate, ground_truth)
    if len(estimate.stamps) < 3:
        return found
    found['ate'], _ = trajectory.absolute_error(estimate, truth)
    found['ate_sim3'], found['sim3_scale'] = trajectory.absolute_error(estimate, truth, with_scale=True)
    found['rpe'], found['rpe_degrees'] = trajectory.relative_error(estimate, truth)
    found['step'], found['step_degrees'] = trajectory.step_error(estimate, truth)
    found['alpha_slope'] = _alpha_slope_of(results)
    scales = np.array(scales_over_time(estimate, truth))
    found['scales'] = scales.tolist()
    scales = scales[np.isfinite(scales)]
    if len(scales) > 1:
        found['scale_drift'] = float(scales[-1] / scales[0] - 1)
        found['scale_spread'] = float(scales.max() / scales.min() - 1)
    return found


def relative_pose_nees(fused, ground_truth):
    """NEES of the poses relative to their keyframes, by the bag's /tracker/frame: the mean of min(NEES / 6, 25), about 1
    for a right covariance, and the median of NEES / 6, about 0.89. The error of scale is part of the error."""
    with bags.open_bag(fused) as bag:
        frames = [message for _, message, _ in bag.read_messages(topics=['/tracker/frame'])
                  if message.state == message.TRACKING and message.keyframe_stamp != message.header.stamp]
    stamps = np.array([[stamp.secs * 10**9 + stamp.nsecs for stamp in (frame.header.stamp, frame.keyframe_stamp)]
                       for frame in frames], np.int64).reshape(-1, 2)
    truth = interpolated(ground_truth, np.unique(stamps))
    found = []
    for frame, (stamp, keyframe) in zip(frames, stamps):
        if stamp in truth.stamps and keyframe in truth.stamps:
            at, reference = np.searchsorted(truth.stamps, (stamp, keyframe))
            error = _difference(frame.T_frame_keyframe, *_motion(truth, at, reference))
            covariance = np.array(frame.covariance).reshape(6, 6)
            regular = np.linalg.matrix_rank(covariance) == 6
            found.append(error @ np.linalg.solve(covariance, error) / 6 if regular else np.inf)
    if not found:
        return {}
    return {'pose_nees': float(np.minimum(found, 25).mean()), 'pose_nees_median': float(np.median(found))}


def _motion(trajectory_, at, reference):
    """Pose of the reference camera in the axes of the other camera: R, t."""
    R = trajectory_.rotations[at].T
    return R @ trajectory_.rotations[reference], R @ (trajectory_.positions[reference] - trajectory_.positions[at])


def _difference(transform, R, t):
    """x y z rx ry rz of the left perturbation that leads from R, t to a message's transform, to first order."""
    q, p = transform.rotation, transform.translation
    turned = tum.rotation_matrix([q.x, q.y, q.z, q.w]) @ R.T
    return np.concatenate([np.array([p.x, p.y, p.z]) - turned @ t, cv2.Rodrigues(turned)[0].ravel()])


def median_of_frames(results, column):
    """Median of a column of frames.csv; frames without a number do not count."""
    with open(os.path.join(results, 'frames.csv')) as file:
        values = [float(row[column]) for row in csv.DictReader(file) if row[column] not in ('', 'nan')]
    return float(np.median(values)) if values else float('nan')


def states(results):
    """Stamps [ns] and states of all frames of a run."""
    with open(os.path.join(results, 'frames.csv')) as file:
        rows = list(csv.DictReader(file))
    return np.array([tum.nanoseconds(row['stamp']) for row in rows]), [row['state'] for row in rows]
