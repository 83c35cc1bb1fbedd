# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Integration of many rollouts at once, from given states, along recorded or planned commands."""

from collections.abc import Callable
import math

import numpy as np

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.registry import ROWS_OF, SLICES, TABLE
from quad_ident_ros.model.actuators import is_followed, shares
from quad_ident_ros.model.rigid_body import derivative, prepare, STATE
from quad_ident_ros.model.situation import (
    FULL,
    GUIDE,
    GUIDE_BEGIN,
    GUIDED,
    PER_IZ,
    PER_XZ,
    PER_YZ,
    PER_ZZ,
    ROTOR_ROWS,
    SPEED,
    SPIN_UP,
    SPUN,
    STAGE,
    TIME,
    VOLT_DROP,
    VOLT_SHARE,
)

LAG = SLICES['motor_lag'].start
# Where s says whether rotors have momentum, alike or by their spin.
ALIKE, BY_SPIN = (ROWS_OF['rotor_gyro', form] for form in ('momentum', 'momentum_by_spin'))
# Rows of work[3] after the shares of begin, middle and end: one over the lag, and what of the
# moment by which the rotors' speeds change no lag gives.
RATE, CHANGE = 3, 4


@compiled(fused=True, inlined=True)
def _set_speeds(share: np.ndarray, speed: np.ndarray, command: np.ndarray, added: np.ndarray,
                period_rate: np.ndarray, change: np.ndarray, s: np.ndarray, rotors: np.ndarray
                ) -> None:
    """
    Set the speeds that lie between `speed` and `command`, and the moment by which they change.

    share (LANES,) of the gap remains.
    """
    for i in range(s.shape[1]):
        s[SPIN_UP, i] = change[i]
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            gap = (speed[j, i] - command[j, i]) * share[i]
            rotors[j, SPEED, i] = command[j, i] + gap + added[j, i]
            s[SPIN_UP, i] -= rotors[j, SPUN, i] * gap * period_rate[i]


@compiled(fused=True, inlined=True)
def take_up(x: np.ndarray, speed: np.ndarray, command: np.ndarray, span: np.ndarray,
            theta: np.ndarray, s: np.ndarray, rotors: np.ndarray, work: np.ndarray) -> None:
    """
    Hand the momentum of rotors that change their speed without a lag of their own to the body.

    Those that jump do so at once, which turns the states x (13, LANES); those whose speeds are
    followed elsewhere (model.actuators) evenly over span (LANES,) s, which is written into work.
    """
    change = work[3, CHANGE]
    for i in range(s.shape[1]):
        change[i] = 0.0
    if s[ALIKE, 0] != 0.0 or s[BY_SPIN, 0] != 0.0:
        for j in range(rotors.shape[0]):
            for i in range(s.shape[1]):
                if theta[LAG, i] == 0.0:
                    change[i] += rotors[j, SPUN, i] * (command[j, i] - speed[j, i])
        for i in range(s.shape[1]):
            if is_followed(theta[:, i]):
                change[i] /= span[i]
            else:
                if s[FULL, 0] != 0.0:
                    x[10, i] += change[i] * s[PER_XZ, i]
                    x[11, i] += change[i] * s[PER_YZ, i]
                    x[12, i] += change[i] * s[PER_ZZ, i]
                else:
                    x[12, i] += change[i] * s[PER_IZ, i]
                change[i] = 0.0


@compiled(fused=True, inlined=True)
def step(x: np.ndarray, h: np.ndarray, u: np.ndarray, v: np.ndarray, places: np.ndarray,
         theta: np.ndarray, speed: np.ndarray, command: np.ndarray, added: np.ndarray,
         lag: np.ndarray, s: np.ndarray, rotors: np.ndarray, work: np.ndarray) -> None:
    """
    Advance the states x (13, LANES) by h (LANES,) s; speed becomes that at the end.

    What is added, (3, n, LANES), to the speeds at begin, middle and end is so for this step alone;
    work has what take_up wrote.
    """
    k, y, total = work[0], work[1], work[2]
    rate, change = work[3, RATE], work[3, CHANGE]
    for i in range(s.shape[1]):
        rate[i] = 1.0 / lag[i] if lag[i] > 0.0 else 0.0
        work[3, 0, i], work[3, 1, i], work[3, 2, i] = shares(h[i], lag[i])
        s[VOLT_DROP, i], s[VOLT_SHARE, i] = u[5, i], u[6, i]
    for n in range(STATE):
        for i in range(s.shape[1]):
            total[n, i], y[n, i] = 0.0, x[n, i]
    # One call of the derivative, which is long: it is compiled once.
    for stage in range(4):
        place = (stage + 1) // 2    # begin, middle, middle, end
        if stage != 2:
            for i in range(s.shape[1]):
                s[STAGE, i] = 0.5 * place
                s[TIME, i] += 0.5 * h[i] if stage else 0.0
            _set_speeds(work[3, place], speed, command, added[place], rate, change, s, rotors)
        derivative(y, u, v, places, theta, s, rotors, k)
        weight = 2.0 if place == 1 else 1.0
        ahead = 1.0 if stage == 2 else 0.5
        for n in range(STATE):
            for i in range(s.shape[1]):
                total[n, i] += weight * k[n, i]
                y[n, i] = x[n, i] + ahead * h[i] * k[n, i]
    for n in range(STATE):
        for i in range(s.shape[1]):
            x[n, i] += h[i] / 6.0 * total[n, i]
    for i in range(s.shape[1]):
        norm = 1.0 / math.sqrt(x[6, i] ** 2 + x[7, i] ** 2 + x[8, i] ** 2 + x[9, i] ** 2)
        for n in range(6, 10):
            x[n, i] *= norm
    for j in range(rotors.shape[0]):
        for i in range(s.shape[1]):
            speed[j, i] = rotors[j, SPEED, i] - added[2, j, i]


def _kernel(lanes: int) -> Callable[..., None]:
    """Return the integrator that does so many rollouts side by side."""
    @compiled(fused=True)
    def roll_out(vehicles: np.ndarray, places: np.ndarray, thetas: np.ndarray, which: np.ndarray,
                 x0: np.ndarray, t: np.ndarray, followed: np.ndarray, speeds: np.ndarray,
                 added: np.ndarray, law: np.ndarray, inputs: np.ndarray, first: np.ndarray,
                 count: int, substeps: int, guides: np.ndarray, guide_of: np.ndarray,
                 out: np.ndarray) -> None:
        """
        Integrate rollouts by Runge-Kutta and write their states into out (B, count + 1, 13).

        Args: vehicles (T, 19), places: see rigid_body; thetas (T, P) parameter sets; which (B,)
        the set of each rollout; x0 (B, 13) states at the start; t (N,) s; followed, speeds
        (A, N, n), added (A, N, 3, n) to each step from a sample on, law (T,) of each parameter
        set: see actuators; inputs (N, INPUT or more), what else acts; first (B,) the sample at
        which a rollout starts; count of samples; substeps per sample, 1 where anything is added or
        guided; guides (G, N, GUIDE): quaternions and rates that a record gives, to which the
        centre of mass moves instead of by the predicted ones; without any, G is 0; guide_of (T,)
        the guide of each parameter set.
        """
        rotor_count = places.shape[0]
        x = np.empty((STATE, lanes))
        work = np.empty((4, STATE, lanes))
        s = np.zeros((TABLE, lanes))
        rotors = np.zeros((rotor_count, ROTOR_ROWS, lanes))
        theta = np.empty((thetas.shape[1], lanes))
        v = np.empty((vehicles.shape[1], lanes))
        u = np.zeros((inputs.shape[1], lanes))
        speed = np.empty((rotor_count, lanes))
        command = np.empty((rotor_count, lanes))
        extra = np.empty((3, rotor_count, lanes))
        h, span = np.empty(lanes), np.empty(lanes)
        batch = x0.shape[0]
        for begin in range(0, batch, lanes):
            for i in range(lanes):
                b = min(begin + i, batch - 1)
                for n in range(STATE):
                    x[n, i] = x0[b, n]
                    out[b, 0, n] = x0[b, n]
                for n in range(v.shape[0]):
                    v[n, i] = vehicles[which[b], n]
                for n in range(thetas.shape[1]):
                    theta[n, i] = thetas[which[b], n]
                # Without lag the rotors still turn as before the command given there.
                before = first[b] > 0 and thetas[which[b], LAG] == 0.0
                for j in range(rotor_count):
                    speed[j, i] = (followed[law[which[b]], first[b] - 1, j] if before else
                                   speeds[law[which[b]], first[b], j])
            prepare(v, places, theta, s, rotors)
            for i in range(lanes):
                s[GUIDED, i] = 1.0 if guides.shape[0] else 0.0
            for k in range(count):
                for i in range(lanes):
                    b = min(begin + i, batch - 1)
                    row = first[b] + k
                    s[TIME, i] = t[row]
                    span[i] = t[row + 1] - t[row]
                    h[i] = span[i] / substeps
                    acting = law[which[b]]
                    for j in range(rotor_count):
                        command[j, i] = followed[acting, row, j]
                        for place in range(3):
                            extra[place, j, i] = added[acting, row, place, j]
                    for n in range(inputs.shape[1]):
                        u[n, i] = inputs[row, n]
                    if guides.shape[0]:
                        lead = guide_of[which[b]]
                        for n in range(2 * GUIDE):
                            s[GUIDE_BEGIN + n, i] = guides[lead, row + n // GUIDE, n % GUIDE]
                take_up(x, speed, command, span, theta, s, rotors, work)
                for _ in range(substeps):
                    step(x, h, u, v, places, theta, speed, command, extra, theta[LAG], s, rotors,
                         work)
                for i in range(min(lanes, batch - begin)):
                    for n in range(STATE):
                        out[begin + i, k + 1, n] = x[n, i]

    return roll_out


roll_out = _kernel(32)
roll_out_one = _kernel(1)
