# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The tables of docs/accuracy.md and docs/performance.md, made from docs/figures.json. That file keeps the measurements
of scripts/evaluate and scripts/benchmark."""

import json
import math

RESULTS = 'docs/figures.json'


class _Number:
    """@param path  names that lead to the number in a recording's results, with / between"""

    def __init__(self, head, path, form, factor=1.0):
        self.head, self._path, self._form, self._factor = head, path.split('/'), form, factor

    def value(self, results):
        for name in self._path:
            results = results.get(name) if isinstance(results, dict) else None
        is_number = isinstance(results, (int, float)) and not math.isnan(results)
        return results if is_number else None

    def text(self, results):
        value = self.value(results)
        return '' if value is None else self._form.format(self._factor * value)

    def keep(self, results, kept):
        """Copies the number from the measured results."""
        value = self.value(results)
        if value is None:
            return
        for name in self._path[:-1]:
            kept = kept.setdefault(name, {})
        kept[self._path[-1]] = value


class _Word(_Number):
    """A text instead of a number."""

    def __init__(self, head, path):
        super().__init__(head, path, '{}')

    def value(self, results):
        for name in self._path:
            results = results.get(name) if isinstance(results, dict) else None
        return results if isinstance(results, str) else None

    def text(self, results):
        return self.value(results) or ''


def _percent(head, path, decimals=0):
    return _Number(head + ' [%]', path, f'{{:.{decimals}f}}', 100)


def _plain(head, path):
    return _Number(head, path, '{:.2f}')


def _held_out(trial, source='held_out'):
    path = f'{trial}/{source}'
    return [_percent('covered', f'{path}/coverage'), _percent('median error', f'{path}/median_relative', 1),
            _percent('within 10 %', f'{path}/within_10_percent'), _plain('NEES25', f'{path}/nees25'),
            _percent('inside 2σ', f'{path}/inside_2_sigma')]


def _source(name, path):
    return [_plain(f'{name}: NEES25', f'plain/{path}/nees25'),
            _percent(f'{name}: inside 2σ', f'plain/{path}/inside_2_sigma'),
            _percent(f'{name}: beyond 5σ', f'plain/{path}/beyond_5_sigma', 1)]


def _gain(place):
    metres = [(metre, metre + 1) for metre in range(1, 5)]
    return [_percent(f'{a}–{b} m', f'plain/gain_{place}/{a}_{b}/ratio') for a, b in metres]


TABLES = {
    'trajectory': [_Number('ATE [m]', 'plain/ate', '{:.3f}')],
    'sources': [_percent('sensor only', 'plain/share_sensor', 1), _percent('SfM only', 'plain/share_sfm', 1),
                _percent('fused', 'plain/share_fused', 1)],
    'before fusion': [_percent('of all pixels', 'plain/sfm_density'),
                      _percent('median error', 'plain/before_fusion_interior/median_relative', 1),
                      _percent('within 10 %', 'plain/before_fusion_interior/within_10_percent'),
                      _plain('robust error / σ', 'plain/before_fusion_interior/sigma_ratio')],
    'held out beyond a plane': _held_out('held-out'),
    'completed beyond a plane': _held_out('held-out', 'held_out_completed'),
    'held out in a box': _held_out('held-out-box'),
    'variances': _source('sensor', 'sensor') + _source('SfM', 'sfm') + _source('fused', 'fused'),
    'gain': _gain('interior'),
    'gain at edges': _gain('edges'),
    'gain realised': [_percent(f'{a}–{a + 1} m', f'plain/gain_interior/{a}_{a + 1}/share_of_stated_gain')
                      for a in range(1, 5)],
    'disturbances': [_percent('leak', 'leak/change', 1), _percent('false block: flagged', 'false-block/flagged'),
                     _percent('false block: averaged', 'false-block/averaged', 1),
                     _percent('averaged, 8 px inside', 'false-block/averaged_in_middle', 1)],
    'costs': [_plain(head, f'cost/ratio/{name}') for head, name in (
        ('tracking + mapping / RgbdOdometry', 'tracking_mapping'), ('the whole / RgbdOdometry', 'whole'),
        ('fusion / registerDepth', 'fusion'), ('p99 / median: tracking', 'p99_tracking'), ('mapping', 'p99_mapping'),
        ('fusion', 'p99_fusion'), ('the whole', 'p99'))] + [_Word('processor', 'cost/processor')],
    'times': [_Number(f'{stage} [ms]', f'cost/ms/{stage}', '{:.1f}')
              for stage in ('preparation', 'tracking', 'mapping', 'fusion', 'OpenCV RgbdOdometry',
                            'OpenCV registerDepth')],
}


def table(name, kept):
    """Lines of a table, with the recordings that have any of the table's numbers."""
    numbers = TABLES[name]
    rows = [[title] + [number.text(kept['results'].get(recording, {})) for number in numbers]
            for recording, title in kept['recordings'].items()]
    # The table of variances is against exact truth, which only runs that compare the sensor have.
    rows = [row for row in rows if (row[1] if name == 'variances' else any(row[1:]))]
    if not rows:
        return ['No figures are kept of this yet.']
    lines = ['| recording | ' + ' | '.join(number.head for number in numbers) + ' |', '|---' * (len(numbers) + 1) + '|']
    return lines + ['| ' + ' | '.join(row) + ' |' for row in rows]


def parts(tree):
    """{name of a part: lines} for pages; none where there are no results."""
    if not tree.has(RESULTS):
        return {}
    kept = json.loads(tree.text(RESULTS))
    return {f'figures, {name}': table(name, kept) for name in TABLES}


def take(measured, kept, names):
    """Adds those measured numbers that a table shows.

    @param measured  last.json of scripts/evaluate or scripts/benchmark
    @param kept      content of docs/figures.json, which is changed
    @param names     {column of `measured`: name under which the column is kept}"""
    for column, results in measured.items():
        name = names.get(column, column)
        kept['recordings'].setdefault(name, name)
        for numbers in TABLES.values():
            for number in numbers:
                number.keep(results, kept['results'].setdefault(name, {}))
