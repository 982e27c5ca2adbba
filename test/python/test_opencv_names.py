# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Ubuntu 20.04 is supported, and has OpenCV 4.2: nothing newer may be used."""

import glob
import os
import re
import unittest

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
LIST = os.path.join(os.path.dirname(os.path.realpath(__file__)), 'opencv_4.2_names.txt')


def names_in(text):
    """Names of the namespace cv in C++ code, e.g. `remap` and `Matx33d::eye`."""
    code = re.sub(r'//.*', '', text)
    return set(re.findall(r'\bcv::((?:[A-Za-z_]\w*::)*[A-Za-z_]\w*)', code))


class OpenCvNames(unittest.TestCase):

    def test_are_read_from_code_but_not_from_comments(self):
        self.assertEqual(names_in('cv::Mat_<float> m; f(cv::Matx33d::eye()); // cv::newer()'),
                         {'Mat_', 'Matx33d::eye'})

    def test_are_all_in_version_4_2(self):
        with open(LIST, encoding='utf-8') as lines:
            known = {line.strip() for line in lines if not line.startswith('#')}
        files = [path for folder in ('include', 'src', 'benchmark', 'test', 'examples') for extension in ('h', 'cpp')
                 for path in glob.glob(os.path.join(SOURCE, folder, '**', '*.' + extension), recursive=True)]
        self.assertGreater(len(files), 100)
        for path in files:
            with open(path, encoding='utf-8') as source:
                unknown = names_in(source.read()) - known
            self.assertFalse(unknown, '%s: not known to be in OpenCV 4.2; see %s' % (path, LIST))


if __name__ == '__main__':
    unittest.main()
