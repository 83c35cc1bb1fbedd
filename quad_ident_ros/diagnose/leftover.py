# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Whether structure is left that no known effect explains, and what it depends on."""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from quad_ident_ros.diagnose.where import CHANNELS, shares

CHANCE = 1e-6       # of calling structure what is none, per channel
LAGS = 6            # windows over which what is left may hang together
FEWEST = 4 * LAGS   # windows from which on this can be told
REMAINS = 0.25      # of the noise's gap that structure must make to speak of an unknown effect
# Where a force and a moment make a gap: of a rate that is off no force is the cause.
MOVES = {'F': ('position', 'velocity'), 'M': ('position', 'velocity', 'attitude', 'rate')}


@dataclass(frozen=True)
class Leftover:
    """What is left in a channel: what it depends on, or 'time' alone; share of its variance."""

    channel: str
    depends_on: str
    share: float
    chance: float

    def remains(self, times):
        """Return the gap it may make, in times the noise's, of {group: the gap in these}."""
        return max(beside_noise(times[name]) for name in MOVES[self.channel[0]])


def beside_noise(times):
    """Return what makes a gap so many times the noise's beside the noise, in times that."""
    return float(np.sqrt(max(0.0, times ** 2 - 1.0)))


def leftovers(flights):
    """
    Return the Leftovers, the strongest first, of the Lacking of flights (of the best model).

    Of flights with less than FEWEST windows nothing is told.
    """
    flights = [flight for flight in flights if len(flight.t) >= FEWEST]
    if not flights:
        return []
    table, names = _library(flights)
    found = []
    for column, channel in enumerate(CHANNELS):
        scaled = np.concatenate([flight.values[:, column] / flight.errors[:, column]
                                 for flight in flights])
        y = np.clip(scaled, *np.quantile(scaled, (0.005, 0.995)))
        name, share, chance = _best_feature(table, names, y)
        if chance > CHANCE:
            chance = _memory(flights, column)
            name, share = 'the time', float(max(0.0, 1.0 - 1.0 / max(np.var(y), 1e-9)))
        if chance < CHANCE:
            found.append(Leftover(channel, name, share, chance))
    return sorted(found, key=lambda one: -one.share)


def unstructured(flights, vehicle):
    """Return the Leftover of the channel in which most is left, where that has no structure."""
    parts = shares(flights, vehicle)
    channel = max(parts, key=parts.get)
    return Leftover(channel, 'nothing that is looked at', 1.0, 1.0)


def _library(flights):
    """Return regressors (B, K) of unit spread, and the names of what they depend on."""
    columns, names = [], []
    for name in flights[0].features:
        values = np.concatenate([flight.features[name][1] for flight in flights])
        for column in (values, values * np.abs(values), values ** 2, np.abs(values)):
            if np.std(column) > 1e-9 * (1.0 + np.abs(column).max()):
                columns.append((column - column.mean()) / np.std(column))
                names.append(name)
    return np.stack(columns, axis=1), names


def _best_feature(table, names, y):
    """Return (name, share of the variance, chance) of the regressor that explains most of y."""
    count = len(y)
    centred = y - y.mean()
    total = np.sum(centred ** 2)
    along = table.T @ centred / count
    explained = count * along ** 2
    k = int(np.argmax(explained))
    share = explained[k] / total
    statistic = share * (count - 2) / max(1.0 - share, 1e-12)
    chance = min(1.0, len(names) * float(stats.f.sf(statistic, 1, count - 2)))
    mean = np.mean(y) ** 2 * count / max(np.var(y), 1.0)
    constant = float(stats.chi2.sf(mean, 1))
    if constant < chance:
        return 'nothing: it is constant', float(np.mean(y) ** 2 / np.mean(y ** 2)), constant
    return names[k], float(share), chance


def _memory(flights, column):
    """Return the chance that what is left hangs together in time as it does, were it noise."""
    statistic = 0.0
    for flight in flights:
        y = flight.values[:, column] / flight.errors[:, column]
        y = np.clip(y, *np.quantile(y, (0.01, 0.99)))
        y = y - y.mean()
        power = np.sum(y ** 2)
        for lag in range(1, LAGS + 1):
            r = np.sum(y[lag:] * y[:-lag]) / power
            statistic += len(y) * (len(y) + 2) * r * r / (len(y) - lag)
    return float(stats.chi2.sf(statistic, LAGS * len(flights)))
