# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Builds of the package with other values of its constants."""

import os
import re
import shutil
import subprocess

PROGRAMS = 'fuse_bag', 'render_sequence', 'tum_to_bag'


def replaced(text, name, value):
    """The text with another value for a constant, and how many constants of this name it has."""
    return re.subn(rf'(\bconstexpr\b[^;]*?\b{name}\s*=\s*)[^,;]+', lambda match: match.group(1) + value, text)


def changed(texts, change):
    """@param texts   {path: text} of the sources
    @param change  "NAME=VALUE", or "FILE:NAME=VALUE" with a part of the path"""
    match = re.fullmatch(r'(?:(\S+):)?(k[A-Z]\w*)=(.+)', change)
    if not match:
        raise ValueError(f'"{change}": expected kName=VALUE, or file:kName=VALUE')
    part, name, value = match.groups()
    found = {path: new for path, text in texts.items() if (part or '') in path
             for new, count in [replaced(text, name, value)] if count}
    if len(found) != 1:
        where = ', '.join(sorted(found)) or 'nowhere'
        raise ValueError(f'"{change}": {name} is set in {where}; expected one file, see scripts/count_constants --list')
    return {**texts, **found}


def sources(package):
    """{path: text} of the core's files."""
    names = subprocess.run(['git', '-C', package, 'ls-files', 'src', 'include'], check=True, capture_output=True, text=True)
    texts = {}
    for path in names.stdout.split():
        with open(os.path.join(package, path), encoding='utf-8') as file:
            texts[path] = file.read()
    return texts


def write(package, texts, folder):
    """Copies the package with these texts. Writes only what differs, so that the next build is short."""
    names = subprocess.run(['git', '-C', package, 'ls-files'], check=True, capture_output=True,
                           text=True).stdout.split('\n')
    for path in filter(None, names):
        target = os.path.join(folder, path)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        if path not in texts:
            shutil.copy2(os.path.join(package, path), target)
            continue
        if os.path.exists(target):
            with open(target, encoding='utf-8') as file:
                if file.read() == texts[path]:
                    continue
        with open(target, 'w', encoding='utf-8') as file:
            file.write(texts[path])


def build(folder, jobs):
    """Builds what scripts/evaluate needs, and returns the folder of the programs."""
    result = os.path.join(folder, '_build')
    launcher = ['-DCMAKE_CXX_COMPILER_LAUNCHER=ccache'] if shutil.which('ccache') else []
    # What is the same in several folders is compiled once.
    environment = {**os.environ, 'CCACHE_BASEDIR': os.path.realpath(folder), 'CCACHE_NOHASHDIR': '1'}
    subprocess.run(['cmake', '-S', folder, '-B', result, *launcher], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(['cmake', '--build', result, '-j', str(jobs), '--target', *PROGRAMS], check=True, env=environment,
                   stdout=subprocess.DEVNULL)
    return os.path.join(result, 'devel', 'lib', 'rgbd_sfm_fusion')


def evaluate(package, programs, work, inputs, arguments, *more):
    """Runs scripts/evaluate, and returns the path of its results."""
    subprocess.run([os.path.join(package, 'scripts', 'evaluate'), '--tools', programs, '--work', work, '--inputs', inputs,
                    *more, *arguments], check=True, stdout=None if more else subprocess.DEVNULL)
    return os.path.join(work, 'last.json')
