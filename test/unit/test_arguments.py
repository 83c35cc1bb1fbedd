# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What public functions say of a name, a path or a single record in place of what they take."""

from flightmaker import flight
import pytest

from quad_ident_ros.api import diagnose, fit, identify, InputError, load_vehicle, read, simulate

VEHICLE = load_vehicle('hummingbird')
LIST = 'records: expected a list of flight records, got '
OF_FILE = "expected FlightRecord, got 'a.csv'; read(path) makes one of a file"
WANTED = "vehicle: expected Vehicle, got 'hummingbird'; load_vehicle(name_or_path) makes one"


@pytest.mark.parametrize(('call', 'said'), [
    (lambda: diagnose('a.csv', VEHICLE), f"{LIST}'a.csv'; read(path) makes one of a file"),
    (lambda: diagnose(3, VEHICLE), f'{LIST}3; read(path) makes one of a file'),
    (lambda: diagnose(['a.csv'], VEHICLE), f'records[0]: {OF_FILE}'),
    (lambda: diagnose([flight()], VEHICLE, hold_out='a.csv'), f'hold_out: {OF_FILE}'),
    (lambda: diagnose(flight(), VEHICLE), f'{LIST}a single one; write [record]'),
    (lambda: diagnose([flight()], 'hummingbird'), WANTED),
    (lambda: fit(flight(), VEHICLE, ['mass']), f'{LIST}a single one; write [record]'),
    (lambda: fit([flight()], 'hummingbird', ['mass']), WANTED),
    (lambda: identify([flight(), 'a.csv']), f'records[1]: {OF_FILE}'),
    (lambda: simulate('hummingbird', {}, 'hover'), WANTED),
    (lambda: simulate(VEHICLE, {}, 'hover', noise='faulty'),
     "noise: expected Sensors, got 'faulty'; SENSORS[name] is one, of clean, mocap_imu, faulty"),
    (lambda: read(None), 'path: expected the path of a flight, got None'),
])
def test_what_is_given_in_place_of_what_is_needed_is_told_in_one_line(call, said):
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value) == said


def test_one_name_to_be_freed_needs_no_list():
    records = [simulate(VEHICLE, {'mass_offset': {'mass': 0.05}}, 'lissajous', duration=10.0)]
    found = fit(records, VEHICLE, 'mass')
    assert found.vehicle == fit(records, VEHICLE, ['mass']).vehicle
