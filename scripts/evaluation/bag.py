# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Images of bags as arrays, by stamp [ns]."""

import cv2
import numpy as np
import rosbag

_TYPES = {'mono8': (np.uint8, 1), 'rgb8': (np.uint8, 3), 'bgr8': (np.uint8, 3), '16UC1': (np.uint16, 1),
          '32FC1': (np.float32, 1), 'mono16': (np.uint16, 1), '8UC1': (np.uint8, 1), '8UC3': (np.uint8, 3),
          'rgba8': (np.uint8, 4), 'bgra8': (np.uint8, 4), 'yuv422': (np.uint8, 2), 'yuv422_yuy2': (np.uint8, 2),
          'bayer_rggb8': (np.uint8, 1), 'bayer_bggr8': (np.uint8, 1), 'bayer_gbrg8': (np.uint8, 1),
          'bayer_grbg8': (np.uint8, 1)}

_TO_GREY = {'rgb8': cv2.COLOR_RGB2GRAY, 'bgr8': cv2.COLOR_BGR2GRAY, '8UC3': cv2.COLOR_BGR2GRAY,
            'rgba8': cv2.COLOR_RGBA2GRAY, 'bgra8': cv2.COLOR_BGRA2GRAY, 'yuv422': cv2.COLOR_YUV2GRAY_UYVY,
            'yuv422_yuy2': cv2.COLOR_YUV2GRAY_YUY2, 'bayer_rggb8': cv2.COLOR_BayerBG2GRAY,
            'bayer_bggr8': cv2.COLOR_BayerRG2GRAY, 'bayer_gbrg8': cv2.COLOR_BayerGR2GRAY,
            'bayer_grbg8': cv2.COLOR_BayerGB2GRAY}


def _is_compressed(message):
    return hasattr(message, 'format')


def _decoded(message):
    """H x W or H x W x 3 (blue, green, red) array of a sensor_msgs/CompressedImage; RVL is not read here."""
    is_depth = 'compressedDepth' in message.format
    data = message.data[12:] if is_depth else message.data
    values = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    if values is None:
        raise ValueError(f'image of format "{message.format}" is neither JPEG nor PNG')
    if not message.format.startswith('32FC1'):
        return values
    a, b = np.frombuffer(message.data[4:12], '<f4')
    with np.errstate(divide='ignore'):
        return np.where(values > 0, a / (values.astype(np.float32) - b), np.nan).astype(np.float32)


def image(message):
    """H x W or H x W x channels array of a sensor_msgs/Image or CompressedImage."""
    if _is_compressed(message):
        return _decoded(message)
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
    """H x W brightness of a colour or grey image."""
    values = image(message)
    if _is_compressed(message):
        return cv2.cvtColor(values, cv2.COLOR_BGR2GRAY) if values.ndim == 3 else values
    return cv2.cvtColor(values, _TO_GREY[message.encoding]) if message.encoding in _TO_GREY else values


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
