# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Experiments: their files, their inputs, and what flying them gives."""

import copy

from hypothesis import given, HealthCheck, settings
from hypothesis import strategies as st
import numpy as np
import pytest
from scipy import stats
import yaml

from quad_ident_ros import resources
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import check_noise, fly, load_experiment, NOISE_UNITS
from quad_ident_ros.model.attitude import quaternion_from_euler

FAST = settings(deadline=None, max_examples=120,
                suppress_health_check=[HealthCheck.function_scoped_fixture])
HOVER = load_experiment('hover_single_axis')
# Which columns each channel of noise is added to.
CHANNELS = {'attitude': ('phi', 'theta', 'psi'), 'altitude': ('pz',), 'position': ('px', 'py'),
            'velocity': ('vx', 'vy', 'vz'), 'rate': ('wx', 'wy', 'wz')}
QUATERNION = ('qw', 'qx', 'qy', 'qz')


def shipped(name='hover_single_axis'):
    return resources.read_yaml(resources.find('experiments', name))


@pytest.fixture
def load(tmp_path):
    """Return a function that loads an experiment file with the given content."""
    def loader(data):
        path = tmp_path / 'e.yaml'
        path.write_text(yaml.safe_dump(data), encoding='utf-8')
        return load_experiment(path)
    return loader


def refused(load, data):
    with pytest.raises(InputError) as error:
        load(data)
    message = str(error.value)
    assert 'e.yaml: ' in message and '\n' not in message and len(message) < 400
    return message


# The shipped ones.

def test_the_shipped_experiments_are_those_of_the_errata():
    assert set(resources.names('experiments')) >= {
        'hover_single_axis', 'paper_unit_steps_newton_euler', 'paper_unit_steps_printed',
        'small_angle'}


@pytest.mark.parametrize('name', resources.names('experiments'))
def test_every_shipped_experiment_flies(name):
    experiment = load_experiment(name)
    assert experiment.name == name and experiment.description
    for run in experiment.runs:
        flight = fly(experiment, run)
        assert flight.status == 'complete'
        assert len(flight.record) == len(experiment.sample_times(run))
        assert flight.record.info['run'] == run.name
        feasible = not name.startswith('paper_unit_steps')
        assert (experiment.infeasible(run) is None) == feasible
        assert (flight.record.info['infeasible'] is None) == feasible


def test_hover_single_axis_is_that_of_the_errata():
    assert (HOVER.period, HOVER.trim, HOVER.omega_r) == (0.01, 'hover', 'zero')
    weight = 0.65 * 9.806
    for run, expected in zip(HOVER.runs, ([weight, .1, 0, 0], [weight, 0, .1, 0],
                                          [weight, 0, 0, .1], [weight + 1, 0, 0, 0]),
                             strict=True):
        inputs = HOVER.input_signals(run)
        assert len(inputs) == 501 and np.allclose(inputs, expected, atol=1e-12)
    assert [run.outputs for run in HOVER.runs] == [('phi',), ('theta',), ('psi',), ('z',)]


def test_unit_steps_are_the_paper_s():
    for name in ('paper_unit_steps_newton_euler', 'paper_unit_steps_printed'):
        experiment = load_experiment(name)
        assert (experiment.input_signals(experiment.runs[0]) == 1.0).all()


def test_another_vehicle_can_be_flown():
    experiment = load_experiment('hover_single_axis', 'paper_quadrotor_izz_corrected')
    assert experiment.vehicle.inertia[2] == 1.3e-2


# Flying.

def test_the_record_tells_what_was_flown():
    info = fly(HOVER, HOVER.runs[3], noise={'altitude': 0.01}, seed=5).record.info
    assert info['experiment'] == 'hover_single_axis' and info['run'] == 'z'
    assert (info['model'], info['vehicle']) == ('newton_euler', 'paper_quadrotor')
    assert info['trim'] == pytest.approx([0.65 * 9.806, 0, 0, 0])
    assert info['initial'] == {'phi': 0.0, 'theta': 0.0, 'psi': 0.0, 'z': 10.0}
    assert (info['starts_at_rest'], info['seed'], info['status']) == (True, 5, 'complete')
    assert info['noise'] == {'altitude': 0.01}


NOISY = {'attitude': 1e-3, 'altitude': 2e-3, 'position': 3e-3, 'velocity': 4e-3, 'rate': 5e-3}


def values_of(record):
    return {name: values.tobytes() for name, values in record.columns.items()}


def test_the_same_seed_gives_the_same_bytes():
    one, same = (fly(HOVER, HOVER.runs[0], noise=NOISY, seed=3).record for _ in range(2))
    assert values_of(one) == values_of(same)
    assert one.info == same.info


def test_another_seed_gives_other_noise_and_the_same_flight():
    one, other = (fly(HOVER, HOVER.runs[0], noise=NOISY, seed=seed).record for seed in (3, 4))
    for name in one.columns:
        same = (one.columns[name] == other.columns[name]).all()
        assert same == name.startswith('u'), name


@pytest.mark.parametrize('channel', CHANNELS)
def test_noise_is_white_and_gaussian_with_its_standard_deviation(channel):
    assert set(CHANNELS) == set(NOISE_UNITS)
    run, size = HOVER.runs[2], 0.02
    clean = fly(HOVER, run).record.columns
    noisy = fly(HOVER, run, noise={channel: size}, seed=11).record.columns
    for name in clean:
        error = noisy[name] - clean[name]
        if name in CHANNELS[channel]:
            # 501 draws: the standard deviation is known to 3.2 %, the mean to 4.5 %; 4 sigma.
            assert error.std() == pytest.approx(size, rel=0.13)
            assert abs(error.mean()) < 4 * size / np.sqrt(501)
            assert stats.normaltest(error).pvalue > 1e-4
            assert abs(np.corrcoef(error[1:], error[:-1])[0, 1]) < 4 / np.sqrt(500)
        elif not (channel == 'attitude' and name in QUATERNION):
            assert not error.any(), name


def test_columns_have_noise_of_their_own():
    clean = fly(HOVER, HOVER.runs[0]).record
    noisy = fly(HOVER, HOVER.runs[0], noise=NOISY, seed=1).record
    names = [name for group in CHANNELS.values() for name in group]
    errors = noisy.stack(*names) - clean.stack(*names)
    correlation = np.corrcoef(errors.T) - np.eye(len(names))
    # 66 pairs of 501 draws each: 4.5 sigma.
    assert np.abs(correlation).max() < 4.5 / np.sqrt(501)


def test_the_noisy_quaternion_is_that_of_the_noisy_angles():
    record = fly(HOVER, HOVER.runs[0], noise={'attitude': 0.02}, seed=2).record
    made = quaternion_from_euler(record.stack('phi', 'theta', 'psi'))
    assert np.allclose(made, record.stack(*QUATERNION), atol=1e-15)


def test_one_channel_s_noise_does_not_depend_on_another():
    alone = fly(HOVER, HOVER.runs[0], noise={'rate': 5e-3}, seed=9).record.columns
    together = fly(HOVER, HOVER.runs[0], noise=NOISY, seed=9).record.columns
    assert all((alone[name] == together[name]).all() for name in CHANNELS['rate'])


def test_a_run_s_noise_does_not_depend_on_the_others():
    def noise_of(run):
        return (fly(HOVER, run, noise=NOISY, seed=6).record.columns['pz']
                - fly(HOVER, run).record.columns['pz'])
    first = noise_of(HOVER.runs[1])
    noise_of(HOVER.runs[0])
    assert (noise_of(HOVER.runs[1]) == first).all()
    # And runs differ: their correlation is that of independent draws.
    assert abs(np.corrcoef(first, noise_of(HOVER.runs[0]))[0, 1]) < 4 / np.sqrt(501)


def test_noise_of_the_experiment_is_used_unless_replaced(load):
    experiment = load({**shipped(), 'noise': {'altitude': 0.5}})
    run = experiment.runs[2]    # yaw, in which the altitude stays
    assert fly(experiment, run).record.columns['pz'].std() == pytest.approx(0.5, rel=0.13)
    assert fly(experiment, run, noise={}).record.columns['pz'].std() < 1e-9


def test_a_diverging_run_has_the_record_so_far(load):
    data = shipped('paper_unit_steps_printed')
    data['runs'][0]['inputs'] = {'U4': {'type': 'step', 'amplitude': 1.0}}
    experiment = load(data)
    flight = fly(experiment, experiment.runs[0], noise=NOISY)
    assert flight.status == flight.record.info['status'] == 'diverged'
    assert flight.record.info['end_time'] == flight.end_time == pytest.approx(0.081, abs=1e-3)
    assert flight.record.t[-1] <= flight.end_time and len(flight.record) == 9


def test_omega_r_is_taken_from_the_file(load):
    data = shipped()
    data['runs'] = [{**data['runs'][0], 'duration': 0.05, 'inputs': {
        'U2': {'type': 'step', 'amplitude': 0.1}, 'U4': {'type': 'step', 'amplitude': 0.1}}}]
    pitch = {}
    for setting, sign in (('zero', 1), (67.1, 1), (67.1, -1), ('from_rotors', 1)):
        experiment = load({**data, 'omega_r': setting, 'omega_r_sign': sign})
        record = fly(experiment, experiment.runs[0]).record
        pitch[setting, sign] = record.columns['wy'][-1]
    # Jr Omega_r p pitches up, at first, and down with the other sign. From the rotors it is
    # 67.1 rad/s for the yaw step at hover, and a little more with the roll step.
    assert pitch[67.1, -1] < pitch['zero', 1] < pitch[67.1, 1]
    assert pitch['from_rotors', 1] == pytest.approx(pitch[67.1, 1], rel=0.01)


def test_omega_r_from_rotors_refuses_infeasible_inputs(load):
    experiment = load({**shipped('paper_unit_steps_newton_euler'), 'omega_r': 'from_rotors'})
    with pytest.raises(InputError, match='from_rotors needs feasible inputs'):
        fly(experiment, experiment.runs[0])


def test_the_step_of_the_file_is_used(load):
    coarse = load({**shipped('paper_unit_steps_newton_euler'), 'step': 0.01})
    fine = load(shipped('paper_unit_steps_newton_euler'))
    ends = [fly(experiment, experiment.runs[0]).record.columns['phi'][-1]
            for experiment in (coarse, fine)]
    assert 1e-4 < abs(ends[0] - ends[1]) < 1e-2
    assert fly(coarse, coarse.runs[0]).record.info['step'] == 0.01


@pytest.mark.parametrize(('duration', 'period', 'count'), [
    (5.0, 0.01, 501), (0.3, 0.1, 4), (1.0, 0.3, 4), (0.01, 0.01, 2), (0.7, 0.07, 11)])
def test_samples_run_from_zero_to_the_duration(load, duration, period, count):
    data = {**shipped(), 'period': period}
    data['runs'] = [{**data['runs'][0], 'duration': duration}]
    t = load(data).sample_times(load(data).runs[0])
    assert len(t) == count
    assert t[0] == 0.0 and duration - period < t[-1] <= duration + 1e-9


# Bad files.

def changed(path, value):
    """Return the shipped experiment with the value at a path of keys replaced, or added."""
    data = copy.deepcopy(shipped())
    target = data
    for key in path[:-1]:
        target = target[key]
    target[path[-1]] = value
    return data


@pytest.mark.parametrize(('path', 'value', 'words'), [
    (('modle',), 'paper', "'modle' is not known here; did you mean 'model'?"),
    (('model',), 'euler', "model: 'euler' is not one of newton_euler, paper"),
    (('model',), ['paper'], 'is not one of newton_euler, paper'),
    (('vehicle',), 'nope', "vehicle: 'nope' is not among the vehicles"),
    (('vehicle',), None, "vehicle: 'None' is not among the vehicles"),
    (('period',), 0, 'period: 0 is out of range, expected > 0'),
    (('period',), 'fast', "period: expected a number, got 'fast'"),
    (('period',), 1e-9, 'more than 1000000 samples'),
    (('trim',), 'level', "trim: 'level' is not one of hover, zero"),
    (('altitude',), 'high', 'altitude: expected a number'),
    (('omega_r',), 'rotors', 'omega_r (zero, from_rotors or rad/s): expected a number'),
    (('omega_r',), None, 'expected a number, it is empty'),
    (('omega_r_sign',), 0, 'omega_r_sign: 0 is not one of 1, -1'),
    (('step',), -1e-4, 'step: -0.0001 is out of range'),
    (('noise',), {'altitud': 1}, "noise: 'altitud' is not known here; did you mean 'altitude'?"),
    (('noise',), {'altitude': -1}, 'noise: altitude: -1 is out of range'),
    (('noise',), 3, 'noise: expected `key: value` lines'),
    (('name',), ['a'], 'name: expected a name'),
    (('runs',), [], 'runs: expected a list of runs'),
    (('runs',), {'phi': 1}, 'runs: expected a list of runs'),
    (('runs', 0), 'phi', 'runs[0]: expected `key: value` lines'),
    (('runs', 1, 'name'), 'phi', 'two runs have the same name'),
    (('runs', 0, 'name'), '', 'runs[0]: name: expected a name'),
    (('runs', 0, 'duration'), 0, 'runs[0]: duration: 0 is out of range'),
    (('runs', 0, 'duration'), 0.001, 'duration: 0.001 is out of range, expected >= 0.01'),
    (('runs', 0, 'duration'), 1e12, 'more than 1000000 samples'),
    (('runs', 0, 'outputs'), ['roll'], "outputs: 'roll' is not one of phi, theta, psi, z"),
    (('runs', 0, 'outputs'), 'phi', 'outputs: expected a list of phi, theta, psi, z'),
    (('runs', 0, 'outputs'), [], 'outputs: expected a list of phi, theta, psi, z'),
    (('runs', 0, 'inputs'), {'u2': {}}, "'u2' is not known here; did you mean 'U2'?"),
    (('runs', 0, 'inputs'), ['U2'], 'inputs: expected `key: value` lines'),
    (('runs', 0, 'input'), {}, "did you mean 'inputs'?"),
], ids=lambda value: str(value)[:24])
def test_bad_values_are_refused_with_key_and_reason(load, path, value, words):
    with pytest.raises(InputError) as error:
        load(changed(path, value))
    assert words in str(error.value)
    assert words in refused(load, changed(path, value))


@pytest.mark.parametrize('key', ['name', 'model', 'vehicle', 'period', 'trim', 'runs'])
def test_a_missing_key_is_named(load, key):
    data = shipped()
    del data[key]
    assert f"'{key}' is missing" in refused(load, data)


def test_a_bad_excitation_is_named_with_its_run_and_input(load):
    experiment = load(changed(('runs', 0, 'inputs', 'U2', 'amplitude'), 'big'))
    with pytest.raises(InputError, match='hover_single_axis, run phi, U2: step: amplitude'):
        fly(experiment, experiment.runs[0])


@pytest.mark.parametrize('step', [1e-15, 5e-324])
def test_a_step_that_would_take_for_ever_is_refused(load, step):
    experiment = load({**shipped(), 'step': step})
    with pytest.raises(InputError, match='steps'):
        fly(experiment, experiment.runs[0])


@pytest.mark.parametrize('noise', [{'alt': 1}, {'rate': 'x'}, {'rate': float('inf')}, [1], None])
def test_bad_noise_is_refused(noise):
    with pytest.raises(InputError, match='^here'):
        check_noise('here', noise)


scalars = (st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8)
           | st.sampled_from([10 ** 400, 1e308, 5e-324, '1e999', 'zero', 'paper', 'U1', 'phi']))
anything = st.recursive(scalars, lambda inner: st.lists(inner, max_size=3)
                        | st.dictionaries(st.text(max_size=4), inner, max_size=3), max_leaves=6)
places = st.sampled_from([
    *((key,) for key in ('name', 'description', 'model', 'vehicle', 'period', 'trim', 'altitude',
                         'runs', 'omega_r', 'omega_r_sign', 'step', 'noise', 'other')),
    ('runs', 1), *(('runs', 1, key) for key in ('name', 'duration', 'inputs', 'outputs', 'more')),
    ('runs', 1, 'inputs', 'U3'), ('runs', 1, 'inputs', 'U9'),
    *(('runs', 1, 'inputs', 'U3', key) for key in ('type', 'amplitude', 'time', 'file'))])


@pytest.mark.slow
@FAST
@given(place=places, value=anything)
def test_any_value_gives_an_experiment_or_an_input_error(tmp_path, place, value):
    path = tmp_path / 'e.yaml'
    path.write_text(yaml.safe_dump(changed(place, value)), encoding='utf-8')
    try:
        experiment = load_experiment(path)
        for run in experiment.runs:
            with np.errstate(over='ignore'):    # an amplitude of 1e308, say
                signals = experiment.input_signals(run)
            assert signals.shape == (len(experiment.sample_times(run)), 4)
    except InputError as error:
        assert '\n' not in str(error) and len(str(error)) < 500
