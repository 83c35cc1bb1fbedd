# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether the rotors carry the vehicle; their number, order and spin, by what commands do."""

from dataclasses import dataclass
from itertools import permutations, product

import numpy as np

from quad_ident_ros.data.once import once
from quad_ident_ros.data.quality import frames
from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.series import Grid
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.vehicle import hover_fault, Vehicle

SURE, BETTER = 0.5, 0.2   # mean correlation that an explanation needs, and its lead
SLOW = 1.0                # s; what changes more slowly is trim, aerodynamics and battery
# Yaw answers its commands weakly. Over TURN the reaction to the acceleration of the rotors and the
# noise of the rate average out; headings change within some seconds.
TURN, TURNS = 0.3, 3.0    # s
CHANCE = 4.0              # standard errors of a correlation of noise (one over the root of the
                          # number of independent samples)
PART = 0.5                # of the correlation of the best spins, from which on others may be
                          # right: two wrong ones of four have none of it, of six a third
LATEST = 0.08             # s, motors follow their commands within; clocks are as far apart
ROUNDING = 1e-12          # of a power: less counts as 0
COMPACT, WIDE = 0.01, 3.0   # moments of inertia over mass arm^2, beyond which no vehicle is built:
                            # those of known quadrotors lie between 0.16 and 0.32
SPARSE, SOLID = 0.01, 2e4   # kg/m^3, mass over arm^3: human-powered helicopters (AeroVelo's Atlas,
                            # 128 kg with its pilot, arms of 13 m) have 0.06, tungsten 19,300
MOST_ROTORS = 6           # of which all orders are tried


def count(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find more or fewer columns cmd1..N than the vehicle has rotors, and numbers left out."""
    names = record.numbered('cmd')
    if vehicle is None or len(names) == len(vehicle.rotors):
        return []
    wanted = [f'cmd{j}' for j in range(1, len(vehicle.rotors) + 1)]
    if any(map(record.has, wanted[len(names):])):
        missing = [name for name in wanted if not record.has(name)]
        return [Finding(
            'rotor_count', 'error', ', '.join(missing),
            f'missing: the record has the commands of {len(wanted) - len(missing)} of the '
            f'{len(wanted)} rotors of {vehicle.name}',
            'add them, or leave out all columns cmd1, cmd2, ... so that measured rotor speeds '
            'drive the model')]
    if not names:
        return []
    return [Finding(
        'rotor_count', 'error', f'{names[0]} to {names[-1]}',
        f'the record has the commands of {len(names)} rotors, {vehicle.name} has '
        f'{len(vehicle.rotors)}', 'name the vehicle that flew, or the columns cmd1, cmd2, ...')]


def hover(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find vehicle files whose vehicle could not hover."""
    fault = hover_fault(vehicle) if vehicle is not None else None
    return [Finding('hover', 'error', 'vehicle file', *fault)] if fault else []


def size(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find vehicle files whose mass, arms and moments of inertia do not go with each other."""
    if vehicle is None or not vehicle.arm_length > 0.0:
        return []
    shares = np.array(vehicle.inertia[:2]) / (vehicle.mass * vehicle.arm_length ** 2)
    if COMPACT < shares.min() and shares.max() < WIDE:
        # All in units of one kind, as kg, cm and kg cm^2: no size is impossible, but its weight.
        dense = vehicle.mass / vehicle.arm_length ** 3
        if SPARSE < dense < SOLID:
            return []
        return [Finding(
            'vehicle_size', 'error', 'vehicle file',
            f'{vehicle.mass:.3g} kg with arms of {vehicle.arm_length:.3g} m are '
            + (f'{dense:.2g} kg/m^3, less than any vehicle that flies' if dense <= SPARSE else
               f'{dense:.2g} kg/m^3, more than solid metal') + '; usual are 50 to 500',
            'give the mass in kg, the positions of the rotors in m and the inertia in kg m^2')]
    return [Finding(
        'vehicle_size', 'error', 'vehicle file',
        f'the moments of inertia about x and y are {shares[0]:.2g} and {shares[1]:.2g} times mass '
        f'times arm length squared, with arms of {vehicle.arm_length:.3g} m; usual are 0.1 to 0.5',
        'give the mass in kg, the positions of the rotors in m and the inertia in kg m^2')]


def order_and_spin(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """
    Find columns cmd1..N that are not in the vehicle file's order, and spins that are not as in it.

    The moment on the body, I dw/dt + w x I w, is correlated with what the squared commands give
    for each order (roll and pitch), then for each choice of spins (yaw).
    """
    told = _evidence(record, vehicle)
    return [] if told is None or vehicle is None else _wrong(told, vehicle)


def confirmed(record: FlightRecord, vehicle: Vehicle | None) -> tuple[str, ...]:
    """
    Return the codes of Findings that a flight speaks against: it shows what the vehicle file says.

    A flight that hardly yaws shows the order of the rotors, but not their spins.
    """
    told = _evidence(record, vehicle)
    if (told is None or vehicle is None or told.scores[told.declared] < SURE
            or _wrong(told, vehicle)):
        return ()
    yaws = told.spins[tuple(rotor.spin for rotor in vehicle.rotors)] >= told.sure
    return ('rotor_order', 'other_vehicle', *(('rotor_spin',) if yaws else ()))


def _wrong(told: '_Evidence', vehicle: Vehicle) -> list[Finding]:
    """Return the Findings on the order and the spins by what a flight says of them."""
    scores, declared = told.scores, told.declared
    best = max(scores, key=scores.__getitem__)
    if scores[best] < SURE:
        return []
    if scores[best] > scores[declared] + BETTER:
        return [Finding(
            'rotor_order', 'error', f'cmd1 to cmd{len(declared)}',
            f'the commands turn the body as rotors {", ".join(str(k + 1) for k in best)} of '
            f'{vehicle.name} would (correlation {scores[best]:.2f}, as they are '
            f'{scores[declared]:.2f})',
            'put the commands into the order of the vehicle file, or correct that; for outputs in '
            'the order of the log a mapping does it: actuators with kind and order: '
            f'{[best.index(k) + 1 for k in range(len(best))]}')]
    return _spin(told, vehicle)


@dataclass(frozen=True, eq=False)
class _Evidence:
    """
    What a flight says of the order of its rotors, and of their spins.

    scores {order: mean correlation of roll and pitch at the lag that suits it}; declared: the
    order of the vehicle file; spins {spins: correlation of yaw at the lag of the best order}, and
    sure, the correlation that these need.
    """

    scores: dict[tuple[int, ...], float]
    declared: tuple[int, ...]
    spins: dict[tuple[int, ...], float]
    sure: float


@once
def _evidence(record: FlightRecord, vehicle: Vehicle | None) -> _Evidence | None:
    """Return the _Evidence of a record, None where it cannot be held against the vehicle file."""
    names = record.numbered('cmd')
    grid = Grid.of(record)
    if (vehicle is None or grid is None or not record.has('wx', 'wy', 'wz')
            or not len(names) == len(vehicle.rotors) <= MOST_ROTORS):
        return None
    if frames.quaternion(record, vehicle) or frames.world(record, vehicle):
        return None   # rates about other axes: that is to be mended first
    rate = grid.smooth(grid.signal('wx', 'wy', 'wz'))
    inertia = vehicle.inertia_matrix
    moment = (np.gradient(rate, grid.period, axis=0) @ inertia
              + np.cross(rate, rate @ inertia))
    squared = grid.smooth(grid.held(*names) ** 2)
    position = np.array([rotor.position for rotor in vehicle.rotors])
    fast, most = (_fast(grid, moment), _fast(grid, squared)), round(LATEST / grid.period)
    by_lag = {lag: _scores(grid, *fast, position, lag) for lag in range(-most, most + 1)}
    # Each order where it fits best: at the lag of another one a good order may fit badly.
    scores = {order: max(one[order] for one in by_lag.values()) for order in by_lag[0]}
    lag = max(by_lag, key=lambda one: max(by_lag[one].values()))
    return _Evidence(scores, tuple(range(len(names))), _spin_scores(grid, moment, squared, lag),
                     _sure(grid))


def _fast(grid: Grid, signal: np.ndarray, slow: float = SLOW) -> np.ndarray:
    return signal - grid.smooth(signal, slow)


def _scores(grid: Grid, moment: np.ndarray, squared: np.ndarray, position: np.ndarray, lag: int
            ) -> dict[tuple[int, ...], float]:
    """Return {order: mean correlation over roll and pitch} at a lag."""
    target, drive = _aligned(grid, moment[:, :2], squared, lag)
    # Moments of thrust: y F about x, -x F about y.
    arms = np.stack([position[:, 1], -position[:, 0]])
    covariance, cross = drive.T @ drive, target.T @ drive
    power = np.sum(target ** 2, axis=0)
    # Of an axis that is not moved there is rounding alone, which correlates with anything.
    least = ROUNDING * np.trace(covariance) * np.sum(arms ** 2, axis=1)
    moved = power > ROUNDING * power.max(initial=0.0)
    orders = list(permutations(range(len(position))))
    effect = arms[:, np.array(orders)]
    size = np.sum(effect @ covariance * effect, axis=-1)
    told = moved[:, None] & (size > least[:, None])
    scale = np.sqrt(np.where(told, size * power[:, None], 1.0))
    each = np.where(told, np.einsum('aki,ai->ak', effect, cross) / scale, 0.0)
    return dict(zip(orders, (each.sum(axis=0) / len(arms)).tolist(), strict=True))


def _spin_scores(grid: Grid, moment: np.ndarray, squared: np.ndarray, lag: int
                 ) -> dict[tuple[int, ...], float]:
    """
    Return {spins: correlation of the moment about z with that of the commands}.

    Args: moment (N, 3) on the body and squared commands (N, n); lag: samples that the moment
    comes later.
    """
    moment, squared = (_fast(grid, grid.smooth(signal, TURN), TURNS)
                       for signal in (moment[:, 2:], squared))
    target, drive = _aligned(grid, moment, squared, lag)
    power = np.sum(target ** 2)
    scores = {}
    for choice in product((1, -1), repeat=drive.shape[1]):
        torque = drive @ np.array(choice, float)
        scale = np.sqrt(power * np.sum(torque ** 2))
        scores[choice] = float(np.sum(target[:, 0] * torque) / scale) if scale > 0 else 0.0
    return scores


def _sure(grid: Grid) -> float:
    """Return the correlation that spins need: in a short flight noise alone has much of one."""
    seconds = np.count_nonzero(grid.good) * grid.period
    return max(SURE, CHANCE * float(np.sqrt(TURN / seconds)))


def _spin(told: _Evidence, vehicle: Vehicle) -> list[Finding]:
    spins = tuple(rotor.spin for rotor in vehicle.rotors)
    scores = told.spins
    best = max(scores, key=scores.__getitem__)
    if scores[best] < told.sure or scores[best] < scores[spins] + BETTER:
        return []
    # Roll and pitch leak into the yaw of real vehicles, which looks like other spins, too.
    wrong = scores[spins] < PART * scores[best]
    severity, verb, mend = (('error', 'not', 'correct') if wrong
                            else ('warning', 'rather than', 'check'))
    return [Finding(
        'rotor_spin', severity, f'cmd1 to cmd{len(spins)}',
        f'the commands yaw the body as spins {list(best)} would (correlation '
        f'{scores[best]:.2f}), {verb} as those of {vehicle.name}, {list(spins)} '
        f'({scores[spins]:.2f})',
        f'{mend} the spins in the vehicle file (+1: the reaction torque on the body is about +z), '
        'or the order of the commands')]


def _aligned(grid: Grid, moment: np.ndarray, squared: np.ndarray, lag: int
             ) -> tuple[np.ndarray, np.ndarray]:
    """Return moments and the commands lag samples before, both about their means."""
    index = np.flatnonzero(grid.good)
    index = index[(index >= lag) & (index - lag < len(squared))]
    target, drive = moment[index], squared[index - lag]
    return target - target.mean(axis=0), drive - drive.mean(axis=0)
