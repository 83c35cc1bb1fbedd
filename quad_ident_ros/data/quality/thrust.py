# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether the commands give about the thrust by which the vehicle flies."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.data.cutting import without
from quad_ident_ros.data.quality import rotors, units
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.series import Grid
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.signal_kind import described, kinds_of, LINEAR
from quad_ident_ros.data.thrust_level import BY_LOG, FULL_SPEED, mass_to_carry
from quad_ident_ros.model.motors import are_thrusts, KINDS
from quad_ident_ros.model.vehicle import Vehicle

APART = 10.0      # times too much or too little: no vehicle file is that wrong,
OTHER = 2.0       # times by which no scale, thrust stand or battery is off: it is another vehicle
LONGEST = 1.0     # s in all, in which motors may still follow
MOVING = 0.2      # m/s: what stands on the ground needs no thrust
FLYING = 0.5      # of the weight, from which on a thrust is needed
SLOWLY = 0.3      # s: motors lag less, and noise of a derived velocity is less
FOLLOWS = 0.9     # correlation of needed with given thrust, in whose slope noise hardly counts
STEEP = 1.2       # times too steep or flat: drag and inflow make less of it
CLEARER = 3.0     # times nearer in its slope, the logarithm, another reading is the right one
NEAR = 1.6        # times too much or too little thrust that the right one gives at most


def level(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find commands whose scale is that by which thrust carries the weight."""
    if FULL_SPEED not in record.info:
        return []
    what, remedy = ((
        'the thrust coefficient is not known; it is set by the log',
        'give the vehicle file a thrust_coefficient that was measured')
        if record.info.get(BY_LOG) else (
        'the rotor speed at full signal is not known; it is set to '
        f'{record.info[FULL_SPEED]:.4g} rad/s',
        'give the vehicle file motors: with a gain, or speed_max'))
    return [Finding(
        'thrust_level', 'warning', 'commands',
        f'{what}, so that thrust carries the weight on average: a constant factor of thrust, and '
        'a mass that is off, are not visible and not named; inertia and drag are given in '
        'proportion to the mass', remedy)]


def carried(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find flights that the commands do not explain: they give far less thrust, or far more."""
    thrust = _Thrust.of(record, vehicle)
    if thrust is None or vehicle is None:
        return []
    names, grid, found = record.numbered('cmd'), thrust.grid, []
    for bad, what in ((thrust.given * APART < thrust.needed, 'less than a tenth of'),
                      (thrust.given > APART * thrust.needed, 'more than ten times')):
        off = thrust.flying & bad
        if off.sum() * grid.period > LONGEST:
            found.append(Finding(
                'thrust', 'error', f'{names[0]} to {names[-1]}, t = {grid.t[off][0]:.3f} s',
                f'for {off.sum() * grid.period:.1f} s the commands give {what} the thrust by '
                f'which {vehicle.name} flies: they are stuck, belong to something else, or the '
                'vehicle file is of another vehicle',
                without(grid.t, bad, 'record the commands that the rotors follow in rad/s, and '
                        'give the thrust coefficient in N/(rad/s)^2'
                        + _or_signals(record, vehicle))))
    return found


def other_vehicle(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find vehicle files of another vehicle: its thrust is off by a factor, its rotors may be."""
    thrust = _Thrust.of(record, vehicle)
    if (thrust is None or vehicle is None
            or thrust.flying.sum() * thrust.grid.period < LONGEST):
        return []
    ratio = float(np.median(thrust.given[thrust.flying] / thrust.needed[thrust.flying]))
    if 1.0 / OTHER < ratio < OTHER or not 1.0 / APART < ratio < APART:
        return []
    wrong = rotors.order_and_spin(record, vehicle)
    signals = bool(record.info.get('commands'))
    more = ', and they turn the body as rotors in other places would' if wrong else ''
    return [Finding(
        'other_vehicle', 'error' if wrong else 'warning', 'vehicle file',
        f'the commands give {ratio:.2g} times the thrust with which {vehicle.name} flies{more}: '
        'mass, thrust coefficient and inertia seem to be those of another vehicle'
        + (', or its rotors turn at other speeds by these signals' if signals else ''),
        'name the vehicle that flew with --vehicle, or weigh it and measure its thrust'
        + ('; or give the map from signals to speeds, of which the finding commands has the one '
           'used, as `motors` in the vehicle file or `actuators` of a mapping' if signals else '')
        + (f'; or {units.OF_ROTORS}' if are_thrusts(vehicle.motors) else '')
        + _or_signals(record, vehicle))]


def _or_signals(record: FlightRecord, vehicle: Vehicle) -> str:
    """Return what to do where commands that were recorded as speeds are signals, '' if not."""
    names = record.numbered('cmd')
    if record.info.get('commands'):     # they were made of signals
        return ''
    kinds = [kind for kind in kinds_of(record.stack(*names), vehicle.hover_speed,
                                       (vehicle.speed_min, vehicle.speed_max)) if KINDS[kind]]
    if len(kinds) != 1:
        return ''
    return (f'; if they are signals to the motors ({described(kinds[0])}, by their size), name '
            f'their columns output1 to output{len(names)}')


def curve(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """
    Find signals to the motors that are shares of thrust and were taken for shares of speed.

    Taken so, they would carry the vehicle, and thrust would follow them as it should; as they were
    taken, it is too flat or too steep.
    """
    readings, thrust = record.info.get(LINEAR, ()), _Thrust.of(record, vehicle)
    if not readings or thrust is None or vehicle is None:
        return []
    # Where no file has the speed at full signal, the weight determines it, for any reading.
    level = record.info.get(FULL_SPEED)
    low, high = vehicle.speed_min, level or vehicle.speed_max
    if not np.isfinite(high):
        return []
    share = (thrust.grid.held(*record.numbered('cmd')) - low) / (high - low)
    slope = thrust.fit(thrust.given)[0]
    if not np.isfinite(slope) or 1.0 / STEEP < slope < STEEP:
        return []
    for kind, least, factor in readings:
        squared = low ** 2 + np.clip(least + factor * share, 0, 1) * (high ** 2 - low ** 2)
        right, ratio = thrust.fit(thrust.per_speed * np.sum(squared, axis=1))
        if (CLEARER * abs(np.log(right)) < abs(np.log(slope))
                and (level or 1.0 / NEAR < ratio < NEAR)):
            return [Finding(
                'thrust_curve', 'error', 'commands',
                f'thrust does not follow the square of the rotor speeds (its changes are '
                f'{slope:.2g} times as large), but the signals themselves: they are shares of '
                'thrust, not of speed',
                f'say so in a mapping (--mapping): actuators: {{kind: {kind}, curve: thrust}}, or '
                f'in the vehicle file: motors: {{kind: {kind}, thrust: {{exponent: 1}}}}; where '
                'rotors turn at the lowest signal, give the file their speed there, speed_min')]
    return []


@dataclass(frozen=True, eq=False)
class _Thrust:
    """
    Thrust over mass (N,) m/s^2 at the times of a grid: given, needed, and where it flies.

    per_speed: thrust over mass of one rotor over its speed squared.
    """

    grid: Grid
    given: np.ndarray
    needed: np.ndarray
    flying: np.ndarray
    per_speed: float

    def fit(self, given: np.ndarray) -> tuple[float, float]:
        """
        Return how much more steeply the needed thrust changes than one given, and their ratio.

        Slopes are of logarithms, nan where they do not tell.
        """
        use = self.flying & (given > 0)
        if use.sum() * self.grid.period < LONGEST:
            return float('nan'), 0.0
        one, other = (np.log(self.grid.smooth(values[:, None], SLOWLY)[use, 0])
                      for values in (np.maximum(self.needed, 1e-9), np.maximum(given, 1e-9)))
        both = np.cov(one, other)
        scale = float(np.sqrt(both[0, 0] * both[1, 1]))
        told = scale > 0.0 and both[0, 1] > FOLLOWS * scale
        return (float(np.sqrt(both[0, 0] / both[1, 1])) if told else float('nan'),
                float(np.exp(np.median(other - one))))

    @classmethod
    def of(cls, record: FlightRecord, vehicle: Vehicle | None) -> '_Thrust | None':
        """Return that of a record with commands and velocity, None where units are off."""
        names, grid = record.numbered('cmd'), Grid.of(record)
        if (vehicle is None or grid is None or not names or not record.has('vx', 'vy', 'vz')
                or units.speeds_in_rpm(record, vehicle)
                or units.position_in_millimetres(record, vehicle)):
            return None
        velocity = grid.signal('vx', 'vy', 'vz')
        needed = np.linalg.norm(grid.derivative(velocity) + [0.0, 0.0, vehicle.gravity], axis=1)
        speed = np.linalg.norm(grid.smooth(velocity), axis=1)
        per_speed = vehicle.thrust_coefficient / mass_to_carry(vehicle)
        given = per_speed * np.sum(grid.held(*names) ** 2, axis=1)
        return cls(grid, given, needed, grid.good & (speed > MOVING)
                   & (needed > FLYING * vehicle.gravity), per_speed)
