# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Realities drawn at random: any effect, the same by the same seed, and all of them fly."""

import pytest

from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.flight.hidden_effect import draw_reality
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle

SEEDS = range(150)
NOMINAL = load_vehicle('hummingbird')
DRAWN = {seed: draw_reality(NOMINAL, seed).effects for seed in SEEDS}


def test_a_seed_is_a_reality():
    assert draw_reality(NOMINAL, 7).effects == DRAWN[7]
    assert len({str(effects) for effects in DRAWN.values()}) == len(SEEDS)


def test_every_effect_is_drawn_and_one_at_a_time():
    assert {name for effects in DRAWN.values() for name in effects} == set(EFFECTS)
    for effects in DRAWN.values():
        assert len(effects) == 1 or set(effects) == {'wind', 'rotor_drag'}


def test_a_weak_rotor_is_drawn_in_either_form():
    names = {name.rpartition('_')[0] for effects in DRAWN.values()
             for name in effects.get('rotor_fault', {})}
    assert names == {'loss', 'loss_both'}


def test_only_the_effects_differ_and_a_file_holds_them(tmp_path):
    for seed in (0, 1, 2):
        reality = draw_reality(NOMINAL, seed)
        write_vehicle(tmp_path / 'reality.yaml', reality)
        assert load_vehicle(tmp_path / 'reality.yaml') == reality
        assert (reality.name, reality.mass) == (NOMINAL.name, NOMINAL.mass)


@pytest.mark.slow
@pytest.mark.parametrize('name', EFFECTS)
def test_what_is_drawn_can_be_flown(name):
    experiment = load_experiment('closed_loop')
    effects = next(effects for effects in DRAWN.values() if name in effects)
    flown = experiment.with_effects(effects)
    for run in flown.runs:
        assert fly(flown, run, seed=1).status == 'complete'
