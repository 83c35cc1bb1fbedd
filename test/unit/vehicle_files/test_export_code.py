# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The program beside an MJCF model, run in MuJoCo and held against our own equations."""

from dataclasses import replace
import sys

from effect_flights import accelerations, roll, state, steps
from exported import base
import numpy as np
import pytest
from test_vehicle_files_mjcf import DELAYED

from quad_ident_ros.cli.main import main
from quad_ident_ros.effects.thrust_scale_curve import SPEED_OF
from quad_ident_ros.model.motors import rotor_speeds
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.vehicle_files.export import export
from quad_ident_ros.vehicle_files.load import read_vehicle
from quad_ident_ros.vehicle_files.mujoco_code import LINES
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.ways import forms_of
from quad_ident_ros.vehicle_files.written import read_back, with_code

# Some sets, because forms of one effect take the place of one another.
SETS = ({'rotor_drag': {'coefficient': 0.2}, 'body_drag': {'horizontal': 0.02, 'vertical': 0.05},
         'wind': {'x': 2.0, 'y': -1.0, 'z': 0.5},
         'inflow': {'axial': 0.3, 'translational': 0.01}, 'ground_effect': {'strength': 4.0},
         'blade_flapping': {'coefficient': 0.01}, 'thrust_scale': {'exponent': 2.2},
         'rotor_fault': {'loss_2': 0.1, 'loss_both_3': 0.05}},
        {'rotor_drag': {'x': 0.1, 'y': 0.2, 'z': 0.05}, 'body_drag': {'x': 0.02, 'z': 0.01},
         'inflow': {'climb': 0.2, 'climb_square': 0.02, 'edgewise': -0.1,
                    'edgewise_square': 0.01},
         'blade_flapping': {'arm': 0.03}, 'thrust_scale': {'offset': 0.3},
         'ground_effect': {'at_half': 0.3, 'at_one': 0.2, 'at_two': 0.1, 'at_four': 0.05}},
        {'rotor_drag': {'x_by_speed': 0.1, 'y_by_speed': 0.2, 'z_by_speed': 0.05},
         'blade_flapping': {'arm_x': 0.03, 'arm_y': -0.02, 'arm_z': 0.05},
         'thrust_scale': {'at_70': 0.9, 'at_85': 1.0, 'at_100': 1.05, 'at_115': 1.1,
                          'at_130': 0.95},
         'inertia_mismatch': {'xx': 1.2, 'yy': 1.1, 'zz': 0.9, 'xy': 0.1, 'xz': -0.08,
                              'yz': 0.05}},
        {'blade_flapping': {'hub_coefficient': 0.01, 'rate_damping': 2e-3},
         'rotor_drag': {'coefficient': 0.2},
         'inflow': {'axial_overall': 0.3, 'translational_overall': 0.01},
         'inertia_mismatch': {'arms_x': 1.3, 'arms_y': 1.2, 'torque': 0.8}})
IN_NUMBERS = {'rotor_fault', 'inertia_mismatch'}   # of MJCF itself
VEHICLE = replace(load_vehicle('hummingbird'), linear_drag=(0.1, 0.15, 0.2),
                  rotational_drag=(1e-3, 2e-3, 3e-3))


@pytest.fixture(autouse=True)
def without_callback():
    """Leave no callback behind in MuJoCo."""
    yield
    if 'mujoco' in sys.modules:
        sys.modules['mujoco'].set_mjcb_passive(None)


def model_of(vehicle, source=None):
    """Return MuJoCo's model of an Export with its code installed, and the code's names."""
    mujoco = pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    found = export(vehicle, 'mujoco', source)
    model = mujoco.MjModel.from_xml_string(found.text)
    space: dict = {}
    if found.code is not None:
        exec(found.code.text, space)
        space['install'](model)
    return mujoco, model, space, found


def test_every_law_is_in_one_of_the_sets():
    assert set(LINES) <= {(name, form) for effects in SETS for name, form, _ in forms_of(effects)}


@pytest.mark.parametrize('speed', SPEED_OF.values())
@pytest.mark.parametrize('effects', [SETS[1], {**SETS[2], **SETS[3]}])
def test_the_file_and_the_code_read_back_are_the_vehicle_at_a_heavier_hover(effects, speed):
    effects = {name: values for name, values in effects.items() if name not in IN_NUMBERS}
    vehicle = replace(VEHICLE, effects={**effects, 'mass_offset': {'mass': 0.15}})
    found = export(vehicle, 'mujoco', None)
    read = with_code(found, read_back(found, Source('a.xml', found.text), vehicle), vehicle)
    assert read.hover_speed > 1.1 * vehicle.hover_speed
    start = state((0, 0, 0.15), (2, -3, 1), (0.2, -0.1, 0.3), (1, -2, 0.5))
    speeds = np.full((1, 4), speed * read.hover_speed)
    np.testing.assert_allclose(accelerations(read, start, speeds),
                               accelerations(vehicle, start, speeds), rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize('effects', SETS)
def test_accelerations_are_those_of_our_equations(effects):
    vehicle = replace(VEHICLE, effects=effects)
    mujoco, model, _, found = model_of(vehicle)
    by_code = {fate.name for fate in found.fates.by_code}
    assert by_code == set(effects) - IN_NUMBERS | {'linear_drag', 'rotational_drag'}
    data, draw = mujoco.MjData(model), np.random.default_rng(3)
    for _ in range(20):
        start = state((0, 0, 0.15), draw.normal(0, 4, 3), draw.uniform(-0.5, 0.5, 3),
                      draw.normal(0, 2, 3))
        speeds = vehicle.hover_speed * draw.uniform(0.7, 1.3, (1, 4))
        data.qpos[:] = [*start[:3], *start[6:10]]
        data.qvel[:] = [*start[3:6], *start[10:]]
        data.ctrl[:] = vehicle.thrust_coefficient * speeds[0] ** 2
        mujoco.mj_forward(model, data)
        np.testing.assert_allclose(data.qacc, accelerations(vehicle, start, speeds), rtol=1e-9,
                                   atol=1e-9)


def test_the_code_has_the_delayed_thrusts_of_a_file_that_delays():
    source = Source('quad.xml', DELAYED)
    vehicle = read_vehicle(source).vehicle
    drag = {'rotor_drag': {'coefficient': 0.2}}     # goes with the speed of the rotors
    mujoco, model, space, found = model_of(
        replace(vehicle, effects={**vehicle.effects, **drag}), source)
    assert [fate.name for fate in found.fates.by_code] == ['rotor_drag']
    assert 'Commands' not in found.code.text
    data = mujoco.MjData(model)
    lifts = []
    for given in (3.0, 4.0, 5.0):
        data.ctrl[:] = given
        for _ in range(round(0.02 / model.opt.timestep)):
            mujoco.mj_step(model, data)
        lifts.append(space['thrusts'](model, data)[0])
    # At the time after a step acts what was given 0.02 s before it.
    assert lifts == [3.0, 4.0, 5.0]
    np.testing.assert_allclose(data.actuator_force, 4.0)


@pytest.mark.parametrize('effects', [
    {**SETS[0], 'actuation_delay': {'delay': 0.02}}, SETS[1],
    {'motor_lag': {'time_constant': 0.06}}, {'motor_lag': {'rise': 0.05, 'fall': 0.08}},
    {**SETS[0], 'actuation_delay': {'delay': 0.02}, 'motor_lag': {'time_constant': 0.06}}])
def test_a_flight_in_mujoco_is_that_of_our_model(effects):
    vehicle = replace(VEHICLE, effects=effects)
    mujoco, model, space, _ = model_of(vehicle)
    course, start = steps(vehicle, seconds=0.5), state((0, 0, 1), (1, -2, 0.5), (0.1, 0.1, 0.2))
    ours = roll(vehicle, effects, course, start)
    model.opt.timestep = 0.001
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = [*start[:3], *start[6:10]], [*start[3:6], *start[10:]]
    line = space['Commands']() if 'Commands' in space else None
    data.ctrl[:] = vehicle.thrust_coefficient * course.commands[0] ** 2
    data.act[:] = data.ctrl[:model.na]
    for command in course.commands[:-1]:
        for _ in range(10):
            controls = vehicle.thrust_coefficient * command ** 2
            if line is None:
                data.ctrl[:] = controls
            else:
                line.command(model, data, controls)
            mujoco.mj_step(model, data)
    # Our step of 10 ms leaves micrometres over half a second; the effects make decimetres.
    np.testing.assert_allclose(data.qpos[:3], ours[-1, :3], atol=1e-5)
    np.testing.assert_allclose(data.qvel[:3], ours[-1, 3:6], atol=1e-4)
    np.testing.assert_allclose(data.qvel[3:], ours[-1, 10:], atol=1e-3)


def test_rotors_slow_down_as_fast_where_their_controls_end_at_zero():
    vehicle = replace(VEHICLE, effects={'motor_lag': {'time_constant': 0.05}})
    mujoco, model, space, _ = model_of(vehicle)
    model.opt.timestep = 0.001
    assert model.actuator_ctrllimited.all() and not model.actuator_ctrlrange[:, 0].any()
    data, line = mujoco.MjData(model), space['Commands']()
    hover = vehicle.thrust_coefficient * vehicle.hover_speed ** 2
    data.qpos[2], data.act[:] = 1.0, hover
    for _ in range(50):
        line.command(model, data, np.zeros(4))
        mujoco.mj_step(model, data)
    # The speed falls by a lag, so that the thrust falls as its square: twice as fast.
    np.testing.assert_allclose(data.act, hover * np.exp(-2.0), rtol=1e-6)


def test_the_lag_of_the_actuators_is_ours_for_small_changes_without_the_code():
    lag = {'motor_lag': {'time_constant': 0.05}}
    vehicle = replace(VEHICLE, effects=lag, linear_drag=(0.0, 0.0, 0.0),
                      rotational_drag=(0.0, 0.0, 0.0))
    mujoco, model, _, found = model_of(vehicle)
    assert [fate.name for fate in found.fates.by_code] == ['motor_lag']
    data = mujoco.MjData(model)
    hover = vehicle.thrust_coefficient * vehicle.hover_speed ** 2
    data.qpos[2], data.act[:], data.ctrl[:] = 1.0, hover, hover * 1.02 ** 2
    mujoco.mj_step(model, data, 50)
    gone = 1.0 - np.exp(-data.time / 0.05)
    speed = vehicle.hover_speed * (1.0 + 0.02 * gone)
    assert data.actuator_force[0] == pytest.approx(vehicle.thrust_coefficient * speed ** 2,
                                                   rel=2e-4)


def test_code_beside_a_model_of_the_user_finds_its_rotors():
    source, vehicle = base('mujoco')
    vehicle = replace(vehicle, effects={**vehicle.effects, 'rotor_drag': {'coefficient': 0.4}})
    mujoco, model, space, _ = model_of(vehicle, source)
    data = mujoco.MjData(model)
    controls = vehicle.mass * vehicle.gravity / 4
    assert rotor_speeds(vehicle.motors, [[controls]], vehicle.thrust_coefficient)[0, 0] == (
        pytest.approx(vehicle.hover_speed))
    data.act[:], data.qvel[0] = controls, 3.0
    mujoco.mj_forward(model, data)
    assert data.qfrc_passive[0] == pytest.approx(-0.4 * 3.0, rel=1e-9)
    assert space['ACTUATORS'].tolist() == [0, 1, 2, 3]


def test_another_model_is_left_alone():
    mujoco = pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    other = mujoco.MjModel.from_xml_string('<mujoco><worldbody><body><freejoint/><geom size="1"/>'
                                           '</body></worldbody></mujoco>')
    model_of(replace(VEHICLE, effects=SETS[0]))
    data = mujoco.MjData(other)
    data.qvel[0] = 5.0
    mujoco.mj_forward(other, data)
    assert not data.qfrc_passive.any()


def test_the_command_writes_it_beside_the_model(tmp_path, capsys):
    write_vehicle(tmp_path / 'v.yaml', replace(VEHICLE, effects=SETS[0]))
    assert main(['export', str(tmp_path / 'v.yaml'), '--to', 'mujoco', '-o',
                 str(tmp_path / 'like_real.xml')]) == 0
    text = (tmp_path / 'like_real.py').read_text()
    assert 'quad_ident' not in text and 'What like_real.xml has no number for' in text
    said = capsys.readouterr().out
    assert ('carried: drag of the rotors (rotor_drag), form by_speed: by the code beside the '
            'file') in said
    assert 'like_real.py: code for what the file has no number for' in said
    # It is not written over what somebody else wrote.
    (tmp_path / 'mine.py').write_text('print(1)')
    assert main(['export', str(tmp_path / 'v.yaml'), '--to', 'mujoco', '-o',
                 str(tmp_path / 'mine.xml')]) == 2
    said = capsys.readouterr().err.strip()
    assert 'mine.py: the code beside the file would be written over this' in said
    assert '\n' not in said and not (tmp_path / 'mine.xml').exists()
    # Nor is it lost where a simulator's own file is code.
    assert main(['export', str(tmp_path / 'v.yaml'), '--to', 'rotorpy', '-o',
                 str(tmp_path / 'like_real.py')]) == 2
    assert 'like_real.py: this would write over the code beside a file' in capsys.readouterr().err
    assert (tmp_path / 'like_real.py').read_text() == text


@pytest.mark.parametrize('delay', [0.0005, 0.004, 0.0041, 0.0059])
def test_a_delay_that_ends_within_a_step_acts_for_the_rest_of_it(delay):
    mujoco, model, space, _ = model_of(replace(
        VEHICLE, effects={'actuation_delay': {'delay': delay}}))
    model.opt.timestep = step = 0.002
    data, line = mujoco.MjData(model), space['Commands']()
    seen = []
    for _ in range(5):
        line.command(model, data, np.full(4, 1.0))
        seen.append(data.ctrl[0])
        mujoco.mj_step(model, data)
    ends = step * np.arange(1, 6)
    np.testing.assert_allclose(seen, np.clip((ends - delay) / step, 0.0, 1.0), atol=1e-9)
