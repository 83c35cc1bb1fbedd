# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether a recorder works: what it reports on /diagnostics."""

from quad_ident_ros.nodes.messages import ERROR, OK, WARN

NO_ROW = 2.0         # s with messages but without a joined row, after which that is reported
RECENT = 10.0        # s for which something that went wrong is a warning


class Health:
    """
    What goes wrong, and what did a short while ago.

    Args: topics: names that a row needs; apart: called for what to say where their stamps do not
    go together; silent: called with those that nothing comes on, for what to say of them.
    Times are in s, of one steady clock.
    """

    def __init__(self, topics, apart, silent):
        self._topics, self._apart, self._silent = topics, apart, silent
        self._heard = dict.fromkeys(topics, 0)
        self._last_row = None
        self._problems = {}
        self._worse = -RECENT
        self._spoken = -RECENT
        self.trouble = None

    def note_rows(self, now):
        """Note that rows were joined."""
        self._last_row = now

    def look(self, now, received, unreadable=None):
        """
        Say why no rows come while messages do, or return None.

        Args: received: messages of each topic so far; unreadable: why those of one cannot be read.
        """
        news = {name: received[name] - self._heard[name] for name in self._topics}
        self._heard = dict(received)
        if self._last_row is None and any(news.values()):
            self._last_row = now   # the first messages: rows may take their time from here
        if not any(news.values()):
            return None
        silence = now - self._last_row
        if silence < NO_ROW:
            self.trouble = None
            return None
        silent = [name for name in self._topics if not news[name]]
        why = unreadable or (self._silent(silent) if silent else self._apart())
        self.blame(now, f'no sample has been joined for {silence:.0f} s: {why}')
        return self.trouble

    def blame(self, now, trouble):
        """Take what is wrong now."""
        self.trouble, self._spoken = trouble, now

    def status(self, now, counts, note='', disk_error=None):
        """
        Return (level, text) for /diagnostics.

        What went wrong is a warning for RECENT s, and stays in the text. Args: counts Counts; note
        on how rows come about; disk_error.
        """
        problems = counts.problems()
        if any(count > self._problems.get(name, 0) for name, count in problems.items()):
            self._worse = now
        self._problems = problems
        level, text = OK, f'{counts.joined} samples joined'
        if note:
            text += f'; {note}'
        if problems:
            text += ', ' + ', '.join(f'{count} {name}' for name, count in problems.items())
        if now - self._worse < RECENT:
            level = WARN
        if self.trouble and now - self._spoken < RECENT:
            level, text = WARN, self.trouble
        return (ERROR, disk_error) if disk_error else (level, text)
