# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/evaluate measures the errors that were put in."""

import json
import os
import sys
import tempfile
import types
import unittest
from unittest import mock

import cv2
import genpy
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'python'))
from rgbd_sfm_fusion import tum  # noqa: E402
from rgbd_sfm_fusion.evaluation import depth_score, error_table, first_depth, motion_score, pose_nees, results_table  # noqa: E402
from rgbd_sfm_fusion import bags  # noqa: E402

SETTINGS = {'noise_quadratic': 0.01, 'noise_floor': 1e-3, 'noise_lateral': 0.4, 'common_scale_sigma': 0.005}


class Errors(unittest.TestCase):
    def setUp(self):
        random = np.random.default_rng(1)
        self.z = random.uniform(0.5, 5, 100000)
        self.sigma = self.z * np.exp(random.uniform(-6, -1, self.z.size))
        self.e = self.sigma * random.standard_normal(self.z.size)

    def summary(self, e, z, v):
        table = error_table.ErrorTable()
        table.add(e, z, v)
        return table.summary()

    def test_numbers_are_those_of_the_pixels(self):
        e, z, v = self.e + 0.003 * self.z, self.z, self.sigma**2
        found = self.summary(e, z, v)
        n2 = e * e / v
        self.assertEqual(found['count'], z.size)
        for name, value in (('rmse', np.sqrt(np.mean(e * e))), ('nees25', np.minimum(n2, 25).mean()),
                            ('inside_2_sigma', (n2 < 4).mean()), ('beyond_5_sigma', (n2 > 25).mean()),
                            ('within_10_percent', (np.abs(e) < 0.1 * z).mean()),
                            ('sigma_over_a_fifth', (v > 0.04 * z * z).mean()), ('stated_rms', np.sqrt(v.mean()))):
            self.assertAlmostEqual(found[name], value, places=9, msg=name)
        for name, value in (('median_relative', np.median(np.abs(e) / z)), ('bias_relative', np.median(e / z)),
                            ('sigma_ratio', 1.4826 * np.median(np.sqrt(n2)))):
            self.assertAlmostEqual(found[name] / value, 1, delta=0.005, msg=name)

    def test_right_sigmas_have_a_nees_of_one_in_every_decile(self):
        found = self.summary(self.e, self.z, self.sigma**2)
        for value in found['nees25_by_decile']:
            self.assertAlmostEqual(value, 1, delta=0.06)
        flat = self.summary(self.e, self.z, np.mean((self.e / self.z)**2) * self.z**2)
        self.assertAlmostEqual(flat['log_likelihood_gain'], 0, places=9)
        self.assertGreater(found['log_likelihood_gain'], 0.3)

    def test_deciles_find_what_the_mean_hides(self):
        wrong = self.sigma * np.where(self.sigma / self.z < np.median(self.sigma / self.z), 0.7, 2.0)
        found = self.summary(self.e, self.z, wrong**2)
        self.assertGreater(found['highest_decile'], 1.9)
        self.assertLess(found['lowest_decile'], 0.3)
        n2 = np.minimum((self.e / wrong)**2, 25)[np.argsort(wrong / self.z)]
        expected = [part.mean() for part in np.array_split(n2, 10)]
        np.testing.assert_allclose(found['nees25_by_decile'], expected, rtol=0.05)

    def test_adding_tables_is_adding_pixels_and_groups_stay_apart(self):
        half = self.z.size // 2
        tables = [error_table.ErrorTable(2) for _ in range(2)]
        group = (self.z > 3).astype(int)
        for table, part in zip(tables, (slice(half), slice(half, None))):
            table.add(self.e[part], self.z[part], self.sigma[part]**2, group[part])
        both = tables[0] + tables[1]
        whole = self.summary(self.e, self.z, self.sigma**2)
        for name, value in both.summary().items():
            np.testing.assert_allclose(value, whole[name], rtol=1e-9, err_msg=name)
        self.assertEqual(both.summary([1])['count'], group.sum())
        self.assertEqual(error_table.ErrorTable().summary(), {'count': 0})


class Depth(unittest.TestCase):
    def frame(self, exact=True, **changes):
        """A wall at 2 m. Its quarters from the left: none, sensor only, SfM only, fused."""
        label = np.repeat(np.arange(4, dtype=np.uint8), 10)[None].repeat(40, axis=0)
        truth = np.full(label.shape, 2, np.float32)
        if changes.get('completed'):
            label[label == 0] = 4
        error = np.array([np.nan, 0.02, 0.04, 0.01, 0.06], np.float32)[label]
        seen = np.isin(label, (2, 3))  # by SfM
        fused = [truth + error, np.where(label > 0, 0.02, np.nan).astype(np.float32)**2, label,
                 np.where(seen, truth + 0.04, np.nan), np.where(seen, 0.04, np.nan)**2]
        given = np.where((label == 1) | (label == 3), truth + 0.02, np.nan)
        for name, value in changes.items():
            given = value if name == 'given' else given
        score = depth_score.DepthScore(exact)
        score.add(fused, changes.get('truth', truth), changes.get('mirror'), given,
                  dict(SETTINGS, max_range=1.5), changes.get('material'))
        return score

    def test_surfaces_that_the_sensor_does_not_see_are_counted_by_their_material(self):
        material = np.ones((40, 40), np.uint8)
        material[:10] = depth_score.SURFACES['dark']
        material[10:20] = depth_score.SURFACES['mirror']
        found = self.frame(completed=True, material=material).results()
        self.assertEqual((found['filled_dark'], found['completed_dark']), (1, 0.5))
        self.assertEqual((found['filled_far'], found['completed_mirror']), (1, 0.5))
        self.assertTrue(np.isnan(found['filled_shiny']))
        self.assertTrue(np.isnan(self.frame(material=material, truth=np.full((40, 40), 1.4)).results()['filled_far']))
        self.assertAlmostEqual(self.frame(material=material).results()['filled_dark'], 0.5)

    def test_depth_that_is_much_too_near_is_counted(self):
        self.assertEqual(self.frame().results()['sfm']['nearer_by_10_percent'], 0)
        far = self.frame(truth=np.full((40, 40), 2.5, np.float32)).results()
        self.assertEqual(far['sfm']['nearer_by_10_percent'], 1)
        near = self.frame(truth=np.full((40, 40), 1.5, np.float32)).results()
        self.assertEqual(near['sfm']['nearer_by_10_percent'], 0)

    def test_sources_are_compared_each_by_itself(self):
        found = self.frame().results()
        for source, rmse in (('sensor', 0.02), ('sfm', 0.04), ('fused', 0.01)):
            self.assertAlmostEqual(found[source]['rmse'], rmse, places=5)
            self.assertAlmostEqual(found['share_' + source], 1 / 3)
        self.assertAlmostEqual(found['sfm_density'], 0.5)
        self.assertAlmostEqual(found['before_fusion']['rmse'], 0.04, places=5)

    def test_a_recorded_truth_judges_only_sfm_and_adds_its_own_sigma(self):
        found = self.frame(exact=False).results()
        self.assertNotIn('sensor', found)
        self.assertNotIn('fused', found)
        stated = 0.02**2 + (depth_score.SENSOR_SIGMA * 4)**2
        self.assertAlmostEqual(found['sfm']['nees25'], 0.04**2 / stated, places=3)

    def test_what_is_held_out_is_covered_or_leaks(self):
        found = self.frame().results()['held_out']
        self.assertAlmostEqual(found['share_of_pixels'], 0.5)
        self.assertAlmostEqual(found['coverage'], 0.5)
        self.assertEqual(found['other_labels'], 0)
        found = self.frame(given=np.full((40, 40), np.nan)).results()['held_out']
        self.assertAlmostEqual(found['coverage'], 0.25)
        self.assertAlmostEqual(found['other_labels'], 0.5)

    def test_what_is_completed_counts_apart_from_the_papers_table(self):
        score = self.frame() + self.frame(completed=True)
        found = score.results()
        self.assertAlmostEqual(found['share_completed'], 0.125)
        self.assertAlmostEqual(found['share_sfm'], 1 / 3)
        self.assertAlmostEqual(found['refilled'], 0.75)
        self.assertAlmostEqual(found['completed']['rmse'], 0.06, places=5)
        self.assertAlmostEqual(found['held_out']['coverage'], 0.5)
        self.assertAlmostEqual(found['held_out_completed']['coverage'], 0.25)
        self.assertAlmostEqual(found['held_out']['coverage_together'], 0.75)
        self.assertEqual(found['held_out']['other_labels'], 0)

    def test_completed_depth_at_steps_is_compared_with_that_away_from_them(self):
        self.assertNotIn('rmse_over_interior', self.frame(completed=True).results()['completed_edges'])
        truth = np.full((40, 40), 2, np.float32)
        truth[20:] = 2.5
        error = np.full(truth.shape, 0.02, np.float32)
        error[14:26] = 0.1  # the two rows at the step, and 5 px to either side
        none = np.full(truth.shape, np.nan)
        score = depth_score.DepthScore(exact=True)
        score.add([truth + error, error**2, np.full(truth.shape, 4, np.uint8), none, none], truth)
        found = score.results()
        self.assertAlmostEqual(found['completed_edges']['rmse'], 0.1, places=5)
        self.assertAlmostEqual(found['completed_edges']['rmse_over_interior'], 5, places=4)

    def test_gain_over_the_sensor_as_it_is_and_as_it_is_stated(self):
        score = self.frame()
        for _ in range(3):
            score = score + self.frame()
        band = score.results()['gain_interior']['2_3']
        self.assertAlmostEqual(band['ratio'], 0.5, places=4)
        stated = 0.02 / np.sqrt(depth_score.surface_variance(np.full((3, 3), 2.02), SETTINGS)[1, 1])
        self.assertAlmostEqual(band['stated_ratio'], stated, places=4)
        self.assertAlmostEqual(band['share_of_stated_gain'], 0.5 / (1 - stated), places=3)

    def test_the_sensor_is_less_certain_on_slopes(self):
        settings = dict(SETTINGS, noise_quadratic=1.425e-3)
        depth = 2 + 0.02 * np.arange(6.0)[None].repeat(4, axis=0)
        depth[:, 4:] += 1  # a step is no slope
        own = (1.425e-3 * depth[1]**2)**2 + 1e-3**2
        expected = own + (0.005 * depth[1])**2 + 0.4**2 * (0.02**2 - 2 * own)
        np.testing.assert_allclose(depth_score.surface_variance(depth, settings)[1], expected)
        np.testing.assert_allclose(depth_score.surface_variance(depth.T, settings)[:, 1], expected)

    def test_mirrors_and_edges_are_apart(self):
        mirror = np.zeros((40, 40), bool)
        mirror[:, 20:30] = True
        found = self.frame(mirror=mirror).results()
        self.assertEqual(found['sfm']['count'], 0)
        self.assertEqual(found['sfm_mirrors']['count'], 400)
        truth = np.full((40, 40), 2, np.float32)
        truth[:, 30:] = 3
        found = self.frame(truth=truth).results()
        self.assertEqual(found['fused_interior']['count'], 10 * 40 - found['fused_edges']['count'])
        self.assertGreaterEqual(found['fused_edges']['count'], 5 * 40)

    def test_messages_that_contradict_themselves_are_refused(self):
        ones = np.ones((40, 40), np.float32)
        label = np.ones((40, 40), np.uint8)
        none = np.full((40, 40), np.nan)
        for mean, variance in ((none, ones), (ones, 0 * ones), (ones, none)):
            with self.assertRaises(ValueError):
                depth_score.DepthScore(True).add([mean, variance, label, none, none], 2 * ones)


def true_motion(count):
    """A trajectory at 30 Hz."""
    t = np.arange(count) / 30
    return types.SimpleNamespace(
        stamps=(10**9 * (1000 + t)).astype(np.int64), positions=np.stack([np.sin(t), np.cos(2 * t), 0.3 * t], axis=1),
        rotations=np.array([tum.rotation_matrix([0, 0.4 * np.sin(a), 0.1 * a, 1]) for a in t]))


class Motion(unittest.TestCase):
    def setUp(self):
        self.truth = true_motion(150)

    def test_drift_of_the_scale_comes_back(self):
        step = np.diff(self.truth.positions, axis=0, prepend=self.truth.positions[:1])
        scale = np.linspace(1.0, 1.25, len(step))
        estimate = types.SimpleNamespace(rotations=self.truth.rotations, stamps=self.truth.stamps,
                                         positions=np.cumsum(step / scale[:, None], axis=0))
        scales = motion_score.scales_over_time(estimate, self.truth)
        self.assertEqual(len(scales), 5)
        self.assertTrue((np.diff(scales) > 0.02).all())
        self.assertAlmostEqual(scales[2], 1.125, delta=0.03)
        np.testing.assert_allclose(motion_score.scales_over_time(self.truth, self.truth), 1)

    def test_true_poses_between_those_measured(self):
        stamps = self.truth.stamps[:-1] + 10**7
        found = motion_score.interpolated(self.truth, stamps)
        between = 0.7 * self.truth.positions[:-1] + 0.3 * self.truth.positions[1:]
        np.testing.assert_allclose(found.positions, between, atol=1e-6)
        turned = np.array([cv2.Rodrigues(a.T @ b)[0].ravel() for a, b in zip(self.truth.rotations, found.rotations)])
        whole = np.array([cv2.Rodrigues(a.T @ b)[0].ravel() for a, b in
                          zip(self.truth.rotations, self.truth.rotations[1:])])
        np.testing.assert_allclose(turned, 0.3 * whole, atol=1e-6)
        outside = np.array([self.truth.stamps[0] - 1, self.truth.stamps[-1] + 1])
        self.assertEqual(len(motion_score.interpolated(self.truth, outside).stamps), 0)


class PoseCovariance(unittest.TestCase):
    def nees(self, assumed):
        """The score of poses with errors of 0.01 in all six components, and covariances of (assumed errors)²."""
        random = np.random.default_rng(5)
        truth = true_motion(400)
        frames = []
        for i, stamp in enumerate(truth.stamps):
            R = truth.rotations[i].T @ truth.rotations[0]
            p = truth.rotations[i].T @ (truth.positions[0] - truth.positions[i])
            turn = cv2.Rodrigues(random.normal(0, 0.01, 3))[0]
            R, p = turn @ R, turn @ p + random.normal(0, 0.01, 3)
            w = np.sqrt(1 + np.trace(R)) / 2
            x, y, z = (R[2, 1] - R[1, 2]) / (4 * w), (R[0, 2] - R[2, 0]) / (4 * w), (R[1, 0] - R[0, 1]) / (4 * w)
            frames.append(types.SimpleNamespace(
                state=1, TRACKING=1, header=types.SimpleNamespace(stamp=genpy.Time(stamp // 10**9, stamp % 10**9)),
                keyframe_stamp=genpy.Time(truth.stamps[0] // 10**9, truth.stamps[0] % 10**9),
                T_frame_keyframe=types.SimpleNamespace(rotation=types.SimpleNamespace(x=x, y=y, z=z, w=w),
                                                       translation=types.SimpleNamespace(x=p[0], y=p[1], z=p[2])),
                covariance=(assumed**2 * np.eye(6)).ravel()))
        bag = mock.MagicMock()
        bag.__enter__.return_value.read_messages.return_value = [(None, frame, None) for frame in frames]
        with mock.patch.object(bags, 'open_bag', return_value=bag):
            return motion_score.relative_pose_nees('any.bag', truth)

    def test_right_covariances_give_one_and_others_do_not(self):
        right, small = self.nees(0.01), self.nees(0.005)
        self.assertAlmostEqual(right['pose_nees'], 1, delta=0.1)
        self.assertAlmostEqual(right['pose_nees_median'], 0.89, delta=0.1)
        self.assertAlmostEqual(small['pose_nees'] / right['pose_nees'], 4, delta=0.1)


class FirstDepth(unittest.TestCase):
    def delay(self, counts):
        """Of a camera at 30 Hz that moves by 2 cm a second from frame 30 on; it is to have moved by 1 cm."""
        stamps = 10**18 + 33333333 * np.arange(len(counts))
        positions = np.stack([0.02 * np.maximum(0, np.arange(len(counts)) - 30) / 30, *2 * [np.zeros(len(counts))]], 1)
        return first_depth.delay(stamps, np.array(counts), 10000, stamps, positions, 0.01)

    def test_counts_from_the_motion_to_a_quarter_of_what_comes_later(self):
        found = self.delay(60 * [0] + 100 * [4000])
        self.assertAlmostEqual(found['sfm_only_after'], 0.5, delta=0.04)
        self.assertAlmostEqual(found['sfm_only_later'], 0.4, delta=0.001)
        self.assertAlmostEqual(self.delay(50 * [0] + 40 * [700] + 70 * [4000])['sfm_only_after'], 1.5, delta=0.04)

    def test_few_pixels_are_none(self):
        self.assertNotIn('sfm_only_after', self.delay(60 * [0] + 100 * [499]))
        self.assertEqual(self.delay(200 * [0])['sfm_only_later'], 0)

    def test_depth_before_the_motion_takes_no_time(self):
        self.assertEqual(self.delay(200 * [600])['sfm_only_after'], 0)


class MotionCovariance(unittest.TestCase):
    def motions(self, assumed, lost=(), every=15, truth_turn=None):
        """Motions over a second at 30 Hz. Each keyframe has an error of 0.01 against the one before, each frame of
        0.01 against its keyframe; covariances are of (assumed errors)²."""
        random = np.random.default_rng(7)
        truth = true_motion(900)
        frames, poses = [], {}
        poses[truth.stamps[0]] = truth.rotations[0], truth.positions[0]
        for i, stamp in enumerate(truth.stamps):
            first = i - (i - 1) % every - 1 if i > 0 else 0  # the keyframe that it was tracked against
            R, t = poses[truth.stamps[first]]
            step = truth.rotations[first].T @ (truth.positions[i] - truth.positions[first])
            noise = 0.01 if i > 0 else 0.0
            turn = cv2.Rodrigues(random.normal(0, noise, 3))[0]
            R, t = R @ truth.rotations[first].T @ truth.rotations[i], t + R @ step
            poses[stamp] = R @ turn, t + R @ random.normal(0, noise, 3)
            covariance = 1e-12 * np.eye(6) if i % every == 0 else assumed**2 * np.eye(6)
            frames.append(types.SimpleNamespace(stamp=stamp, keyframe=truth.stamps[i - i % every], broken=i in lost,
                                                covariance=covariance))
        if truth_turn is not None:
            truth.rotations = truth.rotations @ cv2.Rodrigues(truth_turn)[0]
        return pose_nees._motions(frames, poses, truth)

    def nees(self, *arguments, **options):
        return pose_nees._nees(self.motions(*arguments, **options))

    def test_right_covariances_give_one_and_others_do_not(self):
        right, small = self.nees(0.01), self.nees(0.005)
        self.assertAlmostEqual(np.mean(right), 1, delta=0.25)
        self.assertAlmostEqual(np.mean(small) / np.mean(right), 4, delta=0.1)

    def test_no_motion_leads_across_a_loss(self):
        self.assertEqual(len(self.nees(0.01)) - len(self.nees(0.01, lost=[400])), 30)

    def test_a_turned_camera_of_the_truth_is_found(self):
        turn = np.radians([-1.5, 0.5, 1.0])
        motions = self.motions(0.01, truth_turn=turn)
        np.testing.assert_allclose(pose_nees.camera_turn(motions), -turn, atol=np.radians(0.4))
        np.testing.assert_allclose(pose_nees.camera_turn(self.motions(0.01)), 0, atol=np.radians(0.4))


class Report(unittest.TestCase):
    def test_runs_are_pooled_by_kind(self):
        runs = [{'plain': ({'ate': ate, 'lost': lost}, None)} for ate, lost in ((0.01, 0), (0.02, 3), (0.06, 1))]
        found = results_table.pooled(runs)['plain']
        self.assertEqual((found['ate'], found['lost']), (0.02, 4))
        self.assertAlmostEqual(found['ate_worst_to_median'], 3)

    def test_the_table_shows_what_was_before_where_it_differs(self):
        now = {'a': {'plain': {'ate': 0.0204, 'rpe': 0.03}}, 'b': {'plain': {'ate': float('nan')}}}
        lines = results_table.table(now, {'a': {'plain': {'ate': 0.0221, 'rpe': 0.03}}})
        ate = next(line for line in lines if line.startswith('  ATE [mm]'))
        self.assertIn('20.4 (22.1)', ate)
        self.assertIn('30.0', next(line for line in lines if 'RPE over 1 s [mm]' in line))
        self.assertNotIn('(', next(line for line in lines if 'RPE over 1 s [mm]' in line).replace('[mm]', ''))
        self.assertFalse(any('Leak' in line for line in lines))

    def test_a_run_without_any_tracked_frame_has_no_errors(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        truth = types.SimpleNamespace(stamps=np.arange(1000, 1100) * 10**9, positions=np.zeros((100, 3)),
                                      rotations=np.tile(np.eye(3), (100, 1, 1)))
        with open(os.path.join(folder.name, 'summary.json'), 'w') as file:
            json.dump({'frames': 9, 'frames_tracked': 0, 'frames_lost': 9, 'keyframes': 0,
                       'timing_ms': {'fusion': {'p50': 2.5}}}, file)
        with open(os.path.join(folder.name, 'trajectory.txt'), 'w') as file:
            file.write('# nothing\n')
        found = motion_score.motion_score(folder.name, truth)
        self.assertEqual(found, {'frames': 9, 'tracked': 0, 'lost': 9, 'keyframes': 0, 'fusion_ms': 2.5})


if __name__ == '__main__':
    unittest.main()
