# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A full matrix of inertia: what physics keeps, another body frame, and the vehicle file."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
import yaml

from quad_ident_ros.effects.registry import NULL, PLACE, vector
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import CLEAN
from quad_ident_ros.greybox.parameters import INDEX, limits, nominal
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.contribution import contribution
from quad_ident_ros.model.dynamics import Course, course_of, predict, states_of
from quad_ident_ros.model.mixing import allocation_matrix
from quad_ident_ros.model.rigid_body import vehicle_vector
from quad_ident_ros.model.simulate import simulate
from quad_ident_ros.model.vehicle import (
    load_vehicle,
    Rotor,
    vehicle_from_mapping,
    vehicle_to_mapping,
    write_vehicle,
)

BARE = replace(load_vehicle('hummingbird'), linear_drag=(0.0,) * 3, rotational_drag=(0.0,) * 3)
IXX, IYY, IZZ = BARE.inertia
SKEW = replace(BARE, inertia=(IXX, 1.2 * IYY, IZZ), products=(0.2 * IXX, -0.15 * IXX, 0.1 * IXX))
START = np.array([0.0, 0.0, 50.0, 1.0, -2.0, 0.5, *Rotation.from_rotvec([0.3, -0.5, 0.8]).as_quat(
    scalar_first=True), 3.0, -5.0, 4.0])


def rolled(vehicle, commands, t, start=START, effects=None):
    """Return the states (N, 13) under commands (M, n) at times t (N,)."""
    theta = vector(effects or {}, vehicle)
    course = Course(t, commands, np.zeros(len(t)))
    return predict(vehicle, theta, course, start[None], [0], len(t) - 1)[0]


def momentum(vehicle, states):
    """Return the angular momentum of the body, world, (N, 3)."""
    own = states[:, 10:] @ vehicle.inertia_matrix
    return np.einsum('nij,nj->ni', rotation_matrix(states[:, 6:10]), own)


def test_free_rotation_keeps_energy_and_angular_momentum():
    t = np.arange(0.0, 2.0, 0.002)
    states = rolled(SKEW, np.zeros((len(t), 4)), t)
    rate = states[:, 10:]
    energy = 0.5 * np.sum(rate * (rate @ SKEW.inertia_matrix), axis=1)
    assert np.ptp(rate, axis=0).min() > 1.0
    np.testing.assert_allclose(energy, energy[0], rtol=1e-7)
    world = momentum(SKEW, states)
    np.testing.assert_allclose(world, np.broadcast_to(world[0], world.shape),
                               atol=1e-7 * np.linalg.norm(world[0]))


def test_a_jump_of_the_rotors_keeps_the_whole_angular_momentum():
    """Two opposite rotors of one spin start: their thrust makes no moment, their spin does."""
    vehicle, spin_inertia = replace(SKEW, torque_coefficient=1e-30), 3e-5
    t = np.arange(0.0, 1.0, 0.002)
    commands = np.zeros((len(t), 4))
    for j, rotor in enumerate(vehicle.rotors):
        commands[200:, j] = 400.0 if rotor.spin == 1 else 0.0
    states = rolled(vehicle, commands, t, effects={'rotor_gyro': {'rotor_inertia': spin_inertia}})
    spun = -spin_inertia * (commands @ [rotor.spin for rotor in vehicle.rotors])
    # A state is that just before the command given with it.
    axes = rotation_matrix(states[:, 6:10])[:, :, 2]
    whole = momentum(vehicle, states) + np.append(0.0, spun[:-1])[:, None] * axes
    assert np.abs(spun).max() > 0.1 * np.linalg.norm(whole[0])
    np.testing.assert_allclose(whole, np.broadcast_to(whole[0], whole.shape),
                               atol=1e-6 * np.linalg.norm(whole[0]))


def test_the_rate_changes_as_the_equation_of_motion_says():
    t, speeds = np.arange(0.0, 0.3, 0.002), np.array([430.0, 450.0, 455.0, 440.0])
    matrix = SKEW.inertia_matrix
    _, roll, pitch, yaw = allocation_matrix(SKEW) @ speeds ** 2
    moment = np.array([roll * SKEW.arm_length, pitch * SKEW.arm_length, yaw])
    known = solve_ivp(lambda _, w: np.linalg.solve(matrix, moment - np.cross(w, matrix @ w)),
                      (0.0, t[-1]), START[10:], t_eval=t, rtol=1e-11, atol=1e-11).y.T
    found = rolled(SKEW, np.tile(speeds, (len(t), 1)), t)
    np.testing.assert_allclose(found[:, 10:], known, atol=1e-6)


def test_the_motion_does_not_depend_on_where_the_body_s_axes_point():
    turned = Rotation.from_euler('z', 0.6)
    table = turned.as_matrix()
    inertia = table @ np.diag([IXX, 1.4 * IYY, IZZ]) @ table.T
    one = replace(BARE, inertia=(IXX, 1.4 * IYY, IZZ))
    other = replace(one, inertia=tuple(np.diag(inertia)),
                    products=(inertia[0, 1], inertia[0, 2], inertia[1, 2]),
                    rotors=tuple(Rotor(tuple(table @ rotor.position), rotor.spin)
                                 for rotor in one.rotors))
    assert abs(other.products[0]) > 0.1 * IXX
    t = np.arange(0.0, 0.5, 0.005)
    commands = 450.0 + 8.0 * np.sin(np.outer(t, [7.0, 5.0, 3.0, 11.0]) + [0.0, 1.0, 2.0, 3.0])
    # What the new axes see of the same body: its attitude is q times the inverse of the turn.
    start = START.copy()
    start[6:10] = (Rotation.from_quat(START[6:10], scalar_first=True) * turned.inv()).as_quat(
        scalar_first=True)
    start[10:] = table @ START[10:]
    known = {'rotor_drag': {'coefficient': 0.3}, 'rotor_gyro': {'rotor_inertia': 3e-5}}
    for effects in ({}, known):
        first = rolled(one, commands, t, effects=effects)
        second = rolled(other, commands, t, start, effects)
        np.testing.assert_allclose(second[:, :6], first[:, :6], atol=1e-7)
        np.testing.assert_allclose(second[:, 10:] @ table, first[:, 10:], atol=1e-6)


def test_a_moment_that_is_added_is_the_contribution():
    theta, t = NULL.copy(), np.arange(0.0, 0.1, 0.01)
    theta[PLACE['external_wrench', 'moment_x']] = 0.02
    course = Course(t, np.full((len(t), 4), 450.0), np.zeros(len(t)))
    _, moment = contribution(SKEW, theta, course, np.tile(START, (len(t), 1)))
    np.testing.assert_allclose(moment, np.tile([0.02, 0.0, 0.0], (len(t), 1)), atol=1e-12)


def test_a_flight_in_closed_loop_is_one_of_the_same_vehicle():
    record = fly_closed_loop(SKEW, {}, 'figure8', duration=5.0, seed=1, noise=CLEAN)
    states, first = states_of(record), np.arange(0, 400, 40)
    ends = predict(SKEW, NULL, course_of(record, SKEW), states[first], first, 20)[:, -1]
    plain = predict(replace(SKEW, products=(0.0,) * 3), NULL, course_of(record, SKEW),
                    states[first], first, 20)[:, -1]
    np.testing.assert_allclose(ends[:, 10:], states[first + 20, 10:], atol=1e-4)
    assert np.abs(plain[:, 10:] - states[first + 20, 10:]).max() > 0.01


def test_products_are_the_last_constants_and_within_their_limits():
    assert tuple(vehicle_vector(SKEW)[16:]) == SKEW.products
    place = slice(INDEX['product_xy'], INDEX['product_yz'] + 1)
    z, (lower, upper, _) = nominal(SKEW)[place], limits(SKEW)[:, place]
    assert ((lower < z) & (z < upper)).all()


def test_the_file_has_a_matrix_only_where_there_are_products(tmp_path):
    known = replace(SKEW, uncertainty={'inertia': (1e-4, None, 2e-4)})
    for vehicle in (BARE, SKEW, known):
        write_vehicle(tmp_path / 'v.yaml', vehicle)
        assert load_vehicle(tmp_path / 'v.yaml') == vehicle
        rows = yaml.safe_load((tmp_path / 'v.yaml').read_text())['inertia']
        assert isinstance(rows[0], list) == bool(any(vehicle.products))


@pytest.mark.parametrize(('rows', 'why'), [
    ([[1.0, 0.1, 0.0], [0.2, 1.0, 0.0], [0.0, 0.0, 1.5]], 'is not symmetric'),
    ([[1.0, 1.5, 0.0], [1.5, 1.0, 0.0], [0.0, 0.0, 1.5]], 'principal moment: -0'),
    ([[1.0, 0.0, 0.0], [0.0, 1.0]], 'expected .Ixx, Iyy, Izz. or 3 rows'),
    ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 1.5], 'expected .Ixx, Iyy, Izz. or 3 rows'),
    ([[1.0, 'a', 0.0], [0.1, 1.0, 0.0], [0.0, 0.0, 1.5]], r'inertia\[0\]\[1\]'),
    ([[1.0, {'value': 0.1, 'std': 0.01}, 0.0], [0.1, 1.0, 0.0], [0.0, 0.0, 1.5]],
     'only moments of inertia'),
    ([[-1.0, 0.1, 0.0], [0.1, 1.0, 0.0], [0.0, 0.0, 1.5]], r'inertia\[0\]')])
def test_a_matrix_that_no_body_has_is_refused_in_one_line(rows, why):
    data = vehicle_to_mapping(BARE)
    data['inertia'] = [[entry * IXX if isinstance(entry, float) else entry for entry in row]
                       if isinstance(row, list) else row * IXX for row in rows]
    with pytest.raises(InputError, match=why) as caught:
        vehicle_from_mapping(data, 'v.yaml')
    assert '\n' not in str(caught.value)


def test_the_equations_as_printed_refuse_products():
    inputs = np.tile(SKEW.hover_input, (10, 1))
    with pytest.raises(InputError, match='know moments of inertia alone'):
        simulate(SKEW, 'paper', inputs, 0.01)
    assert simulate(SKEW, 'newton_euler', inputs, 0.01).status == 'complete'
