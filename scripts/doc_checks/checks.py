# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""Each check gives sentences about faults. No sentence means that all is well."""

import os
import re

from . import written

TOPICS, SETTINGS, CAMERA = 'docs/topics.md', 'docs/settings.md', 'docs/astra.md'
_TOPIC = re.compile(r'(?<![\w.:/$}{])/(?:tracker|fusion)(?:/\w+)+')
_CAMERA_TOPIC = re.compile(r'(?<![\w.:/$}{])/camera(?:/\w+)+')
_ROW = re.compile(r'^\|\s*`(\w+)`\s*\|')
# snake_case, camelCase() and CamelCase
_IDENTIFIER = re.compile(r'(?<![\w./-])(?:[a-z][a-z0-9]*(?:_[a-z0-9]+)+(?![\w/-]|\.\w)|[a-z]+[A-Z]\w*(?=\()|'
                         r'[A-Z][a-z0-9]+[A-Z]\w*)')
_PLACE = re.compile(r'`([A-Za-z]\w*(?:::\w+)*)(?:\(\))?` in `([\w./-]+\.(?:h|cpp))`')
_ASSIGNMENT = re.compile(r'--set ([a-z]\w*)=')
_LAUNCH_FILE = re.compile(r'\b(\w+\.launch)\b')
_LAUNCH_ARGUMENT = re.compile(r'(?<![\w/])([a-z]\w*):=')
_OPTION = re.compile(r'(?<![\w-])--[a-z][\w-]*')
_TOO = {'fuse': ('fuse_bag', 'tum_to_bag')}  # programs to which scripts pass options on
# Names of other projects: one name in a line; a remark may follow after #.
with open(os.path.join(os.path.dirname(os.path.realpath(__file__)), 'names_of_others.txt')) as _file:
    _OTHERS = {_line.split('#')[0].strip() for _line in _file} - {''}
_FOREIGN = ('cmake', 'rosdep', 'sudo', 'apt', 'git', 'rosbag', 'ctest', 'dpkg', 'pip', 'g++', 'docker')


def _rows(page):
    """Names in the first column of the page's tables."""
    return {found.group(1) for _, line in page.prose() for found in [_ROW.match(line)] if found}


def _page(pages, name):
    return next((page for page in pages if page.name == name), None)


def _missing(pages, name):
    return [] if _page(pages, name) else [f'{name} is not there']


def topics(tree, pages):
    """Every topic, service, message and parameter is in docs/topics.md. No page has a topic or service that is gone."""
    page = _page(pages, TOPICS)
    if not page:
        return _missing(pages, TOPICS)
    text = '\n'.join(page.lines)
    there, services = tree.topics(), tree.services()
    said = set(_TOPIC.findall(text)) | set(_CAMERA_TOPIC.findall(text))
    found = [f'{TOPICS}: topic {topic} is not documented' for topic in sorted(there - said)]
    found += [f'{TOPICS}: service {service} is not documented' for service in sorted(services - said)]
    found += [f'{TOPICS}: message {name}.msg is not documented' for name in sorted(tree.messages())
              if not re.search(rf'\b{name}\b', text)]
    found += [f'{TOPICS}: parameter {name} is not documented' for name in sorted(tree.parameters())
              if f'`{name}`' not in text]
    found += [f'{name}: a nodelet that scripts/doc_checks/tree.py does not know' for name in tree.unknown_nodelets()]
    known = there | services
    for each in pages:
        for number, line in enumerate(each.lines, 1):
            names = _TOPIC.findall(line) + (_CAMERA_TOPIC.findall(line) if each.name == TOPICS else [])
            found += [f'{each.name}:{number}: there is no topic or service {name}' for name in names
                      if not any(other == name or other.startswith(name + '/') for other in known)
                      and not name.endswith('/set_parameters')]
    return found


def settings(tree, pages):
    """docs/settings.md has the settings of the table; docs/astra.md has the settings of the camera."""
    found = []
    for name, there in ((SETTINGS, tree.settings()), (CAMERA, tree.camera_settings())):
        page = _page(pages, name)
        if not page:
            found += _missing(pages, name)
            continue
        words_of_page = {word for _, span in page.spans() for word in re.findall(r'\w+', span)}
        said = _rows(page) if name == SETTINGS else words_of_page
        found += [f'{name}: setting {each} is not documented' for each in sorted(there - said)]
        if name == SETTINGS:
            found += [f'{name}: there is no setting {each}' for each in sorted(said - there)]
    for page in pages:
        for number, line in enumerate(page.lines, 1):
            found += [f'{page.name}:{number}: there is no setting {each}' for each in _ASSIGNMENT.findall(line)
                      if each not in tree.settings() and each != 'key' and each != 'name']
    return found


def launch_arguments(tree, pages):
    """Launch files and arguments that pages name exist. (written_parts() checks that pages name all of them.)"""
    files = tree.launch_files()
    every = {argument.name for arguments in files.values() for argument in arguments}
    found = []
    for page in pages:
        for number, line in page.code_text() + page.spans():
            named = [name for name in _LAUNCH_FILE.findall(line) if name not in _OTHERS]
            found += [f'{page.name}:{number}: there is no {name}' for name in named if name not in files]
            named = [name for name in named if name in files]
            if 'rosrun' in line and 'roslaunch' not in line:
                continue  # the line has remappings, not arguments
            allowed = {argument.name for name in named for argument in files[name]} if named else every
            whose = f'{" and ".join(named)} has no' if named else 'no launch file has an'
            found += [f'{page.name}:{number}: {whose} argument {name}' for name in _LAUNCH_ARGUMENT.findall(line)
                      if name not in allowed | _OTHERS]
    return found


def _logical_lines(page):
    """(line number, text) of commands. Lines that go on after a backslash are joined."""
    lines, begun = [], None
    for number, line in page.code_text():
        text = (begun[1] + ' ' if begun else '') + line.strip().rstrip('\\').strip()
        begun = (begun[0] if begun else number, text)
        if not line.rstrip().endswith('\\'):
            lines.append(begun)
            begun = None
    return lines + page.spans()


def options(tree, pages):
    """An option in a page is an option of the command before it."""
    commands = {name: {each for option in of for each in option.names} for name, of in tree.commands().items()}
    shell = {os.path.basename(name): set(_OPTION.findall(tree.text(name))) for name in tree.matching('scripts/*')
             if os.path.basename(name) not in commands}
    every = set().union(*commands.values(), *shell.values()) | {'--help'}
    found = []
    for page in pages:
        for number, line in _logical_lines(page):
            if line.split(' ')[0] in _FOREIGN or re.search(r'\brosbag |\brosrun (?!rgbd_sfm_fusion)', line):
                continue
            names = [name for name in re.findall(r'[\w]+', line.split('#')[0]) if name in commands or name in shell]
            names += [other for name in names for other in _TOO.get(name, ())]
            allowed = every
            if names:
                allowed = set().union({'--help'}, *(commands.get(name) or shell[name] for name in names))
            whose = f'{" or ".join(names)} has no' if names else 'no command has an'
            found += [f'{page.name}:{number}: {whose} option {option}' for option in _OPTION.findall(line.split(' #')[0])
                      if option not in allowed]
    return found


def written_parts(tree, pages):
    found = [f'no page has the part "{name}" ({written.begin_of(name)})' for name in written.missing_parts(pages, tree)]
    return found + [f'{page.name}: what is written from the sources is not as it should be: run '
                    'scripts/check_docs --write' for page in pages
                    if written.rewritten(page, tree) != '\n'.join(page.lines)]


def words(tree, pages):
    """A word in backticks that looks like a name of the code is in the code."""
    sources, endings = set(), set()
    for name in tree.names:
        if not name.endswith(('.md', '.jpg', '.png')):
            sources.update(re.findall(r'\w+', tree.text(name)))
            sources.update(re.split(r'[/.]', name))
            endings.update(re.findall(r'[)}]((?:_[a-z]+)+)\b', tree.text(name)))  # $(arg camera)_rgb_frame
    endings = tuple(endings)
    return [f'{page.name}:{number}: `{word}` is nowhere in the package' for page in pages
            for number, span in page.spans() for word in _IDENTIFIER.findall(span)
            if word not in sources and word not in _OTHERS and not word.endswith(endings)]


def places(tree, pages):
    """If a page says which file has a name, the file has the name. (citations.py checks that the file exists.)"""
    return [f'{page.name}:{number}: `{name}` is not in {file}' for page in pages for number, line in page.prose()
            for name, file in _PLACE.findall(line)
            if tree.has(file) and not set(name.split('::')) <= set(re.findall(r'\w+', tree.text(file)))]


def links(tree, pages):
    """Links lead to files and headings that exist."""
    found = []
    for page in pages:
        for number, target in page.links():
            if re.match(r'[a-z]+:', target):
                continue
            path, _, anchor = target.partition('#')
            name = os.path.normpath(os.path.join(os.path.dirname(page.name), path)) if path else page.name
            other = _page(pages, name)
            if not tree.has(name):
                found.append(f'{page.name}:{number}: the link to {target} leads nowhere')
            elif anchor and other and anchor not in other.anchors:
                found.append(f'{page.name}:{number}: {name} has no heading #{anchor}')
    return found
