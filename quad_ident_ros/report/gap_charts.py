# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Charts of a diagnosis: what they show of it."""

import numpy as np

from quad_ident_ros.diagnose.residual_spectrum import residual_spectrum
from quad_ident_ros.diagnose.result import Diagnosis
from quad_ident_ros.greybox.errors import GROUPS
from quad_ident_ros.model.dynamics import STATES
from quad_ident_ros.report.chart import Chart, Line, Panel

SHOWN = {'velocity': (('vx', 'vy', 'vz'), 'm/s'), 'rate': (('wx', 'wy', 'wz'), 'rad/s')}
HEADROOM = 1.5      # times the range of what was measured that is shown of predictions
ROOM = 1.3          # times the largest density, and by which the smallest is divided


def predictions(found: Diagnosis) -> Chart:
    """Return measured against predicted velocity and rates, and the errors beside them."""
    pictures, panels = found.pictures, []
    states = dict(zip(STATES, pictures.states.T, strict=True))
    for group, (names, unit) in SHOWN.items():
        noise = 2.0 * found.gap.noise[group] / np.sqrt(3.0)     # per axis
        for number, name in enumerate(names):
            measured = states[name]
            errors = {style: ends.errors[:, GROUPS[group]][:, number] for style, ends in
                      (('before', pictures.before), ('after', pictures.after))}
            middle, half = np.mean([measured.min(), measured.max()]), np.ptp(measured) / 2
            panels += [
                Panel(name, unit, (Line('measured', 'measured', measured), *(
                    Line(f'predicted {style}', style, measured - error)
                    for style, error in errors.items())),
                    limits=(middle - HEADROOM * half, middle + HEADROOM * half)),
                Panel(f'error of {name}', unit, tuple(
                    Line(style, style, error) for style, error in errors.items()),
                    band=noise)]
    return Chart('time', 's', pictures.t, tuple(panels), (1.5, 1.0), 1.9,
                 band='noise alone, 2 σ')


def spectrum(found: Diagnosis) -> Chart:
    """Return the amplitude density of the residual acceleration, before and after."""
    frequency, before = residual_spectrum(found.pictures.wrench_before, found.vehicle)
    after = residual_spectrum(found.pictures.wrench_after, found.vehicle)[1]
    panels = []
    for part, kind, unit in ((slice(0, 3), 'acceleration', 'm/s²/√Hz'),
                             (slice(3, 6), 'angular acceleration', 'rad/s²/√Hz')):
        both = np.sqrt([before[:, part], after[:, part]])
        # The same for all axes: what is small on one is to look small.
        limits = both.min() / ROOM, both.max() * ROOM
        panels += [Panel(f'{kind} {axis}', unit, (Line('before', 'before', one),
                                                  Line('after', 'after', other)), limits=limits)
                   for axis, one, other in zip('xyz', *np.swapaxes(both, 1, 2), strict=True)]
    return Chart('frequency', 'Hz', frequency, tuple(panels), (1.0, 1.0, 1.0), 2.5,
                 logarithmic=True)
