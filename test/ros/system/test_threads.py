#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Tracker and fusion under the thread sanitizer: started while a camera publishes, reconfigured ten times and reset
once a second while stamps loop, and stopped; several times over. Fails if a report is of our code.

usage: test_threads.py [ROUNDS]   (default 2)
Needs a build with -DRGBD_SFM_FUSION_SANITIZE=thread whose setup.bash is sourced; scripts/thread_sanitizer does both."""
import glob
import os
import re
import subprocess
import sys
import time

from ros_system import RosSystem, nodelet, tool
from test_starts import TOPICS

SOURCE = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', '..'))


def is_ours(report):
    """Whether one of the two accesses goes through a source file of ours. A message that roscpp makes and deletes, by
    templates in our library and by code that is not instrumented, looks like a race too, and is none of ours."""
    accesses = re.split(r'\n +(?:Location is|Mutex |Thread T)', report)[0]
    return re.search(re.escape(SOURCE) + '/(src|include)/', accesses) is not None


def sanitizer_library():
    return subprocess.run(['gcc', '-print-file-name=libtsan.so'], stdout=subprocess.PIPE, universal_newlines=True,
                          check=True).stdout.strip()


def disturb(seconds):
    import dynamic_reconfigure.client
    import rospy
    from std_srvs.srv import Trigger
    fusion = dynamic_reconfigure.client.Client('/fusion', timeout=60)
    tracker = dynamic_reconfigure.client.Client('/tracker', timeout=60)
    reset = rospy.ServiceProxy('/tracker/reset', Trigger)
    end = time.time() + seconds
    count = 0
    while time.time() < end:
        begin = time.time()
        fusion.update_configuration({'rim_width': count % 5, 'max_range': 4.0 + count % 3})
        tracker.update_configuration({'keyframe_distance': 0.1 + 0.01 * (count % 10)})
        if count % 10 == 0:
            reset()
        count += 1
        time.sleep(max(0.0, 0.1 - (time.time() - begin)))


def run_once(system, reports):
    environment = dict(os.environ, LD_PRELOAD=sanitizer_library(),
                       TSAN_OPTIONS='log_path=%s ignore_noninstrumented_modules=1 detect_deadlocks=0' % reports)
    manager = system.start(*nodelet('manager', '__name:=manager'), env=environment)
    loaders = [system.start(*nodelet('load', 'rgbd_sfm_fusion/' + kind, 'manager', '__name:=' + kind.lower(), *TOPICS))
               for kind in ('Tracker', 'Fusion')]
    try:
        system.wait_for_fused(patience=120)
        disturb(20)
        system.wait_for_fused(patience=120)
    except AssertionError:
        print(system.log_of(manager))
        raise
    for loader in loaders:
        system.stop(loader, patience=60)
    status = system.stop(manager, patience=60)
    assert status in (0, 66), 'the manager ended with %d\n%s' % (status, system.log_of(manager))  # 66: reports


def main():
    with RosSystem() as system:
        system.start(tool('fake_camera_node'), '_round:=100')
        reports = os.path.join(system.folder, 'reports')
        for i in range(int(sys.argv[1]) if len(sys.argv) > 1 else 2):
            run_once(system, reports)
            print('round %d is over' % (i + 1), flush=True)
        texts = [open(path, errors='replace').read() for path in glob.glob(reports + '*')]
        ours = [part for text in texts for part in text.split('==================') if is_ours(part)]
        print('%d reports, %d of them of our code' % (sum(t.count('WARNING: ThreadSanitizer') for t in texts), len(ours)))
        if ours:
            sys.exit('\n'.join(ours[:5]))


if __name__ == '__main__':
    main()
