# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Plots of runs, as SVG. Each takes [(name, what it shows)], of one run or of several."""

import io

import matplotlib
import numpy as np

matplotlib.use('Agg')
from matplotlib import pyplot  # noqa: E402
from matplotlib.ticker import FuncFormatter  # noqa: E402

INK, MUTED, GRID = '#22262b', '#5c6670', '#e3e6e8'
RUN_COLOURS = ('#1f5a8c', '#b4531f', '#3d7a45', '#7a4a8c', '#8a7a1f', '#555555')
SOURCE_INKS = {1: '#8b949c', 2: '#c79a00', 3: '#c8281e', 4: '#1f4fd8'}  # the paper's, so dark that they show on white
_STYLE = {'svg.fonttype': 'none', 'svg.hashsalt': 'rgbd_sfm_fusion', 'font.family': 'sans-serif',
          'font.sans-serif': ['DejaVu Sans', 'Helvetica', 'Arial'], 'font.size': 12.5, 'axes.edgecolor': '#b9c0c6',
          'axes.labelcolor': INK, 'text.color': INK, 'xtick.color': MUTED, 'ytick.color': MUTED, 'axes.linewidth': 0.8,
          'axes.grid': True, 'grid.color': GRID, 'grid.linewidth': 0.8, 'axes.axisbelow': True,
          'axes.spines.top': False, 'axes.spines.right': False, 'legend.frameon': False, 'legend.fontsize': 11.5,
          'lines.linewidth': 1.6, 'figure.facecolor': 'none', 'axes.facecolor': 'none'}
_MOST_POINTS = 600  # points of a curve
_SIZE = 6.2, 3.3    # [in]


def binned(x, y, most=_MOST_POINTS):
    """x, and median, least and largest y. Many points are joined into groups of neighbours."""
    if len(x) <= most:
        return x, y, y, y
    edges = np.linspace(0, len(x), most + 1).astype(int)
    parts = [(x[a:b], y[a:b]) for a, b in zip(edges[:-1], edges[1:])]
    parts = [(a, b[np.isfinite(b)]) for a, b in parts]
    parts = [(a, b if b.size else np.array([np.nan])) for a, b in parts]
    return tuple(np.array([function(part[i]) for part in parts])
                 for i, function in ((0, np.mean), (1, np.median), (1, np.min), (1, np.max)))


class _Figure:
    """Draws with the page's style, and gives the SVG."""

    def __init__(self, size=_SIZE):
        self._context = matplotlib.rc_context(_STYLE)
        self._size = size

    def __enter__(self):
        self._context.__enter__()
        self.figure, self.axis = pyplot.subplots(figsize=self._size, constrained_layout=True)
        return self

    def __exit__(self, *error):
        pyplot.close(self.figure)
        return self._context.__exit__(*error)

    def curve(self, x, y, colour, label=None, band=True):
        x, middle, low, high = binned(np.asarray(x), np.asarray(y, float))
        self.axis.plot(x, middle, color=colour, label=label)
        if band and low is not middle:
            self.axis.fill_between(x, low, high, color=colour, alpha=0.18, linewidth=0)

    def svg(self):
        stream = io.StringIO()
        self.figure.savefig(stream, format='svg', metadata={'Date': None, 'Creator': None})
        return stream.getvalue()


def refilled(runs):
    """@param runs  [(name, seconds, share of the holes that were refilled)]"""
    with _Figure() as plot:
        for (name, seconds, values), colour in zip(runs, RUN_COLOURS):
            plot.curve(seconds, 100 * values, colour, name)
        plot.axis.set(xlabel='time [s]', ylabel='refilled [%]')
        plot.axis.set_ylim(bottom=0)
        plot.axis.margins(x=0)
        if len(runs) > 1:
            plot.axis.legend()
        return plot.svg()


def shares(seconds, coverage, sources):
    """All pixels by the source of their depth, stacked. @param coverage  {source: pixels of each frame}"""
    with _Figure() as plot:
        x = binned(seconds, seconds)[0]
        values = [100 * binned(seconds, coverage.by_source[source] / coverage.pixels)[1] for source in sources]
        plot.axis.stackplot(x, values, colors=[SOURCE_INKS[source] for source in sources], alpha=0.85, linewidth=0)
        bottom = np.cumsum(values, axis=0)
        names = {1: 'sensor only', 2: 'SfM only', 3: 'fused', 4: 'completed'}
        handles = [matplotlib.patches.Patch(color=SOURCE_INKS[source], label=names[source]) for source in sources]
        plot.axis.set(xlabel='time [s]', ylabel='pixels [%]', ylim=(0, max(100, bottom[-1].max())))
        plot.axis.margins(x=0)
        plot.axis.legend(handles=handles, loc='lower left', bbox_to_anchor=(0, 1), ncol=len(handles), handlelength=1)
        return plot.svg()


def trajectories(runs, axes, names, truth=None):
    """@param runs   [(name, N x 3 positions [m], starts of further runs)]
    @param axes   the two to draw, with signs: (0, 2, 1, 1)
    @param truth  N x 3, or None"""
    across, up, sign_across, sign_up = axes
    with _Figure((6.2, 4.4)) as plot:
        if truth is not None:
            plot.axis.plot(sign_across * truth[:, across], sign_up * truth[:, up], color='#9aa3ab', linewidth=3.5,
                           alpha=0.6, label='truth')
        for (name, positions, starts), colour in zip(runs, RUN_COLOURS):
            for i, part in enumerate(np.split(positions, starts)):
                part = part[::max(1, len(part) // 3000)]
                plot.axis.plot(sign_across * part[:, across], sign_up * part[:, up], color=colour,
                               label=name if i == 0 else None)
                plot.axis.plot(sign_across * part[0, across], sign_up * part[0, up], 'o', color=colour, markersize=6)
        plot.axis.set(xlabel=names[0], ylabel=names[1])
        plot.axis.set_aspect('equal', adjustable='datalim')
        plot.axis.margins(0.08)
        if truth is not None or len(runs) > 1:
            plot.axis.legend()
        return plot.svg()


def scale(runs):
    """@param runs  [(name, seconds, alpha, its sigma, whether a fit was refused)]"""
    with _Figure() as plot:
        for (name, seconds, alpha, sigma, refused), colour in zip(runs, RUN_COLOURS):
            x, low, _, _ = binned(seconds, alpha - 2 * sigma)
            _, high, _, _ = binned(seconds, alpha + 2 * sigma)
            plot.axis.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0)
            plot.curve(seconds, alpha, colour, name if len(runs) > 1 else None, band=False)
            at = refused & np.isfinite(alpha)
            if at.any():
                plot.axis.plot(seconds[at], alpha[at], 'x', color=INK, markersize=5,
                               label='fit refused' if len(runs) == 1 else None)
        plot.axis.axhline(1, color=MUTED, linewidth=0.8, linestyle=':')
        plot.axis.set(xlabel='time [s]', ylabel='scale α')
        plot.axis.margins(x=0)
        if plot.axis.get_legend_handles_labels()[0]:
            plot.axis.legend()
        return plot.svg()


def stated_and_shown(curves):
    """@param curves  [(label, colour, stated σ [m], shown spread [m])]"""
    with _Figure((6.2, 4.2)) as plot:
        curves = [curve for curve in curves if len(curve[2])]
        values = np.concatenate([np.concatenate(curve[2:]) for curve in curves])
        ends = np.array([values.min() / 1.4, values.max() * 1.4])
        plot.axis.plot(ends, ends, color=MUTED, linewidth=1, linestyle=':', label='as stated')
        for label, colour, stated, shown in curves:
            plot.axis.plot(stated, shown, '-o', color=colour, markersize=4, label=label)
        plot.axis.set(xscale='log', yscale='log', xlim=ends, ylim=ends, xlabel='stated σ of the difference [m]',
                      ylabel='spread of the differences [m]')
        for axis in (plot.axis.xaxis, plot.axis.yaxis):
            axis.set_major_formatter(FuncFormatter(lambda value, _: f'{value:g}'))
            axis.set_minor_formatter(FuncFormatter(_some_ticks))
        plot.axis.legend()
        return plot.svg()


def _some_ticks(value, _):
    digit = round(value / 10.0 ** np.floor(np.log10(value)))
    return f'{value:g}' if digit in (2, 5) else ''


def times(runs):
    """@param runs  [(name, seconds, {stage: ms of each frame})]; one run's stages are stacked, several runs show their sums"""
    inks = ('#b9c6d2', '#5b86ad', '#1f4d78', '#b4531f')
    with _Figure() as plot:
        if len(runs) == 1:
            _, seconds, stages = runs[0]
            x = binned(seconds, seconds)[0]
            plot.axis.stackplot(x, [binned(seconds, values)[1] for values in stages.values()], colors=inks, linewidth=0)
            handles = [matplotlib.patches.Patch(color=ink, label=stage) for ink, stage in zip(inks, stages)]
            plot.axis.legend(handles=handles, loc='lower left', bbox_to_anchor=(0, 1), ncol=len(handles), handlelength=1)
            total = sum(stages.values())
            plot.axis.set_ylim(0, 1.3 * np.percentile(total, 99))
        else:
            for (name, seconds, stages), colour in zip(runs, RUN_COLOURS):
                plot.curve(seconds, sum(stages.values()), colour, name)
            plot.axis.set_ylim(bottom=0)
            plot.axis.legend()
        plot.axis.set(xlabel='time [s]', ylabel='milliseconds a frame')
        plot.axis.margins(x=0)
        return plot.svg()
