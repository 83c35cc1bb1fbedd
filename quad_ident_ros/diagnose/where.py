# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Where the gap lies: the force and moment that the model lacks, by channel, regime and band."""

from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.effects.registry import LACKING, SLICES
from quad_ident_ros.greybox.estimate import settled, weights_of
from quad_ident_ros.greybox.flights import flight_of
from quad_ident_ros.greybox.linear import errors_along, linearise
from quad_ident_ros.greybox.parameters import SPLIT
from quad_ident_ros.model.attitude import rotation_matrix

CHANNELS = ('Fx', 'Fy', 'Fz', 'Mx', 'My', 'Mz')
MOST = 2000         # windows of a flight; of more, every so many
WINDOW = 0.25       # s over which force and moment are taken as constant
COLUMNS = list(range(SPLIT + SLICES[LACKING.name].start, SPLIT + SLICES[LACKING.name].stop))


@dataclass(frozen=True, eq=False)
class Lacking:
    """
    Force (N) and moment (N m), body, that the model lacks in each window of a flight.

    values, errors (B, 6); t (B,) s; features {name: (unit, (B,))}, the regime of each window.
    """

    values: np.ndarray
    errors: np.ndarray
    t: np.ndarray
    features: dict


def lacking(track, vehicle, z, noise):
    """Return the Lacking of a Track with a parameter vector z (Z,) and noise (12,)."""
    flight = flight_of(track, WINDOW)
    flight = replace(flight, first=flight.first[::-(-len(flight.first) // MOST)])
    [starts] = settled([flight], vehicle, [z], [noise])
    weight = weights_of(errors_along(flight, vehicle, z, starts), noise, flight)
    linear = linearise(flight, vehicle, z, starts, COLUMNS, noise, False, weight)
    information = np.einsum('bmc,bmd->bcd', linear.slope, linear.slope)
    inverse = np.linalg.inv(information)
    values = np.einsum('bcd,bmd,bm->bc', inverse, linear.slope, linear.error)
    middle = flight.first + flight.count // 2
    return Lacking(values, np.sqrt(np.einsum('bcc->bc', inverse)), flight.course.t[middle],
                   _features(flight, middle, vehicle, z))


def shares(flights, vehicle):
    """
    Return {channel: share of the gap}, of the Lacking of flights, noise taken off.

    Forces and moments count by the velocity that they make in half a second.
    """
    values = np.concatenate([flight.values for flight in flights])
    errors = np.concatenate([flight.errors for flight in flights])
    energy = np.maximum(np.mean(values ** 2 - errors ** 2, axis=0), 0.0) * weights(vehicle) ** 2
    total = energy.sum()
    return dict(zip(CHANNELS, energy / total if total > 0 else energy, strict=True))


def weights(vehicle):
    """Return what a unit of each channel makes of velocity in half a second, (6,)."""
    force = 0.5 / vehicle.mass
    moment = vehicle.gravity * 0.5 ** 3 / 6.0 / np.array(vehicle.inertia)
    return np.array([force, force, force, *moment])


def regime(flights, channel):
    """
    Return (text, share): the half-space of the regime in which most of a channel lies.

    Of all features and thresholds the one that leaves the least outside, for its size.
    """
    column = CHANNELS.index(channel)
    energy = np.concatenate([flight.values[:, column] ** 2 - flight.errors[:, column] ** 2
                             for flight in flights])
    if energy.sum() <= 0:
        return 'nowhere above the noise', 0.0
    best = ('everywhere', 1.0, 0.35)
    for name in flights[0].features:
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


def band(flights, channel):
    """Return the frequencies (low, high) Hz between which half of a channel's energy lies."""
    column = CHANNELS.index(channel)
    spectrum, frequency = 0.0, np.linspace(0.0, 0.5 / WINDOW, 33)
    for flight in flights:
        values = flight.values[:, column]
        power = np.abs(np.fft.rfft(values, 64 * max(1, len(values) // 64 + 1))) ** 2
        grid = np.linspace(0.0, 0.5 / WINDOW, len(power))
        spectrum = spectrum + np.interp(frequency, grid, power)
    share = np.cumsum(spectrum) / np.sum(spectrum)
    return float(frequency[np.searchsorted(share, 0.25)]), \
        float(frequency[min(np.searchsorted(share, 0.75), 32)])


def _features(flight, middle, vehicle, z):
    states = flight.states[middle]
    rotation = rotation_matrix(states[:, 6:10])
    wind = z[SPLIT + SLICES['wind'].start:SPLIT + SLICES['wind'].stop]
    air = np.einsum('bji,bj->bi', rotation, states[:, 3:6] - wind)
    rates = states[:, 10:13]
    course = flight.course
    given = np.searchsorted(course.stamps, course.t[middle], side='right') - 1
    speeds = course.commands[np.maximum(given, 0)]
    thrust = vehicle.thrust_coefficient * np.sum(speeds ** 2, axis=1)
    return {
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
