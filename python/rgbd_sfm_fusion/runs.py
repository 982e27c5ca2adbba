# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs of fuse_bag, or recorded live, frame by frame as numpy arrays:

    from rgbd_sfm_fusion import runs

    with runs.Run('fused.bag', 'results') as run:
        for frame in run.frames(every=10):
            added = frame.provenance == runs.SFM_ONLY
            print(frame.seconds, frame.mean[added].mean(), frame.sigma[added].mean())
"""

import csv
import dataclasses
import json
import os
import typing

import numpy as np

from . import bags, tum

NONE, SENSOR_ONLY, SFM_ONLY, FUSED, COMPLETED = range(5)
SOURCES = ('none', 'sensor only', 'SfM only', 'fused', 'completed')  # by the values of provenance

_IMAGES = {'mean': '/fusion/mean', 'variance': '/fusion/variance', 'provenance': '/fusion/provenance',
           'sfm_depth': '/fusion/sfm_depth', 'sfm_variance': '/fusion/sfm_variance', 'image': '/fusion/image_rect'}
_ALWAYS = ('mean', 'variance', 'provenance')
_FRAME, _POSE, _SCALE, _CAMERA = '/tracker/frame', '/tracker/pose', '/fusion/scale', '/fusion/camera_info'
_STATES = ('initialising', 'tracking', 'lost')
_TEXT_COLUMNS = ('stamp', 'state', 'keyframe')


@dataclasses.dataclass
class Frame:
    """The results for one colour image. Images are H x W, in the pixels of the rectified colour camera. An image that
    the bag does not hold is None."""
    stamp: int                                 # [ns]
    seconds: float                             # since the first frame
    state: str                                 # initialising, tracking or lost
    alpha: float                               # from tracker units to metres; NaN: not known
    mean: np.ndarray                           # [m], NaN = none
    variance: np.ndarray                       # [m²]
    provenance: np.ndarray                     # 0 none, 1 sensor only, 2 SfM only, 3 fused, 4 completed
    sfm_depth: typing.Optional[np.ndarray]     # [m], before fusion
    sfm_variance: typing.Optional[np.ndarray]  # [m²]
    image: typing.Optional[np.ndarray]         # H x W x 3 (red, green, blue), or H x W
    T_world_camera: typing.Optional[np.ndarray]  # 4 x 4, in tracker units; world: the first camera. None: not tracked

    @property
    def sigma(self):
        """Standard deviation [m]."""
        return np.sqrt(self.variance)

    def points(self, K):
        """H x W x 3 [m], in the camera's frame. @param K  of the run"""
        y, x = np.indices(self.mean.shape, np.float32)
        return np.dstack([(x - K[0, 2]) / K[0, 0] * self.mean, (y - K[1, 2]) / K[1, 1] * self.mean, self.mean])


class Run:
    """An output bag of fuse_bag, or a recorded live run, and its folder of results.

    @param path     the bag, or the folder of results: the other one is looked for beside it
    @param results  the folder of results, if it is elsewhere

    stamps   [ns] of all frames
    table    {column of frames.csv: array}; empty without the folder
    timing   likewise, of timing.csv
    summary  summary.json; empty without the folder
    alpha    from tracker units to metres, of all frames; NaN: not known
    K, size  of the rectified camera; size is (width, height), K None where the bag does not say it"""

    def __init__(self, path, results=None):
        self.path, self.results = _bag_and_results(path, results)
        self._bag = bags.open_bag(self.path)
        try:
            self._read()
        except Exception:
            self._bag.close()
            raise

    def _read(self):
        self._finder = bags.Finder(self._bag, _IMAGES.values())
        for name in _ALWAYS:
            if _IMAGES[name] not in self._finder.topics:
                there = ', '.join(sorted(self._bag.get_type_and_topic_info().topics)) or 'nothing'
                raise ValueError(f'{self.path} has no messages of {_IMAGES[name]}: expected the output bag of '
                                 f'fuse_bag, or a recorded live run; it has {there}')
        self.table, self.timing, self.summary = {}, {}, {}
        if self.results:
            self._read_results()
        else:
            self._find_frames()
        mean, camera = self._first(_IMAGES['mean']), self._first(_CAMERA)
        self.size = mean.width, mean.height
        self.K = None if camera is None else np.reshape(camera.P, (3, 4))[:, :3]
        self.trajectory = self._read_trajectory()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._bag.close()

    def __len__(self):
        return len(self.stamps)

    @property
    def name(self):
        return os.path.splitext(os.path.basename(self.path))[0]

    @property
    def settings(self):
        return self.summary.get('settings', {})

    def has(self, image):
        """Whether the bag holds one of the images of Frame."""
        return _IMAGES[image] in self._finder.topics

    def seconds(self, stamps=None):
        return 1e-9 * ((self.stamps if stamps is None else np.asarray(stamps)) - self.stamps[0])

    def depth_stamp(self, index):
        """[ns] of the sensor depth that belongs to a frame; None where there is none, or it is not known."""
        skew = self.table['skew'][index] if 'skew' in self.table else np.nan
        return None if np.isnan(skew) else int(self.stamps[index]) + round(1e9 * skew)

    def frames(self, every=1):
        """Yields every nth Frame, and reads only those. A live recording may lack some."""
        wanted = range(0, len(self), every)
        if every > 10:
            for index in wanted:
                messages = self._finder.at(int(self.stamps[index]))
                if not self._missing(messages):
                    yield self._make(index, messages)
            return
        by_stamp = {int(self.stamps[index]): index for index in wanted}
        for stamp, messages in bags.synchronised(self._bag, self._finder.topics):
            if stamp in by_stamp:
                yield self._make(by_stamp[stamp], messages)

    def frame(self, index):
        messages = self._finder.at(int(self.stamps[index]))
        missing = self._missing(messages)
        if missing:
            raise ValueError(f'{self.path} has no {missing[0]} with the stamp '
                             f'{tum.seconds_text(int(self.stamps[index]))}: it is damaged, or not of these results')
        return self._make(index, messages)

    @staticmethod
    def _missing(messages):
        return [_IMAGES[name] for name in _ALWAYS if _IMAGES[name] not in messages]

    def _make(self, index, messages):
        images = {name: messages.get(topic) for name, topic in _IMAGES.items()}
        images = {name: None if message is None else bags.image(message) for name, message in images.items()}
        stamp = int(self.stamps[index])
        return Frame(stamp=stamp, seconds=1e-9 * (stamp - int(self.stamps[0])), state=self.states[index],
                     alpha=float(self.alpha[index]), T_world_camera=self._pose(stamp), **images)

    def _pose(self, stamp):
        if self.trajectory is None:
            return None
        at = np.searchsorted(self.trajectory.stamps, stamp)
        if at == len(self.trajectory.stamps) or self.trajectory.stamps[at] != stamp:
            return None
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = self.trajectory.rotations[at], self.trajectory.positions[at]
        return pose

    def _first(self, topic):
        return next((message for _, message, _ in self._bag.read_messages(topics=[topic])), None)

    def _read_results(self):
        with open(os.path.join(self.results, 'summary.json')) as file:
            self.summary = json.load(file)
        self.table = _read_table(os.path.join(self.results, 'frames.csv'))
        self.timing = _read_table(os.path.join(self.results, 'timing.csv'))
        self.stamps, self.states, self.alpha = self.table['stamp'], list(self.table['state']), self.table['alpha']
        count = self._bag.get_message_count(_IMAGES['mean'])
        if count != len(self.stamps):
            raise ValueError(f'{self.results} is of {len(self.stamps)} frames, but {self.path} has {count}: expected the '
                             'results that were written with the bag')

    def _find_frames(self):
        """From what every frame has in the bag, a live recording's, too. A recording may lack parts of some frames, those
        that it ends with for instance: only whole ones count."""
        scales = [message for _, message, _ in self._bag.read_messages(topics=[_SCALE])]
        if not scales:
            raise ValueError(f'found no results of {self.path} beside it (a folder with summary.json), nor messages of '
                             f'{_SCALE} in it: name the folder that fuse_bag wrote with --results DIR')
        states = {bags.stamp_of(message): _STATES[message.state]
                  for _, message, _ in self._bag.read_messages(topics=[_FRAME])}
        whole = self._finder.stamps_of_all([_IMAGES[name] for name in _ALWAYS])
        scales = [message for message in scales if bags.stamp_of(message) in whole]
        if not scales:
            raise ValueError(f'{self.path} has no frame with all of ' + ', '.join(_IMAGES[name] for name in _ALWAYS))
        self.stamps = np.array([bags.stamp_of(message) for message in scales], np.int64)
        self.states = [states.get(int(stamp), 'lost') for stamp in self.stamps]
        self.alpha = np.array([message.scale for message in scales])

    def _read_trajectory(self):
        """None where no frame was tracked. Of the bag's poses in `odom`, the axes are the robot's."""
        if self.results:
            path = os.path.join(self.results, 'trajectory.txt')
            return tum.Trajectory.read(path) if tum.rows(path) else None
        poses = [(bags.stamp_of(message), message.pose) for _, message, _ in self._bag.read_messages(topics=[_POSE])]
        return tum.Trajectory([stamp for stamp, _ in poses],
                              [[p.position.x, p.position.y, p.position.z,
                                p.orientation.x, p.orientation.y, p.orientation.z, p.orientation.w]
                               for _, p in poses]) if poses else None


def _read_table(path):
    with open(path) as file:
        rows = list(csv.DictReader(file))
    if not rows:
        raise ValueError(f'{path} has no rows: expected one for each frame')
    table = {}
    for column in rows[0]:
        values = [row[column] for row in rows]
        if column == 'stamp':
            table[column] = np.array([tum.nanoseconds(value) for value in values], np.int64)
        elif column in _TEXT_COLUMNS:
            table[column] = np.array(values)
        else:
            table[column] = np.array([float(value) if value else np.nan for value in values])
    return table


def is_results(folder):
    return os.path.isfile(os.path.join(folder, 'summary.json'))


def _bag_and_results(path, results):
    """The bag, and the folder or None. Where one is not named, it is the only one beside the other."""
    path = os.path.expanduser(path)
    if results is not None:
        results = os.path.expanduser(results)
        if not is_results(results):
            raise ValueError(f'{results} has no summary.json: expected the folder that fuse_bag --results named')
    if not os.path.isdir(path):
        return path, results or results_beside(path)
    if not is_results(path):
        raise ValueError(f'{path} has no summary.json: expected the folder that fuse_bag --results named, or its bag')
    found = _bags_in(path) or [bag for bag in _bags_in(os.path.dirname(os.path.realpath(path)))
                               if results_beside(bag) and os.path.samefile(results_beside(bag), path)]
    if len(found) != 1:
        raise ValueError(f'found {len(found)} bags that may be of the results in {path}: name the bag, too')
    return found[0], path


def results_beside(path):
    """NAME, NAME.results, NAME_results, results, or the bag's own folder."""
    folder, stem = os.path.dirname(path), os.path.splitext(os.path.basename(path))[0]
    stem = stem[:-len('.fused')] if stem.endswith('.fused') else stem
    for name in (stem, stem + '.results', stem + '_results', 'results', ''):
        if is_results(os.path.join(folder, name)):
            return os.path.join(folder, name) or '.'
    return None


def _bags_in(folder):
    """Those that fuse_bag may have written."""
    found = []
    for name in sorted(os.listdir(folder)):
        if name.endswith('.bag'):
            with bags.open_bag(os.path.join(folder, name)) as bag:
                if _IMAGES['provenance'] in bag.get_type_and_topic_info().topics:
                    found.append(os.path.join(folder, name))
    return found
