# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What kind of signals to motors values are, by their size."""

from collections.abc import Sequence

import numpy as np

from quad_ident_ros.model.motors import KINDS, TO_SPEED

PWM = 800.0, 2200.0     # us, between which pulses to motors lie
LEAST = 0.1             # of full throttle, which a flight exceeds for a tenth of the time
BACKWARDS = -0.999, -0.01   # of signals from -1 to 1; -1 alone may stand for off, -0.01 be noise
MANY = 0.01             # of the signals: fewer out of a range are glitches, more another kind
LEAST_DUTY = 10000.0    # a sixth of 65535: less lifts nothing
ALIKE = 'pwm', 'dshot'  # kinds of the same size
NEAR_HOVER = 0.75, 1.33  # of the hover speed: thrust coefficients are off by less than half
LIKE = 0.3              # of the strongest motor's usual signal, that the weakest one's exceeds
APART = 1.15            # times in speed, a third in thrust: vehicle files may err by less
FASTEST = {'speed': 4000.0, 'rpm': 60000.0}     # rad/s and rpm of rotors that fly anything

LINEAR = 'linear_in'
"""Info of a record: of what signals its commands were taken to be linear, see linear_in."""

TITLES = {'speed': 'rad/s', 'rpm': 'rpm', 'pwm': 'PWM', 'normalised': 'normalised',
          'percent': 'per cent', 'duty16': 'duty', 'dshot': 'DSHOT'}


def kinds_of(values: np.ndarray, hover: float | None = None,
             ends: tuple[float, float] = (0.0, np.inf)) -> tuple[str, ...]:
    """
    Return the kinds (of KINDS) that values may be, the likeliest first.

    Values of 0 and less are motors that are off; where signals of 1 and less are often
    below 0, they have another range, which their size does not show.
    Args: values, any shape; hover: rad/s, the hover speed of the vehicle, or None; ends: its
    lowest and highest speed, rad/s, which separate PWM from DSHOT of the same size.
    """
    on = values[np.isfinite(values) & (values > 0)]
    if not len(on):
        return ()
    low, high, usual = float(on.min()), float(on.max()), float(np.median(on))
    whole = bool(np.all(on == np.round(on)))
    if high <= 1.001:
        below = np.mean((values > BACKWARDS[0]) & (values < BACKWARDS[1]))
        return () if below > MANY else ('normalised',)
    if 2.0 < high <= 100.001:
        return ('percent',)
    found = []
    strong = float(np.quantile(on, 0.9))
    if PWM[0] <= low and high <= PWM[1] and strong > _at(LEAST, 'pwm'):
        found.append('pwm')
    if whole and 48 <= low and high <= 2047 and strong > _at(LEAST, 'dshot'):
        found.append('dshot')
    if len(found) == 2:
        found = _nearer(found, usual, hover, ends)
    if whole and LEAST_DUTY < high <= 65535:
        found.append('duty16')
    if hover is not None:
        found += [kind for kind, factor in TO_SPEED.items()
                  if NEAR_HOVER[0] < usual * factor / hover < NEAR_HOVER[1]]
    elif not found:     # what it would be without a vehicle to hold it against
        found += [kind for kind in TO_SPEED if 100.0 < high < FASTEST[kind]][:1]
    return tuple(found)


def in_newtons(values: np.ndarray, kinds: Sequence[str], weight: float, hover: float,
               ends: tuple[float, float]) -> bool:
    """
    Whether signals carry a vehicle as thrusts of its rotors in N, and not as what they may be.

    Args: kinds that they may be by their size; weight of the vehicle on each rotor, N; hover and
    ends as in kinds_of.
    """
    on = values[np.isfinite(values) & (values > 0)]
    usual = float(np.median(on)) if len(on) else 0.0
    if not NEAR_HOVER[0] ** 2 < usual / weight < NEAR_HOVER[1] ** 2:
        return False
    full = {'normalised': 1.0, 'percent': 100.0}
    shares = [usual / full[kind] for kind in kinds if kind in full]
    if len(shares) < len(kinds) or (shares and not np.isfinite(ends[1])):
        return False
    speeds = [ends[0] + of_full * (ends[1] - ends[0]) for share in shares
              for of_full in (share, np.sqrt(share))]
    return not any(NEAR_HOVER[0] < speed / hover < NEAR_HOVER[1] for speed in speeds)


def are_signals(values: np.ndarray) -> bool:
    """
    Return whether columns (N, 4) named as thrust and moments are signals to four motors.

    These are alike and not below 0; moments are about 0, for the vehicle turns to and fro.
    """
    on = values[np.isfinite(values).all(axis=1) & (values.max(axis=1) > 0)]
    if not len(on) or np.mean(on < 0) > MANY:
        return False
    usual = np.median(on, axis=0)
    return bool(usual.min() > LIKE * usual.max())


def linear_in(kind: str) -> list[tuple[str, float, float]]:
    """
    Return (kind, a, b) of a kind and of the others of its size, for the info LINEAR.

    A signal that is the share x of the range of the first is the share a + b x of the others'.
    """
    low, high = KINDS[kind] or (0.0, 1.0)
    others = [other for other in (kind, *ALIKE) if kind in ALIKE or other == kind]
    found = []
    for other in dict.fromkeys(others):
        least, most = KINDS[other] or (0.0, 1.0)
        found.append((other, (low - least) / (most - least), (high - low) / (most - least)))
    return found


def hovers_signed(values: np.ndarray, hover: float, ends: tuple[float, float]) -> bool:
    """
    Whether signals of 0 to 1 turn the rotors as in hover if they are signals from -1 to 1 alone.

    Args: as kinds_of.
    """
    usual = float(np.median(values[np.isfinite(values) & (values > 0)]))
    near = [NEAR_HOVER[0] < (ends[0] + share * (ends[1] - ends[0])) / hover < NEAR_HOVER[1]
            for share in (usual, (usual + 1.0) / 2.0)]
    return bool(np.isfinite(ends[1])) and near == [False, True]


def _nearer(kinds: list[str], usual: float, hover: float | None,
            ends: tuple[float, float]) -> list[str]:
    """
    Return of kinds of the same size those by which the usual signal turns the rotors as in hover.

    That is one alone where it is nearer by APART, and all where they are alike or no highest speed
    is known; without a vehicle the first.
    """
    if hover is None:
        return kinds[:1]
    if not np.isfinite(ends[1]):
        return kinds
    off = {}
    for kind in kinds:
        low, high = KINDS[kind] or (0.0, 1.0)
        speed = ends[0] + (usual - low) / (high - low) * (ends[1] - ends[0])
        off[kind] = abs(np.log(speed / hover)) if speed > 0.0 else np.inf
    least = min(off.values())
    return [kind for kind in kinds if off[kind] <= least + np.log(APART)]


def _at(share: float, kind: str) -> float:
    """Return the signal of a kind at a share of full throttle."""
    low, high = KINDS[kind] or (0.0, 1.0)
    return low + share * (high - low)


def described(kind: str) -> str:
    """Return a kind with its range, as messages say it."""
    limits = KINDS[kind]
    return TITLES[kind] + ('' if limits is None else f', {limits[0]:g} to {limits[1]:g}')
