# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles of one make, and how verdicts with and without its priors are compared."""

import numpy as np
import pytest

from quad_ident_ros.effects.registry import EFFECTS, vector
from quad_ident_ros.model.vehicle import load_vehicle
from withheld.fleet.gain import compared, no_worse
from withheld.fleet.make import NOMINAL
from withheld.fleet.sisters import fly, make_of, OFTEN, vehicle_of

VEHICLE = load_vehicle(NOMINAL)


def test_vehicles_of_a_make_have_its_effects_as_often_as_it_says():
    """Effects come with their shares, never others, with values that a vehicle file may have."""
    rng = np.random.default_rng(1)
    make = make_of(VEHICLE, rng)
    drawn = [vehicle_of(make, rng) for _ in range(300)]
    for name, (share, _) in make.items():
        assert np.mean([name in one for one in drawn]) == pytest.approx(share, abs=0.09)
    assert {name for one in drawn for name in one} <= set(make) and len(make) == len(OFTEN)
    for one in drawn[:50]:
        vector(one, VEHICLE)    # raises InputError where a value is out of bounds


def test_logs_have_no_word_of_the_effects(tmp_path):
    """Neither names nor numbers of effects are in what the diagnosis is given."""
    rng = np.random.default_rng(2)
    truth = fly(tmp_path / 'tried', ['uav01'], make_of(VEHICLE, rng), VEHICLE, rng)
    files = [path for path in tmp_path.rglob('*') if path.is_file()]
    assert len(files) == 3 and list(truth) == ['uav01']
    text = ''.join(path.read_text(encoding='utf-8') for path in files)
    assert not [name for name in (*EFFECTS, 'seed') if name in text]


TRUTH = {'a': ['rotor_drag'], 'b': [], 'c': ['motor_lag', 'com_offset']}
RIGHT = {'a': {'verdict': {'rotor_drag'}, 'minor': set(), 'probability': {'rotor_drag': 0.9}},
         'b': {'verdict': {'none'}, 'minor': set(), 'probability': {'wind': 0.1}},
         'c': {'verdict': {'motor_lag'}, 'minor': {'com_offset'},
               'probability': {'motor_lag': 0.9, 'com_offset': 0.8}}}
WRONG = RIGHT | {'a': {'verdict': {'wind'}, 'minor': set(),
                       'probability': {'rotor_drag': 0.2, 'wind': 0.7}}}


def test_a_comparison_counts_sets_and_probabilities():
    """A minor effect is named, a wrong verdict is missed and false; errors grow with mistakes."""
    result = compared(TRUTH, RIGHT, WRONG)['measures']
    assert result['exact']['without'] == 1.0
    assert result['exact']['with'] == pytest.approx(2 / 3)
    assert result['missed']['with'] == result['false']['with'] == pytest.approx(1 / 3)
    assert result['log']['change'] > 0.0 and result['square']['change'] > 0.0
    assert result['square']['without'] == pytest.approx(
        (0.1 ** 2 + 0.1 ** 2 + 0.1 ** 2 + 0.2 ** 2) / 3 / len(EFFECTS), rel=0.01)


def test_the_comparison_ends_badly_where_verdicts_get_worse():
    """More exact sets than before are good, fewer in many vehicles are not."""
    many = {f'{name}{k}': value for k in range(20) for name, value in TRUTH.items()}
    right, wrong = ({f'{name}{k}': value for k in range(20) for name, value in found.items()}
                    for found in (RIGHT, WRONG))
    assert no_worse(compared(many, wrong, right)) and no_worse(compared(many, right, right))
    assert not no_worse(compared(many, right, wrong))


def test_a_vehicle_without_a_verdict_counts_as_wrong():
    """What was refused has no effect named and no probability."""
    result = compared(TRUTH, RIGHT, {})['measures']
    assert result['exact']['with'] == 0.0 and result['missed']['with'] == pytest.approx(4 / 3)
