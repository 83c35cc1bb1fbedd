# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""One way to read a flight, whatever it is kept in."""

from pathlib import Path

from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.foreign import read_mapped_bag
from quad_ident_ros.data.replay import read_bag
from quad_ident_ros.errors import InputError

_ULOG = b'ULog\x01\x12\x35'
_BAGS = {b'\x89MCAP0\r\n': '.mcap', b'SQLite format 3\0': '.db3'}   # how they begin


def load(path, mapping=None, vehicle=None):
    """
    Return the FlightRecord in a file or bag that holds one flight.

    CSV (plain or gzip), rosbag2 (folder, .mcap, .db3) and PX4 ULog (by its first bytes) are told
    apart.
    Args: path; mapping (data.mapping.Mapping) for bags of others and for the outputs of PX4;
    vehicle (model.vehicle.Vehicle) for the speeds of its rotors.
    Raises InputError in one line that names file, and row and column or topic and message.
    """
    flights = load_all(path, mapping, vehicle)
    if len(flights) > 1:
        raise InputError(f'{path}: holds {len(flights)} flights; split it with: quad_ident '
                         f'convert {path} OUT.csv')
    return flights[0]


def load_all(path, mapping=None, vehicle=None):
    """Return the flight records in a file or bag, at least one; arguments and errors of load."""
    path = Path(path)
    kind = _kind(path)
    if kind == 'bag':
        return [read_mapped_bag(path, mapping, vehicle)] if mapping else read_bag(path)
    if kind == 'ulog':
        return [_read_ulog(path, mapping, vehicle)]
    if mapping is not None:
        raise InputError(f'{path}: a mapping is for bags and logs; the columns of a CSV file have '
                         'the names of the flight record, see docs/records.md')
    return [read_csv(path)]


def _read_ulog(path, mapping, vehicle):
    # A ROS 2 installed by its packages may lack pyulog, which all else can do without.
    try:
        from quad_ident_ros.data.ulog import read_ulog
    except ModuleNotFoundError as error:
        if error.name != 'pyulog':
            raise
        raise InputError(f'{path}: logs of PX4 are read with pyulog, which is not installed; '
                         'install it with: pip install pyulog') from None
    return read_ulog(path, mapping, vehicle)


def _kind(path):
    if path.is_dir():
        return 'bag'
    start = b''
    try:
        if path.is_file():
            with open(path, 'rb') as file:
                start = file.read(16)
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    for magic, suffix in _BAGS.items():
        if start.startswith(magic) and path.suffix != suffix:
            raise InputError(f'{path}: this is a bag, and is read under a name that ends in '
                             f'{suffix}; rename it')
    if path.suffix in _BAGS.values():
        return 'bag'
    if start.startswith(_ULOG) or path.suffix == '.ulg':
        return 'ulog'
    return 'csv'
