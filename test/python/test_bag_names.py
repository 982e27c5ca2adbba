# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'python'))
from rgbd_sfm_fusion.bag_names import find_bags  # noqa: E402


class FindBags(unittest.TestCase):

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        for name in ('a.bag', 'b.bag', 'my bag.bag', "it's mine.bag"):
            open(os.path.join(self.folder.name, name), 'w').close()

    def names(self, text):
        return [os.path.relpath(path, self.folder.name) for path in find_bags(text, self.folder.name)]

    def test_takes_one_or_several_in_their_order(self):
        self.assertEqual(self.names('b.bag'), ['b.bag'])
        self.assertEqual(self.names('b.bag  a.bag'), ['b.bag', 'a.bag'])
        self.assertEqual(self.names(''), [])

    def test_takes_names_with_spaces_quoted_or_not(self):
        self.assertEqual(self.names('my bag.bag a.bag'), ['my bag.bag', 'a.bag'])
        self.assertEqual(self.names("'my bag.bag' a.bag"), ['my bag.bag', 'a.bag'])
        self.assertEqual(self.names("it's mine.bag"), ["it's mine.bag"])
        self.assertEqual(self.names("a.bag it's mine.bag"), ['a.bag', "it's mine.bag"])
        self.assertEqual(self.names("'my bag.bag' 'it'\"'\"'s mine.bag'"), ['my bag.bag', "it's mine.bag"])

    def test_takes_absolute_paths(self):
        path = os.path.join(self.folder.name, 'a.bag')
        self.assertEqual(find_bags(path, '/'), [path])

    def test_says_which_one_is_missing(self):
        with self.assertRaisesRegex(FileNotFoundError, 'no bag .*none.bag, and none named .*a.bag none.bag$'):
            self.names('a.bag none.bag')


if __name__ == '__main__':
    unittest.main()
