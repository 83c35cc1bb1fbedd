# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The made fleet: what its truth is, that no log has a word of it, and how it is scored."""

import hashlib

import numpy as np
import pytest

from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import load_vehicle
from withheld.fleet.make import make, NOMINAL, spoilt, write_log
from withheld.fleet.score import numbers_of, passed, score
from withheld.fleet.truth import CHANGES, KINDS, LASTING, Truth, truth_of

WORDS = ('rotor_drag', 'motor_lag', 'com_offset', 'thrust_scale', 'seed', 'effects', 'spoilt')


@pytest.fixture(scope='module')
def truth():
    return truth_of(20, 30, np.random.default_rng(1))


def test_the_fleet_is_as_large_as_promised(truth):
    """600 flights of 20 vehicles: three changes, a drift, two odd ones, one wrong log in 20."""
    assert len(truth.flights) == 600 and len({one.vehicle for one in truth.flights}) == 20
    assert len(truth.changes) == 3 and len(truth.drifts) == 1 and len(truth.odd) == 2
    assert len({*truth.changes, *truth.drifts, *truth.odd}) == 6
    assert sum(bool(one.spoilt) for one in truth.flights) == 30
    assert truth.as_data() == truth_of(20, 30, np.random.default_rng(1)).as_data()
    assert truth.as_data() != truth_of(20, 30, np.random.default_rng(2)).as_data()


def test_a_change_is_in_the_flights_from_its_number_on(truth):
    """The mean of a parameter steps there, by what the truth says, and the others do not."""
    for vehicle, (effect, parameter, step, at) in truth.changes.items():
        mine = [one for one in truth.flights if one.vehicle == vehicle]
        air = np.array([1.0 - (one.temperature - 15.0) / 288.0 for one in mine])
        values = np.array([one.effects[effect][parameter] for one in mine])
        if effect == 'thrust_scale':
            values = values / air
        assert LASTING <= at < 30 - LASTING
        assert values[at:].mean() - values[:at].mean() == pytest.approx(step, rel=0.2)
    assert set(CHANGES) == {effect for effect, *_ in truth.changes.values()}


def test_too_small_a_fleet_is_refused():
    """Three changes in two vehicles are no fleet."""
    with pytest.raises(ValueError, match='vehicles and'):
        truth_of(5, 30, np.random.default_rng(1))


def test_logs_are_read_and_say_nothing_of_the_truth(truth, tmp_path):
    """A log, the manifest and the vehicle file have no word of what is to be found."""
    one = next(each for each in truth.flights if not each.spoilt)
    make(Truth((one,), {}, {}, {}), tmp_path)
    files = [path for path in tmp_path.rglob('*') if path.is_file()]
    assert len(files) == 3
    for path in files:
        text = path.read_text(encoding='utf-8')
        assert not [word for word in WORDS if word in text], path
    log = tmp_path / one.vehicle / f'flight_{one.number:02d}.csv'
    assert read_csv(log).t[-1] == pytest.approx(10.0)
    assert numbers_of(tmp_path) == {hashlib.sha256(log.read_bytes()).hexdigest():
                                    (one.vehicle, one.number)}


@pytest.mark.parametrize('kind', KINDS)
def test_a_wrong_log_differs_from_the_flight(truth, tmp_path, kind):
    """Each kind of wrong log differs from what was flown, or cannot be read."""
    first = truth.flights[0]
    right, wrong = tmp_path / 'right.csv', tmp_path / 'wrong.csv'
    write_log(right, type(first)(**{**vars(first), 'spoilt': ''}), load_vehicle(NOMINAL))
    write_log(wrong, type(first)(**{**vars(first), 'spoilt': kind}), load_vehicle(NOMINAL))
    record = read_csv(right)
    if kind == 'rubbish':
        with pytest.raises(InputError):
            read_csv(wrong)
        return
    other = read_csv(wrong)
    assert len(other.t) < len(record.t) or any(
        not np.allclose(other.columns[name], values) for name, values in record.columns.items())
    assert spoilt(record, '').columns.keys() == record.columns.keys()


def event(vehicle, flight, effect, kind='change', probability=0.99):
    change = {'per_week': -0.004, 'std': 0.0003} if kind == 'drift' else {'size': 1.0}
    return {'vehicle': vehicle, 'flight': flight, 'kind': kind, 'probability': probability,
            'parts': [{'effect': effect, 'parameter': 'x', 'change': change}]}


def odd(vehicle, effect):
    return {'effect': effect, 'parameter': 'y', 'sister': {'vehicle': vehicle}}


TRUTH = {'changes': {'a': ['com_offset', 'x', 4e-3, 12]}, 'seed': 1, 'flights': 60,
         'drifts': {'b': ['thrust_scale', 'factor', -0.004]},
         'odd': {'c': ['motor_lag', 'time_constant', 0.02]},
         'spoilt': {'a/03': 'cut', 'b/04': 'late'}}
NUMBERS = {f'{vehicle}{number}': (vehicle, number) for vehicle in 'abcd' for number in range(30)}
RIGHT = {'vehicles': list('abcd'), 'refused': [['a', 'flight_03.csv', 'too short']],
         'suspect': [['b', 'flight_04.csv', 'off'], ['b', 'flight_05.csv', 'off']],
         'events': [event('a', 'a13', 'com_offset'), event('b', 'b0', 'mass_offset', 'drift')],
         'odd': [odd('c', 'motor_lag'), odd('a', 'com_offset')]}


def test_an_insight_that_is_right_passes():
    """A change one flight late, a drift by its ratio, an odd vehicle, a wrong log refused."""
    result = score(TRUTH, RIGHT, NUMBERS)
    assert passed(result)
    assert result['logs'] == {'wrong': 2, 'refused': 1, 'suspect': 1, 'unnoticed': {},
                              'right_refused': 0, 'right_suspect': 1}


@pytest.mark.parametrize('wrong', [
    {'events': RIGHT['events'][1:]}, {'events': RIGHT['events'][:1]}, {'odd': []},
    {'events': [event('a', 'a16', 'com_offset'), RIGHT['events'][1]]},
    {'events': [event('a', 'a13', 'rotor_drag'), RIGHT['events'][1]]},
    {'events': [*RIGHT['events'], event('d', 'd5', 'com_offset')]},
    {'events': [*RIGHT['events'], event('a', 'a25', 'com_offset')]},
    {'odd': [*RIGHT['odd'], odd('d', 'com_offset')]}])
def test_an_insight_that_misses_or_invents_does_not_pass(wrong):
    """What is missed, dated three flights off, of another effect, or false does not pass."""
    assert not passed(score(TRUTH, RIGHT | wrong, NUMBERS))
