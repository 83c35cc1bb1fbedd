# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulation of the vehicle under given inputs."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.model import attitude, equations, mixing

MODELS = {'newton_euler': equations.NEWTON_EULER, 'paper': equations.PRINTED}

# Longest integration step, s. The errors that they leave are stated in docs/paper.md and shown
# by test/unit/test_golden.py: the printed equations are stiff and chaotic, the derived are not.
LONGEST_STEP = {'newton_euler': 1e-4, 'paper': 1e-5}

STEPS_AT_ONCE = 1_000_000   # integrated before a signal or a cancel can act: about 0.3 s

RATE_LIMIT = 1e6  # rad/s; beyond it a run counts as diverged
MOST_STEPS = 10 ** 9    # of the integration: some minutes


@dataclass(frozen=True)
class Simulation:
    """What a run gave: its record, 'complete' or 'diverged', the time (s) at which it ended."""

    record: FlightRecord
    status: str
    end_time: float


def simulate(vehicle, model, inputs, period, *, omega_r=0.0, altitude=0.0, step=None, info=None,
             on_progress=lambda share: None):
    """
    Fly the vehicle from rest, level, under inputs that are held between samples.

    Args: model 'newton_euler' or 'paper'; inputs (N, 4) U1..U4 in N, N, N, N m; period s between
    samples; omega_r rad/s, a number or (N,); altitude m at the start; step s, the longest
    integration step (LONGEST_STEP[model] if None); info is kept with the record; on_progress is
    called now and then with the share done, and what it raises ends the simulation.
    Returns a Simulation whose record has N rows, or fewer where the run diverged.
    Raises InputError where it diverged within the first sample, or where the inputs are no
    numbers.
    """
    # Copies: a read-only array would have the integrator compiled anew.
    inputs = np.array(inputs, float, order='C')
    if inputs.ndim != 2 or inputs.shape[1] != 4 or len(inputs) < 2:
        raise InputError(f'inputs: expected an array (N >= 2, 4), got {inputs.shape}')
    if not np.isfinite(inputs).all():
        raise InputError(f'inputs: row {int(np.argmin(np.isfinite(inputs).all(axis=1)))} '
                         'holds a value that is no finite number')
    number = MODELS[model]
    step = step or LONGEST_STEP[model]
    if period / step * len(inputs) > MOST_STEPS:
        raise InputError(f'{len(inputs)} samples of {period:g} s at a step of {step:g} s are more '
                         f'than {MOST_STEPS:.0e} steps: shorten the run or lengthen the step')
    substeps = max(1, int(np.ceil(period / step - 1e-9)))
    x = np.zeros(equations.STATE_SIZE[number])
    x[2] = altitude
    if number == equations.NEWTON_EULER:
        x[6] = 1.0
    states = np.empty((len(inputs), x.size))
    speeds = np.array(np.broadcast_to(np.asarray(omega_r, float), (len(inputs),)), order='C')
    parameters = equations.parameter_vector(vehicle)
    rows = max(1, STEPS_AT_ONCE // substeps)
    first = 0
    while first < len(inputs) - 1:
        on_progress(first / len(inputs))
        part = slice(first, first + rows + 1)
        done, time = equations.rk4(number, x, inputs[part], speeds[part], parameters, period,
                                   substeps, RATE_LIMIT, states[part])
        count, end = first + done, first * period + time
        if done < len(inputs[part]):
            break
        first += rows
    if count < 2:
        raise InputError(f'the {model} model diverges at t = {end:.6g} s, before the second '
                         f'sample: shorten the sample period ({period:g} s) or the inputs')
    columns = _columns(number, states[:count], inputs[:count])
    record = FlightRecord(np.arange(count) * period, columns, dict(info or {}))
    return Simulation(record, 'complete' if count == len(inputs) else 'diverged', float(end))


def _columns(model, states, inputs):
    if model == equations.NEWTON_EULER:
        quaternion = states[:, 6:10]
        euler = attitude.unwrap_euler(attitude.euler_from_quaternion(quaternion))
        rate = states[:, 10:13]
    else:
        euler = states[:, 6:9]
        quaternion = attitude.quaternion_from_euler(euler)
        rate = attitude.body_rate(euler, states[:, 9:12])
    table = np.hstack([states[:, :6], quaternion, rate, inputs, euler])
    return dict(zip(STATE_COLUMNS, table.T, strict=True))


STATE_COLUMNS = ('px', 'py', 'pz', 'vx', 'vy', 'vz', 'qw', 'qx', 'qy', 'qz', 'wx', 'wy', 'wz',
                 'u1', 'u2', 'u3', 'u4', 'phi', 'theta', 'psi')


def omega_r_of(setting, vehicle, inputs, t, sign=1):
    """
    Return Omega_r for a setting: 'zero', 'from_rotors' or a number of rad/s.

    `sign` +1 keeps eq. (11) as printed, -1 turns it (errata: its sign contradicts eq. (9)).
    Raises InputError where the speeds are to come from rotors that cannot give the inputs.
    """
    if setting == 'zero':
        return 0.0
    if setting == 'from_rotors':
        problem = mixing.infeasibility(vehicle, inputs, t)
        if problem:
            raise InputError(f'omega_r: from_rotors needs feasible inputs, but {problem}; '
                             'take zero or a number')
        return sign * mixing.residual_rotor_speed(vehicle, inputs)
    return sign * float(setting)
