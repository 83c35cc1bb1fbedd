# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag of a cage of thin rods."""

import numpy as np

from withheld.forms.air import Drag


class Caged(Drag):
    """
    A body in a cage of thin rods, as for flights in tanks and tunnels: it is alike all around.

    Rods drag by more than the square of the speed has it where they are slow, by the fit of F. M.
    White, Viscous Fluid Flow, 2006, chapter 3: 1 + 10 Re^(-2/3) for a cylinder.
    """

    beside = ('rotor_drag',)            # slow, it is less than the square
    SHARE, SLOW = 0.65, 10.0            # of the coefficient, when fast; of the fit
    THICK, VISCOSITY = 0.0012, 1.5e-5   # m, of the rods; m^2/s, of air

    def law(self, now):
        """Return what the coefficient is of."""
        speed = float(np.linalg.norm(now.air))
        slow = self.SLOW * (self.VISCOSITY / self.THICK) ** (2.0 / 3.0) * speed ** (1.0 / 3.0)
        return self.SHARE * (speed + slow) * now.air
