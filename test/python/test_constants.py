# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""What is taken for a constant, and what for a number that follows from one."""

import unittest

from rgbd_sfm_fusion.evaluation import constants

TEXT = '''
constexpr float kNoise = 4.0F, kShare = 0.25F;
static constexpr int kBorder = 2 * kRadius + 1;
constexpr float kShared = 1.0F / (kPattern + 1);
constexpr double kSlow = 1.5 * kFast;
constexpr double kLater = 12 * kFast;
constexpr int kTwo = 2;
constexpr int kCell = Other::kRows;
'''


class Constants(unittest.TestCase):
    def test_sums_and_multiples_of_constants_follow(self):
        self.assertEqual(constants.following(TEXT), ['kBorder', 'kShared'])

    def test_a_number_of_its_own_is_a_constant_also_beside_another_one(self):
        self.assertEqual(constants.independent(TEXT), ['kNoise', 'kShare', 'kSlow', 'kLater', 'kTwo'])


if __name__ == '__main__':
    unittest.main()
