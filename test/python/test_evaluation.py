# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The evaluation is right itself: it finds the errors that were put in."""

import os
import sys
import tempfile
import types
import unittest
from unittest import mock

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'python'))
from rgbd_sfm_fusion import bags, trajectory, tum  # noqa: E402
from rgbd_sfm_fusion.evaluation import coverage, truth_errors  # noqa: E402
from rgbd_sfm_fusion.evaluation.surface_interior import surface_interior  # noqa: E402


def random_trajectory(seed, count=300):
    """A smooth trajectory at 30 Hz."""
    result = types.SimpleNamespace()
    t = np.arange(count) / 30
    phases = np.random.default_rng(seed).uniform(0, 6, 6)
    result.stamps = (1.3e18 + 1e9 * t).astype(np.int64)
    result.positions = np.stack([np.sin(t * (1 + 0.3 * i) + phases[i]) for i in range(3)], axis=1)
    result.rotations = np.array([tum.rotation_matrix([0.3 * np.sin(a + phases[3]), 0.2 * np.cos(a + phases[4]),
                                                      0.1 * np.sin(2 * a + phases[5]), 1]) for a in t])
    return result


def moved(source, R, translation, scale=1.0):
    return types.SimpleNamespace(stamps=source.stamps.copy(), rotations=R @ source.rotations,
                                 positions=scale * source.positions @ R.T + translation)


class TrajectoryErrors(unittest.TestCase):
    def setUp(self):
        self.truth = random_trajectory(1)
        self.R = tum.rotation_matrix([0.5, -0.5, 0.1, 0.7])

    def test_choice_of_frame_and_scale_is_no_error(self):
        estimate = moved(self.truth, self.R, np.array([5.0, -2.0, 100.0]))
        self.assertLess(trajectory.absolute_error(estimate, self.truth)[0], 1e-9)
        self.assertLess(max(trajectory.relative_error(estimate, self.truth)), 1e-5)
        estimate = moved(self.truth, self.R, np.zeros(3), scale=0.8)
        error, scale = trajectory.absolute_error(estimate, self.truth, with_scale=True)
        self.assertLess(error, 1e-9)
        self.assertAlmostEqual(scale, 1 / 0.8)
        self.assertGreater(trajectory.absolute_error(estimate, self.truth)[0], 0.1)

    def test_noise_comes_back(self):
        estimate = moved(self.truth, self.R, np.ones(3))
        estimate.positions += np.random.default_rng(2).normal(0, 0.01, estimate.positions.shape)
        self.assertAlmostEqual(trajectory.absolute_error(estimate, self.truth)[0], 0.01 * np.sqrt(3), delta=0.001)

    def test_drift_per_second_comes_back(self):
        estimate = moved(self.truth, np.eye(3), np.zeros(3))
        seconds = 1e-9 * (estimate.stamps - estimate.stamps[0])
        estimate.positions += np.outer(seconds, [0.03, 0, 0.04])
        self.assertAlmostEqual(trajectory.relative_error(estimate, self.truth)[0], 0.05, places=4)

    def test_errors_of_single_poses_show_from_frame_to_frame(self):
        estimate = moved(self.truth, self.R, np.ones(3))
        estimate.positions[::2] += self.R @ [0.003, 0, 0.004]
        estimate.rotations[::2] = estimate.rotations[::2] @ tum.rotation_matrix([0, np.sin(0.005), 0, np.cos(0.005)])
        found = trajectory.step_error(estimate, self.truth)
        np.testing.assert_allclose(found, [0.005, np.degrees(0.01)], rtol=0.01)
        self.assertLess(trajectory.step_error(moved(self.truth, self.R, np.ones(3)), self.truth)[0], 1e-9)

    def test_a_step_after_a_gap_is_no_step_from_frame_to_frame(self):
        estimate = moved(self.truth, self.R, np.ones(3))
        keep = np.r_[0:100, 130:300]
        truth = types.SimpleNamespace(stamps=self.truth.stamps[keep], positions=self.truth.positions[keep],
                                      rotations=self.truth.rotations[keep])
        estimate.positions[130:] += 1.0
        estimate = types.SimpleNamespace(stamps=estimate.stamps[keep], positions=estimate.positions[keep],
                                         rotations=estimate.rotations[keep])
        self.assertLess(trajectory.step_error(estimate, truth)[0], 1e-9)
        self.assertTrue(np.isnan(trajectory.step_error(
            types.SimpleNamespace(stamps=estimate.stamps[:1]), truth)[0]))

    def test_poses_without_a_true_one_at_their_time_are_left_out(self):
        estimate = moved(self.truth, np.eye(3), np.zeros(3))
        estimate.stamps[::2] += 15 * 10**6
        self.assertEqual(len(trajectory.matches(estimate, self.truth)[0]), 150)
        estimate.stamps += 10**12
        with self.assertRaises(ValueError):
            trajectory.absolute_error(estimate, self.truth)


class Reading(unittest.TestCase):
    def test_stamps_are_exact(self):
        self.assertEqual(tum.nanoseconds('1305031102.175304'), 1305031102175304000)
        self.assertEqual(tum.nanoseconds('1305031102.123456789'), 1305031102123456789)
        self.assertEqual(tum.nanoseconds('7'), 7 * 10**9)

    def test_trajectory_refuses_other_files(self):
        with tempfile.NamedTemporaryFile('w') as file:
            for content in ('', '# nothing\n', '1 2 3\n'):
                file.seek(0)
                file.truncate()
                file.write(content)
                file.flush()
                with self.assertRaises(ValueError):
                    tum.Trajectory.read(file.name)

    def test_images_with_padded_rows_and_either_byte_order(self):
        values = np.array([[0, 1, 258], [65535, 1000, 2]], np.uint16)
        for order in '<>':
            padded = np.zeros((2, 4), np.dtype(np.uint16).newbyteorder(order))
            padded[:, :3] = values
            message = types.SimpleNamespace(encoding='16UC1', height=2, width=3, step=8, data=padded.tobytes(),
                                            is_bigendian=order == '>')
            np.testing.assert_array_equal(bags.image(message), values)

    def test_only_real_depths_become_metres(self):
        np.testing.assert_array_equal(bags.metres(np.array([[0, 1500]], np.uint16)), [[np.nan, 1.5]])
        none = np.array([[0, -1, np.nan, np.inf, -np.inf, 2]], np.float32)
        np.testing.assert_array_equal(bags.metres(none), [[np.nan] * 5 + [2]])


class Interior(unittest.TestCase):
    def test_keeps_clear_of_steps_and_holes(self):
        truth = np.full((40, 60), 2, np.float32)
        truth[:, 30:] = 3
        truth[20, 10] = np.nan
        inner = surface_interior(truth)
        self.assertFalse(inner[:, 25:35].any())
        self.assertFalse(inner[15:26, 5:16].any())
        self.assertTrue(inner[:, 40:].all())
        slope = np.tile(np.linspace(2, 3, 200, dtype=np.float32), (20, 1))
        self.assertTrue(surface_interior(slope).all())


class ErrorsOfSources(unittest.TestCase):
    """A wall 2 m away. Each row of the image has one source."""

    LABELS = np.repeat(np.arange(5, dtype=np.uint8), 12)[:, None].repeat(60, axis=1)

    def errors(self, exact, sensor=None, mirror=None):
        truth = np.full(self.LABELS.shape, 2, np.float32)
        sequence = mock.MagicMock(exact=exact)
        sequence.__contains__.return_value = True
        sequence.true_depth.return_value, sequence.mirror.return_value = truth, mirror
        mean = np.where(self.LABELS > 0, 2 + 0.1 * self.LABELS, np.nan).astype(np.float32)
        result = truth_errors.TruthErrors(sequence)
        result.add(types.SimpleNamespace(stamp=0, provenance=self.LABELS, mean=mean, variance=np.full(truth.shape, 0.04)),
                   sensor)
        return {(source, place): summary for source, place, summary in result.rows()}

    def test_each_pixel_counts_for_its_source(self):
        found = self.errors(exact=True, sensor=np.full(self.LABELS.shape, 2.5))
        for source, name in enumerate(('sensor only', 'SfM only', 'fused', 'completed'), 1):
            self.assertAlmostEqual(found[name, 'outside mirrors']['rmse'], 0.1 * source, places=5)
        self.assertAlmostEqual(found['the sensor, where fused', 'interior']['rmse'], 0.5)

    def test_recorded_depth_judges_only_what_was_added_where_the_run_had_none(self):
        self.assertEqual({source for source, _ in self.errors(exact=False)}, {'SfM only', 'completed'})
        self.assertEqual(self.errors(exact=False, sensor=np.full(self.LABELS.shape, 2.0)), {})

    def test_mirrors_are_kept_apart(self):
        mirror = np.zeros(self.LABELS.shape, bool)
        mirror[:30] = True
        found = self.errors(exact=True, mirror=mirror)
        self.assertEqual(found['SfM only', 'outside mirrors']['count'], 6 * 60)
        self.assertEqual(found['SfM only', 'in mirrors']['count'], 6 * 60)
        self.assertNotIn(('sensor only', 'outside mirrors'), found)


class FlatWall:
    """A wall 2 m away that fills the view: a stand-in for DepthTruth."""

    intrinsics = [50, 50, 31.5, 23.5]

    def __contains__(self, stamp):
        return True

    def __getitem__(self, stamp):
        return np.full((48, 64), 2, np.float32)

    def rays(self):
        x, y = np.meshgrid(np.arange(64), np.arange(48))
        return np.dstack([(x - 31.5) / 50, (y - 23.5) / 50, np.ones(x.shape)])


class SfmCoverage(unittest.TestCase):
    def moving(self, speed, seconds=2.0):
        """Along x [m/s]."""
        t = np.arange(0, seconds, 1 / 30)
        poses = np.zeros((len(t), 7))
        poses[:, 0], poses[:, 6] = speed * t, 1
        return tum.Trajectory((1e9 * t).astype(np.int64), poses)

    def observable(self, poses):
        wall = FlatWall()
        return coverage.Visibility(wall, poses).observable(int(poses.stamps[-1]), wall[0])

    def test_needs_parallax_and_time(self):
        self.assertFalse(self.observable(self.moving(0.0)).any(), 'no motion')
        self.assertFalse(self.observable(self.moving(0.01)).any(), '0.6° at most')
        self.assertFalse(self.observable(self.moving(0.2, 0.9)).any(), 'not long enough')
        seen = self.observable(self.moving(0.2))
        self.assertTrue(seen[:, :50].all())
        # Pixels that came into view on the right less than a second ago: 0.2 m are 5 px.
        self.assertFalse(seen[:, 60:].any())

    def test_texture_is_the_gradient_nearby(self):
        grey = np.full((20, 40), 100, np.uint8)
        grey[:, 20:] += 18
        self.assertEqual(set(np.flatnonzero(coverage.textured(grey).any(axis=0))), {18, 19, 20, 21})
        self.assertFalse(coverage.textured(np.tile(np.arange(0, 240, 6, dtype=np.uint8), (20, 1))).any())

    def test_counts_sfm_where_it_could_be_and_mirrors_as_errors(self):
        poses, wall = self.moving(0.2), FlatWall()
        grey = np.tile(np.array([0, 0, 99, 99], np.uint8), (48, 16))
        provenance = np.zeros((48, 64), np.uint8)
        provenance[:12] = 2
        mirror = np.zeros((48, 64), bool)
        mirror[:2] = mirror[-2:] = True
        sensor = np.full((48, 64), np.nan, np.float32)
        sensor[24:] = 2
        mean = np.where(mirror, 4, 2.02).astype(np.float32)
        result = coverage.Coverage(coverage.Visibility(wall, poses))
        result.add(int(poses.stamps[-1]), grey, sensor, mean, provenance, wall[0], mirror)
        share, error, error_with_mirrors = result.summary()
        self.assertAlmostEqual(share, 10 / 22, delta=0.01)
        self.assertAlmostEqual(error, 0.01, places=4)
        self.assertAlmostEqual(error_with_mirrors, 0.01, places=4)
        self.assertEqual(result.in_mirrors, result.covered // 5)
        provenance[:] = np.where(mirror, 2, 0)
        for _ in range(10):
            result.add(int(poses.stamps[-1]), grey, sensor, mean, provenance, wall[0], mirror)
        self.assertAlmostEqual(result.summary()[1], 0.01, places=4)
        self.assertAlmostEqual(result.summary()[2], 1, places=4)


if __name__ == '__main__':
    unittest.main()
