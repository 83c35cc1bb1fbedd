# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flight records from bags of others: a mapping says which topic is what, or their types do."""

from collections.abc import Mapping as Pairs
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from quad_ident_ros.data.bag_file import BagFile
from quad_ident_ros.data.bag_guess import guessed
from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.message_roles import is_tf
from quad_ident_ros.data.px4_resets import split_at_resets
from quad_ident_ros.data.record import FlightRecord, QUATERNION, SPOILT
from quad_ident_ros.data.streams import join, Stream
from quad_ident_ros.data.topic_part import BODY_VELOCITY, TopicPart
from quad_ident_ros.data.transforms import static_topic
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import rotate

ONE_CLOCK = 1.0     # s between a stamp and its receipt that vary so much are of several clocks


def read_mapped_bag(path: str | Path, mapping: Mapping, spoilt: bool = False
                    ) -> list[FlightRecord]:
    """
    Return the FlightRecords in a bag of ROS 1 or ROS 2 whose topics a mapping names.

    There is one, or several between the resets that px4_msgs count. A mapping without topics
    is filled by the types of the topics, where these leave no doubt. Stamps are those in the
    messages where all of a topic have one, else the times of receipt; all are the times of
    receipt where the stamps are of several clocks.
    Args: path of a bag; mapping Mapping; spoilt: leave invalid attitudes out and list them
    in the info, see record.SPOILT.
    Raises InputError that names file, topic and message.
    """
    notes: list[str] = []
    with BagFile(path) as bag:
        if not mapping.topics:
            mapping, notes = guessed(path, bag, mapping)
        parts = [TopicPart(f'{path}, topic {source.topic}', role, source)
                 for role, source in mapping.topics.items()]
        by_topic = _by_topic(parts, {topic.name: topic.type for topic in bag.topics})
        for topic, received, message in bag.together(
                by_topic, lambda name: _fixed(by_topic[name])):
            for part in by_topic[topic]:
                if isinstance(received, int):
                    part.add(received, message, topic != part.source.topic)
                else:
                    part.add_many(received, message)
    parts = [part for part in parts if not (notes and part.role == 'battery' and part.count < 2)]
    streams = [part.stream(mapping, spoilt) for part in parts]
    if np.ptp([part.offset for part in parts]) > ONE_CLOCK:
        streams = [Stream(stream.source, np.array(part.received, np.int64), stream.columns,
                          stream.between) for part, stream in zip(parts, streams, strict=True)]
        notes = [*notes, 'the stamps of the topics are of several clocks; times of receipt are '
                 'used for all of them']
    else:
        notes = [*notes, *dict.fromkeys(without_stamps(part.source.topic) for part in parts
                                        if not part.stamped)]
    notes += dict.fromkeys(part.note for part in parts if part.note)
    start, t, columns, left_out = join(path, streams)
    record = FlightRecord(t, velocity_in_world(path, columns),
                          {'name': _name(path), 'source': str(path), 'start_ns': start,
                           'notes': [*notes, *left_out]}
                          | _spoilt(parts, streams, start))
    return split_at_resets([record], start, {
        part.counters.topic: (stream.stamps, part.counters.fields())
        for part, stream in zip(parts, streams, strict=True) if part.counters})


def _name(path: str | Path) -> str:
    """Return the name of the flight in a bag, which is a folder or a file."""
    whole = Path(path).resolve()
    return whole.name if whole.is_dir() else whole.stem


def _by_topic(parts: Sequence[TopicPart], types: Pairs[str, str]) -> dict[str, list[TopicPart]]:
    """
    Return topic -> the parts that read it.

    Those of transforms read the topic of those that do not change, too. types: by topic.
    """
    found: dict[str, list[TopicPart]] = {}
    for part in parts:
        topic = part.source.topic
        beside = static_topic(topic)
        found.setdefault(topic, []).append(part)
        if is_tf(types.get(topic)) and is_tf(types.get(beside)) and not part.source.field:
            found.setdefault(beside, []).append(part)
    return found


def _spoilt(parts: Sequence[TopicPart], streams: Sequence[Stream], start: int
            ) -> dict[str, list[list[object]]]:
    """Return the info of the samples that were left out as spoilt; start: of the record, ns."""
    told: list[list[object]] = [
        [(int(stream.stamps[k]) - start) * 1e-9, part.not_unit(k)]
        for part, stream in zip(parts, streams, strict=True) for k in part.spoilt]
    return {SPOILT: told} if told else {}


def without_stamps(topic: str) -> str:
    """Return the note on a topic whose messages have no stamp."""
    return (f'the messages of topic {topic} have no stamps; their times of receipt are used, '
            'which are later by what transport takes')


def velocity_in_world(path: str | Path, columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return columns whose velocity in body axes is turned into the world; raises InputError."""
    if BODY_VELOCITY[0] in columns:
        if not all(name in columns for name in QUATERNION):
            raise InputError(f'{path}: a velocity in body axes needs an attitude; map a pose, or '
                             'say frame: world')
        body = np.stack([columns.pop(name) for name in BODY_VELOCITY], axis=-1)
        attitude = np.stack([columns[name] for name in QUATERNION], axis=-1)
        attitude = attitude / np.linalg.norm(attitude, axis=-1, keepdims=True)
        columns.update(zip(('vx', 'vy', 'vz'), rotate(attitude, body).T, strict=True))
    return columns


def _fixed(parts: Sequence[TopicPart]) -> set[str] | None:
    """Return the fields that say how parts are read, or None where they are read one by one."""
    found: set[str] = set()
    for part in parts:
        names = part.fixed
        if names is None:
            return None
        found.update(names)
    return found
