#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Starts and stops tracker and fusion again and again while a camera is publishing already, as on a robot.

usage: test_starts.py [COUNT]   (default 5). Fails at the first start that dies, gives nothing, or ends badly."""
import sys

from ros_system import RosSystem, nodelet, tool

TOPICS = ('rgb/image_raw:=/camera/rgb/image_raw', 'rgb/camera_info:=/camera/rgb/camera_info',
          'depth_registered/image_raw:=/camera/depth_registered/image_raw',
          'depth_registered/camera_info:=/camera/depth_registered/camera_info')


def start_once(system):
    manager = system.start(*nodelet('manager', '__name:=manager'))
    loaders = [system.start(*nodelet('load', 'rgbd_sfm_fusion/' + kind, 'manager', '__name:=' + kind.lower(), *TOPICS))
               for kind in ('Tracker', 'Fusion')]
    try:
        seconds = system.wait_for_fused()
        assert manager.poll() is None, 'the manager died with %d' % manager.returncode
    except AssertionError:
        print(system.log_of(manager))
        raise
    # Loaders first: so nodelets are torn down while messages come, in a manager that runs on. A manager that ends
    # while a loader still lives may end with boost::lock_error, whatever nodelets it has, because a bond calls back
    # into it during its destructor.
    for loader in loaders:
        system.stop(loader)
    status = system.stop(manager)
    assert status == 0, 'the manager ended with %d\n%s' % (status, system.log_of(manager))
    return seconds


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    with RosSystem() as system:
        system.start(tool('fake_camera_node'))
        for i in range(count):
            print('start %d of %d: fused after %.1f s' % (i + 1, count, start_once(system)), flush=True)


if __name__ == '__main__':
    main()
