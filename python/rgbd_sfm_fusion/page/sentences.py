# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""What a run gained, in three sentences."""

from ..runs import COMPLETED, SFM_ONLY
from .facts import ADDED, share
from .layout import length, percent

_MANY = 0.1  # so large a share of the added points speaks for all
INSIDE = '95.4\u00a0% would be right'  # of a Gaussian, inside two σ


def sentences(facts):
    return [_added(facts), _stated(facts), _checked(facts)]


def _added(facts):
    coverage, run = facts.coverage, facts.run
    frames = f'{len(run)} frames ({run.seconds()[-1]:.1f} s)'
    without = percent(coverage.without_sensor_share())
    if coverage.added.sum() == 0:
        return f'In {frames}, {without} of the pixels have no usable depth from the sensor, and none of them got a depth.'
    parts = ''
    if coverage.has_completed and coverage.by_source[COMPLETED].sum() > 0:
        whole = coverage.without_sensor.sum()
        parts = (f': {percent(share(coverage.by_source[SFM_ONLY].sum(), whole))} from motion, '
                 f'{percent(share(coverage.by_source[COMPLETED].sum(), whole))} completed between measured depths of one '
                 'surface')
    return (f'In {frames}, {without} of the pixels have no usable depth from the sensor; {percent(coverage.total_refilled())} '
            f'of these were refilled ({percent(coverage.added_share())} of all pixels){parts}.')


def _stated(facts):
    sigma = facts.sigmas.quantiles(*ADDED)
    if sigma is None:
        return 'There is no added depth whose deviation could be stated.'
    return (f'Half of the added depth has a stated standard deviation of at most {length(sigma["median"])} '
            f'({percent(sigma["relative_median"])} of the depth), and nine tenths of it at most '
            f'{length(sigma["ninth"])} ({percent(sigma["relative_ninth"])}).')


def _checked(facts):
    if facts.truth:
        errors = facts.truth.of_added()
        if 'rmse' in errors:
            what = 'the exact depth' if facts.truth.sequence.exact else 'the recorded depth that the run was not given'
            return (f'Against {what}, the added depth is wrong by {percent(errors["median_relative"])} in the median; '
                    f'{percent(errors["inside_2_sigma"])} of it is within two stated deviations ({INSIDE}), and '
                    f'{percent(errors["beyond_5_sigma"])} is beyond five.')
    found = facts.overlap.summary() if facts.overlap else {}
    if 'rmse' not in found:
        return ('Nothing in this run can tell how right that is: too few pixels are known for which sensor and SfM both have '
                'a depth.')
    where = (f'Where sensor and SfM both have a depth ({percent(share(facts.overlap.pixels, facts.overlap.all_pixels))} of '
             f'the pixels), they differ by {percent(found["median_relative"])} in the median, and '
             f'{percent(found["inside_2_sigma"])} of the differences are within two stated deviations ({INSIDE})')
    later, seen, _ = facts.later.compared()
    summary = later.summary()
    if seen < _MANY or 'rmse' not in summary:
        return where + '.'
    return (f'{where}; {percent(seen)} of the added points are measured by the sensor from a viewpoint nearby, where the '
            f'difference is {percent(summary["median_relative"])} in the median, and '
            f'{percent(summary["inside_2_sigma"])} are within two deviations.')
