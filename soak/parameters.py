# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Fuzzing of every parameter of every node: while they work, and for a sample at the start."""

from dataclasses import dataclass, field
from pathlib import Path
import random
import tempfile
import time
from typing import Any

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters

from benchmarks import load
from quad_ident_ros.nodes import diagnoser, identifier, recorder, simulator
from quad_ident_ros.nodes.launched import Launched
from soak.rig import Finding, slowness, Watch

NODES = {'recorder': recorder, 'identifier': identifier, 'diagnoser': diagnoser,
         'simulator': simulator}
COUNT, SHORT_COUNT = 4000, 200      # inputs while the nodes work, and
STARTS = 100                        # so many of them for one at a start
ANSWER = 30.0                       # s that a node may take to answer, or to be there
LONG = 200_000                      # characters or entries of what is absurdly long
KIND, NO_TYPE = ParameterType, 200
NUMBERS = (0.0, -0.0, 1.0, -1.0, 5e-324, 1e-300, 1e308, -1e308, float('nan'), float('inf'),
           float('-inf'), 0.5, 2.5, 1e6)
WHOLE = (0, 1, -1, 2, 7, 2 ** 31, -2 ** 31, 2 ** 63 - 1, -2 ** 63)
TEXTS = ('', ' ', 'x' * LONG, '\n', '%s%n{0}', '[/]', '~nosuch/x', '/dev/zero', '/dev/null', '..',
         '/proc/self/environ', '{a: 1}', '\u202e\U0001f681', '"', "'", '=', ',', 'a=1,2', 'nan',
         'record=1', 'wind:x=nan', 'wind:x=1e999', 'rotor_drag:coefficient=0.1', ':', '-', '*')
# As they stand behind -p NAME:=, read as YAML.
WORDS = ('', '~', 'true', '.nan', '.inf', '-.inf', '1e999', '9' * 400, '0x10', '1_000', '[]',
         '[[1]]', '[1, two]', '[.nan, .inf]', '{a: 1}', '2026-11-23', '"\\0"', '&a [*a]',
         '[' * 500, '!!set {a}', '- 1', 'x' * 10_000, "'", '"', '-1', '1', '1.5', '[1.0, 2.0]',
         '[a, b]', '%', '\u202e')


@dataclass
class Tally:
    """What came of the inputs to a node, and what did not hold."""

    inputs: int = 0
    refused: int = 0
    starts: int = 0
    wrong: list[str] = field(default_factory=list)
    slowest: float = 0.0


def run(count: int = COUNT, seed: int = 0, short: bool = False, **_: object) -> list[Finding]:
    """Return a Finding for each node; count: inputs of all of them together."""
    source = random.Random(seed)
    count = SHORT_COUNT if short and count == COUNT else count
    tallies = {node: Tally() for node in NODES}
    with tempfile.TemporaryDirectory() as name, Launched(name) as launched, \
            launched.watcher('soak') as pair:
        watch = Watch(*pair)
        _start_all(launched, Path(name))
        watch.until(lambda: watch.heard.keys() >= set(NODES), 'all nodes')
        for node, tally in tallies.items():
            _living(watch, launched, node, source, count // len(NODES), tally)
            _starts(watch, launched, Path(name), node, source, max(count // STARTS // 4, 1), tally)
        for node, tally in tallies.items():
            text = (Path(name) / f'{node}.txt').read_text('utf-8', 'replace')
            if 'Traceback' in text:
                tally.wrong.append(f'traceback: {text.strip().splitlines()[-1][:90]}')
    return [Finding('parameters', f'{node}, {tally.inputs} inputs while it works, {tally.starts} '
                    f'at the start, seed {seed}',
                    f'{tally.refused} refused with a reason; slowest answer {tally.slowest:.1f} s'
                    + (f'; {len(tally.wrong)} wrong, such as {tally.wrong[0]}'
                       if tally.wrong else ''), not tally.wrong)
            for node, tally in tallies.items()]


def _start_all(launched: Launched, folder: Path) -> None:
    """Start all nodes, with a flight that goes on all the while and windows to work on."""
    given = {'recorder': {'window_seconds': 2.0, 'overlap': 0.5},
             'identifier': {'method': 'vp', 'mode': 'continuous'},
             'diagnoser': {'mode': 'continuous'},
             'simulator': {**load.simulator(folder, 0.01, 600.0), 'autostart': True,
                           'wait_for_subscribers': False}}
    for node, parameters in given.items():
        launched.start(node, parameters)


def value_for(spec: Any, source: random.Random) -> ParameterValue:
    """Return a value for a parameter (a ParameterSpec): of its type in half the cases, or any."""
    kind = spec.descriptor().type
    if source.random() < 0.5:
        kind = source.choice((*range(KIND.PARAMETER_STRING_ARRAY + 1), NO_TYPE))
    texts = (*TEXTS, *(spec.choices or ()))
    numbers = (*NUMBERS, *(map(float, spec.limits or ())), source.gauss(0.0, 10.0))
    length = source.choice((0, 1, 2, 3, 4, 4, 17, LONG))

    def some(entries: tuple) -> list:
        return source.choices(entries, k=length)

    return ParameterValue(type=kind, **{
        KIND.PARAMETER_BOOL: lambda: {'bool_value': source.random() < 0.5},
        KIND.PARAMETER_INTEGER: lambda: {'integer_value': source.choice(WHOLE)},
        KIND.PARAMETER_DOUBLE: lambda: {'double_value': source.choice(numbers)},
        KIND.PARAMETER_STRING: lambda: {'string_value': source.choice(texts)},
        KIND.PARAMETER_BYTE_ARRAY: lambda: {'byte_array_value': [b'\xff'] * min(length, 17)},
        KIND.PARAMETER_BOOL_ARRAY: lambda: {'bool_array_value': some((True, False))},
        KIND.PARAMETER_INTEGER_ARRAY: lambda: {'integer_array_value': some(WHOLE)},
        KIND.PARAMETER_DOUBLE_ARRAY: lambda: {'double_array_value': some(numbers)},
        KIND.PARAMETER_STRING_ARRAY: lambda: {
            'string_array_value': source.choices(texts, k=min(length, 17))},
    }.get(kind, dict)())


def _living(watch: Watch, launched: Launched, node: str, source: random.Random, count: int,
            tally: Tally) -> None:
    """Set parameters of a node that works; a change may be of several of them."""
    client = watch.node.create_client(SetParameters, f'{node}/set_parameters')
    watch.until(client.service_is_ready, f'the services of {node}')
    specs = NODES[node].SPECS
    while tally.inputs < count:
        spec = specs[tally.inputs % len(specs)]
        value = value_for(spec, source)
        begin = time.monotonic()
        answer = client.call_async(SetParameters.Request(
            parameters=[Parameter(name=spec.name, value=value)]))
        watch.until(answer.done, f'{node} to answer; {spec.name} was set', ANSWER)
        launched.check()
        tally.inputs += 1
        tally.slowest = max(tally.slowest, time.monotonic() - begin)
        [result] = answer.result().results
        if not result.successful:
            tally.refused += 1
            if not result.reason.strip():
                tally.wrong.append(f'{spec.name}: refused without a reason')
    watch.node.destroy_client(client)


def _starts(watch: Watch, launched: Launched, folder: Path, node: str, source: random.Random,
            count: int, tally: Tally) -> None:
    """Start a node with a value of one parameter: it is ready, or ends with one line."""
    for _ in range(count):
        name, word = source.choice(NODES[node].SPECS).name, source.choice(WORDS)
        started = f'{node}_{tally.starts}'
        launched.start(node, {'autostart': False} if node == 'simulator' else {}, name=started,
                       arguments=['-r', '__ns:=/fuzzed', '-p', f'{name}:={word}'])
        process, log = launched.processes[started], folder / f'{started}.txt'

        def said(log: Path = log) -> str:
            return log.read_text('utf-8', 'replace')

        watch.until(lambda p=process, s=said: p.poll() is not None or 'ready: ' in s(),
                    f'{node} with {name}:={word[:40]}', ANSWER)
        del launched.processes[started]
        tally.starts += 1
        ended = process.poll()
        if ended is None:
            process.terminate()
            process.wait(ANSWER * slowness())
        errors = [line for line in said().splitlines() if 'error: ' in line]
        if 'Traceback' in said() or ended not in (None, 2) or (ended == 2 and len(errors) != 1):
            tally.wrong.append(f'-p {name}:={word[:40]}: exit code {ended}, '
                               f'{said().strip().splitlines()[-1:]}')
