# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Parts of pages that are written from the sources: between `<!-- written by check_docs: NAME -->` and
`<!-- end of NAME -->`."""

import re

from . import figures


def _cell(text):
    return text.replace('|', '\\|')


def _table(head, rows):
    lines = ['| ' + ' | '.join(head) + ' |', '|' + '---|' * len(head)]
    return lines + ['| ' + ' | '.join(_cell(cell) for cell in row) + ' |' for row in rows]


def _default(argument):
    if argument.default is None:
        return 'has to be given'
    return f'`{argument.default}`' if argument.default else 'empty'


def launch_arguments(tree):
    lines = []
    for name, arguments in sorted(tree.launch_files().items()):
        lines += [f'### `{name}`', '']
        lines += _table(['argument', 'default', 'meaning'],
                        [[f'`{each.name}`', _default(each), each.text] for each in arguments]) + ['']
    return lines[:-1]


def command_options(tree):
    lines = []
    for name, options in sorted(tree.commands().items()):
        lines += [f'### `{name}`', '']
        lines += _table(['option', 'meaning'],
                        [[', '.join(f'`{each} {option.value}`'.replace(' `', '`') for each in option.names),
                          option.text] for option in options]) + ['']
    return lines[:-1]


def parts(tree):
    """{name: lines} of all parts."""
    return {'launch arguments': launch_arguments(tree), 'command options': command_options(tree), **figures.parts(tree)}


def begin_of(name):
    return f'<!-- written by check_docs: {name} -->'


def rewritten(page, tree):
    """The page's text, with all written parts brought up to date."""
    text = '\n'.join(page.lines)
    for name, lines in parts(tree).items():
        begin, end = begin_of(name), f'<!-- end of {name} -->'
        if begin in text and end in text:
            part = '\n'.join([begin, ''] + lines + ['', end])
            text = re.sub(re.escape(begin) + '.*?' + re.escape(end), lambda _: part, text, flags=re.DOTALL)
    return text


def missing_parts(pages, tree):
    """Names of parts that no page has."""
    text = '\n'.join('\n'.join(page.lines) for page in pages)
    return [name for name in parts(tree) if begin_of(name) not in text]
