# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""A sequence in the layout of the TUM RGB-D benchmark: its camera, poses, and what counts as true depth."""

import os

import cv2
import numpy as np

from . import tum


class Camera:
    """Of calib.txt: fx fy cx cy width height depth_scale, and perhaps a comment `# dist k1 k2 p1 p2 k3`."""

    def __init__(self, path):
        words = tum.rows(path)
        if not words or len(words[0]) < 7:
            raise ValueError(f'{path}: expected a line of "fx fy cx cy width height depth_scale"')
        fx, fy, cx, cy, width, height, self.depth_scale = (float(word) for word in words[0][:7])
        self.K = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])
        self.size = int(width), int(height)
        self.distortion = np.zeros(5)
        with open(path) as lines:
            for line in lines:
                comment = line.lstrip('# ').split()
                if line.startswith('#') and len(comment) == 6 and comment[0] == 'dist':
                    self.distortion = np.array([float(word) for word in comment[1:]])
        self._maps = None
        if self.distortion.any():
            self._maps = cv2.initUndistortRectifyMap(self.K, self.distortion, None, self.K, self.size, cv2.CV_32FC1)

    def rectified(self, image):
        """Nearest pixels; 0 outside."""
        return cv2.remap(image, *self._maps, cv2.INTER_NEAREST, borderValue=0) if self._maps else image

    def rays(self):
        """H x W x 3: points of depth 1 behind the pixels of an image that is not rectified."""
        x, y = np.meshgrid(np.arange(self.size[0], dtype=np.float64), np.arange(self.size[1], dtype=np.float64))
        pixels = np.stack([x, y], axis=-1).reshape(-1, 1, 2)
        rays = cv2.undistortPoints(pixels, self.K, self.distortion).reshape(x.shape + (2,))
        return np.concatenate([rays, np.ones(x.shape + (1,))], axis=-1).astype(np.float32)


def open_truth(folder, recording=None):
    """A folder with the truth of a run: exact, unless its depth is what the run was given.

    @param recording  recordings.Recording that was fused; without it, only rendered truth, which has masks, is known to
                      be exact"""
    if not os.path.isfile(os.path.join(folder, 'groundtruth.txt')):
        raise ValueError(f'{folder} has no groundtruth.txt: expected a sequence in the layout of the TUM benchmark, as '
                         'render_sequence --truth writes it')
    if not all(os.path.isfile(os.path.join(folder, name)) for name in ('calib.txt', 'associations.txt')):
        return TruePoses(folder)  # an archive as it is unpacked
    sequence = Sequence(folder, folder)
    is_rendered = os.path.isdir(os.path.join(folder, 'mask'))
    sequence.exact = is_rendered or (recording is not None and not _is_recorded(sequence, recording))
    return sequence


def _is_recorded(sequence, recording, looked_at=5):
    """Whether the depth of both is the same nearly everywhere."""
    same = both = 0
    stamps = list(sequence.depth_stamp)
    for stamp in stamps[::max(1, len(stamps) // looked_at)]:
        given = recording.depth(sequence.depth_stamp[stamp], tolerance=10**6)
        if given is None:
            continue
        truth = sequence.true_depth(stamp)
        if truth.shape == given.shape:
            same += int((np.abs(truth - given) < 1e-3).sum())
            both += int((np.isfinite(truth) & np.isfinite(given)).sum())
    return both > 0 and same > 0.5 * both


class TruePoses:
    """A truth that has no depth."""

    exact = False

    def __init__(self, folder):
        self.folder = folder
        self.ground_truth = tum.Trajectory.read(os.path.join(folder, 'groundtruth.txt'))

    def __contains__(self, stamp):
        return False


class Sequence:
    """Pairs of images, true poses and true depth.

    @param truth  folder of the same layout with exact depth; without one the recorded depth is the truth, which it
                  can only be for depth that was not made from it."""

    def __init__(self, folder, truth=None, name=None):
        self.folder = os.path.realpath(folder)
        self.name = name or os.path.basename(self.folder)
        self.camera = Camera(os.path.join(folder, 'calib.txt'))
        self.ground_truth = tum.Trajectory.read(os.path.join(folder, 'groundtruth.txt'))
        self.depth_stamp = {tum.nanoseconds(row[0]): tum.nanoseconds(row[2])
                            for row in tum.rows(os.path.join(folder, 'associations.txt'))}
        self.exact = truth is not None
        self.truth = tum.DepthTruth(truth or folder)  # not rectified

    def __contains__(self, stamp):
        return stamp in self.truth

    def true_depth(self, stamp):
        """[m], NaN = none, in the rectified camera."""
        depth = self.camera.rectified(self.truth[stamp])
        depth[depth == 0] = np.nan
        return depth

    def mirror(self, stamp):
        """Pixels of a mirror; None where that is not known."""
        return self.truth.mirror(stamp) if self.exact else None

    def material(self, stamp):
        """Of each pixel (tum.DepthTruth); None where that is not known."""
        return self.truth.material(stamp) if self.exact else None

    def pose(self, stamp, tolerance=3 * 10**7):
        """Camera-to-world (R, t) nearest in time; None where there is none."""
        nearest = int(np.abs(self.ground_truth.stamps - stamp).argmin())
        if abs(int(self.ground_truth.stamps[nearest]) - stamp) > tolerance:
            return None
        return self.ground_truth.rotations[nearest], self.ground_truth.positions[nearest]
