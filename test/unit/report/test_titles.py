# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where a person reads about an effect, its title stands before its name."""

from dataclasses import replace
import io
import re
from types import SimpleNamespace

from fleets import series, START
import numpy as np
from published import diagnosis
import pytest

from quad_ident_ros.cli import fly
from quad_ident_ros.cli.main import main
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.effects.registry import EFFECTS, titled
from quad_ident_ros.errors import InputError
from quad_ident_ros.greybox.cautions import cautions
from quad_ident_ros.greybox.fit import Parameter
from quad_ident_ros.greybox.free import columns_of_names
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.report.diagnosis import caution_lines
from quad_ident_ros.report.export import source_of
from quad_ident_ros.report.fit_table import fit_table
from quad_ident_ros.report.screen import console
from quad_ident_ros.vehicle_files.export import mean_left

VEHICLE = load_vehicle('hummingbird')
NAMES = re.compile('|'.join(rf'\b{name}\b' for name in EFFECTS if '_' in name))


def bare(text):
    """Return the names of effects in a text that do not stand behind their title."""
    text = ' '.join(text.split())
    return [one[0] for one in NAMES.finditer(text)
            if not text[:one.start()].endswith(f'{EFFECTS[one[0]].title} (')]


def printed(content):
    """Return what a console prints."""
    stream = io.StringIO()
    console(stream).print(content)
    return stream.getvalue()


def test_a_parameter_has_the_title_of_its_effect_and_anything_else_none():
    assert titled('motor_lag') == 'lag of the motors (motor_lag)'
    assert titled('motor_lag.rise') == 'lag of the motors (motor_lag.rise)'
    assert titled('inertia_x') == 'inertia_x' and titled('of_a_later_version.x') == (
        'of_a_later_version.x')
    assert bare('rotor_drag and lag of the motors (motor_lag)') == ['rotor_drag']


def test_a_fit():
    still = [('a.csv', [Finding('excitation', 'info', 'yaw', '', '')])]
    said = cautions(still, ['inertia_mismatch.factor_z'])
    with pytest.raises(InputError) as error:
        columns_of_names(['mass', 'mass_offset'], VEHICLE)
    table = printed(fit_table(SimpleNamespace(parameters=[
        Parameter('motor_lag.time_constant', 's', 0.0, 0.0301, 0.0004, 'determined', {}),
        Parameter('rotor_drag.coefficient', 'kg/s', 0.0, None, None, 'undetermined',
                  {'body_drag.horizontal': 0.1})])))
    assert said and not bare(' '.join(said)) and not bare(str(error.value))
    assert 'lag of the motors (motor_lag.time_constant)' in table and '0.03010 ± 0.00040' in table
    assert 'drag of the rotors (rotor_drag.coefficient)' in table
    assert 'undetermined; this if body_drag.horizontal is 0.1' in table


def test_what_the_simulator_node_flies():
    pytest.importorskip('rclpy', reason='ROS 2 is not here')
    from quad_ident_ros.nodes.simulator import HELP
    assert all(f'  {effect.name}: {effect.title}\n' in HELP for effect in EFFECTS.values())


def test_what_fit_can_free(capsys):
    with pytest.raises(SystemExit):
        main(['fit', '--help'])
    said = ' '.join(capsys.readouterr().out.split())
    assert all(titled(name) in said for name in EFFECTS)


def test_warnings_of_a_diagnosis():
    found = diagnosis(findings=(
        {'flight': 'all flights', 'code': 'at_bound', 'severity': 'warning',
         'where': 'inertia_mismatch', 'message': 'factor_x 5 is the bound',
         'remedy': 'log faster'},))
    assert caution_lines(found) == ['warning: all flights: error in inertia (inertia_mismatch): '
                                    'factor_x 5 is the bound; log faster']


def test_an_export(tmp_path, capsys):
    assert source_of('mass, mass_offset') == 'mass, error in mass (mass_offset)'
    assert source_of('rotor_drag over the hover speeds') == (
        'drag of the rotors (rotor_drag) over the hover speeds')
    vehicle = replace(VEHICLE, effects={'motor_lag': {'time_constant': 0.03},
                                        'mass_offset': {'mass': 0.05},
                                        'rotor_drag': {'coefficient': 0.2}})
    file, written = tmp_path / 'v.yaml', tmp_path / 'q.sdf'
    write_vehicle(file, replace(vehicle, effects={}))
    assert main(['export', str(file), '--to', 'gazebo', '-o', str(written)]) == 0
    write_vehicle(file, vehicle)
    capsys.readouterr()
    assert main(['export', str(file), '--to', 'gazebo', '--base', str(written), '-o',
                 str(tmp_path / 'r.sdf')]) == 0
    said = capsys.readouterr().out
    assert 'error in mass (mass_offset)' in said and not bare(said)


def test_a_sag_that_flights_do_not_show():
    record = FlightRecord(np.linspace(0.0, 60.0, 61), {'pz': np.zeros(61)})
    with pytest.raises(InputError, match='depends on the voltage') as error:
        mean_left(replace(VEHICLE, effects={'battery_sag': {'per_volt': 0.05}}), [record])
    assert 'battery_sag' in str(error.value) and not bare(str(error.value))


def test_a_flight_that_is_flown(tmp_path, capsys, monkeypatch):
    still = FlightRecord(np.linspace(0.0, 5.0, 6), {name: np.zeros(6) for name in (
        'px', 'py', 'pz', 'vx', 'vy', 'vz')})
    monkeypatch.setattr(fly, 'fly_closed_loop', lambda *_, **__: still)
    monkeypatch.setattr(fly, 'with_asked', lambda record, _: record)
    assert main(['fly', 'hover', '--vehicle', 'hummingbird', '--duration', '5', '--effect',
                 'rotor_drag:coefficient=0.1', '-o', str(tmp_path / 'a.csv')]) == 0
    said = capsys.readouterr().out
    assert '  effects: drag of the rotors (rotor_drag) coefficient = 0.1' in said


def test_a_picture_of_a_fleet_in_words():
    pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
    from quad_ident_ros.fleet.history import histories
    from quad_ident_ros.report.fleet_charts import small_multiple
    one, = histories([series(3.0 + np.zeros(5), 0.1, effect='rotor_drag',
                             parameter='coefficient', unit='kg/s')])
    label = re.search('aria-label="([^"]*)"', small_multiple(one, 'kg/s', 1.0))[1]
    assert 'drag of the rotors (rotor_drag) coefficient in kg/s' in label and not bare(label)


def test_what_happened_to_a_vehicle_of_a_fleet():
    pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
    from quad_ident_ros.fleet.events import Event, Part
    from quad_ident_ros.fleet.history import Change
    from quad_ident_ros.report.fleet_words import event_line
    change = Change(3, 3, 3, 0.99, 0.01, 0.1, 0.01)
    parts = tuple(Part(*of, change, 0.2) for of in (('rotor_drag', 'coefficient', 'kg/s'),
                                                    ('com_offset', 'x', 'm')))
    line = event_line(Event('uav1', '', 'change', 'f', 'f.csv', 4, 9, START, None, parts, 0.99,
                            True))
    assert 'with offset of the centre of mass (com_offset) x +' in line and not bare(line)
