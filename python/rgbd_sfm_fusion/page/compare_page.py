# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The page of several runs beside each other."""

import os

import numpy as np

from ..evaluation.error_table import ErrorTable
from . import layout, pictures, plots, run_page
from .facts import ADDED, PAPER, Facts, evenly
from .layout import length, percent
from .sentences import INSIDE

_FRAMES, _WIDTH = 6, 320
_LOOKED_AT = 40  # frames that are compared pixel by pixel


class Entry:
    """A run, its input, its name on the page, and its Facts."""

    def __init__(self, name, run, recording, sequence):
        self.name, self.run, self.recording = name, run, recording
        self.facts = Facts(run, recording, sequence)
        self.index_of = {int(stamp): index for index, stamp in enumerate(run.stamps)}


def names_of(runs):
    """Short names that tell the runs apart: the bags' names, or those of the folders that they are in."""
    paths = [os.path.splitext(os.path.realpath(run.path))[0].split(os.sep) for run in runs]
    for length_ in range(1, max(map(len, paths)) + 1):
        for names in (['/'.join(path[-length_:]) for path in paths], ['/'.join(path[-length_ - 1:-1]) for path in paths]):
            if len(set(names)) == len(names) and all(names):
                return [name[:-len('.fused')] if name.endswith('.fused') else name for name in names]
    return [f'{name} ({i + 1})' for i, name in enumerate(run.name for run in runs)]


def compare_page(entries, sequence=None):
    """The page as HTML, and the sentences with which it begins. @param entries  at least two"""
    said = sentences(entries)
    common = common_stamps(entries)
    sections = [numbers(entries, sequence), over_time(entries), certainty(entries)]
    if common:
        sections += [pixel_by_pixel(entries, common), frames(entries, common)]
    else:
        sections.append(layout.section('Frames', layout.paragraph(
            'The runs are of different recordings and have no frame in common, so there are no pictures side by side.')))
    sections.append(settings(entries))
    title = 'Comparison: ' + ', '.join(entry.name for entry in entries)
    subtitle = '; '.join(f'{layout.text(entry.name)}: {run_page.subtitle(entry.run)}' for entry in entries)
    return layout.page(title, subtitle, ''.join(layout.paragraph(sentence) for sentence in said), sections), said


def common_stamps(entries):
    return sorted(set.intersection(*(set(entry.index_of) for entry in entries)))


def _each(entries, value):
    return ', '.join(f'{entry.name} {value(entry)}' for entry in entries)


def sentences(entries):
    def sigma(entry):
        found = entry.facts.sigmas.quantiles(*ADDED)
        return percent(found['relative_median']) if found else 'of nothing'

    def inside(entry):
        found = entry.facts.overlap.summary() if entry.facts.overlap else {}
        return percent(found['inside_2_sigma']) if 'rmse' in found else 'not known'

    return ['Of the pixels without sensor depth, this share was refilled: '
            f'{_each(entries, lambda entry: percent(entry.facts.coverage.total_refilled()))}.',
            f'Half of the added depth has a stated deviation of at most this share of itself: {_each(entries, sigma)}.',
            'Where sensor and SfM both have a depth, this share of their differences is within two stated deviations '
            f'({INSIDE}): {_each(entries, inside)}.']


def numbers(entries, sequence):
    rows = []

    def row(name, value):
        cells = [value(entry) for entry in entries]
        if any(cell not in ('–', None) for cell in cells):
            rows.append([name] + [cell or '–' for cell in cells])

    def of(summary, name, form):
        return form(summary[name]) if summary and name in summary else None

    row('frames', lambda e: str(len(e.run)))
    for state in ('tracking', 'initialising', 'lost'):
        row(state, lambda e: str(e.facts.states()[state]))
    row('no sensor depth, of all pixels', lambda e: percent(e.facts.coverage.without_sensor_share()))
    row('refilled of these', lambda e: percent(e.facts.coverage.total_refilled()))
    for key, name in (('sensor_only', 'sensor only'), ('sfm_only', 'SfM only'), ('fused', 'fused')):
        row(f'Table I: {name} [%] (the paper: {PAPER[key]})', lambda e: f'{e.facts.coverage.table_1()[key]:.1f}')
    if any(entry.facts.coverage.has_completed for entry in entries):
        row('completed, of all pixels', lambda e: percent(e.facts.coverage.completed_share()))
    for what, key in (('median', 'median'), ('nine tenths below', 'ninth')):
        row(f'σ of added depth, {what}', lambda e: of(e.facts.sigmas.quantiles(*ADDED), key, length))
        row('… of the depth', lambda e: of(e.facts.sigmas.quantiles(*ADDED), 'relative_' + key, percent))
    for name, summary in (('overlap', lambda e: e.facts.overlap.summary() if e.facts.overlap else None),
                          ('added, against the truth', lambda e: e.facts.truth.of_added() if e.facts.truth else None)):
        row(f'{name}: median difference', lambda e: of(summary(e), 'median_relative', percent))
        row('… inside 2σ', lambda e: of(summary(e), 'inside_2_sigma', percent))
        row('… beyond 5σ', lambda e: of(summary(e), 'beyond_5_sigma', lambda value: percent(value, 2)))
        row('… spread / σ', lambda e: of(summary(e), 'sigma_ratio', '{:.2f}'.format))
    for stage in run_page.stages(entries[0].run):
        row(f'{stage} [ms], median', lambda e: f'{np.median(run_page.stages(e.run).get(stage, np.nan)):.1f}')
    parts = [layout.table('', [''] + [entry.name for entry in entries], rows)]
    if sequence is not None:
        parts += [layout.paragraph(f'{entry.name}: {words}') for entry in entries
                  for words in [run_page.true_motion(entry.run, sequence)[0]] if words]
    return layout.section('Numbers', *parts)


def settings(entries):
    names = list(dict.fromkeys(name for entry in entries for name in entry.run.settings))
    rows = [[name] + [str(entry.run.settings.get(name, '–')) for entry in entries] for name in names
            if len({str(entry.run.settings.get(name)) for entry in entries}) > 1]
    body = layout.table('Settings that differ', [''] + [entry.name for entry in entries], rows) if rows else \
        layout.paragraph('All settings are the same.')
    return layout.section('Settings', body)


def over_time(entries):
    start = min(int(entry.run.stamps[0]) for entry in entries)

    def seconds(entry):
        offset = 1e-9 * (int(entry.run.stamps[0]) - start)
        return entry.run.seconds() + (offset if offset < 3600 else 0)  # other recordings have times of their own

    figures = [layout.plot(plots.refilled([(e.name, seconds(e), e.facts.coverage.refilled()) for e in entries]),
                           'Share of the pixels without sensor depth that got a depth, over time',
                           'Refilled: pixels without sensor depth that got a depth.'),
               layout.plot(plots.scale([(e.name, seconds(e), e.run.table['alpha'], e.run.table['sigma_alpha'],
                                         e.run.table['refused'] > 0) for e in entries]),
                           'Scale over time, with bands of two standard deviations',
                           'The scale α from tracker units to metres, with ± 2σ; × where a fit was refused.'),
               layout.plot(plots.times([(e.name, seconds(e), run_page.stages(e.run)) for e in entries]),
                           'Milliseconds of each frame over time', 'Milliseconds of each frame, all stages together.')]
    tracked = [(e.name, e.run.trajectory.positions, run_page.starts(e.run)) for e in entries if e.run.trajectory]
    if tracked:
        figures += [layout.plot(plots.trajectories(tracked, *view), f'Paths of the camera, seen from {name}',
                                f'The camera’s path from {name}, each in the axes of its first image.')
                    for view, name in ((run_page.ABOVE, 'above'), (run_page.SIDE, 'the side'))]
    return layout.section('Over time', layout.plots(*figures))


def certainty(entries):
    curves = [(entry.name, colour, *entry.facts.overlap.curve()) for entry, colour in zip(entries, plots.RUN_COLOURS)
              if entry.facts.overlap]
    if not any(len(curve[2]) for curve in curves):
        return layout.section('How sure it is', layout.paragraph(
            'Stated deviations are not compared with what the overlap shows: no run has both /fusion/sfm_depth and its '
            'input.', 'note'))
    return layout.section('How sure it is', layout.plots(layout.plot(
        plots.stated_and_shown(curves), 'Spread of the differences between SfM’s and the sensor’s depth by the stated '
        'standard deviation, one curve for each run',
        'Pixels where sensor and SfM both have a depth: spread of the differences by their stated σ. Above the dotted line '
        'the stated σ is too small.')))


def pixel_by_pixel(entries, common):
    first, rows = entries[0], []
    for other in entries[1:]:
        differences, counts = ErrorTable(), np.zeros(4)
        for stamp in (common[i] for i in evenly(len(common), _LOOKED_AT)):
            a, b = (entry.run.frame(entry.index_of[stamp]) for entry in (first, other))
            if a.mean.shape != b.mean.shape:
                break
            there = np.isfinite(a.mean), np.isfinite(b.mean)
            both = there[0] & there[1]
            counts += both.sum(), (there[0] & ~both).sum(), (there[1] & ~both).sum(), both.size
            differences.add((b.mean - a.mean)[both], a.mean[both], np.maximum(a.variance, b.variance)[both])
        summary = differences.summary()
        if 'rmse' in summary:
            rows.append([other.name] + [percent(count / counts[3]) for count in counts[:3]] +
                        [percent(summary['median_relative'], 2), percent(1 - summary['inside_2_sigma'], 2)])
    if not rows:
        return ''
    return layout.section('Pixel by pixel', layout.table(
        f'Compared with {first.name}, in % of all pixels of common frames',
        ['', 'both have depth', f'only {first.name}', 'only this', 'median difference', 'over 2σ of the larger σ'], rows))


def frames(entries, common):
    indices = [common[i] for i in evenly(len(common), _FRAMES)]
    first = entries[0]
    values = [first.run.frame(first.index_of[stamp]).mean[::8, ::8].ravel() for stamp in indices]
    painter = pictures.Painter(pictures.round_limit(np.concatenate(values)), _WIDTH)
    has_completed = any(entry.facts.coverage.has_completed for entry in entries)
    parts = [layout.keys(painter.depth_limit, run_page.swatches(has_completed))]
    for stamp in indices:
        for entry in entries:
            parts.append(run_page.row(entry.run, entry.recording, entry.index_of[stamp], painter, entry.name))
    return layout.section('Frames', *parts)
