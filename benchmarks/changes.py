# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Share of changes in flight that are found, how soon, and how often none is found as one."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2

from benchmarks.tables import markdown, number
from quad_ident_ros.cluster import cluster, values
from quad_ident_ros.experiment import fly, load_experiment, Run
from quad_ident_ros.identify.identify import collect, Settings
from quad_ident_ros.identify.online import Changes

EXPERIMENT = 'payload_in_flight'    # vehicle, noise and rate
PAYLOAD = 0.3           # of the mass
COURSES = {'hover': ('hover',), 'lateral': ('circle', 'figure8', 'lissajous')}
WITH, WITHOUT = 35.0, 45.0         # s of each flight with a change, and without
AT = (15.0, 25.0)       # s, between which the change is
SOON = 5.0              # s after it, by which it counts as found
WINDOW, STRIDE = 150, 25            # samples, of a recorder's; the blocks are those of any window
START_NS = 1_795_402_874_187_903_202    # of 2026, which no double has exactly
SURE = 0.95


@dataclass(frozen=True)
class Flown:
    """What came of a flight: its largest tilt, s without a change, and alarms in them, delay s."""

    tilt: float
    seconds: float
    false: int
    delay: float | None = None


def effects_of(seed):
    """Return what the vehicle has beside the linear model: drag of rotors and body, and inflow."""
    random = np.random.default_rng([seed, 7])
    return {'rotor_drag': {'coefficient': random.uniform(0.1, 0.3)},
            'body_drag': {'horizontal': random.uniform(0.0, 0.03),
                          'vertical': random.uniform(0.0, 0.05)},
            'inflow': {'axial': random.uniform(0.0, 0.3),
                       'translational': random.uniform(0.0, 0.01)}}


def flown(course, seed, payload, seconds, at=None):
    """Return what was Flown; course: of TRAJECTORIES; payload kg, taken up at a time, s."""
    experiment = load_experiment(EXPERIMENT)
    changes = () if at is None else ((at, {'mass_offset': {'mass': payload}}),)
    experiment = replace(experiment, runs=(Run(course, seconds, trajectory=course,
                                               changes=changes),)).with_effects(effects_of(seed))
    record = fly(experiment, experiment.runs[0], seed=seed).record
    record = replace(record, info={**record.info, 'start_ns': START_NS})
    settings, changes, alarms = Settings(initial_state='free'), Changes(), []
    for end in range(WINDOW, len(record) + 1, STRIDE):
        signals, _ = collect([record.starting(end - WINDOW).slice(0, WINDOW)], settings)
        if changes.update(signals)[0]:
            alarms.append(record.t[end - 1])
    tilts = np.cos(record.columns['phi']) * np.cos(record.columns['theta'])
    tilt = float(np.degrees(np.arccos(tilts.min())))
    if at is None:
        return Flown(tilt, seconds, len(alarms))
    delays = [alarm - at for alarm in alarms if 0 <= alarm - at <= SOON]
    return Flown(tilt, seconds - SOON, len(alarms) - len(delays[:1]),
                 delays[0] if delays else None)


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    each = size.change_flights // len(COURSES)
    found = {(regime, changed): [] for regime in COURSES for changed in (True, False)}
    with bar('changes', each * len(found)) as advance, cluster() as client:
        for (regime, changed, *_), flight in values(client, _flown, (
                (regime, changed, number, number if changed else each + number)
                for regime, changed in found for number in range(each))):
            found[regime, changed].append(flight)
            advance()
    rows = [_row(regime, found[regime, True], found[regime, False]) for regime in COURSES]
    head = ('flight', 'tilt up to, deg', 'with a change', 'found', 'delay, s: median', 'largest',
            'hours without', 'false alarms', 'per hour', 'at most, 95 %')
    return (f'{markdown(head, rows)}\n\nSeeds 0 to {each - 1} with a change, {each} to '
            f'{2 * each - 1} without.')


def _flown(which):
    """Return what was Flown: (regime, with a change, number of the course, seed)."""
    regime, changed, number_of_it, seed = which
    course = COURSES[regime][number_of_it % len(COURSES[regime])]
    if not changed:
        return flown(course, seed, 0.0, WITHOUT)
    payload = PAYLOAD * load_experiment(EXPERIMENT).vehicle.mass
    return flown(course, seed, payload, WITH, float(np.random.default_rng([seed, 8]).uniform(*AT)))


def _row(regime, changed, same):
    delays = [flight.delay for flight in changed if flight.delay is not None]
    hours = sum(flight.seconds for flight in changed + same) / 3600
    false = sum(flight.false for flight in changed + same)
    return (regime, f'{max(flight.tilt for flight in changed + same):.0f}', str(len(changed)),
            f'{100 * len(delays) / len(changed):.0f} %',
            number(float(np.median(delays)) if delays else None),
            number(max(delays, default=None)), number(hours), str(false), number(false / hours),
            number(float(chi2.ppf(SURE, 2 * (false + 1))) / 2 / hours))
