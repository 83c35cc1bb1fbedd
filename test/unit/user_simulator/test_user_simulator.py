# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulators of users: flown as they are, and with effects around them."""

from dataclasses import replace
from pathlib import Path

from flying import usual
import numpy as np
import pytest

from quad_ident_ros.diagnose.gap import by_model, ends, gap
from quad_ident_ros.diagnose.residual_wrench import residual_wrench
from quad_ident_ros.effects.registry import EFFECTS, vector
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.greybox.flights import highest_voltage, track_of
from quad_ident_ros.greybox.parameters import nominal, SPLIT
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.user_simulator import simulator as processes
from quad_ident_ros.user_simulator.program import INTERFACE, Program
from quad_ident_ros.user_simulator.simulator import Simulator

FILE = Path(__file__).parents[2] / 'helpers' / 'plain_simulators.py'
BARE = load_vehicle('hummingbird')
LAGGED = replace(BARE, effects={'motor_lag': {'time_constant': 0.03}})
REALITY = {'rotor_drag': {'coefficient': 0.3}, 'motor_lag': {'time_constant': 0.05},
           'thrust_scale': {'factor': 0.95}}


@pytest.fixture(scope='module')
def record():
    """Fly a vehicle that has what no simulator here has."""
    return fly_closed_loop(BARE, REALITY, 'low_passes', duration=8.0, seed=1,
                           noise=SENSORS['mocap_imu'])


@pytest.fixture(scope='module')
def track(record):
    return track_of(record, BARE, highest_voltage([record]))


@pytest.fixture(scope='module')
def brief(record):
    """Return what a simulator that steps one vehicle at a time follows in a few seconds."""
    part = record.slice(200, 325)      # rows of 10 ms
    return track_of(part, BARE, highest_voltage([record]))


def simulator(name, vehicle=BARE):
    return Simulator(f'{FILE}:{name}', vehicle)


def with_effects(vehicle, effects):
    return np.concatenate([nominal(vehicle)[:SPLIT], vector(effects, vehicle)])


def apart(track, vehicle, z, flown):
    """Return {group: root mean square} of what a simulator predicts other than the model."""
    theirs, ours = ends(track, vehicle, z, 0.5, flown), ends(track, vehicle, z, 0.5)
    return gap([replace(theirs, errors=theirs.errors - ours.errors)]), gap([ours])


def change_by(track, vehicle, z):
    """Return {group: root mean square} of what effects change in our model."""
    return apart(track, vehicle, nominal(vehicle), lambda *args: by_model(
        args[0], vehicle, z, *args[3:]))[0]


@pytest.mark.slow
@pytest.mark.parametrize('name, vehicle', [
    ('Many', BARE), ('ManyLagged', LAGGED), ('One', BARE), ('OneLagged', LAGGED),
    ('OnePushed', BARE), ('ManyPushed', BARE)])
def test_a_simulator_of_the_nominal_vehicle_has_the_gap_of_our_model(brief, name, vehicle):
    with simulator(name, vehicle) as flown:
        off, ours = apart(brief, vehicle, nominal(vehicle), flown)
    for group, value in off.items():
        assert value < 1e-3 * ours[group]


# Without a drag no wind is felt.
ALONG = {'wind': {'rotor_drag': {'coefficient': 0.3}}}


@pytest.mark.slow
@pytest.mark.parametrize('name', ['Many', 'ManyPushed'])
@pytest.mark.parametrize('effect', EFFECTS)
def test_each_effect_around_a_simulator_does_what_it_does_in_our_model(track, effect, name):
    effects = {**ALONG.get(effect, {}), **usual(effect, BARE)}
    z = with_effects(BARE, effects)
    with simulator(name) as flown:
        off, _ = apart(track, BARE, z, flown)
    change = change_by(track, BARE, z)
    # Held over a step of 10 ms that turns by 0.02 rad, a force is right to some percent.
    for group, value in off.items():
        assert value < max(0.02 * change[group], 2e-5)
    assert max(change.values()) > 1e-4


@pytest.mark.slow
@pytest.mark.parametrize('motors, name', [
    ({'time_constant': 0.05}, 'OneLagged'), ({'time_constant': 0.05}, 'ManyLagged'),
    ({'rise': 0.02, 'fall': 0.05}, 'ManyLagged'), ({'time_constant': 0.02}, 'ManyLagged'),
    ({'slew': 1e-5, 'time_constant': 0.04}, 'ManyLagged'), ({}, 'ManyLagged'),
    ({'mean_lag': 0.03, 'inner_lag': 0.02}, 'ManyLagged')])
def test_motors_of_another_law_take_the_place_of_the_simulator_s(brief, motors, name):
    effects = {'motor_lag': motors, 'rotor_drag': {'coefficient': 0.2}}
    z = with_effects(LAGGED, effects)
    with simulator(name, LAGGED) as flown:
        off, _ = apart(brief, LAGGED, z, flown)
    change = change_by(brief, LAGGED, z)
    for group, value in off.items():
        assert value < 0.02 * change[group]


@pytest.mark.slow
def test_with_the_true_effects_around_it_noise_alone_is_left(track):
    truth = with_effects(BARE, REALITY)
    with simulator('ManyPushed') as flown:
        before, after = (gap([ends(track, BARE, z, 0.5, flown)])
                         for z in (nominal(BARE), truth))
    best = gap([ends(track, BARE, truth, 0.5)])
    for group in before:
        assert after[group] == pytest.approx(best[group], rel=0.02)
    assert after['velocity'] < 0.2 * before['velocity']


@pytest.mark.slow
def test_where_the_gap_lies_is_told_as_of_our_model(track):
    noise = np.repeat([1e-3, 1e-2, 2e-3, 1e-2], 3)
    ours = residual_wrench(track, BARE, nominal(BARE), noise)
    with simulator('Many') as flown:
        theirs = residual_wrench(track, BARE, nominal(BARE), noise, flown)
    assert np.max(np.abs(theirs.values - ours.values) / ours.errors) < 0.02
    assert (theirs.t == ours.t).all()


@pytest.mark.slow
def test_slow_records_are_flown_in_finer_steps():
    record = fly_closed_loop(BARE, REALITY, 'lissajous', duration=6.0, rate=50.0, seed=2)
    slow, z = track_of(record, BARE), with_effects(BARE, REALITY)
    with simulator('Many') as flown:
        off, ours = apart(slow, BARE, z, flown)
        before = gap([ends(slow, BARE, nominal(BARE), 0.5)])
    for group, value in off.items():
        assert value < 0.01 * before[group]


@pytest.mark.slow
def test_several_processes_fly_what_one_does(brief, monkeypatch):
    with simulator('One') as flown:
        alone = ends(brief, BARE, with_effects(BARE, REALITY), 0.1, flown)
    monkeypatch.setattr(processes, 'WORTH', 0.0)
    monkeypatch.setattr(processes.os, 'sched_getaffinity', lambda _: {0, 1})
    with simulator('One') as flown:
        together = ends(brief, BARE, with_effects(BARE, REALITY), 0.1, flown)
    np.testing.assert_array_equal(together.errors, alone.errors)


def test_the_interface_that_the_help_shows_is_python():
    namespace = {}
    exec(INTERFACE.replace('...            #', 'pass  #'), namespace)
    assert {'reset', 'step'} <= set(vars(namespace['Name']))


BEGIN = 'import numpy as np\nclass Sim:\n    def reset(self, state):\n        self.x = state\n'


@pytest.mark.parametrize('text, said', [
    ('x = (1\n', 'line 1: reading it of Sim raises SyntaxError'),
    ('\nimport no_such_library\n', 'line 2: reading it of Sim raises ModuleNotFoundError: No '
     "module named 'no_such_library'"),
    ('import sys\nsys.exit(3)\n', 'line 2: reading it of Sim raises SystemExit: 3'),
    ('class Other:\n    pass\n', 'it has no class Sim'),
    ('Sim = 3\n', 'it has no class Sim'),
    ('class Sim:\n    def __init__(self, path):\n        pass\n', 'making it of Sim raises '
     'TypeError'),
    ('\nclass Sim:\n    def reset(self, state):\n        pass\n', 'line 2: Sim has no method '
     'step; it needs reset(state) and step(commands, dt)'),
    (BEGIN + '    def step(self, commands, dt):\n        return self.y\n',
     "line 6: step of Sim raises AttributeError: 'Sim' object has no attribute 'y'"),
    (BEGIN + '    def step(self, commands, dt):\n        return self.x[:12]\n',
     'line 5: step of Sim returns an array of shape (12,); expected (13,) or (17,): px py'),
    (BEGIN + '    def step(self, commands, dt):\n        return self.x[None]\n',
     'returns an array of shape (1, 17); expected (13,) or (17,)'),
    (BEGIN + '    def step(self, commands, dt):\n        return "here"\n',
     'returns str; expected an array of'),
    (BEGIN + '    def step(self, commands, dt):\n        return self.x * np.inf\n',
     'returns px = nan after a step from px 0 py 0 pz 1'),
    (BEGIN + '    def step(self, commands, dt):\n        return self.x * 2.0\n',
     'returns a quaternion qw qx qy qz of length 2; expected 1'),
    ('class Sim:\n    def step_many(self, states, commands, dt):\n        return states[0]\n',
     'returns an array of shape (17,); expected (1, 13) or (1, 17)'),
    (BEGIN + '    def step(self, commands):\n        return self.x\n', 'raises TypeError'),
    (BEGIN + '    def step(self, commands, dt):\n        return self.x * 1j\n',
     'returns complex numbers; expected an array of'),
    (BEGIN + '    @property\n    def step(self):\n        raise OSError("no")\n',
     'line 7: step of Sim raises OSError: no'),
    ('def __getattr__(name):\n    raise OSError(name)\n',
     'line 2: reading it of Sim raises OSError'),
])
def test_what_is_wrong_with_a_simulator_is_one_line_with_its_place(tmp_path, text, said):
    path = tmp_path / 'mine.py'
    path.write_text(text)
    with np.errstate(invalid='ignore'), pytest.raises(InputError) as error:
        Simulator(f'{path}:Sim', BARE)
    message = str(error.value)
    assert message.startswith(str(path)) and said in message and '\n' not in message
    assert len(message) < 500


def test_what_a_simulator_prints_does_not_get_into_the_data(tmp_path, capsys):
    path = tmp_path / 'mine.py'
    path.write_text('print("read")\n' + BEGIN + '    def step(self, commands, dt):\n'
                    '        print("stepped")\n        return self.x\n')
    Simulator(f'{path}:Sim', BARE)
    printed = capsys.readouterr()
    assert printed.out == '' and {'read', 'stepped'} <= set(printed.err.split())


@pytest.mark.parametrize('spec, said', [
    ('mine.py', '--simulator mine.py: expected FILE.py:NAME'),
    ('mine.txt:Sim', 'expected FILE.py:NAME'),
    ('mine.py:a b', 'expected FILE.py:NAME'),
    ('none.py:Sim', 'none.py: there is no such file'),
    ('~nosuch/none.py:Sim', '~nosuch/none.py: there is no such file')])
def test_a_simulator_is_a_class_in_a_file(spec, said):
    with pytest.raises(InputError, match=said):
        Program(spec)


def test_a_simulator_may_import_what_stands_beside_it(tmp_path):
    (tmp_path / 'beside_it.py').write_text('from plain_simulators import Many\n')
    (tmp_path / 'plain_simulators.py').write_text(FILE.read_text())
    (tmp_path / 'mine.py').write_text('from beside_it import Many\nclass Sim(Many):\n    pass\n')
    Simulator(f'{tmp_path}/mine.py:Sim', BARE)
