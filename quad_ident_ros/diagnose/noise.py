# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The noise of the measurement: what a perfect model would be off by."""

import numpy as np

from quad_ident_ros.diagnose.gap import HEADLINE, Noise
from quad_ident_ros.diagnose.intake import Intake
from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.diagnose.select import Selection
from quad_ident_ros.greybox.errors import GROUPS
from quad_ident_ros.greybox.kinematics import measurement_noise
from quad_ident_ros.greybox.noise import near_noise, quick_noise


def noise_of(selection: Selection, intake: Intake, rules: Rules) -> Noise:
    """
    Return the Noise of the flights, from the residuals of the best set and from kinematics.

    The part of the attitude's noise that hangs together counts as a tilt, what changes from
    sample to sample as its mean over a prediction. The states of a filter that levels itself show
    little noise, and their tilt not at all: it is taken as usual ones are.
    """
    best = selection.best.estimate
    near, white = (np.median([kind(raw) for raw in best.residuals], axis=0)
                   for kind in (near_noise, quick_noise))
    deviation = measurement_noise(intake.flights, best.vectors, near, white)
    attitude, position = GROUPS['attitude'], GROUPS['position']
    period = float(np.median([flight.period for flight in intake.flights]))
    steady = max(0.0, float(np.mean(deviation[attitude] ** 2 - white[attitude] ** 2)))
    mean = float(np.mean(white[attitude] ** 2)) * period / HEADLINE
    levels = (np.mean(near[attitude]) < rules.filtered_attitude
              and np.mean(near[position]) > rules.tracked_position)
    level, drift = (rules.levelling, rules.drift) if levels else (0.0, 0.0)
    return Noise(deviation, float(np.sqrt(steady + mean + level ** 2)), drift)
