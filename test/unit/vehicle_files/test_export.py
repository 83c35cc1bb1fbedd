# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles back into the files of simulators."""

from dataclasses import replace
import difflib
import json
import re

from exported import again, base
import numpy as np
import pytest
import test_vehicle_files_mjcf as mjcf
import test_vehicle_files_sdf as sdf

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.effects.registry import EFFECTS, FORMS
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.covariance import covariance_of_matrix
from quad_ident_ros.model.quantities import with_values
from quad_ident_ros.model.vehicle import write_vehicle
from quad_ident_ros.vehicle_files.export import export, mean_left
from quad_ident_ros.vehicle_files.load import read_vehicle
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.targets import TARGETS
from quad_ident_ros.vehicle_files.ways import NEEDS, WAYS


def changed_lines(old, new):
    return [line for line in difflib.ndiff(old.split('\n'), new.split('\n')) if line[0] == '+']


@pytest.mark.parametrize('to', TARGETS)
def test_a_vehicle_as_the_file_has_it_changes_no_byte(to, tmp_path):
    source, vehicle = base(to)
    write_vehicle(tmp_path / 'v.yaml', vehicle)
    found = export(vehicle, to, source)
    assert found.text == source.text
    assert found.changes == () and found.fates.not_carried == ()
    # The same by the command, with the mark at the begin that some editors write.
    path = tmp_path / source.path
    path.write_bytes(b'\xef\xbb\xbf' + source.text.encode())
    out = tmp_path / f'out_{source.path}'
    assert main(['export', str(tmp_path / 'v.yaml'), '--to', to, '--base', str(path), '-o',
                 str(out)]) == 0
    assert out.read_bytes() == path.read_bytes()


@pytest.mark.parametrize('to', TARGETS)
def test_constants_are_those_of_the_vehicle_when_the_file_is_read_again(to):
    source, vehicle = base(to)
    size = vehicle.inertia[0]
    wanted = replace(vehicle, mass=1.1 * vehicle.mass, products=(0.02 * size, -0.01 * size, 0.0),
                     inertia=tuple(np.array(vehicle.inertia) * [1.05, 1.1, 1.02]),
                     thrust_coefficient=1.2 * vehicle.thrust_coefficient,
                     torque_coefficient=0.9 * vehicle.torque_coefficient)
    found = export(wanted, to, source)
    read = again(source, found)
    # A curve over the speed stays one, which is read at another hover: see its own test.
    for key in ('mass', *(('thrust_coefficient', 'torque_coefficient', 'speed_max')
                          if to != 'crazyflow' else ())):
        assert getattr(read, key) == pytest.approx(getattr(wanted, key), rel=1e-9), key
    assert read.inertia_matrix == pytest.approx(wanted.inertia_matrix, rel=1e-9, abs=1e-9 * size)
    assert [rotor.position for rotor in read.rotors] == [
        pytest.approx(rotor.position, abs=1e-9) for rotor in wanted.rotors]
    assert found.fates.not_carried == ()
    assert {name for change in found.changes for name in change.source.split(', ')} >= {
        'mass', 'inertia'}
    # All but the numbers stays: with the numbers taken out, both texts are the same but for what
    # products of inertia need beside a diagonal.
    for kept in ('<!--', 'sensor', 'camera', 'update_rate>250', 'as weighed', '\r'):
        assert found.text.count(kept) == source.text.count(kept), kept


@pytest.mark.parametrize(('to', 'count'), [('gazebo', 1), ('mujoco', 1), ('urdf', 2)])
def test_a_payload_changes_just_the_lines_of_the_mass(to, count):
    source, vehicle = base(to)
    if to == 'gazebo':      # one body alone, so that no other has to make up for it
        text = re.sub(r'<mass>0.01</mass>\n.*', '<mass>0</mass><inertia><ixx>0</ixx><iyy>0</iyy>'
                      '<izz>0</izz></inertia>', source.text)
        source = replace(source, text=text)
        vehicle = read_vehicle(source).vehicle
    loaded = replace(vehicle, effects={**vehicle.effects,
                                       'mass_offset': {'mass': 0.1 * vehicle.mass}})
    found = export(loaded, to, source)
    lines = changed_lines(source.text, found.text)
    # gym-pybullet-drones states its limit as thrust to weight, which the weight changes.
    assert len(lines) == count and all(re.search('mass|thrust2weight', line) for line in lines)
    assert again(source, found).mass == pytest.approx(1.1 * vehicle.mass, rel=1e-9)
    assert [fate.name for fate in found.fates.nearest] == ['mass_offset']
    assert found.changes[0].source == 'mass, mass_offset'


def test_lag_drag_and_thrust_go_into_the_motors_of_gazebo():
    source, vehicle = base('gazebo')
    wanted = replace(vehicle, uncertainty={'thrust_coefficient': 1e-7}, effects={
        **vehicle.effects, 'motor_lag': {'rise': 0.02, 'fall': 0.04},
        'rotor_drag': {'coefficient': 0.3}, 'thrust_scale': {'factor': 0.9},
        'wind': {'x': 1.0}})
    found = export(wanted, 'gazebo', source)
    read = again(source, found)
    assert read.effects['motor_lag'] == pytest.approx({'rise': 0.02, 'fall': 0.04}, rel=1e-9)
    assert read.thrust_coefficient == pytest.approx(0.9 * vehicle.thrust_coefficient, rel=1e-9)
    # The reaction torque at a speed is the same with less thrust.
    assert read.torque_coefficient == pytest.approx(vehicle.torque_coefficient, rel=1e-9)
    # Force per speed of a rotor and velocity: at their hover, which the weaker thrust moves.
    assert (read.effects['rotor_drag']['coefficient'] / read.hover_speed
            == pytest.approx(0.3 / wanted.hover_speed, rel=1e-9))
    assert {fate.name for fate in found.fates.carried} == {'motor_lag', 'rotor_drag', 'rotor_gyro'}
    assert [fate.name for fate in found.fates.not_carried] == ['wind']
    stds = {change.place.split('<')[1]: change.std for change in found.changes}
    assert stds['motorConstant>'] == pytest.approx(0.9e-7)
    assert stds['timeConstantUp>'] is None
    assert len(changed_lines(source.text, found.text)) == 4 * 3


def test_what_a_diagnosis_knows_of_effects_becomes_standard_errors_of_the_numbers():
    """A drag is shared by the hover speeds; the ratio of what errs alike is sure."""
    source, vehicle = base('gazebo')
    names = ('motor_lag.time_constant', 'rotor_drag.coefficient', 'thrust_coefficient',
             'torque_coefficient')
    drag, lag = 0.3, 0.04
    values = np.array([lag, drag, 1.1 * vehicle.thrust_coefficient,
                       1.2 * vehicle.torque_coefficient])
    stds = values * [0.05, 0.02, 0.01, 0.01]
    for tied in (0.0, 1.0):
        table = np.eye(4)
        table[2, 3] = table[3, 2] = tied
        wanted = replace(with_values(replace(vehicle, effects={}), dict(
            zip(names, values.tolist(), strict=True))),
            covariance=covariance_of_matrix(names, table * np.outer(stds, stds)))
        told = {change.place.split('<')[1]: change.std
                for change in export(wanted, 'gazebo', source).changes}
        assert told['timeConstantUp>'] == pytest.approx(0.05 * lag)
        # The hover speed goes with the root of the thrust coefficient.
        assert told['rotorDragCoefficient>'] == pytest.approx(
            drag / (4 * wanted.hover_speed) * np.hypot(0.02, 0.005), rel=1e-3)
        assert told['motorConstant>'] == pytest.approx(stds[2])
        ratio = values[3] / values[2]
        assert (told['momentConstant>'] or 0.0) == pytest.approx(
            0.01 * ratio * np.sqrt(2 - 2 * tied), abs=1e-6 * ratio)


def test_a_rotor_that_turns_more_slowly_is_one_number_of_gazebo():
    """The momentConstant is the ratio of its torque to its thrust, which both fall."""
    source, vehicle = base('gazebo')
    weak = replace(vehicle, effects={**vehicle.effects, 'rotor_fault': {'loss_both_3': 0.15}})
    found = export(weak, 'gazebo', source)
    assert [(change.new, change.source) for change in found.changes] == [
        (pytest.approx(0.85 * vehicle.thrust_coefficient), 'thrust_coefficient, rotor_fault')]


@pytest.mark.parametrize('to', ['gazebo', 'mujoco'])
@pytest.mark.parametrize('form', ['loss', 'loss_both'])
def test_a_rotor_that_is_lost_is_not_carried(to, form):
    source, vehicle = base(to)
    lost = replace(vehicle, effects={**vehicle.effects, 'rotor_fault': {f'{form}_3': 1.0}})
    found = export(lost, to, source)
    assert [fate.name for fate in found.fates.not_carried] == ['rotor_fault']
    assert found.text == source.text


def test_where_torques_are_controls_of_their_own_a_weak_rotor_loses_thrust_alone():
    known = {'torque_over_thrust': 0.02, 'spins': list(mjcf.SIGNS)}
    source = Source('quad.xml', mjcf.model(actuators=mjcf.APART))
    vehicle = read_vehicle(source, known).vehicle
    weak = replace(vehicle, effects={'rotor_fault': {'loss_both_2': 0.1}})
    found = export(weak, 'mujoco', source)
    [fate] = found.fates.nearest
    assert fate.form == 'thrust_and_torque' and 'control of its own' in fate.reason
    read = read_vehicle(replace(source, text=found.text), known).vehicle
    assert read.effects == {'rotor_fault': {'loss_2': pytest.approx(0.1)}}


def test_a_lag_that_the_vehicle_does_not_have_is_taken_out():
    source, vehicle = base('gazebo')
    found = export(replace(vehicle, effects={'rotor_gyro': vehicle.effects['rotor_gyro']}),
                   'gazebo', source)
    assert set(again(source, found).effects) == {'rotor_gyro'}
    source, vehicle = base('mujoco')
    found = export(replace(vehicle, effects={}), 'mujoco', source)
    assert found.text == source.text
    assert 'that of the file stays' in found.fates.not_carried[0].reason


def test_a_lag_of_mujoco_is_one_time_constant():
    source, vehicle = base('mujoco')
    found = export(replace(vehicle, effects={'motor_lag': {'rise': 0.04, 'fall': 0.06}}),
                   'mujoco', source)
    assert again(source, found).effects == {'motor_lag': {'time_constant': pytest.approx(0.05)}}
    assert [fate.form for fate in found.fates.by_code] == ['rise_fall']
    none = export(replace(vehicle, effects={'rotor_drag': {'coefficient': 0.1}}), 'mujoco', source)
    assert [fate.name for fate in none.fates.by_code] == ['rotor_drag']


def controls_apart(extra=''):
    """Return models with a thrust of all and moments, and with thrusts and one moment."""
    total = f"""<actuator><motor name="all" site="thrust0" gear="0 0 1 0 0 0" {extra}/>
<motor name="roll" site="thrust0" gear="0 0 0 1 0 0" {extra}/>
<motor name="pitch" site="thrust0" gear="0 0 0 0 1 0" {extra}/></actuator>"""
    yaw = f'<motor name="yaw" site="thrust0" gear="0 0 0 0 0 1" {extra}/></actuator>'
    apart = mjcf.motors('0 0 1 0 0 0', extra).replace('</actuator>', yaw)
    return [Source('quad.xml', mjcf.model(actuators=each)) for each in (total, apart)]


def lagging(**effect):
    return replace(base('mujoco')[1], mass=1.3, motors=None, effects=effect)


def test_a_lag_is_one_of_moments_too_that_are_controls_of_their_own():
    """They come from the same rotors: a vehicle whose thrust alone lags turns as before."""
    vehicle = lagging(motor_lag={'time_constant': 0.03})
    for source, count in zip(controls_apart(), (3, 5), strict=True):
        found = export(vehicle, 'mujoco', source)
        assert found.text.count('dynprm="0.03"') == found.text.count('<general') == count
        source = replace(source, text=found.text)
        assert {entry.key: entry.value for entry in read_vehicle(source).read}[
            'time constant of the thrust'] == 0.03
        assert export(vehicle, 'mujoco', source).text == found.text


def test_mujoco_itself_has_the_lag_of_moments_that_are_controls_of_their_own():
    mujoco = pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    found = export(lagging(motor_lag={'time_constant': 0.03}), 'mujoco', controls_apart()[0])
    model = mujoco.MjModel.from_xml_string(found.text)
    data = mujoco.MjData(model)
    data.qpos[2], data.ctrl[:] = 10.0, 0.1
    mujoco.mj_step(model, data, round(0.03 / model.opt.timestep) + 1)    # forces of its begin
    np.testing.assert_allclose(data.actuator_force, 0.1 * (1.0 - np.exp(-1.0)), rtol=1e-6)


def test_a_delay_is_one_of_moments_too_that_are_controls_of_their_own():
    vehicle = lagging(actuation_delay={'delay': 0.03})
    for source, count in zip(controls_apart('delay="0.02" nsample="10"'), (3, 5), strict=True):
        found = export(vehicle, 'mujoco', source)
        assert found.text.count('delay="0.03"') == found.text.count('nsample="15"') == count
    # Where the file has none, and the code delays the thrusts alone, the rest is said.
    found = export(vehicle, 'mujoco', controls_apart()[1])
    assert [fate.name for fate in found.fates.by_code] == ['actuation_delay']
    [said] = found.remarks
    assert said.endswith("<motor name='yaw'> is a control of its own; delay it in what sends it, "
                         'as the code beside the file does the thrusts')


def test_a_moment_with_another_lag_than_the_thrusts_is_said():
    text = controls_apart()[0].text.replace(
        '<motor name="roll"', '<general name="roll" dyntype="filter" dynprm="0.02"')
    [said] = [line for line in read_vehicle(Source('quad.xml', text)).assumed if 'roll' in line]
    assert said.endswith("<general name='roll'>: its lag of 0.02 s is not that of the thrusts, "
                         '0 s, which is taken')


def test_a_motor_of_mujoco_becomes_one_with_a_lag_and_is_else_the_same():
    text = mjcf.model(actuators=mjcf.motors().replace('/>', '>< !-- </motor> --></motor>', 1
                                                      ).replace('< !', '<!'))
    text = text.replace('<default class="quad">', '<general gainprm="3"/><default class="quad">')
    source = Source('quad.xml', text)
    vehicle = read_vehicle(source).vehicle
    assert vehicle == read_vehicle(Source('quad.xml', mjcf.model())).vehicle
    lagged = replace(vehicle, effects={'motor_lag': {'time_constant': 0.03}})
    found = export(lagged, 'mujoco', source)
    assert again(source, found) == lagged
    assert [fate.name for fate in found.fates.by_code] == ['motor_lag']
    assert '3 more become <general>' in found.remarks[0]
    mujoco = pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    old, new = (mujoco.MjModel.from_xml_string(each) for each in (source.text, found.text))
    for name in ('gainprm', 'gear', 'ctrlrange', 'biastype', 'gaintype'):
        np.testing.assert_array_equal(getattr(new, f'actuator_{name}'),
                                      getattr(old, f'actuator_{name}'))
    assert new.actuator_dynprm[:, 0].tolist() == [0.03] * 4


@pytest.mark.parametrize('to', TARGETS)
@pytest.mark.parametrize('by_effect', [True, False])
def test_of_an_inertia_that_no_body_has_the_nearest_is_written_and_said(to, by_effect):
    """A sum of the two smaller moments that is s short moves each by a third of s."""
    source, vehicle = base(to)
    vehicle = replace(vehicle, products=(0.0, 0.0, 0.0))
    x, y = vehicle.inertia[:2]
    wanted = (replace(vehicle, effects={**vehicle.effects, 'inertia_mismatch': {
        'xx': 1.0, 'yy': 1.0, 'zz': 1.3 * (x + y) / vehicle.inertia[2]}}) if by_effect else
        replace(vehicle, inertia=(x, y, 1.3 * (x + y))))
    third = 0.1 * (x + y)
    # SIH has its rotors in an order of its own, so that not every vehicle makes a new file.
    for file in (source, None)[:1 if to == 'px4_sih' else 2]:
        found = export(wanted, to, file)
        [said] = [text for text in found.remarks if 'no body has the inertia' in text]
        assert 'the largest is 30 % more' in said and f'{third:.2g} kg m2 off' in said
        assert [fate.name for fate in found.fates.nearest
                if 'a body can have' in fate.reason] == ['inertia_mismatch'] * by_effect
        # What rotors with a mass of their own leave for the base is to be a body, too.
        assert again(found.base, found).inertia == pytest.approx(
            [x + third, y + third, x + y + 2.0 * third], rel=5e-3 if to == 'gazebo' else 2e-6)


@pytest.mark.parametrize('beyond', [1.0, 1.01, 1.5])
def test_simulators_that_refuse_an_inertia_take_the_one_that_is_written(beyond):
    _, vehicle = base('mujoco')
    axes, _ = np.linalg.qr(np.arange(9.0).reshape(3, 3) + np.eye(3))
    matrix = axes @ np.diag([0.011, 0.012, 0.023 * beyond]) @ axes.T
    flat = replace(vehicle, inertia=tuple(np.diag(matrix)),
                   products=(matrix[0, 1], matrix[0, 2], matrix[1, 2]))
    for to in ('gazebo', 'urdf', 'mujoco'):
        found = export(flat, to)
        moments = np.linalg.eigvalsh(again(found.base, found).inertia_matrix)
        assert moments[2] < moments[0] + moments[1]
    mujoco = pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    mujoco.MjModel.from_xml_string(found.text)


@pytest.mark.parametrize('to', [to for to in TARGETS if 'centre' in TARGETS[to].holds])
def test_the_centre_of_mass_moves_under_the_rotors(to):
    source, vehicle = base(to)
    shift = 0.1 * vehicle.arm_length
    found = export(replace(vehicle, effects={**vehicle.effects, 'com_offset': {
        'x': shift, 'z': -shift}}), to, source)
    read = again(source, found)
    assert read.inertia == pytest.approx(vehicle.inertia, rel=1e-9)
    for rotor, other in zip(vehicle.rotors, read.rotors, strict=True):
        assert np.subtract(rotor.position, other.position) == pytest.approx([shift, 0, -shift],
                                                                            abs=1e-9)


@pytest.mark.parametrize('turn', ['quat="0.9 0.1 0.2 0.3"', 'euler="10 20 30"',
                                  'axisangle="1 0 1 40"', 'xyaxes="1 1 0 0 1 1"', 'zaxis="1 1 2"'])
def test_principal_axes_of_mujoco_turn_with_the_inertia(turn):
    tilted = mjcf.INERTIAL.replace('mass', f'{turn} mass')
    source = Source('quad.xml', mjcf.model(body=tilted))
    vehicle = read_vehicle(source).vehicle
    turned = replace(vehicle, products=(0.001, -0.002, 0.0005))
    assert again(source, export(turned, 'mujoco', source)).inertia_matrix == pytest.approx(
        turned.inertia_matrix, rel=1e-9, abs=1e-12)
    wanted = replace(vehicle, inertia=tuple(1.1 * value for value in vehicle.inertia))
    assert again(source, export(wanted, 'mujoco', source)).inertia_matrix == pytest.approx(
        wanted.inertia_matrix, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize('body', [
    mjcf.INERTIAL, mjcf.INERTIAL.replace('mass', 'quat="0.9 0.1 0.2 0.3" mass'),
    '<geom type="box" size=".1 .1 .05" mass="1.2"/>'])
def test_mujoco_itself_has_the_mass_and_the_inertia(body):
    mujoco = pytest.importorskip('mujoco', reason='MuJoCo is not installed')
    source = Source('quad.xml', mjcf.model(body=body))
    vehicle = read_vehicle(source).vehicle
    wanted = replace(vehicle, mass=1.1 * vehicle.mass, products=(
        vehicle.products[0] + 0.001, *vehicle.products[1:]))
    compiled = mujoco.MjModel.from_xml_string(export(wanted, 'mujoco', source).text)
    place = compiled.body('quad').id
    axes = np.zeros(9)
    mujoco.mju_quat2Mat(axes, compiled.body_iquat[place])
    axes = axes.reshape(3, 3)
    assert compiled.body_mass[place] == pytest.approx(wanted.mass, rel=1e-9)
    assert axes @ np.diag(compiled.body_inertia[place]) @ axes.T == pytest.approx(
        wanted.inertia_matrix, rel=1e-9, abs=1e-10)


def test_a_body_of_mujoco_that_is_a_frame_leaves_the_mass_to_the_one_in_it():
    inner = f'<body name="hull" pos="0.01 0 0" euler="0 0 90">\n{mjcf.INERTIAL}</body>'
    source = Source('quad.xml', mjcf.model(body=inner))
    vehicle = read_vehicle(source).vehicle
    x, y, z = vehicle.inertia
    wanted = replace(vehicle, mass=1.1, inertia=(1.1 * x, y, 1.02 * z))
    found = export(wanted, 'mujoco', source)
    read = again(source, found)
    assert read.mass == 1.1 and read.inertia == pytest.approx(wanted.inertia, rel=1e-9)
    assert len(changed_lines(source.text, found.text)) == 1


def test_shapes_of_mujoco_get_an_inertial_beside_them():
    source = Source('quad.xml', mjcf.model(body='<geom type="box" size=".1 .1 .05" mass="1.2"/>'))
    vehicle = read_vehicle(source).vehicle
    wanted = replace(vehicle, mass=1.5)
    found = export(wanted, 'mujoco', source)
    assert len(changed_lines(source.text, found.text)) == 1
    read = again(source, found)
    assert read.mass == 1.5 and read.inertia == pytest.approx(vehicle.inertia, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize('to', TARGETS)
def test_every_form_of_every_effect_ends_in_one_class(to):
    source, vehicle = base(to)
    for effect, form in FORMS:
        if effect not in EFFECTS:
            continue
        values = {parameter.name: (parameter.null or 0.0) + 0.1 * parameter.scale(vehicle)
                  for parameter in form.parameters[:1 if effect == 'rotor_fault' else None]}
        effects = {**{name: value for name, value in vehicle.effects.items() if name != effect},
                   effect: values}
        fates = export(replace(vehicle, effects=effects), to, source).fates
        ends = [(fate.name, fate.form) for fate in (*fates.carried, *fates.by_code,
                                                    *fates.nearest, *fates.not_carried)]
        assert ends.count((effect, form.name)) == 1, (effect, form.name, fates)
        assert all(fate.reason for fate in (*fates.carried, *fates.nearest, *fates.not_carried))


def test_each_effect_has_a_way_or_a_reason_why_not():
    assert all(effect in NEEDS or (effect, form.name) in WAYS for effect, form in FORMS
               if effect in EFFECTS)


def test_an_effect_that_no_format_knows_is_said_by_its_title(monkeypatch):
    monkeypatch.delitem(NEEDS, 'gyro_bias')
    source, vehicle = base('gazebo')
    biased = replace(vehicle, effects={**vehicle.effects, 'gyro_bias': {'x': 0.02}})
    fates = export(biased, 'gazebo', source).fates
    reasons = {fate.name: fate.reason for fate in fates.not_carried}
    assert EFFECTS['gyro_bias'].title in reasons['gyro_bias']


def test_a_sag_is_its_mean_over_a_flight():
    source, vehicle = base('gazebo')
    wanted = replace(vehicle, effects={**vehicle.effects, 'battery_sag': {'per_second': 0.002}})
    assert [fate.name for fate in export(wanted, 'gazebo', source).fates.not_carried] == [
        'battery_sag']
    t = np.linspace(5.0, 65.0, 601)
    left = mean_left(wanted, [FlightRecord(t, {'z': 0.0 * t})])
    assert left == pytest.approx(1.0 - 0.002 * 30.0)
    found = export(wanted, 'gazebo', source, left)
    assert again(source, found).thrust_coefficient == pytest.approx(
        left * vehicle.thrust_coefficient, rel=1e-9)
    assert [fate.name for fate in found.fates.nearest] == ['battery_sag']
    by_voltage = replace(vehicle, effects={'battery_sag': {'per_volt': 0.05}})
    with pytest.raises(InputError, match='vbat'):
        mean_left(by_voltage, [FlightRecord(t, {'z': 0.0 * t})])


def test_what_other_bodies_weigh_is_not_undercut():
    source, vehicle = base('gazebo')
    with pytest.raises(InputError, match='other bodies weigh 0.04 kg') as error:
        export(replace(vehicle, mass=0.03), 'gazebo', source)
    assert str(error.value).startswith('model.sdf, line ')
    with pytest.raises(InputError, match='4 rotors, the vehicle has 3'):
        export(replace(vehicle, rotors=vehicle.rotors[:3]), 'gazebo', source)


def test_a_comment_between_numbers_is_not_written_over():
    source, vehicle = base('gazebo')
    text = source.text.replace('<pose>0.2 -0.25 0.06', '<pose>0.2 -0.25 <!-- m --> 0.06')
    moved = replace(vehicle, effects={**vehicle.effects, 'inertia_mismatch': {'arms_y': 1.1}})
    with pytest.raises(InputError, match='line 14: <pose>: a comment stands between its numbers'):
        export(moved, 'gazebo', replace(source, text=text))
    for other in (text.replace('<!-- m --> 0.06 0.0 0 0', '0.06 0.0 0 0 <!-- m -->'),
                  text.replace('0.2 -0.25 <!-- m -->', '<!-- m --> 0.2 -0.25')):
        assert export(moved, 'gazebo', replace(source, text=other)).text.count('<!-- m -->') == 1


def test_what_stands_in_an_included_file_stays_and_is_said(tmp_path):
    for name, text in (('frame', sdf.model(sdf.bodies(), name='frame')), ('quad', sdf.model(
            "<include merge='true'><uri>model://frame</uri></include>", sdf.motors()))):
        (tmp_path / name).mkdir()
        (tmp_path / name / 'model.sdf').write_text(text)
    path = tmp_path / 'quad' / 'model.sdf'
    source = Source(str(path), path.read_text())
    vehicle = read_vehicle(source).vehicle
    wanted = replace(vehicle, mass=1.1 * vehicle.mass, effects={
        **vehicle.effects, 'motor_lag': {'time_constant': 0.04}})
    found = export(wanted, 'gazebo', source)
    # The drag is stated at hover, which the vehicle with more mass has at a higher speed.
    assert {change.source for change in found.changes} == {
        'motor_lag', 'rotor_drag over the hover speeds'}
    (stays,) = found.fates.not_carried
    assert stays.name == 'mass' and 'frame' in stays.reason and 'gz sdf -p' in stays.reason
    read = again(source, found)
    assert (read.mass, read.effects['motor_lag']) == (vehicle.mass, {'time_constant': 0.04})


def test_the_command_says_what_it_does(tmp_path, capsys):
    source, vehicle = base('gazebo')
    model, ours, out = (tmp_path / name for name in ('model.sdf', 'v.yaml', 'real.sdf'))
    model.write_text(source.text, newline='')
    write_vehicle(ours, replace(vehicle, mass=2.2, uncertainty={'mass': 0.01}, effects={
        **vehicle.effects, 'gyro_bias': {'x': 0.01}}))
    call = ['export', str(ours), '--to', 'gazebo', '--base', str(model), '-o', str(out)]
    assert main(call) == 0
    said = capsys.readouterr().out
    assert '2.16' in said and '0.01' in said and 'the file has 5 bodies' in said
    assert 'not carried: bias of the gyroscope (gyro_bias), form constant: ' in said
    assert 'carried: lag of the motors (motor_lag)' in said
    assert main([*call, '--json', '-']) == 0
    data = json.loads(capsys.readouterr().out)
    assert data['changes'][0]['std'] == pytest.approx(0.01)
    assert data['changes'][0]['source'] == 'mass'
    assert [fate['name'] for fate in data['not_carried']] == ['gyro_bias']
    assert read_vehicle(Source('real.sdf', out.read_text())).vehicle.mass == pytest.approx(2.2)


@pytest.mark.parametrize(('change', 'said'), [
    ({'-o': 'model.sdf'}, 'would write over'), ({'-o': 'real.txt'}, 'ends in .sdf'),
    ({'-o': 'text/real.sdf'}, 'text is a file'), ({'--to': 'mujoco', '-o': 'a.xml'}, 'MJCF'),
    ({'--base': 'v.yaml'}, '--base v.yaml: this is a vehicle file; give an SDF model of Gazebo'),
    ({'--base': 'nothing.sdf'}, '--base nothing.sdf: there is no such file'),
    ({'V': 'model.sdf'}, 'expected a vehicle file'), ({'V': 'none.yaml'}, 'none.yaml')])
def test_bad_input_is_said_in_one_line(change, said, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    source, vehicle = base('gazebo')
    (tmp_path / 'model.sdf').write_text(source.text, newline='')
    write_vehicle(tmp_path / 'v.yaml', vehicle)
    (tmp_path / 'text').write_text('')
    given = {'V': 'v.yaml', '--to': 'gazebo', '--base': 'model.sdf', '-o': 'real.sdf', **change}
    words = ['export', given.pop('V')] + [word for pair in given.items() for word in pair]
    assert main(words) == 2
    message = capsys.readouterr().err.strip()
    assert said in message and '\n' not in message
    assert not (tmp_path / 'real.sdf').exists()
