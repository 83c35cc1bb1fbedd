# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
How far errors of the recorded commands may have moved what is fitted.

A vehicle answers the commands that it is given, not those that are logged. Where these have
errors, as in a log that is slower than the controller, a fit makes the vehicle seem to answer
less than it does. How much less is bounded by the regression and its reverse: Frisch's
bounds (Klepper and Leamer, Econometrica 52, 1984).
"""

import numpy as np

from quad_ident_ros.diagnose.gap import Noise
from quad_ident_ros.effects.base import Parameter
from quad_ident_ros.effects.registry import PARAMETERS
from quad_ident_ros.greybox.errors import ERRORS, GROUPS
from quad_ident_ros.greybox.estimate import Estimate
from quad_ident_ros.greybox.linear import Slopes
from quad_ident_ros.greybox.parameters import SPLIT

RATES = {axis: GROUPS['rate'].start + k for k, axis in enumerate(('roll', 'pitch', 'yaw'))}


def gains(columns: list[int]) -> dict[int, Parameter]:
    """Return {column: parameter} of those that the answer to commands grows or falls with."""
    rows = {column: PARAMETERS[column - SPLIT][1] for column in columns if column >= SPLIT}
    return {column: one for column, one in rows.items() if one.gain and one.excited_by in RATES}


def ranges(fit: Estimate, slopes: Slopes, noise: Noise) -> dict[int, tuple[float, float]]:
    """
    Return {column: (least, most)} of the values that parameters may have in truth.

    One end is the value that was fitted, where the commands have no errors; the other one where
    all that is left of the rate about an axis, beyond the noise of its measurement, is by errors
    of the commands. Args: slopes: at the fit, in its columns.
    """
    found = {}
    for column, parameter in gains(fit.columns).items():
        axis, value = RATES[str(parameter.excited_by)], float(fit.z[column])
        row = ERRORS + slopes.columns.index(column)
        # The initial states of rollouts take a constant of each rate.
        answer = np.concatenate([
            _centred(tangent.table[:, row].reshape(len(tangent.table), -1, ERRORS)[..., axis])
            for tangent in slopes.tangents]) * value
        left = np.concatenate([_centred(one[..., axis]) for one in fit.residuals])
        size = float(np.mean(answer ** 2))
        errors = max(float(np.mean(left ** 2)) - float(noise.deviation[axis]) ** 2, 0.0)
        other = value * (1.0 + errors / max(size, 1e-300)) ** parameter.gain
        found[column] = (min(value, other), max(value, other))
    return found


def _centred(values: np.ndarray) -> np.ndarray:
    """Return values (B, N) of rollouts less the mean of each, as one row."""
    return (values - values.mean(axis=1, keepdims=True)).ravel()
