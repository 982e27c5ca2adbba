# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The scripts that launch files run, with stand-ins for rviz and rosbag; and rviz's configuration."""

import ast
import os
import subprocess
import tempfile
import unittest

import yaml

SOURCE = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..')
CONFIG = os.path.join(SOURCE, 'rviz', 'fusion.rviz')


class ScriptTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def stand_in(self, name, body='printf "%s\\n" "$@"'):
        """Makes a program that prints its arguments, one on each line, or runs the given body."""
        with open(self.path(name), 'w') as file:
            file.write('#!/bin/sh\n' + body + '\n')
        os.chmod(self.path(name), 0o755)

    def run_script(self, name, *arguments, **environment):
        env = dict(os.environ, PATH=self.folder.name + ':/usr/bin:/bin', ROS_HOME=self.path('ros'))
        for variable in ('DISPLAY', 'ROS_NAMESPACE'):
            env.pop(variable, None)
        env.update(environment)
        return subprocess.run([os.path.join(SOURCE, 'scripts', name), *arguments], env=env, capture_output=True,
                              text=True)


class ShowRviz(ScriptTest):
    def test_without_a_display_it_says_so_in_a_line_and_is_done(self):
        self.stand_in('rviz')
        result = self.run_script('show_rviz', CONFIG)
        self.assertEqual((result.returncode, result.stdout), (0, ''))
        self.assertIn('no display', result.stderr)
        self.assertEqual(result.stderr.count('\n'), 1)

    def test_without_rviz_it_says_so_in_a_line_and_is_done(self):
        result = self.run_script('show_rviz', CONFIG, DISPLAY=':7', PATH=self.folder.name)
        self.assertEqual((result.returncode, result.stdout), (0, ''))
        self.assertIn('rviz is not installed', result.stderr)
        self.assertEqual(result.stderr.count('\n'), 1)

    def shown(self, *arguments, **environment):
        """Arguments that rviz got, and its configuration."""
        self.stand_in('rviz')
        result = self.run_script('show_rviz', CONFIG, *arguments, DISPLAY=':7', **environment)
        self.assertEqual(result.returncode, 0, result.stderr)
        words = result.stdout.split('\n')
        path = words[words.index('-d') + 1]
        with open(path) as file:
            return words, path, yaml.safe_load(file)

    def test_frames_are_those_of_the_run(self):
        words, _, config = self.shown('--fixed-frame', 'visual_odom', '--camera-frame', 'eye', '__name:=rviz')
        manager = config['Visualization Manager']
        self.assertEqual(manager['Global Options']['Fixed Frame'], 'visual_odom')
        self.assertEqual(manager['Views']['Current']['Target Frame'], 'eye')
        self.assertIn('__name:=rviz', words, "roslaunch's own arguments reach rviz")

    def test_a_bag_that_cannot_be_read_leaves_the_usual_frame(self):
        _, _, config = self.shown(BAGS=self.path('none.bag'))
        self.assertEqual(config['Visualization Manager']['Views']['Current']['Target Frame'],
                         'camera_rgb_optical_frame')

    def test_each_namespace_has_a_configuration_of_its_own(self):
        _, left, _ = self.shown(ROS_NAMESPACE='/left')
        _, right, _ = self.shown(ROS_NAMESPACE='/right')
        self.assertNotEqual(left, right)


class RecordRun(ScriptTest):
    def test_topics_are_written_by_their_full_names(self):
        self.stand_in('rosrun')
        folder = self.path('a/b')
        for namespace, full in (('', '/fusion/mean'), ('/left', '/left/fusion/mean')):
            result = self.run_script('record_run', folder, 'lz4', '/tf', 'fusion/mean', '__name:=recorder',
                                     ROS_NAMESPACE=namespace)
            self.assertEqual(result.returncode, 0, result.stderr)
            words = result.stdout.split()
            self.assertEqual(words[:2], ['rosbag', 'record'])
            self.assertEqual(words[-3:], ['/tf', full, '__name:=recorder'])
            self.assertIn('--lz4', words)
            self.assertIn('about 4 MB a frame', result.stderr)
        self.assertTrue(os.path.isdir(folder))

    def test_without_compression_it_is_offered(self):
        self.stand_in('rosrun')
        self.assertIn('compress:=lz4', self.run_script('record_run', self.path('a'), 'none', '/tf').stderr)

    def test_an_unknown_compression_is_refused(self):
        result = self.run_script('record_run', self.path('a'), 'zip', '/tf')
        self.assertEqual(result.returncode, 1)
        self.assertIn('zip, expected none, lz4 or bz2', result.stderr)

    def test_places_are_as_they_were_typed(self):
        self.stand_in('rosrun')
        for place, folder in (('~/bags', self.path('home/bags')), ('bags', self.path('typed in/bags'))):
            words = self.run_script('record_run', place, 'none', '/tf', HOME=self.path('home'),
                                    BAGS_FOLDER=self.path('typed in')).stdout.splitlines()
            self.assertIn(folder + '/live', words)
            self.assertTrue(os.path.isdir(folder))

    def test_a_bag_is_written_by_its_name(self):
        self.stand_in('rosrun')
        bag = self.path("a folder's name/fused bag.bag")
        words = self.run_script('record_run', bag, 'none', 'fusion/mean').stdout.splitlines()
        self.assertEqual(words[-3:], ['-O', bag, '/fusion/mean'])
        self.assertTrue(os.path.isdir(os.path.dirname(bag)))


class InNamespace(ScriptTest):
    def told(self, *arguments, namespace=''):
        command = ('/usr/bin/python3', '-c', 'import sys; print(sys.argv[1:])', *arguments)
        return ast.literal_eval(self.run_script('in_namespace', *command, ROS_NAMESPACE=namespace).stdout)

    def test_names_are_those_of_the_namespace(self):
        arguments = ('_a:={namespace}odom', '/{namespace}manager', 'x y', '')
        self.assertEqual(self.told(*arguments), ['_a:=odom', '/manager', 'x y', ''])
        self.assertEqual(self.told(*arguments, namespace='/left'), ['_a:=left/odom', '/left/manager', 'x y', ''])
        self.assertEqual(self.told(*arguments, namespace='/robot/left')[0], '_a:=robot/left/odom')

    def test_a_node_further_down_is_in_the_namespace_above(self):
        for namespace, frame in (('/camera', 'odom'), ('/left/camera', 'left/odom')):
            result = self.run_script('in_namespace', '--below', 'camera', 'echo', '{namespace}odom', ROS_NAMESPACE=namespace)
            self.assertEqual(result.stdout.strip(), frame)


class ShellScripts(ScriptTest):
    def test_help_says_what_they_are_for_and_does_nothing(self):
        folder = os.path.join(SOURCE, 'scripts')
        found = 0
        for name in sorted(os.listdir(folder)):
            path = os.path.join(folder, name)
            if not os.path.isfile(path) or name == 'environment.sh':
                continue
            with open(path) as file:
                if 'environment.sh' not in file.read():
                    continue
            for option in ('--help', '-h'):
                result = self.run_script(name, option, BUILD_DIR=self.path('build'))
                self.assertEqual((result.returncode, result.stderr), (0, ''), name)
                self.assertGreater(len(result.stdout), 60, name)
                self.assertNotIn('#', result.stdout.split('\n')[0], name)
            found += 1
        self.assertGreaterEqual(found, 9)
        self.assertFalse(os.path.exists(self.path('build')))


class RegisterDepth(ScriptTest):
    def test_a_missing_package_is_said_with_the_cure(self):
        self.stand_in('rospack', 'exit 1')
        self.stand_in('sleep')
        result = self.run_script('register_depth', 'manager', 'raw')
        self.assertIn('apt install libdepth-image-proc-dev', result.stderr)

    def test_depth_comes_as_it_is_sent(self):
        self.stand_in('rospack', 'exit 0')
        self.stand_in('rosrun')
        for transport in ('raw', 'compressedDepth', 'compressed'):
            words = self.run_script('register_depth', 'manager', transport, '__name:=register_depth').stdout.split()
            self.assertEqual(words[3:], ['depth_image_proc/register', 'manager', f'_image_transport:={transport}',
                                         '__name:=register_depth'])

    def test_a_missing_plug_in_is_said_with_the_cure(self):
        self.stand_in('rospack', '[ "$2" = depth_image_proc ]')
        self.stand_in('rosrun')
        self.stand_in('sleep', 'true')
        for transport, package in (('compressedDepth', 'compressed_depth_image_transport'),
                                   ('compressed', 'compressed_image_transport')):
            result = self.run_script('register_depth', 'manager', transport)
            self.assertEqual(result.stdout, '', 'nothing is loaded')
            self.assertIn(f'the package {package} is not installed', result.stderr)
            self.assertIn('depth_transport:=raw', result.stderr)

    def test_an_unknown_transport_is_refused(self):
        self.stand_in('rospack', 'exit 0')
        self.stand_in('sleep', 'true')
        self.assertIn('"theora", expected raw, compressedDepth or compressed',
                      self.run_script('register_depth', 'manager', 'theora').stderr)


class Configuration(unittest.TestCase):
    def setUp(self):
        with open(CONFIG) as file:
            self.config = yaml.safe_load(file)

    def topics(self, displays):
        for display in displays:
            yield from self.topics(display.get('Displays', []))
            yield from (value for key, value in display.items() if key in ('Topic', 'Image Topic', 'Marker Topic'))

    def test_topics_follow_the_namespace(self):
        topics = list(self.topics(self.config['Visualization Manager']['Displays']))
        self.assertIn('fusion/preview', topics)
        for topic in topics:
            self.assertFalse(topic.startswith('/'), topic)

    def test_the_saved_window_places_the_preview(self):
        state = bytes.fromhex(self.config['Window Geometry']['QMainWindow State'])
        for panel in ('Preview', 'Displays'):
            self.assertIn(panel.encode('utf-16-be'), state)


if __name__ == '__main__':
    unittest.main()
