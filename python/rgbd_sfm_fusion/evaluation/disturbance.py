# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Copies of input bags in which something is missing or false.

A region that is fixed in the world is placed by the true poses, in the axes of the camera of the first depth image. So
the same surface is missing or false in every image, the first included. If depth were missing in a region of the image
instead, a moving camera would soon see it again."""

import os

import numpy as np

from .. import bags
from ..recordings import COLOUR, DEPTH


class Frame:
    """Facts about an image for the function that disturbs it."""

    def __init__(self, index, seconds, world):
        self.index = index      # number of the depth image, from 0
        self.seconds = seconds  # time since the first image of the bag
        self._world = world

    def points(self, depth):
        """H x W x 3 [m] in the axes of the first camera; None where the true pose is not known."""
        if self._world is None:
            return None
        rays, R, t = self._world
        return (rays * (1e-3 * depth.astype(np.float32))[..., None]) @ R.T + t


class Nothing:
    """Leaves images as recorded. Derived classes override what they change. Depth is uint16 [mm], 0 = none, and may be
    written to."""
    name = 'plain'

    def depth(self, depth, frame):
        return depth

    def darkens(self, frame):
        return False


class Beyond(Nothing):
    """No depth of the world beyond a plane: z > distance [m]."""

    def __init__(self, distance):
        self._distance = distance
        self.name = f'beyond_{distance:g}'

    def depth(self, depth, frame):
        points = frame.points(depth)
        depth[slice(None) if points is None else points[..., 2] > self._distance] = 0
        return depth


class Box(Nothing):
    """No depth of the world inside a box (x0, x1, y0, y1, z0, z1 [m]). With a factor: false depth inside the box, from
    the second depth image on."""

    def __init__(self, box, factor=None):
        self._low, self._high = (np.array(box[start::2], np.float32) for start in (0, 1))
        self._factor = factor
        self.name = 'box_' + '_'.join(f'{value:g}' for value in box) + ('' if factor is None else f'_times_{factor:g}')

    def depth(self, depth, frame):
        points = frame.points(depth)
        if points is None:
            depth[:] = 0
        elif self._factor is None:
            depth[self.contains(points)] = 0
        elif frame.index > 0:
            inside = self.contains(points) & (depth > 0)
            depth[inside] = np.minimum(np.rint(depth[inside] * self._factor), 65535).astype(np.uint16)
        return depth

    def contains(self, points):
        return ((points >= self._low) & (points <= self._high)).all(axis=-1)


class RightHalf(Nothing):
    """No depth in the right half of every image."""
    name = 'right_half'

    def depth(self, depth, frame):
        depth[:, depth.shape[1] // 2:] = 0
        return depth


class FalseBlock(Nothing):
    """A square in the middle of the image is too near, as a mirror's depth might be."""

    def __init__(self, size=60, nearer=0.5):
        self._size, self._nearer = size, int(round(1000 * nearer))  # [px], [mm]
        self.name = f'false_block_{size}_{nearer:g}'

    def depth(self, depth, frame):
        top, left = ((length - self._size) // 2 for length in depth.shape)
        block = depth[top:top + self._size, left:left + self._size]
        block[block > self._nearer + 300] -= self._nearer  # depth stays if it would become nearer than a sensor sees
        return depth


class ShallowOverlap(Nothing):
    """A sensor that sees only between two depths [m], where all its depths share an error: the disparity [1/m] is off by
    an offset, the scale by a factor."""

    def __init__(self, nearest, farthest, offset, factor):
        self._nearest, self._farthest, self._offset, self._factor = nearest, farthest, offset, factor
        self.name = f'shallow_{nearest:g}_{farthest:g}_{offset:g}_{factor:g}'

    def depth(self, depth, frame):
        with np.errstate(divide='ignore'):
            metres = self._factor / (1000.0 / depth + self._offset)
        seen = (depth > 0) & (metres >= self._nearest) & (metres <= self._farthest)
        return np.where(seen, np.rint(1000 * metres), 0).astype(np.uint16)


class Black(Nothing):
    """Black images and no depth for a time."""

    def __init__(self, start=5.0, duration=1.0):
        self.start, self.duration = start, duration  # [s]
        self.name = f'black_{start:g}_{duration:g}'

    def darkens(self, frame):
        return self.start <= frame.seconds < self.start + self.duration

    def depth(self, depth, frame):
        if self.darkens(frame):
            depth[:] = 0
        return depth


class NoDepth(Nothing):
    """Images only: depth images are there, but empty."""
    name = 'no_depth'

    def depth(self, depth, frame):
        depth[:] = 0
        return depth


def disturb(source, target, disturbance, sequence):
    """Writes a disturbed copy of the bag of a sequence. The copy appears under its name when complete.
    @return share of the pixels whose depth was changed"""
    rays = sequence.camera.rays()
    T_world_first, start, index, changed, pixels = None, None, 0, 0, 0
    partial = f'{target}.{os.getpid()}'
    with bags.open_bag(source) as recorded, bags.rosbag.Bag(partial, 'w') as copy:
        for topic, message, time in recorded.read_messages():
            if topic not in (COLOUR, DEPTH):
                copy.write(topic, message, time)
                continue
            stamp = bags.stamp_of(message)
            start = stamp if start is None else start
            world = None
            if topic == DEPTH:
                T_world_camera = sequence.pose(stamp)
                T_world_first = T_world_first or T_world_camera
                world = T_world_camera and (rays,) + _relative(T_world_first, T_world_camera)
            frame = Frame(index, 1e-9 * (stamp - start), world)
            if topic == DEPTH:
                depth = _millimetres(message)
                edited = disturbance.depth(depth.copy(), frame)
                changed += np.count_nonzero(edited != depth)
                pixels += depth.size
                index += 1
                message.data = edited.tobytes()
            elif disturbance.darkens(frame):
                message.data = bytes(len(message.data))
            copy.write(topic, message, time)
    os.rename(partial, target)
    return changed / max(1, pixels)


def _millimetres(message):
    depth = bags.image(message)
    if depth.dtype != np.uint16 or message.is_bigendian or message.step != 2 * message.width:
        raise ValueError(f'depth has encoding "{message.encoding}", expected 16UC1 without padding')
    return depth


def _relative(T_world_first, T_world_camera):
    """T_first_camera, in single precision."""
    (R_first, t_first), (R, t) = T_world_first, T_world_camera
    return (R_first.T @ R).astype(np.float32), (R_first.T @ (t - t_first)).astype(np.float32)


def first_points(path, sequence):
    """N x 3: the points that the first depth image of a bag shows, in the axes of this image's camera [m]."""
    with bags.open_bag(path) as bag:
        for _, message, _ in bag.read_messages(topics=[DEPTH]):
            depth = _millimetres(message)
            identity = np.eye(3, dtype=np.float32), np.zeros(3, np.float32)
            return Frame(0, 0.0, (sequence.camera.rays(),) + identity).points(depth)[depth > 0]
    raise ValueError(f'{path} has no images of {DEPTH}')


def default_plane(points):
    """[m] Distance of a plane: a quarter of the points is beyond."""
    return round(float(np.percentile(points[:, 2], 75)), 2)


def default_box(points):
    """A box with about a quarter of the points inside."""
    low, high = np.percentile(points, [25, 75], axis=0)
    (x0, y0, _), (x1, y1, _) = low, high
    return [round(float(value), 2) for value in (x0, x1, y0, y1, 0.0, points[:, 2].max() + 1)]
