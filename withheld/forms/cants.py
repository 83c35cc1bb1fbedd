# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motors that are canted for the sake of the heading."""

import numpy as np

from withheld.forms.leans import Leaning


class Canted(Leaning):
    """
    Motors that are canted around the arms, so that their thrust helps to turn the heading.

    Each leans across its arm, to the side to which its own reaction turns the body, and its
    momentum leans along: what changes the speeds of rotors on opposite sides also rolls and
    pitches the body. S. Rajappa, M. Ryll, H. H. Buelthoff, A. Franchi, Modeling, control and
    design optimization for a fully-actuated hexarotor aerial vehicle with tilted propellers, ICRA
    2015; some degrees of it are usual where yaw is weak. What it does to the thrust is in the
    file.
    """

    CANT = 0.15         # rad

    def __init__(self, size, params, rng):
        """Set the axes."""
        super().__init__(size, params, rng)
        places = np.array(list(params['rotor_pos'].values()))
        up = np.array([0.0, 0.0, 1.0])
        around = np.cross(up, places)
        around /= np.linalg.norm(around, axis=1)[:, None]
        self.axes = np.cos(self.CANT) * up + np.sin(self.CANT) * self.spins[:, None] * around
