# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs as plain files."""

import os
import resource
import sys
import unittest

import cv2
import numpy as np

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, '..', '..', 'python')]
import synthetic_run as synthetic  # noqa: E402
from rgbd_sfm_fusion import export, sequence, tum  # noqa: E402
from test_report import ToolTest  # noqa: E402


def read_ply(path):
    with open(path, 'rb') as file:
        head, body = file.read().split(b'end_header\n', 1)
    count = int([line.split()[2] for line in head.splitlines() if line.startswith(b'element vertex')][0])
    points = np.frombuffer(body, export.POINT)
    assert len(points) == count
    return points


class ExportedRun(ToolTest):
    def exported(self, *arguments):
        done = self.run_tool('export_run', self.bag, 'out', *arguments)
        self.assertEqual((done.returncode, done.stderr), (0, ''))
        return done.stdout

    def test_images_are_those_of_the_run(self):
        self.exported()
        expected = synthetic.images_of(3)
        stamp = tum.seconds_text(synthetic.STAMPS[3])
        depth = cv2.imread(self.path(f'out/depth/{stamp}.png'), cv2.IMREAD_UNCHANGED)
        self.assertEqual(depth.dtype, np.uint16)
        mean = expected['/fusion/mean'][0]
        np.testing.assert_allclose(depth / 5000, np.nan_to_num(mean), atol=1.01e-4)
        sigma = cv2.imread(self.path(f'out/sigma/{stamp}.tiff'), cv2.IMREAD_UNCHANGED)
        self.assertEqual(sigma.dtype, np.float32)
        np.testing.assert_allclose(sigma, np.sqrt(expected['/fusion/variance'][0]))
        label = cv2.imread(self.path(f'out/provenance/{stamp}.png'), cv2.IMREAD_UNCHANGED)
        np.testing.assert_array_equal(label, expected['/fusion/provenance'][0])
        colour = cv2.imread(self.path(f'out/rgb/{stamp}.png'))[..., ::-1]
        np.testing.assert_array_equal(colour, synthetic.colour_image(3))

    def test_it_is_a_sequence_as_the_benchmark_has_them(self):
        self.exported()
        for name in ('rgb.txt', 'depth.txt', 'associations.txt'):
            self.assertEqual(len(tum.rows(self.path('out/' + name))), synthetic.FRAMES)
        camera = sequence.Camera(self.path('out/calib.txt'))
        self.assertEqual((camera.size, camera.depth_scale), ((synthetic.WIDTH, synthetic.HEIGHT), 5000))
        truth = tum.DepthTruth(self.path('out'))
        np.testing.assert_allclose(np.nanmedian(truth[synthetic.STAMPS[2]]), 2)

    def test_points_and_poses_are_in_metres(self):
        self.exported('--point-step', '1', '--point-frames', '2')
        trajectory = tum.Trajectory.read(self.path('out/trajectory.txt'))
        np.testing.assert_allclose(trajectory.positions[-1], [1.01 * synthetic.SPEED * 7, 0, 0], atol=1e-8)
        points = read_ply(self.path('out/points.ply'))
        expected = []
        for i in (0, synthetic.FRAMES - 1):
            images = synthetic.images_of(i)
            mean = images['/fusion/mean'][0].astype(np.float64)
            y, x = np.nonzero(np.isfinite(mean))
            z = mean[y, x]
            expected.append(np.stack([(x - 31.5) / 50 * z + trajectory.positions[i, 0], (y - 23.5) / 50 * z, z,
                                      images['/fusion/provenance'][0][y, x], synthetic.colour_image(i)[y, x, 2]], axis=1))
        got = np.stack([points[name] for name in ('x', 'y', 'z', 'source', 'blue')], axis=1)
        np.testing.assert_allclose(got, np.concatenate(expected), atol=1e-5)
        np.testing.assert_allclose(points['sigma'], synthetic.SIGMA, rtol=1e-6)

    def test_depth_beyond_16_bits_is_left_out_and_said(self):
        said = self.exported('--depth-scale', '40000')  # 1.64 m
        self.assertIn('depth beyond 1.6 m are left out', said)
        depth = cv2.imread(self.path(f'out/depth/{tum.seconds_text(synthetic.STAMPS[0])}.png'), cv2.IMREAD_UNCHANGED)
        self.assertEqual(depth.max(), 0)

    def test_a_folder_that_exists_is_left_alone(self):
        os.makedirs(self.path('out'))
        self.refused('out is there already', 'export_run', self.bag, 'out')
        self.assertEqual(os.listdir(self.path('out')), [])

    def test_without_colour_images_the_cure_is_said(self):
        os.remove(self.given)
        done = self.run_tool('export_run', self.bag, 'out')
        self.assertEqual(done.returncode, 1)
        self.assertIn('name it with --input BAG', done.stderr)
        self.refused('has no messages of /camera/rgb/image_raw', 'export_run', self.bag, 'out', '--input', self.bag)
        self.assertFalse(os.path.exists(self.path('out')))

    def test_a_full_disk_leaves_nothing(self):
        self.refused('cannot write out: File too large', 'export_run', self.bag, 'out', '--point-step', '1',
                     preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000)))
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith('out')], [])


class EvaluatedRun(ToolTest):
    def test_json_and_csv_say_what_the_text_says(self):
        import csv
        import json
        synthetic.write_truth(self.path('truth'))
        done = self.run_tool('evaluate_run', self.bag, '--truth', 'truth', '--json', 'all.json', '--csv', 'errors.csv')
        self.assertEqual((done.returncode, done.stderr), (0, ''))
        with open(self.path('all.json')) as file:
            found = json.load(file)
        self.assertAlmostEqual(found['shares']['refilled'], 100 * 10 / 21)
        self.assertEqual(found['truth'], 'exact')
        with open(self.path('errors.csv')) as file:
            rows = {(row['source'], row['place']): row for row in csv.DictReader(file)}
        self.assertAlmostEqual(float(rows['SfM only', 'outside mirrors']['rmse']), synthetic.SFM_ERROR, delta=0.002)
        self.assertIn('refilled: 47.6 %', done.stdout)
        self.assertIn('SfM only', done.stdout)

    def test_of_a_recorded_sequence_it_says_nothing_that_means_nothing(self):
        synthetic.write_recorded(self.path('truth'))
        done = self.run_tool('evaluate_run', self.bag, '--truth', 'truth')
        self.assertEqual((done.returncode, done.stderr), (0, ''))
        self.assertNotIn('nan', done.stdout)
        self.assertNotIn(' 0.0 mm  ', done.stdout)
        self.assertIn('The true depth is recorded', done.stdout)

    def test_exact_depth_needs_no_masks(self):
        synthetic.write_sequence(self.path('truth'), np.full((synthetic.HEIGHT, synthetic.WIDTH), 2.01))
        done = self.run_tool('evaluate_run', self.bag, '--truth', 'truth')
        self.assertEqual((done.returncode, done.stderr), (0, ''))
        self.assertIn('sensor only                           10.0 mm', done.stdout)

    def test_bad_input_is_refused(self):
        self.refused('has no groundtruth.txt', 'evaluate_run', self.bag, '--truth', 'results')
        self.refused('cannot write x/all.json: there is no folder x', 'evaluate_run', self.bag, '--json', 'x/all.json')
        self.assertEqual(self.run_tool('evaluate_run', self.bag, '--every', '0').returncode, 2)


if __name__ == '__main__':
    unittest.main()
