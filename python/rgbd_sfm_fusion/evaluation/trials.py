# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The tests of scripts/evaluate. Each gives numbers by name, and some also a score of the depth."""

import numpy as np

from .. import trajectory
from . import comparisons, disturbance
from .depth_score import score
from .first_depth import first_depth
from .motion_score import interpolated, median_of_frames, motion_score, relative_pose_nees
from .pose_nees import second_nees

_RANDOM_STARTS, _BETWEEN_STARTS = 10, 0.2  # [s]
_GOOD_RANDOM_ATE = 0.05                    # [m] after Sim(3)


class Bench:
    """One sequence with one configuration. All trials share the results of the run on the sequence as recorded.

    @param plane, box  limits of the held-out depth; the box is also the place of false depth in the leak test. None:
                       the first depth image decides"""

    def __init__(self, workshop, sequence, config, assignments=(), every=1, plane=None, box=None):
        self._workshop, self.sequence, self._every = workshop, sequence, every
        self._config, self._assignments = config, list(assignments)
        self._plane, self._box = plane, box

    def run(self, trials):
        """{trial: (numbers, DepthScore or None)}"""
        results = {}
        with self._fuse() as plain:
            self.plain = motion_score(plain.results, self.sequence.ground_truth)
            if 'plain' in trials:
                self.plain.update(relative_pose_nees(plain.fused, self.sequence.ground_truth))
                self.plain.update(second_nees(plain.fused, plain.results, self.sequence.ground_truth,
                                              not self.sequence.exact))
                self.plain.update(first_depth(plain.fused, plain.results))
                results['plain'] = self.plain, self._score(plain)
            for name in trials:
                if name != 'plain':
                    results[name] = TRIALS[name](self, plain)
        return results

    def _fuse(self, change=None, **options):
        assignments = self._assignments + list(options.pop('assignments', []))
        return self._workshop.fused(self._workshop.bag(self.sequence, change), self._config, assignments, **options)

    def _score(self, run):
        return score(run.fused, run.given, self.sequence, run.settings(), self._every)

    def _points(self):
        return disturbance.first_points(self._workshop.bag(self.sequence), self.sequence)

    def _the_box(self):
        return self._box or disturbance.default_box(self._points())

    def held_out(self, _):
        return self._held_out(disturbance.Beyond(self._plane or disturbance.default_plane(self._points())))

    def held_out_box(self, _):
        return self._held_out(disturbance.Box(self._the_box()))

    def _held_out(self, change):
        with self._fuse(change) as run:
            return motion_score(run.results, self.sequence.ground_truth), self._score(run)

    def shallow_overlap(self, _):
        """SfM depth beyond the range of a sensor whose depths share an error, of either sign."""
        points = self._points()
        nearest = round(float(np.percentile(points[:, 2], 10)), 2)
        numbers = {}
        for name, sign in (('plus', 1), ('minus', -1)):
            change = disturbance.ShallowOverlap(nearest, 1.3 * nearest, sign * 0.003, 1 + sign * 0.005)
            with self._fuse(change) as run:
                numbers.update({f'{name}_{key}': value for key, value in comparisons.sfm_only_by_metre(
                    run.fused, self.sequence, self._every).items()})
                numbers[f'{name}_sigma_twice_as_far'] = median_of_frames(run.results, 'sigma_twice_as_far')
        return numbers, None

    def leak(self, plain):
        change = disturbance.Box(self._the_box(), factor=1.1)
        with self._fuse(change) as run:
            numbers = {'change': comparisons.leak(plain.bags, run.bags, self.sequence, self._every)}
        off = {'assignments': ['sensor_feedback=off'], 'topics': comparisons.KEYFRAME_TOPICS}
        with self._fuse(**off) as before, self._fuse(change, **off) as after:
            differing, images = comparisons.keyframe_difference(before.fused, after.fused)
        return dict(numbers, keyframe_images=images, keyframe_images_changed=differing), None

    def black(self, _):
        change = disturbance.Black()
        with self._fuse(change) as run:
            numbers = motion_score(run.results, self.sequence.ground_truth)
            numbers.update(comparisons.recovery(run.results, change.start, change.duration))
        numbers['ate_ratio'] = numbers.get('ate', np.nan) / self.plain.get('ate', np.nan)
        return numbers, None

    def false_block(self, plain):
        with self._fuse(disturbance.FalseBlock()) as run:
            return comparisons.false_depth(plain.bags, run.bags, self.sequence, self._every), None

    def right_half(self, _):
        with self._fuse(disturbance.RightHalf()) as run:
            return motion_score(run.results, self.sequence.ground_truth), None

    def random_start(self, _):
        """Starts from a different image each time, since the random numbers are the same in every run."""
        errors, good = [], 0
        for start in range(_RANDOM_STARTS):
            with self._fuse(disturbance.NoDepth(), assignments=['init=random'], start=start * _BETWEEN_STARTS,
                            topics=['/fusion/sfm_depth']) as run:
                numbers = motion_score(run.results, self.sequence.ground_truth)
            errors.append(numbers.get('ate_sim3', np.nan))
            good += numbers['lost'] == 0 and errors[-1] <= _GOOD_RANDOM_ATE
        return {'starts': _RANDOM_STARTS, 'good_starts': int(good), 'ate_sim3': float(np.nanmedian(errors)),
                'ate_sim3_each': errors}, None

    def rgbd_odometry(self, _):
        """The package and OpenCV's RgbdOdometry, both in one process and from the same images."""
        ate = {}
        for name, estimate in self._workshop.beside_rgbd_odometry(self._workshop.bag(self.sequence),
                                                                  self._assignments).items():
            truth = interpolated(self.sequence.ground_truth, estimate.stamps)
            ate[name], _ = trajectory.absolute_error(estimate, truth)
        return {'ate_package': ate['package'], 'ate_rgbd_odometry': ate['rgbd_odometry'],
                'ate_to_rgbd_odometry': ate['package'] / ate['rgbd_odometry']}, None


TRIALS = {'plain': None, 'held-out': Bench.held_out, 'held-out-box': Bench.held_out_box, 'leak': Bench.leak,
          'shallow-overlap': Bench.shallow_overlap, 'black': Bench.black, 'false-block': Bench.false_block,
          'right-half': Bench.right_half, 'random-start': Bench.random_start, 'rgbd-odometry': Bench.rgbd_odometry}
