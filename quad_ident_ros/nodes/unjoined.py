# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Why a recorder joins no rows: what does not come, or as another type, or at other times."""

from quad_ident_ros.nodes.other_types import other_types

AWAITED = 5.0        # s for a vehicle to begin, after which missing topics are reported
OTHER_CLOCK = 1.0    # s by which stamps are of another clock, as data.foreign has it for bags


class Unjoined:
    """
    Says in words why no rows come about, or how they do.

    Args: node: that subscribes; topics: their names, as the joiner has them; joiner; mapped:
    MappedTopics, or None for FLIGHT_TOPICS; gap: the parameter, s; now: time of one steady
    clock, s.
    """

    def __init__(self, node, topics, joiner, mapped, gap, now):
        self._node, self._topics, self._joiner = node, topics, joiner
        self._mapped, self._gap, self._begun = mapped, gap, now
        self._awaits = mapped is not None
        self._at_rows = (0, 0)

    def between(self):
        """Return how rows come about where the stamps are not what they should be, or ''."""
        if self._mapped is not None:
            return '; '.join(self._mapped.notes())
        if not self._joiner.interpolates:
            return ''
        return ('the stamps of the topics are seldom equal: joined by interpolation at those of '
                f'{self._joiner.base}, within {self._gap:g} s (parameter gap)')

    def silent(self, names):
        """Say that nothing comes on some of the topics, and what to do."""
        if self._mapped is None:
            return (f'nothing comes on {", ".join(names)} (the parameter topics leaves topics '
                    'out)')
        absent = self._absent()
        return f'nothing comes on {self._mapped.named(names)}; ' + (
            f'nobody publishes {", ".join(absent)}: correct the name, or leave it out of the '
            'mapping' if absent else 'leave missing topics out of the mapping')

    def note_rows(self):
        """Note that rows were joined."""
        self._at_rows = self._repeated()

    def apart(self):
        """Say what keeps the stamps of the topics from going together."""
        repeated, received = (now - then for now, then in zip(self._repeated(), self._at_rows,
                                                              strict=True))
        if 2 * repeated > received:
            return ('the messages have one stamp again and again (header.stamp, 0 where nobody '
                    'sets it); stamp each with the time of its sample')
        if self._mapped is None and not self._joiner.interpolates:
            return 'the stamps of the topics are never equal'
        if self._mapped is not None:
            name, behind = max(self._joiner.behind().items(), key=lambda one: abs(one[1]),
                               default=('', 0.0))
            if abs(behind) > OTHER_CLOCK:
                return (f'the stamps of {self._mapped.named([name])} are {abs(behind):.1f} s '
                        f'{"behind" if behind > 0 else "ahead of"} those of '
                        f'{self._mapped.named(self._topics[:1])}; synchronise their clocks')
        return (f'the samples of the topics are never within {self._gap:g} s of one another '
                '(parameter gap)')

    def _repeated(self):
        """Return how many messages had the stamp of another one, and how many there were."""
        counts = self._joiner.counts
        return counts.duplicated, sum(counts.received.values())

    def another_type(self):
        """Say which silent topics are of other types, or return ''."""
        silent = () if self._mapped is not None else (
            name for name in self._topics if not self._joiner.counts.received[name])
        return other_types(self._node, silent)

    def awaited(self, now):
        """Return, once, that no topic of the mapping exists, or ''."""
        if not self._awaits or now - self._begun < AWAITED:
            return ''
        self._awaits = False
        absent = self._absent()
        if any(self._joiner.counts.received.values()) or len(absent) < len(self._mapped.topics):
            return ''
        return (f'waits for {", ".join(absent)}: nobody publishes them; if they should be there, '
                '`ros2 topic list` has the names')

    def _absent(self):
        """Return the topics of the mapping that nobody publishes."""
        return [name for name in self._mapped.topics if not self._node.count_publishers(name)]
