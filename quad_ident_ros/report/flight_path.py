# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The path of a flight in space, coloured by the error of the predictions along it."""

from dataclasses import dataclass
from itertools import groupby
from pathlib import Path as File

from matplotlib import rc_context
from matplotlib.colors import LinearSegmentedColormap
import numpy as np

from quad_ident_ros.diagnose.result import Diagnosis
from quad_ident_ros.greybox.errors import GROUPS
from quad_ident_ros.report.chart import breaks, rounded
from quad_ident_ros.report.picture import pyplot, save

FROM = {'azimuth': -60.0, 'elevation': 30.0}     # degrees, from where it is seen first
THIN, THICK = 1.2, 5.0      # pt, at no error and at the largest
LEVELS = 8          # of colour and thickness
SMALLEST = 0.1      # m to each side: a hover is to look like one
# Both can be seen on white and on black, for they are the same on a dark page.
COLOURS = LinearSegmentedColormap.from_list('error', ['#92989e', '#d65f04'])


@dataclass(frozen=True, eq=False)
class FlightPath:
    """
    Positions (N, 3) m at t (N,) s, and velocity errors {stage: (N,)} m/s of predictions there.

    title: of what the errors are.
    """

    t: np.ndarray
    positions: np.ndarray
    errors: dict[str, np.ndarray]

    def as_data(self) -> dict:
        """Return what the script of a page draws, with as many digits as can be seen."""
        return {'path': [rounded(place) for place in self.positions], 't': rounded(self.t, 6),
                'breaks': breaks(self.t),
                'errors': {stage: rounded(one) for stage, one in self.errors.items()}, **FROM}

    def in_words(self) -> str:
        """Return where the errors are largest, for readers who cannot see the picture."""
        places = []
        for stage, error in self.errors.items():
            worst = int(np.argmax(error))
            where = ', '.join(f'{value:.2f}' for value in self.positions[worst])
            places.append(f'{stage}: {error[worst]:.2g} m/s at {self.t[worst]:.4g} s, '
                          f'x, y, z {where} m')
        return f'Largest error {"; ".join(places)}.'


def flight_path(found: Diagnosis) -> FlightPath | None:
    """Return the path of the flight held out; None where the flights know no position."""
    pictures = found.pictures
    if not all('height' in one.features for one in pictures.wrench_before):
        return None
    return FlightPath(pictures.t, pictures.states[:, :3], {
        stage: np.linalg.norm(ends.errors[:, GROUPS['velocity']], axis=1)
        for stage, ends in (('before', pictures.before), ('after', pictures.after))})


def save_path(path: FlightPath, file: str | File) -> None:
    """Save the path, a picture per stage in one scale; raises InputError where it cannot."""
    from mpl_toolkits.mplot3d.art3d import Line3DCollection
    plt = pyplot(file)
    with rc_context({'grid.color': '0.92'}):
        figure, axes = plt.subplots(1, len(path.errors), dpi=110, figsize=(11.4, 4.8),
                                    layout='constrained', subplot_kw={'projection': '3d',
                                                                      'proj_type': 'ortho'})
    most = max(float(max(error.max() for error in path.errors.values())), 1e-9)
    half = max(np.ptp(path.positions, axis=0).max() / 2, SMALLEST)
    for axis, (stage, error) in zip(axes, path.errors.items(), strict=True):
        runs, shares = _runs(path, error / most)
        lines = Line3DCollection(runs, cmap=COLOURS, array=most * shares, capstyle='round',
                                 linewidths=THIN + (THICK - THIN) * shares)
        lines.set_clim(0.0, most)
        axis.add_collection3d(lines)
        axis.patch.set_visible(False)   # it would cover the labels of its neighbour
        axis.view_init(FROM['elevation'], FROM['azimuth'])
        for name, values in zip('xyz', path.positions.T, strict=True):
            middle = (values.min() + values.max()) / 2
            getattr(axis, f'set_{name}lim')(middle - half, middle + half)
            getattr(axis, f'set_{name}label')(f'{name}, m', labelpad=4 if name == 'z' else 9)
            getattr(axis, f'{name}axis').set_pane_color((0.0, 0.0, 0.0, 0.0))
        axis.set_title(stage, fontsize='medium')
    figure.colorbar(lines, ax=axes, label='velocity error, m/s', pad=0.08, shrink=0.8)
    save(plt, figure, file)


def _runs(path: FlightPath, shares: np.ndarray) -> tuple[list[np.ndarray], np.ndarray]:
    """
    Return the path as lines (K, 3) of one colour each, and the share (R,) that each has.

    Args: shares (N,) of the largest error, which are rounded to LEVELS: a line for every
    segment would take twice the room.
    """
    levels = np.round(LEVELS * shares) / LEVELS
    stretch = np.cumsum(np.isin(np.arange(len(path.t)), breaks(path.t)))
    ends = np.flatnonzero(np.diff(stretch) == 0) + 1    # of the segments
    lines, values = [], []
    for (level, _), run in groupby(ends, lambda end: (levels[end], stretch[end])):
        places = list(run)
        lines.append(path.positions[places[0] - 1:places[-1] + 1])
        values.append(level)
    return lines, np.array(values)
