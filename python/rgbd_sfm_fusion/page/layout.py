# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""HTML of a page that needs no other file."""

import base64
import html
import math

from . import pictures

STYLE = '''
:root { --ink: #22262b; --muted: #5c6670; --line: #d9dde0; --paper: #fcfcfa; --accent: #1f5a8c; }
* { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; text-size-adjust: 100%; }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 16px/1.55 "Helvetica Neue", Helvetica, Arial, "Liberation Sans", sans-serif; }
main, header, footer { max-width: 74rem; margin: 0 auto; padding: 0 1.25rem; }
header { padding-top: 2.5rem; }
h1, h2, .lede { font-family: Charter, "Bitstream Charter", Georgia, "Liberation Serif", serif; }
h1 { font-size: 2rem; line-height: 1.15; font-weight: 600; margin: 0 0 .35rem; overflow-wrap: anywhere; }
h2 { font-size: 1.35rem; line-height: 1.25; font-weight: 600; margin: 3rem 0 .75rem; padding-top: 1rem;
  border-top: 1px solid var(--line); }
h3 { font-size: 1rem; margin: 1.5rem 0 .4rem; }
p { max-width: 44rem; margin: .5rem 0 1rem; }
.lede { font-size: 1.3rem; line-height: 1.5; margin: 1.5rem 0 0; }
.lede p { max-width: 50rem; margin: .6rem 0; }
.muted, figcaption, .note { color: var(--muted); }
.note { font-size: .9rem; }
table { border-collapse: collapse; font-size: .95rem; font-variant-numeric: tabular-nums; }
.table { overflow-x: auto; margin: 0 0 1rem; }
.caption { color: var(--muted); font-size: .9rem; margin: 1rem 0 .2rem; }
th, td { padding: .35rem .9rem .35rem 0; text-align: right; vertical-align: baseline;
  border-bottom: 1px solid var(--line); }
th { font-weight: 600; }
th[scope=row], td.text { text-align: left; font-weight: normal; }
thead th { border-bottom: 1px solid var(--ink); }
thead th:first-child { text-align: left; }
td.text { overflow-wrap: anywhere; }
figure { margin: 0; }
figcaption { font-size: .85rem; line-height: 1.35; padding-top: .25rem; }
img { display: block; width: 100%; height: auto; }
.plots { display: grid; gap: 1.5rem 2.5rem; grid-template-columns: repeat(auto-fit, minmax(min(26rem, 100%), 1fr)); }
.plots figure { max-width: 38rem; }
.frame { margin: 0 0 1.5rem; }
.frame > p { margin: 0 0 .3rem; font-size: .9rem; color: var(--muted); }
.columns { display: grid; gap: .6rem; grid-template-columns: repeat(var(--columns, 5), minmax(0, 1fr)); }
.columns img { image-rendering: auto; background: #000; }
.keys { display: flex; flex-wrap: wrap; gap: .8rem 2.5rem; font-size: .85rem; color: var(--muted); margin: 0 0 1.25rem; }
.bar i { display: block; width: 13rem; height: .7rem; border: 1px solid var(--line); }
.bar span { display: flex; justify-content: space-between; }
.sources { display: flex; flex-wrap: wrap; gap: .2rem 1rem; align-items: center; }
.swatch { display: inline-block; width: .85em; height: .85em; margin-right: .35em; border: 1px solid #666;
  vertical-align: -.05em; }
.slider { display: flex; gap: 1rem; align-items: center; margin-bottom: .8rem; max-width: 44rem; }
.slider input { flex: 1; accent-color: var(--accent); min-width: 0; }
.slider output { min-width: 5em; font-variant-numeric: tabular-nums; }
footer { margin-top: 3rem; padding-top: 1rem; padding-bottom: 2rem; font-size: .85rem; color: var(--muted);
  border-top: 1px solid var(--line); }
@media (max-width: 44rem) {
  body { font-size: 15px; }
  main, header, footer { padding-left: 1rem; padding-right: 1rem; }
  header { padding-top: 1.5rem; }
  h1 { font-size: 1.5rem; }
  .lede { font-size: 1.12rem; }
  .columns { --columns: 2 !important; }
  .columns figure:first-child:nth-last-child(odd) { grid-column: span 2; }
  th, td { padding-right: .6rem; }
  table { font-size: .85rem; }
  th[scope=row] { min-width: 6.5em; }
}
@media print { .slider, .more { display: none; } h2 { break-after: avoid; } figure { break-inside: avoid; } }
'''

_SLIDER = '''
document.querySelectorAll('.more').forEach(function (more) {
  var frames = more.querySelectorAll('.frame'), slider = more.querySelector('input');
  function show() {
    frames.forEach(function (frame, i) { frame.hidden = i != slider.value; });
    more.querySelector('output').textContent = frames[slider.value].dataset.time;
  }
  slider.addEventListener('input', show);
  more.querySelector('.slider').hidden = false;
  show();
});
'''

text = html.escape


def page(title, subtitle, lede, sections):
    """@param subtitle, lede, sections  HTML"""
    return f'''<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<title>{text(title)}</title>
<link rel="icon" href="data:,"/>
<style>{STYLE}</style>
</head>
<body>
<header>
<h1>{text(title)}</h1>
<p class="muted">{subtitle}</p>
<div class="lede">{lede}</div>
</header>
<main>
{"".join(sections)}
</main>
<footer>Method: Chandrashekar, Papadakis, Willis and Gantert, <cite>Structure-From-Motion and RGBD Depth Fusion</cite>,
2018. Page by rgbd_sfm_fusion.</footer>
<script>{_SLIDER}</script>
</body>
</html>
'''


def section(title, *parts):
    return f'<section>\n<h2>{text(title)}</h2>\n{"".join(parts)}\n</section>\n'


def paragraph(words, kind=''):
    return f'<p{_class(kind)}>{text(words)}</p>\n'


def _class(kind):
    return f' class="{kind}"' if kind else ''


def table(caption, head, rows, text_columns=()):
    """@param rows  of cells; the first of each is its title. Strings are escaped
    @param text_columns  indices of columns that hold no numbers"""
    def cell(index, words):
        if index == 0:
            return f'<th scope="row">{text(words)}</th>'
        return f'<td{_class("text" if index in text_columns else "")}>{text(words)}</td>'
    lines = ''.join('<tr>' + ''.join(cell(i, words) for i, words in enumerate(row)) + '</tr>\n' for row in rows)
    titles = ''.join(f'<th scope="col"{_style(i in text_columns)}>{text(words)}</th>' for i, words in enumerate(head))
    # Outside the table, so that it does not scroll with a wide one.
    above = f'<p class="caption">{text(caption)}</p>\n' if caption else ''
    label = f' aria-label="{text(caption)}"' if caption else ''
    head = f'<thead><tr>{titles}</tr></thead>\n' if any(head) else ''
    return f'{above}<div class="table"><table{label}>\n{head}<tbody>\n{lines}</tbody></table></div>\n'


def _style(is_text):
    return ' style="text-align:left"' if is_text else ''


def plot(svg, alternative, caption):
    data = base64.b64encode(svg.encode()).decode()
    return (f'<figure><img src="data:image/svg+xml;base64,{data}" alt="{text(alternative)}"/>'
            f'<figcaption>{text(caption)}</figcaption></figure>\n')


def plots(*figures):
    return f'<div class="plots">{"".join(figures)}</div>\n'


def frame(title, time, cells, hidden=False):
    """One row of pictures. @param cells  [(Picture, alternative text, caption)]"""
    figures = ''.join(
        f'<figure><img src="{picture.uri}" width="{picture.width}" height="{picture.height}" alt="{text(alternative)}"/>'
        f'<figcaption>{text(caption)}</figcaption></figure>' for picture, alternative, caption in cells)
    return (f'<div class="frame" data-time="{text(time)}"{" hidden=" + chr(34) * 2 if hidden else ""}><p>{text(title)}</p>'
            f'<div class="columns" style="--columns:{len(cells)}">{figures}</div></div>\n')


def slider(frames):
    """@param frames  as frame() makes them; all but the first hidden"""
    return (f'<div class="more"><div class="slider" hidden=""><label for="slider">Frame</label><input id="slider" '
            f'type="range" min="0" max="{len(frames) - 1}" value="0"/><output for="slider"></output></div>\n'
            f'<noscript><p class="note">The slider needs JavaScript; the frames above do not.</p></noscript>'
            f'{"".join(frames)}</div>\n')


def keys(depth_limit, sources):
    """The legend of the pictures. @param sources  [(colour, name)]"""
    low, high = pictures.SIGMA_ENDS
    bars = ''.join(
        f'<div class="bar">{name}<i style="background:{gradient}"></i><span><b>{left}</b><b>{right}</b></span></div>'
        for name, gradient, left, right in (
            ('Depth (black: none)', pictures.DEPTH_GRADIENT, '0 m', f'{depth_limit:g} m'),
            ('Standard deviation, logarithmic (grey: none)', pictures.SIGMA_GRADIENT, f'{1e3 * low:g} mm', f'{high:g} m')))
    swatches = ''.join(f'<span><i class="swatch" style="background:rgb({colour[0]} {colour[1]} {colour[2]})"></i>'
                       f'{text(name)}</span>' for colour, name in sources)
    return f'<div class="keys">{bars}<div class="sources">{swatches}</div></div>\n'


def percent(value, decimals=1):
    """A share from 0 to 1 as text."""
    if value is None or math.isnan(value):
        return '–'
    least = 10.0 ** -decimals
    if 0 < 100 * value < least / 2:
        return f'below {least:g}\u00a0%'
    return f'{100 * value:.{decimals}f}\u00a0%'


def length(metres):
    if metres is None or math.isnan(metres):
        return '–'
    if metres < 0.01:
        return f'{1e3 * metres:.1f}\u00a0mm'
    return f'{1e2 * metres:.1f}\u00a0cm' if metres < 1 else f'{metres:.2f}\u00a0m'
