# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Sequences and trajectories in the layout of the TUM RGB-D benchmark. Stamps are integers [ns]."""

import os

import cv2
import numpy as np


def rows(path):
    """Words of each line that is neither empty nor a comment."""
    with open(path) as lines:
        return [line.split() for line in lines if line.strip() and not line.lstrip().startswith('#')]


def nanoseconds(text):
    """Exact, unlike int(float(text) * 1e9): a double holds no stamp of today to the nanosecond."""
    seconds, _, fraction = text.partition('.')
    return int(seconds) * 10**9 + int((fraction + '000000000')[:9])


class Trajectory:
    """Camera-to-world poses of the optical frame."""

    def __init__(self, path):
        poses = rows(path)
        if not poses or any(len(pose) != 8 for pose in poses):
            raise ValueError(f'{path}: expected lines of "timestamp tx ty tz qx qy qz qw"')
        self.stamps = np.array([nanoseconds(pose[0]) for pose in poses])
        values = np.array([[float(word) for word in pose[1:]] for pose in poses])
        self.positions = values[:, :3]
        self.rotations = np.array([rotation_matrix(q) for q in values[:, 3:]])


def rotation_matrix(quaternion):
    """Of (x, y, z, w), of any length but zero."""
    x, y, z, w = np.asarray(quaternion) / np.linalg.norm(quaternion)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


class DepthTruth:
    """Depth images of a sequence by the stamp of their colour image."""

    _MIRROR = 5  # in the masks that render_sequence writes

    def __init__(self, folder):
        self._folder = folder
        calibration = rows(os.path.join(folder, 'calib.txt'))[0]
        self._scale = float(calibration[6])
        self._files = {nanoseconds(row[0]): os.path.join(folder, row[3])
                       for row in rows(os.path.join(folder, 'associations.txt'))}

    def __contains__(self, stamp):
        return stamp in self._files

    def __getitem__(self, stamp):
        """[m], NaN = none."""
        image = cv2.imread(self._files[stamp], cv2.IMREAD_UNCHANGED)
        if image is None:
            raise IOError(f'cannot read {self._files[stamp]}')
        depth = image.astype(np.float32) / self._scale
        depth[image == 0] = np.nan
        return depth

    def mirror(self, stamp):
        """Pixels of a mirror, whose true depth is the glass while both senses of depth may see what it shows;
        None where the sequence has no masks."""
        name = os.path.basename(self._files[stamp])
        mask = cv2.imread(os.path.join(self._folder, 'mask', name), cv2.IMREAD_UNCHANGED)
        return None if mask is None else mask == self._MIRROR
