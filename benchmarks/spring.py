# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drifts in a spring that gets warmer: false ones and those found, with sisters and without."""

from pathlib import Path
import sys

import numpy as np

from benchmarks.tables import markdown
from quad_ident_ros.fleet.history import histories
from quad_ident_ros.fleet.shared import shared_histories

ROOT = Path(__file__).resolve().parents[1]
LAYOUTS = (
    (10, 18, 3.0, '', {}), (10, 18, 1.5, '', {}), (10, 18, 0.5, '', {}), (4, 18, 1.5, '', {}),
    (20, 30, 1.5, '', {}),
    (10, 18, 1.5, 'one vehicle follows no temperature', {'follows': (1.0, 0.0)}),
    (10, 18, 1.0, 'one vehicle follows no temperature', {'follows': (1.0, 0.0)}),
    (10, 18, 1.5, 'three vehicles follow none', {'follows': (1.0, 0.0, 0.0, 0.0)}),
    (10, 18, 1.5, 'it is told within 1.5 °C', {'wrong': 1.5}))
"""Vehicles, flights of each, degrees by which days differ from the season, what else is so."""
WEAR = -0.004       # of the thrust, a week


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    with bar('spring', len(LAYOUTS) * size.spring_fleets) as advance:
        rows = [row(*layout, size.spring_fleets, advance) for layout in LAYOUTS]
    return markdown(('vehicles × flights', 'days differ by (°C)', '',
                     'fleets with a false alarm: alone', 'with sisters',
                     'drift found: alone', 'with sisters'), rows)


def row(vehicles, flights, weather, said, more, fleets, advance=lambda: None):
    """Return a row: false alarms of so many fleets, and shares of the drifts that are found."""
    sys.path[:0] = [str(ROOT / 'test' / 'helpers')]
    from fleets import drift, in_spring
    ways = histories, shared_histories
    false, found = np.zeros(2, int), np.zeros(2, int)
    for seed in range(fleets):
        fleet = in_spring(np.random.default_rng([seed, vehicles, flights]), vehicles, flights,
                          weather=weather, **more)
        false += [any(one.changes or one.drift for one in way(fleet)) for way in ways]
        drift(fleet[0], WEAR)
        found += [way(fleet)[0].drift is not None for way in ways]
        advance()
    return (f'{vehicles} × {flights}', f'{weather:g}', said,
            *(f'{count} of {fleets}' for count in false),
            *(f'{100 * count / fleets:.0f} %' for count in found))
