# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/fit_fusion and scripts/fit_completion on synthetic images."""

import os
import sys
import unittest

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'python'))
from rgbd_sfm_fusion.evaluation.error_correlation import DISTANCES, ErrorCorrelation  # noqa: E402
from rgbd_sfm_fusion.evaluation.farther_surface import FartherSurface, nearest_farther  # noqa: E402
from rgbd_sfm_fusion.evaluation.surroundings import NEAR, WIDE, agreeing_neighbours  # noqa: E402

NONE = np.nan


def strip(*parts):
    """20 equal rows. Each consists of parts with a width [px] and a depth [m]."""
    row = np.concatenate([np.full(width, depth, np.float32) for width, depth in parts])
    return np.tile(row, (20, 1))


class AgreeingNeighbours(unittest.TestCase):
    def test_those_of_the_same_surface_in_the_image_count(self):
        found = agreeing_neighbours(np.full((20, 30), 2, np.float32), NEAR)
        self.assertEqual((found[10, 15], found[10, 0], found[10, 2], found[0, 0]), (24, 14, 19, 8))

    def test_others_do_not(self):
        found = agreeing_neighbours(strip((15, 2.0), (15, 2.2)), NEAR)
        self.assertEqual(list(found[10, 10:20]), [24, 19, 19, 14, 14, 14, 14, 19, 19, 24])
        found = agreeing_neighbours(strip((15, 2.0), (15, 2.08)), NEAR)
        self.assertTrue((found[4:-4, 4:-4] == 24).all())

    def test_single_depths(self):
        depth = np.full((20, 30), NONE, np.float32)
        depth[10, 10] = depth[10, 11] = depth[12, 14] = 1
        found = agreeing_neighbours(depth, NEAR)
        self.assertEqual((found[10, 10], found[10, 11], found[12, 14]), (1, 0, 1))

    def test_wide_ones_tell_a_band_from_a_surface(self):
        depth = np.full((100, 60), NONE, np.float32)
        depth[40:46] = 1
        self.assertEqual(agreeing_neighbours(depth, WIDE)[42, 30], 4)
        self.assertEqual(agreeing_neighbours(np.ones((100, 60), np.float32), WIDE)[42, 30], 24)


class Correlation(unittest.TestCase):
    def test_of_errors_half_of_which_squares_of_pixels_have_in_common(self):
        random = np.random.default_rng(5)
        common = random.standard_normal((100, 100)).repeat(6, axis=0).repeat(6, axis=1)
        errors = common + random.standard_normal(common.shape)
        errors[random.random(errors.shape) < 0.3] = NONE
        correlation = ErrorCorrelation()
        correlation.add(errors[:300])
        correlation.add(3 * errors[300:])
        expected = [max(0, 1 - distance / 6) / 2 for distance in DISTANCES]
        np.testing.assert_allclose(correlation.by_distance(), expected, atol=0.03)

    def test_without_pairs_there_is_none(self):
        correlation = ErrorCorrelation()
        correlation.add(np.ones((4, 4)))
        np.testing.assert_array_equal(correlation.by_distance(), [1, 1, 1] + [NONE] * (len(DISTANCES) - 3))


class OfFartherSurface(unittest.TestCase):
    def test_the_nearest_farther_depth_counts(self):
        depth = strip((40, 1.0), (10, NONE), (30, 1.5), (30, 3.0))
        distance, step = nearest_farther(depth)
        self.assertEqual((distance[10, 39], distance[10, 31]), (12, 24))
        self.assertTrue(np.isnan(distance[10, 5]) and np.isnan(distance[10, 100]))
        self.assertAlmostEqual(step[10, 39], 0.5)
        self.assertEqual((distance[10, 79], step[10, 79]), (4, 1.0))

    def test_the_probability_is_found_again(self):
        random = np.random.default_rng(1)
        depth = strip((40, 1.0), (40, 2.0)).repeat(20, axis=0)
        distance, _ = nearest_farther(depth)
        is_farther = random.random(depth.shape) < 0.6 * np.exp(-np.nan_to_num(distance, nan=1e9) / 16)
        errors = FartherSurface()
        errors.add(depth, np.where(is_farther, 2.0, depth), depth == 1)
        amplitude, reach = errors.fit()
        self.assertAlmostEqual(amplitude, 0.6, delta=0.1)
        self.assertAlmostEqual(reach, 16, delta=4)


if __name__ == '__main__':
    unittest.main()
