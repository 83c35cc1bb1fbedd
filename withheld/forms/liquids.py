# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers with a liquid in a ring, and propellers with free wheels in their wake."""

import numpy as np

from withheld.forms.clutches import PartlyLoosePropellers


class Filled(PartlyLoosePropellers):
    """
    Propellers with a ring of liquid each, which balances them and turns along a little later.

    The liquid comes along by what flows over the walls, the sooner the faster it turns: H. P.
    Greenspan, The Theory of Rotating Fluids, 1968. Such rings: J. P. Den Hartog, Mechanical
    Vibrations, 1956, on Leblanc's balancer.
    """

    OWN, TIME = 0.2, 0.2        # of the inertia, without the liquid; s, at the speed of hover

    def _slope(self):
        """Return the slopes (n,) of the speeds of the liquid, rad/s^2."""
        root = np.sqrt(np.maximum(self._blades, 0.0) / self.hover)
        return root * (self._hubs - self._blades) / self.TIME


class Wheeled(PartlyLoosePropellers):
    """
    Propellers below which a free wheel turns in the wake, that takes the swirl out of it.

    The wake spins it, and not the motor: the body feels what its momentum resists, but not what
    changes its speed. O. Grim, Propeller and vane wheel, Journal of Ship Research 24(4), 1980.
    """

    OWN, TIME = 0.2, 0.3        # of the momentum in hover, of the propeller; s, there

    def wrench(self, now):
        """Return the moment that it takes to turn the axes of the wheels along."""
        force, (x, y, _) = super().wrench(now)
        return force, np.array([x, y, 0.0])

    def _slope(self):
        """Return the slopes (n,) of the speeds of the wheels, of their ratio, rad/s^2."""
        # A wake that is faster is there sooner.
        return self._hubs / self.hover * (self._hubs - self._blades) / self.TIME
