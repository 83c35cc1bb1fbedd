# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Motor plugins of Gazebo: MulticopterMotorModel, and the one of Gazebo Classic before it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
import math

import numpy as np

from quad_ident_ros.effects.registry import titled, Values
from quad_ident_ros.effects.rotor_gyro_by_spin import values_of
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.reading import Draft, per_sum_of_speeds
from quad_ident_ros.vehicle_files.weak_rotors import faults_of, note_losses, SAME
from quad_ident_ros.vehicle_files.xml_tree import Element

_PLUGINS = ('multicopter-motor-model', 'multicoptermotormodel', 'gazebo_motor_model')
# PX4's plugin of Gazebo Classic takes the axial speed over this, in m/s, from the thrust; its code
# has the number, no file has. Older versions took the whole speed; RotorS, from which it came, and
# gz-sim take none.
_CLASSIC, _NO_THRUST = 'libgazebo_motor_model.so', 25.0
TURNS = {'cw': 1, 'ccw': -1}
"""Signs of the reaction torque by the direction in which a rotor turns, seen from above."""
EQUAL = 1e-6    # relative: inertias of rotors that differ by less are rounded
# Tag, what it is where the tag is missing (in the code of the plugin), unit.
_NUMBERS = {'motorConstant': (8.54858e-6, 'N/(rad/s)^2'), 'momentConstant': (0.016, 'm'),
            'timeConstantUp': (1 / 80, 's'), 'timeConstantDown': (1 / 40, 's'),
            'maxRotVelocity': (838.0, 'rad/s'), 'rotorDragCoefficient': (1e-4, 'kg/rad'),
            'rollingMomentCoefficient': (1e-6, 'kg m/rad'),
            'rotorVelocitySlowdownSim': (10.0, '1')}


@dataclass(frozen=True)
class MotorPlugin:
    """A motor plugin: its element, joint, link and number, spin of the rotor, and its numbers."""

    element: Element
    joint: str
    link: str
    number: int
    spin: int
    numbers: dict[str, float]


def motor_plugins(model: Element) -> list[MotorPlugin]:
    """Return the motor plugins that are children of an element, by their motorNumber."""
    found = [_plugin(element) for element in model.all('plugin') if _is_motor(element)]
    return sorted(found, key=lambda plugin: plugin.number)


def check_numbers(plugins: Sequence[MotorPlugin]) -> None:
    """Raise InputError where two plugins have the same number, joint or link."""
    for known, what in ((lambda plugin: plugin.number, 'motorNumber'),
                        (lambda plugin: plugin.joint, 'jointName')):
        seen: dict[object, MotorPlugin] = {}
        for plugin in plugins:
            other = seen.setdefault(known(plugin), plugin)
            if other is not plugin:
                raise InputError(f'{plugin.element.where}: {what} {known(plugin)} is that of the '
                                 f'plugin in line {other.element.line} too; give each motor its '
                                 'own')


def take_motors(draft: Draft, plugins: Sequence[MotorPlugin], spinning: Sequence[float],
                place: Callable[[Element, str], str]) -> None:
    """
    Enter coefficients, limits and effects of the motors.

    Args: spinning: moments of inertia of the rotors about their axes, kg m^2; place: of an element
    and a tag in it.
    """
    constants = [plugin.numbers['motorConstant'] for plugin in plugins]
    faults = faults_of(constants, [plugin.numbers['motorConstant']
                                   * plugin.numbers['momentConstant'] for plugin in plugins])
    if faults:      # the strongest one stands for all
        best = plugins[constants.index(max(constants))]
        plugins = [replace(plugin, numbers={**plugin.numbers, **{
            tag: best.numbers[tag] for tag in ('motorConstant', 'momentConstant')}})
            for plugin in plugins]
        note_losses(draft, faults, len(plugins), place(best.element, 'motorConstant'))
    values = {tag: _common(plugins, tag) for tag in _NUMBERS}
    first = plugins[0].element
    constant, ratio = values['motorConstant'], values['momentConstant']
    draft.take('thrust_coefficient', constant, 'N/(rad/s)^2', place(first, 'motorConstant'))
    draft.take('torque_coefficient', constant * ratio, 'N m/(rad/s)^2',
               place(first, 'motorConstant x momentConstant'))
    draft.take('speed_max', values['maxRotVelocity'], 'rad/s', place(first, 'maxRotVelocity'))
    for tag in list(_NUMBERS)[1:]:
        if tag != 'maxRotVelocity':
            draft.note(tag, values[tag], _NUMBERS[tag][1], place(first, tag))
    absent = [tag for tag in _NUMBERS if first.first(tag) is None]
    if absent:
        draft.assumed.append('the usual values of the plugin, which does not name them: '
                             + ', '.join(f'{tag} {values[tag]:g}' for tag in absent))
    slow = values['rotorVelocitySlowdownSim']
    inertia = float(np.mean(spinning)) / slow
    momentum = {'rotor_inertia': inertia}
    if inertia > 0.0:
        draft.take('rotor_inertia', inertia, 'kg m2', f'inertial of the rotors / {slow:g}')
    if not np.allclose(spinning, np.mean(spinning), rtol=EQUAL, atol=0.0):
        of_spin = {spin: [one / slow for one, plugin in zip(spinning, plugins, strict=True)
                          if plugin.spin == spin] or [inertia] for spin in TURNS.values()}
        apart = values_of({spin: float(np.mean(some)) for spin, some in of_spin.items()})
        momentum = momentum if apart is None else apart
        draft.assumed.append('the inertias of the rotors differ: each acts as the mean of '
                             + ('all: those of one spin have over 1.5 times those of the other'
                                if apart is None else 'those of its spin'))
    rolling = values['rollingMomentCoefficient']
    if rolling > 0.0:
        draft.assumed.append(
            f'rollingMomentCoefficient {rolling:g} is left out: its moment lies along the air '
            f'velocity, that of {titled("blade_flapping")} across it')
    draft.assumed.append(
        f'speeds are those of the rotors; the joints turn {slow:g} times slower '
        '(rotorVelocitySlowdownSim)')

    classic = first.get('filename') == _CLASSIC
    if classic:
        draft.assumed.append(
            f'thrust falls by the speed along the axis over {_NO_THRUST:g} m/s, up or down, as in '
            f'the code of {_CLASSIC} of PX4; older versions took the whole speed')

    def effects(vehicle: Vehicle) -> Values:
        rise, fall = values['timeConstantUp'], values['timeConstantDown']
        drag = per_sum_of_speeds(values['rotorDragCoefficient'], vehicle)
        return {'motor_lag': ({'time_constant': rise} if rise == fall else
                              {'rise': rise, 'fall': fall}),
                'rotor_drag': {'coefficient': drag}, 'rotor_gyro': momentum,
                **({'inflow': {'by_axial_speed': 1.0 / _NO_THRUST}} if classic else {}),
                **faults}

    draft.effects = effects


def _is_motor(element: Element) -> bool:
    said = f'{element.get("filename")} {element.get("name")}'.lower()
    return any(word in said for word in _PLUGINS)


def _plugin(element: Element) -> MotorPlugin:
    texts = {}
    for tag in ('jointName', 'linkName', 'turningDirection'):
        child = element.first(tag)
        if child is None or not child.text.strip():
            raise InputError(f'{element.where}: <{tag}> is missing; add it')
        texts[tag] = child.text.strip()
    direction, kind = texts['turningDirection'], element.first('motorType')
    if direction not in TURNS:
        raise InputError(f'{element.where}: turningDirection: {direction[:20]!r} is neither cw '
                         'nor ccw')
    if kind is not None and kind.text.strip() not in ('velocity', ''):
        raise InputError(f'{element.where}: motorType {kind.text.strip()[:20]!r} turns no rotor '
                         'that lifts; expected velocity')
    numbers = {tag: element.value(tag, usual) for tag, (usual, _) in _NUMBERS.items()}
    for tag, value in numbers.items():
        if value < 0.0 or value == 0.0 and tag in ('motorConstant', 'maxRotVelocity',
                                                   'rotorVelocitySlowdownSim'):
            raise InputError(f'{element.where}: {tag}: {value:g} is impossible; correct it')
    return MotorPlugin(element, texts['jointName'], texts['linkName'],
                       int(element.value('motorNumber', 0.0)), TURNS[direction], numbers)


def _common(plugins: Sequence[MotorPlugin], tag: str) -> float:
    """Return the number that all plugins share; InputError where two differ."""
    first = plugins[0].numbers[tag]
    for plugin in plugins[1:]:
        if not math.isclose(plugin.numbers[tag], first, rel_tol=SAME):
            raise InputError(f'{plugin.element.where}: {tag} is {plugin.numbers[tag]:g}, that of '
                             f'the plugin in line {plugins[0].element.line} is {first:g}; a '
                             'vehicle has the same rotors everywhere')
    return first
