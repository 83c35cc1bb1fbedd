# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the installed configuration lies, and how its files are read."""

import os
from pathlib import Path
import stat
import sys

import yaml

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError

PACKAGE = 'quad_ident_ros'
MOST_BYTES = 2 ** 18        # of a YAML file, thirty times the longest of those that ship
MOST_VALUES = 20_000        # in it, each counted as often as an alias repeats it
EMPTY = 'the file is empty; save or copy it again'
MOST_BITS = 64              # of a whole number: stamps and seeds have no more


def config_dir():
    """Return the folder `config/`, from the source tree, an ament prefix or the Python prefix."""
    source = Path(__file__).resolve().parents[1]
    prefixes = [p for p in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep) if p]
    candidates = [source] if (source / 'package.xml').exists() else []
    candidates += [Path(prefix) / 'share' / PACKAGE for prefix in [*prefixes, sys.prefix]]
    for candidate in candidates:
        if (candidate / 'config').is_dir():
            return candidate / 'config'
    raise InputError(f'the folder share/{PACKAGE}/config was not found: install {PACKAGE} again, '
                     'or source its workspace')


def names(kind):
    """Return the sorted names of the files that ship in config/<kind>."""
    return sorted(path.stem for path in (config_dir() / kind).glob('*.yaml'))


def find(kind, name_or_path):
    """
    Return the path of a shipped file by its name, or of a user's file by its path.

    Raises InputError that lists the shipped names where there is no such file.
    """
    text = str(name_or_path)
    if os.sep in text or os.path.splitext(text)[1]:
        path = _existing(text)
        if path is None:
            said = text if text.isprintable() and len(text) < 300 else schema.shown(text)
            _refuse_folder(text, said)
            problem = ('this is not a file' if _existing(text, Path.exists) else
                       'there is no such file')
            raise InputError(f'{said}: {problem}; give the path of one, or a name: '
                             f'{", ".join(names(kind))}')
        return path
    shipped = _existing(config_dir() / kind / f'{text}.yaml')
    path = shipped or _existing(text)
    if path is not None:
        return path
    _refuse_folder(text, schema.shown(text))
    shipped_names = names(kind)
    mend = (schema.suggestion(text, shipped_names)
            or 'give one of these or the path of a .yaml file')
    raise InputError(f'{schema.shown(text)} is not among the {kind} ({", ".join(shipped_names)}); '
                     f'{mend}')


def _refuse_folder(path, said):
    if _existing(path, Path.is_dir) is not None:
        raise InputError(f'{said}: this is a folder; name a file in it')


def _existing(path, kind=Path.is_file):
    """Return the path of a file, or of another kind, that exists, or None."""
    try:
        path = Path(path).expanduser()
        return path if kind(path) else None
    # No such user, no permission, a name that is too long or no name at all.
    except (OSError, RuntimeError, ValueError):
        return None


def read_yaml(path):
    """Return the mapping in a YAML file; raises InputError with file and line where it fails."""
    try:
        data = yaml.load(_text_of(path), _Loader)   # a SafeLoader
    except FileNotFoundError:
        raise InputError(f'{path}: there is no such file; check its path') from None
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    except UnicodeDecodeError:
        what = kind_of(path)
        raise InputError(f'{path}: ' + (f'this is {what}; ' if what else 'is not text in UTF-8; ')
                         + 'expected a YAML file') from None
    except InputError:
        raise
    except yaml.YAMLError as error:
        mark = getattr(error, 'problem_mark', None)
        where = f', line {mark.line + 1}' if mark else ''
        problem = getattr(error, 'problem', None) or str(error).splitlines()[0]
        raise InputError(f'{path}{where}: is not YAML: {problem}') from None
    # PyYAML lets these through, for a date such as 2001-99-99 or brackets a thousand deep.
    except (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError,
            ValueError) as error:
        raise InputError(f'{path}: holds a value that cannot be read: '
                         f'{schema.shown(str(error))}') from None
    if not isinstance(data, dict):
        raise InputError(f'{path}: expected `key: value` lines')
    _refuse_endless(path, data)
    return data


class _Loader(yaml.SafeLoader):
    """
    One that refuses a key that occurs twice, and mappings that are merged without end.

    PyYAML takes the last value of such a key in silence. Nine levels of nine merged mappings
    would be 4e8 keys.
    """

    def compose_mapping_node(self, anchor):
        """Return the node of a mapping; raises YAMLError where it has a key twice."""
        node = super().compose_mapping_node(anchor)
        lines = {}
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode):
                name = key.tag, key.value
                if name in lines:
                    raise yaml.MarkedYAMLError(
                        problem=f'{schema.shown(key.value)} is given twice, first in line '
                        f'{lines[name]}; remove one of them', problem_mark=key.start_mark)
                lines[name] = key.start_mark.line + 1
        return node

    def flatten_mapping(self, node):
        """Merge what `<<` names into a mapping; raises YAMLError where that is too much."""
        super().flatten_mapping(node)
        if len(node.value) > MOST_VALUES:
            raise yaml.MarkedYAMLError(problem=f'more than {MOST_VALUES} keys are merged',
                                       problem_mark=node.start_mark)


def _text_of(path):
    """Return the text of a file; raises InputError for a device, a pipe, and by its size."""
    about = Path(path).stat()
    mode = about.st_mode
    if stat.S_ISCHR(mode) or stat.S_ISBLK(mode):
        raise InputError(f'{path}: this is a device; name a file')
    if stat.S_ISFIFO(mode):     # opening it may wait for ever, and it is read more than once
        raise InputError(f'{path}: this is a pipe; save it to a file and name that')
    if stat.S_ISREG(mode) and not about.st_size:    # /proc/kmsg, too: reading it waits for ever
        raise InputError(f'{path}: {EMPTY}')
    with open(path, 'rb') as file:
        data = file.read(MOST_BYTES + 1)
    what = kind_of(path) if len(data) > MOST_BYTES else ''
    if what:
        raise InputError(f'{path}: this is {what}; expected a YAML file')
    if len(data) > MOST_BYTES:
        raise InputError(f'{path}: is larger than {MOST_BYTES // 1024} kB: no YAML file that is '
                         'read here is; name another')
    return data.decode('utf-8')


def kind_of(path):
    """Return what a file is by its content, such as a picture or a log, or ''."""
    from quad_ident_ros.data.readers.others import START, title_of
    from quad_ident_ros.data.readers.registry import READERS
    with open(path, 'rb') as file:
        start = file.read(START)
    known = (reader.title for reader in READERS if reader.recognises(Path(path), start))
    return title_of(start) or next(known, '')


def _refuse_endless(path, data):
    """Raise InputError for data whose aliases stand for more than anyone writes, or for ever."""
    rest, count = [data], 0
    while rest:
        value = rest.pop()
        count += 1
        if count > MOST_VALUES:
            raise InputError(f'{path}: holds more than {MOST_VALUES} values, aliases followed; '
                             'write out what is meant')
        if isinstance(value, dict):
            rest += value
            rest += value.values()
        elif isinstance(value, list | tuple | set):
            rest += value
        elif isinstance(value, int) and value.bit_length() > MOST_BITS:
            raise InputError(f'{path}: holds a whole number of about '
                             f'{int(value.bit_length() * 0.30103) + 1} digits; no value has so '
                             'many')
