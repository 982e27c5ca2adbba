# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""check_docs on small packages with one fault each, and what it reads from this package."""

import json
import os
import subprocess
import sys
import tempfile
import unittest

SOURCE = os.path.realpath(os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..'))
sys.path.insert(0, os.path.join(SOURCE, 'scripts'))
from doc_checks import checks, citations, figures, pages, written  # noqa: E402
from doc_checks.tree import Tree  # noqa: E402

PACKAGE = {
    'src/nodelets/tracker_nodelet.cpp': '#include "poses.h"\nserver = handle.advertiseService("reset", &reset, this);\n'
                                        'handle.param<std::string>("odom_frame", "odom")',
    'src/nodelets/poses.h': '',
    'src/nodelets/poses.cpp': 'handle.advertise<PoseStamped>("pose", 10);\n'
                              'for (const Topic& topic : someImageTopics())\n'
                              '  advertise<Image>("parts/" + topic.name, 1);',
    'src/nodelets/unused.cpp': 'handle.advertise<PoseStamped>("not_ours", 10);',
    'src/ros/images.cpp': 'someImageTopics() {\n  return {{"depth", make}, {"label", make}};\n}',
    'src/settings/table.cpp': 'number(\n "min_range", "m", 0.1, 1.0), boolean("publish_tf", kAtStart, "")',
    'cfg/OpenNI2Camera.cfg': "gen.add('mirror', bool_t)",
    'src/apps/fuse_it.cpp': '#include "more.h"\napp.add_option("IN", a)->required();\n'
                            'app.add_option("--out", a.out, "Where to \\"write\\" "\n  "it")->required();\n'
                            'app.add_flag("--blur,!--no-blur", a.blur, "of the lens");',
    'src/apps/more.h': 'app.add_option("--rgb", a.rgb, "topic");',
    'scripts/compare': "#!/usr/bin/python3\nparser.add_argument('--box', metavar=('X0', 'X1'), nargs=2, "
                       "help='a '\n 'box')",
    'scripts/show': '#!/usr/bin/python3\nfrom ours import more\nmore.add_input(parser)',
    'python/ours/more.py': "def add_input(parser):\n    parser.add_argument('--input', help='b')\n"
                           "def other(parser):\n    parser.add_argument('--other')\n",
    'scripts/run': '#!/bin/sh\ncase $1 in --quick) ;; esac\n',
    'launch/play.launch': '<launch><arg name="bag" doc="What to\n   play"/><arg name="rate" default="1"/>'
                          '<arg name="own" value="2"/></launch>',
    'msg/Frame.msg': 'uint8 x',
    'docs/settings.md': '| name |\n|---|\n| `min_range` |\n| `publish_tf` |\n',
    'docs/astra.md': 'There is `mirror`.\n',
    'docs/topics.md': '# Topics\n\n`/tracker/pose`, `/tracker/parts/depth`, `/tracker/parts/label`, `/tracker/reset`, '
                      '`odom_frame`, `Frame`\n\n<!-- written by check_docs: launch arguments -->\n'
                      '<!-- end of launch arguments -->\n',
    'docs/method.md': '# Method\n\n## 1. Noise of a sensor\n\n## 2. More\n\nEq. 12 is the last.\n\n'
                      '<!-- written by check_docs: command options -->\n<!-- end of command options -->\n',
}


class InPackage(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = folder.name
        for name, text in PACKAGE.items():
            self.write(name, text)
        self.write_parts()

    def write_parts(self):
        tree = Tree(self.root)
        for page in tree.pages():
            self.write(page.name, written.rewritten(page, tree))

    def write(self, name, text):
        path = os.path.join(self.root, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, 'w') as file:
            file.write(text)

    def add(self, name, text):
        with open(os.path.join(self.root, name), 'a') as file:
            file.write('\n' + text + '\n')

    def found(self):
        tree = Tree(self.root)
        every = (checks.topics, checks.settings, checks.launch_arguments, checks.options, checks.written_parts,
                 checks.words, checks.places, checks.links, citations.check)
        return [sentence for check in every for sentence in check(tree, tree.pages())]

    def expect(self, *parts):
        """Expects as many complaints as parts, and each part in one of them."""
        found = self.found()
        self.assertEqual(len(found), len(parts), found)
        for part in parts:
            self.assertTrue(any(part in sentence for sentence in found), f'{part} is not in {found}')


class WhatThereIs(InPackage):
    def test_is_read_from_the_sources(self):
        tree = Tree(self.root)
        self.assertEqual(tree.topics(), {'/tracker/pose', '/tracker/parts/depth', '/tracker/parts/label'})
        self.assertEqual(tree.services(), {'/tracker/reset'})
        self.assertEqual(tree.settings(), {'min_range', 'publish_tf'})
        self.assertEqual(tree.parameters(), {'odom_frame'})
        self.assertEqual([(each.name, each.default, each.text) for each in tree.launch_files()['play.launch']],
                         [('bag', None, 'What to play'), ('rate', '1', '')])

    def test_options_of_programs_and_scripts(self):
        commands = Tree(self.root).commands()
        self.assertEqual([(each.names, each.text) for each in commands['fuse_it']],
                         [(['--out'], 'Where to "write" it'), (['--blur', '--no-blur'], 'of the lens'),
                          (['--rgb'], 'topic')])
        self.assertEqual([(each.names, each.value, each.text) for each in commands['compare']],
                         [(['--box'], 'X0 X1', 'a box')])
        self.assertEqual([(each.names, each.text) for each in commands['show']], [(['--input'], 'b')])

    def test_a_package_that_is_all_right(self):
        self.expect()


class Undocumented(InPackage):
    def test_topics_services_parameters_and_messages(self):
        self.add('src/nodelets/poses.cpp', 'handle.advertise<nav_msgs::Path>("path", 1); advertiseService("load", f);'
                 'param("base_frame", x);')
        self.write('msg/Other.msg', '')
        self.expect('topic /tracker/path', 'service /tracker/load', 'parameter base_frame', 'Other.msg')

    def test_a_topic_in_a_table(self):
        self.write('src/ros/images.cpp', PACKAGE['src/ros/images.cpp'].replace('make}};', 'make}, {"x", make}};'))
        self.expect('topic /tracker/parts/x')

    def test_settings(self):
        self.add('src/settings/table.cpp', 'choice("splat", {"nearest"}, kFusion)')
        self.add('cfg/OpenNI2Camera.cfg', "gen.add('exposure', int_t)")
        self.expect('setting splat', 'setting exposure')

    def test_launch_arguments_and_options_are_written(self):
        self.write('launch/play.launch', '<launch><arg name="bag"/><arg name="loop" default="0"/></launch>')
        self.expect('docs/topics.md: what is written')
        self.write_parts()
        self.expect()
        self.add('src/apps/more.h', 'app.add_option("--new", a.x, "text");')
        self.expect('docs/method.md: what is written')

    def test_a_part_that_no_page_has(self):
        self.write('docs/topics.md', PACKAGE['docs/topics.md'].split('<!--')[0])
        self.expect('no page has the part "launch arguments"')

    def test_a_nodelet_whose_name_is_not_known(self):
        self.write('src/nodelets/new_nodelet.cpp', '')
        self.expect('new_nodelet.cpp')


class Gone(InPackage):
    def test_topics(self):
        self.add('README.md', 'See `/tracker/path` and `/tracker/parts`.')
        self.expect('README.md:2: there is no topic or service /tracker/path')

    def test_settings(self):
        self.add('docs/settings.md', '| `max_speed` |')
        self.add('README.md', '    fuse_it --out x --set gone=1')
        found = self.found()
        self.assertIn('docs/settings.md: there is no setting max_speed', found)
        self.assertIn('README.md:2: there is no setting gone', found)

    def test_launch_files_and_arguments(self):
        self.add('README.md', '    roslaunch package play.launch bag:=x speed:=2\n\n`other.launch`, `bag:=x`, `no:=x`')
        self.expect('play.launch has no argument speed', 'there is no other.launch',
                    'no launch file has an argument no')

    def test_options_are_those_of_their_command(self):
        self.add('README.md', '    rosrun rgbd_sfm_fusion fuse_it --out x \\\n        --box 1 2\n'
                 '    scripts/run --quick --slow\n    cmake --build _build\n\n`compare --box 1 2`')
        self.expect('README.md:2: fuse_it has no option --box', 'README.md:4: run has no option --slow')

    def test_names_in_backticks(self):
        self.add('README.md', '`min_range`, `odom_frame: x`, `someImageTopics()`, `PoseStamped`')
        self.add('README.md', '`not_there`, `isNot()`, `NotAType`')
        self.expect('`not_there` is nowhere', '`isNot` is nowhere', '`NotAType` is nowhere')

    def test_names_in_the_file_that_a_page_says(self):
        self.write('src/core.cpp', 'void Core::run() {}')
        self.add('README.md', '`Core::run()` in `src/core.cpp`, `Core` in `src/core.cpp`, `stop()` in `src/core.cpp`')
        self.add('README.md', 'Topics are from `someImageTopics()` in `src/core.cpp`.')
        self.expect('README.md:2: `stop` is not in src/core.cpp', 'README.md:4: `someImageTopics` is not in')


class Links(InPackage):
    def test_to_files_and_headings(self):
        self.add('README.md', '[a](docs/method.md#1-noise-of-a-sensor), [b](docs/no.md), [c](docs/method.md#3-no), '
                 '![d](docs/no.png), [e](https://example.org/x#y), [f](#here), `[g](no.md)`\n\n# Here\n')
        self.expect('docs/no.md leads nowhere', 'no heading #3-no', 'docs/no.png leads nowhere')

    def test_in_code_are_none(self):
        self.add('README.md', '    [b](docs/no.md)\n\n```sh\n[b](docs/no.md)\n```')
        self.expect()

    def test_headings_become_anchors_as_on_github(self):
        self.assertEqual(pages.slug('5. What `x_y` is, in §: 2'), '5-what-x_y-is-in--2')
        page = pages.Page('x.md', '# Twice\n\n# Twice\n\n    # code\n')
        self.assertEqual(page.anchors, {'twice', 'twice-1'})


class Citations(InPackage):
    def test_of_pages_and_sections(self):
        self.write('src/core.cpp', '// method.md 1\n// docs/method.md 7\n// (method.md 2).\nint x;  // see plan.md\n'
                   '// method.md 1 to 2, method.md 1 to 3; in method.md 2 of 7 are said to be 5 m\n')
        self.expect('src/core.cpp:2: cites section 7 of docs/method.md', 'src/core.cpp:4: cites plan.md',
                    'src/core.cpp:5: cites section 3')

    def test_of_documents_by_their_names(self):
        self.write('src/core.cpp', '// DESIGN 3.4\n// DESIGN section 2\n// LSD-SLAM 0.035 m, ECCV 2014\n')
        self.expect('core.cpp:1: cites DESIGN', 'core.cpp:2: cites DESIGN')

    def test_of_equations(self):
        self.write('src/core.cpp', '// Eq. 9 to 10\n// paper, Eq. 11 to 13\n// Engel et al. 2013, Eq. 13\n'
                   '// (Engel et al. 2013,\n// Eq. 14)\n')
        self.expect('core.cpp:2: cites Eq. 13')

    def test_of_files(self):
        self.write('src/core.cpp', '#include "not_ours.h"\n// poses.h, gone.h, src/gone.cpp, test/NAME.cpp\n')
        self.write('CMakeLists.txt', '# see scripts/compare and scripts/gone\n')
        self.expect('gone.h', 'src/gone.cpp', 'scripts/gone')


class AccuracyTables(InPackage):
    KEPT = {'recordings': {'a': 'Recording A', 'b': 'Recording B'},
            'results': {'a': {'plain': {'ate': 0.0123, 'share_sfm': 0.5}}, 'b': {'plain': {'ate': float('nan')}}}}

    def test_have_the_recordings_that_have_numbers(self):
        self.assertEqual(figures.table('trajectory', self.KEPT)[2:], ['| Recording A | 0.012 |'])
        self.assertEqual(figures.table('sources', self.KEPT)[2:], ['| Recording A |  | 50.0 |  |'])

    def test_take_what_was_measured(self):
        kept = json.loads(json.dumps(self.KEPT))
        measured = {'a': {'plain': {'ate': 0.02, 'frames': 7}}, 'c': {'leak': {'change': 0.01}}}
        figures.take(measured, kept, {'c': 'C, left'})
        self.assertEqual(kept['results']['a'], {'plain': {'ate': 0.02, 'share_sfm': 0.5}})
        self.assertEqual(kept['results']['C, left'], {'leak': {'change': 0.01}})
        self.assertEqual(kept['recordings']['C, left'], 'C, left')

    def test_are_parts_of_pages(self):
        self.write('docs/figures.json', json.dumps(self.KEPT))
        parts = [f'{written.begin_of("figures, " + name)}\n<!-- end of figures, {name} -->' for name in figures.TABLES]
        self.write('docs/accuracy.md', '\n'.join(parts))
        self.expect('docs/accuracy.md: what is written')
        self.write_parts()
        self.expect()


class RenewFigures(unittest.TestCase):
    SCRIPT = os.path.join(SOURCE, 'scripts', 'renew_figures')

    def test_measures_every_recording_of_the_tables(self):
        with open(os.path.join(SOURCE, figures.RESULTS)) as file:
            kept = [name for name, results in json.load(file)['results'].items() if set(results) - {'cost'}]
        with tempfile.TemporaryDirectory() as folder:
            for name in ('fr1_xyz', 'fr1_rpy', 'icl_living_room'):
                os.mkdir(os.path.join(folder, name))
            done = subprocess.run([self.SCRIPT, '--list', folder], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ''))
            names = [line.split(': ')[0] for line in done.stdout.splitlines()]
            self.assertEqual(sorted(names), sorted(kept))
            known = subprocess.run([os.path.join(SOURCE, 'scripts', 'evaluate'), '--help'], capture_output=True,
                                   text=True).stdout
            for option in {word for word in done.stdout.split() if word.startswith('--')}:
                self.assertIn(option, known)

    def test_says_which_recording_is_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([self.SCRIPT, '--list', folder], capture_output=True, text=True)
            self.assertIn(f'fr1_rpy: left out, as there is no {folder}/fr1_rpy', done.stderr)
            self.assertEqual(done.stdout.count('\n'), 2, 'the rendered room needs no recording')


class Command(InPackage):
    def run_it(self, *arguments):
        return subprocess.run([os.path.join(SOURCE, 'scripts', 'check_docs'), '--root', self.root, *arguments],
                              capture_output=True, text=True)

    def test_ends_with_1_and_names_the_line(self):
        self.assertEqual(self.run_it().returncode, 0)
        self.add('README.md', '[b](docs/no.md)')
        done = self.run_it()
        self.assertEqual(done.returncode, 1)
        self.assertIn('README.md:2: the link to docs/no.md leads nowhere', done.stdout)

    def test_writes(self):
        self.write('launch/play.launch', '<launch><arg name="bag" doc="A | B"/></launch>')
        self.assertEqual(self.run_it().returncode, 1)
        self.assertEqual(self.run_it('--write').returncode, 0)
        with open(os.path.join(self.root, 'docs/topics.md')) as file:
            self.assertIn('| `bag` | has to be given | A \\| B |', file.read())


class ThisPackage(unittest.TestCase):
    """The parsers find names that are known to be there, so a source that is written another way is not simply skipped."""

    def test_has_what_users_meet(self):
        tree = Tree(SOURCE)
        self.assertLessEqual({'/fusion/mean', '/fusion/preview', '/fusion/points', '/tracker/frame',
                              '/tracker/keyframe/depth', '/camera/rgb/image_raw',
                              '/camera/depth_registered/camera_info'}, tree.topics())
        self.assertIn('/tracker/reset', tree.services())
        self.assertGreater(len(tree.settings()), 50)
        self.assertLessEqual({'fuse_bag', 'tum_to_bag', 'evaluate_run'}, set(tree.commands()))
        self.assertIn('--output', [name for option in tree.commands()['fuse_bag'] for name in option.names])
        self.assertEqual(len(tree.launch_files()), len(tree.matching('launch/*.launch')))


if __name__ == '__main__':
    unittest.main()
