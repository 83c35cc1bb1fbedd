# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a fleet teaches, against a data set whose truth is known."""

from dataclasses import replace

from fleets import data_set, START, TRACKED
import numpy as np
import pytest

from quad_ident_ros.diagnose.priors import EffectPrior
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.diagnose.standard_errors import OF_EACH
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.errors import InputError

pyarrow = pytest.importorskip(
    'pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
from quad_ident_ros.fleet.grouping import rules_hash  # noqa: E402, I100
from quad_ident_ros.fleet.insight import insight  # noqa: E402, I100
from quad_ident_ros.fleet.priors import DOUBT, effects_without_priors, learned  # noqa: E402, I100
from quad_ident_ros.fleet.store import read_table, remove, write_rows  # noqa: E402, I100


@pytest.fixture(scope='module')
def taught(tmp_path_factory):
    """Return (the priors of a fleet of eight, whose every verdict has two effects)."""
    out = tmp_path_factory.mktemp('fleet')
    data_set(out)
    return learned(read_table(out, 'effects'), insight(out).histories)


def test_presence_is_the_mean_over_vehicles_with_some_doubt(taught):
    """Eight vehicles of 0.97 each, DOUBT of the usual presence; groups do not count."""
    assert taught['rotor_drag'].present == pytest.approx(
        (8 * 0.97 + DOUBT * RULES.usual_presence) / (8 + DOUBT))
    assert set(taught) == {'rotor_drag', 'com_offset'}


@pytest.mark.slow
def test_what_the_flights_of_a_vehicle_cannot_show_is_not_taken_for_absent(tmp_path):
    """Without position and velocity, drag has no row: such a vehicle says nothing of it."""
    data_set(tmp_path)
    for number in range(30):
        write_rows(tmp_path, 'effects', f'blind {number}', [{
            'group': f'blind {number}', 'vehicle': f'blind {number}', 'configuration': '',
            'date': START, 'effect': 'motor_lag', 'probability': 0.0, 'named': False}])
    found = learned(read_table(tmp_path, 'effects'), ())
    assert found['rotor_drag'].present == pytest.approx(
        (8 * 0.97 + DOUBT * RULES.usual_presence) / (8 + DOUBT))


def test_verdicts_that_used_priors_teach_none(tmp_path):
    """Also those of an earlier run on the same data set."""
    given = replace(RULES, priors={'wind': EffectPrior(0.5)})
    for name, rules, effect in (('a', RULES, 'rotor_drag'), ('b', given, 'wind')):
        whose = {'group': name, 'vehicle': name, 'configuration': '', 'date': START}
        write_rows(tmp_path, 'effects', name, [whose | {'effect': effect, 'probability': 0.9}])
        write_rows(tmp_path, 'groups', name, [whose | {
            'rules': rules_hash(rules), 'status': 'diagnosed'}])
    assert effects_without_priors(tmp_path)['effect'].to_pylist() == ['rotor_drag']
    remove(tmp_path, 'groups', 'a')
    with pytest.raises(InputError, match='nothing to learn from'):
        effects_without_priors(tmp_path)


def test_flights_that_are_all_refused_are_not_blamed_on_priors(tmp_path):
    with pytest.raises(InputError, match='no flight is diagnosed, so that there is nothing'):
        effects_without_priors(tmp_path)


@pytest.mark.slow
def test_vehicles_without_an_effect_do_not_say_how_large_it_is(tmp_path):
    """Thrust is tracked in all: a thousand that have none would leave the next no room for it."""
    data_set(tmp_path, odd=[('uav7', 'thrust_scale', 'factor', -0.2)])
    for number in range(8):
        name = f'uav{number + 1}'
        write_rows(tmp_path, 'effects', name, [{
            'group': f'{name}-0', 'vehicle': name, 'configuration': '', 'date': START,
            'effect': 'thrust_scale', 'probability': float(number == 6), 'form': 'factor',
            'named': number == 6}])
    found = learned(read_table(tmp_path, 'effects'), insight(tmp_path).histories)
    assert found['thrust_scale'].sizes['factor'] == pytest.approx(0.2, abs=0.03)


@pytest.mark.slow
def test_sizes_are_those_of_the_vehicles(taught):
    """How far the parameters usually are from no effect, of drag of one sign and of an offset."""
    _, mean, spread, _ = TRACKED['rotor_drag', 'coefficient']
    assert taught['rotor_drag'].sizes['coefficient'] == pytest.approx(mean, abs=2 * spread)
    assert taught['com_offset'].sizes['x'] == pytest.approx(5e-4, rel=0.6)


def taught_form_error(errors, groups=1):
    """
    Return the form_error that a fleet teaches whose formula is wrong by such relative errors.

    Args: errors (V, K): of each second of the flights of a vehicle, each known to 0.01; groups: of
    a vehicle, with the same errors.
    """
    squares = np.array(OF_EACH)[:, None] ** 2 + 1e-4
    rows = [{'vehicle': f'uav{vehicle}', 'effect': 'rotor_drag', 'probability': 1.0, 'named': True,
             'form': 'by_speed', 'form_errors': -0.5 * np.sum(
                 some ** 2 / squares + np.log(squares), axis=1)}
            for vehicle, some in enumerate(np.asarray(errors)) for _ in range(groups)]
    rows.append(rows[0] | {'named': False, 'form_errors': -1e6 * np.arange(len(OF_EACH))})
    rows.append(rows[0] | {'vehicle': 'of an older version', 'form_errors': None})
    return learned(pyarrow.Table.from_pylist(rows), ())['rotor_drag'].form_error


@pytest.mark.parametrize('form_error', [0.04, 0.06, 0.16, 0.3])
def test_the_error_of_form_is_that_of_the_fleet(form_error):
    """Of verdicts that name the effect, by a data set that knows it."""
    rng = np.random.default_rng(1)
    found = taught_form_error(form_error * rng.standard_normal((12, 20)))
    assert found == pytest.approx(form_error, rel=0.4)      # the sizes tried are apart by 2


def test_flights_that_say_little_leave_the_usual_error_of_form(taught):
    """One vehicle with a second of flight; groups of a vehicle say no more than one of them."""
    assert taught_form_error(np.full((1, 1), 0.05)) == pytest.approx(RULES.form_error, rel=0.5)
    rng = np.random.default_rng(2)
    errors = 0.03 * rng.standard_normal((1, 5))
    once = taught_form_error(errors)
    assert taught_form_error(errors, groups=40) == pytest.approx(once)
    assert once > 1.2 * taught_form_error(np.repeat(errors, 40, axis=0))
    assert taught['rotor_drag'].form_error is None


def test_forms_that_were_named_are_likelier(taught):
    """All vehicles name the usual form: its share is more than before, the others have some."""
    forms = taught['rotor_drag'].forms
    assert sum(forms.values()) == pytest.approx(1.0)
    assert forms[EFFECTS['rotor_drag'].forms[0].name] > RULES.usual_form
    assert min(forms.values()) > 0.0
