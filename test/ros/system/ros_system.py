# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""For tests that start, stop and kill: a ROS master of their own, processes around it, and a listener to fused images."""
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time


def free_port():
    with socket.socket() as listener:
        listener.bind(('localhost', 0))
        return listener.getsockname()[1]


class RosSystem:
    """Ends everything that it started when the `with` block ends."""

    def __init__(self):
        self.folder = tempfile.mkdtemp(prefix='rgbd_sfm_fusion_test_')
        os.environ['ROS_MASTER_URI'] = 'http://localhost:%d' % free_port()
        os.environ['ROS_HOME'] = self.folder
        os.environ.setdefault('ROS_HOSTNAME', 'localhost')
        self.processes = []

    def __enter__(self):
        port = os.environ['ROS_MASTER_URI'].rsplit(':', 1)[1]
        self.start('roscore', '-p', port)
        self.connect()
        return self

    def __exit__(self, *_):
        for process in reversed(self.processes):
            self.stop(process)
        subprocess.run(['rm', '-rf', self.folder], check=False)

    def connect(self):
        import rosgraph  # needs the environment that is set above
        wait_for(lambda: rosgraph.Master('/test').is_online(), 20, 'a master')
        import rospy
        from sensor_msgs.msg import Image
        rospy.init_node('system_test', anonymous=True, disable_signals=True)
        self.fused = 0

        def count(_):
            self.fused += 1

        self.subscriber = rospy.Subscriber('/fusion/mean', Image, count, queue_size=10)

    def start(self, *command, **more):
        """Starts a process in a group of its own; its output goes to a file that show_logs() prints."""
        log = open(os.path.join(self.folder, '%d.log' % len(self.processes)), 'w')
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, start_new_session=True, **more)
        self.processes.append(process)
        return process

    def stop(self, process, patience=15):
        """Stops a process as Ctrl-C does. @return the exit status, negative for a signal"""
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGINT)
            try:
                process.wait(patience)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
        return process.returncode

    def log_of(self, process):
        return open(os.path.join(self.folder, '%d.log' % self.processes.index(process)), errors='replace').read()

    def wait_for_fused(self, count=3, patience=30, what='fused images'):
        """@return seconds until `count` more images have come"""
        begin, goal = time.time(), self.fused + count
        wait_for(lambda: self.fused >= goal, patience, what)
        return time.time() - begin


def wait_for(condition, patience, what):
    end = time.time() + patience
    while not condition():
        if time.time() > end:
            raise AssertionError('no %s within %g s' % (what, patience))
        time.sleep(0.02)


def nodelet(*arguments):
    """The command of a nodelet manager or loader, without rosrun around it, so that signals reach it."""
    found = subprocess.run(['catkin_find', '--first-only', '--libexec', 'nodelet', 'nodelet'],
                           stdout=subprocess.PIPE, universal_newlines=True, check=False).stdout.strip()
    for path in (found, '/usr/lib/nodelet/nodelet', '/opt/ros/noetic/lib/nodelet/nodelet'):
        if path and os.access(path, os.X_OK):
            return (path,) + arguments
    sys.exit('cannot find the executable nodelet of package nodelet')


def tool(name):
    """The path of an executable of this package, in the folder of the build or the installation."""
    for prefix in os.environ.get('CMAKE_PREFIX_PATH', '').split(':'):
        path = os.path.join(prefix, 'lib', 'rgbd_sfm_fusion', name)
        if os.access(path, os.X_OK):
            return path
    sys.exit('cannot find %s: source the build\'s setup.bash' % name)
