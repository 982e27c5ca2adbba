# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""What a run was given: colour images and sensor depth, in the rectified camera that results are in."""

import os

import cv2
import numpy as np
import yaml

from . import bags

COLOUR, DEPTH = '/camera/rgb/image_raw', '/camera/depth_registered/image_raw'
_NEAR = 20 * 10**6  # [ns] between images that belong together


def is_rectified(topic):
    """Whether images say so by their name, as the package takes it (isRectifiedByName())."""
    for transport in ('/compressed', '/compressedDepth'):
        if topic.endswith(transport):
            topic = topic[:-len(transport)]
            break
    return '_rect_' in topic.rsplit('/', 1)[-1] + '_'


class Calibration:
    """@param K, D, P  lists as in camera_info"""

    def __init__(self, size, model, K, D, P):
        self.size = size
        K, P, self._D = np.reshape(K, (3, 3)), np.reshape(P, (3, 4))[:, :3], np.array(D, np.float64)
        self._K, self._model = K, model
        self.rectified_K = P if P[0, 0] != 0 else K
        self._maps = None

    @classmethod
    def of_message(cls, info):
        return cls((info.width, info.height), info.distortion_model, info.K, info.D, info.P)

    @classmethod
    def of_file(cls, path):
        """YAML as camera_calibration writes it."""
        with open(path) as file:
            values = yaml.safe_load(file)
        matrix = values['camera_matrix']['data']
        return cls((values['image_width'], values['image_height']), values.get('distortion_model', 'plumb_bob'),
                   matrix, values['distortion_coefficients']['data'],
                   values.get('projection_matrix', {}).get('data', [0] * 12))

    def rectified(self, image, nearest):
        """@param nearest  of depth, which must not be averaged, and is 0 where nothing was seen"""
        if image.shape[1::-1] != tuple(self.size) or (
                not self._D.any() and np.allclose(self._K, self.rectified_K)):
            return image
        if self._maps is None:
            rectify = (cv2.fisheye if self._model in ('equidistant', 'fisheye') else cv2).initUndistortRectifyMap
            self._maps = rectify(self._K, self._D, np.eye(3), self.rectified_K, tuple(self.size), cv2.CV_32FC1)
        if nearest:
            return cv2.remap(image, *self._maps, cv2.INTER_NEAREST, borderValue=0)
        return cv2.remap(image, *self._maps, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)


class Recording:
    """The bags that fuse_bag has read.

    @param paths         of the bags, one or several
    @param colour, depth topics; of compressed images with the transport's name at the end
    @param calibration   file, or topic of camera_info; None: the topic beside the colour images
    @param depth_scale   [m] per count of 16UC1 depth
    @param saturated     [m] depth of the sensor's highest code, which means none; 0: there is no such code"""

    def __init__(self, paths, colour=COLOUR, depth=DEPTH, calibration=None, depth_scale=1e-3, saturated=0.0):
        self._bags = [bags.open_bag(path) for path in paths]
        self._colour, self._depth, self._depth_scale, self._saturated = colour, depth, depth_scale, saturated
        self._finders = [bags.Finder(bag, [colour, depth]) for bag in self._bags]
        for topic in (colour, depth):
            if not any(topic in finder.topics for finder in self._finders):
                there = sorted({name for bag in self._bags for name in bag.get_type_and_topic_info().topics})
                self.close()
                raise ValueError(f'{", ".join(paths)} has no messages of {topic}; it has {", ".join(there)}')
        self.calibration = self._find_calibration(calibration)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        for bag in self._bags:
            bag.close()

    def _find_calibration(self, where):
        path = where[len('file://'):] if where and where.startswith('file://') else where
        if path and os.path.isfile(path):
            return Calibration.of_file(path)
        base = self._colour[:-len('/compressed')] if self._colour.endswith('/compressed') else self._colour
        topic = where or base.rsplit('/', 1)[0] + '/camera_info'
        for bag in self._bags:
            for _, message, _ in bag.read_messages(topics=[topic]):
                if message.K[0] != 0:
                    return Calibration.of_message(message)
        if where:
            raise ValueError(f'there is no calibration {where}: expected a file, or a topic of camera_info of the bag')
        return None

    def _nearest(self, topic, stamp, tolerance):
        for finder in self._finders:
            message = finder.nearest(topic, stamp, tolerance)
            if message is not None:
                return message
        return None

    def _rectified(self, image, nearest, topics):
        if self.calibration is None or any(is_rectified(topic) for topic in topics):
            return image
        return self.calibration.rectified(image, nearest)

    def colour(self, stamp, tolerance=_NEAR):
        """Rectified image nearest to a stamp [ns], H x W (x 3: red, green, blue); None where there is none."""
        message = self._nearest(self._colour, stamp, tolerance)
        return None if message is None else self._rectified(bags.picture(message), False, [self._colour])

    def depth(self, stamp, tolerance=_NEAR):
        """Rectified sensor depth [m], NaN = none, nearest to a stamp [ns]; None where there is none."""
        message = self._nearest(self._depth, stamp, tolerance)
        if message is None:
            return None
        depth = np.nan_to_num(bags.metres(bags.image(message), self._depth_scale))
        if self._saturated > 0:
            depth[np.abs(depth - self._saturated) < 5e-4] = 0
        depth = self._rectified(depth, True, [self._colour, self._depth])
        depth[depth == 0] = np.nan
        return depth

    def depth_of(self, run, index, frame):
        """The depth that a frame of a run was fused with [m]; None where there was none, or it is of another size."""
        stamp = run.depth_stamp(index)
        if stamp is not None:
            depth = self.depth(stamp, tolerance=10**3)
        else:  # a live run has no table that would say that there was none
            depth = None if 'skew' in run.table else self.depth(frame.stamp)
        return depth if depth is None or depth.shape == frame.mean.shape else None
