# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""From a record to what is identified: trim, start, grid, gaps, and which outputs are excited."""

import numpy as np
import pytest

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.signals import INPUT_OF, OUTPUTS, signals
from quad_ident_ros.identify.transfer import response, SecondOrder
from quad_ident_ros.model.attitude import quaternion_from_euler

PERIOD = 0.01
HOVER = (6.3739, 0.0, 0.0, 0.0)
TRUTH = SecondOrder.from_poles(3.5, 2.0, 0.5)


def record(t=None, steps=(1.0, 0.1, 0.2, 0.3), info=None, trim=HOVER, **columns):
    """Return a record in which U1..U4 step by so much over hover at 1 s."""
    t = np.arange(501) * PERIOD if t is None else t
    late = t - t[0] >= 1.0 - 1e-9
    data = {f'u{i + 1}': trim[i] + steps[i] * late for i in range(4)}
    # Smooth motions that differ from output to output; altitude about 10 m.
    motion = np.where(late, (t - t[0] - 1.0) ** 2, 0.0)
    data.update(phi=0.1 * motion, theta=0.2 * motion, psi=0.3 * motion, pz=10.0 + motion)
    data.update(columns)
    return FlightRecord(t, data, {'trim': list(trim), 'starts_at_rest': True} if info is None
                        else info)


def of(found, name):
    return {signal.output: signal for signal in found}[name]


def test_each_output_goes_with_its_input():
    found, remarks = signals(record())
    assert [signal.output for signal in found] == list(OUTPUTS) and remarks == []
    for signal, size in zip(found, (0.1, 0.2, 0.3, 1.0), strict=True):
        assert signal.u[0] == 0 and signal.u[-1] == pytest.approx(size)
        assert signal.y[0] == 0 and signal.y[-1] == pytest.approx(size * 16.0)
        assert signal.period == pytest.approx(PERIOD) and signal.t[0] == 0.0
        assert len(signal.t) == len(signal.u) == len(signal.y) == 501
    assert INPUT_OF == {'phi': 'U2', 'theta': 'U3', 'psi': 'U4', 'z': 'U1'}


def test_outputs_whose_input_is_at_trim_are_left_out():
    found, _ = signals(record(steps=(0.0, 0.1, 0.0, 1e-12)))
    assert [signal.output for signal in found] == ['phi']


def test_an_input_that_moves_only_at_the_last_sample_excites_nothing():
    u = np.zeros(501)
    u[-1] = 5.0
    assert signals(record(steps=(0, 0, 0, 0), u2=u))[0] == []


def test_outputs_asked_for_or_recorded_are_the_only_ones():
    assert [s.output for s in signals(record(), outputs=('z', 'phi'))[0]] == ['phi', 'z']
    flight = record(info={'trim': list(HOVER), 'outputs': ['psi'], 'starts_at_rest': True})
    assert [s.output for s in signals(flight)[0]] == ['psi']


def test_nothing_excited_is_an_error_that_says_what_to_do():
    with pytest.raises(InputError, match='nothing to identify: excite U1..U4, or state the trim'):
        identify([record(steps=(0, 0, 0, 0))])


def test_inputs_count_from_the_trim_of_the_record_or_the_one_stated():
    flight = record()
    assert of(signals(flight)[0], 'z').u[0] == 0.0
    stated, remarks = signals(flight, trim=(5.0, 0.0, 0.0, 0.0))
    assert of(stated, 'z').u[0] == pytest.approx(HOVER[0] - 5.0) and remarks == []


def test_a_missing_trim_is_the_first_sample_and_a_remark():
    little = np.linspace(0.0, 1e-3, 501)    # of tilt, which would take a part of U1 (test_change)
    found, remarks = signals(record(info={}, phi=little, theta=little))
    assert of(found, 'z').u[0] == 0.0 and of(found, 'z').u[-1] == pytest.approx(1.0)
    assert len(remarks) == 1 and 'no trim' in remarks[0] and 'first sample' in remarks[0]
    # The remark goes on into the result.
    result = identify([record(info={}, steps=(0, 0.1, 0, 0))], Settings(methods=('ls',)))
    assert any('no trim' in remark for remark in result.remarks)


def test_outputs_count_from_the_known_start_at_rest_and_else_from_the_first_sample():
    noisy = record().columns['pz'] + 0.5
    known = record(pz=noisy, info={'trim': list(HOVER), 'starts_at_rest': True,
                                   'initial': {'z': 10.0}})
    assert of(signals(known)[0], 'z').y[0] == pytest.approx(0.5)
    assert of(signals(known, initial_state='free')[0], 'z').y[0] == 0.0
    unknown = record(pz=noisy)
    assert of(signals(unknown)[0], 'z').y[0] == 0.0


def test_rest_is_assumed_where_the_record_or_the_caller_says_so():
    flight, silent = record(), record(info={'trim': list(HOVER)})
    assert all(s.at_rest for s in signals(flight)[0])
    assert not any(s.at_rest for s in signals(silent)[0])
    assert not any(s.at_rest for s in signals(flight, initial_state='free')[0])
    assert all(s.at_rest for s in signals(silent, initial_state='rest')[0])


def test_angles_come_from_the_quaternion_where_they_are_not_recorded():
    t = np.arange(501) * PERIOD
    # Several turns of yaw: unwrapped, whatever the sign of the quaternion.
    psi = 4.0 * t
    quaternion = quaternion_from_euler(np.column_stack([0 * t, 0 * t, psi]))
    quaternion *= np.where(np.arange(501) % 2, 1, -1)[:, None]
    with_angles = record(psi=psi)
    columns = {name: values for name, values in with_angles.columns.items()
               if name not in ('phi', 'theta', 'psi')}
    columns.update(zip(('qw', 'qx', 'qy', 'qz'), quaternion.T, strict=True))
    found, _ = signals(FlightRecord(t, columns, with_angles.info))
    assert np.abs(of(found, 'psi').y - psi).max() < 1e-9


def without(*missing):
    flight = record()
    columns = {name: values for name, values in flight.columns.items() if name not in missing}
    return FlightRecord(flight.t, columns, flight.info)


@pytest.mark.parametrize(('missing', 'left_out'), [
    ('u1', {'z'}), ('u3', {'theta'}), ('pz', {'z'}), ('phi', {'phi', 'theta', 'psi'})])
def test_outputs_that_are_not_recorded_with_their_input_are_left_out(missing, left_out):
    everything = {signal.output for signal in signals(record())[0]}
    assert {signal.output for signal in signals(without(missing))[0]} == everything - left_out


def test_a_record_without_any_output_and_its_input_is_refused():
    with pytest.raises(InputError, match='no column u1'):
        signals(without('u1', 'u2', 'u3', 'u4'))
    with pytest.raises(InputError, match='no attitude'):
        signals(without('phi', 'pz'))
    with pytest.raises(InputError, match='no output together with its input'):
        signals(without('u2', 'u3', 'u4', 'pz'))


def test_wrapped_angles_are_unwrapped_and_that_is_said():
    t = record().t
    psi = 3.0 * t
    plain, wrapped = record(psi=psi), record(psi=(psi + np.pi) % (2 * np.pi) - np.pi)
    found, remarks = signals(wrapped)
    np.testing.assert_allclose(of(found, 'psi').y, of(signals(plain)[0], 'psi').y, atol=1e-9)
    assert any('unwrapped' in remark for remark in remarks)


def test_angles_that_turn_fast_stay_as_they_are_where_the_record_says_so():
    info = {'trim': list(HOVER), 'starts_at_rest': True, 'unwrapped': True}
    found, remarks = signals(record(psi=500.0 * record().t, info=info))
    np.testing.assert_allclose(of(found, 'psi').y, 500.0 * record().t)
    assert not any('unwrapped' in remark for remark in remarks)


def test_an_output_that_does_not_move_is_left_out_and_named():
    found, remarks = signals(record(phi=np.zeros(len(record().t))))
    assert 'phi' not in {signal.output for signal in found}
    assert any(remark.startswith('phi does not move') for remark in remarks)


# The grid.

def test_any_start_and_a_steady_clock_are_taken_as_they_are():
    # Stamps in 2026 are multiples of 2e-7 s in a double, 2e-5 of a period.
    t = 1.79e9 + np.arange(501) * PERIOD
    found, remarks = signals(record(t))
    assert remarks == []
    assert found[0].t[-1] == pytest.approx(5.0, abs=1e-6)
    assert (found[0].y == signals(record(t))[0][0].y).all()


def test_a_clock_that_is_off_is_no_uneven_clock():
    found, remarks = signals(record(np.arange(501) * PERIOD * 1.01))
    assert remarks == [] and found[0].period == pytest.approx(1.01 * PERIOD)


def test_a_clock_that_changes_its_pace_is_uneven():
    # Each step is within 0.1 % of a period of the next, but the times leave the grid by 5 %.
    steps = PERIOD * np.where(np.arange(500) < 250, 0.9996, 1.0004)
    _, remarks = signals(record(np.concatenate([[0.0], np.cumsum(steps)])))
    assert any('uneven' in remark for remark in remarks)


def uneven(seed=0, jitter=0.3, drop=0.05):
    """Return 5 s of sample times at 100 Hz with jitter and with some missing."""
    random = np.random.default_rng(seed)
    t = np.arange(501) * PERIOD + random.uniform(-jitter, jitter, 501) * PERIOD
    keep = random.random(501) > drop
    keep[[0, 1, -1]] = True
    t[0] = 0.0
    return t[keep]


def fine_truth(t, u_of_t):
    """Return what the true system, under a held input, does at any times."""
    fine = np.arange(50_001) * 1e-4
    y = response(TRUTH, u_of_t(fine), 1e-4)
    return np.interp(t, fine, y)


def staircase(t):
    return 0.1 * np.random.default_rng(4).choice([-1.0, 1.0], 20)[np.minimum(
        (np.asarray(t) / 0.25 + 1e-9).astype(int), 19)]


def held(t, u):
    """Return the input that a record means: u[k] from t[k] until t[k+1]."""
    return lambda at: u[np.searchsorted(t, at + 1e-12, side='right') - 1]


@pytest.mark.parametrize('seed', range(5))
def test_uneven_times_are_resampled_with_a_remark(seed):
    t = uneven(seed)
    u = staircase(t)
    true_y = held(t, u)
    flight = record(t, steps=(0, 0, 0, 0), phi=fine_truth(t, true_y), u2=u)
    found, remarks = signals(flight)
    assert len(remarks) == 1 and 'resampled' in remarks[0] and 'filled' in remarks[0]
    signal = found[0]
    assert np.abs(np.diff(signal.t) - signal.period).max() < 1e-12
    # Nothing is invented after the last sample.
    assert signal.t[-1] <= t[-1] + 1e-5
    # Straight lines between samples miss curves by h^2 / 8 of their curvature, which is K u at
    # first and at most twice that where the input turns over.
    curvature = 2 * TRUTH.gain * 0.1
    miss = np.abs(signal.y - fine_truth(signal.t, true_y)).max()
    assert miss < curvature * np.diff(t).max() ** 2 / 8
    # The input keeps its impulse from sample to sample, so the fit is within 5e-4 as measured.
    result = identify([flight], Settings(methods=('pso_cs',)))
    model = result.methods['pso_cs'].outputs['phi'].model
    assert model.gain == pytest.approx(TRUTH.gain, rel=2e-3)
    assert model.c1 == pytest.approx(TRUTH.c1, rel=2e-3)
    assert model.c0 == pytest.approx(TRUTH.c0, rel=2e-3)


def test_resampled_inputs_keep_their_impulse():
    t = uneven(7)
    u = staircase(t)
    signal = signals(record(t, steps=(0, 0, 0, 0), u2=u))[0][0]
    given = np.concatenate([[0.0], np.cumsum(u[:-1] * np.diff(t))])
    kept = np.concatenate([[0.0], np.cumsum(signal.u[:-1] * signal.period)])
    assert np.allclose(kept, np.interp(signal.t, t, given), atol=1e-14)


def test_missing_samples_are_counted_and_left_out_of_the_fit():
    t = np.delete(np.arange(501) * PERIOD, [100, 101, 102, 300])
    found, remarks = signals(record(t))
    signal = of(found, 'z')
    assert len(signal.t) == len(signal.y) == 501
    assert list(np.flatnonzero(~signal.measured)) == [100, 101, 102, 300]
    assert signal.samples == 497
    assert '4 of 501 samples are missing' in remarks[0]
    there = signal.measured
    np.testing.assert_array_equal(signal.y[there], record().columns['pz'][there] - 10)


def test_a_gap_is_refused_with_its_place_and_length():
    t = np.delete(np.arange(501) * PERIOD, np.arange(200, 220))
    with pytest.raises(InputError, match=r'gap of 0.21 s after t = 1.99 s \(21 periods'):
        signals(record(t))
    # Ten periods may be bridged.
    assert signals(record(np.delete(np.arange(501) * PERIOD, np.arange(200, 209))))[0]


def test_too_many_missing_samples_are_refused_with_their_count():
    keep = np.random.default_rng(0).random(501) > 0.3
    keep[[0, -1]] = True
    with pytest.raises(InputError, match='of 501 samples are missing; at most 20 % can be filled'):
        signals(record((np.arange(501) * PERIOD)[keep]))


def test_a_record_that_is_too_short_is_refused():
    with pytest.raises(InputError, match='7 samples; at least 8'):
        signals(record(np.arange(7) * PERIOD))
    t = np.arange(8) * 0.5
    assert signals(record(t))[0]


@pytest.mark.parametrize('value', [1e60, -1e200])
def test_values_beyond_computing_are_refused(value):
    phi = record().columns['phi'].copy()
    phi[-1] = value
    with pytest.raises(InputError, match='nothing can be computed'):
        signals(record(phi=phi))


def test_times_in_the_wrong_unit_are_refused():
    with pytest.raises(InputError, match='check the unit of t'):
        signals(record(np.arange(501) * 1e10))


# Missing samples and what the errors do not count.

def gapped(u, missing, jitter=0.0):
    """Return the psi fit of a response to inputs (501,) of which some samples are not recorded."""
    random = np.random.default_rng(3)
    t = np.arange(501) * PERIOD
    y = response(TRUTH, u, PERIOD)
    y = y + 0.01 * np.ptp(y) * random.normal(size=501)
    keep = ~np.isin(np.arange(501), missing)
    t = t + jitter * PERIOD * random.uniform(-1, 1, 501) * (np.arange(501) > 0)
    flight = record(t[keep], steps=(0, 0, 0, 0), u4=u[keep], psi=y[keep],
                    info={'trim': list(HOVER), 'starts_at_rest': True, 'unwrapped': True})
    result = identify([flight], Settings(methods=('vp',), compare_orders=False))
    return result.remarks, result.methods['vp'].outputs['psi'].findings


def test_an_input_that_changed_within_a_gap_is_a_finding():
    u = np.where(np.arange(501) // 50 % 2, 0.1, -0.1)
    _, findings = gapped(u, [99, 100, 220, 330, 331, 400])
    [said] = [finding for finding in findings if 'gaps' in finding]
    assert 'between the two sides of 2 of 4 gaps' in said and 'too small' in said


@pytest.mark.parametrize('missing', [[], [220, 330, 331]], ids=['none', 'while it stood'])
def test_gaps_in_which_the_input_stood_are_none(missing):
    u = np.where(np.arange(501) // 50 % 2, 0.1, -0.1)
    assert not [finding for finding in gapped(u, missing)[1] if 'gaps' in finding]


def test_uneven_records_say_the_same_where_they_are_resampled():
    u = np.where(np.arange(501) // 50 % 2, 0.1, -0.1)
    [said] = [remark for remark in gapped(u, [99, 100, 220], 0.1)[0] if 'resampled' in remark]
    assert 'between the two sides of 1 of 2 gaps' in said
    [said] = [remark for remark in gapped(u, [220], 0.1)[0] if 'resampled' in remark]
    assert 'two sides' not in said
