# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The paper's figures of results: grey image, sensor depth, SfM depth, fused depth by source, deviation."""

import matplotlib
import numpy as np

matplotlib.use('Agg')
from matplotlib import pyplot  # noqa: E402
from matplotlib.colors import ListedColormap  # noqa: E402
from matplotlib.patches import Patch  # noqa: E402

SOURCES = ['none', 'sensor only', 'SfM only', 'fused', 'completed']
SOURCE_COLOURS = ['black', 'white', 'yellow', 'red', 'blue']
TITLES = ['(a) grey image', '(b) sensor depth', '(c) SfM depth', '(d) fused depth by source',
          '(e) standard deviation']


def _limit(images, percentile):
    """A round upper end of a colour bar; most values are below."""
    values = np.concatenate([image[~np.isnan(image)] for image in images] + [np.array([1e-3])])
    top = np.percentile(values, percentile)
    step = 10.0 ** np.floor(np.log10(top)) / 2
    return step * np.ceil(top / step)


def draw(frames, path):
    """@param frames dicts of grey, sensor, sfm, provenance, deviation (H x W; NaN = none) and title; sfm may be None"""
    depth_limit = _limit([frame[name] for frame in frames for name in ('sensor', 'sfm') if frame[name] is not None],
                         99.5)
    deviation_limit = _limit([frame['deviation'] for frame in frames], 99)
    depth_style = {'cmap': pyplot.get_cmap('turbo').with_extremes(bad='black'), 'vmin': 0, 'vmax': depth_limit}
    styles = {
        'grey': {'cmap': 'gray', 'vmin': 0, 'vmax': 255},
        'sensor': depth_style,
        'sfm': depth_style,
        'provenance': {'cmap': ListedColormap(SOURCE_COLOURS), 'vmin': -0.5, 'vmax': 4.5},
        'deviation': {'cmap': pyplot.get_cmap('viridis_r').with_extremes(bad='0.25'), 'vmin': 0,
                      'vmax': deviation_limit},
    }
    figure = pyplot.figure(figsize=(20, 3.1 * len(frames) + 0.8), layout='constrained')
    images = {}
    grid = figure.add_gridspec(len(frames) + 1, 5, height_ratios=[1] * len(frames) + [0.05])
    for y, frame in enumerate(frames):
        for x, (name, style) in enumerate(styles.items()):
            axis = figure.add_subplot(grid[y, x], xticks=[], yticks=[])
            if frame[name] is not None:
                images[name] = axis.imshow(frame[name], interpolation='nearest', **style)
            else:
                axis.text(0.5, 0.5, 'not in the bag', ha='center', va='center', transform=axis.transAxes)
            if y == 0:
                axis.set_title(TITLES[x], fontsize='x-large')
            if x == 0:
                axis.set_ylabel(frame['title'], fontsize='large')
    bar = {'orientation': 'horizontal', 'extend': 'max'}
    figure.colorbar(images['sensor'], cax=figure.add_subplot(grid[-1, 1:3]),
                    label='depth [m] (black: none)', **bar)
    figure.colorbar(images['deviation'], cax=figure.add_subplot(grid[-1, 4]),
                    label='standard deviation [m] (grey: none)', **bar)
    legend = figure.add_subplot(grid[-1, 3])
    legend.axis('off')
    legend.legend(handles=[Patch(facecolor=colour, edgecolor='black', label=name)
                           for colour, name in zip(SOURCE_COLOURS, SOURCES)],
                  loc='upper center', ncol=5, frameon=False, handlelength=1.2, columnspacing=1.0)
    figure.savefig(path, dpi=100, bbox_inches='tight')
    pyplot.close(figure)

