# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""One table of the results of an evaluation, beside the results before."""

import functools
import math
import operator

import numpy as np

_SUMMED = {'frames', 'tracked', 'lost', 'keyframes', 'dark_frames', 'tracked_in_the_dark', 'pixels', 'starts',
           'good_starts', 'keyframe_images', 'keyframe_images_changed'}


def pooled(results):
    """Makes one {trial: {name: value}} of several runs [{trial: (numbers, DepthScore or None)}]. The depth of all runs is
    scored together, counts are added up, and other numbers give the median."""
    found = {}
    for trial in results[0]:
        numbers = [result[trial][0] for result in results]
        scores = [result[trial][1] for result in results]
        found[trial] = {name: _pool(name, [each[name] for each in numbers if name in each]) for name in numbers[0]}
        if len(results) > 1 and 'ate' in numbers[0]:
            ate = [each.get('ate', float('nan')) for each in numbers]
            found[trial]['ate_worst'] = max(ate)
            found[trial]['ate_worst_to_median'] = max(ate) / float(np.median(ate))
        if scores[0] is not None:
            found[trial].update(functools.reduce(operator.add, scores).results())
    return found


def _pool(name, values):
    if isinstance(values[0], list):
        return values if len(values) > 1 else values[0]
    return sum(values) if name in _SUMMED else float(np.median(values))


class _Row:
    """@param path  names that lead to the number, with / between
    @param form  format of the number times factor"""

    def __init__(self, label, path, form='{:.2f}', factor=1.0):
        self.label, self.path, self._form, self._factor = label, path.split('/'), form, factor

    def rest(self):
        """All columns but the label."""
        return '/'.join(self.path), self._form, self._factor

    def value(self, results):
        for name in self.path:
            results = results.get(name) if isinstance(results, dict) else None
        return results if isinstance(results, (int, float)) and not math.isnan(results) else None

    def text(self, value):
        return '' if value is None else self._form.format(self._factor * value)


def _percent(label, path, decimals=1):
    return _Row(label + ' [%]', path, f'{{:.{decimals}f}}', 100)


def _millimetres(label, path):
    return _Row(label + ' [mm]', path, '{:.1f}', 1000)


def _motion(trial):
    return [_millimetres('ATE', f'{trial}/ate'), _millimetres('ATE of the worst seed', f'{trial}/ate_worst'),
            _Row('… over the median', f'{trial}/ate_worst_to_median'),
            _millimetres('ATE after Sim(3)', f'{trial}/ate_sim3'),
            _Row('Sim(3) scale', f'{trial}/sim3_scale', '{:.4f}'),
            _percent('scale drift, first to last fifth', f'{trial}/scale_drift', 2),
            _percent('scale, range of the fifths', f'{trial}/scale_spread', 2),
            _Row('slope of ln α [% per 12 s]', f'{trial}/alpha_slope', '{:.2f}', 1200),
            _millimetres('RPE over 1 s', f'{trial}/rpe'), _Row('RPE over 1 s [°]', f'{trial}/rpe_degrees'),
            _millimetres('RPE from frame to frame', f'{trial}/step'),
            _Row('RPE from frame to frame [°]', f'{trial}/step_degrees'),
            _Row('frames', f'{trial}/frames', '{:.0f}'), _Row('tracked', f'{trial}/tracked', '{:.0f}'),
            _Row('lost', f'{trial}/lost', '{:.0f}'), _Row('keyframes', f'{trial}/keyframes', '{:.0f}')]


def _errors(path, rmse=True):
    rows = [_millimetres('RMSE', f'{path}/rmse')] if rmse else []
    return rows + [_percent('median error', f'{path}/median_relative', 2),
                   _percent('bias (median)', f'{path}/bias_relative', 2),
                   _percent('within 10 %', f'{path}/within_10_percent'),
                   _Row('robust error / σ', f'{path}/sigma_ratio'), _Row('NEES25', f'{path}/nees25'),
                   _percent('inside 2σ', f'{path}/inside_2_sigma'), _percent('beyond 5σ', f'{path}/beyond_5_sigma', 2)]


def _source(path):
    return _errors(path) + [
        _Row('NEES25, lowest decile of σ/Z', f'{path}/lowest_decile'),
        _Row('NEES25, highest decile', f'{path}/highest_decile'),
        _percent('σ > 0.2 Z', f'{path}/sigma_over_a_fifth', 2),
        _Row('likelihood over constant σ/Z [nats]', f'{path}/log_likelihood_gain'),
        _Row('interior: NEES25', f'{path}_interior/nees25'),
        _percent('interior: inside 2σ', f'{path}_interior/inside_2_sigma'),
        _Row('edges: NEES25', f'{path}_edges/nees25'),
        _percent('edges: beyond 5σ', f'{path}_edges/beyond_5_sigma', 2),
        _Row('mirrors: NEES25', f'{path}_mirrors/nees25'),
        _Row('all, with mirrors: NEES25', f'{path}_with_mirrors/nees25'),
        _percent('all, with mirrors: beyond 5σ', f'{path}_with_mirrors/beyond_5_sigma', 2)]


def _held_out(trial):
    return [_percent('held out, of all pixels', f'{trial}/held_out/share_of_pixels'),
            _percent('covered by SfM and completed', f'{trial}/held_out/coverage_together'),
            _percent('covered by SfM', f'{trial}/held_out/coverage'), *_errors(f'{trial}/held_out', rmse=False),
            *(_Row('completed: ' + row.label, *row.rest()) for row in [
                _percent('covered', f'{trial}/held_out_completed/coverage'),
                *_errors(f'{trial}/held_out_completed', rmse=False)]),
            _percent('other labels', f'{trial}/held_out/other_labels', 3), *_motion(trial)[:1]]


def _gains():
    rows = []
    for metre in range(10):
        band = f'plain/gain_interior/{metre}_{metre + 1}'
        name = f'{metre}–{metre + 1} m'
        rows += [_Row(f'{name}: RMSE fused / sensor', f'{band}/ratio', '{:.3f}'),
                 _Row(f'{name}: … by the stated σ', f'{band}/stated_ratio', '{:.3f}'),
                 _percent(f'{name}: gain realised', f'{band}/share_of_stated_gain', 0),
                 _Row(f'{name}: RMSE ratio at edges', f'plain/gain_edges/{metre}_{metre + 1}/ratio', '{:.3f}')]
    return rows


_SECTIONS = [
    ('Trajectory', _motion('plain') + [_Row('pose in keyframe: NEES / 6, capped', 'plain/pose_nees'),
                                       _Row('… median (0.89)', 'plain/pose_nees_median'),
                                       _Row('motion over 1 s: NEES / 6', 'plain/second_nees'),
                                       _Row('… median (0.89)', 'plain/second_nees_median'),
                                       _Row("… with the truth's camera turned", 'plain/second_nees_turned'),
                                       _Row('… by [°]', 'plain/truth_turn')]),
    ('SfM depth before fusion, interior', [_percent('density, of all pixels', 'plain/sfm_density'),
                                           *_errors('plain/before_fusion_interior')]),
    ('Sources of the depth', [_percent('sensor only', 'plain/share_sensor'), _percent('SfM only', 'plain/share_sfm'),
                              _percent('fused', 'plain/share_fused'),
                              _percent('SfM only, later frames, of all pixels', 'plain/sfm_only_later'),
                              _Row('… from so many s after 2 % of motion', 'plain/sfm_only_after'),
                              _percent('completed, of all pixels', 'plain/share_completed'),
                              _percent('refilled, of pixels without sensor depth', 'plain/refilled'),
                              _percent('… with σ ≤ 0.1 Z', 'plain/refilled_sure'),
                              *(_percent(f'refilled, of {text} surfaces without sensor depth', f'plain/filled_{name}')
                                for name, text in (('far', 'far matte'), ('dark', 'dark'), ('shiny', 'shiny'),
                                                   ('sunlit', 'sunlit'))),
                              _percent('completed, of the mirror', 'plain/completed_mirror', 2)]),
    ('Sensor only', _source('plain/sensor')), ('SfM only', _source('plain/sfm')), ('Fused', _source('plain/fused')),
    ('Completed', [*_source('plain/completed'),
                   _percent('more than 10 % too near', 'plain/completed/nearer_by_10_percent', 2),
                   _millimetres('interior: RMSE', 'plain/completed_interior/rmse'),
                   _millimetres('edges: RMSE', 'plain/completed_edges/rmse'),
                   _Row('… over that of the interior', 'plain/completed_edges/rmse_over_interior')]),
    ('Fused, interior', _gains()),
    ('No sensor depth beyond a plane', _held_out('held-out')),
    ('No sensor depth in a box', _held_out('held-out-box')),
    ('Shallow overlap, sensor wrong in common', [
        row for sign in ('plus', 'minus') for row in
        [_percent(f'{sign}: σ of the state twice as far', f'shallow-overlap/{sign}_sigma_twice_as_far', 2)] +
        [_Row(f'{sign}: NEES25 at {z} to {z + 1} m', f'shallow-overlap/{sign}_nees25_{z}_{z + 1}')
         for z in range(2, 6)] +
        [_percent(f'{sign}: median error at {z} to {z + 1} m', f'shallow-overlap/{sign}_error_{z}_{z + 1}', 2)
         for z in range(2, 6)]]),
    ('Leak', [_percent('feedback on: change inside', 'leak/change', 2),
              _Row('feedback off: keyframe images', 'leak/keyframe_images', '{:.0f}'),
              _Row('… that changed', 'leak/keyframe_images_changed', '{:.0f}')]),
    ('Black images', [_Row('dark frames', 'black/dark_frames', '{:.0f}'),
                      _Row('… said to be tracked', 'black/tracked_in_the_dark', '{:.0f}'),
                      _Row('frames lost', 'black/lost', '{:.0f}'),
                      _Row('recovered after [s]', 'black/recovered_after'),
                      _Row('ATE / undisturbed ATE', 'black/ate_ratio', '{:.3g}')]),
    ('False block, where there is SfM depth', [_Row('pixels', 'false-block/pixels', '{:.0f}'),
                                               _percent('flagged', 'false-block/flagged'),
                                               _percent('averaged', 'false-block/averaged', 2),
                                               _percent('averaged, 8 px inside', 'false-block/averaged_in_middle', 3),
                                               _percent('SfM kept', 'false-block/sfm_kept')]),
    ('No depth in the right half', _motion('right-half')),
    ('Random start without depth', [_Row('starts', 'random-start/starts', '{:.0f}'),
                                    _Row('without loss, ATE ≤ 50 mm', 'random-start/good_starts', '{:.0f}'),
                                    _millimetres('ATE after Sim(3), median', 'random-start/ate_sim3')]),
    ('Beside RgbdOdometry, in the same run', [_millimetres('ATE', 'rgbd-odometry/ate_package'),
                                              _millimetres("RgbdOdometry's ATE", 'rgbd-odometry/ate_rgbd_odometry'),
                                              _Row('ATE / its ATE', 'rgbd-odometry/ate_to_rgbd_odometry')]),
    ('Milliseconds, medians', [_Row(stage, f'plain/{stage}_ms', '{:.1f}')
                               for stage in ('preparation', 'tracking', 'mapping', 'fusion')]),
]


def table(results, before):
    """The table as lines of text. A number from before is in brackets, if it reads differently.
    @param results, before  {column: {trial: {name: value}}}"""
    cells = []
    for title, rows in _SECTIONS:
        section = [[row.label] + [_cell(row, results[column], before.get(column, {})) for column in results]
                   for row in rows]
        section = [line for line in section if any(line[1:])]
        if section:
            cells += [[title] + [''] * len(results)] + [['  ' + line[0]] + line[1:] for line in section]
    cells.insert(0, [''] + list(results))
    widths = [max(len(line[i]) for line in cells) for i in range(len(results) + 1)]
    return [('{:<{}}'.format(line[0], widths[0]) + ''.join('  {:>{}}'.format(cell, width) for cell, width in
                                                            zip(line[1:], widths[1:]))).rstrip() for line in cells]


def _cell(row, results, before):
    now, then = row.text(row.value(results)), row.text(row.value(before))
    return f'{now} ({then})' if now and then and now != then else now
