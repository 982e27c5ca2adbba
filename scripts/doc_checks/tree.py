# SPDX-FileCopyrightText: 2026 rgbd_sfm_fusion developers
# SPDX-License-Identifier: BSD-3-Clause
"""The package's files, and the names in them that a user meets: topics, services, parameters, settings, launch arguments
and command options. All names are read from the sources, so nothing has to be built or run."""

import ast
import fnmatch
import os
import re
import xml.etree.ElementTree

from .pages import Page

# The names that the launch files give to the nodelets. They tell which topic is whose.
NODELETS = {'src/nodelets/tracker_nodelet.cpp': '/tracker', 'src/nodelets/fusion_nodelet.cpp': '/fusion',
            'src/nodelets/camera_nodelet.cpp': '/camera'}
_INCLUDE = re.compile(r'#include "([^"]+)"')
_ADVERTISE = re.compile(r'\badvertise(?:<[^;(]*?>)?\(\s*(?:"([\w/]+)")?\s*(\+?\s*topic\.name)?')
_PICTURE = re.compile(r'\badvertisePicture\(\s*\w+,\s*(?:"([\w/]+)"|(topic\.name))')
_SERVICE = re.compile(r'\badvertiseService\(\s*"([\w/]+)"')
_TABLE_USED = re.compile(r':\s*(\w+ImageTopics)\(\)')
_OPTION = re.compile(r'\badd_(?:option|flag)\(\s*"(-[^"]+)"\s*,.*?((?:"(?:[^"\\]|\\.)*"\s*)+)\)', re.DOTALL)
_PARAMETER = re.compile(r'\bparam(?:<[^;(]*?>)?\(\s*"(\w+)"')


class Option:
    """A command's option, e.g. `--set KEY=VALUE`."""

    def __init__(self, names, value, text):
        self.names, self.value, self.text = names, value, text


class Argument:
    """A launch file's argument. @param default  None if the argument has to be given"""

    def __init__(self, name, default, text):
        self.name, self.default, self.text = name, default, text


class Tree:
    """@param root  folder of the package; folders in it that begin with _ or . are left out, except .ci"""

    def __init__(self, root):
        self.root, self._texts, self.names = root, {}, []
        for folder, folders, files in os.walk(root):
            folders[:] = sorted(name for name in folders if name[0] not in '_.' or name == '.ci')
            inside = os.path.relpath(folder, root)
            self.names += [os.path.normpath(os.path.join(inside, name)) for name in sorted(files)]
        self._here = set(self.names)

    def has(self, name):
        name = os.path.normpath(name)
        return name in self._here or os.path.isdir(os.path.join(self.root, name))

    def text(self, name):
        if name not in self._texts:
            with open(os.path.join(self.root, name), errors='replace') as file:
                self._texts[name] = file.read()
        return self._texts[name]

    def matching(self, *patterns):
        return [name for name in self.names if any(fnmatch.fnmatch(name, pattern) for pattern in patterns)]

    def pages(self):
        return [Page(name, self.text(name)) for name in self.matching('README.md', 'CONTRIBUTING.md', 'docs/*.md')]

    # --- what a user meets --------------------------------------------------------------------------------

    def topics(self):
        """{full name} of the nodelets' topics, with the names that the launch files give to the nodelets."""
        topics = set()
        for nodelet, namespace in NODELETS.items():
            for name in self._closure(nodelet):
                topics.update(f'{namespace}/{topic}' for topic in self._advertised(name))
        return topics

    def services(self):
        return {f'{namespace}/{service}' for nodelet, namespace in NODELETS.items()
                for name in self._closure(nodelet) for service in _SERVICE.findall(self.text(name))}

    def parameters(self):
        """Private parameters of the nodelets that are not in the table of settings."""
        return {name for file in self.matching('src/nodelets/*.cpp') for name in _PARAMETER.findall(self.text(file))}

    def unknown_nodelets(self):
        return [name for name in self.matching('src/nodelets/*_nodelet.cpp') if name not in NODELETS]

    def _closure(self, name, seen=None):
        """Files of src/nodelets that make up a nodelet."""
        seen = set() if seen is None else seen
        if name in seen or name not in self._here:
            return seen
        seen.add(name)
        if name.endswith('.h'):
            self._closure(name[:-2] + '.cpp', seen)
        for included in _INCLUDE.findall(self.text(name)):
            self._closure('src/nodelets/' + included, seen)
        return seen

    def _advertised(self, name):
        text = self.text(name)
        tables = [entry for table in _TABLE_USED.findall(text) for entry in self._table(table)]
        topics = set()
        for prefix, of_table in _ADVERTISE.findall(text) + _PICTURE.findall(text):
            topics.update([prefix + entry for entry in tables] if of_table else [prefix] if prefix else [])
        if 'advertiseCamera(name + "/image_raw"' in text:
            topics.update(f'{camera}/{kind}' for camera in self._cameras() for kind in ('image_raw', 'camera_info'))
        return topics

    def _cameras(self):
        return re.findall(r'\badd\("(\w+)"', self.text('src/nodelets/camera_nodelet.cpp'))

    def _table(self, function):
        for name in self.matching('src/ros/*.cpp'):
            found = re.search(function + r'\(\) \{(.*?)\n\}', self.text(name), re.DOTALL)
            if found:
                return re.findall(r'\{"(\w+)",', found.group(1))
        return []

    def messages(self):
        return {os.path.basename(name)[:-4] for name in self.matching('msg/*.msg')}

    def settings(self):
        """Names in the table of settings."""
        text = self.text('src/settings/table.cpp')
        names = re.findall(r'\b(?:number|integer|boolean|choice|noise)\(\s*"(\w+)"', text)
        return set(names + re.findall(r'describeChoice\(\s*\{[^}]*\},\s*"(\w+)"', text))

    def camera_settings(self):
        return set(re.findall(r"gen\.add\('(\w+)'", self.text('cfg/OpenNI2Camera.cfg')))

    def launch_files(self):
        """{file name: [Argument]}"""
        return {os.path.basename(name): self._arguments(name) for name in self.matching('launch/*.launch')}

    def _arguments(self, name):
        root = xml.etree.ElementTree.fromstring(self.text(name))
        return [Argument(arg.get('name'), arg.get('default'), ' '.join(arg.get('doc', '').split()))
                for arg in root.findall('arg') if arg.get('value') is None]

    def commands(self):
        """{name: [Option]} of programs and of Python scripts."""
        found = {os.path.basename(name)[:-4]: self._program_options(name) for name in self.matching('src/apps/*.cpp')}
        for name in self.matching('scripts/*'):
            if name.count('/') == 1 and self.text(name).startswith('#!/usr/bin/python3'):
                found[os.path.basename(name)] = self._script_options(name)
        return {name: options for name, options in found.items() if options}

    def _program_options(self, name):
        options = []
        for text in [self.text(name)] + [self.text(header) for header in self._headers_beside(name)]:
            for names, strings in _OPTION.findall(text):
                # A flag and its opposite: --blur,!--no-blur
                names = [each.strip().lstrip('!') for each in names.split(',')]
                parts = re.findall(r'"((?:[^"\\]|\\.)*)"', strings)
                options.append(Option(names, '', ''.join(parts).replace('\\"', '"')))
        return options

    def _headers_beside(self, name):
        folder = os.path.dirname(name)
        return [folder + '/' + included for included in _INCLUDE.findall(self.text(name))
                if folder + '/' + included in self._here]

    def _script_options(self, name):
        return self._added_options(ast.parse(self.text(name)))

    def _added_options(self, code):
        """Options that code adds to a parser, itself or by a function of this package that takes the parser."""
        options = []
        for node in ast.walk(code):
            if not isinstance(node, ast.Call):
                continue
            function = getattr(node.func, 'attr', getattr(node.func, 'id', ''))
            if function in ('add', 'add_argument'):
                options += self._option(node)
            elif any(getattr(each, 'id', '') == 'parser' for each in node.args):
                options += self._options_of_function(getattr(getattr(node.func, 'value', None), 'id', ''), function)
        return options

    def _options_of_function(self, module, function):
        for name in self.matching(f'scripts/*/{module}.py', f'python/*/{module}.py'):
            for node in ast.walk(ast.parse(self.text(name))):
                if isinstance(node, ast.FunctionDef) and node.name == function:
                    return self._added_options(node)
        return []

    @staticmethod
    def _option(call):
        names = [each.value for each in call.args if isinstance(each, ast.Constant)]
        if not names or not str(names[0]).startswith('--'):
            return []
        keywords = {each.arg: each.value.value for each in call.keywords if isinstance(each.value, ast.Constant)}
        metavar = next((each.value for each in call.keywords if each.arg == 'metavar'), None)
        value = ' '.join(part.value for part in getattr(metavar, 'elts', [metavar]) if part is not None)
        return [Option(names, value, ' '.join(str(keywords.get('help', '')).split()))]
