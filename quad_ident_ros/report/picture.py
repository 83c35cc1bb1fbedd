# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of an identification."""

from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import matplotlib
from matplotlib.ticker import NullFormatter, StrMethodFormatter
import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.result import Identification
from quad_ident_ros.identify.signals import INPUT_OF, OUTPUT_UNITS
from quad_ident_ros.whole_file import replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAMES = {'phi': 'roll φ', 'theta': 'pitch θ', 'psi': 'yaw ψ', 'z': 'altitude z'}
MEASURED = '#9aa0a6'
WIDTH = 170.0            # pt, about what a panel of responses is wide
THICK, THIN = 5.0, 0.5   # pt, of the measured line
# One colour and dash per method (Okabe and Ito), so that lines on top of one another still show.
STYLES = (('#0072b2', '-'), ('#e69f00', (0, (6, 2))), ('#009e73', (0, (3, 2))),
          ('#d55e00', (0, (1, 1.5))), ('#cc79a7', (0, (5, 1, 1, 1))))


def save_responses(identification: Identification, path: str | Path, title: str,
                   given: str = 'measured') -> None:
    """
    Save a picture of the given responses with the fitted ones over them, errors beneath.

    Args: given: what the legend calls the responses that were fitted. Raises InputError where the
    file cannot be written.
    """
    plt = pyplot(path)
    signals = identification.signals
    figure, axes = plt.subplots(2, len(signals), figsize=(3.2 * len(signals) + 0.4, 5.2), dpi=130,
                                sharex='col', squeeze=False, layout='constrained',
                                gridspec_kw={'height_ratios': (2.2, 1)})
    for column, (output, signal) in enumerate(signals.items()):
        top, bottom = axes[:, column]
        unit = OUTPUT_UNITS[output]
        top.plot(signal.t, signal.y, color=MEASURED, linewidth=_line(signal.y),
                 label=given, solid_capstyle='butt')
        for (name, method), (color, dash) in zip(identification.methods.items(), STYLES,
                                                 strict=False):
            fit = method.outputs[output]
            if fit.model is None:
                continue
            label = METHODS[name].label
            top.plot(signal.t, fit.response, color=color, linestyle=dash, label=label)
            error = signal.y - fit.response
            bottom.plot(signal.t, error, color=color, linestyle=dash,
                        linewidth=min(1.0, _line(error)))
        fast = '\n(only its range can be seen)' if _line(signal.y) == THIN else ''
        top.set_title(f'{NAMES[output]} from {INPUT_OF[output]}{fast}')
        top.set_ylabel(unit)
        bottom.set_ylabel(f'error, {unit}')
        bottom.set_xlabel('time, s')
        bottom.axhline(0.0, color='0.6', linewidth=0.6, zorder=0)
        for axis in (top, bottom):
            axis.grid(color='0.92')
            axis.spines[['top', 'right']].set_visible(False)
    # Below the panels, where no response passes.
    entries = {line.get_label(): line for axis in axes[0] for line in axis.lines}
    legend = figure.legend(entries.values(), entries, loc='outside lower center', frameon=False,
                           ncols=2 if len(signals) == 1 else len(entries))
    for line in legend.get_lines():
        line.set_linewidth(max(line.get_linewidth(), 1.5))
    figure.suptitle(title, parse_math=False)
    save(plt, figure, path)


def _line(y: np.ndarray) -> float:
    """Return how thick a line, in pt, leaves the turns of y (N,) to be seen."""
    above = y > (y.min() + y.max()) / 2
    crossings = max(1, int(np.count_nonzero(above[1:] != above[:-1])))
    return float(np.clip(WIDTH / crossings / 3, THIN, THICK))


def save_spread(panels: Mapping[str, Mapping[str, np.ndarray]], path: str | Path, title: str,
                quantity: str) -> None:
    """
    Save a picture of how values spread, by panel and method: a dot each, a line at the median.

    Args: panels: title -> name of a method -> values (n,), 0 or above; quantity: what they are.
    What lies more than a decade below all that spread is shown at the lower edge, with its value.
    Raises InputError where the file cannot be written.
    """
    plt = pyplot(path)
    every = [values for methods in panels.values() for values in methods.values()]
    spread = np.concatenate([values for values in every if len(values) > 1] or every)
    everything, spread = (values[np.isfinite(values) & (values > 0)]
                          for values in (np.concatenate(every), spread))
    bottom = max(everything.min() / 1.5, spread.min() / 10)
    figure, axes = plt.subplots(1, len(panels), figsize=(3.2 * len(panels) + 0.4, 3.3), dpi=130,
                                sharey=True, squeeze=False, layout='constrained')
    for axis, (label, methods) in zip(axes[0], panels.items(), strict=True):
        axis.set_yscale('log')
        for place, ((_, values), (color, _)) in enumerate(zip(methods.items(), STYLES,
                                                              strict=False)):
            median = np.median(values)
            if len(values) == 1 and median < bottom:
                axis.plot(place, bottom, 'v', color=color, markersize=8, clip_on=False)
                axis.annotate(f'{median:.0e}', (place, bottom), xytext=(0, 8), ha='center',
                              textcoords='offset points', color=color, fontsize='small')
                continue
            across = np.linspace(-0.22, 0.22, len(values)) if len(values) > 1 else [0.0]
            axis.plot(place + np.asarray(across), values, 'o', color=color, markersize=3.5,
                      alpha=0.55, markeredgewidth=0)
            axis.plot([place - 0.36, place + 0.36], [median, median], color=color, linewidth=2)
        axis.set_xticks(range(len(methods)), [METHODS[name].label for name in methods])
        axis.set_xlim(-0.6, len(methods) - 0.4)
        axis.set_title(label, fontsize='medium', parse_math=False)
        axis.grid(axis='y', color='0.92')
        axis.spines[['top', 'right']].set_visible(False)
    axes[0, 0].set_ylim(bottom, 1.5 * everything.max())
    plain, narrow = StrMethodFormatter('{x:g}'), everything.max() < 5 * bottom
    axes[0, 0].yaxis.set_major_formatter(plain)
    axes[0, 0].yaxis.set_minor_formatter(plain if narrow else NullFormatter())
    axes[0, 0].set_ylabel(quantity)
    figure.suptitle(title, parse_math=False)
    save(plt, figure, path)


def pyplot(path: str | Path) -> ModuleType:
    """Return pyplot for files; raises InputError where a path says no kind of picture."""
    if not Path(path).suffix:
        raise InputError(f'{path}: the name of a picture ends in .png, .svg or .pdf')
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt
    return plt


def save(plt: ModuleType, figure: 'Figure', path: str | Path) -> None:
    """Write a figure to a file and forget it; raises InputError."""
    try:
        with replacing(path) as temporary:
            figure.savefig(temporary)
    except (OSError, ValueError) as error:
        raise InputError(f'{path}: the picture cannot be written: '
                         f'{getattr(error, "strerror", None) or error}') from None
    finally:
        plt.close(figure)
