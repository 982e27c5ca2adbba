#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""A running system is stopped for a while, or a part of it is killed: fused images come again by themselves.

usage: test_recovery.py [-k PART_OF_NAME]"""
import glob
import os
import signal
import sys
import time
import unittest
import xml.etree.ElementTree

from ros_system import RosSystem, tool, wait_for

HERE = os.path.dirname(os.path.abspath(__file__))
LAUNCH = os.path.join(HERE, '..', '..', '..', 'launch')
BACK_WITHIN = 60  # [s] a bond's time-out alone is 4 s, and a busy machine is slow; the time that it took is printed


def pids(name):
    """Process ids of this master's nodelet processes that have `__name:=name`."""
    found = []
    for folder in glob.glob('/proc/[0-9]*'):
        try:
            words = open(folder + '/cmdline', 'rb').read().split(b'\0')
            master = open(folder + '/environ', 'rb').read()
        except OSError:
            continue
        if os.environ['ROS_MASTER_URI'].encode() in master and b'__name:=' + name.encode() in words \
                and words[0].endswith(b'nodelet'):
            found.append(int(os.path.basename(folder)))
    return found


class Recovery(unittest.TestCase):
    """One master for all tests, as a process can have only one node. Each test has processes of its own."""

    @classmethod
    def setUpClass(cls):
        cls.system = RosSystem().__enter__()

    @classmethod
    def tearDownClass(cls):
        cls.system.__exit__()

    def setUp(self):
        self.launch = self.system.start('roslaunch', os.path.join(HERE, 'recovery.launch'))

    def tearDown(self):
        self.system.stop(self.camera)
        self.system.stop(self.launch)

    def start_camera(self, *arguments):
        self.camera = self.system.start(tool('fake_camera_node'), *arguments)
        self.system.wait_for_fused(patience=BACK_WITHIN)
        time.sleep(5)  # a bond that is not made yet takes 10 s to break

    def expect_back(self, after):
        seconds = self.system.wait_for_fused(count=10, patience=BACK_WITHIN)
        print('fused again %.1f s after %s' % (seconds, after), file=sys.stderr, flush=True)

    def test_a_manager_that_was_stopped_for_five_seconds(self):
        self.start_camera()
        manager, = pids('fusion_nodelet_manager')
        os.kill(manager, signal.SIGSTOP)
        time.sleep(5)
        os.kill(manager, signal.SIGCONT)
        time.sleep(1)  # messages that were on their way come first
        self.expect_back('a second after it was stopped for 5 s')

    def test_a_manager_that_is_killed(self):
        self.start_camera()
        manager, = pids('fusion_nodelet_manager')
        os.kill(manager, signal.SIGKILL)
        self.expect_back('the manager was killed')

    def test_loaders_that_are_killed(self):
        self.start_camera()
        for name in ('tracker', 'fusion'):
            loader, = pids(name)
            os.kill(loader, signal.SIGKILL)
            time.sleep(4.5)  # the manager notices after 4 s, and unloads what it had loaded
            self.expect_back('4.5 s after the loader of %s was killed' % name)
            wait_for(lambda: len(pids(name)) == 1, BACK_WITHIN, 'loader of ' + name)

    def test_every_round_of_a_loop_starts_anew(self):
        """Stamps begin anew every 40 images, as with `rosbag play --loop`."""
        import rospy
        from rgbd_sfm_fusion.msg import TrackedFrame
        runs = []
        listener = rospy.Subscriber('/tracker/frame', TrackedFrame, lambda m: runs.append(m.run), queue_size=1000)
        self.start_camera('_round:=40')
        wait_for(lambda: len(set(runs)) >= 6, BACK_WITHIN, 'six rounds')
        listener.unregister()
        # 40 images of each round, except for the current round, and for the first, which may have begun before.
        whole = sorted(set(runs))[1:-1]
        for run in whole:
            self.assertGreaterEqual(runs.count(run), 30, 'round %d: %r' % (run, runs))
            self.assertLessEqual(runs.count(run), 40, 'round %d was not told from the next: %r' % (run, runs))


class LaunchFiles(unittest.TestCase):
    def test_every_nodelet_comes_back(self):
        for path in glob.glob(os.path.join(LAUNCH, '*.launch')):
            for node in xml.etree.ElementTree.parse(path).iter('node'):
                if node.get('pkg') == 'nodelet':
                    self.assertEqual(node.get('respawn'), 'true', '%s: %s' % (path, node.get('name')))
                    self.assertNotIn('--no-bond', node.get('args'), path)


if __name__ == '__main__':
    unittest.main(verbosity=2, warnings='ignore')
