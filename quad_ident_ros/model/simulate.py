# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Simulation of the vehicle under given inputs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.effects import registry
from quad_ident_ros.errors import InputError
from quad_ident_ros.model import attitude, equations, mixing
from quad_ident_ros.model.actuators import actuated, FOLLOWED, without_lag
from quad_ident_ros.model.residual_in_flight import smoothed
from quad_ident_ros.model.rigid_body import (
    INPUT,
    rotor_table,
    STATE,
    vehicle_vector,
    with_residual,
)
from quad_ident_ros.model.rollout import roll_out_one
from quad_ident_ros.model.sensors import NO_GUIDE, recorded
from quad_ident_ros.model.vehicle import Vehicle

Progress: TypeAlias = Callable[[float], object]
Flown: TypeAlias = tuple[dict[str, np.ndarray], float]
"""Columns of a record and the time at which it ends, s."""

# Longest integration step, s. The errors that they leave are stated in docs/paper.md and shown by
# test/unit/model/test_golden.py: the printed equations are stiff and chaotic, the derived are not.
LONGEST_STEP = {'newton_euler': 1e-4, 'paper': 1e-5}

STEPS_AT_ONCE = 1_000_000   # integrated before a signal or a cancel can act: about 0.5 s

RATE_LIMIT = 1e6  # rad/s; beyond it a run counts as diverged
MOST_STEPS = 10 ** 9    # of the integration: some minutes
# s, of speeds that model.actuators follows: what they drive is then right to fifth order in it.
FOLLOWED_STEP = 1e-3


@dataclass(frozen=True)
class Simulation:
    """What a run gave: its record, 'complete' or 'diverged', the time (s) at which it ended."""

    record: FlightRecord
    status: str
    end_time: float


def simulate(vehicle: Vehicle, model: str, inputs: ArrayLike, period: float, *,
             omega_r: ArrayLike = 0.0, altitude: float = 0.0, step: float | None = None,
             info: Mapping[str, Any] | None = None,
             on_progress: Progress = lambda share: None) -> Simulation:
    """
    Fly the vehicle from rest, level, under inputs that are held between samples.

    Args: model 'newton_euler' or 'paper'; inputs (N, 4) U1..U4 in N, N, N, N m; period s between
    samples; omega_r rad/s, a number or (N,); altitude m at the start; step s, the longest
    integration step (LONGEST_STEP[model] if None); info is kept with the record; on_progress is
    called now and then with the share done, and what it raises ends the simulation.
    Effects of the vehicle that act on rotors have U1..U4 flown by rotor speeds, which are then
    recorded as commands and take the place of omega_r.
    Returns a Simulation whose record has N rows, or fewer where the run diverged.
    Raises InputError where it diverged within the first sample, where the inputs are no numbers,
    or where the effects need rotors that cannot give them.
    """
    # Copies: for a read-only array the integrator would be compiled again.
    inputs = np.array(inputs, float, order='C')
    if inputs.ndim != 2 or inputs.shape[1] != 4 or len(inputs) < 2:
        raise InputError(f'inputs: expected an array (N >= 2, 4), got {inputs.shape}')
    if not np.isfinite(inputs).all():
        raise InputError(f'inputs: row {int(np.argmin(np.isfinite(inputs).all(axis=1)))} '
                         'holds a value that is not a finite number')
    step = step or LONGEST_STEP[model]
    if period / step * len(inputs) > MOST_STEPS:
        raise InputError(f'{len(inputs)} samples of {period:g} s at a step of {step:g} s are more '
                         f'than {MOST_STEPS:.0e} steps: shorten the run or lengthen the step')
    substeps = max(1, int(np.ceil(period / step - 1e-9)))
    speeds = np.array(np.broadcast_to(np.asarray(omega_r, float), (len(inputs),)), order='C')
    columns, end = MODELS[model](vehicle, inputs, speeds, period, substeps, altitude, on_progress)
    count = len(columns['px'])
    if count < 2:
        raise InputError(f'the {model} model diverges at t = {end:.6g} s, before the second '
                         f'sample: shorten the sample period ({period:g} s) or the inputs')
    record = FlightRecord(np.arange(count) * period, columns, dict(info or {}))
    return Simulation(record, 'complete' if count == len(inputs) else 'diverged', float(end))


def _newton_euler(vehicle: Vehicle, inputs: np.ndarray, omega_r: np.ndarray, period: float,
                  substeps: int, altitude: float, on_progress: Progress) -> Flown:
    """Fly the vehicle model with the vehicle's effects; linear drag is along world axes."""
    stamps = np.arange(len(inputs)) * period
    theta = registry.vector(vehicle.effects, vehicle)
    commands, others = _acting(vehicle, theta, inputs, omega_r, stamps)
    # Delayed commands may change within a sample: then there are two intervals to each.
    within = theta[registry.SLICES['actuation_delay'].start] % period
    between = 1e-9 * period < within < (1.0 - 1e-9) * period
    by_law = theta[FOLLOWED].any()
    every = 2 if between else 1
    t = np.sort(np.append(stamps, stamps[:-1] + within)) if between else stamps
    if by_law:
        every = int(np.ceil(period / FOLLOWED_STEP - 1e-9))
        t = np.append((stamps[:-1, None] + period / every * np.arange(every)).ravel(), stamps[-1])
    others = np.repeat(others, every, axis=0)
    acted = actuated(t, stamps, commands, theta[None])
    if vehicle.residual is not None:
        before = smoothed(t, stamps, commands, rotor_table(vehicle), vehicle.thrust_coefficient,
                          vehicle.torque_coefficient)
        others = np.concatenate([others[:len(t)], before], axis=1)
    constants = with_residual(vehicle_vector(vehicle, drag_in_world=True), vehicle)[None]
    places = rotor_table(vehicle)[:commands.shape[1]]
    acting, one = without_lag(theta[None]), np.zeros(1, np.int64)

    def advance(part: np.ndarray, first: int, t: np.ndarray, substeps: int) -> None:
        """Integrate from the state part[0], at the sample first, and write what comes after it."""
        roll_out_one(constants, places, acting, one, part[:1].copy(), t, *acted, others,
                     np.array([first]), len(part) - 1, substeps, *NO_GUIDE, part[None])

    states = np.zeros((len(t), STATE))
    states[0, 2], states[0, 6] = altitude, 1.0
    states[0, :3] += theta[registry.SLICES['com_offset']]
    count, end = len(t), t[-1]
    rows = every * max(1, STEPS_AT_ONCE // substeps)
    substeps = 1 if by_law else int(np.ceil(np.diff(t[:3]).max() / period * substeps - 1e-9))
    for first in range(0, len(t) - 1, rows):
        on_progress(first / len(t))
        part = states[first:first + rows + 1]
        advance(part, first, t, substeps)
        lost = _lost(part)
        if lost.any():
            count = first + int(np.argmax(lost))
            # The step of this sample at which it is lost: by bisection, for it stays so.
            kept, gone = 0, substeps
            step, clock = (t[count] - t[count - 1]) / substeps, t.copy()
            while gone - kept > 1:
                half = (kept + gone) // 2
                pair = states[[count - 1, count]]
                clock[count] = t[count - 1] + half * step
                advance(pair, count - 1, clock, half)
                kept, gone = (kept, half) if _lost(pair)[1] else (half, gone)
            end = t[count - 1] + gone * step
            break
    states = recorded(theta, states[:count:every])
    count = len(states)
    euler = attitude.unwrap_euler(attitude.euler_from_quaternion(states[:, 6:10]))
    columns = _columns(states[:, :6], states[:, 6:10], states[:, 10:], inputs[:count], euler)
    columns |= {f'cmd{j}': values[:count] for j, values in enumerate(commands.T.copy(), 1)}
    return columns, end


def _acting(vehicle: Vehicle, theta: np.ndarray, inputs: np.ndarray, omega_r: np.ndarray,
            t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """
    Return what acts: commands of the rotors (N, n), n = 0 where none are needed, and the rest.

    Writes the inertia of the rotors into theta where they are to turn. Raises InputError.
    """
    others = np.zeros((len(t), INPUT))
    if omega_r.any() and not any(theta[registry.PLACES['rotor_gyro', form.name]].any()
                                 for form in registry.EFFECTS['rotor_gyro'].forms):
        theta[registry.SLICES['rotor_gyro']] = vehicle.rotor_inertia
    names = list(dict.fromkeys(
        name for name, form in registry.FORMS if form.on_rotors and name in vehicle.effects
        and (theta != registry.NULL)[registry.PLACES[name, form.name]].any()))
    names += ['residual'] if vehicle.residual is not None else []
    if names:
        problem = mixing.infeasibility(vehicle, inputs, t)
        if problem:
            raise InputError(f'vehicle {vehicle.name}: its effects {", ".join(names)} act on '
                             f'rotors, but {problem}')
        return np.sqrt(np.maximum(mixing.squared_speeds(vehicle, inputs), 0.0)), others
    arm = vehicle.arm_length
    others[:, :4] = inputs * [1.0, arm, arm, 1.0]
    # A rotor turns against its reaction torque: the errata's sign is the other one.
    others[:, 4] = -omega_r
    return np.empty((len(t), 0)), others


def _lost(states: np.ndarray) -> np.ndarray:
    """Say which states (N, 13) are beyond the limit of rates or no numbers, (N,)."""
    within = (np.abs(states[:, 10:]) <= RATE_LIMIT).all(axis=1)
    return ~(within & np.isfinite(states).all(axis=1))


def _printed(vehicle: Vehicle, inputs: np.ndarray, omega_r: np.ndarray, period: float,
             substeps: int, altitude: float, on_progress: Progress) -> Flown:
    """Fly the equations as the paper prints them."""
    if vehicle.effects:
        raise InputError(f'vehicle {vehicle.name}: the equations as printed know no effects; fly '
                         'the model newton_euler, or take the effects out of the vehicle file')
    if vehicle.residual is not None:
        raise InputError(f'vehicle {vehicle.name}: the equations as printed know no residual; fly '
                         'the model newton_euler, or take it out of the vehicle file')
    if any(vehicle.products):
        raise InputError(f'vehicle {vehicle.name}: the equations as printed know moments of '
                         'inertia alone; fly the model newton_euler, or give inertia: '
                         '[Ixx, Iyy, Izz] in the vehicle file')
    x = np.zeros(equations.STATE)
    x[2] = altitude
    states = np.empty((len(inputs), equations.STATE))
    parameters = equations.parameter_vector(vehicle)
    rows = max(1, STEPS_AT_ONCE // substeps)
    for first in range(0, len(inputs) - 1, rows):
        on_progress(first / len(inputs))
        part = slice(first, first + rows + 1)
        done, time = equations.rk4(x, inputs[part], omega_r[part], parameters, period, substeps,
                                   RATE_LIMIT, states[part])
        if done < len(inputs[part]):
            break
    count, end = first + done, first * period + time
    states = states[:count]
    euler = states[:, 6:9]
    return _columns(states[:, :6], attitude.quaternion_from_euler(euler),
                    attitude.body_rate(euler, states[:, 9:]), inputs[:count], euler), end


MODELS = {'newton_euler': _newton_euler, 'paper': _printed}
STATE_COLUMNS = ('px', 'py', 'pz', 'vx', 'vy', 'vz', 'qw', 'qx', 'qy', 'qz', 'wx', 'wy', 'wz',
                 'u1', 'u2', 'u3', 'u4', 'phi', 'theta', 'psi')


def _columns(*parts: np.ndarray) -> dict[str, np.ndarray]:
    """Return the columns of a record of parts of the table of its state, (N, ...) each."""
    return dict(zip(STATE_COLUMNS, np.hstack(parts).T, strict=True))


def omega_r_of(setting: str | float, vehicle: Vehicle, inputs: np.ndarray, t: np.ndarray,
               sign: int = 1) -> float | np.ndarray:
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
