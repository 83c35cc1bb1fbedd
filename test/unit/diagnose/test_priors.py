# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Priors of a fleet: their file, and what they do to a verdict."""

from dataclasses import replace

import numpy as np
import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.diagnose.candidates import candidates
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.fitted import prior_deviations
from quad_ident_ros.diagnose.frame import form_errors_of
from quad_ident_ros.diagnose.priors import EffectPrior, load_priors, write_priors
from quad_ident_ros.diagnose.probability import presence, Support
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.diagnose.standard_errors import OF_EACH
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import MOCAP_IMU
from quad_ident_ros.greybox.parameters import INDEX, prior_sizes
from quad_ident_ros.model.vehicle import load_vehicle

VEHICLE = load_vehicle('hummingbird')
DRAG = EffectPrior(0.8, {'linear': 0.7, 'axes': 0.3}, {'coefficient': 0.06}, 0.05)


def rules(**present):
    """Return Rules in which effects have these probabilities before looking."""
    return replace(RULES, priors={name: EffectPrior(value) for name, value in present.items()})


def test_a_file_is_read_as_it_was_written(tmp_path):
    """What is written is read again, to the digits that are written."""
    forms = [form.name for form in EFFECTS['rotor_drag'].forms][:2]
    prior = replace(DRAG, forms=dict(zip(forms, (0.7, 0.3), strict=True)))
    write_priors(tmp_path / 'priors.yaml', {'rotor_drag': prior, 'wind': EffectPrior(0.01)}, 20)
    assert load_priors(tmp_path / 'priors.yaml') == {'rotor_drag': prior,
                                                     'wind': EffectPrior(0.01)}


@pytest.mark.parametrize(('text', 'said'), [
    ('a: [', 'not YAML'), ('day: 2026-13-45', 'cannot be read'),
    pytest.param('[' * 2000, 'cannot be read', id='nested deeply', marks=pytest.mark.slow),
    ('a: 1\na: 2', 'twice'),
    ('schema: other', 'schema'), ('- 1', 'expected `key: value`'),
    ('schema: quad_ident/priors/2\neffects: {drag: {present: 1}}', 'drag'),
    ('schema: quad_ident/priors/2\neffects: {rotor_drag: {present: 2}}', 'out of range'),
    ('schema: quad_ident/priors/2\neffects: {rotor_drag: {}}', 'expected a number'),
    ('schema: quad_ident/priors/2\neffects: {rotor_drag: {present: 1, sizes: {mass: 1}}}', 'mass'),
    ('schema: quad_ident/priors/2\neffects: {rotor_drag: {present: 1, sizes: 3}}', 'sizes'),
    ('schema: quad_ident/priors/1\neffects: {rotor_drag: {present: 1, exactness: 0.1}}',
     'expected quad_ident/priors/2'),
    ('schema: quad_ident/priors/2\neffects: {rotor_drag: {present: 1, form_error: 2}}',
     'form_error')])
def test_a_wrong_file_is_refused_in_one_line(tmp_path, text, said, capsys):
    """The message names the file and what is wrong; the command ends with 2."""
    path = tmp_path / 'priors.yaml'
    path.write_text(text, encoding='utf-8')
    with pytest.raises(InputError, match=said) as raised:
        load_priors(path)
    assert 'priors.yaml' in str(raised.value) and '\n' not in str(raised.value)
    flight = tmp_path / 'a.csv'
    flight.write_text('t\n', encoding='utf-8')
    assert main(['diagnose', str(flight), '--vehicle', 'hummingbird', '--priors',
                 str(path)]) == 2
    assert 'priors.yaml' in capsys.readouterr().err


def test_a_missing_file_is_refused(tmp_path):
    """A file that is not there is named."""
    with pytest.raises(InputError, match='nowhere.yaml'):
        load_priors(tmp_path / 'nowhere.yaml')


def test_the_log_odds_of_an_effect_rise_by_those_of_the_fleet():
    """By Bayes' rule odds are multiplied by the odds of the fleet over the usual ones."""
    support = Support(0.2, 5.0, 0.9, {}, 6.0)
    for present in (0.01, RULES.usual_presence, 0.9):
        known = rules(rotor_drag=present)
        before, after = (presence(support, RULES),
                         presence(support, known, known.shift('rotor_drag')))
        ratio = (present / (1 - present)) / (RULES.usual_presence / (1 - RULES.usual_presence))
        assert after / (1 - after) == pytest.approx(ratio * before / (1 - before))
    assert known.shift('wind') == 0.0
    usual = rules(wind=RULES.usual_presence)
    assert usual.prior_of('wind') == pytest.approx(RULES.prior_probability)
    assert RULES.prior_of('wind') == pytest.approx(RULES.prior_probability)


def test_the_error_of_form_is_that_of_the_fleet_where_it_is_known():
    """Of the effect alone; of others and of nuisances, and at most, it is the usual one."""
    known = replace(RULES, priors={'rotor_drag': DRAG, 'wind': EffectPrior(0.5),
                                   'inflow': EffectPrior(0.5, form_error=0.3)})
    assert known.form_error_of('rotor_drag') == DRAG.form_error
    for name in ('wind', 'motor_lag', 'inflow', None):
        assert known.form_error_of(name) == RULES.form_error
    distances = {(name, (0,)): None for name in ('rotor_drag', None, 'wind')}
    assert form_errors_of(distances, known).tolist() == [DRAG.form_error, 0.2, 0.2]


def test_the_forms_of_an_effect_share_its_prior_probability():
    """Shares sum to one; a form that a fleet never had keeps a small one."""
    def shares(known):
        return {one.form: one.share for one in candidates([], VEHICLE, known, ['motor_lag'])}

    usual = shares(RULES)
    first, second = list(usual)[:2]
    found = shares(replace(RULES, priors={'motor_lag': EffectPrior(0.5, {second: 1.0})}))
    assert sum(usual.values()) == pytest.approx(1.0) == sum(found.values())
    assert found[second] > 0.8 and 0.0 < found[first] < usual[first]


def test_priors_are_as_wide_as_effects_of_the_fleet_are_large():
    """Never wider than without a fleet, never narrower than a tenth of that."""
    usual = prior_sizes(VEHICLE, RULES.prior_width)
    column = INDEX['rotor_drag.coefficient']
    for size, wide in ((1e-9, 0.1 * usual[column]), (0.4 * usual[column], 0.8 * usual[column]),
                       (1e9, usual[column])):
        known = replace(RULES, priors={'rotor_drag': EffectPrior(0.5, {}, {'coefficient': size})})
        found = prior_deviations(VEHICLE, known)
        assert found[column] == pytest.approx(wide)
        assert np.array_equal(np.delete(found, column), np.delete(usual, column))


@pytest.mark.slow
def test_a_weak_effect_is_named_unless_hardly_any_sister_has_it():
    """A drag that two short flights hardly show: its probability follows the fleet."""
    flights = [fly_closed_loop(VEHICLE, {'rotor_drag': {'coefficient': 0.008}}, name,
                               duration=8.0, seed=seed, noise=MOCAP_IMU)
               for seed, name in enumerate(('lissajous', 'figure8'))]

    def verdict(known):
        found = diagnose(flights, VEHICLE, effects=['rotor_drag', 'body_drag'], rules=known)
        return found.verdict, {row.effect: row.probability for row in found.ranking}['rotor_drag']

    usual = verdict(RULES)[1]
    assert 0.05 < usual < 0.9
    named, high = verdict(rules(rotor_drag=0.95))
    assert named == ('rotor_drag',) and high > 0.9
    unnamed, low = verdict(rules(rotor_drag=0.005))
    assert unnamed == ('none',) and low < 0.5 * usual


@pytest.mark.slow
def test_a_weak_effect_is_more_probable_beside_a_form_that_the_fleet_knows_to_be_exact():
    """Thrust of 0.8 % more beside a strong drag, whose formula flights show to be exact to 4 %."""
    truth = {'rotor_drag': {'coefficient': 0.2}, 'thrust_scale': {'factor': 1.008}}
    flights = [fly_closed_loop(VEHICLE, truth, name, duration=8.0, seed=seed, noise=MOCAP_IMU)
               for seed, name in enumerate(('lissajous', 'figure8'))]
    exact = replace(RULES, priors={'rotor_drag': EffectPrior(RULES.usual_presence,
                                                             form_error=0.03)})
    usual, known = (diagnose(flights, VEHICLE, effects=['rotor_drag', 'thrust_scale'], rules=each)
                    for each in (RULES, exact))
    before, after = ({row.effect: row.probability for row in found.ranking}['thrust_scale']
                     for found in (usual, known))
    assert known.verdict == ('rotor_drag', 'thrust_scale') and after > before + 0.05
    assert OF_EACH[np.argmax(usual.form_errors['rotor_drag'])] <= 0.05
