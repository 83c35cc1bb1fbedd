# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Propellers behind magnets and copper, and propellers that are driven by oil under pressure."""

import numpy as np

from withheld.forms.clutches import LoosePropellers


class SlowerPropellers(LoosePropellers):
    """Propellers that always turn somewhat more slowly than their hubs."""

    SLOWS = 1.5         # 1/s, of the drag at the speed of hover

    def wrench(self, now):
        """Return the moment; begin with the slip of hover."""
        if self._blades is None:
            self._blades = (1.0 - self.slip()) * now.speeds
        return super().wrench(now)

    def slip(self):
        """Return the slip in hover, of the speed."""
        raise NotImplementedError


class Eddied(SlowerPropellers):
    """
    Propellers behind magnets that face a disk of copper: eddies take them along, with some slip.

    The torque has a peak, and beyond that slip it falls again, since the eddies weaken the field.
    W. R. Smythe, On eddy currents in a rotating disk, Transactions of the AIEE 61(9), 1942. As
    where motors are sealed from water or spray, in practice.
    """

    HOLDS, PEAK = 3.0, 0.3      # of the torque in hover, at most; of the speed, the slip there

    def slip(self):
        """Return the slip in hover, of the speed."""
        return self.PEAK * (self.HOLDS - np.sqrt(self.HOLDS ** 2 - 1.0))

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        slip = (self._hubs - self._blades) / (self.PEAK * self.hover)
        torque = 2.0 * self.HOLDS * slip / (1.0 + slip ** 2)
        return self.SLOWS * self.hover * (torque - (self._blades / self.hover) ** 2)


class Hydraulic(SlowerPropellers):
    """
    Propellers that oil drives: pumps on the motors, and hoses to other motors at the propellers.

    Hoses and oil yield as a spring does, some oil leaks past, a valve lets off what is too much,
    and nothing pulls where there is no pressure. H. E. Merritt, Hydraulic Control Systems, 1967.
    As vehicles with an engine and heavy loads have it in practice.
    """

    RATE, SLIP = 2.0 * np.pi * 5.0, 0.03        # rad/s; of the speed in hover, by the leak
    MOST = 2.5                                  # of the torque in hover, at the valve

    def begin(self, rng):
        """Start in balance."""
        super().begin(rng)
        self._pull = None

    def slip(self):
        """Return the slip in hover, of the speed."""
        return self.SLIP

    def _slope(self):
        """Return the slopes (n,) of the speeds of the propellers, rad/s^2."""
        drag = self.SLOWS / self.hover * self._blades ** 2
        if self._pull is None:
            self._pull = drag
        return self._pull - drag

    def _follow(self, step):
        super()._follow(step)
        flow = self._hubs - self._blades - self.SLIP / self.SLOWS * self._pull
        self._pull = np.clip(self._pull + step * self.RATE ** 2 * flow,
                             0.0, self.MOST * self.SLOWS * self.hover)
