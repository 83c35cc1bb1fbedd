# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How well the parameters that a diagnosis estimated are known together."""

from collections.abc import Mapping

import numpy as np
import scipy

from quad_ident_ros.diagnose.bench import Bench, given, Model
from quad_ident_ros.diagnose.fitted import columns_at_bounds
from quad_ident_ros.greybox.parameters import NAMES
from quad_ident_ros.model.covariance import Covariance, covariance_of_matrix


def known_together(bench: Bench, model: Model, probability: Mapping[str, float]
                   ) -> Covariance | None:
    """
    Return the Covariance of a Model's columns, and of constants whose file states a deviation.

    None where there is neither; without those that end at a bound. The correlation is that of the
    Joint of the best set, or that by the noise of a model which has other forms; deviations are
    the reported standard errors, but for constants without a stated deviation: the vehicle of this
    covariance has them as they are. probability {effect: of being present}, of those that the
    model has not.
    """
    best, joint = bench.selection.best.estimate, bench.selection.joint
    columns, constants = model.estimate.columns, joint.constants
    if not columns and not constants:
        return None
    errors = bench.errors(model)
    if set(columns) <= set(best.columns):
        count = len(best.columns)
        whole = joint.stated.copy()
        whole[:count, :count] += bench.selection.covariance - joint.covariance
        gone = [best.columns.index(column) for column in bench.taken_out(model)]
        whole = given(whole, gone)[1] if gone else whole
        places = [*(best.columns.index(column) for column in columns),
                  *range(count, count + len(constants))]
        whole = whole[np.ix_(places, places)]
    else:
        told = np.array([errors[column] for column in columns])
        scale = told / np.maximum(model.estimate.errors, 1e-300)
        first = len(best.columns)
        whole = scipy.linalg.block_diag(model.estimate.covariance * np.outer(scale, scale),
                                        joint.stated[first:, first:])
    shift = bench.shift_by_absent(model, probability)
    whole[:len(columns), :len(columns)] += np.outer(shift, shift)
    # What ends at a bound is no estimate.
    held = {column for cause in model.effects
            for column in columns_at_bounds(cause, model.z, bench.vehicle, bench.rules)}
    kept = [place for place, column in enumerate(columns) if column not in held]
    names = (*(NAMES[columns[place]] for place in kept), *constants)
    places = [*kept, *range(len(columns), len(whole))]
    return covariance_of_matrix(names, whole[np.ix_(places, places)]) if names else None
