# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""False changes where whole days differ, and which real ones are found beside that."""

from pathlib import Path
import sys

import numpy as np

from benchmarks.tables import markdown
from quad_ident_ros.fleet.history import histories

ROOT = Path(__file__).resolve().parents[1]
LAYOUTS = ((30, 1, 0.0), (6, 5, 0.0), (6, 5, 1.0), (6, 5, 2.0), (6, 5, 4.0), (20, 3, 2.0))
"""Days, flights on each, and how far days differ, in scatters of the flights of one day."""
SIZES = 3.0, 6.0, 12.0      # of real steps, in the same
NEAR = 2            # flights, by which a step that is found may be dated wrongly


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    with bar('days', len(LAYOUTS) * size.day_fleets) as advance:
        rows = [row(*layout, size.day_fleets, advance) for layout in LAYOUTS]
    return markdown(('days × flights', 'days differ by', 'fleets with a false alarm',
                     *(f'found: {step:g} between days' for step in SIZES),
                     *(f'{step:g} within a day' for step in SIZES)), rows)


def row(days, each, apart, fleets, advance=lambda: None):
    """Return a row: false alarms of so many fleets, and shares of the steps that are found."""
    places = days // 2 * each, days // 2 * each + each // 2
    steps = [(place, step) for place in places for step in SIZES]
    false, found = 0, np.zeros(len(steps), int)
    for seed in range(fleets):
        fleet = made(seed, days, each, apart, len(steps))
        false += any(one.changes or one.drift for one in histories(fleet))
        for one, (place, step) in zip(fleet, steps, strict=True):
            one.values[place:] += step
        found += [any(abs(change.place - place) <= NEAR for change in one.changes)
                  for one, (place, _) in zip(histories(fleet), steps, strict=True)]
        advance()
    shares = [f'{100 * count / fleets:.0f} %' for count in found]
    if each == 1:       # no day has an inside
        shares[len(SIZES):] = ['–'] * len(SIZES)
    return f'{days} × {each}', f'{apart:g}', f'{false} of {fleets}', *shares


def made(seed, days, each, apart, vehicles):
    """Return a fleet in which nothing changes, as Series."""
    sys.path[:0] = [str(ROOT / 'test' / 'helpers')]
    from fleets import in_days
    rng = np.random.default_rng([seed, days, each])
    return [in_days(rng, days, each, apart=apart, vehicle=f'uav{number}')
            for number in range(vehicles)]
