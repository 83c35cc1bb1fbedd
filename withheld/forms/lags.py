# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of rotors whose blades are hinged to fold."""

import numpy as np

from withheld.forms.air import Drag


class HingedBlades(Drag):
    """
    In-plane force of folding propellers, whose hinges hold by friction up to some force.

    Level flow pulls at the blades once each turn, and by more where they turn fast. Tight hinges
    hand that on to the hub; once they slip, the blades swing in the plane of the disk, and keep
    most of what is beyond from it, as their own frequency is far below that of the turn. A. R. S.
    Bramwell, Helicopter Dynamics, 2001; as on vehicles that fold for the pocket.
    """

    HOLDS = 1.1         # m/s, of flow at the speed of hover
    FREES = 0.7         # of what is beyond: what the hub does not feel

    def wrench(self, now):
        """Return force and moment."""
        turn, level = now.speeds / self.hover, now.hubs() * [1.0, 1.0, 0.0]
        pull = turn * np.linalg.norm(level, axis=1)
        beyond = np.maximum(1.0 - self.HOLDS / np.maximum(pull, 1e-9), 0.0)
        share = self.coefficient / len(turn) * turn * (1.0 - self.FREES * beyond)
        forces = -share[:, None] * level
        return forces.sum(axis=0), np.cross(now.places, forces).sum(axis=0)
