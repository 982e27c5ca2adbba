# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Runs are read as they were written, and with the help of their indices."""

import contextlib
import io
import os
import sys
import unittest

import genpy.dynamic
import numpy as np
import rosbag

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, '..', '..', 'python')]
import synthetic_run as synthetic  # noqa: E402
from in_folder import InFolder  # noqa: E402
from rgbd_sfm_fusion import bags, recordings, runs  # noqa: E402


class Reading(InFolder):
    def setUp(self):
        super().setUp()
        self.given, self.bag, self.results = synthetic.write_all(self.folder)

    def test_frames_are_as_written_whichever_way_they_are_read(self):
        with runs.Run(self.bag) as run:
            self.assertEqual(len(run), synthetic.FRAMES)
            self.assertEqual(run.size, (synthetic.WIDTH, synthetic.HEIGHT))
            all_of_them = list(run.frames())
            for i in (0, 3, 7):
                expected = synthetic.images_of(i)
                for frame in (run.frame(i), all_of_them[i]):
                    self.assertEqual(frame.stamp, synthetic.STAMPS[i])
                    np.testing.assert_array_equal(frame.mean, expected['/fusion/mean'][0])
                    np.testing.assert_array_equal(frame.provenance, expected['/fusion/provenance'][0])
                    np.testing.assert_allclose(np.nanmax(frame.sigma), synthetic.SIGMA, rtol=1e-6)
                    self.assertIsNone(frame.image)
                    np.testing.assert_allclose(frame.T_world_camera[:3, 3], [synthetic.SPEED * i, 0, 0])
            self.assertEqual([frame.stamp for frame in run.frames(every=3)], synthetic.STAMPS[::3])
            self.assertEqual(run.depth_stamp(2), synthetic.STAMPS[2])

    def test_points_are_where_depth_puts_them(self):
        with runs.Run(self.bag) as run:
            points = run.frame(0).points(run.K)
            np.testing.assert_allclose(points[10, 50], [(50 - 31.5) / 50 * 2, (10 - 23.5) / 50 * 2, 2], rtol=1e-6)

    def test_bag_and_results_find_each_other(self):
        with runs.Run(self.results) as run:
            self.assertEqual(os.path.realpath(run.path), os.path.realpath(self.bag))
        with runs.Run(self.bag) as run:
            self.assertEqual(os.path.realpath(run.results), os.path.realpath(self.results))

    def test_several_runs_in_a_folder_go_by_their_names(self):
        for name in ('one', 'other'):
            synthetic.write_bag(self.path(name + '.bag'))
            synthetic.write_results(self.path(name), self.given)
        for name in ('one', 'other'):
            with runs.Run(self.path(name)) as by_results, runs.Run(self.path(name + '.bag')) as by_bag:
                self.assertEqual(by_results.path, self.path(name + '.bag'))
                self.assertEqual(by_bag.results, self.path(name))

    def test_results_of_another_run_are_refused(self):
        with open(os.path.join(self.results, 'frames.csv')) as file:
            lines = file.readlines()
        with open(os.path.join(self.results, 'frames.csv'), 'w') as file:
            file.writelines(lines[:-1])
        with self.assertRaisesRegex(ValueError, 'is of 7 frames, but .* has 8'):
            runs.Run(self.bag)

    def test_a_bag_of_something_else_is_refused_with_what_it_has(self):
        with self.assertRaisesRegex(ValueError, 'no messages of /fusion/mean.*it has /camera'):
            runs.Run(self.given)

    def test_the_example_of_the_documentation_runs(self):
        example = runs.__doc__.split(':\n', 1)[1]
        self.assertLessEqual(len(example.strip().splitlines()), 10)
        lines = [line[4:] for line in example.splitlines()]
        before = os.getcwd()
        os.chdir(self.folder)
        self.addCleanup(os.chdir, before)
        with contextlib.redirect_stdout(io.StringIO()) as said:
            exec('\n'.join(lines), {})  # noqa: S102
        self.assertIn(str(np.float32(synthetic.SIGMA)), said.getvalue())


class LiveRecording(InFolder):
    """A live run: no folder of results, and messages were recorded some time after their stamps."""

    LAG = 3 * 10**8

    def message_type(self, name):
        source = os.path.join(HERE, '..', '..', 'msg', name + '.msg')
        with open(source) as file:
            text = file.read()
        parts = {'std_msgs/Header': 'uint32 seq\ntime stamp\nstring frame_id\n',
                 'geometry_msgs/Transform': 'geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n',
                 'geometry_msgs/Vector3': 'float64 x\nfloat64 y\nfloat64 z\n',
                 'geometry_msgs/Quaternion': 'float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n'}
        for part, definition in parts.items():
            text += '=' * 80 + f'\nMSG: {part}\n{definition}'
        return genpy.dynamic.generate_dynamic('rgbd_sfm_fusion/' + name, text)['rgbd_sfm_fusion/' + name]

    def write(self, without_mean=None, late=0):
        """@param without_mean  index of a frame whose mean is not in the bag
        @param late  [ns] all frames but the first are recorded so much later"""
        Scale, TrackedFrame = self.message_type('Scale'), self.message_type('TrackedFrame')
        with rosbag.Bag(self.path('live.bag'), 'w') as bag:
            for i, stamp in enumerate(synthetic.STAMPS):
                time = synthetic.time_of(stamp + self.LAG + (late if i else 0))
                scale, tracked = Scale(scale=1.5), TrackedFrame(state=1)
                scale.header.stamp = tracked.header.stamp = synthetic.time_of(stamp)
                bag.write('/fusion/scale', scale, time)
                bag.write('/tracker/frame', tracked, time)
                for topic, (values, encoding) in synthetic.images_of(i).items():
                    if i != without_mean or topic != '/fusion/mean':
                        bag.write(topic, synthetic.image_message(values, stamp, encoding), time)

    def test_has_no_frame_that_is_not_whole(self):
        self.write(without_mean=5)
        with runs.Run(self.path('live.bag')) as run:
            self.assertEqual(len(run), synthetic.FRAMES - 1)
            self.assertEqual(run.frame(5).stamp, synthetic.STAMPS[6])

    def test_is_read_by_stamps(self):
        self.write()
        with runs.Run(self.path('live.bag')) as run:
            self.assertIsNone(run.results)
            self.assertEqual(len(run), synthetic.FRAMES)
            frame = run.frame(5)
            self.assertEqual((frame.state, frame.alpha), ('tracking', 1.5))
            np.testing.assert_array_equal(frame.mean, synthetic.images_of(5)['/fusion/mean'][0])

    def test_a_busy_machine_records_late(self):
        self.write(late=20 * 10**9)
        with runs.Run(self.path('live.bag')) as run:
            self.assertEqual(run.frame(5).stamp, synthetic.STAMPS[5])


class Recordings(InFolder):
    def test_images_come_by_their_stamps_rectified(self):
        synthetic.write_input(self.path('plain.bag'))
        synthetic.write_input(self.path('curved.bag'), distortion=(0.2, 0.0, 0.0, 0.0, 0.0))
        with recordings.Recording([self.path('plain.bag')]) as plain, \
                recordings.Recording([self.path('curved.bag')]) as curved:
            stamp = synthetic.STAMPS[4]
            np.testing.assert_array_equal(plain.colour(stamp + 10**7), synthetic.colour_image(4))
            self.assertIsNone(plain.colour(stamp + 4 * 10**7))
            depth = plain.depth(stamp, tolerance=0)
            self.assertTrue(np.isnan(depth[:, synthetic.HOLE]).all())
            np.testing.assert_allclose(depth[:, 21:], 2)
            # Barrel distortion: points at the rim of the raw image are farther out in the rectified image.
            holes = [np.isnan(of.depth(stamp)[24]).sum() for of in (plain, curved)]
            self.assertNotEqual(*holes)

    def test_a_missing_topic_is_named(self):
        synthetic.write_input(self.path('in.bag'))
        with self.assertRaisesRegex(ValueError, 'no messages of /x; it has /camera'):
            recordings.Recording([self.path('in.bag')], colour='/x')

    def test_images_that_are_rectified_by_their_name_are_not_rectified_again(self):
        for name, rectified in (('/camera/rgb/image_rect_color', True), ('/camera/rgb/image_rect_color/compressed', True),
                                ('/rect/image_raw', False), ('/camera/rgb/image_raw/compressed', False),
                                ('/camera/depth_registered/sw_registered/image_rect', True)):
            self.assertEqual(recordings.is_rectified(name), rectified, name)
        synthetic.write_input(self.path('curved.bag'), distortion=(0.2, 0.0, 0.0, 0.0, 0.0))
        with rosbag.Bag(self.path('named.bag'), 'w') as named:
            with rosbag.Bag(self.path('curved.bag')) as curved:
                for topic, message, time in curved.read_messages():
                    named.write(topic.replace('rgb/image_raw', 'rgb/image_rect_color'), message, time)
        with recordings.Recording([self.path('named.bag')], colour='/camera/rgb/image_rect_color') as named:
            self.assertTrue((named.colour(synthetic.STAMPS[3]) == synthetic.colour_image(3)).all())

    def test_saturated_depth_is_none(self):
        synthetic.write_input(self.path('in.bag'))
        with recordings.Recording([self.path('in.bag')], saturated=synthetic.DEPTH) as recording:
            self.assertTrue(np.isnan(recording.depth(synthetic.STAMPS[0])).all())

    def test_a_calibration_that_is_not_there_is_named(self):
        synthetic.write_input(self.path('in.bag'))
        with self.assertRaisesRegex(ValueError, 'no calibration .*none.yaml'):
            recordings.Recording([self.path('in.bag')], calibration=self.path('none.yaml'))


class Finding(InFolder):
    def test_reads_only_what_is_near(self):
        synthetic.write_input(self.path('in.bag'))
        with bags.open_bag(self.path('in.bag')) as bag:
            finder = bags.Finder(bag, ['/camera/rgb/image_raw', '/not/there'])
            self.assertEqual(finder.topics, ['/camera/rgb/image_raw'])
            message = finder.nearest('/camera/rgb/image_raw', synthetic.STAMPS[3] - 10**7, 2 * 10**7)
            self.assertEqual(bags.stamp_of(message), synthetic.STAMPS[3])
            self.assertIsNone(finder.nearest('/not/there', synthetic.STAMPS[3]))
            self.assertEqual(finder.at(synthetic.STAMPS[3] + 1), {})


if __name__ == '__main__':
    unittest.main()
