# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""A run as plain files: the layout of the TUM RGB-D benchmark, and a point cloud as PLY."""

import os
import shutil

import cv2
import numpy as np

from . import command_line, tum

DEPTH_SCALE = 5000  # counts of a metre, as the benchmark's own images have
IMAGES = ('rgb', 'depth', 'sigma', 'provenance')
_MOST = 65535       # counts of 16 bits

POINT = np.dtype([('x', '<f4'), ('y', '<f4'), ('z', '<f4'), ('red', 'u1'), ('green', 'u1'), ('blue', 'u1'),
                  ('sigma', '<f4'), ('source', 'u1')])
_PLY_TYPES = {'f4': 'float', 'u1': 'uchar'}


class Export:
    """Writes a folder, which must not be there yet and appears when it is complete.

    @param run           runs.Run
    @param recording     recordings.Recording that has the colour images, unless the run's bag has them; or None
    @param depth_scale   counts of depth per metre
    @param point_frames  number of frames whose points go into points.ply
    @param point_step    [px] every nth pixel of every nth row becomes a point"""

    def __init__(self, run, recording, folder, depth_scale=DEPTH_SCALE, point_frames=20, point_step=4):
        self._run, self._recording, self._scale, self._step = run, recording, depth_scale, point_step
        self._folder, self._partial = folder.rstrip('/'), folder.rstrip('/') + '.partial'
        for path in (self._folder, self._partial):
            if os.path.exists(path):
                raise OSError(f'cannot write {self._folder}: {path} is there already; remove it, or choose another name')
        if recording is None and not run.has('image'):
            raise ValueError(f'{run.path} has no colour images (/fusion/image_rect), and what was fused is not known or not '
                             'there: name it with --input BAG')
        if run.K is None:
            raise ValueError(f'{run.path} has no messages of /fusion/camera_info')
        # One unit for all: poses are in tracker units, depth is in metres.
        alpha = run.alpha[np.isfinite(run.alpha)]
        self.alpha = float(np.median(alpha)) if alpha.size else 1.0
        tracked = [] if run.trajectory is None else \
            np.flatnonzero(np.isin(run.stamps, run.trajectory.stamps))
        chosen = np.linspace(0, len(tracked) - 1, min(point_frames, len(tracked))).round().astype(int)
        self._point_indices = {int(tracked[i]) for i in chosen}
        self.frames = self.points = self.too_far = 0

    def write(self):
        os.makedirs(os.path.dirname(os.path.realpath(self._folder)), exist_ok=True)
        try:
            for name in IMAGES:
                os.makedirs(os.path.join(self._partial, name))
            self._write_all()
            os.rename(self._partial, self._folder)
        except OSError as error:
            raise OSError(f'cannot write {self._folder}: {error.strerror or error}')
        finally:
            shutil.rmtree(self._partial, ignore_errors=True)

    def _path(self, *names):
        return os.path.join(self._partial, *names)

    def _write_all(self):
        lists = {name: [] for name in ('rgb', 'depth', 'associations')}
        with open(self._path('points.body'), 'wb') as body:
            for index, frame in enumerate(self._run.frames()):
                image = self._image(frame)
                if image is None:
                    continue
                stamp = tum.seconds_text(frame.stamp)
                self._write_images(stamp, frame, image)
                lists['rgb'].append(f'{stamp} rgb/{stamp}.png')
                lists['depth'].append(f'{stamp} depth/{stamp}.png')
                lists['associations'].append(f'{stamp} rgb/{stamp}.png {stamp} depth/{stamp}.png')
                if index in self._point_indices:
                    body.write(self._points(frame, image).tobytes())
                self.frames += 1
        if self.frames == 0:
            raise ValueError('there are no colour images of the frames of this run: expected the input that was fused')
        for name, lines in lists.items():
            _write_text(self._path(name + '.txt'), lines)
        width, height = self._run.size
        K = self._run.K
        _write_text(self._path('calib.txt'), [
            '# fx fy cx cy width height depth_scale, of rectified images',
            f'{K[0, 0]:.9g} {K[1, 1]:.9g} {K[0, 2]:.9g} {K[1, 2]:.9g} {width} {height} {self._scale:g}'])
        self._write_trajectory()
        self._write_ply()

    def _image(self, frame):
        if frame.image is not None:
            return frame.image
        return self._recording.colour(frame.stamp, tolerance=10**3) if self._recording else None

    def _write_images(self, stamp, frame, image):
        counts = np.rint(np.nan_to_num(frame.mean.astype(np.float64) * self._scale))
        self.too_far += int((counts > _MOST).sum())
        counts[counts > _MOST] = 0
        colour = image[..., ::-1] if image.ndim == 3 else image
        for name, values, ending in (('rgb', colour, 'png'), ('depth', counts.astype(np.uint16), 'png'),
                                     ('sigma', frame.sigma, 'tiff'), ('provenance', frame.provenance, 'png')):
            done, data = cv2.imencode('.' + ending, values)
            if not done:
                raise ValueError(f'OpenCV cannot write .{ending} files of {values.dtype}')
            with open(self._path(name, f'{stamp}.{ending}'), 'wb') as file:
                file.write(data.tobytes())

    def _points(self, frame, image):
        """In the axes of the first camera [m]."""
        every = (slice(None, None, self._step),) * 2
        known = np.isfinite(frame.mean[every])
        pose = frame.T_world_camera
        positions = frame.points(self._run.K)[every][known] @ pose[:3, :3].T + self.alpha * pose[:3, 3]
        points = np.zeros(len(positions), POINT)
        for i, name in enumerate(('x', 'y', 'z')):
            points[name] = positions[:, i]
        colours = image[every][known]
        for i, name in enumerate(('red', 'green', 'blue')):
            points[name] = colours[:, i] if colours.ndim == 2 else colours
        points['sigma'], points['source'] = frame.sigma[every][known], frame.provenance[every][known]
        self.points += len(points)
        return points

    def _write_trajectory(self):
        trajectory = self._run.trajectory
        lines = ['# timestamp tx ty tz qx qy qz qw: estimated camera-to-world poses of the optical frame, in metres '
                 f'(those of the run times its median scale, {self.alpha:.6f})']
        if trajectory is not None:
            for stamp, position, quaternion in zip(trajectory.stamps, trajectory.positions, trajectory.quaternions):
                values = [*(self.alpha * position), *quaternion]
                lines.append(' '.join([tum.seconds_text(int(stamp))] + [f'{value:.9f}' for value in values]))
        _write_text(self._path('trajectory.txt'), lines)

    def _write_ply(self):
        properties = [f'property {_PLY_TYPES[POINT[name].str[1:]]} {name}' for name in POINT.names]
        head = ['ply', 'format binary_little_endian 1.0',
                'comment metres, in the axes of the first camera; source: 1 sensor only, 2 SfM only, 3 fused, 4 completed',
                f'element vertex {self.points}', *properties, 'end_header']
        with open(self._path('points.ply'), 'wb') as file, open(self._path('points.body'), 'rb') as body:
            file.write(('\n'.join(head) + '\n').encode())
            shutil.copyfileobj(body, file)
        os.remove(self._path('points.body'))


def _write_text(path, lines):
    command_line.write(path, '\n'.join(lines) + '\n')
