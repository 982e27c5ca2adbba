#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""replay.launch as people type it: a bag's name with spaces, a relative one, none; and a start after the bag's /tf_static."""
import os
import sys

from ros_system import RosSystem, wait_for

FRAMES, PERIOD, WIDTH, HEIGHT = 90, 0.033, 320, 240
OPTICAL = 'camera_rgb_optical_frame'


def make_bag(path):
    """A camera that stands still before a wall; its place on camera_link is sent once, at the start."""
    import numpy as np
    import rosbag
    import rospy
    from geometry_msgs.msg import TransformStamped
    from sensor_msgs.msg import CameraInfo, Image
    from tf2_msgs.msg import TFMessage
    texture = np.kron(np.random.RandomState(1).randint(40, 220, (HEIGHT // 8, WIDTH // 8)), np.ones((8, 8)))
    with rosbag.Bag(path, 'w') as bag:
        for frame in range(FRAMES):
            stamp = rospy.Time.from_sec(1000 + PERIOD * frame)
            info, depth_info, colour, depth = CameraInfo(), CameraInfo(), Image(), Image()
            for message in (info, depth_info, colour, depth):
                message.header.stamp, message.header.frame_id = stamp, OPTICAL
                message.width, message.height = WIDTH, HEIGHT
            for message in (info, depth_info):
                message.K = [260, 0, 159.5, 0, 260, 119.5, 0, 0, 1]
            noise = np.random.RandomState(frame).randint(-2, 3, texture.shape)
            colour.encoding, colour.step, colour.data = 'mono8', WIDTH, (texture + noise).astype(np.uint8).tobytes()
            depth.encoding, depth.step = '16UC1', 2 * WIDTH
            depth.data = np.full((HEIGHT, WIDTH), 2000, np.uint16).tobytes()
            if frame == 0:
                mount = TransformStamped()
                mount.header.stamp, mount.header.frame_id, mount.child_frame_id = stamp, 'camera_link', OPTICAL
                rotation = mount.transform.rotation
                rotation.x, rotation.y, rotation.z, rotation.w = -0.5, 0.5, -0.5, 0.5
                bag.write('/tf_static', TFMessage([mount]), stamp)
            for topic, message in (('rgb/camera_info', info), ('rgb/image_raw', colour),
                                   ('depth_registered/camera_info', depth_info), ('depth_registered/image_raw', depth)):
                bag.write('/camera/' + topic, message, stamp)


def launch(system, *arguments, folder):
    port = os.environ['ROS_MASTER_URI'].rsplit(':', 1)[1]
    return system.start('roslaunch', '-p', port, 'rgbd_sfm_fusion', 'replay.launch', 'rviz:=false', *arguments,
                        cwd=folder, env=dict(os.environ, PWD=folder))


def expect_refusal(system, sentence, *arguments):
    process = launch(system, *arguments, folder=system.folder)
    wait_for(lambda: process.poll() is not None, 60, 'end of a launch that has nothing to play')
    assert sentence in system.log_of(process), system.log_of(process)


def main():
    with RosSystem() as system:
        import rospy
        from tf2_msgs.msg import TFMessage
        expect_refusal(system, 'replay.launch: no bag is named; type roslaunch rgbd_sfm_fusion replay.launch bag:=')
        expect_refusal(system, 'replay.launch: there is no bag ' + system.folder + '/none.bag', 'bag:=none.bag')

        folder = os.path.join(system.folder, "a folder's name")
        os.mkdir(folder)
        make_bag(os.path.join(folder, 'my bag.bag'))
        moved = set()

        def remember(message):
            moved.update(transform.child_frame_id for transform in message.transforms)

        rospy.Subscriber('/tf', TFMessage, remember, queue_size=100)
        process = launch(system, 'bag:=my bag.bag', 'start:=1', 'exit:=true', folder=folder)
        try:
            system.wait_for_fused(30, 60)
            wait_for(lambda: process.poll() is not None, 60, 'end of the launch with its bag')
        except AssertionError:
            print(system.log_of(process))
            raise
        assert moved == {'camera_link'}, 'tf went to %s: /tf_static was not heard of' % moved


if __name__ == '__main__':
    sys.exit(main())
