# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""What scripts/evaluate measures and disturbs: it gives back what was put in."""

import json
import os
import sys
import tempfile
import types
import unittest
from unittest import mock

import cv2
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'scripts'))
from evaluation import comparisons, depth_score, disturbance, error_table, motion_score, report, tum  # noqa: E402
from evaluation import bag as bags  # noqa: E402
from evaluation.sequence import Sequence  # noqa: E402
from sensor_msgs.msg import Image  # noqa: E402

import genpy  # noqa: E402

WIDTH, HEIGHT = 40, 30
SETTINGS = {'common_scale_sigma': 0.005}


def image_message(values, stamp, encoding):
    message = Image(height=values.shape[0], width=values.shape[1], encoding=encoding,
                    step=values.shape[1] * values.dtype.itemsize, data=values.tobytes())
    message.header.stamp = genpy.Time(stamp // 10**9, stamp % 10**9)
    return message


def write_bag(path, images):
    """@param images  (topic, stamp [ns], values, encoding)"""
    with bags.rosbag.Bag(path, 'w') as bag:
        for topic, stamp, values, encoding in images:
            message = image_message(values, stamp, encoding)
            bag.write(topic, message, message.header.stamp)


def write_sequence(folder, positions, depths, distortion=None):
    """A sequence whose camera looks along z and moves; depth images [m] are 10 ms before colour."""
    os.makedirs(os.path.join(folder, 'depth'))
    stamps = [10**9 * (1000 + i) for i in range(len(positions))]
    with open(os.path.join(folder, 'calib.txt'), 'w') as file:
        file.write(f'40 40 19.5 14.5 {WIDTH} {HEIGHT} 1000\n')
        if distortion:
            file.write('# dist ' + ' '.join(map(str, distortion)) + '\n')
    with open(os.path.join(folder, 'groundtruth.txt'), 'w') as poses, \
            open(os.path.join(folder, 'associations.txt'), 'w') as pairs:
        for i, (stamp, position, depth) in enumerate(zip(stamps, positions, depths)):
            seconds = stamp // 10**9 - 1
            poses.write(f'{seconds}.990 {position[0]} {position[1]} {position[2]} 0 0 0 1\n')
            pairs.write(f'{seconds + 1}.000 rgb/{i}.png {seconds}.990 depth/{i}.png\n')
            cv2.imwrite(os.path.join(folder, 'depth', f'{i}.png'), np.rint(1000 * depth).astype(np.uint16))
    return stamps


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)


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
        np.testing.assert_allclose(found['nees25_by_decile'], [part.mean() for part in np.array_split(n2, 10)], rtol=0.05)

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
        """A wall at 2 m: left quarter none, then sensor only, SfM only, fused."""
        label = np.repeat(np.arange(4, dtype=np.uint8), 10)[None].repeat(40, axis=0)
        truth = np.full(label.shape, 2, np.float32)
        error = np.array([np.nan, 0.02, 0.04, 0.01], np.float32)[label]
        fused = [truth + error, np.where(label > 0, 0.02, np.nan).astype(np.float32)**2, label,
                 np.where(label > 1, truth + 0.04, np.nan), np.where(label > 1, 0.04, np.nan)**2]
        given = np.where((label == 1) | (label == 3), truth + 0.02, np.nan)
        for name, value in changes.items():
            given = value if name == 'given' else given
        score = depth_score.DepthScore(exact)
        score.add(fused, changes.get('truth', truth), changes.get('mirror'), given, SETTINGS)
        return score

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

    def test_gain_over_the_sensor_as_it_is_and_as_it_is_stated(self):
        score = self.frame()
        for _ in range(3):
            score = score + self.frame()
        band = score.results()['gain_interior']['2_3']
        self.assertAlmostEqual(band['ratio'], 0.5, places=4)
        fused = 0.02**2 - (0.005 * 2.01)**2
        sensor = 1 / (1 / fused - 1 / 0.04**2)
        self.assertAlmostEqual(band['stated_ratio'], np.sqrt(fused / sensor), places=4)
        self.assertAlmostEqual(band['share_of_stated_gain'], 0.5 / (1 - np.sqrt(fused / sensor)), places=3)

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


class Motion(unittest.TestCase):
    def setUp(self):
        t = np.arange(150) / 30
        self.truth = types.SimpleNamespace(
            stamps=(10**9 * (1000 + t)).astype(np.int64), positions=np.stack([np.sin(t), np.cos(2 * t), 0.3 * t], axis=1),
            rotations=np.array([tum.rotation_matrix([0, 0.2 * np.sin(a), 0.1, 1]) for a in t]))

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


class PoseCovariance(InFolder):
    def nees(self, assumed):
        """Of poses with errors of 0.01 in all six, and covariances of (assumed errors)²."""
        random = np.random.default_rng(5)
        t = np.arange(400) / 30
        truth = types.SimpleNamespace(
            stamps=(10**9 * (1000 + t)).astype(np.int64), positions=np.stack([np.sin(t), np.cos(2 * t), t], axis=1),
            rotations=np.array([tum.rotation_matrix([0, 0.4 * np.sin(a), 0.2 * a, 1]) for a in t]))
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


class Disturbances(InFolder):
    def setUp(self):
        super().setUp()
        # The camera moves towards a wall that is at 3 m first; its lower half is 1 m nearer.
        self.depths = []
        for i in range(4):
            depth = np.full((HEIGHT, WIDTH), 3 - 0.5 * i, np.float32)
            depth[HEIGHT // 2:] -= 1
            self.depths.append(depth)
        stamps = write_sequence(self.path('sequence'), [(0, 0, 0.5 * i) for i in range(4)], self.depths)
        self.sequence = Sequence(self.path('sequence'))
        images = []
        for stamp, depth in zip(stamps, self.depths):
            images += [(disturbance.DEPTH, stamp - 10**7, (1000 * depth).astype(np.uint16), '16UC1'),
                       (disturbance.COLOUR, stamp, np.full((HEIGHT, WIDTH), 200, np.uint8), 'mono8')]
        write_bag(self.path('plain.bag'), images)

    def disturbed(self, change):
        """Depth and colour images after it."""
        disturbance.disturb(self.path('plain.bag'), self.path('other.bag'), change, self.sequence)
        with bags.open_bag(self.path('other.bag')) as bag:
            return [[bags.image(message) for _, message, _ in bag.read_messages(topics=[topic])]
                    for topic in (disturbance.DEPTH, disturbance.COLOUR)]

    def test_what_is_beyond_a_plane_of_the_world_is_gone_in_every_image(self):
        depths, colours = self.disturbed(disturbance.Beyond(2.5))
        for depth, recorded in zip(depths, self.depths):
            np.testing.assert_array_equal(depth[:HEIGHT // 2], 0)
            np.testing.assert_allclose(depth[HEIGHT // 2:], 1000 * recorded[HEIGHT // 2:])
        self.assertTrue(all((colour == 200).all() for colour in colours))

    def test_boxes_are_fixed_in_the_world(self):
        depths, _ = self.disturbed(disturbance.Box([-9, 9, -9, 9, 1.5, 2.5]))
        for depth in depths:
            np.testing.assert_array_equal(depth > 0, self.depths[0] > 2.5)
        depths, _ = self.disturbed(disturbance.Box([-9, 9, -9, 9, 1.5, 2.5], factor=1.1))
        np.testing.assert_allclose(depths[0], 1000 * self.depths[0])
        for depth, recorded in zip(depths[1:], self.depths[1:]):
            np.testing.assert_allclose(depth, 1000 * recorded * np.where(self.depths[0] > 2.5, 1, 1.1), atol=0.5)

    def test_depth_without_a_true_pose_does_not_pass(self):
        self.sequence.ground_truth.stamps += 10**11
        depths, _ = self.disturbed(disturbance.Beyond(2.5))
        self.assertFalse(np.any(depths))

    def test_images_go_black_for_their_time(self):
        depths, colours = self.disturbed(disturbance.Black(start=0.9, duration=1.1))
        self.assertEqual([colour.any() for colour in colours], [True, False, True, True])
        self.assertEqual([depth.any() for depth in depths], [True, False, True, True])

    def test_regions_of_the_image(self):
        depths, _ = self.disturbed(disturbance.RightHalf())
        self.assertFalse(depths[0][:, WIDTH // 2:].any())
        self.assertTrue(depths[0][:, :WIDTH // 2].all())
        depths, _ = self.disturbed(disturbance.FalseBlock(size=10, nearer=0.5))
        changed = depths[1] != np.rint(1000 * self.depths[1])
        self.assertEqual(changed.sum(), 100)
        self.assertTrue(changed[10:20, 15:25].all())
        np.testing.assert_allclose(depths[1][changed], 1000 * self.depths[1][changed] - 500)
        depths, colours = self.disturbed(disturbance.NoDepth())
        self.assertFalse(np.any(depths))
        self.assertTrue(colours[0].all())

    def test_default_plane_and_box_hold_a_quarter(self):
        points = disturbance.first_points(self.path('plain.bag'), self.sequence)
        self.assertEqual(points.shape, (HEIGHT * WIDTH, 3))
        inside = disturbance.Box(disturbance.default_box(points)).contains(points).mean()
        self.assertTrue(0.15 < inside < 0.35, inside)
        slanted = np.stack([np.zeros(1000), np.zeros(1000), np.linspace(1, 5, 1000)], axis=1)
        self.assertAlmostEqual(disturbance.default_plane(slanted), 4, delta=0.02)

    def test_recorded_depth_is_rectified_as_the_camera_is(self):
        columns = np.tile(1 + 0.001 * np.arange(WIDTH), (HEIGHT, 1))
        write_sequence(self.path('bent'), [(0, 0, 0)], [columns], distortion=[0.3, 0, 0, 0, 0])
        bent = Sequence(self.path('bent'))
        rays = bent.camera.rays()
        self.assertLess(rays[0, 0, 0], 0)
        self.assertGreater(abs(self.sequence.camera.rays()[0, 0, 0]), abs(rays[0, 0, 0]) + 0.01)
        self.assertAlmostEqual(bent.true_depth(10**12)[4, 36], 1.037, places=5)  # x = 0.41 is seen at 0.44
        self.assertTrue(np.isnan(bent.true_depth(10**12)[0, 0]))                 # outside of the recorded image


class Comparisons(InFolder):
    def setUp(self):
        super().setUp()
        depth = np.full((HEIGHT, WIDTH), 2, np.float32)
        self.stamps = write_sequence(self.path('sequence'), [(0, 0, 0)] * 3, [depth] * 3)
        self.sequence = Sequence(self.path('sequence'))
        self.given = np.full((HEIGHT, WIDTH), 2000, np.uint16)
        self.false = self.given.copy()
        self.false[10:20, 10:30] = 2200

    def run_of(self, name, given, sfm, label=0, disagreement=0):
        """Input and output bag of a run whose images stay the same."""
        fill = lambda value, kind: np.broadcast_to(np.asarray(value, kind), given.shape).copy()  # noqa: E731
        write_bag(self.path(name + '_in.bag'), [(disturbance.DEPTH, stamp - 10**7, given, '16UC1')
                                                for stamp in self.stamps])
        write_bag(self.path(name + '.bag'), [
            (topic, stamp, values, encoding) for stamp in self.stamps for topic, values, encoding in (
                ('/tracker/frame', fill(0, np.uint8), 'mono8'), ('/fusion/sfm_depth', fill(sfm, np.float32), '32FC1'),
                ('/fusion/provenance', fill(label, np.uint8), 'mono8'),
                ('/fusion/disagreement', fill(disagreement, np.uint8), 'mono8'))])
        return self.path(name + '_in.bag'), self.path(name + '.bag')

    def test_a_leak_is_found_but_not_what_changes_everywhere(self):
        plain = self.run_of('plain', self.given, 2.0)
        both = self.run_of('both', self.false, 2.1)
        self.assertAlmostEqual(comparisons.leak(plain, both, self.sequence), 0, places=5)
        leaky = self.run_of('leaky', self.false, np.where(self.false == 2200, 2.16, 2.1))
        self.assertAlmostEqual(comparisons.leak(plain, leaky, self.sequence), 2.16 / 2.1 - 1, places=5)

    def test_false_depth_counts_where_there_is_sfm_depth(self):
        plain = self.run_of('plain', self.given, 2.0)
        sfm = np.full((HEIGHT, WIDTH), np.nan)
        sfm[:, :20] = 2
        label, disagreement = np.full((HEIGHT, WIDTH), 2), np.full((HEIGHT, WIDTH), 2)
        label[10:15, 10:15], disagreement[10:15, 10:15] = 3, 0
        found = comparisons.false_depth(plain, self.run_of('false', self.false, sfm, label, disagreement),
                                        self.sequence)
        self.assertEqual(found, {'flagged': 0.75, 'averaged': 0.25, 'sfm_kept': 0.75, 'pixels': 300})

    def test_keyframes_are_compared_bit_by_bit(self):
        images = np.ones((2, HEIGHT, WIDTH), np.float32)
        other = images.copy()
        other[1, 3, 4] = np.nextafter(np.float32(1), np.float32(2))
        for name, values in (('one', images), ('same', images), ('other', other), ('shorter', images[:1])):
            write_bag(self.path(name), [(comparisons.KEYFRAME_TOPICS[0], self.stamps[0], value, '32FC1')
                                        for value in values])
        for name, expected in (('same', (0, 2)), ('other', (1, 2)), ('shorter', (1, 2))):
            self.assertEqual(comparisons.keyframe_difference(self.path('one'), self.path(name)), expected)

    def test_recovery_after_darkness(self):
        with open(self.path('frames.csv'), 'w') as file:
            file.write('stamp,state\n')
            for i in range(30):
                lost = 11 <= i < 23
                file.write(f'{1000 + 0.1 * i:.9f},{"lost" if lost else "tracking"}\n')
        found = comparisons.recovery(self.folder, 1.0 - 1e-6, 1.0)
        self.assertEqual((found['dark_frames'], found['tracked_in_the_dark']), (10, 1))
        self.assertAlmostEqual(found['recovered_after'], 0.3, places=6)


class Report(InFolder):
    def test_runs_are_pooled_by_kind(self):
        runs = [{'plain': ({'ate': ate, 'lost': lost}, None)} for ate, lost in ((0.01, 0), (0.02, 3), (0.06, 1))]
        found = report.pooled(runs)['plain']
        self.assertEqual((found['ate'], found['lost']), (0.02, 4))
        self.assertAlmostEqual(found['ate_worst_to_median'], 3)

    def test_the_table_shows_what_was_before_where_it_differs(self):
        now = {'a': {'plain': {'ate': 0.0204, 'rpe': 0.03}}, 'b': {'plain': {'ate': float('nan')}}}
        lines = report.table(now, {'a': {'plain': {'ate': 0.0221, 'rpe': 0.03}}})
        ate = next(line for line in lines if line.startswith('  ATE [mm]'))
        self.assertIn('20.4 (22.1)', ate)
        self.assertIn('30.0', next(line for line in lines if 'RPE over 1 s [mm]' in line))
        self.assertNotIn('(', next(line for line in lines if 'RPE over 1 s [mm]' in line).replace('[mm]', ''))
        self.assertFalse(any('Leak' in line for line in lines))

    def test_results_of_a_run_can_be_written_and_read(self):
        truth = types.SimpleNamespace(stamps=np.arange(1000, 1100) * 10**9, positions=np.zeros((100, 3)),
                                      rotations=np.tile(np.eye(3), (100, 1, 1)))
        with open(self.path('summary.json'), 'w') as file:
            json.dump({'frames': 9, 'frames_tracked': 0, 'frames_lost': 9, 'keyframes': 0,
                       'timing_ms': {'fusion': {'p50': 2.5}}}, file)
        with open(self.path('trajectory.txt'), 'w') as file:
            file.write('# nothing\n')
        found = motion_score.motion_score(self.folder, truth)
        self.assertEqual(found, {'frames': 9, 'tracked': 0, 'lost': 9, 'keyframes': 0, 'fusion_ms': 2.5})


if __name__ == '__main__':
    unittest.main()
