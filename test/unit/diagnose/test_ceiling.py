# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The ceiling of what can be closed, and the residual function written, on known truths."""

from dataclasses import replace
import json

import pytest
from residual_functions import STRANGE, times

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.diagnose.carried import carried
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.result import ShareClosed
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.report.ceiling import ceiling_line, residual_line, share_of
from quad_ident_ros.report.diagnosis import far_rows
from quad_ident_ros.report.received import diagnosis_from

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group('ceiling')]    # they share diagnoses
NOMINAL = load_vehicle('hummingbird')
COURSES = ('figure8', 'lissajous', 'steps', 'lissajous')     # the last one is held out
DRAG = {'rotor_drag': {'coefficient': 0.3 * NOMINAL.mass}}
EFFECTS = ['rotor_drag', 'body_drag', 'mass_offset']    # few: the search is no matter here


def flights(vehicle, effects, seed=0, courses=COURSES, duration=10.0):
    return [fly_closed_loop(vehicle, effects, course, duration=duration, seed=seed + k,
                            noise=SENSORS['mocap_imu']) for k, course in enumerate(courses)]


@pytest.fixture(scope='module')
def strange():
    """Return what flew with a drag and a force that no effect has."""
    return flights(replace(NOMINAL, residual=STRANGE), DRAG)


@pytest.fixture(scope='module')
def found(strange):
    return diagnose(strange, NOMINAL, effects=EFFECTS)


@pytest.fixture(scope='module')
def explained():
    """Return the diagnosis of a reality that has a named effect and nothing else."""
    return diagnose(flights(NOMINAL, DRAG), NOMINAL, effects=EFFECTS)


def test_where_effects_explain_all_the_ceiling_is_what_they_close(explained):
    ceiling = explained.ceiling
    assert explained.verdict == ('rotor_drag',)
    assert abs(ceiling.open_loop.closed - explained.gap.closed) < 0.02
    assert abs(ceiling.given_attitude.closed - explained.gap_given_attitude.closed) < 0.02


def test_noise_alone_has_no_ceiling():
    one = diagnose(flights(NOMINAL, {}), NOMINAL, effects=EFFECTS)
    assert one.verdict == ('none',)
    assert not one.ceiling.shown and one.residual is None
    assert one.ceiling.open_loop.closed == one.gap.closed
    assert one.ceiling.open_loop.after == one.gap.after


def test_a_force_that_no_effect_has_is_under_the_ceiling(found):
    assert 'unknown' in found.verdict
    for closed, ceiling in ((found.gap.closed, found.ceiling.open_loop),
                            (found.gap_given_attitude.closed, found.ceiling.given_attitude)):
        # All of it is a function of the state: the truth is 1, of which three flights of 10 s
        # do not show all.
        assert ceiling.closed - 3.0 * ceiling.std > closed
        assert 0.7 < ceiling.closed <= 1.0
        assert 0.0 < ceiling.std < 0.1
    assert found.ceiling.shown == ('force',) and found.ceiling.gain['force'] > 3.0


def test_it_is_told_beside_what_the_effects_close(found, explained):
    assert f'{100 * found.ceiling.open_loop.closed:.0f} ± ' in ceiling_line(found)
    assert f'{100 * found.gap.closed:.0f} %' in residual_line(found)
    assert 'no function' in ceiling_line(explained) and 'none is written' in residual_line(
        explained)
    had = replace(explained, vehicle=replace(NOMINAL, residual=STRANGE))
    assert 'residual: that of the vehicle file stays' in residual_line(had)
    velocity = far_rows(found)[1]
    assert velocity[0] == 'velocity'
    assert float(velocity[4]) == pytest.approx(found.ceiling.open_loop.after['velocity'], rel=0.01)


def test_the_ceiling_of_a_moment_is_told_by_the_rate():
    """Flights without velocity, whose motors lag, and an effect without a moment."""
    lag = {'motor_lag': {'time_constant': 0.03}}
    seen = [replace(one, columns={name: values for name, values in one.columns.items()
                                  if name in ('wx', 'wy', 'wz', 'ax', 'ay', 'az')
                                  or name.startswith('cmd')})
            for one in flights(NOMINAL, lag, courses=('figure8', 'lissajous', 'steps'),
                               duration=15.0)]
    one = diagnose(seen, NOMINAL, effects=['thrust_scale'])
    assert one.ceiling.shown == ('moment',)
    ceiling = one.ceiling.open_loop
    assert ceiling.group == 'rate' and ceiling.after['rate'] < one.gap.after['rate']
    assert ceiling.closed > 3.0 * ceiling.std
    closed = f'{100 * ceiling.closed:.0f} ± '
    assert f'would close {closed}' in ceiling_line(one) and 'rate gap' in ceiling_line(one)
    assert closed in residual_line(one) and '% of the rate gap' in residual_line(one)


@pytest.mark.parametrize(('std', 'said'), [
    (0.096, '83 ± 10 %'), (1.34, '83 ± 100 %'), (0.004, '83 ± 0.4 %'), (None, '83 %')])
def test_a_large_standard_error_is_written_without_an_exponent(std, said):
    assert share_of(ShareClosed({}, 0.83, std, 'velocity')) == said


def test_it_travels_as_data(found):
    data = json.loads(json.dumps(found.as_data()))
    assert data['ceiling']['open_loop']['closed'] == found.ceiling.open_loop.closed
    assert diagnosis_from(data, NOMINAL).ceiling == found.ceiling


def test_the_written_vehicle_flies_a_third_flight_closer(found):
    third = flights(replace(NOMINAL, residual=STRANGE), DRAG, seed=70, courses=('lissajous',))
    named = found.corrected(NOMINAL)
    assert named.residual is None
    whole = replace(named, residual=found.residual)
    gaps = carried(third, NOMINAL, whole, {'named': named}).gaps
    assert gaps['vehicle']['velocity'] < 0.5 * gaps['named']['velocity']
    assert gaps['vehicle']['velocity'] < 0.5 * gaps['nominal']['velocity']


def test_a_nominal_vehicle_that_has_the_function_has_nothing_unknown(strange, found):
    """The next diagnosis is of what remains: the function is a part of the nominal model."""
    known = replace(found.corrected(NOMINAL), residual=found.residual)
    again = diagnose(strange, known, effects=EFFECTS)
    assert again.gap.before['velocity'] < 0.5 * found.gap.before['velocity']
    assert again.corrected(known).residual == found.residual


def test_a_new_function_does_what_that_of_the_vehicle_file_did_too():
    """It is flown in place of the old one: with half of the truth known it learns the whole."""
    real = flights(replace(NOMINAL, residual=times(2.0, STRANGE)), {})
    half = diagnose(real, replace(NOMINAL, residual=STRANGE), effects=['rotor_drag'])
    assert half.ceiling.shown == ('force',)
    ceiling = half.ceiling.open_loop
    assert ceiling.closed - 3.0 * ceiling.std > half.gap.closed
    bare = diagnose(real, NOMINAL, effects=['rotor_drag']).ceiling.open_loop
    assert ceiling.after['velocity'] == pytest.approx(bare.after['velocity'], rel=0.1)


def test_blocks_of_a_single_flight_have_a_ceiling(strange):
    one = diagnose(strange[:1], NOMINAL, effects=EFFECTS)
    assert one.gap.closed - 1e-9 <= one.ceiling.open_loop.closed <= 1.0
    assert 0.0 <= one.ceiling.open_loop.std < 0.5


def command(tmp_path, records, *more):
    paths = []
    for k, record in enumerate(records):
        paths.append(str(tmp_path / f'flight_{k}.csv'))
        write_csv(paths[-1], record)
    write_vehicle(tmp_path / 'nominal.yaml', NOMINAL)
    return ['diagnose', *paths, '--vehicle', str(tmp_path / 'nominal.yaml'), '--effects',
            ','.join(EFFECTS), *more]


def test_the_command_writes_it_and_the_verdict_is_the_same(tmp_path, capsys, strange):
    out, plain = tmp_path / 'real.yaml', tmp_path / 'plain.yaml'
    told = []
    for path, more in ((out, ['--residual']), (plain, [])):
        said = tmp_path / f'{path.stem}.json'
        assert main(command(tmp_path, strange[:2], '--out-vehicle', str(path), '--json', str(said),
                            *more)) == 0
        told.append(json.loads(said.read_text()))
    assert told[0] == told[1]
    printed = capsys.readouterr().out
    assert printed.count('residual (force): the effects close') == 1
    real, named = load_vehicle(out), load_vehicle(plain)
    assert named.residual is None and real.residual is not None
    assert replace(real, residual=None) == named


def test_the_command_refuses_it_where_it_gains_nothing(tmp_path, capsys):
    out = tmp_path / 'real.yaml'
    assert main(command(tmp_path, flights(NOMINAL, DRAG, courses=COURSES[:2]), '--out-vehicle',
                        str(out), '--residual')) == 0
    assert 'residual: none is written' in capsys.readouterr().out
    assert load_vehicle(out).residual is None


def test_without_a_file_to_write_to_it_is_refused(tmp_path, capsys, strange):
    assert main(command(tmp_path, strange, '--residual')) == 2
    said = capsys.readouterr().err
    assert said.count('\n') == 1 and '--residual' in said and '--out-vehicle' in said
