# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Topics of any installed type that a mapping names, as streams that the recorder joins."""

from collections import Counter
from importlib import import_module

from quad_ident_ros.data.foreign import without_stamps
from quad_ident_ros.data.mapping import actuators_to_mapping, mapping_from, ROLES
from quad_ident_ros.data.message_roles import is_tf
from quad_ident_ros.data.outputs import ACTUATORS
from quad_ident_ros.data.stream_joiner import between_of
from quad_ident_ros.data.topic_part import BODY_VELOCITY, TopicPart
from quad_ident_ros.data.transforms import static_topic
from quad_ident_ros.errors import InputError

KNOWN = {'odometry': ('pose', 'velocity', 'rate'), 'imu': ('rate', 'specific_force'),
         'actuators': ('commands',)}
"""Topics that need no mapping file, and what they are read for: a later one takes its role."""


APART = 60.0        # s by which stamps of one clock are never late, however fast they are played
SETTLED = 2.0       # s after which all topics follow a clock that was set
RECEIVED = ('the stamps of the topics are of several clocks; times of receipt are used for all of '
            'them')


def known_mapping(names):
    """Return the Mapping of some of the KNOWN topics."""
    topics = {role: {'topic': name} for name in KNOWN if name in names for role in KNOWN[name]}
    return mapping_from({'topics': topics}, 'parameter topics')


class MappedTopics:
    """
    What the topics of a mapping hold.

    Stamps are those in the messages, or the times of receipt where there are none, and for all
    topics where the clocks of some are APART, as data.foreign has it for bags.
    Args: mapping Mapping; where: what names it, for messages. InputError where it names no topics.
    """

    def __init__(self, mapping, where):
        if not mapping.topics:
            raise InputError(f'{where}: the mapping names no topics; add topics: to it')
        self._mapping = mapping
        self._late = {}     # s from the stamp to the receipt, by topic
        self._settled = 0   # ns of receipt from which on they are compared
        self.by_receipt = False
        self.refused = ''       # why poses that the last message completes were left out
        self.without_stamps = []    # topics, in the order in which they were heard
        self._parts = {role: TopicPart(f'topic {mapping.topics[role].topic}', role,
                                       mapping.topics[role])
                       for role in ROLES if role in mapping.topics}
        self.streams = {role: between_of(role) for role in self._parts}
        self.topics = tuple(dict.fromkeys(part.source.topic for part in self._parts.values()))

    @property
    def info(self):
        """
        Return what records of the topics are to say of themselves.

        It has what the outputs to the motors are: they become speeds where their vehicle is known.
        """
        told = self._mapping.actuators
        return {**({} if told is None else {ACTUATORS: actuators_to_mapping(told)}),
                **({'notes': notes} if (notes := self.notes()) else {})}

    def notes(self):
        """Return the note on the stamps."""
        chains = [part.note for part in self._parts.values() if part.note]
        if self.by_receipt:
            return [RECEIVED, *chains]
        return [*(without_stamps(topic) for topic in self.without_stamps), *chains]

    def beside(self, topic, kind):
        """Return the existing topic that a topic of a type needs beside it, or ''."""
        sources = [part.source for part in self._parts.values() if part.source.topic == topic]
        return static_topic(topic) if is_tf(kind) and not all(
            source.field for source in sources) else ''

    def named(self, roles):
        """Return roles with the topics that they come on, for messages."""
        by_topic = {}
        for role in roles:
            by_topic.setdefault(self._parts[role].source.topic, []).append(role)
        return ', '.join(f'{" and ".join(some)} ({topic})' for topic, some in by_topic.items())

    def samples(self, topic, kind, received_ns, message):
        """
        Return [(role, stamp in ns, columns -> numbers)] in a message of a topic.

        Args: kind its type, package/msg/Name; received_ns its time of receipt.
        Raises InputError where it does not hold what the mapping says.
        """
        parts = {role: part for role, part in self._parts.items()
                 if topic in (part.source.topic, self.beside(part.source.topic, kind))}
        found = [(role, *sample) for role, part in parts.items()
                 for sample in part.samples(received_ns, message, kind, self._mapping,
                                            topic != part.source.topic)]
        self.refused = next((part.refused for part in parts.values() if part.refused), '')
        if not (self._parts.keys() & {'pose', 'attitude'}) and any(
                BODY_VELOCITY[0] in values for *_, values in found):
            raise InputError(f'topic {topic}: a velocity in body axes needs an attitude; map a '
                             'pose, or say frame: world')
        # A simulator stamps its messages with the very time that its clock says.
        if found and not found[0][1] and topic not in self.without_stamps:
            self.without_stamps.append(topic)
        if found and topic in self.topics and not self.by_receipt:
            self._compare(topic, found[0][2], found[0][1] or found[0][2])
        return [(role, came if self.by_receipt else stamp or came, values)
                for role, stamp, came, values in found]

    def left_out(self, end=False):
        """Return how many live poses came to nothing since the last call, by names of Counts."""
        return sum((part.left_out(end) for part in self._parts.values()), Counter())

    def _compare(self, topic, received_ns, stamp):
        """Note how late a topic is: where some are APART the stamps are of several clocks."""
        late = (received_ns - stamp) * 1e-9
        if abs(late - self._late.get(topic, late)) > APART:
            # The clock was set, or a simulation restarted: the other topics are about to follow.
            self._late = {}
            self._settled = received_ns + int(SETTLED * 1e9)
        self._late[topic] = late
        if received_ns >= self._settled and len(self._late) == len(self.topics):
            self.by_receipt = max(self._late.values()) - min(self._late.values()) > APART


def message_class(kind):
    """Return the class of a message type, package/msg/Name; InputError if not installed."""
    package, _, name = kind.partition('/msg/')
    try:
        return getattr(import_module(f'{package}.msg'), name)
    except (ImportError, AttributeError):
        raise InputError(f'messages of type {kind} cannot be read: the package {package} is not '
                         'installed here; install it or source its workspace') from None
