# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Which figures change with a constant of the method."""

import re

import numpy as np

# What fusion and completion do is not fed back: their figures have no chance.
_FED_BACK = 'image', 'tracking', 'mapping', 'odometry', 'sensor'
# name, path in the results of scripts/evaluate, factor, format, whether it is a share of pixels
FIGURES = [
    ('ATE [mm]', 'plain/ate', 1000, '{:.2f}', False),
    ("poses' NEES/6", 'plain/second_nees', 1, '{:.2f}', False),
    ('SfM before fusion [%]', 'plain/sfm_density', 100, '{:.1f}', True),
    ('error before fusion [%]', 'plain/before_fusion_interior/median_relative', 100, '{:.2f}', False),
    ('NEES before fusion', 'plain/before_fusion_interior/nees25', 1, '{:.2f}', False),
    ('fused NEES', 'plain/fused/nees25', 1, '{:.2f}', False),
    ('refilled, sure [%]', 'plain/refilled_sure', 100, '{:.1f}', True),
    ('held out: ATE [mm]', 'held-out/ate', 1000, '{:.2f}', False),
    ('held out: SfM only [%]', 'held-out/held_out/coverage', 100, '{:.1f}', True),
    ('error of SfM only [%]', 'held-out/held_out/median_relative', 100, '{:.2f}', False),
    ('NEES of SfM only', 'held-out/held_out/nees25', 1, '{:.2f}', False),
    ('held out: completed [%]', 'held-out/held_out_completed/coverage', 100, '{:.1f}', True),
    ('error of completed [%]', 'held-out/held_out_completed/median_relative', 100, '{:.2f}', False),
    ('NEES of completed', 'held-out/held_out_completed/nees25', 1, '{:.2f}', False)]
_LEAST_RELATIVE, _LEAST_SHARE = 0.02, 0.5
_CHANCE = 3.0  # standard deviations
_TITLE = """# What each constant does

Constants of the method, halved and doubled, one at a time, in two rendered rooms that no figure elsewhere is of (seeds
101 and 103, 120 frames each, at 30 Hz with a global shutter). [method.md](method.md#13-the-constants-of-fusion) says where
each comes from. A figure is named if it changes by more than 2 % (a share of pixels: by more than 0.5 % of all), and by more
than three times its σ by chance. In fusion and completion there is no chance: what they do is not fed back. So a constant
that changes nothing is a size that may be half or twice as large, as far as these rooms tell. They do not tell what happens after
a loss, under a rolling shutter, or to an image of another size. "does not build": other numbers rest on it.

Written by `scripts/vary_constants --stages fusion --write docs/constants.md`. Without `--stages` it tries all, for hours.

"Held out": a run without sensor depth in the farthest quarter of the scene. Depth of SfM only, and completed depth, are
judged there.
"""


def halved_and_doubled(value):
    """Two other values of a constant, as text. Of a share between 0.5 and 1, what is missing to 1 is halved and doubled."""
    number, suffix = re.fullmatch(r'(.*?)([FfUu]?)', value).groups()
    if re.fullmatch(r'\d+', number):
        return [str(other) + suffix for other in ((int(number) + 1) // 2, 2 * int(number)) if other != int(number)]
    if not re.fullmatch(r'\d+\.\d*(e-?\d+)?|\d+e-?\d+', number):
        return [f'({value}) / 2', f'({value}) * 2']
    number = float(number)
    others = ((1 + number) / 2, 2 * number - 1) if 0.5 < number < 1 else (number / 2, number * 2)
    return [np.format_float_positional(other, 6, unique=True, fractional=False, trim='0') + suffix for other in others]


def figures(results):
    """The figures of one column of results, None where there is none."""
    found = []
    for _, path, factor, _, _ in FIGURES:
        value = results
        for name in path.split('/'):
            value = value.get(name) if isinstance(value, dict) else None
        found.append(None if value is None else factor * value)
    return found


def changes(found, before, spread):
    """Texts of the figures that have changed.
    @param spread  standard deviations by chance"""
    texts = []
    for (name, _, _, form, is_share), value, old, chance in zip(FIGURES, found, before, spread):
        if value is None or old is None:
            continue
        least = _LEAST_SHARE if is_share else _LEAST_RELATIVE * abs(old)
        if abs(value - old) > max(least, _CHANCE * chance):
            texts.append((name, form.format(value)))
    return texts


def page(rows, measured):
    """The page of documentation.
    @param rows      (stage, path, name, value, other values) of each constant
    @param measured  {"path:name=value": figures, or text}, with those "as it is" and by "chance" """
    before = measured['as it is']
    by_chance = np.std(np.array(measured['chance'], float), axis=0)
    lines = [_TITLE, '| figure | as it is | σ by chance |', '|---|---|---|']
    lines += [f'| {name} | {form.format(value)} | {form.format(chance)} |'
              for (name, _, _, form, _), value, chance in zip(FIGURES, before, by_chance)]
    for stage in dict.fromkeys(row[0] for row in rows):
        lines += ['', f'## {stage}', '', '| constant | value | other values, and what changes |', '|---|---|---|']
        spread = by_chance if stage in _FED_BACK else np.zeros_like(by_chance)
        for _, path, name, value, others in (row for row in rows if row[0] == stage):
            tried = [(other, measured.get(f'{path}:{name}={other}')) for other in others]
            cell = '; '.join(f'**{other}**: {_text(found, before, spread)}' for other, found in tried if found is not None)
            lines.append(f'| `{name}` | {value} | {cell or "not tried"} |')
    return '\n'.join(lines) + '\n'


def _text(found, before, spread):
    if isinstance(found, str):
        return found
    return ', '.join(f'{name} → {text}' for name, text in changes(found, before, spread)) or 'nothing'
