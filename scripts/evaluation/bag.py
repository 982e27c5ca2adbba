# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Images of bags as arrays, by stamp [ns]."""

import cv2
import numpy as np
import rosbag

_TYPES = {'mono8': (np.uint8, 1), 'rgb8': (np.uint8, 3), 'bgr8': (np.uint8, 3), '16UC1': (np.uint16, 1),
          '32FC1': (np.float32, 1)}


def image(message):
    """H x W or H x W x 3 array of a sensor_msgs/Image."""
    if message.encoding not in _TYPES:
        raise ValueError(f'image has encoding "{message.encoding}", expected one of {", ".join(_TYPES)}')
    element, channels = _TYPES[message.encoding]
    order = '>' if message.is_bigendian else '<'
    row_length = message.width * channels
    data = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
    data = data[:, :row_length * np.dtype(element).itemsize].copy()
    values = data.view(np.dtype(element).newbyteorder(order)).astype(element)
    return values if channels == 1 else values.reshape(message.height, message.width, channels)


def grey(message):
    """H x W brightness of a colour or mono8 image."""
    values = image(message)
    conversions = {'rgb8': cv2.COLOR_RGB2GRAY, 'bgr8': cv2.COLOR_BGR2GRAY}
    return cv2.cvtColor(values, conversions[message.encoding]) if message.encoding in conversions else values


def metres(values):
    """Depth [m], NaN = none, of a 16UC1 or 32FC1 image."""
    depth = values.astype(np.float32)
    if values.dtype == np.uint16:
        depth /= 1000
    depth[~((depth > 0) & np.isfinite(depth))] = np.nan
    return depth


def stamp_of(message):
    return message.header.stamp.secs * 10**9 + message.header.stamp.nsecs


def stamps(bag, topic):
    """Stamps of a topic's messages, in the bag's order."""
    found = [stamp_of(message) for _, message, _ in bag.read_messages(topics=[topic])]
    if not found:
        there = ', '.join(sorted(bag.get_type_and_topic_info().topics))
        raise ValueError(f'{bag.filename} has no messages of {topic}; it has {there}')
    return found


def synchronised(bag, topics):
    """Yields (stamp, {topic: message}) as soon as a stamp's messages of all topics have been read."""
    waiting = {}
    for topic, message, _ in bag.read_messages(topics=list(topics)):
        group = waiting.setdefault(stamp_of(message), {})
        group[topic] = message
        if len(group) == len(topics):
            yield stamp_of(message), waiting.pop(stamp_of(message))


def open_bag(path):
    try:
        return rosbag.Bag(path)
    except (IOError, rosbag.ROSBagException) as error:
        raise SystemExit(f'cannot read {path}: {error}')
