# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A reality drawn at random: the nominal vehicle with a hidden effect."""

from dataclasses import replace

import numpy as np

from quad_ident_ros.effects.base import Effect
from quad_ident_ros.effects.registry import (
    bounds,
    EFFECTS,
    mapping,
    NULL,
    PARAMETERS,
    PLACE,
    SLICES,
    Values,
)
from quad_ident_ros.model.vehicle import Vehicle

STRENGTHS = 1.5, 2.5    # of the usual size of a parameter


def draw_reality(vehicle: Vehicle, seed: int) -> Vehicle:
    """
    Return a vehicle with one effect, drawn with its parameters by a seed.

    Wind comes with a drag of the rotors, for a vehicle without drag does not feel it.
    """
    rng = np.random.default_rng([seed, 5])
    name = str(rng.choice(list(EFFECTS)))
    names = [name, 'rotor_drag'] if EFFECTS[name].needs_air else [name]
    effects: Values = {}
    for each in names:
        effects |= mapping(strengthened(EFFECTS[each], vehicle, rng))
    return replace(vehicle, effects=effects)


def strengthened(effect: Effect, vehicle: Vehicle, rng: np.random.Generator) -> np.ndarray:
    """
    Return the parameter vector (P,) of an effect, some usual sizes of each parameter.

    It is in its usual form; one of single rotors is in any form, and of one of them.
    """
    low, high, size = bounds(vehicle)
    places = np.arange(len(PARAMETERS))[SLICES[effect.name]]
    if effect.per_rotor:
        form = effect.forms[rng.integers(len(effect.forms))]
        chosen = effect.parameters_of(form, len(vehicle.rotors))
        places = np.array([PLACE[effect.name, chosen[rng.integers(len(chosen))].name]])
    theta = NULL.copy()
    for place in places:
        step = rng.uniform(*STRENGTHS) * size[place]
        # A weak rotor is no strong one, whatever an estimate of it may be.
        both = low[place] < NULL[place] - step and not effect.per_rotor
        theta[place] += step * (rng.choice([-1, 1]) if both else 1)
    return np.clip(theta, low, high)
