# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which flights there are: named one by one, in a folder, or in a manifest."""

from collections.abc import Iterable, Iterator, Sequence
import csv
from dataclasses import dataclass, field, replace
from datetime import datetime
import difflib
import os
from pathlib import Path
import re

from quad_ident_ros import schema
from quad_ident_ros.data.readers.others import START
from quad_ident_ros.data.readers.registry import READERS
from quad_ident_ros.errors import InputError
from quad_ident_ros.fleet.dates import date_of, is_day
from quad_ident_ros.fleet.folders import whose

COLUMNS = ('path', 'vehicle', 'configuration', 'date', 'group', 'vehicle_file')
"""What the columns of a manifest are called; each further one has numbers: a covariate."""

MISSPELT = 0.85     # likeness from which on a name is one of these: `rate` and `date` have 0.75

UNNAMED = 'Unnamed:'
"""What pandas calls a column without a name, when it has read one and writes it again."""

TABLES = ('.csv', '.csv.gz', '.tsv')    # the other kinds of flights are seen by their first bytes
BAGS = '.mcap', '.db3'      # in the folder of a bag, which has its name
ABOUT = 'fleet.json'
"""The file in the folder of a data set that says how it is made; its tables are no flights."""
VEHICLE_FILE = 'vehicle.yaml'
"""The nominal vehicle in the folder of its flights, or in one above."""


@dataclass(frozen=True)
class Listed:
    """
    A flight as it was named; '' and None: the log is asked.

    folder: the name of the folder that was searched, or of a flight that was named, which is the
    vehicle where nothing else says which; group: what is diagnosed together instead of a day;
    vehicle_file: the nominal vehicle; deeper: a folder below those that name vehicle and
    configuration; place: file and line of a manifest.
    """

    path: str
    vehicle: str = ''
    configuration: str = ''
    date: datetime | None = None
    day: str = ''
    group: str = ''
    vehicle_file: str = ''
    folder: str = ''
    deeper: str = ''
    covariates: dict[str, float] = field(default_factory=dict)
    place: str = field(default='', compare=False)


def listed(names: Iterable[str]) -> list[Listed]:
    """
    Return the flights that paths of flights, folders and manifests stand for, each path once.

    What a manifest says of a flight goes before what its folders say. Raises InputError, for what
    is not there, too.
    """
    found: dict[str, list[Listed]] = {}
    for name in names:
        path = Path(name)
        if not path.exists():
            raise InputError(f'{name}: there is no such file or folder; name flights, a folder of '
                             'them or a manifest')
        if _is_bag(path) or path.is_file() and not is_manifest(path):
            some: Iterable[Listed] = [Listed(str(path), vehicle_file=_nominal_in(path.parent),
                                             folder=own_folder(path).name)]
        else:
            some = _in_folder(path) if path.is_dir() else _in_manifest(path)
        for one in some:
            found.setdefault(os.path.realpath(one.path), []).append(one)
    if not found:
        raise InputError(f'{", ".join(names)}: there is no flight in it; name a folder of tables '
                         '(CSV, Parquet), bags or logs')
    return [_merged(said) for said in found.values()]


def _merged(said: Sequence[Listed]) -> Listed:
    """Return what is said of one flight, perhaps often; InputError where manifests differ."""
    by_manifest = [one for one in said if one.place]
    by_folder = [one for one in said if not one.place]
    if not by_manifest:
        return by_folder[0]
    first, *others = by_manifest
    for one in others:
        if replace(one, path=first.path, folder=first.folder) != first:
            raise InputError(f'{one.place}: {one.path} is named in {first.place}, with other '
                             'values; name each flight once')
    if not by_folder:
        return first
    known = by_folder[0]
    return replace(first, vehicle=first.vehicle or known.vehicle, day=first.day or known.day,
                   configuration=first.configuration or known.configuration,
                   vehicle_file=first.vehicle_file or known.vehicle_file,
                   deeper='' if first.vehicle else known.deeper)


def is_manifest(path: Path) -> bool:
    """
    Return whether a file is a manifest: a CSV table with a column `path`, however written.

    One with another name for it, such as `file`, is known by a first row that names a file.
    """
    if path.suffix != '.csv':
        return False
    try:
        if not path.stat().st_size:     # reading such a file of the system may wait for ever
            return False
        # In another encoding, too: that is said of a manifest, where a flight would be refused.
        with open(path, encoding='utf-8-sig', errors='replace', newline='') as file:
            names, row = ([cell.strip(' "\r\n') for cell in re.split('[,;\t]', line)]
                          for line in (file.readline(START), file.readline(START)))
    except OSError:
        return False
    return 'path' in map(str.lower, names) or any(
        Path(cell).suffix and _is_there(path.parent / cell) for cell in row)


def _is_there(path: Path) -> bool:
    """Return whether there is a file; False for what can be no name of one, too."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _in_manifest(path: Path) -> Iterator[Listed]:
    try:
        with open(path, encoding='utf-8-sig', newline='') as file:
            reader = csv.reader(file, skipinitialspace=True)
            names = [name.strip() for name in next(reader)]
            if 'path' not in names:
                raise InputError(f'{path}, line 1: there is no column `path`; write the names as '
                                 f'{",".join(COLUMNS)}, with commas, of which only path is needed')
            for name in names:
                near = difflib.get_close_matches(name.lower(), COLUMNS, 1, MISSPELT)
                if name not in COLUMNS and near:
                    raise InputError(f'{path}, line 1: the column {name} is not known; write '
                                     f'{near[0]}, or give a covariate a name that differs more')
            if len(set(filter(None, names))) < sum(map(bool, names)):
                raise InputError(f'{path}, line 1: a column is named twice; name each once')
            found: dict[str, Listed] = {}
            for row in reader:
                if any(row):
                    one = _entry(path, reader.line_num, names, row)
                    if found.setdefault(one.path, one) != one:
                        raise InputError(f'{path}, line {reader.line_num}: {one.path} is named '
                                         'above already, with other values; name each flight once')
            yield from found.values()
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise InputError(f'{path}: cannot be read: {error}; expected a table in UTF-8 with '
                         'commas') from None


def _entry(manifest: Path, line: int, names: Sequence[str], row: Sequence[str]) -> Listed:
    where = f'{manifest}, line {line}'
    if len(row) != len(names):
        raise InputError(f'{where}: {len(row)} cells, but {len(names)} columns; write one cell '
                         'for each')
    for number, (name, cell) in enumerate(zip(names, row, strict=True), 1):
        if cell.strip() and (not name or name.startswith(UNNAMED)):
            raise InputError(f'{where}, column {number}: it has no name in line 1; name it, or '
                             'leave it out (`index=False` of pandas)')
    cells = {name: cell.strip() for name, cell in zip(names, row, strict=True) if name}
    if not cells['path'] or '\0' in cells['path']:
        raise InputError(f'{where}, column path: it is empty, or no name; name a flight')
    date = date_of(cells['date']) if cells.get('date') else None
    if cells.get('date') and date is None:
        raise InputError(f'{where}, column date: {schema.shown(cells["date"])} is not a date '
                         'from 2000 to 2100; write 2026-05-14 or 2026-05-14T08:30:00Z')
    covariates = {name: _covariate(where, name, cell) for name, cell in cells.items()
                  if name not in COLUMNS and cell}
    path = str(manifest.parent / cells['path'])
    nominal = cells.get('vehicle_file', '')
    beside = manifest.parent / nominal
    return Listed(path, cells.get('vehicle', ''), cells.get('configuration', ''), date, '',
                  cells.get('group', ''),
                  str(beside) if nominal and beside.is_file() else nominal,
                  own_folder(Path(path)).name, '', covariates, where)


def _covariate(where: str, name: str, cell: str) -> float:
    """Return the number in a cell of a column that is not in COLUMNS; raises InputError."""
    try:
        return schema.number(f'{where}, column {name}', cell)
    except InputError as error:
        raise InputError(f'{error}: columns other than {", ".join(COLUMNS)} are covariates; leave '
                         'it out or correct its name') from None


def _in_folder(top: Path) -> Iterator[Listed]:
    """Yield the flights below a folder, which the folders between say more of."""
    name = _no_day(top).name
    for path, nominal in _below(top, '', frozenset()):
        folders = path.relative_to(top).parts[:-1]
        if _is_of_open_bag(path):
            folders = folders[:-1]
        vehicle, configuration, day = whose(folders)
        yield Listed(str(path), vehicle, configuration, day=day, vehicle_file=nominal,
                     folder=name, deeper=_deeper(top, folders))


def _deeper(top: Path, folders: Sequence[str]) -> str:
    """Return the folder below those that name vehicle and configuration, '' if there is none."""
    third = [number for number, name in enumerate(folders, 1) if not is_day(name)][2:3]
    return str(top.joinpath(*folders[:third[0]])) if third else ''


def own_folder(flight: Path) -> Path:
    """Return the folder that a flight is in, or the next one above whose name is no day."""
    folder = flight.parent
    return _no_day(folder.parent if _is_of_open_bag(flight) else folder)


def _no_day(folder: Path) -> Path:
    """Return a folder, or the next one above whose name is no day."""
    whole = Path(os.path.abspath(folder))       # without a `..`, which is no name
    return next(one for one in (whole, *whole.parents) if not is_day(one.name))


def _below(folder: Path, nominal: str, above: frozenset[str]) -> Iterator[tuple[Path, str]]:
    """
    Yield (path, nominal vehicle file) of the flights below a folder, by name.

    above: the folders that it is in, to which a link in it does not lead back.
    """
    within = above | {os.path.realpath(folder)}
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    except OSError as error:
        raise InputError(f'{folder}: cannot be read: {error.strerror}') from None
    nominal = _nominal_in(folder) or nominal
    for entry in entries:
        path = Path(entry.path)
        if entry.name.startswith('.'):
            continue
        if path.is_dir() and not _is_bag(path):
            if os.path.realpath(path) not in within and not (path / ABOUT).is_file():
                yield from _below(path, nominal, within)
        elif path.is_dir() or path.is_file() and _is_flight(path):
            yield path, nominal


def _is_bag(path: Path) -> bool:
    """Return whether a folder is a bag of ROS 2, or a recording of the recorder with one."""
    return any((path / place).is_file() for place in ('metadata.yaml', 'bag/metadata.yaml'))


def _is_of_open_bag(path: Path) -> bool:
    """Return whether a file lies in the folder of a bag of ROS 2 that is still recorded to."""
    return path.suffix in BAGS and path.name.startswith(f'{path.parent.name}_')


def _is_flight(path: Path) -> bool:
    """Return whether a file in a folder is taken for a flight."""
    if path.name.lower().endswith(TABLES):
        return not is_manifest(path)
    try:
        with open(path, 'rb') as file:
            start = file.read(START) if path.stat().st_size else b''
    except OSError:
        return True     # it is refused with its reason later
    *others, _ = READERS    # the last one takes any text
    return any(path.suffix in reader.suffixes or reader.recognises(path, start)
               for reader in others)


def _nominal_in(folder: Path) -> str:
    """Return the nominal vehicle file in a folder, or ''."""
    return str(folder / VEHICLE_FILE) if (folder / VEHICLE_FILE).is_file() else ''
