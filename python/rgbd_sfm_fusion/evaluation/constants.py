# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The constants of the method, as they stand in the sources (constexpr k… = …), and settings' default values."""

import os
import re

STAGES = 'image', 'tracking', 'mapping', 'odometry', 'sensor', 'fusion', 'completion'
_CONSTANT = re.compile(r'constexpr\s+(?:auto|float|double|int|Stamp|std::\w+(?:<[^;=]*>)?)\s[^;]*?;')
_NAME = re.compile(r'\b(k[A-Z]\w*)\s*=\s*([^,;]*\d[^,;]*)')
_CONSTANT_NAME = re.compile(r'\bk[A-Z]\w*')
_OTHER_NUMBER = re.compile(r'(?<![\w.])(?![12](?:\.0)?[Ff]?(?![\w.]))[\d.]*\d')
_SETTING = re.compile(r'^  (?:float|double|int)\s+(\w+)\s*=\s*[-\d.][^;]*;', re.MULTILINE)
_OPTIONS = re.compile(r'struct (?:\w+Options|DepthNoiseModel) \{.*?^\};', re.MULTILINE | re.DOTALL)


def sources(package, stage):
    """Yields (path, text without comments) of a stage's files."""
    for root in (os.path.join('src', stage), os.path.join('include', 'rgbd_sfm_fusion', stage)):
        folder = os.path.join(package, root)
        for name in sorted(os.listdir(folder)):
            with open(os.path.join(folder, name), encoding='utf-8') as file:
                yield os.path.join(root, name), re.sub(r'//.*', '', file.read())


def follows(value):
    """Whether a value is made of constants alone, and of the numbers 1 and 2."""
    return bool(_CONSTANT_NAME.search(value)) and not _OTHER_NUMBER.search(_CONSTANT_NAME.sub('', value))


def named(text):
    """(name, value as text) of all constants of a text."""
    return [found for statement in _CONSTANT.findall(text) for found in _NAME.findall(statement)]


def independent(text):
    return [name for name, value in named(text) if not follows(value)]


def following(text):
    return [name for name, value in named(text) if follows(value)]


def settings(text):
    return [name for options in _OPTIONS.findall(text) for name in _SETTING.findall(options)]
