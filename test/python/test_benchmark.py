# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/benchmark, with a stand-in for the program that measures."""

import json
import os
import subprocess
import unittest

from in_folder import InFolder

SOURCE = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..')

# Each run takes a millisecond longer than the one before. Arguments: BAG --json FILE …
STAND_IN = '''#!/bin/sh
runs=$(cat "$(dirname "$0")/runs" 2>/dev/null || echo 0); runs=$((runs + 1)); echo $runs >"$(dirname "$0")/runs"
times="\\"median\\": $runs, \\"p95\\": 9, \\"p99\\": 9"
echo "$@" >"$(dirname "$0")/arguments"
cat >"$3" <<END
{"frames": 2, "preparation": {$times}, "tracking": {$times}, "mapping": {$times}, "fusion": {$times},
 "OpenCV RgbdOdometry": {$times}, "tracking + mapping / RgbdOdometry": $runs, "the whole / RgbdOdometry": 1$runs,
 "p99 / median of the whole": 2}
END
'''


class Benchmark(InFolder):
    def run_it(self, *arguments):
        return subprocess.run([os.path.join(SOURCE, 'scripts', 'benchmark'), '--tools', self.folder, '--work',
                               self.path('work'), *arguments], capture_output=True, text=True)

    def stand_in(self):
        with open(self.path('recording_benchmark'), 'w') as file:
            file.write(STAND_IN)
        os.chmod(self.path('recording_benchmark'), 0o755)

    def test_keeps_medians_of_several_runs_and_their_range(self):
        self.stand_in()
        done = self.run_it('room.bag', '--repeat', '3', '--frames', '7', '--set', 'complete=off')
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path('work/last.json')) as file:
            cost = json.load(file)['room']['cost']
        self.assertEqual(cost['ratio'], {'tracking_mapping': 2, 'whole': 12, 'p99': 2})  # a bag without depth
        self.assertEqual((cost['from']['whole'], cost['to']['whole']), (11, 13))
        self.assertEqual(cost['ms']['mapping'], 2)
        self.assertTrue(cost['processor'])
        self.assertIn('12.00  (11.00 to 13.00)', done.stdout)
        with open(self.path('arguments')) as file:
            self.assertEqual(file.read().split(), ['room.bag', '--json', self.path('work/run.json'), '--set',
                                                   'complete=off', '--frames', '7'])

    def test_says_what_is_missing(self):
        done = self.run_it('room.bag')
        self.assertEqual(done.returncode, 1)
        self.assertIn('build it (scripts/build -DRGBD_SFM_FUSION_BENCHMARKS=ON)', done.stderr)
        self.assertEqual(done.stderr.count('Traceback'), 0)


if __name__ == '__main__':
    unittest.main()
