# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Which effects are followed from flight to flight."""

import pytest

pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
import pyarrow  # noqa: E402, I100

from quad_ident_ros.fleet.track import tracked_effects  # noqa: E402, I100


def tracked(**named):
    """Return the effects tracked of vehicles, by {vehicle: names, one for each group's}."""
    rows = [{'vehicle': vehicle, 'effect': name, 'form': 'any', 'named': True}
            for vehicle, names in named.items() for name in names.split()]
    found = tracked_effects(pyarrow.Table.from_pylist(rows))
    return {vehicle: set(effects) for vehicle, effects in found.items()}


@pytest.mark.parametrize(('own', 'kept'), [
    ('rotor_fault rotor_fault', set()), ('mass_offset', set()), ('motor_lag', {'motor_lag'})])
def test_what_looks_like_an_effect_of_the_fleet_is_tracked_as_that(own, kept):
    """A weak rotor moves a vehicle as an offset of the centre of mass, a mass as less thrust."""
    usual = 'com_offset thrust_scale'
    found = tracked(a=usual, b=usual, c=usual, d=f'com_offset {own}')
    assert found['d'] == {'com_offset', 'thrust_scale'} | kept
    assert found['a'] == {'com_offset', 'thrust_scale'}


def test_of_two_alike_the_one_that_is_named_more_often_is_tracked():
    """Where no other vehicle has either, the verdicts decide."""
    found = tracked(a='com_offset rotor_fault rotor_fault', b='motor_lag', c='motor_lag')
    assert found['a'] == {'rotor_fault', 'motor_lag'}
