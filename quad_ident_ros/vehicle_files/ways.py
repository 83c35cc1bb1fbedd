# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How effects go into the numbers of a simulator's file, and what becomes of each."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
import math
from typing import Literal

from quad_ident_ros.effects.registry import EFFECTS, FORMS, Values

Key = Literal['mass', 'centre', 'inertia', 'moments', 'thrust', 'exponent', 'losses', 'torque',
              'torque_losses', 'speed_max', 'rise', 'fall', 'rotor_drag', 'linear_drag',
              'body_drag', 'inflow', 'flapping', 'wind', 'delay']
Keys = tuple[Key, ...]
BODY: Keys = ('mass', 'centre', 'inertia')
LAGS: Keys = ('rise', 'fall')


@dataclass(frozen=True)
class Way:
    """How a form goes into numbers: which, and what is lost, '' where nothing is."""

    keys: Keys
    lost: str = ''


_MEAN = Way(('thrust',), 'its mean factor on the thrust coefficient, the same at all times')
_AT_HOVER = Way(('thrust',), 'its factor at hover on the thrust coefficient, the same at all '
                'speeds')
_PLANE = Way(('rotor_drag',), 'the mean of x and y, scaled by rotor speed; along z nothing')
_STEADY = Way(('linear_drag',), 'the drag at hover, for all rotor speeds')
_BODY_DRAG, _LAG = Way(('body_drag',)), Way(LAGS)
WAYS: dict[tuple[str, str], tuple[Way, ...]] = {
    ('motor_lag', 'first_order'): (_LAG,),
    ('motor_lag', 'rise_fall'): (_LAG,),
    ('motor_lag', 'second_order'): (Way(LAGS, 'its mean lag as a time constant'),),
    ('rotor_drag', 'by_speed'): (Way(('rotor_drag',)), _STEADY),
    ('rotor_drag', 'axes'): (Way(('linear_drag',)), _PLANE),
    ('rotor_drag', 'axes_by_speed'): (_PLANE, _STEADY),
    ('body_drag', 'planar'): (_BODY_DRAG,),
    ('body_drag', 'axes'): (_BODY_DRAG,),
    ('wind', 'steady'): (Way(('wind',)),),
    ('actuation_delay', 'pure_delay'): (Way(('delay',)),),
    ('inflow', 'linear'): (Way(('inflow',)),),
    ('blade_flapping', 'hub_moment'): (Way(('flapping',)),),
    ('blade_flapping', 'damped_hub'): (Way(('flapping',), 'its moment with the velocity; the '
                                           'damping is lost'),),
    ('battery_sag', 'voltage'): (_MEAN,),
    ('battery_sag', 'time'): (_MEAN,),
    ('battery_sag', 'voltage_power'): (_MEAN,),
    ('battery_sag', 'time_and_load'): (_MEAN,),
    ('battery_sag', 'spent'): (_MEAN,),
    ('battery_sag', 'spent_and_load'): (_MEAN,),
    ('battery_sag', 'discharge'): (_MEAN,),
    ('thrust_scale', 'factor'): (Way(('thrust',), 'a factor on the thrust coefficient, which is '
                                     'the same motion'),),
    ('thrust_scale', 'exponent'): (Way(('thrust', 'exponent')), _AT_HOVER),
    ('thrust_scale', 'offset'): (Way(('thrust', 'exponent'), 'the power of the speed that it is '
                                     'at hover'), _AT_HOVER),
    ('thrust_scale', 'curve'): (_AT_HOVER,),
    ('rotor_fault', 'thrust'): (Way(('losses',)),),
    ('rotor_fault', 'thrust_and_torque'): (Way(('losses', 'torque_losses')),),
    ('mass_offset', 'at_centre'): (Way(('mass',), 'a part of the mass, which is the same '
                                       'motion'),),
    ('inertia_mismatch', 'factors'): (Way(('inertia',), 'a part of the inertia, which is the same '
                                          'motion'),),
    ('inertia_mismatch', 'matrix'): (Way(('inertia',), 'a part of the matrix of inertia, which is '
                                         'the same motion'),),
    ('inertia_mismatch', 'moments'): (Way(('moments',), 'the places of the rotors and their '
                                          'torque, which is the same motion'),),
    ('inertia_mismatch', 'moments_and_inertia'): (
        Way(('moments', 'inertia'), 'the places of the rotors, their torque and a part of the '
                                    'inertia, which is the same motion'),),
    ('com_offset', 'fixed'): (Way(('centre',), 'the place of the centre of mass, which is the '
                                  'same motion'),),
}
"""Of effects that a file of numbers can have, the best first; what is exact has nothing lost."""

NEEDS: dict[str, str] = {
    'actuation_delay': 'the format has no delay of commands; delay them in what sends them',
    'body_drag': 'the format has no drag with the square of the velocity of the air',
    'wind': 'a wind is of the world, not of the vehicle; state it there',
    'inflow': 'the format has no such loss of thrust with the velocity of the air',
    'ground_effect': 'the format has no thrust that depends on the height',
    'rotor_drag': 'the format has no drag of the rotors',
    'rotor_fault': 'the format has the same numbers for all rotors',
    'rotor_gyro': 'it comes from the inertia of the rotors, which is not changed, or is one '
                  'number for all of them',
    'blade_flapping': 'the format has no such moment with the velocity of the air',
    'attitude_misalignment': 'it is one of the sensors: turn that of the attitude or the IMU',
    'gyro_bias': 'it is one of the sensors: set it as the bias of the IMU',
    'com_offset': 'the format has its rotors at fixed places about the centre of mass',
    'motor_lag': 'the format has no such lag'}
"""Why an effect without a way is not carried; see why_not."""


def why_not(effect: str) -> str:
    """Return why a format of numbers does not carry an effect that has no way into it."""
    return NEEDS.get(effect, f'the format has no number for {EFFECTS[effect].title}')


@dataclass(frozen=True)
class Fate:
    """What becomes of an effect or a constant: its name, its form or '', and why."""

    name: str
    form: str
    reason: str


@dataclass(frozen=True)
class Fates:
    """All effects, and constants that changed, by what becomes of them; by_code: beside it."""

    carried: tuple[Fate, ...]
    by_code: tuple[Fate, ...]
    nearest: tuple[Fate, ...]
    not_carried: tuple[Fate, ...]

    def with_code(self, names: Collection[tuple[str, str]], said: str) -> Fates:
        """Return them with those of some (name, form) carried by the code beside the file."""
        def others(fates: tuple[Fate, ...]) -> tuple[Fate, ...]:
            return tuple(fate for fate in fates if (fate.name, fate.form) not in names)

        return Fates(others(self.carried), tuple(Fate(*name, said) for name in names),
                     others(self.nearest), others(self.not_carried))


def way_of(effect: str, form: str, holds: Collection[Key]) -> Way | None:
    """Return the best Way of a form into files of a kind, by what these have, or None."""
    return next((way for way in WAYS.get((effect, form), ()) if set(way.keys) <= set(holds)), None)


def forms_of(effects: Values) -> list[tuple[str, str, dict[str, float]]]:
    """Return (effect, form, its values) of all forms that act."""
    found = []
    for effect, form in FORMS:
        values = effects.get(effect, {})
        inside = {parameter.name: values[parameter.name] for parameter in form.parameters
                  if parameter.name in values}
        if inside:
            found.append((effect, form.name, inside))
    return found


def fates_of(effects: Values, base_effects: Values, holds: Collection[Key],
             lacking: Mapping[str, str], nearest: Mapping[str, str], sag: float | None) -> Fates:
    """
    Return what becomes of each form of each effect by the numbers of a file.

    Args: base_effects: what the file has by itself; holds: what files of its kind have; lacking
    and nearest: as of Edits, of this file; sag: as of wanted_of.
    """
    carried: list[Fate] = []
    near: list[Fate] = []
    not_carried: list[Fate] = []
    forms = forms_of(effects)
    lag = next((form for form in ('first_order', 'rise_fall', 'second_order')
                if ('motor_lag', form) in [each[:2] for each in forms]), '')
    for effect, form, values in forms:
        way = way_of(effect, form, holds)
        keys = (effect, *(way.keys if way else ()))
        reason = next((lacking[key] for key in keys if key in lacking), '')
        if way is None and _alike(values, base_effects.get(effect, {})):
            carried.append(Fate(effect, form, 'the file has it already'))
        elif way is None or reason:
            not_carried.append(Fate(effect, form, reason or why_not(effect)))
        elif effect == 'battery_sag' and sag is None:
            not_carried.append(Fate(effect, form, 'its mean depends on the flight; name one by '
                                    '--flight'))
        elif effect == 'motor_lag' and form != lag:
            not_carried.append(Fate(effect, form, f'the file has one lag, that of the form {lag}'))
        else:
            lost = next((nearest[key] for key in keys if key in nearest), way.lost)
            (near if lost else carried).append(Fate(effect, form, lost or 'as it is'))
    return Fates(tuple(carried), (), tuple(near), tuple(not_carried))


def _alike(values: Mapping[str, float], others: Mapping[str, float]) -> bool:
    """Whether all values equal those of others."""
    return all(key in others and math.isclose(value, others[key], rel_tol=1e-9)
               for key, value in values.items())
