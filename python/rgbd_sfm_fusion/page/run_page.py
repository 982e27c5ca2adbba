# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The page of one run."""

import datetime
import os

import numpy as np

from .. import trajectory as trajectories
from ..runs import COMPLETED, FUSED, SENSOR_ONLY, SFM_ONLY, SOURCES
from . import layout, pictures, plots
from .facts import PAPER, Facts, evenly
from .layout import length, percent
from .sentences import sentences

_SHOWN, _MORE = 6, 24                # frames
_SHOWN_WIDTH, _MORE_WIDTH = 320, 220  # [px] width of their pictures
ABOVE = (0, 2, 1, 1), ('to the right [m]', 'ahead [m]')
SIDE = (2, 1, 1, -1), ('ahead [m]', 'up [m]')


def run_page(run, recording=None, sequence=None):
    """The page as HTML, and the three sentences with which it begins."""
    facts = Facts(run, recording, sequence)
    said = sentences(facts)
    sections = [sources(facts), frames(run, recording), over_time(facts), certainty(facts, recording)]
    if facts.truth:
        sections.append(truth(facts))
    sections += [motion(run, sequence), times(run), about(run)]
    lede = ''.join(layout.paragraph(sentence) for sentence in said)
    given = run.summary.get('input')
    names = [os.path.splitext(os.path.basename(path))[0] for path in given['bags']] if given else [run.name]
    return layout.page(f'Depth fusion: {", ".join(names)}', subtitle(run), lede, sections), said


def subtitle(run):
    return f'Fused {date(run)} with rgbd_sfm_fusion {layout.text(version(run))}'


def date(run):
    """When the run was made, by the time of its files. Results hold no date, so that the same run gives the same bytes."""
    path = os.path.join(run.results, 'summary.json') if run.results else run.path
    return datetime.datetime.fromtimestamp(os.path.getmtime(path)).strftime('%Y-%m-%d %H:%M')


def version(run):
    return run.summary.get('version', 'of an unknown version')


def swatches(has_completed):
    shown = (SENSOR_ONLY, SFM_ONLY, FUSED) + ((COMPLETED,) if has_completed else ()) + (0,)
    return [(pictures.SOURCE_COLOURS[source], SOURCES[source]) for source in shown]


def sources(facts):
    mine, coverage = facts.coverage.table_1(), facts.coverage
    rows = [[name] + [f'{values[key]:.1f}' for key in ('sensor_only', 'sfm_only', 'fused')]
            for name, values in (('this run', mine), ('the paper, mean of its three scenes', PAPER))]
    parts = [layout.table('Table I: % of the pixels that have depth from any of these', ['', 'sensor only', 'SfM only',
                                                                                         'fused'], rows)]
    if coverage.has_completed:
        parts.append(layout.paragraph(
            f'Beside these, {percent(coverage.completed_share())} of all pixels are completed: estimated between measured '
            'depths of one surface.', 'note'))
    states = facts.states()
    if states['lost'] or states['initialising']:
        parts.append(layout.paragraph(
            f'{states["tracking"]} of {len(facts.run)} frames were tracked, {states["initialising"]} were at a start, and '
            f'in {states["lost"]} tracking was lost: such frames have the sensor’s depth alone.'))
    parts.append(layout.paragraph('The paper’s scenes were chosen for things that a sensor does not see.', 'note'))
    return layout.section('Where the depth comes from', *parts)


def frames(run, recording):
    first, more = evenly(len(run), _SHOWN), evenly(len(run), _MORE)
    limit = _depth_limit(run, recording, first)
    parts = [layout.keys(limit, swatches('completed' in run.table))]
    missing = []
    if recording is None:
        missing.append('sensor depth, as the input is not there (report_run --input)')
    if not run.has('sfm_depth'):
        missing.append('SfM depth, as the bag has no /fusion/sfm_depth (fuse_bag --report, or --topics)')
    if missing:
        parts.append(layout.paragraph('Not shown: ' + '; '.join(missing) + '.', 'note'))
    painter = pictures.Painter(limit, _SHOWN_WIDTH)
    parts += [row(run, recording, index, painter) for index in first]
    if len(run) > _SHOWN:
        parts.append('<h3>More frames</h3>\n')
        painter = pictures.Painter(limit, _MORE_WIDTH)
        parts.append(layout.slider([row(run, recording, index, painter, hidden=index != more[0]) for index in more]))
    return layout.section('Frames', *parts)


def _depth_limit(run, recording, indices):
    values = []
    for index in indices:
        frame = run.frame(index)
        values += [image[::8, ::8].ravel() for image in (frame.mean, recording and recording.depth_of(run, index, frame))
                   if image is not None]
    return pictures.round_limit(np.concatenate(values))


def row(run, recording, index, painter, name='', hidden=False):
    """A frame in the paper's columns. @param name  of the run, if there are several"""
    frame = run.frame(index)
    image = frame.image
    if image is None and recording is not None:
        image = recording.colour(frame.stamp)
    columns = painter.columns(frame, image, recording and recording.depth_of(run, index, frame))
    time = f't = {frame.seconds:.1f}\u00a0s'
    of = f' of {name}' if name else ''
    cells = [(columns[column], f'{title}{of} at {time}', title) for column, title in pictures.COLUMNS if column in columns]
    return layout.frame(f'{time}, {name or frame.state}{_added_words(frame)}', time, cells, hidden)


def _added_words(frame):
    empty = ~np.isin(frame.provenance, (SENSOR_ONLY, FUSED))
    added = np.isin(frame.provenance, (SFM_ONLY, COMPLETED))
    if not empty.any():
        return ''
    return f': {percent(empty.mean())} without sensor depth, {percent(added.sum() / empty.sum())} of that refilled'


def over_time(facts):
    run, coverage = facts.run, facts.coverage
    shown = (SENSOR_ONLY, FUSED, SFM_ONLY) + ((COMPLETED,) if coverage.has_completed else ())
    refilled = coverage.refilled()
    figures = [layout.plot(plots.refilled([(run.name, run.seconds(), refilled)]),
                           f'Share of the pixels without sensor depth that got a depth, over time; '
                           f'{percent(coverage.total_refilled())} over all',
                           f'Refilled: pixels without sensor depth that got a depth. Over all frames: '
                           f'{percent(coverage.total_refilled())}.'),
               layout.plot(plots.shares(run.seconds(), coverage, shown),
                           'All pixels by the source of their depth, stacked, over time',
                           'All pixels, by the source of their depth; the rest up to 100 % has no depth.')]
    return layout.section('Over time', layout.plots(*figures))


def certainty(facts, recording):
    parts = []
    rows = []
    for source in range(1, len(SOURCES)):
        sigma = facts.sigmas.quantiles(source)
        if sigma:
            rows.append([SOURCES[source], length(sigma['median']), percent(sigma['relative_median']),
                         length(sigma['ninth']), percent(sigma['relative_ninth'])])
    nearby = ''
    stated = layout.table(f'Stated standard deviations, of {len(facts.looked_at)} frames',
                          ['', 'median', '… of the depth', 'nine tenths below', '… of the depth'], rows)
    if not facts.overlap or not facts.overlap.pixels:
        why = 'the input is not there' if recording is None else \
            'the bag has no /fusion/sfm_depth and /fusion/sfm_variance, or there are no pixels with both'
        return layout.section('How sure it is', stated, layout.paragraph(
            f'Stated deviations are not compared with what the overlap of sensor and SfM shows: {why}.', 'note'))
    names = {FUSED: 'fused', SENSOR_ONLY: 'sensor’s kept', SFM_ONLY: 'SfM’s kept'}
    curves = [(names[source], plots.SOURCE_INKS[source], *facts.overlap.curve(source)) for source in names]
    rows = [_check_row(names[source], facts.overlap.summary(source)) for source in names]
    rows.append(_check_row('all of the overlap', facts.overlap.summary()))
    if facts.later:
        table, seen, hidden = facts.later.compared()
        rows.append(_check_row(f'added, measured from nearby ({percent(seen)})', table.summary()))
        nearby = (f'The sensor measures {percent(seen)} of the added points from a viewpoint within 2°, which is found '
                  f'by the run’s own poses. For {percent(hidden)} it sees something more than a tenth nearer. That is taken '
                  'to be in front of the point, and is not compared.')
    checks = layout.table('Differences between SfM’s and the sensor’s depth, compared with their stated σ',
                          ['', 'pixels', 'median', 'within 10 %', 'inside 2σ', 'beyond 5σ', 'spread / σ'],
                          [row for row in rows if row])
    if any(len(curve[2]) for curve in curves):
        parts.append(layout.plots(layout.plot(
            plots.stated_and_shown(curves), 'Spread of the differences between SfM’s and the sensor’s depth by the stated '
            'standard deviation, on logarithmic axes; on the dotted line the stated σ is right',
            'Pixels where both have a depth: spread of the differences (1.4826 × median) by their stated σ. Above the dotted '
            'line the stated σ is too small.')))
    parts.append(layout.paragraph(
        'Right would be: 95.4 % inside 2σ, 0 % beyond 5σ, spread / σ = 1. Fused pixels have passed a test of agreement, so '
        'they differ by less than is stated. Where the sensor’s depth was kept, pixels are beside steps or in contradictions. '
        + nearby, 'note'))
    return layout.section('How sure it is', stated, checks, *parts)


def _check_row(name, summary):
    if 'rmse' not in summary:
        return None
    return [name, count(summary), percent(summary['median_relative']),
            percent(summary['within_10_percent']), percent(summary['inside_2_sigma']),
            percent(summary['beyond_5_sigma'], 2), f'{summary["sigma_ratio"]:.2f}']


def count(summary):
    return f'{summary["count"]:,}'.replace(',', '\u202f')


def truth(facts):
    sequence = facts.truth.sequence
    remarks = {'outside mirrors': '', 'interior': ', off edges', 'in mirrors': ', in mirrors'}
    rows = [[source + remarks[place], count(s), length(s['rmse']), percent(s['median_relative'], 2),
             percent(s['within_10_percent']), percent(s['inside_2_sigma']), percent(s['beyond_5_sigma'], 2),
             f'{s["nees25"]:.2f}'] for source, place, s in facts.truth.rows()]
    if sequence.exact:
        words = ('The truth is exact. Off edges means: more than 5 px from its steps and holes. In mirrors the truth is the '
                 'depth of the glass, though images and SfM show mirrored things.')
    else:
        words = ('The truth is recorded sensor depth. It cannot judge depth that was made from it. So only added depth is '
                 'compared, and only where the run was given no sensor depth.')
    if not rows:
        words += ' There are no such pixels here.'
    errors = layout.table(f'Errors of the depth by source, of {facts.truth.frames} frames',
                          ['', 'pixels', 'RMSE', 'median', 'within 10 %', 'inside 2σ', 'beyond 5σ', 'NEES25'], rows)
    return layout.section('Against the truth', layout.paragraph(words), errors if rows else '', layout.paragraph(
        'NEES25 is the mean of min(e²/σ², 25): 1 for a right σ.', 'note') if rows else '')


def true_motion(run, sequence):
    """Errors in words, and true positions in the axes of the run's trajectory; None, None without a truth."""
    if sequence is None or run.trajectory is None:
        return None, None
    estimate, true = run.trajectory, sequence.ground_truth
    try:
        ate, _ = trajectories.absolute_error(estimate, true)
    except ValueError as error:
        return f'There is no trajectory error: {error}.', None
    _, size = trajectories.absolute_error(estimate, true, with_scale=True)
    metres, degrees = trajectories.relative_error(estimate, true)
    e, t = trajectories.matches(estimate, true)
    R, translation, _ = trajectories.align(true.positions[t], estimate.positions[e])
    inside = (true.stamps >= estimate.stamps[0]) & (true.stamps <= estimate.stamps[-1])
    words = (f'Against the true poses: absolute error {length(ate)} (root mean square, best alignment), '
             f'{1 / size:.4f} of the true size')
    if not np.isnan(metres):
        words += f'; over one second {length(metres)} and {degrees:.2f}°'
    return words + '.', true.positions[inside] @ R.T + translation


def starts(run):
    """Indices of the trajectory at which a further run begins."""
    if 'run' not in run.table:
        return []
    first = run.stamps[1:][np.diff(run.table['run']) != 0]
    return [int(np.searchsorted(run.trajectory.stamps, stamp)) for stamp in first] if len(first) else []


def motion(run, sequence):
    if run.trajectory is None:
        return layout.section('Motion', layout.paragraph('No frame was tracked.'))
    words, true = true_motion(run, sequence)
    shown = [(run.name, run.trajectory.positions, starts(run))]
    steps = np.linalg.norm(np.diff(run.trajectory.positions, axis=0), axis=1).sum()
    figures = [layout.plot(plots.trajectories(shown, *view, truth=true), f'Path of the camera, seen from {name}',
                           f'The camera’s path from {name}, in the axes of its first image; a dot marks its start.')
               for view, name in ((ABOVE, 'above'), (SIDE, 'the side'))]
    table = run.table
    alpha = table['alpha']
    if np.isfinite(alpha).any():
        figures.append(layout.plot(
            plots.scale([(run.name, run.seconds(), alpha, table['sigma_alpha'], table['refused'] > 0)]),
            f'Scale from tracker units to metres over time, with its band of two standard deviations; median '
            f'{np.nanmedian(alpha):.4f}',
            f'The scale α from tracker units to the sensor’s metres, with ± 2σ. Median {np.nanmedian(alpha):.4f}, '
            f'σ {percent(float(np.nanmedian(table["sigma_alpha"])), 2)}.'))
    keyframes = len(set(table['keyframe']) - {''})
    parts = [layout.paragraph(f'The camera moved {length(float(steps))} along its path, over {keyframes} '
                              f'keyframe{"s" if keyframes != 1 else ""}.')]
    if words:
        parts.append(layout.paragraph(words))
    return layout.section('Motion', *parts, layout.plots(*figures))


def stages(run):
    return {name[:-len('_ms')]: values for name, values in run.timing.items() if name.endswith('_ms')}


def times(run):
    by_stage = stages(run)
    rows = [[name] + [f'{value:.1f}' for value in np.percentile(values, (50, 95, 99))]
            for name, values in list(by_stage.items()) + [('all', sum(by_stage.values()))]]
    return layout.section(
        'Time', layout.table('Milliseconds a frame', ['', 'median', '95 % within', '99 % within'], rows),
        layout.plots(layout.plot(plots.times([(run.name, run.seconds(), by_stage)]),
                                 'Milliseconds of each stage over time, stacked', 'Milliseconds of each frame, by stage.')))


def about(run):
    given, changed = run.summary.get('input'), run.summary.get('changed_settings')
    rows = [['results', run.results or '–'], ['output', os.path.realpath(run.path)],
            ['image', f'{run.size[0]} × {run.size[1]} pixels'], ['version', version(run)], ['date', date(run)]]
    if given:
        rows = [['input', ', '.join(given['bags'])], ['colour', given['colour']], ['depth', given['depth']],
                ['calibration', given['calibration']]] + rows
    parts = [layout.table('', ['', ''], rows, text_columns=(1,))]
    if changed is None:
        parts.append(layout.paragraph('These results do not say which settings differ from the default. All settings are '
                                      'in summary.json.', 'note'))
    elif changed:
        parts.append(layout.table('Settings that differ from the default', ['', 'this run', 'default'],
                                  [[name, str(run.settings[name]), str(default)] for name, default in changed.items()]))
    else:
        parts.append(layout.paragraph('All settings are the default ones.'))
    return layout.section('This run', *parts)
