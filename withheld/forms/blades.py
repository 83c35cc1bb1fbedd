# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Blades that stall or that the flow leaves, rotors in descent, disks that their inflow tilts."""

import numpy as np

from withheld.constants import arm_length, hover_speed, induced_velocity
from withheld.forms.air import Thrust
from withheld.forms.body import signs
from withheld.influence import Influence


def swept(forward):
    """Return the induced velocity in level flight over that in hover; forward over it, too."""
    square = 0.5 * forward ** 2
    return np.sqrt(np.sqrt(square ** 2 + 1.0) - square)


class Pitched(Thrust):
    """
    A propeller of high pitch, whose blades are stalled at rest: only a climb takes thrust.

    Charts of propellers are flat over the advance ratio until the blades unstall, and then fall
    evenly (B. W. McCormick, Aerodynamics, Aeronautics, and Flight Mechanics, 1995, chapter 6).
    Across, the advancing blade gains.
    """

    UNSTALLS, WIDE = 0.06, 0.04     # of the induced velocity, upwards: where, and within how much

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        hubs = now.hubs() / (self.induced * turn[:, None])
        across = np.minimum(hubs[:, 0] ** 2 + hubs[:, 1] ** 2, 4.0)
        falls = self._fall(np.clip(hubs[:, 2], -3.0, 3.0)) - self._fall(0.0)
        return 1.0 + self.size * (0.008 * across - 0.09 * falls)

    def _fall(self, climb):
        return self.WIDE * np.logaddexp(0.0, np.clip(
            (climb - self.UNSTALLS) / self.WIDE, -100.0, 100.0))


class Descending(Thrust):
    """
    Rotors with the induced velocity that was measured in descent, where momentum theory fails.

    The curve of the fourth order that J. G. Leishman fits (Principles of Helicopter Aerodynamics,
    2006, section 2.13): it is well above that of momentum theory, so that a slow descent adds
    hardly any thrust. In level flight the induced velocity falls as theory has it.
    """

    CURVE = (-0.655, -1.718, -1.372, -1.125, 1.0)

    def gain(self, now):
        """Return the factors."""
        turn = np.maximum(now.speeds / self.hover, 0.2)
        hubs = now.hubs() / (self.induced * turn[:, None])
        climb, forward = hubs[:, 2], np.hypot(hubs[:, 0], hubs[:, 1])
        flow = swept(forward) * np.where(
            climb < 0.0, np.polyval(self.CURVE, np.clip(climb, -2.0, 0.0)),
            np.sqrt(0.25 * climb ** 2 + 1.0) - 0.5 * climb)
        return 1.0 - 0.08 * self.size * np.clip(climb + flow - 1.0, -3.0, 3.0)


class Bubble(Influence):
    """
    Blades from which the flow parts below a speed, and to which it clings again above.

    A bubble of laminar flow that bursts at low Reynolds numbers: T. J. Mueller, J. D. DeLaurier,
    Aerodynamics of small vehicles, Annual Review of Fluid Mechanics 35, 2003.
    """

    STEP, WIDE = 0.8, 0.05      # of the factor that it is about, either way; of the hover speed

    def __init__(self, size, params, rng):
        """Draw whether it is more or less on the whole, and where the step is."""
        self.share = 0.007 * size * float(signs(rng, 1)[0])
        self.step = 0.007 * size * self.STEP
        self.hover, self.middle = hover_speed(params), rng.uniform(0.97, 1.03)
        self.parameters = {'share': self.share}

    def gain(self, now):
        """Return the factors."""
        return 1.0 + self.share + self.step * np.tanh(
            (now.speeds / self.hover - self.middle) / self.WIDE)


class ThroughFlow(Influence):
    """
    Disks that tilt with the velocity, and less so the more air flows through them.

    Flapping backwards with the pitch of the blades less the inflow (Bramwell's Helicopter
    Dynamics, 2001, chapter 3): a climb makes it less, a descent or forward flight more. The
    blades' own centrifugal force is what holds them, so the moment goes with the speed.
    """

    PART = 0.8          # of the moment in hover, what the inflow takes away there

    def __init__(self, size, params, rng):
        """Set the moment per velocity, and the induced velocity in hover, m/s."""
        self.moment = 0.002 * size * params['mass'] * arm_length(params)
        self.parameters = {'coefficient': self.moment}
        self.hover, self.count = hover_speed(params), params['num_rotors']
        self.induced = induced_velocity(params)

    def wrench(self, now):
        """Return the moment of all rotors."""
        turn = np.maximum(now.speeds / self.hover, 0.1)
        hubs = now.hubs()
        x, y, z = (hubs / (self.induced * turn[:, None])).T
        less = np.clip(z + swept(np.hypot(x, y)) - 1.0, -1.0, 1.0)
        share = self.moment / self.count * turn * (1.0 - self.PART * less)
        return np.zeros(3), np.array([-share @ hubs[:, 1], share @ hubs[:, 0], 0.0])
