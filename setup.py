# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""For catkin only: cmake builds and installs the package."""
from setuptools import setup

from catkin_pkg.python_setup import generate_distutils_setup

setup(**generate_distutils_setup(packages=['rgbd_sfm_fusion', 'rgbd_sfm_fusion.evaluation', 'rgbd_sfm_fusion.page'],
                                 package_dir={'': 'python'}))
