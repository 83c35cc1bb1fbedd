# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Charts of lines: one table of values, drawn as a picture and given to the script of a page."""

from dataclasses import dataclass
import math
from pathlib import Path

from matplotlib.ticker import LogLocator, NullFormatter
import numpy as np

from quad_ident_ros.report.picture import pyplot, save

STYLES = {'measured': ('#9aa0a6', 4.0), 'before': ('#d55e00', 1.1), 'after': ('#0072b2', 1.1)}
"""Colour and width (pt) of a line; the colours of the page have the same names."""
BAND = '0.88'
BREAK = 1.5     # times the usual step, as for the stretches of residual_wrench.py
DIGITS = 4      # of a value on the page: a part in 1000 or more is less than a pixel


@dataclass(frozen=True, eq=False)
class Line:
    """Values (N,) under a label, in one of the STYLES."""

    label: str
    style: str
    values: np.ndarray


@dataclass(frozen=True, eq=False)
class Panel:
    """
    Lines of one quantity over the x of its Chart.

    band: half the height of a grey band about zero, or None; limits (low, high): what is shown at
    most, or None.
    """

    title: str
    unit: str
    lines: tuple[Line, ...]
    band: float | None = None
    limits: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class Chart:
    """
    Panels over the same x (N,), in rows.

    widths of the columns; height of a row (inches); logarithmic: both axes; band: what the grey
    bands are.
    """

    quantity: str
    unit: str
    x: np.ndarray
    panels: tuple[Panel, ...]
    widths: tuple[float, ...]
    height: float
    logarithmic: bool = False
    band: str = ''

    def as_data(self) -> dict:
        """Return what the script of a page draws, with as many digits as can be seen."""
        return {'quantity': self.quantity, 'unit': self.unit, 'logarithmic': self.logarithmic,
                'band': self.band, 'widths': list(self.widths), 'breaks': breaks(self.x),
                'x': rounded(self.x, DIGITS + 2), 'panels': [
                    {'title': panel.title, 'unit': panel.unit, 'band': panel.band,
                     'limits': panel.limits, 'lines': [
                         {'label': line.label, 'style': line.style,
                          'values': rounded(line.values)} for line in panel.lines]}
                    for panel in self.panels]}


def save_chart(chart: Chart, path: str | Path) -> None:
    """Save a Chart as a picture; raises InputError where the file cannot be written."""
    plt = pyplot(path)
    rows = math.ceil(len(chart.panels) / len(chart.widths))
    figure, axes = plt.subplots(rows, len(chart.widths), dpi=110, sharex=True, squeeze=False,
                                figsize=(11.4, rows * chart.height), layout='constrained',
                                gridspec_kw={'width_ratios': chart.widths})
    handles = {}
    for axis, panel in zip(axes.flat, chart.panels, strict=True):
        if panel.band is not None:
            handles['band'] = axis.axhspan(-panel.band, panel.band, color=BAND, linewidth=0,
                                           label=chart.band)
        for line in panel.lines:
            colour, width = STYLES[line.style]
            # Nothing is drawn to or from what is no number.
            drawn, = axis.plot(*(np.insert(values, breaks(chart.x), np.nan)
                                 for values in (chart.x, line.values)), color=colour,
                               linewidth=width, label=line.label)
            handles.setdefault(line.style, drawn)
        if chart.logarithmic:
            axis.set(xscale='log', yscale='log')
            axis.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            for scale in (axis.xaxis, axis.yaxis):
                scale.set_major_formatter('{x:g}')
                scale.set_minor_formatter(NullFormatter())
        axis.set_ylim(panel.limits)
        axis.set_title(f'{panel.title}, {panel.unit}', loc='left', fontsize='medium')
        axis.grid(color='0.92')
        axis.set_axisbelow(True)
        axis.spines[['top', 'right']].set_visible(False)
    for axis in axes[-1]:
        axis.set_xlabel(f'{chart.quantity}, {chart.unit}')
    figure.legend(handles=list(handles.values()), loc='outside upper center',
                  ncols=len(handles), frameon=False)
    save(plt, figure, path)


def breaks(x: np.ndarray) -> list[int]:
    """Return the places in x (N,) before which nothing is known: no line leads to them."""
    steps = np.diff(x)
    return [int(place) + 1 for place in np.flatnonzero(steps > BREAK * np.median(steps))]


def rounded(values: np.ndarray, digits: int = DIGITS) -> list:
    """Return values (N,) with a number of significant digits."""
    return [float(f'{value:.{digits}g}') for value in values]
