# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
The topics that carry a flight: their types, and how messages become columns of a record.

The functions take any message object with the fields of its type, whether from rclpy or from a
bag.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
import json
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.data.cdr import Reader, stamped_numbers
from quad_ident_ros.data.info import unusable_entry
from quad_ident_ros.data.joiner import are_measured
from quad_ident_ros.data.message import Message
from quad_ident_ros.data.record import ARM, MOMENTS
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import rotation_matrix


@dataclass(frozen=True)
class FlightTopic:
    """
    A topic: its message type, the raw columns it carries, and how to read them.

    values: of a message; read: as data.cdr.stamped_numbers, the same of a serialized one.
    """

    name: str
    type: str
    columns: tuple[str, ...]
    values: Callable[[Message], tuple[float, ...]]
    read: Reader


def _pose(message: Message) -> tuple[float, ...]:
    p, q = message.pose.position, message.pose.orientation
    return p.x, p.y, p.z, q.w, q.x, q.y, q.z


def _twist(message: Message) -> tuple[float, ...]:
    v, w = message.twist.linear, message.twist.angular
    return v.x, v.y, v.z, w.x, w.y, w.z


def _input(message: Message) -> tuple[float, ...]:
    force, torque = message.wrench.force, message.wrench.torque
    return force.z, torque.x, torque.y, torque.z


def _attitude(message: Message) -> tuple[float, ...]:
    return message.vector.x, message.vector.y, message.vector.z


# The pose's height comes as `height`, so that the `altitude` topic, where joined, has the say.
FLIGHT_TOPICS = {topic.name: topic for topic in (
    FlightTopic('attitude', 'geometry_msgs/msg/Vector3Stamped', ('phi', 'theta', 'psi'),
                _attitude, stamped_numbers(3, (0, 1, 2))),
    FlightTopic('altitude', 'geometry_msgs/msg/PointStamped', ('pz',), lambda m: (m.point.z,),
                stamped_numbers(3, (2,))),
    FlightTopic('pose', 'geometry_msgs/msg/PoseStamped',
                ('px', 'py', 'height', 'qw', 'qx', 'qy', 'qz'), _pose,
                stamped_numbers(7, (0, 1, 2, 6, 3, 4, 5))),
    FlightTopic('twist', 'geometry_msgs/msg/TwistStamped',
                ('body_vx', 'body_vy', 'body_vz', 'wx', 'wy', 'wz'), _twist,
                stamped_numbers(6, range(6))),
    FlightTopic('input', 'geometry_msgs/msg/WrenchStamped', ('u1', *MOMENTS, 'u4'), _input,
                stamped_numbers(6, (2, 3, 4, 5))),
)}

RUN_TOPIC = 'run'
RUN_TYPE = 'std_msgs/msg/String'

# A whole record in one message, number for number, as `quad_ident convert` writes it.
EXACT_TOPIC = 'flight_record'
ARRAY_TYPE = 'std_msgs/msg/Float64MultiArray'

AT_THE_ARM = dict(zip(MOMENTS, ('u2', 'u3'), strict=True))
SHORTEST_ARM, LONGEST_ARM = 1e-4, 100.0     # m

# The stamp (ns) up to which a recorder has joined: what lets a simulator run as fast as it keeps
# up. The middleware's own acknowledgements come every 3 s only.
JOINED_TOPIC = 'joined_until'


def stamp_ns(message: Message) -> int:
    """Return the stamp of a message with a header, ns."""
    stamp = message.header.stamp
    return stamp.sec * 1_000_000_000 + stamp.nanosec


# What a message raises whose type has a name that we know and a definition that we do not.
OTHER_SHAPE = (AttributeError, OverflowError, TypeError, ValueError)


def not_unit(quaternion: ArrayLike) -> np.ndarray:
    """Return which quaternions (..., 4) are no attitude; those with nan are left to others."""
    q = np.asarray(quaternion, float)
    finite = np.isfinite(q).all(axis=-1)
    length = np.linalg.norm(np.clip(q, -10.0, 10.0), axis=-1)
    return finite & ~((length > 0.5) & (length < 2.0))


def unusable(name: str, values: tuple[float, ...]) -> str:
    """Return why the values of a message of FLIGHT_TOPICS are no measurement, or ''."""
    if not are_measured(values):
        return f'{name}: holds a value that is not a number, or infinite, or beyond all measure'
    if name == 'pose' and not 0.25 < sum(part * part for part in values[3:]) < 4.0:
        return 'pose: the quaternion does not have length 1; publish a pose with an attitude'
    return ''


def raw_columns(topics: Iterable[str]) -> tuple[str, ...]:
    """Return the names of the raw columns that the topics carry together."""
    return tuple(column for name in topics for column in FLIGHT_TOPICS[name].columns)


def record_columns(names: Iterable[str], table: ArrayLike, arm: float | None = None
                   ) -> dict[str, np.ndarray]:
    """
    Return the columns of the flight record format from raw ones.

    Args: names: raw columns; table (N, len(names)). The velocity of `twist` is that of the body
    frame and is turned into the world by the attitude of `pose`, where both exist. arm: the
    arm length in m that makes u2 and u3 of the moments of `input`, None where it is not known.
    """
    columns = dict(zip(names, np.asarray(table, float).T, strict=True))
    if arm is not None:
        columns = {AT_THE_ARM.get(name, name): values / arm if name in AT_THE_ARM else values
                   for name, values in columns.items()}
    height = columns.pop('height', None)
    if height is not None:
        columns.setdefault('pz', height)
    body = [columns.pop(name) for name in ('body_vx', 'body_vy', 'body_vz') if name in columns]
    if body and 'qw' in columns:
        quaternion = np.stack([columns[name] for name in ('qw', 'qx', 'qy', 'qz')], axis=-1)
        with np.errstate(over='ignore', invalid='ignore'):   # the record refuses what comes of it
            velocity = np.einsum('nij,jn->in', rotation_matrix(quaternion), np.stack(body))
        columns.update(zip(('vx', 'vy', 'vz'), velocity, strict=True))
    return columns


def arm_of(info: Mapping[str, Any]) -> float | None:
    """Return the arm length (m) that the info of a run or record says, or None."""
    arm = info.get(ARM)
    if isinstance(arm, bool) or not isinstance(arm, int | float):
        return None
    return float(arm) if SHORTEST_ARM < arm < LONGEST_ARM else None


@dataclass(frozen=True)
class RunNotice:
    """What a simulator announces: first and last stamp (ns), samples and provenance of a run."""

    start_ns: int
    stop_ns: int
    samples: int
    info: dict[str, Any]

    def to_json(self) -> str:
        """Return the notice as text."""
        return json.dumps({'start_ns': self.start_ns, 'stop_ns': self.stop_ns,
                           'samples': self.samples, 'info': self.info})

    @classmethod
    def from_json(cls, text: str) -> 'RunNotice':
        """Return the notice that a text holds; raises InputError where it holds none."""
        try:
            data = json.loads(text)
            notice = cls(int(data['start_ns']), int(data['stop_ns']), int(data['samples']),
                         dict(data['info']))
            if not (0 <= notice.start_ns <= notice.stop_ns < 2 ** 63
                    and 0 <= notice.samples <= notice.stop_ns - notice.start_ns + 1
                    and isinstance(notice.info.get('name', ''), str)
                    and not unusable_entry(notice.info)):
                raise ValueError
        except (ValueError, KeyError, TypeError, OverflowError, RecursionError):
            raise InputError(f'topic {RUN_TOPIC}: {text[:60]!r} announces no run; expected JSON '
                             'with start_ns, stop_ns, samples and info') from None
        return notice

    def cuts_short(self, other: 'RunNotice') -> bool:
        """Tell whether this is the other run, ended before its time."""
        return (self.info.get('status') == 'stopped' and self.start_ns == other.start_ns
                and self.info.get('session') == other.info.get('session')
                and self.stop_ns < other.stop_ns)


def needed_from(runs: list[RunNotice], now: RunNotice | None) -> list[RunNotice]:
    """
    Return the notices that rows may still need when those of one of them, or None, are at hand.

    Args: runs: in the order in which they came. One that came later may begin before, where the
    clock restarts.
    """
    if now is None:
        return runs
    place = runs.index(now)
    return [run for run in runs[:place] if run.stop_ns >= now.start_ns] + runs[place:]


def run_at(runs: Iterable[RunNotice], stamp: int) -> RunNotice | None:
    """
    Return the notice of the run that a stamp (ns) belongs to, or None.

    A run that begins within another has cut it short: its simulator was killed, and started again.
    """
    there = (run for run in runs if run.start_ns <= stamp <= run.stop_ns)
    return max(there, key=lambda run: run.start_ns, default=None)
