# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles, paths, controllers and strangers of the withheld check do what they are for."""

from importlib import import_module
from importlib.util import find_spec
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from quad_ident_ros.model.vehicle import load_vehicle
from withheld import lists

if find_spec('rotorpy') is None:
    pytest.skip('rotorpy is not installed', allow_module_level=True)
constants, controllers, outside, paths, plant, realities, sensors, vehicles = (
    import_module(f'withheld.{name}') for name in (
        'constants', 'controllers', 'outside', 'paths', 'plant', 'realities',
        'sensors', 'vehicles'))
setups = import_module('withheld.estimator.setups')
EVALUATION = lists.EVALUATION


def params_of(name, seed=1):
    return vehicles.vehicle_of(name, np.random.default_rng(seed), True)


def test_every_name_of_the_lists_is_one_that_is_flown():
    for names, table in ((lists.VEHICLES, vehicles.BASES), (lists.PATHS, paths.PATHS),
                         (lists.CONTROLLERS, controllers.CONTROLLERS),
                         (lists.NOISES, sensors.WHITE), (lists.STRANGERS, outside.KINDS)):
        assert {name for part in names.values() for name in part} == set(table)


def test_the_estimators_of_the_two_lists_share_no_sensor_or_filter():
    developed, evaluated = (setups.SETUPS[part] for part in lists.PARTS)
    for one in developed:
        for other in evaluated:
            assert one.imu != other.imu and one.aid != other.aid
            assert one.make_filter.keywords != other.make_filter.keywords


def test_the_vehicles_of_the_evaluation_differ_in_mass_and_geometry():
    made = [params_of(name) for name in lists.VEHICLES[EVALUATION]]
    masses = sorted(params['mass'] for params in made)
    assert masses[-1] > 10.0 * masses[0]
    assert {params['num_rotors'] for params in made} == {4, 6}
    for params in made:
        # A body cannot have more inertia about one axis than about the other two together.
        moments = np.array([params[f'I{axis}{axis}'] for axis in 'xyz'])
        assert np.all(2.0 * moments < moments.sum())
        arm = max(np.linalg.norm(place) for place in params['rotor_pos'].values())
        assert 0.05 < np.sqrt(moments[0] / params['mass']) / arm < 1.0
        assert np.sum(params['rotor_directions']) == 0


@pytest.mark.parametrize('name', lists.VEHICLES[EVALUATION])
def test_the_library_reads_their_files(name, tmp_path):
    params = params_of(name)
    (tmp_path / 'vehicle.yaml').write_text(vehicles.nominal_file(params, name))
    vehicle = load_vehicle(str(tmp_path / 'vehicle.yaml'))
    assert len(vehicle.rotors) == params['num_rotors']
    assert vehicle.hover_speed == pytest.approx(constants.hover_speed(params))


def test_a_hexacopter_hovers_on_six_rotors():
    params = params_of('hexacopter_x')
    reality = plant.Reality(params, {})
    assert reality.rotor_geometry.shape == (6, 3)
    state = np.zeros(22)
    state[2], state[9], state[16:] = 1.0, 1.0, reality.hover
    for _ in range(50):
        state = reality.hold(state, np.full(6, reality.hover), 0.01)
    assert state[:6] == pytest.approx([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], abs=1e-9)
    # A weaker rotor turns it about the line across its own arm.
    weaker = plant.Reality(params, {'rotor_fault': {'loss_6': 0.2}})
    state = weaker.hold(state, np.full(6, reality.hover), 0.001)
    x, y, _ = weaker.rotor_geometry[5]
    assert state[10] * y < 0.0 < state[11] * x


@pytest.mark.parametrize('name', lists.PATHS[EVALUATION])
def test_a_path_is_as_fast_and_as_low_as_asked(name):
    path = paths.PATHS[name](np.random.default_rng(2), size=1.8, acceleration=2.5, low=0.4,
                             turn=1.0)
    t = np.arange(0.0, 20.0, 0.01)
    aims = [path.update(one) for one in t]
    places, speeds, pulls = (np.array([one[key] for one in aims])
                             for key in ('x', 'x_dot', 'x_ddot'))
    assert np.sqrt(np.mean(pulls[:, :2] ** 2)) == pytest.approx(2.5, rel=0.1)
    assert places[:, 2].min() == pytest.approx(0.4, abs=0.01)
    assert np.abs(places[:, :2]).max() < 1.3 * 1.8
    assert np.abs(np.gradient(places, t, axis=0) - speeds)[1:-1].max() < 5e-3
    assert np.abs(np.gradient(speeds, t, axis=0) - pulls)[1:-1].max() < 0.2
    yaw = np.array([one['yaw_ddot'] for one in aims])
    assert 0.1 < np.abs(yaw).max() < 1.05


@pytest.mark.parametrize('name', lists.CONTROLLERS[EVALUATION])
@pytest.mark.parametrize('vehicle', lists.VEHICLES[EVALUATION])
def test_a_controller_holds_every_vehicle_on_its_path(vehicle, name):
    params = params_of(vehicle)
    path = paths.PATHS['knot'](np.random.default_rng(2), size=1.5, acceleration=2.5, low=0.5,
                               turn=0.5)
    world = realities.World(params, realities.Setting(params, name), {}, {}, {})
    flown = world.fly(path, 4.0, 0.01, sensors.Noise(), np.random.default_rng(1), 12.0)
    aims = np.array([path.update(0.01 * k)['x'] for k in range(400)])
    assert np.linalg.norm(flown.exact[:, :3] - aims, axis=1).max() < 0.4
    assert np.mean(flown.commands >= 0.999 * params['rotor_speed_max']) < 0.02


@pytest.mark.parametrize('name', sorted(outside.KINDS))
def test_a_stranger_flies(name):
    params = params_of('hummingbird')
    path = paths.Sines(np.random.default_rng(2), size=1.5, acceleration=2.5, low=0.3, turn=0.5)
    flights = []
    for size in (0.0, 3.0):
        world = realities.World(params, realities.Setting(params), {}, {}, {name: size})
        flights.append(world.fly(path, 2.0, 0.01, sensors.Noise(), np.random.default_rng(1),
                                 12.0))
    none, strange = flights
    assert np.all(np.isfinite(strange.states))
    assert np.abs(strange.states - none.states).max() > 1e-4


def test_a_load_that_sloshes_leaves_the_mass_of_the_vehicle_to_it():
    params = params_of('hummingbird')
    load = outside.Slosh(3.0, params['mass'], np.random.default_rng(1))
    assert load.mass(1.0) == 0.0
    reality = plant.Reality(params, {}, [load])
    state = np.zeros(20)
    state[2], state[9], state[16:] = 1.0, 1.0, reality.hover
    after = reality.hold(state, np.full(4, reality.hover), 0.01)
    assert reality.mass == pytest.approx(params['mass'])
    assert after[:6] == pytest.approx(state[:6], abs=1e-9)


def test_no_stranger_hides_what_an_influence_does():
    methods = ('mass', 'given', 'gain', 'torque', 'wrench', 'wind', 'measured', 'after', 'alter',
               'begin', 'bodies')
    params = params_of('hummingbird')
    world = realities.World(params, realities.Setting(params), {}, {},
                            dict.fromkeys(outside.KINDS, 1.0))
    for part in world.parts().values():
        assert all(callable(getattr(part, method)) for method in methods)


def test_a_wall_pulls_towards_it_and_less_from_afar():
    wall = outside.Wall(1.0, 0.1, 5.0, np.random.default_rng(1))
    near, far = (wall.force(0.0, place * wall.towards, None) for place in (0.6, -0.6))
    assert near @ wall.towards > 2.0 * (far @ wall.towards) > 0.0
    assert np.linalg.norm(np.cross(near, wall.towards)) == pytest.approx(0.0)


def test_a_column_of_air_turns_around_its_middle():
    whirl = outside.Whirl(1.0, 5.0, np.random.default_rng(1))
    middle, turn = np.array([*whirl.place, 1.0]), 0.0
    for angle in np.linspace(0.0, 6.0, 7):
        arm = 0.5 * np.array([np.cos(angle), np.sin(angle), 0.0])
        force = whirl.force(0.0, middle + arm, None)
        assert force @ arm == pytest.approx(0.0, abs=1e-12)
        turn += np.sign(np.cross(arm, force)[2])
    assert abs(turn) == 7 and not np.any(whirl.force(0.0, middle, None))


def test_one_rotor_at_a_time_stutters_and_not_always_the_same():
    stutter = outside.Stutter(2.0, 4, np.random.default_rng(1))
    stutter.begin(np.random.default_rng(2))
    gains = np.array([stutter.gain(SimpleNamespace(time=t)) for t in np.arange(0.0, 20.0, 0.01)])
    weak = gains < 1.0
    assert weak.sum(axis=1).max() == 1 and set(gains[weak].round(9)) == {0.9}
    assert np.all(weak.any(axis=0)) and 0.05 < weak.any(axis=1).mean() < 0.25


def test_a_compass_errs_about_the_vertical_alone():
    compass = outside.Compass(2.0, np.random.default_rng(1))
    errors = []
    for yaw in np.linspace(-3.0, 3.0, 13):
        true = Rotation.from_euler('ZYX', [yaw, 0.2, -0.1])
        seen = compass.measured(0.0, np.array([*np.zeros(6), *true.as_quat(), *np.zeros(3)]), 1.0)
        turn = (Rotation.from_quat(seen[6:10]) * true.inv()).as_rotvec()
        assert turn[:2] == pytest.approx(np.zeros(2), abs=1e-12)
        errors.append(turn[2])
    assert np.ptp(errors) > 0.02 and np.abs(errors).max() < 0.2


def test_branches_push_aside_off_the_centre_now_and_then():
    branches, pushes = outside.Branches(1.0, 5.0, 0.1, np.random.default_rng(1)), []
    branches.begin(np.random.default_rng(2))
    for t in np.arange(0.0, 20.0, 0.01):
        extra = branches.wrench(SimpleNamespace(time=t, rotation=np.eye(3)))
        pushes.append(np.zeros((2, 3)) if extra is None else np.array(extra))
    forces, moments = np.moveaxis(np.array(pushes), 1, 0)
    sizes = np.linalg.norm(forces, axis=1)
    assert 0.05 < np.mean(sizes > 0.0) < 0.3 and not np.any(forces[:, 2])
    assert sizes.max() == pytest.approx(branches.push, rel=0.02)
    assert 0.0 < np.abs(moments).max() <= branches.away * branches.push


def test_a_leash_pulls_beyond_its_length_alone():
    leash = outside.Leash(1.0, 5.0, np.random.default_rng(1))
    place = np.array([0.0, 0.0, leash.length])
    assert not np.any(leash.force(0.0, leash.end - 0.99 * place, None))
    pulls = [leash.force(0.0, leash.end - share * place, None) for share in (1.5, 2.0)]
    assert pulls[1] == pytest.approx(leash.stiffness * place)
    assert pulls[0] == pytest.approx(0.5 * pulls[1])


def test_a_jet_pushes_back_where_the_body_carries_it_and_not_always():
    recoil, pushes = outside.Recoil(1.0, 5.0, 0.1, np.random.default_rng(1)), []
    recoil.begin(np.random.default_rng(2))
    for t in np.arange(0.0, 20.0, 0.01):
        extra = recoil.wrench(SimpleNamespace(time=t))
        pushes.append(np.zeros((2, 3)) if extra is None else np.array(extra))
    forces, moments = np.moveaxis(np.array(pushes), 1, 0)
    sizes = np.linalg.norm(forces, axis=1)
    assert 0.2 < np.mean(sizes > 0.5 * recoil.push) < 0.6 and not np.any(forces[:, 2])
    assert sizes.max() == pytest.approx(recoil.push, rel=0.01)
    # Its valve opens and closes within a moment.
    assert np.abs(np.diff(sizes)).max() <= 1.01 * recoil.push * 0.01 / recoil.OPENS
    assert moments == pytest.approx(np.cross(recoil.place, forces))


def test_a_keel_turns_a_vehicle_upright_and_pushes_it_nowhere():
    keel = outside.Keel(1.0, 5.0, 0.1, np.random.default_rng(1))
    for axis in (0, 1):
        leans = Rotation.from_rotvec(0.3 * np.eye(3)[axis])
        turned = Rotation.from_euler('z', 0.7) * leans
        force, moment = keel.wrench(SimpleNamespace(rotation=turned.as_matrix()))
        assert moment == pytest.approx(-keel.moment * np.sin(0.3) * np.eye(3)[axis])
        assert not np.any(force)


def test_a_twisted_frame_turns_the_body_with_its_thrust_and_pushes_it_nowhere():
    twisted = outside.Twisted(1.0, 5.0, 0.1, 400.0, np.random.default_rng(1))
    for turn in (1.0, 1.2):
        force, moment = twisted.wrench(SimpleNamespace(speeds=np.full(4, 400.0 * turn)))
        assert moment == pytest.approx([0.0, 0.0, twisted.moment * turn ** 2])
        assert not np.any(force)


def test_a_flywheel_resists_a_turn_of_its_axis_alone():
    wheel = outside.Flywheel(1.0, 5.0, 0.1, np.random.default_rng(1))
    along = wheel.momentum / np.linalg.norm(wheel.momentum)
    assert abs(along[2]) > np.cos(wheel.LEANS)
    force, moment = wheel.wrench(SimpleNamespace(rate=2.0 * along))
    assert not np.any(force) and moment == pytest.approx(np.zeros(3))
    across = np.cross(along, [1.0, 0.0, 0.0])
    across /= np.linalg.norm(across)
    _, moment = wheel.wrench(SimpleNamespace(rate=2.0 * across))
    # It takes no energy, and turns about the third axis what it is turned by.
    assert moment @ across == pytest.approx(0.0) and moment @ along == pytest.approx(0.0)
    assert np.linalg.norm(moment) == pytest.approx(2.0 * np.linalg.norm(wheel.momentum))
