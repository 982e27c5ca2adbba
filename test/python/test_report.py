# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Pages of runs are complete and true, and need no other file. Where no page can be made, a message says why."""

import html.parser
import os
import re
import resource
import subprocess
import sys
import unittest
import xml.etree.ElementTree

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, '..', '..', 'python')]
import synthetic_run as synthetic  # noqa: E402
from in_folder import InFolder  # noqa: E402

SCRIPTS = os.path.join(HERE, '..', '..', 'scripts')
_VOID = {'meta', 'link', 'input', 'img'}


class Page(html.parser.HTMLParser):
    """A page's visible words, its links, and whether its tags are balanced."""

    def __init__(self, content):
        super().__init__()
        self.words, self.addresses, self.images, self._open = [], [], [], []
        self.feed(content)
        self.is_balanced = not self._open

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.addresses += [attributes[name] for name in ('src', 'href', 'action') if name in attributes]
        if tag == 'img':
            self.images.append(attributes)
        if tag not in _VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in _VOID:
            self._open.pop()

    def handle_endtag(self, tag):
        assert self._open.pop() == tag, tag

    def handle_data(self, data):
        if not self._open or self._open[-1] not in ('style', 'script'):
            self.words.append(data)

    @property
    def text(self):
        return re.sub(r'\s+', ' ', ' '.join(self.words))


class ToolTest(InFolder):
    def setUp(self):
        super().setUp()
        self.given, self.bag, self.results = synthetic.write_all(self.folder)

    def run_tool(self, name, *arguments, **options):
        return subprocess.run([os.path.join(SCRIPTS, name), *arguments], capture_output=True, text=True, cwd=self.folder,
                              **options)

    def refused(self, words, name, *arguments, **options):
        done = self.run_tool(name, *arguments, **options)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        self.assertRegex(done.stderr, words)
        return done

    def page(self, path):
        with open(path, encoding='utf-8') as file:
            content = file.read()
        page = Page(content)
        self.assertTrue(page.is_balanced)
        xml.etree.ElementTree.fromstring(content.split('\n', 1)[1])  # well-formed, which HTML does not even demand
        for address in page.addresses:
            self.assertTrue(address.startswith('data:'), address[:60])
        self.assertNotIn('@import', content)
        self.assertNotRegex(content, r'url\(|https?://')
        for image in page.images:
            self.assertGreater(len(image['alt']), 10)
        self.assertLess(len(content), 5 * 10**6)
        return page


class RunPage(ToolTest):
    def test_shows_what_the_run_holds(self):
        done = self.run_tool('report_run', self.bag)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, '')
        page = self.page(os.path.join(self.results, 'report.html'))
        # 21 of 64 columns have no sensor depth, 10 of them were refilled.
        self.assertIn('32.8 % of the pixels have no usable depth from the sensor; 47.6 % of these were refilled (15.6 % of '
                      'all pixels', page.text)
        self.assertIn('at most 4.0 cm (2.0 % of the depth)', page.text)
        self.assertIn('Where sensor and SfM both have a depth (37.5 % of the pixels)', page.text)
        self.assertIn('this run 35.8 18.9 45.3', page.text)
        self.assertIn('the paper, mean of its three scenes 63.3 10.3 26.3', page.text)
        self.assertIn('noise_lateral 0.5 0.3', page.text)
        self.assertIn('1.2.3', page.text)
        self.assertIn('in.bag', page.text)
        self.assertEqual(sum(image['src'].startswith('data:image/svg') for image in page.images), 7)
        pictures = [image for image in page.images if not image['src'].startswith('data:image/svg')]
        self.assertEqual(len(pictures), 5 * (6 + synthetic.FRAMES))
        self.assertTrue(done.stdout.startswith('In 8 frames (0.7 s), 32.8'))

    def test_completed_depth_is_refilled_but_not_in_table_1(self):
        synthetic.write_bag(self.path('whole.bag'), completed=True)
        synthetic.write_results(self.path('whole_results'), self.given, completed=True)
        done = self.run_tool('report_run', 'whole.bag', '--output', 'page.html')
        self.assertEqual((done.returncode, done.stderr), (0, ''))
        page = self.page(self.path('page.html'))
        self.assertIn('71.4 % of these were refilled (23.4 % of all pixels): 47.6 % from motion, 23.8 % completed',
                      page.text)
        self.assertIn('this run 35.8 18.9 45.3', page.text)
        self.assertIn('7.8 % of all pixels are completed', page.text)

    def test_with_truth_it_has_the_errors_that_were_put_in(self):
        synthetic.write_truth(self.path('truth'))
        done = self.run_tool('report_run', self.results, '--truth', 'truth', '--output', 'page.html')
        self.assertEqual(done.returncode, 0, done.stderr)
        page = self.page(self.path('page.html'))
        self.assertIn('The truth is exact', page.text)
        self.assertRegex(page.text, r'SfM only [0-9\u202f ]+ 2\.0 cm')
        self.assertRegex(page.text, 'absolute error 0.0 mm')
        self.assertIn('Against the exact depth, the added depth is wrong by 0.7 % in the median', page.text)

    def test_recorded_truth_judges_nothing_that_was_made_from_it(self):
        synthetic.write_recorded(self.path('truth'))
        done = self.run_tool('report_run', self.bag, '--truth', 'truth')
        self.assertEqual((done.returncode, done.stderr), (0, ''))
        self.assertIn('There are no such pixels here', self.page(os.path.join(self.results, 'report.html')).text)

    def test_without_the_input_and_sfm_depth_it_says_what_is_not_shown(self):
        os.remove(self.given)
        os.remove(self.bag)
        synthetic.write_bag(self.bag, left_out=('/fusion/sfm_depth', '/fusion/sfm_variance'))
        done = self.run_tool('report_run', self.bag)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('in.bag is not there any more', done.stderr)
        page = self.page(os.path.join(self.results, 'report.html'))
        self.assertIn('Not shown: sensor depth, as the input is not there (report_run --input); SfM depth', page.text)
        self.assertIn('Nothing in this run can tell how right that is', page.text)

    def test_what_is_in_the_names_of_files_is_no_html(self):
        odd = self.path('<b>&.bag')
        os.rename(self.given, odd)
        synthetic.write_results(self.path('odd'), odd)
        done = self.run_tool('report_run', self.bag, '--results', 'odd')
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn('Depth fusion: <b>&', self.page(self.path('odd/report.html')).text)

    def test_a_bag_without_results_is_refused_with_the_cure(self):
        os.rename(self.results, self.path('elsewhere'))
        self.refused('no results of .*fused.bag beside it.*--results DIR', 'report_run', self.bag)
        self.refused('in.bag has no messages of /fusion/mean', 'report_run', self.given)
        self.refused('no summary.json', 'report_run', self.bag, '--results', self.folder)
        self.refused('cannot read .*none.bag', 'report_run', 'none.bag')

    def test_pages_that_cannot_be_written_are_named(self):
        self.refused('it is a folder', 'report_run', self.bag, '--output', 'results')
        self.refused('there is no folder x', 'report_run', self.bag, '--output', 'x/page.html')
        self.refused('has no groundtruth.txt', 'report_run', self.bag, '--truth', 'results')

    def test_a_full_disk_leaves_nothing(self):
        self.refused('cannot write page.html: File too large', 'report_run', self.bag, '--output', 'page.html',
                     preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000)))
        self.assertFalse(os.path.exists(self.path('page.html')))
        self.assertFalse(os.path.exists(self.path('page.html.partial')))

    def test_a_missing_package_is_named_with_the_cure(self):
        with open(self.path('matplotlib.py'), 'w') as file:
            file.write('raise ImportError("none")')
        self.refused('apt-get install python3-matplotlib', 'report_run', '--check',
                     env=dict(os.environ, PYTHONPATH=self.folder + ':' + os.environ.get('PYTHONPATH', '')))
        self.assertEqual(self.run_tool('report_run', '--check', '--output', 'page.html').returncode, 0)
        self.assertFalse(os.path.exists(self.path('page.html')))


class ComparedRuns(ToolTest):
    def other(self, name, **options):
        synthetic.write_bag(self.path(name + '.bag'), **options)
        synthetic.write_results(self.path(name), self.given)

    def test_differences_are_shown(self):
        self.other('second')
        with open(self.path('second/summary.json')) as file:
            content = file.read()
        with open(self.path('second/summary.json'), 'w') as file:
            file.write(content.replace('"noise_lateral": 0.5', '"noise_lateral": 0.75'))
        done = self.run_tool('compare_runs', self.bag, 'second.bag', '--results', 'results', 'second')
        self.assertEqual((done.returncode, done.stderr), (0, ''))
        page = self.page(self.path('comparison.html'))
        self.assertIn('Comparison: fused, second', page.text)
        self.assertIn('this share was refilled: fused 47.6 %, second 47.6 %', page.text)
        self.assertIn('noise_lateral 0.5 0.75', page.text)
        self.assertIn('second 82.8 % 0.0 % 0.0 % below 0.01 % 0.00 %', page.text)

    def test_bad_input_is_refused(self):
        self.assertEqual(self.run_tool('compare_runs', self.bag).returncode, 2)
        self.assertEqual(self.run_tool('compare_runs', self.bag, self.bag, '--names', 'one').returncode, 2)
        self.refused('in.bag has no messages', 'compare_runs', self.bag, self.given)
        os.rename(self.results, self.path('elsewhere'))
        self.refused('no results', 'compare_runs', self.bag, self.bag)
        self.refused('it is a folder', 'compare_runs', self.bag, self.bag, '--output', 'elsewhere')


if __name__ == '__main__':
    unittest.main()
