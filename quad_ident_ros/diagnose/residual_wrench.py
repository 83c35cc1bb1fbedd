# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the gap lies: the force and moment that the model does not explain."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.diagnose.accelerometer import residual_force
from quad_ident_ros.effects.registry import SLICES
from quad_ident_ros.greybox.errors import ERRORS
from quad_ident_ros.greybox.estimate import weights_of
from quad_ident_ros.greybox.flights import Flight, flight_of, inertial, Track
from quad_ident_ros.greybox.linear import (
    errors_along,
    linear_of,
    new_starts,
    seen_along,
    STEP,
    tangent_of,
    WRENCH,
)
from quad_ident_ros.greybox.parameters import limits, SPLIT
from quad_ident_ros.greybox.predictor import by_model, Predictor
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.vehicle import Vehicle

CHANNELS = ('Fx', 'Fy', 'Fz', 'Mx', 'My', 'Mz')
# How finely `where` is reported; no verdict depends on these.
WINDOW = 0.2        # s over which force and moment are taken as constant,
EVERY = 0.05        # s from one such window to the next: up to 5 Hz are seen
STRETCH = 25.0      # s without a break that spectra are taken of,
STRETCHES = 4       # and how many of them, spread over a longer flight
AIR = ('horizontal air speed', 'air speed forward', 'air speed to the left', 'climb speed')
AT_ONCE = 700       # windows whose slopes are held at once, 30 MB: those of 35 s
FEWEST = 8          # windows of a stretch that has a spectrum


@dataclass(frozen=True, eq=False)
class ResidualWrench:
    """
    Force (N) and moment (N m), body, that the model does not explain, in each window of a flight.

    values, errors (B, 6); t (B,) s; features {name: (unit, (B,))}, the regime of each window;
    stretch (B,): the number of the unbroken stretch that a window is of.
    """

    values: np.ndarray
    errors: np.ndarray
    t: np.ndarray
    features: dict
    stretch: np.ndarray


def residual_wrench(track: Track, vehicle: Vehicle, z: np.ndarray, noise: np.ndarray,
                    predictor: Predictor = by_model) -> ResidualWrench:
    """Return the ResidualWrench of a Track with a parameter vector z (Z,) and noise (12,)."""
    flight = flight_of(track, WINDOW, EVERY)
    # A window whose end is not seen, at the end of a block, shows nothing.
    flight = replace(flight, first=flight.first[
        flight.seen[flight.first + flight.count].all(axis=1)])
    first, stretch = _stretches(flight)
    flight = replace(flight, first=first)
    parts = [_by_motion(replace(flight, first=part), vehicle, z, noise, predictor)
             for part in np.array_split(first, -(-len(first) // AT_ONCE))]
    values, errors = (np.concatenate(each) for each in zip(*parts, strict=True))
    felt = residual_force(flight, vehicle, z, predictor)
    if felt is not None:
        values[:, :3], errors[:, :3] = _combined(values[:, :3], errors[:, :3], *felt)
    middle = flight.first + flight.count // 2
    return ResidualWrench(values, errors, flight.course.t[middle],
                          _features(flight, middle, vehicle, z), stretch)


def _by_motion(flight: Flight, vehicle: Vehicle, z: np.ndarray, noise: np.ndarray,
               predictor: Predictor) -> tuple[np.ndarray, np.ndarray]:
    """Return force and moment in the windows of a Flight and their errors, both (B, 6)."""
    starts = flight.states[flight.first]
    tangent = tangent_of(flight, vehicle, z, starts, WRENCH,
                         STEP * limits(vehicle)[2, list(WRENCH)])
    initial = replace(tangent, kept=[*range(ERRORS), -1])
    settled = linear_of(initial, errors_along(flight, vehicle, z, starts, predictor),
                        seen_along(flight) / noise, False)
    # Within the noise of the states, by which these move, the slopes stay the same.
    raw = errors_along(flight, vehicle, z, new_starts(settled, starts, np.zeros(0)), predictor)
    linear = linear_of(tangent, raw, weights_of(raw, noise, flight) / noise, False)
    inverse = np.linalg.inv(linear.products)
    values = inverse @ linear.cross[..., None]
    return values[..., 0], np.sqrt(np.einsum('bcc->bc', inverse))


def _combined(values: np.ndarray, errors: np.ndarray, felt: np.ndarray, noise: np.ndarray
              ) -> tuple[np.ndarray, np.ndarray]:
    """
    Return forces (B, 3) and their errors from those by the motion and those by an accelerometer.

    By their variances. The offset of the accelerometer is what it has more in the mean.
    """
    weight, other = errors ** -2.0, np.maximum(noise, 1e-12) ** -2.0
    felt = felt - np.average(felt - values, axis=0, weights=weight)
    return ((weight * values + other * felt) / (weight + other), (weight + other) ** -0.5)


def _stretches(flight: Flight) -> tuple[np.ndarray, np.ndarray]:
    """Return the starts of windows, at most STRETCHES times STRETCH s, and their stretches."""
    first, t = flight.first, flight.course.t
    if t[first[-1]] - t[first[0]] > STRETCHES * STRETCH:
        begins = np.linspace(t[first[0]], t[first[-1]] - STRETCH, STRETCHES)
        inside = (t[first] >= begins[:, None]) & (t[first] < begins[:, None] + STRETCH)
        first = first[inside.any(axis=0)]
    breaks = np.diff(t[first]) > 1.5 * np.median(np.diff(t[first]))
    return first, np.append(0, np.cumsum(breaks))


def shares(flights: Sequence[ResidualWrench], vehicle: Vehicle) -> dict[str, float]:
    """
    Return {channel: share of the gap}, of the ResidualWrench of flights, noise taken off.

    Forces and moments count by the velocity that they make in half a second.
    """
    values = np.concatenate([flight.values for flight in flights])
    errors = np.concatenate([flight.errors for flight in flights])
    energy = np.maximum(np.mean(values ** 2 - errors ** 2, axis=0), 0.0) * weights(vehicle) ** 2
    total = energy.sum()
    return dict(zip(CHANNELS, energy / total if total > 0 else energy, strict=True))


def weights(vehicle: Vehicle) -> np.ndarray:
    """Return what a unit of each channel makes of velocity in half a second, (6,)."""
    force = 0.5 / vehicle.mass
    moment = vehicle.gravity * 0.5 ** 3 / 6.0 / np.array(vehicle.inertia)
    return np.array([force, force, force, *moment])


def shared_features(flights: Sequence[ResidualWrench]) -> list[str]:
    """Return the names of the features that all flights have: without a position no height."""
    return [name for name in flights[0].features
            if all(name in flight.features for flight in flights)]


def regime(flights: Sequence[ResidualWrench], channel: str, excess: float
           ) -> tuple[str, float]:
    """
    Return (text, share): the half-space of the regime in which most of a channel lies.

    Of all features and thresholds the one that leaves the least outside, for its size.
    """
    column = CHANNELS.index(channel)
    energy = np.concatenate([flight.values[:, column] ** 2 - flight.errors[:, column] ** 2
                             for flight in flights])
    if energy.sum() <= 0:
        return 'nowhere above the noise', 0.0
    best = ('everywhere', 1.0, excess)
    for name in shared_features(flights):
        unit = flights[0].features[name][0]
        values = np.concatenate([flight.features[name][1] for flight in flights])
        if np.ptp(values) == 0:
            continue
        for level in np.quantile(values, (0.25, 0.5, 0.75)):
            for side, word in ((values > level, 'over'), (values <= level, 'under')):
                share = energy[side].sum() / energy.sum()
                excess = share - side.mean()
                if excess > best[2]:
                    best = (f'{name} {word} {level:.3g} {unit}', min(1.0, float(share)), excess)
    return best[:2]


def band(flights: Sequence[ResidualWrench], channel: str) -> tuple[float, float]:
    """
    Return the frequencies (low, high) Hz between which half of a channel's energy lies.

    Of what is above the noise, whose power is taken as the same at all frequencies.
    """
    column = CHANNELS.index(channel)
    frequency = np.linspace(0.0, 0.5 / EVERY, 201)
    spectrum = np.zeros(len(frequency))
    for flight in flights:
        for number in range(flight.stretch[-1] + 1):
            inside = flight.stretch == number
            values = flight.values[inside, column]
            if len(values) < FEWEST:
                continue
            step = float(np.median(np.diff(flight.t[inside])))
            length = 1 << (2 * len(values) - 1).bit_length()
            power = np.abs(np.fft.rfft(values, length)) ** 2
            noise = np.sum(flight.errors[inside, column] ** 2)
            grid = np.fft.rfftfreq(length, step)
            spectrum += np.interp(frequency, grid, np.maximum(power - noise, 0.0), right=0.0)
    if not spectrum.sum():
        return 0.0, 0.0
    share = np.cumsum(spectrum) / np.sum(spectrum)
    return (float(frequency[np.searchsorted(share, 0.25)]),
            float(frequency[min(int(np.searchsorted(share, 0.75)), len(frequency) - 1)]))


def _features(flight: Flight, middle: np.ndarray, vehicle: Vehicle, z: np.ndarray) -> dict:
    states = flight.states[middle]
    rotation = rotation_matrix(states[:, 6:10])
    wind = z[SPLIT + SLICES['wind'].start:SPLIT + SLICES['wind'].stop]
    air = np.einsum('bji,bj->bi', rotation, states[:, 3:6] - wind)
    rates = states[:, 10:13]
    course = flight.course
    given = np.searchsorted(course.stamps, course.t[middle], side='right') - 1
    speeds = course.commands[np.maximum(given, 0)]
    thrust = vehicle.thrust_coefficient * np.sum(speeds ** 2, axis=1)
    features = {
        'horizontal air speed': ('m/s', np.hypot(air[:, 0], air[:, 1])),
        'air speed forward': ('m/s', air[:, 0]),
        'air speed to the left': ('m/s', air[:, 1]),
        'climb speed': ('m/s', air[:, 2]),
        'height': ('m', states[:, 2]),
        'thrust': ('N', thrust),
        'roll and pitch rate': ('rad/s', np.hypot(rates[:, 0], rates[:, 1])),
        'roll rate': ('rad/s', rates[:, 0]),
        'pitch rate': ('rad/s', rates[:, 1]),
        'yaw rate': ('rad/s', rates[:, 2]),
        'fall of the voltage': ('V', flight.course.volt_drop[middle]),
        'time of flight': ('s', flight.course.t[middle]),
    }
    unknown = ([*AIR, 'height'] if inertial([flight]) else ['height'] if flight.summed else [])
    return {name: feature for name, feature in features.items() if name not in unknown}
