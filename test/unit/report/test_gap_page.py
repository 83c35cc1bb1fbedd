# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A diagnosis as a person reads it: in the terminal, on the page, and its pictures."""

from dataclasses import replace
import hashlib
from html import escape, unescape
import io
import json
from pathlib import Path
import re

import matplotlib.image
import numpy as np
import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.residual_wrench import CHANNELS, ResidualWrench
from quad_ident_ros.diagnose.result import FlightCheck, Minor, Unexplained, Value
from quad_ident_ros.effects.registry import titled
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.report import gap_page
from quad_ident_ros.report.diagnosis import ALL, caution_lines, show, USUAL, VERDICT
from quad_ident_ros.report.gap_pictures import _by_third, map_rows, regimes, save_map
from quad_ident_ros.report.received import diagnosis_from
from quad_ident_ros.report.verdict import sentence

# One diagnosis for all tests.
pytestmark = [pytest.mark.slow, pytest.mark.xdist_group('gap_page')]
VEHICLE = load_vehicle('hummingbird')


@pytest.fixture(scope='module')
def flights():
    return [fly_closed_loop(VEHICLE, {'rotor_drag': {'coefficient': 0.3}}, name, duration=10.0,
                            seed=seed, noise=MOCAP_IMU)
            for seed, name in enumerate(('figure8', 'circle'))]


@pytest.fixture(scope='module')
def found(flights):
    return diagnose(flights, VEHICLE, effects=['rotor_drag', 'body_drag', 'wind'])


@pytest.fixture(scope='module')
def page(found, tmp_path_factory):
    """Return a function that writes the page of a changed diagnosis and reads it."""
    path = tmp_path_factory.mktemp('page') / 'page.html'

    def write(**changes):
        gap_page.write(path, replace(found, **changes))
        return path.read_text(encoding='utf-8')
    return write


@pytest.fixture(scope='module')
def plain(page):
    """Return the page of the diagnosis as it is."""
    return page()


@pytest.fixture(scope='module')
def remaining(page):
    """Return the page of one that leaves much open."""
    return page(**OPEN)


@pytest.fixture
def terminal(found):
    """Return a function that returns what is printed of a changed diagnosis."""
    def printed(detail=USUAL, **changes):
        stream = io.StringIO()
        show(replace(found, **changes), stream, detail)
        return stream.getvalue()
    return printed


def test_the_verdict_comes_first_then_where_which_and_how_far(plain, found):
    text = plain
    places = [text.index(part) for part in (
        '<strong>Verdict: </strong>', '>drag of the rotors (rotor_drag)</span>', '<h2>Where</h2>',
        '<h2>Which effects</h2>', '<h2>How far</h2>', '<h2>Provenance</h2>')]
    assert places == sorted(places)
    assert text.count('class="picture" role="img"') == 5 and '<img' not in text
    assert not re.search(r'(src|href)="(?!#|data:)', text)     # one file holds it all
    assert not re.search(r'url\((?!#)|@import', text)
    assert f'explains {100 * found.gap.closed:.0f} % of the velocity gap above the noise.' in text


def test_a_flight_that_knows_no_position_has_no_path(page, plain, found):
    assert plain.count('Flight path in space') > 0
    blind = tuple(replace(one, features={name: feature for name, feature in one.features.items()
                                         if name != 'height'})
                  for one in found.pictures.wrench_before)
    text = page(pictures=replace(found.pictures, wrench_before=blind, wrench_after=blind))
    drawn = re.sub('<script>.*?</script>', '', text, flags=re.DOTALL)
    assert drawn.count('class="picture" role="img"') == 4 and 'Flight path in space' not in drawn


def test_the_terminal_has_the_same_order_and_the_size_beside_the_verdict(terminal, found):
    text = terminal()
    verdict, size, step, *_ = text.splitlines()
    one = found.ranking[0].parameters['coefficient']
    assert verdict == (
        f'verdict: drag of the rotors (rotor_drag), coefficient {one.value:.4g} ± {one.std:.2g} '
        f'kg/s, explains {100 * found.gap.closed:.0f} % of the velocity gap above the noise')
    assert step.startswith('Next: ') and '--out-vehicle' in step
    for stage in (found.gap.before, found.gap.after, found.gap.noise):
        assert f'{stage["velocity"]:.3g} m/s' in size
    places = [text.index(part) for part in ('\nwhere: ', '\nwhich effects ', '\nhow far: ')]
    assert places == sorted(places)


def test_both_gaps_are_told_of_the_nominal_vehicle_with_and_without_nuisances(terminal, found):
    gap = replace(found.gap, before_own=found.gap.before | {'velocity': 0.12345})
    lines = {line[:25].strip(): line for line in terminal(gap=gap).splitlines()}
    for number in (gap.before['velocity'], 0.123, gap.after['velocity'], gap.noise['velocity']):
        assert f'{number:.3g} ' in lines['velocity']
    given = found.gap_given_attitude
    for name in ('position', 'velocity'):
        row = lines[f'{name} given attitude']
        assert all(f'{stage[name]:.3g}' in row for stage in (given.before, given.before_own,
                                                             given.after, given.noise))


def test_the_interval_is_that_of_the_estimate(plain, found):
    one = found.ranking[0].parameters['coefficient']
    low, high = one.value - 1.96 * one.std, one.value + 1.96 * one.std
    assert f'<td>{low:.4g} to {high:.4g}</td>' in plain
    assert low < 0.3 < high


def test_an_effect_has_its_form_and_what_is_lost_without_it(terminal, found):
    [line] = [line for line in terminal().splitlines() if line.strip().startswith('rotor_drag')]
    row = found.ranking[0]
    assert row.form in line and f'{100 * row.contribution:.0f} %' in line
    assert f'{found.gap.without["rotor_drag"]["velocity"]:.3g}' in line


def test_where_the_gap_is_within_the_noise_there_is_nothing_to_close(terminal, found):
    within = found.gap.before | {'velocity': 0.5 * found.gap.noise['velocity']}
    gap = replace(found.gap, before=within, before_own=within, after=within, closed=1.0)
    verdict, size, *rest = terminal(gap=gap).splitlines()
    [far] = [line for line in rest if line.startswith('how far: ')]
    assert 'nothing to close' in size and 'nothing to close' in far
    assert verdict.endswith('explains the gap')
    assert f'attitude, {100 * found.gap_given_attitude.closed:.0f} % of the velocity gap' in far
    assert 'nothing to close' not in terminal()


OPEN = {
    'verdict': ('rotor_drag', 'unknown'),
    'minor': (Minor('motor_lag', 0.98, 0.012), Minor('inflow', 0.9, 0.3)),
    'unknown': (Unexplained('Fz', 'height under 0.66 m', 0.4, (0.2, 1.2), 0.03, 'N'),
                Unexplained('Fz', 'height <5 m', 0.4, (0.0, 0.0), 0.03, 'N')),
    'one_finding': ({'effect': 'inertia_mismatch', 'tells': 'a ruler',
                     'may_be': [['inertia about z', 'torque coefficient']]},),
    'flight_checks': (FlightCheck('monday', {'velocity': 1.1}, False),
                      FlightCheck('payload', {'velocity': 14.2}, True)),
    'nuisances': {'clock_offset': {'what': 'how late', 'unit': 's', 'values': [[0.01], [0.02]],
                                   'held_out': [0.03], 'hidden_delay': 0.014}},
    'findings': ({'flight': 'monday', 'code': 'gap', 'severity': 'warning', 'where': 'rows',
                  'message': 'are lost', 'remedy': 'record again'},),
    'not_shown': ('ground_effect',)}
SAID = ('also present, but closing less than 5 %: lag of the motors (motor_lag), 1.2 %, '
        'probability 0.98',
        "also present, but closing no more than the other effects' errors of form could: inflow "
        'and translational lift (inflow), 30.0 %, probability 0.90',
        'unexplained: Fz, height under 0.66 m, 0.03 N rms, 0.2 to 1.2 Hz',
        'error in inertia (inertia_mismatch): the same motion comes of inertia about z or torque '
        'coefficient; what distinguishes them: a ruler',
        'payload differs from the other flights; gap over that of the noise: velocity 14.2',
        'estimated per flight, not reported as effects:',
        'clock_offset (how late), s: 0.01; 0.02; held out 0.03',
        'a delay common to all flights of up to 14 ms cannot be distinguished from clock offsets',
        'would not show at their usual size: ground effect (ground_effect)',
        'warning: monday: rows: are lost; record again')


def test_what_remains_open_is_said_in_the_terminal(terminal):
    text = terminal(ALL, **OPEN)
    verdict, *_ = text.splitlines()
    assert verdict.startswith('verdict: drag of the rotors (rotor_drag), ')
    assert verdict.endswith(', and the rest is unknown: another cause, or this effect by a law '
                            'that is none of its forms')
    lines = [line.strip() for line in text.splitlines()]
    assert [said for said in SAID if said not in lines] == []
    assert 'monday differs' not in text


def test_what_was_estimated_per_flight_and_other_horizons_are_asked_for(terminal, found):
    usual, everything = terminal(**OPEN), terminal(ALL, **OPEN)
    lines = [line.split() for line in everything.splitlines()]
    for seconds, one in found.gap.horizons.items():
        row = [f'{float(seconds):g}', *(f'{one[stage]["velocity"]:.3g}' for stage in (
            'before', 'before_own', 'after', 'noise'))]
        assert row in lines and row not in [line.split() for line in usual.splitlines()]
    assert 'clock_offset' in everything and 'clock_offset' not in usual


def test_a_vehicle_that_is_written_is_the_one_to_export(found, tmp_path):
    stream = io.StringIO()
    show(found, stream, VERDICT, 'like_real.yaml')
    gap_page.write(tmp_path / 'page.html', found, 'like_real.yaml')
    said = 'quad_ident export like_real.yaml --to SIMULATOR'
    assert said in stream.getvalue().splitlines()[2]
    assert said in (tmp_path / 'page.html').read_text(encoding='utf-8')


@pytest.mark.parametrize(('text', 'said'), [
    ('the ceiling', 'The ceiling.'), ('also: one', 'Also: one.'),
    ('flight_1 (flight_2 alike): a', 'flight_1 (flight_2 alike): a.'),
    ('clock_offset (how late), s: 0.01', 'clock_offset (how late), s: 0.01.')])
def test_a_sentence_leaves_a_name_that_it_begins_with_as_it_is(text, said):
    assert sentence(text) == said


def test_the_verdict_alone_is_three_lines(terminal):
    whole = terminal().splitlines()
    assert terminal(VERDICT).splitlines() == whole[:3]


def test_the_verdict_alone_says_where_the_lines_are_that_it_points_to(terminal):
    lines = terminal(VERDICT, verdict=('rotor_drag', 'unknown')).splitlines()
    assert '"unexplained"' in lines[2] and lines[3:] == ['Without --quiet these are printed.']


def test_effects_without_a_row_are_told_in_one_line(terminal, found):
    [line] = [one for one in terminal().splitlines() if 'not in the table' in one]
    without = [row for row in found.ranking if row.form is None]
    assert len(without) == 2
    likely = [replace(row, probability=0.31) if row is without[0] else
              replace(row, probability=0.001) if row is without[1] else row
              for row in found.ranking]
    [line] = [one for one in terminal(ranking=tuple(likely)).splitlines()
              if 'not in the table' in one]
    assert line == (f'probability of effects not in the table: {titled(without[0].effect)} 0.31, '
                    '1 other effect below 0.02')


class Screen(io.StringIO):
    """A terminal that knows colours."""

    def isatty(self):
        return True


@pytest.mark.parametrize(('value', 'coded'), [('1', False), ('', True)])
def test_no_color_prints_no_codes(found, monkeypatch, value, coded):
    monkeypatch.setenv('NO_COLOR', value)
    monkeypatch.setenv('TERM', 'xterm-256color')
    screen = Screen()
    show(found, screen)
    assert ('\x1b' in screen.getvalue()) == coded


def finding(flight, message):
    """Return a finding on the commands of a flight."""
    return {'flight': flight, 'code': 'commands', 'severity': 'info', 'where': 'file',
            'message': message, 'remedy': ''}


def test_each_finding_on_a_flight_is_told_and_equal_ones_of_several_flights_once(found):
    said = [finding(name, message) for name, gain in (('one', 2), ('two', 2.5))
            for message in ('rotors are motors 2, 1, 4, 3', f'taken for duty, speed {gain} x',
                            'gain 3', 'gain 4')]
    said.append(finding('two', 'taken for PWM'))
    assert caution_lines(replace(found, findings=said)) == [
        'one (two alike): file: rotors are motors 2, 1, 4, 3',
        'one (two alike): file: taken for duty, speed 2 x', 'one (two alike): file: gain 3',
        'one (two alike): file: gain 4', 'two: file: taken for PWM']


def test_what_remains_open_is_said_on_the_page(remaining):
    text = remaining
    assert '<h2>What remains open</h2>' in text
    assert [said for said in SAID if f'<li>{escape(sentence(said))}' not in text] == []


def test_what_a_diagnosis_says_survives_the_way_over_json(found):
    changed = replace(found, **OPEN)
    received = diagnosis_from(json.loads(json.dumps(changed.as_data())), VEHICLE)
    texts = []
    for one in (changed, received):
        stream = io.StringIO()
        show(one, stream)
        texts.append(stream.getvalue())
    assert texts[0] == texts[1]


def test_no_private_word_is_read(terminal, remaining):
    for text in (terminal(**OPEN), terminal(), terminal(verdict=('none',)),
                 re.sub('<style>.*?</style>|<script>.*?</script>', '', remaining,
                        flags=re.DOTALL)):
        assert not re.search(r'\b(lacks?|lacking|own|left)\b',
                             re.sub('to the left', '', text))


def test_what_cannot_be_told_apart_asks_for_a_flight(page, terminal):
    changes = {'verdict': ('undetermined',), 'undetermined': ('wind', 'body_drag'),
               'sure': ('rotor_drag',), 'fly_next': [proposal('circle'), proposal('chirp_x')]}
    text = page(**changes)
    said = ('undetermined: the flights cannot distinguish between steady wind (wind) and drag of '
            'the body (body_drag); certain: drag of the rotors (rotor_drag)')
    assert f'U{said[1:]}.' in text
    first = text.index('<th scope="row" class="text">circle, 20 s</th>')
    assert first < text.index('chirp_x, 20 s')
    assert ('<td class="text">tell apart steady wind (wind), drag of the body (body_drag)</td>'
            '<td>0.5</td><td>12</td>') in text
    assert terminal(**changes).startswith(f'verdict: {said}\n')
    assert '\nNext: fly what ' in terminal(**changes)


def test_what_is_less_likely_than_not_is_not_certain_beside_what_cannot_be_told_apart(
        terminal, found):
    changes = {'verdict': ('undetermined',), 'undetermined': ('motor_lag', 'actuation_delay'),
               'sure': ('rotor_drag',),
               'ranking': tuple(replace(row, probability=0.37) if row.effect == 'rotor_drag'
                                else row for row in found.ranking)}
    verdict = terminal(**changes).splitlines()[0]
    assert verdict.endswith(' and delay of the commands (actuation_delay); drag of the rotors '
                            '(rotor_drag), uncertain (probability 0.37)')


def test_what_cannot_be_told_apart_beside_a_larger_effect_ends_the_sentence(terminal, found):
    changes = {'undetermined': ('motor_lag', 'actuation_delay'), 'sure': ('rotor_drag',)}
    verdict, size, *_ = terminal(**changes).splitlines()
    assert verdict == (f'{terminal().splitlines()[0]}; beside it, the flights cannot '
                       'distinguish between lag of the motors (motor_lag) and delay of the '
                       'commands (actuation_delay)')
    assert size.startswith('With this effect, ')


def test_each_of_several_effects_is_told_with_its_size(terminal, found):
    first, second, *_ = found.ranking
    second = replace(second, contribution=0.2, parameters={'x': Value(2.0, 0.1, 'm/s', 0.5)})
    verdict, size, *_ = terminal(verdict=(first.effect, second.effect),
                                 ranking=(first, second)).splitlines()
    assert verdict.startswith('verdict: 2 effects explain ')
    assert verdict.endswith(f' ({second.effect}), x 2 ± 0.1 m/s (+0.5 against the file), '
                            'contribution 20 %')
    assert size.startswith('With these effects, ')


def test_effects_that_are_less_likely_than_not_are_no_certain_verdict(terminal, found):
    first, second = (replace(row, probability=value) for row, value in zip(
        found.ranking[:2], (0.37, 0.16), strict=True))
    names = first.effect, second.effect
    verdict, _, step, *_ = terminal(verdict=names, ranking=(first, second),
                                    fly_next=None).splitlines()
    assert verdict.startswith('verdict: uncertain: the best known explanation of ')
    assert 'probability 0.37' in verdict and verdict.endswith('probability 0.16')
    assert step.startswith('Next: fly again') and '--out-vehicle' not in step
    likely = replace(first, probability=0.6)
    verdict = terminal(verdict=names, ranking=(likely, second)).splitlines()[0]
    assert verdict.startswith('verdict: 2 effects explain ')


@pytest.mark.parametrize(('differing', 'said'), [
    (('held',), True), (('monday',), False), (('monday', 'held'), False), ((), False)])
def test_where_only_the_flight_held_out_differs_another_one_may_be_held_out(
        terminal, found, differing, said):
    checks = tuple(FlightCheck(name, {'velocity': 1.1}, name in differing)
                   for name in ('monday', 'tuesday', 'held'))
    text = terminal(verdict=('unknown',), flight_checks=checks, held_out='held')
    assert ('Only held differs' in text and '(--hold-out FLIGHT)' in text) is said


def test_the_verdict_of_nothing_known_names_no_effect(terminal, found):
    gap = replace(found.gap, without={})
    unknown, size, step, *_ = terminal(verdict=('unknown',), gap=gap).splitlines()
    assert unknown == 'verdict: unknown: no known effect explains the gap'
    assert size.startswith('The velocity error of the nominal vehicle after 0.5 s is ')
    assert '"unexplained"' in step
    none, _, step, *_ = terminal(verdict=('none',), gap=gap, fly_next=None).splitlines()
    assert none.startswith('verdict: none: the nominal vehicle explains the flights')
    assert 'the simulation matches these flights' in step
    blind = terminal(verdict=('none',), gap=gap, fly_next=None, not_shown=('wind',)).splitlines()
    assert '"would not show" may be present' in blind[2]
    assert any(line.startswith('would not show') and '(wind)' in line for line in blind)
    seen = terminal(verdict=('none',), gap=gap, fly_next=None, not_shown=())
    assert 'may be present' not in seen and 'would not show' not in seen


def test_a_vehicle_that_needs_a_clock_offset_is_not_said_to_match(terminal, page, found):
    """Without it the gap is above the tolerance, and the commands may be late instead."""
    clock = {'clock_offset': {'what': 'late', 'unit': 's', 'values': [[0.046], [0.041]],
                              'held_out': [0.039], 'hidden_delay': 0.067}}
    changes = {'verdict': ('none',), 'fly_next': None, 'nuisances': clock, 'findings': ()}
    own = found.gap.before_own

    def said(above):
        before = {name: (own[name] ** 2 + (above * tolerance) ** 2) ** 0.5
                  for name, tolerance in found.tolerance.items()}
        gap = replace(found.gap, before=before, without={})
        verdict, _, step, *_ = terminal(gap=gap, **changes).splitlines()
        return verdict, step, gap

    verdict, step, gap = said(above=1.1)
    assert step in unescape(page(gap=gap, **changes))
    assert verdict.startswith('verdict: none: the nominal vehicle, with clock_offset estimated')
    assert 'does not match' in step and '67 ms' in step and 'clock_offset' in step
    verdict, step, _ = said(above=0.9)
    assert verdict.startswith('verdict: none: the nominal vehicle explains')
    assert 'nothing; the simulation matches' in step


def test_text_from_records_is_no_markup(remaining):
    assert 'height &lt;5 m' in remaining and 'height <5 m' not in remaining


def proposal(trajectory):
    return {'purpose': 'separate', 'effects': ['wind', 'body_drag'], 'trajectory': trajectory,
            'duration': 20.0, 'seed': 0, 'span': [2.0, 2.0, 0.0], 'height': [1.0, 3.0],
            'speed': 2.0, 'now': 0.5, 'after': 12.0, 'manoeuvres': {trajectory: 12.0}}


def test_none_and_unknown_have_their_colours(page, remaining):
    assert 'tag yes">none<' in page(verdict=('none',))
    assert OPEN['verdict'] == ('rotor_drag', 'unknown') and 'tag no">unknown<' in remaining


def test_a_place_that_cannot_be_written_is_said_in_one_line(found, tmp_path, monkeypatch):
    """Without pictures, which take seconds."""
    monkeypatch.setattr(gap_page, 'drawings', lambda drawn, _: dict.fromkeys(drawn, ''))
    (tmp_path / 'file').write_text('')
    with pytest.raises(InputError, match='cannot be written'):
        gap_page.write(tmp_path / 'file' / 'page.html', found)


@pytest.fixture
def paths(flights, tmp_path):
    written = [str(tmp_path / f'{k}.csv') for k in range(len(flights))]
    for path, flight in zip(written, flights, strict=True):
        write_csv(path, flight)
    return written


def test_the_command_writes_it(paths, tmp_path, capsys):
    out = tmp_path / 'new' / 'report.html'
    assert main(['diagnose', *paths, '--vehicle', 'hummingbird', '--effects',
                 'rotor_drag,body_drag', '--report', str(out)]) == 0
    assert capsys.readouterr().out.startswith('verdict: drag of the rotors (rotor_drag), ')
    text = out.read_text(encoding='utf-8')
    assert '<h1>Sim-to-real gap of hummingbird</h1>' in text
    for path in paths:      # what the page comes from can be checked
        assert hashlib.sha256(Path(path).read_bytes()).hexdigest() in text
    assert '--effects rotor_drag,body_drag' in text
    [vehicle] = re.findall(r'<pre tabindex="0">(.*?)</pre>', text, flags=re.DOTALL)
    (tmp_path / 'again.yaml').write_text(unescape(vehicle))
    assert load_vehicle(tmp_path / 'again.yaml') == VEHICLE


def test_a_gap_within_the_tolerance_of_the_user_does_not_matter(paths, tmp_path):
    """The drag makes some 0.4 m/s; who minds no metre per second has no effect to name."""
    out = tmp_path / 'out.json'
    assert main(['diagnose', *paths, '--vehicle', 'hummingbird', '--effects', 'rotor_drag',
                 '--tolerance', 'velocity=50,position=50, attitude=50,rate=50',
                 '--json', str(out)]) == 0
    data = json.loads(out.read_text())
    assert data['verdict'] == ['none'] and data['tolerance']['velocity'] == 50.0
    assert [one['effect'] for one in data['minor']] == ['rotor_drag']


@pytest.mark.parametrize('given, said', [
    ('velocty=0.1', "'velocty' is not known here; did you mean 'velocity'"),
    ('velocity', 'expected GROUP=VALUE'), ('', 'expected GROUP=VALUE'),
    ('velocity=much', 'velocity: expected a number'), ('rate=nan', 'finite number'),
    ('velocity=-0.1', 'velocity: -0.1 is out of range'),
    ('velocity=0.1,velocity=0.2', 'velocity is given twice')])
def test_a_tolerance_that_cannot_be_used_is_refused_in_one_line(given, said, paths, capsys):
    assert main(['diagnose', *paths, '--vehicle', 'hummingbird', '--tolerance', given]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert line.startswith('quad_ident diagnose: error: --tolerance: ') and said in line


def wrench(force):
    """Return the residual of a flight with a force along x (N) at speeds from 0 to 3 m/s."""
    speed = np.linspace(0.0, 3.0, 300)
    values = np.zeros((300, 6))
    values[:, 0] = force(speed)
    return ResidualWrench(values, np.full((300, 6), 1e-3), speed,
                          {'speed': ('m/s', speed),
                           'height': ('m', np.tile([1.0, 2.0, 3.0], 100))},
                          np.zeros(300, int))


def test_the_map_shows_where_the_force_acts():
    flight = wrench(lambda speed: np.where(speed > 2.0, 1.0, 0.0))
    table = _by_third((flight,), ['speed', 'height'], VEHICLE)
    assert table.shape == (len(CHANNELS), 6)
    push = 0.5 / VEHICLE.mass       # m/s that 1 N makes in half a second
    assert table[0, 2] == pytest.approx(push, rel=1e-3) and (table[0, :2] < 0.1 * push).all()
    np.testing.assert_allclose(table[0, 3:], push / np.sqrt(3.0), rtol=0.1)
    assert not table[1:].any()      # what noise alone gives is taken off


def test_the_numbers_of_the_map_name_the_regime_of_each_row():
    flight = wrench(lambda speed: np.where(speed > 2.0, 1.0, 0.0))
    rows = map_rows((flight,), ['speed', 'height'], VEHICLE)
    assert [row[0] for row in rows] == [f'{name}, {third}' for name in ('speed', 'height')
                                        for third in ('low', 'mid', 'high')]
    assert rows[2][1:] == [f'{0.5 / VEHICLE.mass:.3g}', *['0'] * 5]


def test_the_page_has_each_cell_of_the_map_as_text_with_channel_regime_and_unit(plain, found):
    text = plain
    pictures = found.pictures
    for stage, flights in (('before', pictures.wrench_before), ('after', pictures.wrench_after)):
        caption = ('<caption>Velocity that the unexplained force and moment cause in half a '
                   f'second, {stage} the diagnosis')
        content = text[text.index(caption):].partition('</table>')[0]
        assert re.findall(r'<th scope="col"[^>]*>([^<]*)</th>', content) == [
            'regime, third', *(f'{name}, m/s' for name in CHANNELS)]
        rows = map_rows(flights, regimes(pictures.wrench_before), found.vehicle)
        assert len(rows) > 6 and content.count('<th scope="row"') == len(rows)
        for name, *cells in rows:
            assert f'{name}</th>' + ''.join(f'<td>{cell}</td>' for cell in cells) in content


def test_the_map_has_ink(tmp_path):
    save_map((wrench(lambda speed: speed),), (wrench(lambda speed: 0.0 * speed),), VEHICLE,
             tmp_path / 'map.png')
    picture = matplotlib.image.imread(tmp_path / 'map.png')
    assert picture.shape[1] > 500 and np.std(picture[..., :3]) > 0.05


def test_every_effect_has_its_probability_and_ids_are_unique(plain, found):
    text = plain
    for row in found.ranking:
        assert re.search(f'{re.escape(titled(row.effect))}</th><td class="text">'
                         f'{row.probability:.2f} <span', text)
    ids = re.findall(r'\bid="([^"]*)"', text)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r'(?:url\(|href=")#([^")]*)', text)) <= set(ids)
