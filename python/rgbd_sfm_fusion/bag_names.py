# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Bags as a launch file's argument names them: one, or several with spaces in between. Names with spaces may be quoted as
in a shell, and need not be."""

import os
import shlex


def find_bags(text, folder):
    """Paths of the bags that `text` names, relative to `folder`; `~` is the home folder.

    Raises FileNotFoundError whose text says which one there is not. Empty where none is named.
    """
    def path_of(name):
        return os.path.join(folder, os.path.expanduser(name))

    text = text.strip()
    if os.path.isfile(path_of(text)):
        return [path_of(text)]
    try:
        quoted = [path_of(name) for name in shlex.split(text)] if any(mark in text for mark in '\'"\\') else []
    except ValueError:  # an apostrophe in a name
        quoted = []
    if quoted and all(os.path.isfile(path) for path in quoted):
        return quoted

    words = text.split(' ')
    paths = []
    while words:
        # The longest name of a file that there is.
        for count in range(len(words), 0, -1):
            path = path_of(' '.join(words[:count]))
            if os.path.isfile(path):
                paths.append(path)
                break
            if count == 1 and words[0]:
                whole = path_of(text)
                raise FileNotFoundError(f'there is no bag {path}' + ('' if path == whole else f', and none named {whole}'))
        words = words[count:]
    return paths


def bags_of_environment():
    """find_bags() of BAGS in BAGS_FOLDER, as launch files hand them on: names may have any character in them."""
    return find_bags(os.environ.get('BAGS', ''), os.environ.get('BAGS_FOLDER', '/'))
