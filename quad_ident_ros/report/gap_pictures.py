# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of a diagnosis."""

from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter
import numpy as np

from quad_ident_ros.diagnose.residual_wrench import (
    CHANNELS,
    ResidualWrench,
    shared_features,
    weights,
)
from quad_ident_ros.diagnose.result import Gap
from quad_ident_ros.greybox.errors import GROUPS
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.report.picture import pyplot, save

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BEFORE, AFTER, NOISE = '#d55e00', '#0072b2', '#555555'
THIRDS = ('low', 'mid', 'high')
NARROW = 4.0        # times the lowest gap that its axis shows at least
MANY = 300.0        # times the lowest gap from where on an axis names powers of ten alone: 8 marks


def save_horizons(gap: Gap, path: str | Path) -> None:
    """Save the gap over the horizon, before, after and of noise, with its 95 % intervals."""
    plt = pyplot(path)
    figure, axes = plt.subplots(1, len(GROUPS), figsize=(11.4, 3.2), dpi=110,
                                layout='constrained')
    horizons = np.array([float(name) for name in gap.horizons])
    for axis, group in zip(axes, GROUPS, strict=True):
        for stage, color, shift in (('before', BEFORE, -0.012), ('after', AFTER, 0.012)):
            values = np.array([one[stage][group] for one in gap.horizons.values()])
            ends = np.array([one[f'{stage}_interval'][group]
                             for one in gap.horizons.values()]).T
            axis.errorbar(horizons + shift, values, np.maximum([values - ends[0],
                                                                ends[1] - values], 0.0),
                          color=color, marker='o', markersize=4, capsize=3, label=stage)
        axis.plot(horizons, [one['noise'][group] for one in gap.horizons.values()],
                  color=NOISE, linestyle='--', label='noise alone')
        # The gap after may be a hundredth of that before: both are to be read.
        axis.set_yscale('log')
        low, high = axis.get_ylim()
        low = min(low, high / NARROW)    # a gap that stays must not look steep
        axis.set_ylim(low, high)
        # 2 and 5 between the powers of ten have no room where these are many.
        axis.yaxis.set_major_locator(LogLocator(
            subs=(1.0, 2.0, 5.0) if high / low < MANY else (1.0,)))
        axis.yaxis.set_major_formatter(StrMethodFormatter('{x:g}'))
        axis.yaxis.set_minor_formatter(NullFormatter())
        axis.set_xticks(horizons)
        axis.set_title(f'{group}, {gap.units[group]}', fontsize='medium')
        axis.set_xlabel('horizon, s')
        _plain(axis)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc='outside upper center', ncols=len(labels), frameon=False)
    save(plt, figure, path)


def horizons_in_words(gap: Gap) -> str:
    """Return the gap at the longest horizon, for readers who cannot see the picture."""
    horizon, last = max(gap.horizons.items(), key=lambda one: float(one[0]))
    return f'At {float(horizon):g} s: ' + '; '.join(
        f'{group} {last["before"][group]:.3g} {gap.units[group]} before, '
        f'{last["after"][group]:.3g} after, {last["noise"][group]:.3g} of noise'
        for group in GROUPS) + '.'


def save_map(before: tuple[ResidualWrench, ...], after: tuple[ResidualWrench, ...],
             vehicle: Vehicle, path: str | Path) -> None:
    """
    Save the residual force and moment by channel and third of each feature of the regime.

    Args: before, after: of each flight with the nominal and with the diagnosed vehicle. In m/s of
    velocity made in half a second, so that forces and moments compare; what noise alone gives is
    taken off.
    """
    plt = pyplot(path)
    names = regimes(before)
    tables = [_by_third(flights, names, vehicle) for flights in (before, after)]
    most = max(float(np.nanmax(tables[0])), 1e-9)
    figure, axes = plt.subplots(2, 1, figsize=(11.4, 5.6), dpi=110, sharex=True,
                                layout='constrained')
    for axis, table, title in zip(axes, tables, ('before', 'after'), strict=True):
        image = axis.pcolormesh(table, cmap='magma_r', vmin=0.0, vmax=most,
                                edgecolors='face')
        axis.invert_yaxis()
        axis.set_yticks(np.arange(len(CHANNELS)) + 0.5, CHANNELS)
        axis.set_title(title, fontsize='medium', loc='left')
        for edge in range(1, len(names)):
            axis.axvline(len(THIRDS) * edge, color='white', linewidth=3)
        axis.tick_params(length=0)
        axis.spines[:].set_visible(False)
    columns = (np.arange(len(names)) + 0.5) * len(THIRDS)
    axes[1].set_xticks(columns, [f'{name}\nlow to high'.replace(' and ', ' and\n')
                                 .replace('horizontal air', 'horizontal\nair')
                                 .replace('to the left', '\nto the left')
                                 .replace('of the voltage', '\nof the voltage')
                                 for name in names], fontsize='x-small')
    figure.colorbar(image, ax=axes, label='m/s in half a second', pad=0.01)
    save(plt, figure, path)


def regimes(flights: tuple[ResidualWrench, ...]) -> list[str]:
    """Return the names of the features that vary in a flight, which the map has columns of."""
    return [name for name in shared_features(flights)
            if np.ptp(flights[0].features[name][1]) > 0]


def map_rows(flights: tuple[ResidualWrench, ...], names: list[str],
             vehicle: Vehicle) -> list[list[str]]:
    """
    Return the numbers of a map as rows of text: a third of a feature, then m/s of each channel.

    Args: flights: before or after; names: of the features.
    """
    columns = _by_third(flights, names, vehicle).T
    return [[f'{name}, {third}', *(f'{value:.3g}' for value in column)]
            for (name, third), column in zip(product(names, THIRDS), columns, strict=True)]


def map_in_words(flights: tuple[ResidualWrench, ...], vehicle: Vehicle) -> str:
    """Return the largest number of a map and its place, for readers who cannot see its colours."""
    names = regimes(flights)
    cells = _by_third(flights, names, vehicle)
    channel, column = np.unravel_index(np.nanargmax(cells), cells.shape)
    name, third = list(product(names, THIRDS))[column]
    return f'{cells[channel, column]:.3g} m/s by {CHANNELS[channel]} ({name}, {third})'


def _by_third(flights: tuple[ResidualWrench, ...], names: list[str],
              vehicle: Vehicle) -> np.ndarray:
    """Return the residual (6, 3 K) by third of K features, of all flights together."""
    values = np.concatenate([flight.values for flight in flights])
    errors = np.concatenate([flight.errors for flight in flights])
    energy = (values ** 2 - errors ** 2) * weights(vehicle) ** 2
    columns = []
    for name in names:
        feature = np.concatenate([flight.features[name][1] for flight in flights])
        rank = np.argsort(np.argsort(feature)) * len(THIRDS) // len(feature)
        columns += [np.sqrt(np.maximum(energy[rank == third].mean(axis=0), 0.0))
                    for third in range(len(THIRDS))]
    return np.stack(columns, axis=1)


def _plain(axis: 'Axes') -> None:
    axis.grid(color='0.92')
    axis.set_axisbelow(True)
    axis.spines[['top', 'right']].set_visible(False)
