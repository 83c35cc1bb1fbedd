# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a fleet teaches, against a data set whose truth is known."""

from dataclasses import replace

from fleets import data_set, START, TRACKED
import pytest

from quad_ident_ros.diagnose.priors import EffectPrior
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.errors import InputError

pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
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


def test_sizes_are_those_of_the_vehicles(taught):
    """How far the parameters usually are from no effect, of drag of one sign and of an offset."""
    _, mean, spread, _ = TRACKED['rotor_drag', 'coefficient']
    assert taught['rotor_drag'].sizes['coefficient'] == pytest.approx(mean, abs=2 * spread)
    assert taught['com_offset'].sizes['x'] == pytest.approx(5e-4, rel=0.6)


def test_exactness_is_the_scatter_between_flights_over_the_effect(taught):
    """The drag scatters by 1 in 60 from flight to flight."""
    _, mean, _, scatter = TRACKED['rotor_drag', 'coefficient']
    assert taught['rotor_drag'].exactness == pytest.approx(scatter / mean, rel=0.3)


def test_forms_that_were_named_are_likelier(taught):
    """All vehicles name the usual form: its share is more than before, the others have some."""
    forms = taught['rotor_drag'].forms
    assert sum(forms.values()) == pytest.approx(1.0)
    assert forms[EFFECTS['rotor_drag'].forms[0].name] > RULES.usual_form
    assert min(forms.values()) > 0.0
