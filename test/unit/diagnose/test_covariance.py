# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The covariance that a vehicle file has: read, written, refused; and that of a diagnosis."""

from dataclasses import replace

import numpy as np
import pytest

from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model import quantities
from quad_ident_ros.model.covariance import covariance_of_matrix
from quad_ident_ros.model.vehicle import (
    load_vehicle,
    vehicle_from_mapping,
    vehicle_to_mapping,
    write_vehicle,
)

BARE = load_vehicle('hummingbird')
TRUTH = {'rotor_drag': {'coefficient': 0.3}, 'motor_lag': {'time_constant': 0.03}}
SECTION = {'parameters': {'mass': {'std': 0.01, 'unit': 'kg'},
                          'rotor_drag.coefficient': {'std': 0.02, 'unit': 'kg/s'}},
           'correlation': [[1, 0.5], [0.5, 1]]}


def refused(**changes):
    """Return what is said of a section with other keys."""
    section = {**SECTION, **changes}
    with pytest.raises(InputError) as caught:
        vehicle_from_mapping({**vehicle_to_mapping(BARE), 'covariance': section}, 'v.yaml')
    assert '\n' not in str(caught.value) and str(caught.value).startswith('v.yaml: covariance')
    return str(caught.value)


def test_a_covariance_is_read_back_as_it_was_written(tmp_path):
    rng = np.random.default_rng(1)
    names = ('mass', 'inertia_y', 'rotors[2].position_x', 'rotor_drag.coefficient')
    sizes = np.array([0.01, 1e-4, 1e-3, 0.02])
    roots = rng.normal(size=(4, 4)) * sizes[:, None]
    known = covariance_of_matrix(names, roots @ roots.T)
    assert known.matrix == pytest.approx(roots @ roots.T, rel=1e-7)
    vehicle = replace(BARE, covariance=known)
    write_vehicle(tmp_path / 'v.yaml', vehicle)
    assert load_vehicle(tmp_path / 'v.yaml') == vehicle


@pytest.mark.parametrize('changes, said', [
    ({'correlation': [[1, 0.5]]}, 'expected 2 rows, one for each of the parameters, got 1'),
    ({'correlation': [[1, 0.5], [0.5]]}, 'correlation[1]: expected a list of 2 numbers'),
    ({'correlation': [[1, 0.5], [0.4, 1]]}, 'mass and rotor_drag.coefficient have 0.5 in row 1 '
                                            'and 0.4 in row 2: it is not symmetric'),
    ({'correlation': [[2, 0.5], [0.5, 1]]}, '2 is not a correlation'),
    ({'correlation': [[0.9, 0.5], [0.5, 1]]}, '0.9 is that of mass with itself; it is 1'),
    ({'correlation': 'none'}, "got 'none'"),
    ({'parameters': {'mas': {'std': 1, 'unit': 'kg'}}}, "did you mean 'mass'?"),
    ({'parameters': {'rotor_fault.loss_5': {'std': 1, 'unit': '1'}}}, "'rotor_fault.loss_5' is "
     'not known here'),
    ({'parameters': {'mass': {'std': 10.0, 'unit': 'g'}}}, "'g' is not the unit of mass; give the "
     'std in kg'),
    ({'parameters': {'mass': {'std': -0.1, 'unit': 'kg'}}}, 'std: -0.1 is out of range'),
    ({'parameters': {'mass': {'std': 0.1}}}, "'unit' is missing"),
    ({'more': 1}, "'more' is not known here")])
def test_what_can_be_no_covariance_is_refused_in_one_line(changes, said):
    assert said in refused(**changes)


def test_numbers_cannot_all_be_opposed_to_one_another():
    names = ('inertia_x', 'inertia_y', 'inertia_z')
    table = np.full((3, 3), -0.9) + 1.9 * np.eye(3)
    said = refused(parameters={name: {'std': 1e-4, 'unit': 'kg m^2'} for name in names},
                   correlation=table.tolist())
    assert 'least eigenvalue is -0.8' in said


def test_every_number_of_a_vehicle_can_be_read_and_changed():
    for name, unit in quantities.units(len(BARE.rotors)).items():
        value = quantities.value_of(BARE, name)
        changed = quantities.with_values(BARE, {name: 1.5 * min(value, 1e3) + 0.25})
        assert quantities.value_of(changed, name) == 1.5 * min(value, 1e3) + 0.25
        assert unit == quantities.unit_of(name)
        others = [other for other in quantities.units(len(BARE.rotors)) if other != name]
        assert all(quantities.value_of(changed, other) == quantities.value_of(BARE, other)
                   for other in others)


@pytest.fixture(scope='module')
def flights():
    return [fly_closed_loop(BARE, TRUTH, course, duration=8.0, seed=k, noise=SENSORS['mocap_imu'])
            for k, course in enumerate(('figure8', 'steps', 'lissajous'))]


@pytest.mark.slow
def test_deviations_are_the_standard_errors_that_are_told_without_what_the_file_adds(flights):
    found = diagnose(flights, BARE, effects=['rotor_drag', 'motor_lag'])
    told = {f'{row.effect}.{name}': value.std for row in found.ranking
            for name, value in row.parameters.items()}
    known = dict(zip(found.covariance.names, found.covariance.stds, strict=True))
    assert known.keys() == told.keys()
    assert all(known[name] <= told[name] < 2.0 * known[name] for name in known)
    assert found.corrected(BARE).covariance == found.covariance
    assert found.as_data()['covariance']['correlation'][0][0] == 1.0
    # A second round that estimates nothing leaves what the first one wrote.
    again = replace(found, covariance=None)
    assert again.corrected(found.corrected(BARE)).covariance == found.covariance


@pytest.mark.slow
def test_constants_that_are_stated_are_as_wide_as_flights_leave_them(flights):
    # Mass, thrust, moments of inertia and torque in proportion are the same motion: what is stated
    # of each gives the common factor; flights give the ratios far better than the statements.
    shares = {'mass': 0.02, 'thrust_coefficient': 0.05, 'torque_coefficient': 0.1,
              'inertia_x': 0.05, 'inertia_y': 0.05, 'inertia_z': 0.05}
    values = {name: quantities.value_of(BARE, name) for name in shares}
    stds = {name: share * values[name] for name, share in shares.items()}
    vehicle = replace(BARE, uncertainty={
        **{name: stds[name] for name in ('mass', 'thrust_coefficient', 'torque_coefficient')},
        'inertia': tuple(stds[f'inertia_{axis}'] for axis in 'xyz')})
    found = diagnose(flights, vehicle, effects=['rotor_drag', 'motor_lag'])
    known = found.covariance
    sizes = [values.get(name, 1.0) for name in known.names]
    matrix = known.matrix / np.outer(sizes, sizes)
    mass, thrust = (known.names.index(name) for name in ('mass', 'thrust_coefficient'))
    common = sum(share ** -2.0 for share in shares.values()) ** -0.5
    assert np.sqrt(matrix[mass, mass]) == pytest.approx(common, rel=0.05)
    ratio = matrix[mass, mass] + matrix[thrust, thrust] - 2.0 * matrix[mass, thrust]
    assert np.sqrt(ratio) < 0.1 * shares['mass']
    # A drag in kg/s scales with them.
    drag = known.names.index('rotor_drag.coefficient')
    assert np.sqrt(matrix[drag, drag]) / 0.3 == pytest.approx(common, rel=0.1)
