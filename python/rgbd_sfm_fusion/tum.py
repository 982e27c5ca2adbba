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


def seconds_text(stamp):
    """The inverse: all nine decimals."""
    return f'{stamp // 10**9}.{stamp % 10**9:09d}'


def nearest_index(stamps, stamp):
    """Of the one nearest to `stamp` in an array of rising stamps, which must not be empty."""
    after = int(np.clip(np.searchsorted(stamps, stamp), 1, max(1, len(stamps) - 1)))
    return min((after - 1, min(after, len(stamps) - 1)), key=lambda i: abs(int(stamps[i]) - stamp))


class Trajectory:
    """Camera-to-world poses of the optical frame."""

    def __init__(self, stamps, values):
        """@param values N x 7, tx ty tz qx qy qz qw"""
        self.stamps = np.array(stamps)
        values = np.array(values, np.float64)
        self.positions = values[:, :3]
        self.quaternions = values[:, 3:]
        self.rotations = np.array([rotation_matrix(q) for q in values[:, 3:]])

    @classmethod
    def read(cls, path):
        poses = rows(path)
        if not poses or any(len(pose) != 8 for pose in poses):
            raise ValueError(f'{path}: expected lines of "timestamp tx ty tz qx qy qz qw"')
        return cls([nanoseconds(pose[0]) for pose in poses], [[float(word) for word in pose[1:]] for pose in poses])


def rotation_matrix(quaternion):
    """Of (x, y, z, w), of any length but zero."""
    x, y, z, w = np.asarray(quaternion) / np.linalg.norm(quaternion)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


class DepthTruth:
    """Depth images of a sequence by the stamp of their colour image, or one nearly the same: the stamps of a live
    camera's images are estimates."""

    _MIRROR = 5  # in the masks that render_sequence writes
    _TOLERANCE = 8 * 10**6  # [ns]

    def __init__(self, folder):
        self._folder = folder
        calibration = rows(os.path.join(folder, 'calib.txt'))[0]
        self.intrinsics = [float(word) for word in calibration[:4]]
        self._size = int(calibration[4]), int(calibration[5])
        self._scale = float(calibration[6])
        files = {nanoseconds(row[0]): os.path.join(folder, row[3])
                 for row in rows(os.path.join(folder, 'associations.txt'))}
        self.stamps = np.array(sorted(files))
        if not files:
            raise ValueError(f'{folder}/associations.txt lists no images')
        self._files = [files[stamp] for stamp in self.stamps]

    def _index(self, stamp):
        index = nearest_index(self.stamps, stamp)
        return index if abs(int(self.stamps[index]) - stamp) <= self._TOLERANCE else None

    def __contains__(self, stamp):
        return self._index(stamp) is not None

    def __getitem__(self, stamp):
        """[m], NaN = none."""
        path = self._files[self._index(stamp)]
        image = cv2.imread(path, cv2.IMREAD_UNCHANGED)
        if image is None:
            raise IOError(f'cannot read {path}')
        depth = image.astype(np.float32) / self._scale
        depth[image == 0] = np.nan
        return depth

    def material(self, stamp):
        """Material of each pixel as render_sequence writes it (--truth); None where the sequence has no masks."""
        path = os.path.join(self._folder, 'mask', os.path.basename(self._files[self._index(stamp)]))
        return cv2.imread(path, cv2.IMREAD_UNCHANGED) if os.path.exists(path) else None

    def mirror(self, stamp):
        """Pixels of a mirror, whose true depth is the glass while both senses of depth may see what it shows;
        None where the sequence has no masks."""
        material = self.material(stamp)
        return None if material is None else material == self._MIRROR

    def rays(self):
        """H x W x 3 points at depth 1 on the lines of sight of the pixels."""
        fx, fy, cx, cy = self.intrinsics
        x, y = np.meshgrid(np.arange(self._size[0]), np.arange(self._size[1]))
        return np.dstack([(x - cx) / fx, (y - cy) / fy, np.ones(x.shape)])
