# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the topics of a bag are, by their types where these leave no doubt."""

from dataclasses import replace
from pathlib import Path
import re

import numpy as np

from quad_ident_ros.data.bag_file import BagFile, Topic
from quad_ident_ros.data.mapping import Mapping, ROLES, Source
from quad_ident_ros.data.message import Message
from quad_ident_ros.data.message_roles import could_be, is_tf, NoSuch, reading_of, ROLES_OF
from quad_ident_ros.data.topics import not_unit, OTHER_SHAPE
from quad_ident_ros.data.vehicle_names import VEHICLE
from quad_ident_ros.errors import InputError

MOTION = ('pose', 'position', 'attitude', 'velocity', 'rate', 'specific_force')
"""Roles of which a flight has at least one."""

_LISTED = 6     # topics in a message
_BEHIND = 10    # ranks that a topic of the second choice is behind those of the first

# What a vehicle is asked for, and not what it does.
_ASKED = re.compile(r'set_?point|target|desired|reference|goal|command|waypoint'
                    r'|(^|[/_])(ref|cmd)([/_]|$)')
# PX4's inputs; measurements before calibration or fusion; MAVROS' copies of one estimate; truth
# beside an estimate.
_INPUT = re.compile(r'(^|/)fmu/in/')
_SECOND = re.compile(r'raw|ground_?truth|(^|/)odometry/(in|out)$|(^|/)global_position/'
                     r'|(^|/)velocity_body(_cov)?$')
_OF_ONE = re.compile(rf'(?:^|/)({VEHICLE})/')


def guessed(path: str | Path, bag: BagFile, mapping: Mapping) -> tuple[Mapping, list[str]]:
    """
    Return (mapping with topics, notes) for an open BagFile, by the types of its topics.

    Raises InputError that lists topics and the mapping to write where several could serve one
    role, or none is known.
    """
    topics = [topic for topic in bag.topics if topic.count]
    first = bag.first({topic.name for topic in topics if topic.type in ROLES_OF})
    found = {role: _best(role, topics, first) for role in ROLES}
    if found['pose'][0]:
        found['position'] = found['attitude'] = [], []
    if bag.recovered and not topics:
        raise InputError(f'{path}: this bag ends within its first message: its recorder was '
                         'killed at once, or the file was not copied completely; copy it again')
    if not any(found[role][0] for role in MOTION):
        raise InputError(f'{path}: no topic of this bag is known to be a state of a vehicle; it '
                         f'has {_listed(topics)}; say which is what in a mapping file '
                         '(--mapping), see docs/records.md')
    several = {role: best for role, (best, _) in found.items()
               if len(best) > 1 and role != 'battery'}
    if several:
        which = '; '.join(f'{role}: {", ".join(topic.name for topic in best[:_LISTED])}'
                          for role, best in several.items())
        lines = ', '.join(f'{role}: {{topic: {best[0].name}}}'
                          for role, (best, _) in found.items() if best)
        raise InputError(f'{path}: several topics could serve one role ({which})'[:600]
                         + f'; name one of each in a mapping file (--mapping), such as: topics: '
                         f'{{{lines}}}'[:350])
    _refuse_mixture(path, [best[0] for best, _ in found.values() if len(best) == 1])
    sources = {role: Source(best[0].name) for role, (best, _) in found.items() if len(best) == 1}
    return replace(mapping, topics=sources), _notes(found, topics)


def _refuse_mixture(path: str | Path, topics: list[Topic]) -> None:
    """Raise InputError where the names of topics are those of several vehicles."""
    by_number: dict[str, list[str]] = {}     # one may be cf1 here and crazyflie_1 there
    for topic in dict.fromkeys(topics):
        match = _OF_ONE.search(topic.name.lower())
        if match:
            by_number.setdefault(re.sub(r'\D', '', match[1].removeprefix('px4')), []).append(
                topic.name)
    if len(by_number) > 1:
        which = '; '.join(', '.join(some) for some in by_number.values())
        raise InputError(f'{path}: the topics known by their types are of several vehicles '
                         f'({which[:400]}); name those of one in a mapping file (--mapping), such '
                         f'as: topics: {{pose: {{topic: {topics[0].name[:100]}}}}}')


def _best(role: str, topics: list[Topic], first: dict[str, Message]
          ) -> tuple[list[Topic], list[Topic]]:
    """Return the topics that serve a role best, and those that could as well."""
    ranked: dict[int, list[Topic]] = {}
    commanded = any(_speeds(topic) and _ASKED.search(topic.name.lower()) for topic in topics)
    for topic in topics:
        rank = _rank(role, topic, first.get(topic.name), commanded)
        if rank is not None:
            ranked.setdefault(rank, []).append(topic)
    if not ranked:
        return [], []
    least = min(ranked)
    return ranked[least], [topic for rank, some in ranked.items() if rank > least
                           for topic in some]


def _rank(role: str, topic: Topic, message: Message, commanded: bool) -> int | None:
    """Return how far behind others a topic is for a role, None where it does not serve it."""
    known = ROLES_OF.get(topic.type, {}).get(role)
    if known is None or known.rank is None or message is None:
        return None
    name = topic.name.lower()
    if name.endswith('tf_static') or not _meant(role, topic, name, commanded):
        return None
    if not _holds(role, topic.type, message):
        return None
    return known.rank + _BEHIND * bool(_SECOND.search(name) or _INPUT.search(name))


def _meant(role: str, topic: Topic, name: str, commanded: bool) -> bool:
    """
    Whether the name of a topic goes with a role.

    Args: commanded: whether the name of one of the topics with speeds says that it commands.
    """
    asked = bool(_ASKED.search(name))
    if role in MOTION:
        return not asked and not _INPUT.search(name)
    if _speeds(topic):
        return (asked or not commanded) if role == 'commands' else commanded and not asked
    return True


def _speeds(topic: Topic) -> bool:
    """Whether a topic holds rotor speeds that may be commands or measured."""
    return topic.type.endswith('/Actuators')


def _holds(role: str, msgtype: str, message: Message) -> bool:
    """Whether the first message holds values of a role."""
    try:
        if is_tf(msgtype):
            return len(message.transforms) > 0
        reading = reading_of(role, msgtype, message)
        with np.errstate(invalid='ignore'):     # a signalling not-a-number becomes a quiet one
            values = np.array(reading.values(message), float)
        if role == 'velocity' and msgtype.startswith('geometry_msgs/'):
            return reading.frame is not None and reading.frame(message) != ''
    except (NoSuch, *OTHER_SHAPE):
        return False
    if role == 'attitude':
        return bool(np.isfinite(values).all() and not not_unit(values))
    return role not in ('rate', 'specific_force') or bool(np.isfinite(values).all())


def _notes(found: dict[str, tuple[list[Topic], list[Topic]]], topics: list[Topic]) -> list[str]:
    """Return what was taken for what, as notes of the record."""
    taken: dict[Topic, list[str]] = {}
    for role, (best, _) in found.items():
        if len(best) == 1:
            taken.setdefault(best[0], []).append(role)
    notes = ['taken by type: ' + '; '.join(
        f'{" and ".join(roles)} from {topic.name} ({topic.type})'
        for topic, roles in taken.items())]
    others = {topic: role for role, (best, rest) in found.items() if role in MOTION
              for topic in rest if topic not in taken}
    if others:
        notes.append('not used, because others have priority: ' + ', '.join(
            f'{topic.name} ({role})' for topic, role in list(others.items())[:_LISTED]))
    if len(found['battery'][0]) > 1:
        notes.append('not used, because there are several batteries: '
                     + ', '.join(topic.name for topic in found['battery'][0][:_LISTED]))
    if not found['commands'][0]:
        unknown = [topic for topic in topics if topic not in taken
                   and set(could_be(topic.name, topic.type, ('[]',))[0]) & {'commands', 'rotors'}]
        notes.append('no topic is known to be the commands of the rotors; name it in a mapping '
                     'file (--mapping)'
                     + (f', such as: {_listed(unknown)}' if unknown else ''))
    return notes


def _listed(topics: list[Topic]) -> str:
    """Return names and types of topics in one line."""
    if not topics:
        return 'no messages'
    more = f' and {len(topics) - _LISTED} more' if len(topics) > _LISTED else ''
    return ', '.join(f'{topic.name} ({topic.type})' for topic in topics[:_LISTED])[:500] + more
