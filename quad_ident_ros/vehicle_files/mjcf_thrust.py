# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Actuators of an MJCF model that push at a site: thrusts of rotors."""

from collections.abc import Sequence
from dataclasses import dataclass
import math

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.bodies import Pose
from quad_ident_ros.vehicle_files.mjcf_defaults import Model
from quad_ident_ros.vehicle_files.weak_rotors import SAME
from quad_ident_ros.vehicle_files.xml_tree import Element, SHOWN

STEP = 0.002    # s, of MuJoCo where a model does not say it


@dataclass(frozen=True)
class Push:
    """
    What an actuator does at a site, per unit of its control.

    site: its name; force (3,) N, moment (3,) N m, axes of the vehicle's body; place (3,) m; limits
    of the control, infinite where it has none; lag: time constant s of the force, 0 for none;
    delay: of the control, s.
    """

    element: Element
    site: str
    force: np.ndarray
    moment: np.ndarray
    place: np.ndarray
    limits: tuple[float, float]
    lag: float
    delay: float

    @property
    def pushes(self) -> bool:
        """Whether it is a force, not a moment alone."""
        return float(np.linalg.norm(self.force)) > 0.0


def pushes_of(model: Model, sites: dict[str, tuple[Pose, Element]]) -> list[Push]:
    """Return what the actuators do at the sites (Pose in body axes) of a vehicle; InputError."""
    known = {element.get('name') for element in model.root.walk() if element.tag == 'site'}
    options = model.root.all('option')
    off = {group for option in options for group in option.get('actuatorgroupdisable').split()}
    for flag in (flag for option in options for flag in option.all('flag')):
        if flag.get('actuation') == 'disable':
            raise InputError(f'{flag.where}: actuation="disable" stops all rotors; take it out')
    found = []
    for holder in model.root.all('actuator'):
        for child in holder.children:
            if child.get('site') and child.get('site') not in known:
                raise InputError(f'{child.where}: no site {child.get("site")[:SHOWN]!r} is in the '
                                 'model; correct the name')
            if child.get('site') in sites and child.tag in ('motor', 'general'):
                element = model.whole(child, '')
                if element.get('group', '0') not in off:
                    found.append(_push(model, element, sites[child.get('site')][0]))
    return found


def common(pushes: Sequence[Push], values: Sequence[float], what: str) -> float:
    """Return the value that all rotors share; InputError that names the first other one."""
    for push, value in zip(pushes, values, strict=True):
        if not math.isclose(value, values[0], rel_tol=SAME, abs_tol=1e-12):
            raise InputError(f'{push.element.where}: {what} is {value:.6g}, that of the one in '
                             f'line {pushes[0].element.line} is {values[0]:.6g}; a vehicle has '
                             'the same rotors everywhere')
    return values[0]


def _push(model: Model, element: Element, site: Pose) -> Push:
    if 'refsite' in element.attributes:
        raise InputError(f'{element.where}: refsite is not read; let it act in the axes of its '
                         'site')
    # Of a <motor> MuJoCo has a gain of 1 and nothing else, whatever the defaults of actuators say.
    general = element.tag == 'general'
    if general and (element.get('biastype', 'none') != 'none'
                    or element.get('gaintype', 'fixed') != 'fixed'):
        raise InputError(f'{element.where}: its force depends on more than its control (gaintype, '
                         'biastype); rotors are read of actuators with a fixed gain')
    gear = np.zeros(6)
    words = element.get('gear', '1').split()
    gear[:len(words)] = element.numbers('gear', len(words), (1.0,))[:6]
    gain = _first(element, 'gainprm') if general else 1.0
    kind = element.get('dyntype', 'none') if general else 'none'
    if kind not in ('none', 'filter', 'filterexact'):
        raise InputError(f'{element.where}: dyntype {kind[:20]!r} is not a lag; expected none or '
                         'filter')
    lag = 0.0 if kind == 'none' else _first(element, 'dynprm')
    return Push(element, element.get('site'), gain * site.rotation @ gear[:3],
                gain * site.rotation @ gear[3:], site.position, _limits(model, element, gain),
                lag, _delay(model, element))


def step_of(model: Model) -> float:
    """Return the time step of a model, s."""
    steps = [option.number('timestep') for option in model.root.all('option')
             if option.get('timestep')]
    return steps[-1] if steps else STEP


def _delay(model: Model, element: Element) -> float:
    """Return the delay of a control, s; InputError where MuJoCo keeps no controls for so long."""
    delay = element.number('delay', 0.0)
    step = step_of(model)
    if delay > element.number('nsample', 0.0) * step * (1.0 + SAME):
        raise InputError(f'{element.where}: nsample is less than its delay of {delay:g} s takes '
                         f'in steps of {step:g} s; increase it')
    return delay


def _first(element: Element, attribute: str) -> float:
    """Return the first number of an attribute, of which MuJoCo has 1 where it is not stated."""
    return float(element.numbers(attribute, max(len(element.get(attribute, '1').split()), 1),
                                 (1.0,))[0])


def _limits(model: Model, element: Element, gain: float) -> tuple[float, float]:
    """Return the least and the most control, by its range and by that of the force."""
    low, high = -math.inf, math.inf
    for name, factor in (('ctrl', 1.0), ('force', gain)):
        if f'{name}range' not in element.attributes:
            continue
        limited = element.get(f'{name}limited', 'auto')
        if limited == 'false' or limited == 'auto' and model.compiler.get('autolimits') == 'false':
            continue
        if factor == 0.0:
            raise InputError(f'{element.where}: a gain of 0 pushes nothing; correct gainprm')
        ends = sorted(element.numbers(f'{name}range', 2) / factor)
        low, high = max(low, ends[0]), min(high, ends[1])
    return low, high
