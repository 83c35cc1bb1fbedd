# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicle files as one has them: every constant is a little off."""

import copy

import numpy as np

# Standard deviations of the logarithms: what a ruler, a pendulum, a thrust stand leave open.
SPREADS = {'torque_coefficient': 0.05, 'arms': 0.03, 'inertia_x': 0.05, 'inertia_y': 0.05,
           'inertia_z': 0.05, 'linear_drag': 0.2, 'rotor_radius': 0.03}
FARTHEST = 2.0      # standard deviations: nobody leaves more than that


def misread(params, rng):
    """
    Return rotorpy's parameters as a file has them, and {constant: its factor on the true one}.

    Mass, thrust coefficient and gravity are right: an error of these is an effect.
    """
    factors = {name: float(np.exp(spread * np.clip(rng.normal(), -FARTHEST, FARTHEST)))
               for name, spread in SPREADS.items()}
    told = copy.deepcopy(params)
    told['k_m'] *= factors['torque_coefficient']
    told['rotor_pos'] = {name: factors['arms'] * np.asarray(place)
                         for name, place in params['rotor_pos'].items()}
    for axis in 'xyz':
        told[f'I{axis}{axis}'] *= factors[f'inertia_{axis}']
    told['linear_drag'] = factors['linear_drag'] * params['linear_drag']
    told['rotor_radius'] *= factors['rotor_radius']
    return told, factors
