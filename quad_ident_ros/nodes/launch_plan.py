# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which nodes a launch file starts, with which ROS arguments: without `launch` itself."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import signal

import yaml

from quad_ident_ros import resources, schema
from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.parameter_files import (
    given_to,
    is_for,
    names_in,
    overriding,
    words_for,
)

SIMULATOR = 'simulator'
TOLD = (signal.SIGINT, signal.SIGTERM)   # signals by which a node ends that was told to


@dataclass(frozen=True)
class Argument:
    """
    An argument of a launch file: its name, what it is, its type and the parameters that it sets.

    kind: str, int, float, bool or list; sets: (node, parameter) pairs. The default is '' where
    nothing is to be set, so that a parameter file and the nodes' own defaults hold.
    """

    name: str
    description: str
    kind: type = str
    sets: tuple[tuple[str, str], ...] = ()
    default: str = ''


NAMESPACE = Argument('namespace', 'Namespace of the nodes, their topics and their clock.')
SIMULATE = Argument('simulate', 'Start the simulator; false where a vehicle, a bag or another '
                    'simulator publishes its topics.', bool, default='true')
PARAMS_FILE = Argument('params_file', 'Parameter file, such as config/parameters.yaml; arguments '
                       'that are given take precedence over it.')
USE_SIM_TIME = Argument('use_sim_time', 'Follow the simulated time: that of the simulator here, '
                        'or with simulate:=false that on /clock.', bool, default='false')
RESPAWN = Argument('respawn', 'Start a node that is killed or crashes once more, instead of '
                   'ending all; empty: true with simulate:=false, else false.', bool)
COMMON = (
    NAMESPACE, SIMULATE, PARAMS_FILE, USE_SIM_TIME, RESPAWN,
    Argument('experiment', 'Name of an experiment or path of its file.', str,
             ((SIMULATOR, 'experiment'),)),
    Argument('effects', "Effects of the vehicle that flies, for example ['wind:x=3'].", list,
             ((SIMULATOR, 'effects'),)),
    Argument('real_time_factor', 'Simulated seconds per second; 0.0: as fast as it goes.', float,
             ((SIMULATOR, 'real_time_factor'),)),
    Argument('output', 'Folder for recordings; empty: nothing is written.', str,
             (('recorder', 'output'),)),
    Argument('vehicle_name', 'Name of the vehicle: recordings go to the folder of its day in '
             'output.', str, (('recorder', 'vehicle_name'),)),
    Argument('topics', "Topics that a row needs, for example ['odometry', 'imu', 'actuators'].",
             list, (('recorder', 'topics'),)),
    Argument('mapping', 'Mapping file for topics of other names and types.', str,
             (('recorder', 'mapping'),)),
    Argument('window_samples', 'Samples after which a window is complete.', int,
             (('recorder', 'window_samples'),)),
    Argument('window_seconds', 'Seconds after which a window is complete.', float,
             (('recorder', 'window_seconds'),)),
    Argument('overlap', 'Share of a window that the next one keeps.', float,
             (('recorder', 'overlap'),)),
    Argument('windows', "Further windows, with topics of their own: ['record_long=30,0.5'].", list,
             (('recorder', 'windows'),)),
)
"""Arguments of all launch files."""


@dataclass(frozen=True)
class Planned:
    """A node of this package to start: its executable, ROS arguments, whether to respawn it."""

    node: str
    words: tuple[str, ...]
    respawn: bool


def planned(nodes: Sequence[str], arguments: Sequence[Argument], values: Mapping[str, str],
            usual: Mapping[str, Mapping[str, object]]) -> list[Planned]:
    """
    Return what is started.

    Args: nodes: of this package, the simulator first; arguments of the launch file; values: their
    texts by name; usual: {node: {parameter: value}} of a
    flight that is simulated, which the parameter file overrides.
    Raises InputError for values of another type, and for those of a simulator that is not started.
    """
    simulate = _value(SIMULATE, values)
    sim_time = _value(USE_SIM_TIME, values)
    path = values.get(PARAMS_FILE.name, '')
    started = [node for node in nodes if simulate or node != SIMULATOR]
    given: dict[str, dict[str, object]] = {node: {} for node in started}
    for argument in arguments:
        if not argument.sets or not values.get(argument.name, ''):
            continue
        value = _value(argument, values)
        here = [(node, name) for node, name in argument.sets if node in given]
        if not here:
            raise InputError(f'launch argument {argument.name}: is for the simulator, which '
                             'simulate:=false leaves out; give one of the two')
        for node, name in here:
            given[node][name] = value
    if sim_time:
        for node in started:
            given[node]['publish_clock' if node == SIMULATOR else 'use_sim_time'] = True
    space = values.get(NAMESPACE.name, '').strip('/')
    if space and simulate:
        given[SIMULATOR]['frame_prefix'] = f'{space}/'
    data = resources.read_yaml(path) if path else {}
    names = {node: f'/{space}/{node}' if space else f'/{node}' for node in started}
    filed = {node: given_to(data, node, name) for node, name in names.items()}
    # Two simulators, each in its namespace, have two times.
    clocked = sim_time or filed.get(SIMULATOR, {}).get('publish_clock') is True
    clock = ('-r', '/clock:=clock') if clocked and simulate and space else ()
    usual = usual if simulate else {}
    # A flight that is simulated ends with its simulator: a new one flies from the beginning.
    respawn = _value(RESPAWN, values) if values.get(RESPAWN.name, '') else not simulate
    plans = []
    for node in started:
        if key := overriding(data, node, names[node], given[node]):
            raise InputError(f'launch argument params_file: {path}: what {key} sets would '
                             'override launch arguments, because /** stands before it; move /** '
                             'to the end of the file')
        # ROS 2 takes the later of two values: arguments come after the file.
        words = {name: value for name, value in usual.get(node, {}).items()
                 if name not in filed[node]} | given[node]
        plans.append(Planned(node, (*_file(path, data, node, names), *words_for(words), *clock),
                             respawn))
    return plans


def within(around: str, inner: str) -> str:
    """Return the namespace of nodes where `launch` has one around theirs, as it joins them."""
    return inner if not around or inner.startswith('/') else f'{around.rstrip("/")}/{inner}'


def was_killed(code: int) -> bool:
    """Return whether a node with this exit code was killed or crashed, and did not end itself."""
    return code < 0 and -code not in TOLD


def _file(path: str, data: Mapping[str, object], node: str, names: Mapping[str, str]) -> tuple:
    """Return the ROS arguments for a parameter file where it has something for a node."""
    if not path:
        return ()
    keys = names_in(data)
    if not any(is_for(keys, one, name) for one, name in names.items()):
        raise InputError(f'launch argument params_file: nothing in {path} is for '
                         f'{", ".join(names)}; it is for {", ".join(keys) or "none"}')
    return ('--params-file', path) if is_for(keys, node, names[node]) else ()


def _value(argument: Argument, values: Mapping[str, str]) -> object:
    """Return the value of an argument in its type; InputError."""
    where, text = f'launch argument {argument.name}', values.get(argument.name, argument.default)
    if argument.kind is str:
        return text
    try:
        value = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError):    # ValueError: an invalid day
        value = None
    if argument.kind is bool:
        if not isinstance(value, bool):
            raise InputError(f'{where}: expected true or false, got {text!r}')
        return value
    if argument.kind is list:
        if not isinstance(value, list):
            raise InputError(f"{where}: expected a list, for example \"['a', 'b']\", got {text!r}")
        if all(isinstance(one, str) for one in value):
            return value
        if not all(isinstance(one, int | float) and not isinstance(one, bool) for one in value):
            raise InputError(f'{where}: expected texts or numbers in the list, got {text!r}; put '
                             'quotes around what is text')
        # A whole number among numbers is one of them.
        return [float(schema.number(where, one)) for one in value]
    number = schema.number(where, value)
    if argument.kind is int and number != int(number):
        raise InputError(f'{where}: expected a whole number, got {text!r}')
    return argument.kind(number)
