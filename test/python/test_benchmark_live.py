# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/benchmark_live, as far as it goes without a build."""

import os
import subprocess
import unittest

from in_folder import InFolder

SOURCE = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..')


class BenchmarkLive(InFolder):
    def refusal(self, *arguments):
        done = subprocess.run([os.path.join(SOURCE, 'scripts', 'benchmark_live'), '--build', self.folder, '--work',
                               self.path('work'), *arguments], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.count('\n'), 1, done.stderr)
        return done.stderr

    def test_says_that_there_is_no_bag(self):
        self.assertIn('room.bag: there is no such bag', self.refusal('room.bag'))

    def test_says_that_there_is_no_build(self):
        with open(self.path('room.bag'), 'w'):
            pass
        self.assertIn('build with scripts/build, or say where with --build', self.refusal(self.path('room.bag')))


if __name__ == '__main__':
    unittest.main()
