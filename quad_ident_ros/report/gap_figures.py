# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Every picture of a diagnosis, with its words and the values that a script may draw."""

from pathlib import Path

from quad_ident_ros.diagnose.residual_wrench import WINDOW
from quad_ident_ros.diagnose.result import Diagnosis
from quad_ident_ros.report.chart import save_chart
from quad_ident_ros.report.flight_path import flight_path, save_path
from quad_ident_ros.report.gap_charts import predictions, spectrum
from quad_ident_ros.report.gap_pictures import (
    horizons_in_words,
    map_in_words,
    save_horizons,
    save_map,
)
from quad_ident_ros.report.svg import Figure


def figures(found: Diagnosis) -> dict[str, Figure]:
    """Return {name: Figure} of a Diagnosis."""
    pictures, ahead, density = found.pictures, predictions(found), spectrum(found)
    path = flight_path(found)
    made = {
        'predictions': Figure(
            lambda file: save_chart(ahead, file),
            'Measured and predicted velocity and rates over time, and the errors',
            f'Velocity (world) and rates (body) of {found.held_out}: open-loop predictions from '
            f'recorded states, each shown at its end, {found.gap.horizon:g} s later, and their '
            'errors, measured minus predicted. Predictions beyond the frame are cut off.',
            ahead.as_data()),
        'spectrum': Figure(
            lambda file: save_chart(density, file),
            'Residual acceleration over the frequency, before and after',
            'Amplitude density (Welch) of the acceleration (body) that the model does not '
            f'explain, from means over {WINDOW:g} s: residual force by mass and residual moment '
            'by inertia, each without its mean; the noise is part of it.', density.as_data()),
        'horizons': Figure(
            lambda file: save_horizons(found.gap, file),
            'Gap by horizon, before and after, and of noise alone. '
            f'{horizons_in_words(found.gap)}',
            'Root mean square error of the predictions over the horizon, with 95 % intervals '
            '(bootstrap of blocks of time).'),
        'map': Figure(
            lambda file: save_map(pictures.wrench_before, pictures.wrench_after, found.vehicle,
                                  file),
            'Residual force and moment by channel and regime. Largest before: '
            f'{map_in_words(pictures.wrench_before, found.vehicle)}; after: '
            f'{map_in_words(pictures.wrench_after, found.vehicle)}. The tables under "The map in '
            'numbers" have every cell.',
            'Force and moment that the model does not explain, by channel and regime: each '
            'feature is split into thirds of the flight time. The colour is the velocity that '
            'they cause in half a second, without the noise, on one scale for both.')}
    if path is not None:
        made['path'] = Figure(
            lambda file: save_path(path, file),
            f'Flight path in space, before and after. {path.in_words()}',
            f'Path of {found.held_out}, more orange and thicker where the velocity '
            f'predicted {found.gap.horizon:g} s ahead is more wrong. {path.in_words()}',
            path.as_data())
    return made


def save_figures(found: Diagnosis, folder: Path, ending: str) -> None:
    """Save every picture of a Diagnosis as its name and an ending, .png or .svg."""
    for name, figure in figures(found).items():
        figure.save(folder / f'{name}{ending}')
