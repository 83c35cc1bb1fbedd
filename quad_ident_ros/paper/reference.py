# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the simulated responses must be: reference values and exact solutions."""

import numpy as np

# The four unit steps at once, from rest: phi, theta, psi (rad) and z (m) by time (s). Adaptive
# integrators (Radau and DOP853 at rtol 1e-8 and 1e-10) agree on the digits written here.
UNIT_STEPS = {
    'paper': {0.05: (.054383418, .02768125, 1.1663499, -.010334457),
              0.1: (-7.3300893, -16.395710, -4.0092130, -.041856193),
              1.0: (-6.63003, -17.278757, -3981.276, -4.795288),
              5.0: (-6.264577, -17.278726, -14367.37, -121.83080)},
    'newton_euler': {5.0: (.3487337538, .0694080022, 197.9126925, -104.3602190)},
}


def turned(moment, inertia, drag, t):
    """
    Return the angle (rad) after t s of a constant moment from rest, with friction K w|w|.

    Args: moment N m; inertia kg m^2; drag K, N m s^2. It is V tau ln cosh(t/tau) with
    V = sqrt(M/K), tau = I/sqrt(M K).
    """
    speed, tau = np.sqrt(moment / drag), inertia / np.sqrt(moment * drag)
    return float(speed * tau * (np.logaddexp(t / tau, -t / tau) - np.log(2.0)))


def climbed(force, mass, drag, t):
    """
    Return the height (m) after t s of a constant force from rest, with friction k v.

    Args: force N beyond the weight; mass kg; drag k, N s/m.
    """
    share = drag / mass * t
    return float(force / drag * t * (1.0 + np.expm1(-share) / share))


def blow_up(moment, inertia, drag):
    """
    Return the time (s) at which friction that pushes on has made the rate infinite.

    From w' = (M + K w^2)/I: w = sqrt(M/K) tan(t sqrt(M K)/I), which ends at a quarter turn. Args
    as in turned, all positive.
    """
    return float(np.pi / 2 * inertia / np.sqrt(moment * drag))
