# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Every effect by name, and the vector that holds the parameters of all their forms.

The order of EFFECTS is the order in which they act, form by form.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects import (
    actuation_delay,
    attitude_misalignment,
    battery_sag,
    blade_flapping,
    body_drag,
    com_offset,
    external_wrench,
    ground_effect,
    gusts,
    gyro_bias,
    inertia_mismatch,
    inflow,
    mass_offset,
    motor_lag,
    rotor_drag,
    rotor_fault,
    rotor_gyro,
    thrust_scale,
    wind,
)
from quad_ident_ros.effects.base import Effect, Form, Hook, Parameter, Table
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.situation import ROWS

if TYPE_CHECKING:
    from quad_ident_ros.model.vehicle import Vehicle

Values = dict[str, dict[str, float]]
"""{effect: {parameter: value}}."""

EFFECTS: dict[str, Effect] = {module.EFFECT.name: module.EFFECT for module in (
    motor_lag, actuation_delay, rotor_drag, body_drag, wind, inflow, ground_effect, battery_sag,
    thrust_scale, mass_offset, inertia_mismatch, com_offset, rotor_fault, rotor_gyro,
    blade_flapping, attitude_misalignment, gyro_bias)}
# Not a cause but a measure: force and moment that no effect explains, whatever they come from.
RESIDUAL_WRENCH = external_wrench.EFFECT
# Nor is this one: air that moves as no vehicle makes it, differently in each flight.
GUSTS = gusts.EFFECT
MEASURES = (RESIDUAL_WRENCH, GUSTS)

# The usual form of each effect first, so that the vector begins with what most know of it.
FORMS: tuple[tuple[str, Form], ...] = (
    *((effect.name, effect.forms[0]) for effect in (*EFFECTS.values(), *MEASURES)),
    *((effect.name, form) for effect in EFFECTS.values() for form in effect.forms[1:]))
PARAMETERS: tuple[tuple[str, Parameter], ...] = tuple(
    (name, parameter) for name, form in FORMS for parameter in form.parameters)
NULL = np.array([parameter.null for _, parameter in PARAMETERS])
PLACES: dict[tuple[str, str], slice] = {}
"""Where in the vector the parameters of a form stand, by effect and form."""
for _name, _form in FORMS:
    _first = max((part.stop for part in PLACES.values()), default=0)
    PLACES[_name, _form.name] = slice(_first, _first + len(_form.parameters))
SLICES: dict[str, slice] = {effect.name: PLACES[effect.name, effect.forms[0].name]
                            for effect in (*EFFECTS.values(), *MEASURES)}
"""Where those of an effect's usual form stand."""
PLACE: dict[tuple[str, str], int] = {(name, parameter.name): place for place, (name, parameter)
                                     in enumerate(PARAMETERS)}
"""Where one parameter stands, by effect and parameter."""
# The rows of the table `s` of model.situation and, after them, one per form: whether it acts.
ROWS_OF: dict[tuple[str, str], int] = {key: ROWS + number for number, key in enumerate(PLACES)}
TABLE = ROWS + len(ROWS_OF)
OWNERS = np.array([ROWS_OF[name, form.name] for name, form in FORMS for _ in form.parameters])


def titled(name: str) -> str:
    """
    Return an effect, or a parameter of one, as a person reads it: the title, then the name.

    A name of anything else, such as a constant of the vehicle file, comes back as it is.
    """
    effect = EFFECTS.get(name.partition('.')[0])
    return name if effect is None else f'{effect.title} ({name})'


@lru_cache(maxsize=8)
def bounds(vehicle: Vehicle) -> Table:
    """
    Return the lower and upper bounds and the usual sizes of all parameters, (3, P), SI.

    Not to be written to.
    """
    table = np.array([parameter.bounds(vehicle) for _, parameter in PARAMETERS]).T
    table.flags.writeable = False
    return table


def fit_bounds(vehicle: Vehicle) -> Table:
    """Return the bounds within which all parameters are identified, (2, P), SI."""
    given = vector(vehicle.effects, vehicle)
    return np.array([parameter.fit_bounds(vehicle, value)
                     for (_, parameter), value in zip(PARAMETERS, given, strict=True)]).T


def vector(effects: Mapping[str, Mapping[str, float]], vehicle: Vehicle,
           where: str = 'effects') -> Table:
    """
    Return the parameter vector, (P,), of {effect: {parameter: value}}; absent ones have no effect.

    Raises InputError for an unknown effect or parameter and for a value out of bounds.
    """
    theta = NULL.copy()
    low, high, _ = bounds(vehicle)
    schema.check_keys(where, effects, EFFECTS)
    for name, values in effects.items():
        rotors = len(vehicle.rotors)
        known = [one.name for one in EFFECTS[name].parameters_for(rotors)]
        if isinstance(values, Mapping):
            beyond = [key for key in values if key not in known and (name, key) in PLACE]
            if beyond:
                raise InputError(f'{where}: {name}: {beyond[0]!r} is of a rotor that '
                                 f'{vehicle.name} does not have: its rotors are 1 to {rotors}')
        schema.check_keys(f'{where}: {name}', values, known)
        for key, value in values.items():
            place = PLACE[name, key]
            theta[place] = schema.number(f'{where}: {name}: {key}', value, low[place], high[place])
    return theta


def mapping(theta: Table) -> Values:
    """Return {effect: {parameter: value}} of what in a parameter vector (P,) is not null."""
    effects: Values = {}
    for value, null, (effect, parameter) in zip(theta, NULL, PARAMETERS, strict=True):
        if value != null:
            effects.setdefault(effect, {})[parameter.name] = float(value)
    return effects


def from_entries(entries: Iterable[str], start: Mapping[str, Mapping[str, float]],
                 where: str) -> Values:
    """
    Return {effect: {parameter: value}} of entries NAME:PARAMETER=VALUE over those of start.

    Raises InputError for entries of another form; the names are checked by vector.
    """
    effects = {name: dict(values) for name, values in start.items()}
    for entry in entries:
        name, colon, rest = entry.partition(':')
        parameter, sign, value = rest.partition('=')
        if '=' in value:
            raise InputError(f'{where} {entry}: one parameter at a time; repeat {where} for '
                             'each of them')
        if not (colon and sign):
            raise InputError(f'{where} {entry}: expected NAME:PARAMETER=VALUE, for example '
                             'rotor_drag:coefficient=0.1')
        effects.setdefault(name, {})[parameter] = schema.number(f'{where} {entry}', value)
    return effects


@compiled
def mark(theta: Table, s: Table) -> None:
    """Write into s which forms act in any lane: the others are passed over in flight."""
    s[ROWS:] = 0.0
    for n in range(len(NULL)):
        for i in range(s.shape[1]):
            if theta[n, i] != NULL[n]:
                s[OWNERS[n]] = 1.0


Link = tuple[Hook, int, int]    # a form's function, where its parameters begin, its row of s
AT_ONCE = 4     # links that are compiled as one function


def _chain(hook: str) -> Hook:
    """Return one compiled function that does what all forms do at a hook, one after another."""
    early = hook in BEFORE
    links: list[Link] = []
    for effect in (*EFFECTS.values(), *MEASURES):
        for form in effect.forms:
            key = effect.name, form.name
            function = getattr(form, hook)
            if function is not None:
                links.append((function, PLACES[key].start, ROWS_OF[key]))
    # Compilation takes as long as functions are many, and what they call is compiled in each.
    nothing: Link = (_nothing_early if early else _nothing, 0, 0)
    links += [nothing] * (-len(links) % AT_ONCE)
    some, both = (_some_early, _both_early) if early else (_some, _both)
    hooks = [some(*links[k:k + AT_ONCE]) for k in range(0, len(links), AT_ONCE)]
    while len(hooks) > 1:
        hooks = [both(*pair) if len(pair) > 1 else pair[0]
                 for pair in (hooks[k:k + 2] for k in range(0, len(hooks), 2))]
    return hooks[0]


@compiled(inlined=True)
def _nothing_early(_theta: Table, _place: int, _s: Table) -> None:
    pass


@compiled(inlined=True)
def _nothing(_theta: Table, _place: int, _s: Table, _rotors: Table) -> None:
    pass


def _some_early(one: Link, two: Link, three: Link, four: Link) -> Hook:
    (f, i, _), (g, j, _), (h, k, _), (o, m, _) = one, two, three, four

    @compiled(inlined=True)
    def act(theta: Table, s: Table) -> None:
        f(theta, i, s)
        g(theta, j, s)
        h(theta, k, s)
        o(theta, m, s)

    return act


def _some(one: Link, two: Link, three: Link, four: Link) -> Hook:
    (f, i, a), (g, j, b), (h, k, c), (o, m, d) = one, two, three, four

    @compiled(inlined=True)
    def act(theta: Table, s: Table, rotors: Table) -> None:
        if s[a, 0] != 0.0:
            f(theta, i, s, rotors)
        if s[b, 0] != 0.0:
            g(theta, j, s, rotors)
        if s[c, 0] != 0.0:
            h(theta, k, s, rotors)
        if s[d, 0] != 0.0:
            o(theta, m, s, rotors)

    return act


def _both_early(first: Hook, second: Hook) -> Hook:
    @compiled(inlined=True)
    def act(theta: Table, s: Table) -> None:
        first(theta, s)
        second(theta, s)

    return act


def _both(first: Hook, second: Hook) -> Hook:
    @compiled(inlined=True)
    def act(theta: Table, s: Table, rotors: Table) -> None:
        first(theta, s, rotors)
        second(theta, s, rotors)

    return act


BEFORE = ('body', 'air')    # hooks that act before the flight, and know nothing of the rotors
BODY, AIR, GUST, THRUST, WRENCH = (
    _chain(hook) for hook in ('body', 'air', 'gust', 'thrust', 'wrench'))
