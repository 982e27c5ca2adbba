# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Images of bags as arrays, by stamp [ns]."""

import struct

import cv2
import genpy
import numpy as np
import rosbag

_TYPES = {'mono8': (np.uint8, 1), 'rgb8': (np.uint8, 3), 'bgr8': (np.uint8, 3), '16UC1': (np.uint16, 1),
          '32FC1': (np.float32, 1), 'mono16': (np.uint16, 1), '8UC1': (np.uint8, 1), '8UC3': (np.uint8, 3),
          'rgba8': (np.uint8, 4), 'bgra8': (np.uint8, 4), 'yuv422': (np.uint8, 2), 'yuv422_yuy2': (np.uint8, 2),
          'bayer_rggb8': (np.uint8, 1), 'bayer_bggr8': (np.uint8, 1), 'bayer_gbrg8': (np.uint8, 1),
          'bayer_grbg8': (np.uint8, 1)}

_TO_RGB = {'bgr8': cv2.COLOR_BGR2RGB, '8UC3': cv2.COLOR_BGR2RGB, 'rgba8': cv2.COLOR_RGBA2RGB,
           'bgra8': cv2.COLOR_BGRA2RGB, 'yuv422': cv2.COLOR_YUV2RGB_UYVY, 'yuv422_yuy2': cv2.COLOR_YUV2RGB_YUY2,
           'bayer_rggb8': cv2.COLOR_BayerBG2RGB, 'bayer_bggr8': cv2.COLOR_BayerRG2RGB,
           'bayer_gbrg8': cv2.COLOR_BayerGR2RGB, 'bayer_grbg8': cv2.COLOR_BayerGB2RGB}

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


def picture(message):
    """H x W x 3 (red, green, blue) of a colour image, H x W of a grey one; 8 bits."""
    values = image(message)
    if _is_compressed(message):
        return cv2.cvtColor(values, cv2.COLOR_BGR2RGB) if values.ndim == 3 else values
    if values.dtype == np.uint16:
        values = (values >> 8).astype(np.uint8)
    return cv2.cvtColor(values, _TO_RGB[message.encoding]) if message.encoding in _TO_RGB else values


def metres(values, scale=1e-3):
    """Depth [m], NaN = none, of a 32FC1 image, or a 16UC1 image whose counts are `scale` [m]."""
    depth = (values * (scale if values.dtype == np.uint16 else 1.0)).astype(np.float32)
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
        raise IOError(f'cannot read {path}: {error}')


class Finder:
    """Finds messages by their stamps, without reading those between: a bag's index is by the time of recording, which
    is the stamp plus some lag."""

    _WINDOWS = (0, 10**8, 3 * 10**9)  # [ns] around the expected time

    def __init__(self, bag, topics):
        """@param topics  those that the bag lacks are left out"""
        self._bag = bag
        there = bag.get_type_and_topic_info().topics
        self.topics = [topic for topic in topics if topic in there and there[topic].message_count]
        self._lag = {topic: self._first_lag(topic) for topic in self.topics}
        self._times = {}  # {topic: {stamp: time of recording}}, once they were read

    def stamps_of_all(self, topics):
        """The stamps [ns] with which each of the topics has a message. All messages are read once, and found afterwards
        however late they were recorded: many seconds on a busy machine."""
        self._times = {topic: {} for topic in self.topics}
        for topic, raw, time in self._bag.read_messages(topics=self.topics, raw=True):
            self._times[topic][_raw_stamp(raw)] = time.to_nsec()
        return set.intersection(*(set(self._times[topic]) for topic in topics))

    def _first_lag(self, topic):
        _, raw, time = next(self._bag.read_messages(topics=[topic], raw=True))
        return time.to_nsec() - _raw_stamp(raw)

    def _around(self, topic, stamp, window):
        """Yields (stamp, message as it is in the bag) of what was recorded near the expected time."""
        expected = self._times.get(topic, {}).get(stamp, stamp + self._lag[topic])
        times = (genpy.Time(0, max(0, expected + side)) for side in (-window, window))
        for _, raw, _ in self._bag.read_messages([topic], *times, raw=True):
            yield _raw_stamp(raw), raw

    def nearest(self, topic, stamp, tolerance=0):
        """The message with the stamp nearest to `stamp` [ns]; None where there is none within the tolerance."""
        if topic not in self._lag:
            return None
        for window in self._WINDOWS:
            if window < tolerance:
                continue
            found = min(self._around(topic, stamp, window), key=lambda each: abs(each[0] - stamp), default=None)
            if found and abs(found[0] - stamp) <= tolerance:
                return _from_raw(found[1])
        return None

    def at(self, stamp):
        """{topic: message} of those that have the stamp."""
        found = {topic: self.nearest(topic, stamp) for topic in self.topics}
        return {topic: message for topic, message in found.items() if message is not None}


def _raw_stamp(raw):
    """Of the header that a message begins with."""
    seconds, nanoseconds = struct.unpack_from('<II', raw[1], 4)
    return seconds * 10**9 + nanoseconds


def _from_raw(raw):
    message = raw[4]()
    message.deserialize(raw[1])
    return message
