# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records from a bag of the recorder, of `ros2 bag record` or of `quad_ident convert`."""

from collections.abc import Container, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from quad_ident_ros.data.bag_file import BagFile, read_bag_messages
from quad_ident_ros.data.buffer import Limits, RecordBuffer
from quad_ident_ros.data.joiner import Joiner, Row
from quad_ident_ros.data.message import Message
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.table import record_from_table
from quad_ident_ros.data.topics import (
    ARRAY_TYPE,
    EXACT_TOPIC,
    FLIGHT_TOPICS,
    not_unit,
    OTHER_SHAPE,
    raw_columns,
    RUN_TOPIC,
    RUN_TYPE,
    RunNotice,
    stamp_ns,
)
from quad_ident_ros.errors import InputError

UNBOUNDED = Limits(samples=2 ** 62, seconds=float('inf'))

_TYPES = {RUN_TOPIC: RUN_TYPE, **{topic.name: topic.type for topic in FLIGHT_TOPICS.values()}}


class _Named:
    """Topics of these names in any namespace: what else is in a bag is not even decoded."""

    def __init__(self, names: Container[str]) -> None:
        self._names = names

    def __contains__(self, topic: object) -> bool:
        return str(topic).rpartition('/')[2] in self._names


def is_recorded(path: str | Path) -> bool:
    """
    Whether a bag is of the recorder, of `quad_ident convert`, or of such topics.

    `pose` and `twist` are common names, so they do not show that.
    """
    path = in_recording(path)
    with BagFile(path) as bag:
        topics = bag.topics
    spaces: dict[str, set[str]] = {}
    for topic in topics:
        space, _, name = topic.name.rpartition('/')
        if _TYPES.get(name) == topic.type:
            spaces.setdefault(space, set()).add(name)
        if name == EXACT_TOPIC and topic.type == ARRAY_TYPE:
            return True
    return any(not names <= {'pose', 'twist'} and names != {RUN_TOPIC}
               for names in spaces.values())


def in_recording(path: str | Path) -> str | Path:
    """Return the bag in a folder of the recorder, or the path itself."""
    bag = Path(path) / 'bag'
    return bag if (bag / 'metadata.yaml').exists() else path


def read_bag(path: str | Path) -> list[FlightRecord]:
    """
    Return the flight records in a bag, one per announced run, joined as the recorder does.

    Where the bag holds whole records, as `quad_ident convert` writes them, it is these.

    Raises InputError for a path that is no bag, or a bag with none of the topics of a flight or
    with those of several vehicles.
    """
    path = in_recording(path)
    exact = [_exact(path, topic, message)
             for topic, _, message in read_bag_messages(path, _Named((EXACT_TOPIC,)))
             if message.__msgtype__ == ARRAY_TYPE]
    if exact:
        return exact
    messages, spaces = [], set()
    for topic, _, message in read_bag_messages(path, _Named(_TYPES)):
        space, _, name = topic.rpartition('/')
        if message.__msgtype__ != _TYPES[name]:
            continue   # another program's
        messages.append((space, name, message))
        if name != RUN_TOPIC:
            spaces.add(space)
    if len(spaces) > 1:
        raise InputError(f'{path}: holds the flights of several vehicles ({len(spaces)} '
                         'namespaces); record each into a bag of its own')
    present = {name for _, name, _ in messages}
    topics = [name for name in FLIGHT_TOPICS if name in present]
    if not topics:
        with BagFile(path) as bag:
            empty = any(_TYPES.get(topic.name.rpartition('/')[2]) == topic.type
                        for topic in bag.topics)
        if empty:
            raise InputError(f'{path}: has the topics of a flight and no message on them yet: its '
                             'recorder heard none, or ended within its first second, or the file '
                             'was not copied whole')
        raise InputError(f'{path}: has none of the topics {", ".join(FLIGHT_TOPICS)}; for those '
                         'of others give a mapping file (--mapping)')
    samples = [(space, name, message if name == RUN_TOPIC else _sample(path, name, message))
               for space, name, message in messages]
    try:
        records = _joined(topics, spaces, samples)
    except InputError as error:
        raise InputError(f'{path}: {error}') from None
    if not records:
        raise InputError(f'{path}: its topics share no stamps, so there is no flight in it')
    return [type(record)(record.t, record.columns, {**record.info, 'source': str(path)})
            for record in records]


def _joined(topics: Sequence[str], spaces: Container[str],
            samples: Iterable[tuple[str, str, Any]]) -> list[FlightRecord]:
    """Return records of samples: namespace, topic, and a Row, or the message of a run."""
    joiner, buffer = Joiner(topics), RecordBuffer(raw_columns(topics), UNBOUNDED)
    records = []
    for space, name, sample in samples:
        if name != RUN_TOPIC:
            records += buffer.add_rows(joiner.add(name, *sample))
        elif space in spaces:
            # A flight needs no notice, and `run` is a common name.
            with suppress(InputError, *OTHER_SHAPE):
                records += buffer.add_run(RunNotice.from_json(sample.data))
    records += buffer.add_rows(joiner.drain())
    return records + buffer.complete(run_over=True)


def _sample(path: str | Path, name: str, message: Message) -> Row:
    """Return stamp (ns) and values of a message; InputError for one of another shape."""
    try:
        stamp = int(np.int64(stamp_ns(message)))
        values = tuple(map(float, FLIGHT_TOPICS[name].values(message)))
    except OTHER_SHAPE:
        raise InputError(f'{path}, topic {name}: the definition of {_TYPES[name]} in the bag '
                         'differs from that of ROS 2; record it again') from None
    if name == 'pose' and not_unit(values[3:]):
        raise InputError(f'{path}, topic {name}, stamp {stamp} ns: the quaternion does not have '
                         'length 1; record a pose with an attitude')
    return stamp, values


def _exact(path: str | Path, topic: str, message: Message) -> FlightRecord:
    where = f'{path}, topic {topic}'
    try:
        record = record_from_table(message, where)
    except OTHER_SHAPE as error:   # InputError is a ValueError
        text = str(error)
        raise InputError(text if text.startswith(where) else f'{where}: {text}') from None
    return type(record)(record.t, record.columns, {**record.info, 'source': str(path)})
