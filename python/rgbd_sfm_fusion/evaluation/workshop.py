# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Makes the inputs of an evaluation: sequences and input bags are kept, runs are removed once measured."""

import contextlib
import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile

import rosbag

from . import disturbance
from .. import bags, tum
from ..sequence import Sequence

TOPICS = ('/fusion/sfm_depth', '/fusion/sfm_variance', '/fusion/disagreement')


def say(text):
    print(text, file=sys.stderr, flush=True)


class TemporaryRun:
    """A run of fuse_bag, kept while it is measured: its input bag, output bag, folder of results, and settings."""

    def __init__(self, given, folder):
        self.given, self.fused = given, os.path.join(folder, 'fused.bag')
        self.results = os.path.join(folder, 'results')

    @property
    def bags(self):
        return self.given, self.fused

    def settings(self):
        with open(os.path.join(self.results, 'summary.json')) as file:
            return json.load(file)['settings']


class Workshop:
    """@param source  the package
    @param tools   folder of fuse_bag, tum_to_bag and render_sequence
    @param inputs  folder for sequences and bags, which are kept
    @param count   frames of each rendered sequence; None: one pass of its trajectory
    @param depth_scale_sigma  spread of the rendered sensors' scale over seeds; None: render_sequence's
    @param rendering  further options of render_sequence, {name: value}"""

    def __init__(self, source, tools, inputs, count=None, depth_scale_sigma=None, rendering=None):
        self._tools, self._inputs = tools, os.path.realpath(inputs)
        self._rendered, self._rendering = f'rendered-{_scene_version(source)}', []
        if count is not None:
            self._rendered += f'-{count}'
            self._rendering += ['--count', str(count)]
        if depth_scale_sigma is not None:
            self._rendered += f'-scale-{depth_scale_sigma:g}'
            self._rendering += ['--depth-scale-sigma', f'{depth_scale_sigma:g}']
        for name, value in (rendering or {}).items():
            self._rendered += f'-{name}-{value:g}'
            self._rendering += [f'--{name}', f'{value:g}']
        os.makedirs(self._inputs, exist_ok=True)

    def rendered(self, seed, every=1):
        """The built-in scene with its exact truth. At a reduced rate: every Nth pair of images."""
        if every != 1:
            return self._thinned_rendering(seed, every)
        folder = os.path.join(self._inputs, self._rendered, f'seed-{seed}')
        if not os.path.exists(folder):
            say(f'rendering seed {seed}')
            with self._partial(folder) as partial:
                where = [os.path.join(partial, name) for name in ('sequence', 'truth')]
                self._call('render_sequence', where[0], '--truth', where[1], '--seed', str(seed),
                           *self._rendering)
                self._call('tum_to_bag', where[0], os.path.join(partial, 'plain.bag'))
                for images in ('rgb', 'depth'):  # the images are in the bag
                    shutil.rmtree(os.path.join(where[0], images))
        return Sequence(os.path.join(folder, 'sequence'), os.path.join(folder, 'truth'), name=f'seed {seed}')

    def _thinned_rendering(self, seed, every):
        """Thins the bag, as the images are nowhere else."""
        full = os.path.dirname(self.rendered(seed).folder)
        folder = os.path.join(self._inputs, f'{self._rendered}-every-{every}', f'seed-{seed}')
        if not os.path.exists(folder):
            with self._partial(folder) as partial:
                os.symlink(os.path.join(full, 'truth'), os.path.join(partial, 'truth'))
                sequence = os.path.join(partial, 'sequence')
                os.mkdir(sequence)
                _thin_associations(os.path.join(full, 'sequence'), sequence, every)
                kept = {tum.nanoseconds(stamp) for row in tum.rows(os.path.join(sequence, 'associations.txt'))
                        for stamp in (row[0], row[2])}
                with bags.open_bag(os.path.join(full, 'plain.bag')) as source, \
                        rosbag.Bag(os.path.join(partial, 'plain.bag'), 'w') as target:
                    for topic, message, time in source.read_messages():
                        if message.header.stamp.to_nsec() in kept:
                            target.write(topic, message, time)
        return Sequence(os.path.join(folder, 'sequence'), os.path.join(folder, 'truth'),
                        name=f'seed {seed} every {every}')

    def thinned(self, folder, every):
        """A recorded sequence at a reduced rate: every Nth line of its associations."""
        if every == 1:
            return Sequence(folder)
        source = os.path.realpath(folder)
        target = os.path.join(self._inputs, f'{os.path.basename(source)}-{_digest(source)}-every-{every}', 'sequence')
        if not os.path.exists(target):
            with self._partial(target) as partial:
                _thin_associations(source, partial, every)
        return Sequence(target, name=f'{os.path.basename(source)} every {every}')

    def bag(self, sequence, change=None):
        """The input bag of a sequence, as recorded or disturbed."""
        change = change or disturbance.Nothing()
        if os.path.commonpath([sequence.folder, self._inputs]) == self._inputs:
            folder = os.path.dirname(sequence.folder)
        else:
            folder = os.path.join(self._inputs, f'{sequence.name}-{_digest(sequence.folder)}')
        path = os.path.join(folder, change.name + '.bag')
        if os.path.exists(path):
            return path
        os.makedirs(folder, exist_ok=True)
        say(f'{sequence.name}: making {os.path.basename(path)}')
        if change.name == 'plain':
            self._call('tum_to_bag', sequence.folder, path)
        else:
            share = disturbance.disturb(self.bag(sequence), path, change, sequence)
            say(f'  {100 * share:.1f} % of the pixels have other sensor depth than recorded')
        return path

    @contextlib.contextmanager
    def fused(self, bag, config, assignments=(), topics=TOPICS, start=0.0):
        """A TemporaryRun. Its files are removed when the context is left."""
        with tempfile.TemporaryDirectory(dir=self._inputs, prefix='run-') as folder:
            run = TemporaryRun(bag, folder)
            values = [value for assignment in assignments for value in ('--set', assignment)]
            self._call('fuse_bag', bag, '--output', run.fused, '--results', run.results, '--config', config,
                       '--start', str(start), *values, '--topics', *topics)
            yield run

    def beside_rgbd_odometry(self, bag, assignments=()):
        """Trajectories {package, rgbd_odometry}, of the default settings and the assignments after them."""
        values = [value for assignment in assignments for value in ('--set', assignment)]
        with tempfile.TemporaryDirectory(dir=self._inputs, prefix='run-') as folder:
            self._call('recording_benchmark', bag, '--trajectories', folder, *values)
            return {name: tum.Trajectory.read(os.path.join(folder, name + '.txt'))
                    for name in ('package', 'rgbd_odometry')}

    def _call(self, tool, *arguments):
        path = os.path.join(self._tools, tool)
        if not os.path.exists(path):
            raise IOError(f'{path} is not there: build it (scripts/build), or say where with --tools')
        done = subprocess.run([path, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              universal_newlines=True)
        if done.returncode != 0:
            raise IOError(f'{tool} {" ".join(arguments)}\nfailed: {done.stderr.strip()}')

    @contextlib.contextmanager
    def _partial(self, folder):
        """A temporary folder, which gets its final name if all goes well."""
        os.makedirs(os.path.dirname(folder), exist_ok=True)
        partial = tempfile.mkdtemp(dir=os.path.dirname(folder))
        try:
            yield partial
            os.chmod(partial, 0o755)
            os.rename(partial, folder)
        finally:
            shutil.rmtree(partial, ignore_errors=True)


def _thin_associations(source, target, every):
    """Fills a folder with every Nth pair of a sequence; the sequence's other files are linked."""
    for name in os.listdir(source):
        if name != 'associations.txt':
            os.symlink(os.path.join(source, name), os.path.join(target, name))
    with open(os.path.join(source, 'associations.txt')) as lines:
        pairs = [line for line in lines if line.strip() and not line.startswith('#')]
    with open(os.path.join(target, 'associations.txt'), 'w') as file:
        file.writelines(pairs[::every])


def _digest(text):
    return hashlib.sha256(text.encode()).hexdigest()[:8]


def _scene_version(source):
    """A text that changes whenever the rendered images might change."""
    files = [os.path.join(source, 'src/apps/render_sequence.cpp')]
    for folder in ('src/scene', 'include/rgbd_sfm_fusion/scene'):
        folder = os.path.join(source, folder)
        files += [os.path.join(folder, name) for name in os.listdir(folder)]
    text = []
    for path in sorted(files):
        with open(path) as file:
            text.append(file.read())
    return _digest('\n'.join(text))
