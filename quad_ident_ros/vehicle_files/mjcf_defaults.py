# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Settings, defaults and orientations of an MJCF model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
import math

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.bodies import about, Pose, pose, turned
from quad_ident_ros.vehicle_files.xml_tree import Element

ACTUATORS = ('general', 'motor', 'position', 'velocity', 'intvelocity', 'damper', 'cylinder',
             'muscle', 'adhesion', 'plugin')
MAIN = 'main'
# What these shortcuts set of the actuators of a default class that holds them.
_FIXED = {'gainprm': '1', 'gaintype': 'fixed', 'biastype': 'none', 'dyntype': 'none',
          'dynprm': '1'}
_BIASED = {'gaintype': 'fixed', 'biastype': 'affine'}
_PART_BY_PART = 'size', 'gear'     # an element with fewer numbers has the others of its class
_TURNS = ('euler', 'axisangle', 'xyaxes', 'zaxis', 'quat')
_AXES = {'x': (1, 0, 0), 'y': (0, 1, 0), 'z': (0, 0, 1)}


@dataclass(frozen=True)
class Model:
    """
    An MJCF model: its root, what its <compiler> says, and its default classes.

    degrees: whether angles are in degrees; sequence: of the Euler angles; classes: attributes by
    class and tag, those of the classes around it included.
    """

    root: Element
    compiler: Mapping[str, str]
    classes: Mapping[str, Mapping[str, Mapping[str, str]]] = field(repr=False)

    @property
    def to_radians(self) -> float:
        """Factor from the angles of the model to rad."""
        return 1.0 if self.compiler.get('angle') == 'radian' else math.pi / 180.0

    def setting(self, name: str, usual: tuple[float, ...]) -> tuple[float, ...]:
        """Return numbers of the <compiler>, as many as the usual ones; InputError."""
        where = f'{self.root.path}: <compiler>: {name}'
        return usual if name not in self.compiler else schema.numbers(
            where, self.compiler[name].split(), len(usual))

    def whole(self, element: Element, inherited: str) -> Element:
        """
        Return an element with the attributes that its default class adds.

        Args: inherited: the childclass that holds where it stands, or ''.
        """
        name = element.get('class') or inherited or MAIN
        if name not in self.classes:
            raise InputError(f'{element.where}: no default class {name[:50]!r} is in the model')
        tag = 'actuator' if element.tag in ACTUATORS else element.tag
        usual = dict(self.classes[name].get(tag, {}))
        if any(turn in element.attributes for turn in _TURNS):
            usual = {key: value for key, value in usual.items() if key not in _TURNS}
        attributes = {**usual, **element.attributes}
        for key in usual.keys() & element.attributes.keys() & set(_PART_BY_PART):
            stated = element.get(key).split()
            attributes[key] = ' '.join([*stated, *usual[key].split()[len(stated):]])
        return replace(element, attributes=attributes)

    def pose_of(self, element: Element) -> Pose:
        """Return the Pose that the attributes of an element state; InputError."""
        return pose(element.numbers('pos', 3, (0.0, 0.0, 0.0)), self.rotation_of(element))

    def along(self, element: Element) -> tuple[Pose, float]:
        """Return the Pose and the length, m, of an element between two points (fromto)."""
        ends = element.numbers('fromto', 6)
        back = ends[:3] - ends[3:]      # MuJoCo has z point from the second to the first
        length = float(np.linalg.norm(back))
        if not length > 0.0:
            raise InputError(f'{element.where}: fromto: no {element.get("type", "sphere")} lies '
                             'between these points')
        return pose((ends[:3] + ends[3:]) / 2.0, onto(back / length)), length

    def rotation_of(self, element: Element) -> np.ndarray:
        """Return the rotation (3, 3) that the attributes of an element state; InputError."""
        if 'euler' in element.attributes:
            return self._euler(element)
        if 'axisangle' in element.attributes:
            values = element.numbers('axisangle', 4)
            return about(_direction(element, 'axisangle', values[:3]),
                         self.to_radians * values[3])
        if 'xyaxes' in element.attributes:
            values = element.numbers('xyaxes', 6)
            x = _direction(element, 'xyaxes', values[:3])
            y = _direction(element, 'xyaxes', values[3:] - x * (x @ values[3:]))
            return np.stack([x, y, np.cross(x, y)], axis=1)
        if 'zaxis' in element.attributes:
            return onto(_direction(element, 'zaxis', element.numbers('zaxis', 3)))
        values = element.numbers('quat', 4, (1.0, 0.0, 0.0, 0.0))
        _direction(element, 'quat', values)
        return turned(values)

    def _euler(self, element: Element) -> np.ndarray:
        angles = self.to_radians * element.numbers('euler', 3)
        sequence = self.compiler.get('eulerseq', 'xyz')
        if len(sequence) != 3 or any(letter.lower() not in _AXES for letter in sequence):
            raise InputError(f'{element.where}: eulerseq {sequence[:20]!r} of <compiler> is not '
                             'a sequence of three axes')
        rotation = np.eye(3)
        for letter, angle in zip(sequence, angles, strict=True):
            step = about(_AXES[letter.lower()], angle)
            # Small letters turn about the axes that turn along, capitals about fixed ones.
            rotation = rotation @ step if letter.islower() else step @ rotation
        return rotation


def model_of(root: Element) -> Model:
    """Return the Model of a <mujoco>; InputError for what is not expanded in it."""
    for element in root.walk():
        if element.tag in ('replicate', 'attach', 'composite', 'flexcomp'):
            raise InputError(f'{element.where}: it is not expanded here; save the compiled model '
                             'with `mj_saveLastXML` and give that file')
    compiler: dict[str, str] = {}
    for element in root.all('compiler'):
        compiler.update(element.attributes)
    if compiler.get('coordinate') == 'global':
        raise InputError(f'{root.path}: coordinate="global" of <compiler> is not read; save it '
                         'with local coordinates, as MuJoCo does since 2.3')
    classes: dict[str, dict[str, dict[str, str]]] = {MAIN: {}}
    for element in root.all('default'):
        _enter(classes, element, element.get('class') or MAIN, {})
    return Model(root, compiler, classes)


def onto(axis: np.ndarray) -> np.ndarray:
    """Return the smallest rotation (3, 3) that turns z onto a unit axis (3,)."""
    across = np.cross([0.0, 0.0, 1.0], axis)
    length = float(np.linalg.norm(across))
    if length < 1e-12:
        return np.eye(3) if axis[2] > 0 else about((1, 0, 0), math.pi)
    return about(across, math.atan2(length, float(axis[2])))


def _enter(classes: dict[str, dict[str, dict[str, str]]], element: Element, name: str,
           around: Mapping[str, Mapping[str, str]]) -> None:
    """Enter a default class and those within it."""
    inside = {tag: dict(values) for tag, values in (classes.get(name) or around).items()}
    for child in element.children:
        if child.tag != 'default':
            tag = 'actuator' if child.tag in ACTUATORS else child.tag
            sets = (_FIXED if child.tag == 'motor' else
                    _BIASED if tag == 'actuator' and child.tag != 'general' else {})
            inside.setdefault(tag, {}).update({**sets, **child.attributes})
    classes[name] = inside
    for child in element.all('default'):
        if not child.get('class'):
            raise InputError(f'{child.where}: a default within another needs a class')
        _enter(classes, child, child.get('class'), inside)


def _direction(element: Element, attribute: str, values: np.ndarray) -> np.ndarray:
    """Return a unit vector; InputError for zeros."""
    length = float(np.linalg.norm(values))
    if not length > 1e-12:
        raise InputError(f'{element.where}: {attribute}: zeros are not a direction; correct it')
    return values / length
