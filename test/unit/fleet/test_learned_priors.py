# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a fleet teaches, against a data set whose truth is known."""

from fleets import data_set, TRACKED
import pytest

from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.effects.registry import EFFECTS

pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
from quad_ident_ros.fleet.insight import insight  # noqa: E402, I100
from quad_ident_ros.fleet.priors import DOUBT, learned  # noqa: E402, I100
from quad_ident_ros.fleet.store import read_table  # noqa: E402, I100


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
