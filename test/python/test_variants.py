# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""How another value is put in the place of a constant."""

import unittest

from rgbd_sfm_fusion.evaluation import variants

NOISE = 'constexpr float kNoise = 4.0F;  // [grey levels] kNoise = 3 would do\n'
TEXTS = {'one/noise.cpp': NOISE,
         'one/cells.cpp': 'constexpr double kFastest = 0.010, kSlowest = 0.033;\nconstexpr int kCell = 16;\n',
         'two/cells.cpp': 'static constexpr int kCell = 8;\nint other = kCell;\n'}


class Changed(unittest.TestCase):
    def test_the_value_alone_is_another_one(self):
        self.assertEqual(variants.changed(TEXTS, 'kNoise=6.0F')['one/noise.cpp'], NOISE.replace('4.0F', '6.0F'))

    def test_one_of_several_in_a_statement(self):
        changed = variants.changed(TEXTS, 'kSlowest=0.1')['one/cells.cpp']
        self.assertIn('kFastest = 0.010, kSlowest = 0.1;', changed)
        changed = variants.changed(TEXTS, 'kFastest=0.1')['one/cells.cpp']
        self.assertIn('kFastest = 0.1, kSlowest = 0.033;', changed)

    def test_other_files_stay(self):
        changed = variants.changed(TEXTS, 'two/cells:kCell=4')
        self.assertIn('kCell = 4;', changed['two/cells.cpp'])
        self.assertEqual(changed['one/cells.cpp'], TEXTS['one/cells.cpp'])

    def test_a_name_of_several_files_needs_one_of_them(self):
        with self.assertRaisesRegex(ValueError, 'one/cells.cpp, two/cells.cpp'):
            variants.changed(TEXTS, 'kCell=4')

    def test_what_is_not_there_or_no_change_is_said(self):
        with self.assertRaisesRegex(ValueError, 'set in nowhere'):
            variants.changed(TEXTS, 'kOther=4')
        with self.assertRaisesRegex(ValueError, 'expected kName=VALUE'):
            variants.changed(TEXTS, 'kCell')


if __name__ == '__main__':
    unittest.main()
