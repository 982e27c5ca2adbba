# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Checks references in comments and pages: to pages and their sections, to the paper's equations, and to files."""

import os
import re

EQUATIONS = 12  # of the paper
_SOURCES = ('*.h', '*.cpp', '*.py', '*.cmake', '*.cfg', '*.launch', '*.yaml', '*.msg', '*.in', '*CMakeLists.txt',
            'scripts/*', '.ci/*', 'cmake/*')
# Documents by their names in capitals, with a section. Conferences have a year, no section.
_DOCUMENT = re.compile(r'(?<![\w-])([A-Z]{4,})(?:\.md)?,? (?:section \d+|\d+\.\d+)')
_PAGE = re.compile(r'\b((?:docs/)?[A-Za-z]*[a-z][A-Za-z_]*\.md)'
                   r'(?:#([\w-]+)|,? (?:sections? )?(\d+(?:\.\d+)?)(?![\d.]*\w)'
                   r'(?:(?: to |, | and )(\d+(?:\.\d+)?)(?![\d.]*\w))?)?')
_EQUATION = re.compile(r'\bEqs?\.? ?(\d+)(?:(?: to |, | and |–|-)(\d+))?')
_PATH = re.compile(r'(?<![\w/.$}{>-])(?:docs|scripts|src|include|test|config|launch|cmake|rviz|msg|benchmark|cfg|'
                   r'examples|python|\.ci)/(?![\w/.-]*\.md)(?![\w/.-]*[A-Z]{3,}\b)[\w/.-]*\w')
_FILE = re.compile(r'(?<![\w/.<-])([a-z]\w+\.(?:h|cpp|launch|cfg))\b(?!\w)')
_CODE_FILE = re.compile(r'(?<![\w/.<-])([a-z]\w+\.(?:h|cpp|cfg))\b(?!\w)')


def _is_of_another(before):
    """Whether an equation is another author's, with the author named before, as in "(Engel et al. 2013, …)"."""
    before = before[-60:]
    cited = max(before.rfind('et al'), *(found.end() for found in re.finditer(r'(?:19|20)\d\d', before)), -1)
    return cited >= 0 and 'aper' not in before[cited:] and not re.search(r'[.;:]\s', before[cited + 6:])


def comment(line, is_python=False):
    """The part of a line that is a comment. In Python, strings may be comments too, so the whole line counts."""
    if is_python or line.startswith('#include'):
        return '' if line.startswith('#include') else re.sub(r'\bself\.\w+', '', line)
    for mark in ('//', '<!--'):
        if mark in line and '://' not in line[max(0, line.find(mark) - 1):line.find(mark) + 2]:
            return line[line.find(mark):]
    return line if re.match(r'\s*(#|\*|/\*)', line) else ''


def check(tree, pages):
    by_name = {page.name: page for page in pages}
    basenames = {os.path.basename(name) for name in tree.names}
    found = []

    def add(where, text):
        found.append(f'{where}: {text}')

    def look(name, number, text, before='', files=_FILE):
        where = f'{name}:{number}'
        for document in _DOCUMENT.findall(text):
            if f'{document}.md' not in basenames:
                add(where, f'cites {document}, which is not in the package')
        for page, anchor, *sections in _PAGE.findall(text):
            target = by_name.get(page) or by_name.get('docs/' + page)
            if not target:
                add(where, f'cites {page}, which is not there')
                continue
            for section in filter(None, sections):
                if section not in target.numbered_sections():
                    add(where, f'cites section {section} of {page}, which it does not have')
            if anchor and anchor not in target.anchors:
                add(where, f'cites #{anchor} of {page}, which it does not have')
        for equation in _EQUATION.finditer(text):
            for value in filter(None, equation.groups()):
                cited = before[-60:] + ' ' + text[:equation.start()]  # an author may be named in the line before
                if not 1 <= int(value) <= EQUATIONS and not _is_of_another(cited):
                    add(where, f'cites Eq. {value}; the paper has {EQUATIONS}')
        for path in _PATH.findall(text):
            if not tree.has(path):
                add(where, f'names {path}, which is not there')
        for file in files.findall(text):
            if file not in basenames:
                add(where, f'names {file}, which is not there')

    for name in tree.matching(*_SOURCES):
        if name.startswith('scripts/doc_checks') or name.startswith('test/python/test_docs'):
            continue  # examples
        is_python = name.endswith('.py') or tree.text(name).startswith('#!/usr/bin/python3')
        before = ''
        for number, line in enumerate(tree.text(name).split('\n'), 1):
            text = comment(line, is_python)
            look(name, number, text, before)
            before = text
    for page in pages:
        for number, line in page.prose():
            # Links and launch files are checked as such.
            look(page.name, number, re.sub(r'\]\([^)]*\)', ']', line), files=_CODE_FILE)
    return found
