# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What of a recording is not on disk, by the stamps of its rows."""

from pathlib import Path

import numpy as np

from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.replay import read_bag
from quad_ident_ros.errors import InputError


def lost(recording: Path, newest: int) -> float:
    """
    Return how much of a recording is not on disk, s.

    Args: recording: its folder; newest: the stamp of the newest row that it had, ns. Raises
    InputError where bag or CSV cannot be read, or have no row in common.
    """
    flights = read_bag(recording / 'bag')
    heights = {height: stamp for flight in flights
               for height, stamp in zip(flight.columns['pz'].tolist(), _stamps(flight),
                                        strict=True)}
    tables = sorted(recording.glob('flight_*.csv'),
                    key=lambda path: int(path.stem.rpartition('_')[2]))
    rows = _newest(read_csv(tables[-1]), heights)
    return max(newest - _stamps(flights[-1])[-1], newest - rows, 0) * 1e-9


def _newest(table, heights):
    """
    Return the stamp of the last row of a table, ns.

    A table has no stamps, and may begin within a flight of the bag, where the notice of the run
    came late. But noise makes each height one that no other row has: heights, {height in m: ns}.
    """
    for k in range(len(table.t) - 1, -1, -1):
        stamp = heights.get(float(table.columns['pz'][k]))
        if stamp is not None:
            return stamp + round(1e9 * (table.t[-1] - table.t[k]))
    raise InputError(f'{table.info["source"]}: has no row of the bag')


def _stamps(flight):
    return (flight.info['start_ns'] + np.rint(1e9 * flight.t).astype(np.int64)).tolist()
