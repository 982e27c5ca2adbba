# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""What the command line tools have in common."""

import importlib
import os
import sys
import tempfile

_PACKAGES = {'cv2': 'python3-opencv', 'matplotlib': 'python3-matplotlib', 'numpy': 'python3-numpy',
             'rosbag': 'python3-rosbag', 'yaml': 'python3-yaml'}


def run(name, main):
    """Calls main(). What is wrong with files is one line."""
    try:
        main()
    except (OSError, ValueError) as error:
        words = str(error)
        if getattr(error, 'errno', None) and error.filename is None:  # rosbag writes a module for each type of message
            words = f'{error.strerror}, of a temporary file in {tempfile.gettempdir()}'
        raise SystemExit(f'{name}: {words}')
    except Exception as error:
        if not type(error).__module__.startswith('rosbag'):
            raise
        cure = ': apt-get install python3-roslz4' if 'lz4' in str(error) else ''
        raise SystemExit(f'{name}: cannot read the bag: {error}{cure}')
    except KeyboardInterrupt:
        raise SystemExit(f'{name}: interrupted')


def require(*modules):
    for module in modules:
        try:
            importlib.import_module(module)
        except ImportError as error:
            raise OSError(f'{_PACKAGES[module]} is missing ({error}): apt-get install {_PACKAGES[module]}')


def require_writable(path):
    """That a file can be written there, before any work."""
    if os.path.isdir(path):
        raise OSError(f'cannot write {path}: it is a folder, expected the name of a file')
    folder = os.path.dirname(path) or '.'
    if not os.path.isdir(folder):
        raise OSError(f'cannot write {path}: there is no folder {folder}')
    if not os.access(folder, os.W_OK):
        raise OSError(f'cannot write {path}: Permission denied')


def write(path, content):
    """The file appears when it is complete. @param content  text, or bytes"""
    partial = path + '.partial'
    try:
        with open(partial, 'wb') as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        os.replace(partial, path)
    except OSError as error:
        if os.path.exists(partial):
            os.remove(partial)
        raise OSError(f'cannot write {path}: {error.strerror}')


def require_results(of):
    """@param of  a runs.Run"""
    if not of.results:
        raise ValueError(f'found no results of {of.path} beside it (a folder with summary.json): name the folder that '
                         'fuse_bag wrote with --results DIR')


def add_input(parser):
    parser.add_argument('--input', metavar='BAG', nargs='+', help='bags that fuse_bag has read (default: from the results)')
    parser.add_argument('--rgb', metavar='TOPIC', help='topic of their colour images (default: from the results)')
    parser.add_argument('--depth', metavar='TOPIC', help='topic of their depth images (default: from the results)')
    parser.add_argument('--calibration', metavar='FILE', help='calibration of their camera (default: from the results)')


def recording(options, of):
    """The recordings.Recording that options of add_input() name; None where there is none."""
    from . import recordings
    given = of.summary.get('input', {})
    paths = options.input or [path for path in given.get('bags', []) if os.path.exists(path)]
    if not options.input and len(paths) != len(given.get('bags', [])):
        print(f'the input {", ".join(given["bags"])} is not there any more: going on without; --input names another',
              file=sys.stderr)
        return None
    if not paths:
        return None
    return recordings.Recording([os.path.expanduser(path) for path in paths],
                                options.rgb or given.get('colour', recordings.COLOUR),
                                options.depth or given.get('depth', recordings.DEPTH),
                                options.calibration or given.get('calibration'),
                                float(of.settings.get('depth_scale', 1e-3)),
                                float(of.settings.get('saturated_depth', 0)))
