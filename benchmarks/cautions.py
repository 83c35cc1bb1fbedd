# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How often the checks of a flight warn of one that nothing is wrong with."""

from itertools import islice, product

from benchmarks.tables import markdown
from quad_ident_ros import resources
from quad_ident_ros.cluster import cluster, values
from quad_ident_ros.data.quality import findings
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.flight.trajectories import TRAJECTORIES
from quad_ident_ros.model.vehicle import load_vehicle

NOISES = ('clean', 'mocap_imu')
SECONDS = 20.0      # of each flight


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    names = [name for name in resources.names('vehicles') if load_vehicle(name).rotors]
    courses = product(range(size.clean_flights), TRAJECTORIES, names)
    courses = list(islice(courses, size.clean_flights))
    codes = {noise: [] for noise in NOISES}
    with bar('cautions', len(courses) * len(NOISES)) as advance, cluster() as client:
        for (noise, *_), found in values(client, _codes, (
                (noise, *course) for noise in NOISES for course in courses)):
            codes[noise].append(found)
            advance()
    rows = []
    for noise, each in codes.items():
        which = ', '.join(sorted({code for one in each for code in one})) or 'none'
        rows.append((noise, str(len(each)), str(sum(map(bool, each))), which))
    return markdown(('noise', 'flights', 'with a caution', 'cautions'), rows)


def _codes(flight):
    """Return the codes of the cautions of a flight: (noise, seed, trajectory, vehicle)."""
    noise, seed, trajectory, name = flight
    vehicle = load_vehicle(name)
    record = fly_closed_loop(vehicle, {}, trajectory, duration=SECONDS, seed=seed,
                             noise=SENSORS[noise])
    return [one.code for one in findings(record, vehicle) if one.severity != 'info']
