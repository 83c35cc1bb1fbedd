# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of an identification."""

from pathlib import Path

import matplotlib

from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.signals import INPUT_OF, OUTPUT_UNITS

NAMES = {'phi': 'roll φ', 'theta': 'pitch θ', 'psi': 'yaw ψ', 'z': 'altitude z'}
MEASURED = '#9aa0a6'
# One colour and dash per method (Okabe and Ito), so that lines on top of one another still show.
STYLES = (('#0072b2', '-'), ('#e69f00', (0, (6, 2))), ('#009e73', (0, (3, 2))),
          ('#d55e00', (0, (1, 1.5))), ('#cc79a7', (0, (5, 1, 1, 1))))


def save_responses(identification, path, title):
    """
    Save a picture of the measured responses with the fitted ones over them, errors beneath.

    Raises InputError where the file cannot be written.
    """
    if not Path(path).suffix:
        raise InputError(f'{path}: the name of a picture ends in .png, .svg or .pdf')
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt

    signals = identification.signals
    figure, axes = plt.subplots(2, len(signals), figsize=(3.2 * len(signals) + 0.4, 5.2), dpi=130,
                                sharex='col', squeeze=False, layout='constrained',
                                gridspec_kw={'height_ratios': (2.2, 1)})
    for column, (output, signal) in enumerate(signals.items()):
        top, bottom = axes[:, column]
        unit = OUTPUT_UNITS[output]
        top.plot(signal.t, signal.y, color=MEASURED, linewidth=5, label='measured',
                 solid_capstyle='butt')
        for (name, method), (color, dash) in zip(identification.methods.items(), STYLES,
                                                 strict=False):
            fit = method.outputs[output]
            if fit.model is None:
                continue
            label = METHODS[name].label
            top.plot(signal.t, fit.response, color=color, linestyle=dash, label=label)
            bottom.plot(signal.t, signal.y - fit.response, color=color, linestyle=dash,
                        linewidth=1.0)
        top.set_title(f'{NAMES[output]} from {INPUT_OF[output]}')
        top.set_ylabel(unit)
        bottom.set_ylabel(f'error, {unit}')
        bottom.set_xlabel('time, s')
        bottom.axhline(0.0, color='0.6', linewidth=0.6, zorder=0)
        for axis in (top, bottom):
            axis.grid(color='0.92')
            axis.spines[['top', 'right']].set_visible(False)
    axes[0, 0].legend(frameon=False)
    figure.suptitle(title)
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path)
    except (OSError, ValueError) as error:
        raise InputError(f'{path}: the picture cannot be written: {error}') from None
    finally:
        plt.close(figure)
