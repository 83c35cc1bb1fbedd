# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The excitations, each by its definition."""

from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.excitation import EXCITATIONS, excite

FAST = settings(deadline=None, max_examples=60)
PERIOD = 0.01
T = np.arange(1001) * PERIOD    # 0 to 10 s


def signal(kind, t=T, **parameters):
    return excite('U2', {'type': kind, **parameters}, t)


def at(values, time):
    return values[round(time / PERIOD)]


def refused(kind, **parameters):
    """Return the message with which an excitation is refused: one line that says where."""
    with pytest.raises(InputError) as error:
        signal(kind, **parameters)
    message = str(error.value)
    assert message.startswith('U2: ') and '\n' not in message and len(message) < 200
    return message


@pytest.mark.parametrize('kind', sorted(set(EXCITATIONS) - {'recorded'}))
@pytest.mark.parametrize('t', [T, T + 0.0, T[:2], np.arange(50) * 0.07], ids=len)
def test_one_finite_value_per_sample(kind, t):
    values = signal(kind, t)
    assert values.shape == t.shape and values.dtype == float
    assert np.isfinite(values).all()
    assert np.abs(values).max() <= 1.0


@pytest.mark.parametrize('kind', sorted(set(EXCITATIONS) - {'recorded'}))
def test_amplitude_scales(kind):
    assert np.allclose(signal(kind, amplitude=-0.25), -0.25 * signal(kind), atol=1e-15)


def test_step_begins_at_its_sample_and_holds():
    values = signal('step', amplitude=0.3, time=2.0)
    assert not values[T < 2.0 - 1e-9].any()
    assert (values[T >= 2.0 - 1e-9] == 0.3).all()
    assert (signal('step', amplitude=-2) == -2).all()


@FAST
@given(st.integers(0, 1000), st.floats(1e-4, 0.5))
def test_step_at_a_sample_time_begins_there_whatever_the_rounding(k, period):
    t = np.arange(1001) * period
    values = signal('step', t, time=k * period)
    assert np.flatnonzero(values)[0] == k


def test_steps_of_a_list_each_hold_until_the_next():
    values = signal('step', amplitude=[0.1, -0.2, 0.0], time=[1.0, 2.5, 4.0])
    for time, level in ((0.99, 0.0), (1.0, 0.1), (2.49, 0.1), (2.5, -0.2), (3.99, -0.2),
                        (4.0, 0.0), (10.0, 0.0)):
        assert at(values, time) == level, time


def test_step_between_samples_acts_at_the_next_one():
    assert np.flatnonzero(signal('step', time=1.003))[0] == 101


def test_doublet_is_two_pulses():
    values = signal('doublet', amplitude=0.5, time=1.0, width=0.25)
    for time, level in ((0.99, 0.0), (1.0, 0.5), (1.24, 0.5), (1.25, -0.5), (1.49, -0.5),
                        (1.5, 0.0), (10.0, 0.0)):
        assert at(values, time) == level, time


@FAST
@given(st.floats(0.01, 2.0), st.floats(0.0, 4.0))
def test_doublet_has_no_area(width, time):
    # Also where width is no whole number of samples: the two pulses last equally long.
    values = signal('doublet', width=width, time=time)
    up, down = np.count_nonzero(values > 0), np.count_nonzero(values < 0)
    assert up == down
    assert abs(up * PERIOD - width) <= PERIOD / 2 + 1e-9
    assert abs(values.sum()) < 1e-12


@pytest.mark.parametrize('order', [2, 3, 7, 9])
def test_prbs_is_two_valued_with_its_clock_and_period(order):
    clock = 0.05
    t = np.arange(round(3 * (2 ** order - 1) * clock / PERIOD)) * PERIOD
    values = signal('prbs', t, amplitude=0.2, clock=clock, order=order, seed=3)
    assert set(values) == {0.2, -0.2}
    # It changes at multiples of the clock only, and repeats after 2^order - 1 of them and not
    # before.
    held = values.reshape(-1, 5)
    assert (held == held[:, :1]).all()
    bits = held[:, 0]
    period = 2 ** order - 1
    assert (bits[:-period] == bits[period:]).all()
    assert not any((bits[:period] == np.roll(bits[:period], k)).all() for k in range(1, period))


def test_prbs_spectrum_is_white():
    # The lines of a maximum-length sequence of L clocks are all of one size but the one at zero:
    # its circular autocorrelation is -1 at every lag but 0.
    bits = signal('prbs', np.arange(511) * 0.1, clock=0.1, order=9)
    power = np.abs(np.fft.fft(bits)) ** 2
    assert power[0] == pytest.approx(1.0)
    assert np.allclose(power[1:], 512.0)
    # Balanced but for one.
    assert abs(bits.sum()) == 1


def test_prbs_seed_chooses_where_it_begins():
    t = np.arange(511) * 0.1
    one, same, other = (signal('prbs', t, seed=seed) for seed in (1, 1, 2))
    assert (one == same).all() and (one != other).any()
    assert any((np.roll(one, k) == other).all() for k in range(511))
    # Any seed is a valid state of the register, the largest too.
    assert set(signal('prbs', t, seed=10 ** 12)) == {1.0, -1.0}


def test_multisine_has_its_amplitude_and_only_its_frequencies():
    # low x high = 1 Hz .. 8 Hz by factors of 2: whole periods in 4 s, so that the lines are sharp.
    t = np.arange(400) * PERIOD
    values = signal('multisine', t, amplitude=0.7, low=1.0, high=8.0, count=4)
    assert np.abs(values).max() == pytest.approx(0.7)
    lines = np.abs(np.fft.rfft(values))
    frequency = np.fft.rfftfreq(len(t), PERIOD)
    chosen = np.isin(frequency.round(9), [1.0, 2.0, 4.0, 8.0])
    assert chosen.sum() == 4
    assert lines[~chosen].max() < 1e-9 * lines.max()
    assert np.allclose(lines[chosen], lines.max())


def test_multisine_phases_keep_the_crest_low():
    # Schroeder's phases are for evenly spaced tones; spaced logarithmically they still do better
    # than tones that all begin at a crest, whose peak is their sum.
    values = signal('multisine', np.arange(10_000) * PERIOD, low=0.1, high=5.0, count=10)
    assert np.abs(values).max() / np.sqrt(np.mean(values ** 2)) < np.sqrt(2 * 10) * 0.85


def test_chirp_sweeps_from_low_to_high():
    t = np.arange(20_001) * 1e-3
    values = signal('chirp', t, amplitude=2.0, low=0.5, high=20.0)
    assert values[0] == pytest.approx(0.0, abs=1e-12)
    assert np.abs(values).max() == pytest.approx(2.0, rel=1e-3)
    # Between zero crossings lies half a period: its frequency follows the logarithmic sweep.
    k = np.flatnonzero(np.diff(np.signbit(values)))
    crossing = t[k] - values[k] * 1e-3 / (values[k + 1] - values[k])
    middle = (crossing[1:] + crossing[:-1]) / 2
    expected = 0.5 * 40.0 ** (middle / t[-1])
    assert np.allclose(0.5 / np.diff(crossing), expected, rtol=0.05)
    assert expected[0] < 0.7 and expected[-1] > 19.0


def test_chirp_can_sweep_down():
    t = np.arange(20_001) * 1e-3
    crossings = np.flatnonzero(np.diff(np.signbit(signal('chirp', t, low=20.0, high=0.5))))
    assert np.diff(crossings)[-1] > 10 * np.diff(crossings)[0]


@pytest.mark.parametrize('name', ['flight.csv', 'flight.csv.gz'])
def test_recorded_plays_a_csv_back(tmp_path, name):
    values = np.random.default_rng(0).normal(size=len(T))
    write_csv(tmp_path / name, FlightRecord(T + 17.3, {'u2': values, 'phi': 0 * T}))
    found = signal('recorded', file=str(tmp_path / name), column='u2', trim=0.5)
    assert (found == values - 0.5).all()


def test_recorded_is_held_at_another_rate_and_after_its_end(tmp_path):
    write_csv(tmp_path / 'slow.csv', FlightRecord([5.0, 5.5, 7.0], {'u1': [1.0, 2.0, 3.0]}))
    values = signal('recorded', file=str(tmp_path / 'slow.csv'), column='u1')
    for time, level in ((0.0, 1.0), (0.49, 1.0), (0.5, 2.0), (1.99, 2.0), (2.0, 3.0), (10.0, 3.0)):
        assert at(values, time) == level, time


@pytest.mark.parametrize('content', ['root:secret:0\n', 't,secret\n0,secret\n', ''])
def test_recorded_shows_nothing_of_a_file_that_is_no_record(tmp_path, content):
    path = tmp_path / 'shadow'
    path.write_text(content)
    for file in (path, tmp_path, '/dev/zero'):
        message = refused('recorded', file=str(file), column='u2')
        assert 'is not a flight record that can be read' in message and 'secret' not in message


@pytest.mark.parametrize(('kind', 'parameters', 'words'), [
    ('step', {'amplitude': 'big'}, "amplitude[0]: expected a number, got 'big'"),
    ('step', {'amplitude': float('nan')}, 'finite'),
    ('step', {'amplitude': True}, 'expected a number'),
    ('step', {'amplitude': [1.0, 2.0]}, 'amplitude has 2 entries and time 1'),
    ('step', {'amplitude': [], 'time': []}, 'amplitude has 0 entries'),
    ('step', {'amplitude': [1, 2], 'time': [2.0, 2.0]}, 'must increase'),
    ('step', {'amplitude': {}}, 'expected a number'),
    ('step', {'amplitud': 1}, "did you mean 'amplitude'?"),
    ('doublet', {'width': 0}, 'width: 0 is out of range, expected > 0'),
    ('doublet', {'width': 0.001}, 'width: 0.001 s is shorter than the sample period, 0.01 s'),
    ('doublet', {'time': None}, 'time: expected a number'),
    ('prbs', {'order': 1}, 'order: expected a whole number of at least 2'),
    ('prbs', {'order': 21}, 'expected 2 to 20'),
    ('prbs', {'order': 9.0}, 'whole number'),
    ('prbs', {'seed': -1}, 'seed: expected a whole number of at least 0'),
    ('prbs', {'clock': 0.001}, 'clock: 0.001 s is shorter than the sample period, 0.01 s'),
    ('multisine', {'low': 5.0, 'high': 1.0}, 'high: 1 is out of range, expected >= 5'),
    ('multisine', {'high': 50.0}, 'high: 50 Hz is not below half the sample rate, 50 Hz'),
    ('multisine', {'count': 0}, 'count'), ('multisine', {'count': 10 ** 9}, 'expected 1 to 200'),
    ('chirp', {'high': 60.0}, '60 Hz is not below half the sample rate, 50 Hz'),
    ('chirp', {'low': 0.0}, 'low: 0 is out of range, expected > 0'),
    ('recorded', {'column': 'u2'}, "'file' is missing"),
    ('recorded', {'file': '/no/such.csv', 'column': 'u2'}, 'there is no such file'),
    ('recorded', {'file': 7, 'column': 'u2'}, 'file: expected text, got 7'),
    ('recorded', {'file': ['a'], 'column': 'u2'}, 'file: expected text'),
], ids=str)
def test_bad_parameters_are_refused_with_the_reason(kind, parameters, words):
    message = refused(kind, **parameters)
    assert kind in message and words in message


def test_recorded_names_a_column_that_is_missing(tmp_path):
    write_csv(tmp_path / 'f.csv', FlightRecord([0.0, 1.0], {'u1': [1.0, 2.0]}))
    assert 'has no column u2' in refused('recorded', file=str(tmp_path / 'f.csv'), column='u2')
    assert 'column: expected text' in refused('recorded', file=str(tmp_path / 'f.csv'),
                                              column={})


@pytest.mark.parametrize('spec', [None, 3, 'step', [], {}, {'amplitude': 1.0}])
def test_a_specification_must_be_a_mapping_with_a_type(spec):
    with pytest.raises(InputError, match=r'^U2: expected \{type: NAME'):
        excite('U2', spec, T)


@pytest.mark.parametrize('kind', ['stairs', None, 1, ['step'], True])
def test_an_unknown_type_is_refused_with_those_known(kind):
    with pytest.raises(InputError, match='is not one of step, doublet, prbs'):
        excite('U2', {'type': kind}, T)


anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5)
    | st.integers(10 ** 300, 10 ** 400),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=3), inner,
                                                                max_size=2), max_leaves=4)


@pytest.mark.slow
@settings(deadline=None, max_examples=300)
@given(st.sampled_from(sorted(EXCITATIONS)), st.dictionaries(
    st.sampled_from(['amplitude', 'time', 'width', 'clock', 'order', 'seed', 'low', 'high',
                     'count', 'file', 'column', 'trim']), anything, max_size=4))
def test_any_parameters_give_a_signal_or_an_input_error(kind, parameters):
    with np.errstate(over='ignore'):    # an amplitude of 1e308, say
        try:
            values = signal(kind, **parameters)
        except InputError as error:
            assert '\n' not in str(error) and len(str(error)) < 300
        else:
            assert values.shape == T.shape
