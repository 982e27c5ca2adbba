# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The parts of Markdown that are needed here: headings, links, words in backticks, and code."""

import re

_FENCE = re.compile(r'^\s*(```|~~~)')
_HEADING = re.compile(r'^(#{1,6})\s+(.*?)\s*#*\s*$')
_ANCHOR = re.compile(r'<a\s+(?:id|name)="([^"]+)"')
_LINK = re.compile(r'!?\[(?:[^\]\[]|\[[^\]]*\])*\]\(\s*([^)\s]+)[^)]*\)')
_HTML_LINK = re.compile(r'<(?:img|a)\s[^>]*(?:src|href)="([^"]+)"')
_SPAN = re.compile(r'(`+)(.+?)\1')


def slug(heading):
    """The anchor that GitHub makes of a heading."""
    text = re.sub(r'[^\w\- ]', '', re.sub(r'[`*]|<[^>]*>', '', heading).strip().lower())
    return text.replace(' ', '-')


class Page:
    """@param name  path in the package"""

    def __init__(self, name, text):
        self.name, self.lines = name, text.split('\n')
        self.code = self._code_lines()      # whether a line is in a block of code
        self.headings = []                  # (line, level, text)
        self.anchors = set()
        for number, line in self.prose():
            found = _HEADING.match(line)
            if found:
                self.headings.append((number, len(found.group(1)), found.group(2)))
                self._add_anchor(slug(found.group(2)))
            self.anchors.update(_ANCHOR.findall(line))

    def _add_anchor(self, anchor):
        """Adds the anchor of a heading. GitHub numbers headings of the same text."""
        candidate, count = anchor, 0
        while candidate in self.anchors:
            count += 1
            candidate = f'{anchor}-{count}'
        self.anchors.add(candidate)

    def _code_lines(self):
        code, fence, before_is_blank = [], None, True
        for line in self.lines:
            found = _FENCE.match(line)
            if fence or found:
                code.append(True)
                if found and (not fence or found.group(1) == fence):
                    fence = None if fence else found.group(1)
                before_is_blank = not fence
                continue
            indented = line.startswith('    ')
            is_code = indented and (before_is_blank or code[-1]) or not line.strip() and bool(code) and code[-1]
            code.append(is_code)
            before_is_blank = not line.strip()
        return code

    def prose(self):
        """(line number from 1, text) of lines that are not code."""
        return [(i + 1, line) for i, line in enumerate(self.lines) if not self.code[i]]

    def links(self):
        """(line number, target)"""
        return [(number, target) for number, line in self.prose()
                for target in _LINK.findall(_SPAN.sub('', line)) + _HTML_LINK.findall(line)]

    def spans(self):
        """(line number, text in backticks)"""
        return [(number, text) for number, line in self.prose() for _, text in _SPAN.findall(line)]

    def code_text(self):
        """(line number, text) of lines of code."""
        return [(i + 1, line) for i, line in enumerate(self.lines) if self.code[i]]

    def section(self, title):
        """Numbers of the lines below the heading whose text, without backticks, is `title`; None without such a heading."""
        for index, (number, level, text) in enumerate(self.headings):
            if text.replace('`', '') == title:
                ends = [other for other, depth, _ in self.headings[index + 1:] if depth <= level]
                return range(number + 1, ends[0] if ends else len(self.lines) + 1)
        return None

    def numbered_sections(self):
        """Numbers of headings such as `## 3. Reprojection` or `### 3.1 Gaps`."""
        return {found.group(1) for _, _, text in self.headings
                for found in [re.match(r'(\d+(?:\.\d+)?)\.?\s', text)] if found}
