# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""scripts/evaluate disturbs inputs as it says, and finds just these disturbances again."""

import os
import sys
import unittest

import cv2
import genpy
import numpy as np
from sensor_msgs.msg import Image

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, '..', '..', 'python')]
from in_folder import InFolder  # noqa: E402
from rgbd_sfm_fusion import bags  # noqa: E402
from rgbd_sfm_fusion.evaluation import comparisons, disturbance  # noqa: E402
from rgbd_sfm_fusion.evaluation.workshop import Workshop  # noqa: E402
from rgbd_sfm_fusion.sequence import Sequence  # noqa: E402

WIDTH, HEIGHT = 40, 30


def image_message(values, stamp, encoding):
    message = Image(height=values.shape[0], width=values.shape[1], encoding=encoding,
                    step=values.shape[1] * values.dtype.itemsize, data=values.tobytes())
    message.header.stamp = genpy.Time(stamp // 10**9, stamp % 10**9)
    return message


def write_bag(path, images):
    """@param images  (topic, stamp [ns], values, encoding)"""
    with bags.rosbag.Bag(path, 'w') as bag:
        for topic, stamp, values, encoding in images:
            message = image_message(values, stamp, encoding)
            bag.write(topic, message, message.header.stamp)


def write_sequence(folder, positions, depths, distortion=None):
    """A sequence whose camera looks along z and moves; depth images [m] are 10 ms before colour."""
    os.makedirs(os.path.join(folder, 'depth'))
    stamps = [10**9 * (1000 + i) for i in range(len(positions))]
    with open(os.path.join(folder, 'calib.txt'), 'w') as file:
        file.write(f'40 40 19.5 14.5 {WIDTH} {HEIGHT} 1000\n')
        if distortion:
            file.write('# dist ' + ' '.join(map(str, distortion)) + '\n')
    with open(os.path.join(folder, 'groundtruth.txt'), 'w') as poses, \
            open(os.path.join(folder, 'associations.txt'), 'w') as pairs:
        for i, (stamp, position, depth) in enumerate(zip(stamps, positions, depths)):
            seconds = stamp // 10**9 - 1
            poses.write(f'{seconds}.990 {position[0]} {position[1]} {position[2]} 0 0 0 1\n')
            pairs.write(f'{seconds + 1}.000 rgb/{i}.png {seconds}.990 depth/{i}.png\n')
            cv2.imwrite(os.path.join(folder, 'depth', f'{i}.png'), np.rint(1000 * depth).astype(np.uint16))
    return stamps


class ReducedRates(InFolder):
    def test_keep_every_nth_pair_with_the_same_truth(self):
        depths = [np.full((HEIGHT, WIDTH), 2 + 0.1 * i, np.float32) for i in range(7)]
        stamps = write_sequence(self.path('sequence'), [(0, 0, 0)] * 7, depths)
        source = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..')
        workshop = Workshop(source, self.path('tools'), self.path('inputs'))
        for _ in range(2):  # at first it is made, then it is found
            sequence = workshop.thinned(self.path('sequence'), 3)
            self.assertEqual(sorted(sequence.depth_stamp), stamps[::3])
            for i in (0, 3, 6):
                self.assertAlmostEqual(float(sequence.true_depth(stamps[i])[3, 4]), 2 + 0.1 * i, places=3)
        self.assertEqual(sorted(workshop.thinned(self.path('sequence'), 1).depth_stamp), stamps)


class Disturbances(InFolder):
    def setUp(self):
        super().setUp()
        # The camera moves towards a wall that is at 3 m first; its lower half is 1 m nearer.
        self.depths = []
        for i in range(4):
            depth = np.full((HEIGHT, WIDTH), 3 - 0.5 * i, np.float32)
            depth[HEIGHT // 2:] -= 1
            self.depths.append(depth)
        stamps = write_sequence(self.path('sequence'), [(0, 0, 0.5 * i) for i in range(4)], self.depths)
        self.sequence = Sequence(self.path('sequence'))
        images = []
        for stamp, depth in zip(stamps, self.depths):
            images += [(disturbance.DEPTH, stamp - 10**7, (1000 * depth).astype(np.uint16), '16UC1'),
                       (disturbance.COLOUR, stamp, np.full((HEIGHT, WIDTH), 200, np.uint8), 'mono8')]
        write_bag(self.path('plain.bag'), images)

    def disturbed(self, change):
        """Depth and colour images after it."""
        disturbance.disturb(self.path('plain.bag'), self.path('other.bag'), change, self.sequence)
        with bags.open_bag(self.path('other.bag')) as bag:
            return [[bags.image(message) for _, message, _ in bag.read_messages(topics=[topic])]
                    for topic in (disturbance.DEPTH, disturbance.COLOUR)]

    def test_what_is_beyond_a_plane_of_the_world_is_gone_in_every_image(self):
        depths, colours = self.disturbed(disturbance.Beyond(2.5))
        for depth, recorded in zip(depths, self.depths):
            np.testing.assert_array_equal(depth[:HEIGHT // 2], 0)
            np.testing.assert_allclose(depth[HEIGHT // 2:], 1000 * recorded[HEIGHT // 2:])
        self.assertTrue(all((colour == 200).all() for colour in colours))

    def test_boxes_are_fixed_in_the_world(self):
        depths, _ = self.disturbed(disturbance.Box([-9, 9, -9, 9, 1.5, 2.5]))
        for depth in depths:
            np.testing.assert_array_equal(depth > 0, self.depths[0] > 2.5)
        depths, _ = self.disturbed(disturbance.Box([-9, 9, -9, 9, 1.5, 2.5], factor=1.1))
        np.testing.assert_allclose(depths[0], 1000 * self.depths[0])
        for depth, recorded in zip(depths[1:], self.depths[1:]):
            np.testing.assert_allclose(depth, 1000 * recorded * np.where(self.depths[0] > 2.5, 1, 1.1), atol=0.5)

    def test_depth_without_a_true_pose_does_not_pass(self):
        self.sequence.ground_truth.stamps += 10**11
        depths, _ = self.disturbed(disturbance.Beyond(2.5))
        self.assertFalse(np.any(depths))

    def test_images_go_black_for_their_time(self):
        depths, colours = self.disturbed(disturbance.Black(start=0.9, duration=1.1))
        self.assertEqual([colour.any() for colour in colours], [True, False, True, True])
        self.assertEqual([depth.any() for depth in depths], [True, False, True, True])

    def test_regions_of_the_image(self):
        depths, _ = self.disturbed(disturbance.RightHalf())
        self.assertFalse(depths[0][:, WIDTH // 2:].any())
        self.assertTrue(depths[0][:, :WIDTH // 2].all())
        depths, _ = self.disturbed(disturbance.FalseBlock(size=10, nearer=0.5))
        changed = depths[1] != np.rint(1000 * self.depths[1])
        self.assertEqual(changed.sum(), 100)
        self.assertTrue(changed[10:20, 15:25].all())
        np.testing.assert_allclose(depths[1][changed], 1000 * self.depths[1][changed] - 500)
        depths, colours = self.disturbed(disturbance.NoDepth())
        self.assertFalse(np.any(depths))
        self.assertTrue(colours[0].all())

    def test_default_plane_and_box_hold_a_quarter(self):
        points = disturbance.first_points(self.path('plain.bag'), self.sequence)
        self.assertEqual(points.shape, (HEIGHT * WIDTH, 3))
        inside = disturbance.Box(disturbance.default_box(points)).contains(points).mean()
        self.assertTrue(0.15 < inside < 0.35, inside)
        slanted = np.stack([np.zeros(1000), np.zeros(1000), np.linspace(1, 5, 1000)], axis=1)
        self.assertAlmostEqual(disturbance.default_plane(slanted), 4, delta=0.02)

    def test_recorded_depth_is_rectified_as_the_camera_is(self):
        columns = np.tile(1 + 0.001 * np.arange(WIDTH), (HEIGHT, 1))
        write_sequence(self.path('bent'), [(0, 0, 0)], [columns], distortion=[0.3, 0, 0, 0, 0])
        bent = Sequence(self.path('bent'))
        rays = bent.camera.rays()
        self.assertLess(rays[0, 0, 0], 0)
        self.assertGreater(abs(self.sequence.camera.rays()[0, 0, 0]), abs(rays[0, 0, 0]) + 0.01)
        self.assertAlmostEqual(bent.true_depth(10**12)[4, 36], 1.037, places=5)  # x = 0.41 is seen at 0.44
        self.assertTrue(np.isnan(bent.true_depth(10**12)[0, 0]))                 # outside of the recorded image


class Comparisons(InFolder):
    def setUp(self):
        super().setUp()
        depth = np.full((HEIGHT, WIDTH), 2, np.float32)
        self.stamps = write_sequence(self.path('sequence'), [(0, 0, 0)] * 3, [depth] * 3)
        self.sequence = Sequence(self.path('sequence'))
        self.given = np.full((HEIGHT, WIDTH), 2000, np.uint16)
        self.false = self.given.copy()
        self.false[10:20, 10:30] = 2200

    def run_of(self, name, given, sfm, label=0, disagreement=0):
        """Input and output bag of a run whose images stay the same."""
        fill = lambda value, kind: np.broadcast_to(np.asarray(value, kind), given.shape).copy()  # noqa: E731
        write_bag(self.path(name + '_in.bag'), [(disturbance.DEPTH, stamp - 10**7, given, '16UC1')
                                                for stamp in self.stamps])
        write_bag(self.path(name + '.bag'), [
            (topic, stamp, values, encoding) for stamp in self.stamps for topic, values, encoding in (
                ('/tracker/frame', fill(0, np.uint8), 'mono8'), ('/fusion/sfm_depth', fill(sfm, np.float32), '32FC1'),
                ('/fusion/provenance', fill(label, np.uint8), 'mono8'),
                ('/fusion/disagreement', fill(disagreement, np.uint8), 'mono8'))])
        return self.path(name + '_in.bag'), self.path(name + '.bag')

    def test_a_leak_is_found_but_not_what_changes_everywhere(self):
        plain = self.run_of('plain', self.given, 2.0)
        both = self.run_of('both', self.false, 2.1)
        self.assertAlmostEqual(comparisons.leak(plain, both, self.sequence), 0, places=5)
        leaky = self.run_of('leaky', self.false, np.where(self.false == 2200, 2.16, 2.1))
        self.assertAlmostEqual(comparisons.leak(plain, leaky, self.sequence), 2.16 / 2.1 - 1, places=5)

    def test_false_depth_counts_where_there_is_sfm_depth(self):
        plain = self.run_of('plain', self.given, 2.0)
        sfm = np.full((HEIGHT, WIDTH), np.nan)
        sfm[:, :20] = 2
        label, disagreement = np.full((HEIGHT, WIDTH), 2), np.full((HEIGHT, WIDTH), 2)
        label[10:15, 10:15], disagreement[10:15, 10:15] = 3, 0
        found = comparisons.false_depth(plain, self.run_of('false', self.false, sfm, label, disagreement),
                                        self.sequence)
        in_middle = found.pop('averaged_in_middle')
        self.assertEqual(found, {'flagged': 0.75, 'averaged': 0.25, 'sfm_kept': 0.75, 'pixels': 300})
        self.assertTrue(np.isnan(in_middle))  # the block is too small for a pixel 8 px inside it

    def test_the_middle_of_a_block_is_8_px_inside(self):
        block = np.zeros((50, 60), bool)
        block[5:35, 10:50] = True
        around = ~block
        block[20, 30] = False  # no sensor depth to falsify
        middle = comparisons._middle(block, around)
        self.assertEqual(middle.sum(), 14 * 24 - 1)
        self.assertEqual(middle[13:27, 18:42].sum(), middle.sum())
        around[20, 30] = True  # unchanged depth may be moved to any pixel nearby
        middle = comparisons._middle(block, around)
        self.assertEqual(middle.sum(), 14 * (24 - 17))

    def test_keyframes_are_compared_bit_by_bit(self):
        images = np.ones((2, HEIGHT, WIDTH), np.float32)
        other = images.copy()
        other[1, 3, 4] = np.nextafter(np.float32(1), np.float32(2))
        for name, values in (('one', images), ('same', images), ('other', other), ('shorter', images[:1])):
            write_bag(self.path(name), [(comparisons.KEYFRAME_TOPICS[0], self.stamps[0], value, '32FC1')
                                        for value in values])
        for name, expected in (('same', (0, 2)), ('other', (1, 2)), ('shorter', (1, 2))):
            self.assertEqual(comparisons.keyframe_difference(self.path('one'), self.path(name)), expected)

    def test_recovery_after_darkness(self):
        with open(self.path('frames.csv'), 'w') as file:
            file.write('stamp,state\n')
            for i in range(30):
                lost = 11 <= i < 23
                file.write(f'{1000 + 0.1 * i:.9f},{"lost" if lost else "tracking"}\n')
        found = comparisons.recovery(self.folder, 1.0 - 1e-6, 1.0)
        self.assertEqual((found['dark_frames'], found['tracked_in_the_dark']), (10, 1))
        self.assertAlmostEqual(found['recovered_after'], 0.3, places=6)


if __name__ == '__main__':
    unittest.main()
