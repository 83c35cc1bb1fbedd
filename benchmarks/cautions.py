# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How often the checks of a flight warn of one that nothing is wrong with."""

from itertools import islice, product

from benchmarks.tables import markdown
from quad_ident_ros import resources
from quad_ident_ros.data.quality import findings
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.flight.trajectories import TRAJECTORIES
from quad_ident_ros.model.vehicle import load_vehicle

NOISES = ('clean', 'mocap_imu')
SECONDS = 20.0      # of each flight


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    vehicles = [load_vehicle(name) for name in resources.names('vehicles')]
    vehicles = [vehicle for vehicle in vehicles if vehicle.rotors]
    courses = product(range(size.clean_flights), TRAJECTORIES, vehicles)
    courses = list(islice(courses, size.clean_flights))
    rows = []
    with bar('cautions', len(courses) * len(NOISES)) as advance:
        for noise in NOISES:
            codes = []
            for seed, trajectory, vehicle in courses:
                record = fly_closed_loop(vehicle, {}, trajectory, duration=SECONDS, seed=seed,
                                         noise=SENSORS[noise])
                codes.append([one.code for one in findings(record, vehicle)
                              if one.severity != 'info'])
                advance()
            which = ', '.join(sorted({code for one in codes for code in one})) or 'none'
            rows.append((noise, str(len(codes)), str(sum(map(bool, codes))), which))
    return markdown(('noise', 'flights', 'with a caution', 'cautions'), rows)
