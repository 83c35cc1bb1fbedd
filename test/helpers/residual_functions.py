# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Residual functions that tests fly: some of one input, and a force that no effect has."""

from dataclasses import replace

from quad_ident_ros.model.residual_function import Input, ResidualFunction, Wave

NONE = (0.0,) * 6
WIDE = 1e6


def linear(name, weights, low=-WIDE, high=WIDE):
    """Return the function of one input whose slopes, (6,) per unit of it, are the weights."""
    half = 0.5 * (high - low)
    middle = 0.5 * (low + high)
    return ResidualFunction((WIDE,) * 6, tuple(middle * one for one in weights),
                            ((name, Input(low, high, tuple(half * one for one in weights))),), ())


def constant(wrench):
    """Return the function that is the same force and moment (6,) everywhere."""
    return ResidualFunction((WIDE,) * 6, tuple(wrench), (), ())


def times(factor, function):
    """Return a function that is everywhere a factor times another one."""
    def by(weights):
        return tuple(factor * one for one in weights)
    return replace(function, limit=by(function.limit), constant=by(function.constant),
                   inputs=tuple((name, replace(one, weights=by(one.weights)))
                                for name, one in function.inputs),
                   waves=tuple(replace(one, weights=by(one.weights))
                               for one in function.waves))


# Smooth in the velocity of the air, odd in nothing, across it: no law of drag is alike.
AIR = tuple((f'air_{axis}', Input(-2.0, 2.0, NONE)) for axis in 'xyz')
STRANGE = ResidualFunction((3.0,) * 6, NONE, AIR, (
    Wave((0, 0, 0), (2.5, 0.0, 0.0), 0.5, (0.0, 0.3, 0.3, 0.0, 0.0, 0.0)),
    Wave((1, 2, 1), (2.0, 2.0, 0.0), 0.5, (0.4, 0.0, 0.0, 0.0, 0.0, 0.0))))
