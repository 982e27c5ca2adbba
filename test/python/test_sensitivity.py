# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""What other values of a constant are tried, and what is said of them."""

import unittest

from rgbd_sfm_fusion.evaluation import sensitivity

BEFORE = [None] * len(sensitivity.FIGURES)
BEFORE[0], BEFORE[2] = 2.0, 38.0  # ATE [mm], SfM before fusion [%]


def figures(ate, share):
    found = list(BEFORE)
    found[0], found[2] = ate, share
    return found


class OtherValues(unittest.TestCase):
    def test_numbers_are_halved_and_doubled(self):
        for value, others in (('0.02F', ['0.01F', '0.04F']), ('32', ['16', '64']), ('1e-3', ['0.0005', '0.002']),
                              ('3', ['2', '6']), ('1', ['2'])):
            self.assertEqual(sensitivity.halved_and_doubled(value), others, value)

    def test_of_a_share_near_one_the_rest_is(self):
        self.assertEqual(sensitivity.halved_and_doubled('0.95'), ['0.975', '0.9'])

    def test_other_texts_keep_their_form(self):
        self.assertEqual(sensitivity.halved_and_doubled('1.0F / 3.0F'), ['(1.0F / 3.0F) / 2', '(1.0F / 3.0F) * 2'])


class Changes(unittest.TestCase):
    def changes(self, found, chance):
        return sensitivity.changes(found, BEFORE, [chance] * len(BEFORE))

    def test_small_ones_and_those_by_chance_do_not_count(self):
        self.assertEqual(self.changes(figures(2.03, 38.4), 0.0), [])
        self.assertEqual(self.changes(figures(2.5, 39.0), 0.4), [])

    def test_others_are_named(self):
        self.assertEqual(self.changes(figures(2.5, 36.0), 0.1), [('ATE [mm]', '2.50'), ('SfM before fusion [%]', '36.0')])


if __name__ == '__main__':
    unittest.main()
