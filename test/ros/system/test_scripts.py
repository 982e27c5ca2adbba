#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/fuse on what people have, parameters of the launch files, and live.launch on a machine without a display.

usage: test_scripts.py [-k PART_OF_NAME]"""
import csv
import os
import shutil
import subprocess
import tempfile
import unittest

import yaml

from ros_system import RosSystem, tool

SOURCE = os.path.realpath(os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', '..'))
FRAMES = 20


class Fuse(unittest.TestCase):
    """A short recording of the virtual camera, as a bag whose name has a space, and in TUM's layout."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp(prefix='rgbd_sfm_fusion_test_')
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        subprocess.run([tool('render_sequence'), cls.path('sequence'), '--count', str(FRAMES), '--bag',
                        cls.path('my recording.bag')], check=True, stdout=subprocess.DEVNULL)

    @classmethod
    def path(cls, *names):
        return os.path.join(cls.folder, *names)

    def fuse(self, *arguments, **environment):
        env = dict(os.environ, BUILD_DIR=tool('fuse_bag').split('/devel/')[0], **environment)
        return subprocess.run([os.path.join(SOURCE, 'scripts', 'fuse'), *arguments], cwd=self.folder, env=env,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def expect_results(self, folder, result):
        self.assertEqual(result.returncode, 0, result.stdout)
        for line in ('colour /camera/rgb/image_raw, depth /camera/depth_registered/image_raw',
                     f'{FRAMES} frames: {FRAMES} tracked', 'of the pixels with measured depth: sensor only',
                     'of the pixels without sensor depth: refilled', 'stated standard deviation', 'Everything is in ' + folder):
            self.assertIn(line, result.stdout)
        with open(os.path.join(folder, 'frames.csv')) as file:
            self.assertEqual(len(list(csv.DictReader(file))), FRAMES)
        with open(os.path.join(folder, 'trajectory.txt')) as file:
            self.assertEqual(sum(not line.startswith('#') for line in file), FRAMES)
        for name, magic in (('fused.bag', b'#ROSBAG'), ('report.html', b'<!DOCTYPE html>'), ('summary.json', b'{')):
            with open(os.path.join(folder, name), 'rb') as file:
                self.assertEqual(file.read(len(magic)), magic, name)

    def test_of_a_bag(self):
        result = self.fuse('my recording.bag')
        self.expect_results(self.path('my recording_fused'), result)

    def test_of_a_folder_in_tums_layout_and_into_a_chosen_one(self):
        result = self.fuse('sequence', '--set', 'max_range=4', FUSE_DIR=self.path('chosen'))
        self.expect_results(self.path('chosen'), result)
        self.assertFalse(os.path.exists(self.path('sequence_fused')))

    def test_what_it_cannot_do_is_said_in_a_line(self):
        for arguments, text in (([], 'no recording is named'), (['none.bag'], 'there is no none.bag'),
                                (['sequence', 'my recording.bag'], 'sequence is a folder: expected just this one'),
                                (['my recording.bag', '--output', 'x'], '$FUSE_DIR'),
                                (['my recording.bag', '--camera', 'icl'], '--camera is for folders')):
            result = self.fuse(*arguments)
            self.assertEqual(result.returncode, 1, result.stdout)
            self.assertIn(text, result.stdout)
            self.assertEqual(result.stdout.count('\n'), 1, result.stdout)

    def test_what_fuse_bag_refuses_ends_it(self):
        result = self.fuse('my recording.bag', '--set', 'max_range=-1', FUSE_DIR=self.path('refused'))
        self.assertEqual(result.returncode, 1, result.stdout)
        self.assertIn('max_range', result.stdout)
        self.assertNotIn('Everything is in', result.stdout)


class LaunchFiles(unittest.TestCase):
    def parameters(self, *arguments):
        """The parameters that a launch file would set, by `roslaunch --dump-params`, which needs no master."""
        done = subprocess.run(['roslaunch', '--dump-params', 'rgbd_sfm_fusion', *arguments], check=True,
                              stdout=subprocess.PIPE, text=True)
        return yaml.safe_load(done.stdout)

    def test_settings_of_both_files_reach_the_nodelets(self):
        with tempfile.TemporaryDirectory() as folder:
            files = [os.path.join(folder, name) for name in ('mine.yaml', 'expert.yaml')]
            for path, text in zip(files, ('max_range: 4.0\nrim_width: 2\n', 'rim_width: 1\nkeyframe_lost: 0.4\n')):
                with open(path, 'w') as file:
                    file.write(text)
            for launch in (['fusion.launch', 'manager:=m'], ['live.launch'], ['replay.launch', 'bag:=x'], ['demo.launch']):
                found = self.parameters(*launch, 'config:=' + files[0], 'expert_config:=' + files[1])
                for node in ('/tracker/', '/fusion/'):
                    self.assertEqual([found[node + name] for name in ('max_range', 'rim_width', 'keyframe_lost')],
                                     [4.0, 1, 0.4], (launch, node))
                found = self.parameters(*launch, 'config:=' + files[0])
                self.assertEqual(found['/fusion/rim_width'], 2, launch)
                self.assertNotIn('/tracker/keyframe_lost', found, launch)

    def test_registered_depth_is_read_as_depth_image_proc_sends_it(self):
        for launch in (['fusion.launch', 'manager:=m'], ['replay.launch', 'bag:=x']):
            for register, transport in (('true', 'raw'), ('false', 'compressedDepth')):
                found = self.parameters(*launch, 'register_depth:=' + register, 'depth_transport:=compressedDepth')
                self.assertEqual([found[node + 'depth_transport'] for node in ('/tracker/', '/fusion/')], [transport] * 2)


class WithoutADisplay(unittest.TestCase):
    def test_live_launch_says_so_in_a_line_and_goes_on(self):
        with RosSystem() as system:
            environment = {name: value for name, value in os.environ.items() if name != 'DISPLAY'}
            launch = system.start(tool('with_virtual_camera'), 'roslaunch', 'rgbd_sfm_fusion', 'live.launch',
                                  env=environment)
            try:
                system.wait_for_fused(patience=90)
                said = [line for line in system.log_of(launch).splitlines() if 'display' in line]
                self.assertEqual(len(said), 1, said)
                self.assertIn('there is no display: the results are not shown, everything else goes on', said[0])
                system.wait_for_fused()
            except AssertionError:
                print(system.log_of(launch))
                raise


if __name__ == '__main__':
    unittest.main()
