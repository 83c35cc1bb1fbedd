# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The state of a vehicle as text and tables for a terminal, one function for each panel."""

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from quad_ident_ros.data.counted import counted
from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.signals import GAIN_UNITS
from quad_ident_ros.report.table import with_error
from quad_ident_ros.watch.state import Model, NODES, OK, State

LEVELS = {OK: ('OK', 'green'), 1: ('WARN', 'yellow'), 2: ('ERROR', 'red'), 3: ('STALE', 'red')}
BAR = 20            # columns of a progress bar
WIDE = 100          # columns from which units of K and the fit have room beside K, a, b
GAP_ROWS = ('before', 'after', 'noise')
ROLES = {'recorder': 'joins the topics of the vehicle into records',
         'identifier': 'fits K, a, b to the records',
         'diagnoser': 'says which effects the vehicle has and its file has not'}
MORE_ARGUMENTS = {'diagnoser': ('-p vehicle:=FILE',)}


def start_command(node: str, namespace: str) -> str:
    """Return the command that starts a node in a namespace ('/' or '/uav1')."""
    arguments = [*MORE_ARGUMENTS.get(node, ()),
                 *([] if namespace == '/' else [f'-r __ns:={namespace}'])]
    return ' '.join([f'quad_ident node {node}', *(['--ros-args', *arguments] if arguments
                                                  else [])])


def waiting_panel(state: State, namespace: str, where: str) -> RenderableType:
    """Return which nodes have not been heard and how to start them; where: what is listened to."""
    missing = [node for node in NODES if node not in state.health]
    if not missing:
        return Text()
    rows = _grid()
    for node in missing:
        rows.add_row(Text(node, 'bold'), ROLES[node])
        rows.add_row('', Text(start_command(node, namespace), 'cyan'))
    return Group(Text(f'Not heard yet on {where}; each is shown as soon as it runs:'), rows)


def recorder_panel(state: State, now: float) -> RenderableType:
    """Return the streams of the recorder with their rates, what was joined, what went wrong."""
    lines: list[RenderableType] = [_title(state, 'recorder', now)]
    recording = state.recording
    if recording is None:
        return Group(*lines)
    streams = Text('  ')
    for stream in recording.streams:
        rate = 'no rate yet' if stream.rate is None else f'{stream.rate:.0f} Hz'
        silent = not stream.received
        streams.append(f'{stream.name}\N{NO-BREAK SPACE}'.replace(' ', '\N{NO-BREAK SPACE}'))
        streams.append(('nothing' if silent else rate).replace(' ', '\N{NO-BREAK SPACE}'),
                       'red' if silent else 'bold')
        streams.append('  ')
    lines.append(streams)
    problems = ', '.join(f'{count} {name.replace("_", " ")}'
                         for name, count in recording.problems.items())
    lines.append(Text.assemble(
        f'  {counted(recording.records, "record")}, {recording.buffered} samples in the next; ',
        (problems, 'yellow') if problems else 'nothing lost',
        f'; run {recording.run}' if recording.run else '',
        f'; {recording.folder}' if recording.folder else ''))
    if recording.disk_error:
        lines.append(Text(f'  {recording.disk_error}', 'red'))
    return Group(*lines)


def identifier_panel(state: State, now: float, width: int) -> RenderableType:
    """Return K, a, b of each output with standard errors; width: columns of the terminal."""
    title = _title(state, 'identifier', now)
    if state.fit is None:
        return title
    wide = width >= WIDE
    table = _grid(header=True)
    table.add_column(f'  {METHODS[state.fit.method].label}', no_wrap=True)
    for name in ('K', 'a, 1/s', 'b, 1/s', *(('fit, %',) if wide else ())):
        table.add_column(name, justify='right', no_wrap=True)
    for name in ('changed', *(('unit of K',) if wide else ())):
        table.add_column(name, no_wrap=True)
    for model in state.fit.models:
        fit = '' if model.fit_percent is None else f'{model.fit_percent:.2f}'
        table.add_row(f'  {model.output}', *_numbers(model), *((fit,) if wide else ()),
                      Text(state.changed.get(model.output, ''), 'bold yellow'),
                      *((GAIN_UNITS[model.output],) if wide else ()))
    return Group(title, table)


def diagnoser_panel(state: State, now: float) -> RenderableType:
    """Return the verdict and the gap before and after, beside that of noise."""
    title = _title(state, 'diagnoser', now)
    verdict = state.verdict
    if verdict is None:
        return title
    table = _grid(header=True)
    table.add_column(f'  gap {verdict.horizon:g} s ahead', no_wrap=True)
    for name, unit in verdict.units.items():
        table.add_column(f'{name}, {unit}', justify='right', no_wrap=True)
    for row in GAP_ROWS:
        table.add_row(f'  {row}', *(f'{getattr(verdict, row)[name]:.3g}'
                                    for name in verdict.units))
    said = Table.grid(padding=(0, 1))
    said.add_row(' ', Text.assemble(('verdict: ', 'bold'), verdict.line))
    return Group(title, said, table)


def history_panel(state: State) -> RenderableType:
    """Return verdicts, changes and answers to keys, the newest first."""
    if not state.history:
        return Text('  no verdict and no change yet', 'dim')
    rows = _grid()
    for event in state.history:
        rows.add_row(f'  {event.time}', Text(event.about, 'bold'), Text(event.text))
    return rows


def _title(state: State, node: str, now: float) -> Table:
    """Return the line of a node: its health, or that it is silent, and how far its work is."""
    name, said = Text(node, 'bold'), Text()
    health, silence = state.health.get(node), state.silence(node, now)
    if health is None:
        said.append('not heard', 'dim')
    elif silence is not None:
        said.append(f'silent for {silence:.0f} s; it has ended, or the network lost it', 'red')
    else:
        word, style = LEVELS.get(health.level, LEVELS[3])
        name.append(f'  {word}', style)
        share = state.progress.get(node)
        if share is not None:
            done = round(BAR * share)
            said.append(f'{"█" * done}{"░" * (BAR - done)} {100 * share:.0f} %  ', 'cyan')
        if not _is_repeated(state, node, health.text):
            said.append(health.text)
    line = Table.grid(padding=(0, 2, 0, 0))     # a long text is wrapped beside the name
    line.add_column(no_wrap=True)
    line.add_row(name, said)
    return line


def _is_repeated(state: State, node: str, text: str) -> bool:
    """Whether the text of a node repeats what its panel shows."""
    return (node == 'diagnoser' and state.verdict is not None
            and text.endswith(state.verdict.line))


def _numbers(model: Model) -> list[str]:
    """Return K, a, b with their standard errors as text."""
    if model.values[0] is None:
        return ['none', '', '']
    if model.pair is not None:
        real, imaginary = model.pair
        return [with_error(model.values[0], model.errors[0]), f'{real:.4g}',
                f'±{abs(imaginary):.4g}j']
    return ['' if value is None else with_error(value, error)
            for value, error in zip(model.values, model.errors, strict=True)]


def _grid(header: bool = False) -> Table:
    return Table(box=None, show_header=header, show_edge=False, pad_edge=False,
                 padding=(0, 2, 0, 0), header_style='dim')
