# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The records of the recorder that belong together."""


class Records:
    """The records of the session that flies: one for each run that it announced."""

    def __init__(self):
        self._records = {}
        self._session = None
        self._wanted = 1

    def __len__(self):
        return len(self._records)

    def add(self, record, longest):
        """
        Take a record and return whether it is the first of another session.

        Args: longest: of the parts of one announced run the longest has the say, not the newest.
        """
        info = record.info
        new = info.get('session') != self._session
        if new:
            self._records, self._session = {}, info.get('session')
        run = info.get('run_index', 0)
        before = self._records.pop(run, None)
        keep = (before is not None and longest and 'run_index' in info
                and len(before) >= len(record))
        self._records[run] = before if keep else record
        self._wanted = info.get('run_count', 1)
        return new

    @property
    def complete(self):
        """Whether there is a record of each announced run."""
        return len(self._records) >= self._wanted

    def all(self):
        """Return the records, in the order of their runs."""
        return [self._records[run] for run in sorted(self._records)]
