# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""URDF robots, also with properties of gym-pybullet-drones or motor plugins of Gazebo."""

from collections.abc import Sequence
import math
import re

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.bodies import Body, check_body, combined, spun
from quad_ident_ros.vehicle_files.gz_motors import (
    check_numbers,
    motor_plugins,
    MotorPlugin,
    take_motors,
)
from quad_ident_ros.vehicle_files.reading import Draft
from quad_ident_ros.vehicle_files.rotor_axes import check_axis
from quad_ident_ros.vehicle_files.source import one_of, Source
from quad_ident_ros.vehicle_files.urdf_links import Link, trees_of
from quad_ident_ros.vehicle_files.xml_tree import Element, parse, root_of

GRAVITY = 9.80665   # m/s^2, standard
PYBULLET_GRAVITY = 9.8      # m/s^2, in the code of gym-pybullet-drones
# Of bodies of Bullet where nobody sets it, as gym-pybullet-drones does not: they are slowed by
# DAMPING (1 + speed) speed, m/s^2 with speed in m/s, and their rate likewise, rad/s^2.
DAMPING = 0.04
PER_RPM = (30.0 / math.pi) ** 2     # from per rpm^2 to per (rad/s)^2
PROPS = tuple(f'prop{k}_link' for k in range(4))
PROP_SPINS = (-1, 1, -1, 1)     # of gym-pybullet-drones; those of its racer are the other way
RACER = 'racer'     # the file that its code takes for that model
_ROTOR = re.compile(r'rotor|prop', re.IGNORECASE)
_TURNS = (re.compile(r'(?<![a-z])ccw(?![a-z])', re.IGNORECASE), -1), (
    re.compile(r'(?<![a-z])cw(?![a-z])', re.IGNORECASE), 1)


def recognises(text: str) -> bool:
    """Whether a text is a URDF."""
    return root_of(text) == 'robot'


def read(source: Source) -> Draft:
    """Return the Draft of a URDF; raises InputError."""
    root = parse(source.path, source.text)
    links = links_of(source, root)
    draft = Draft(source.path, root.get('name') or source.stem)
    plugins, rotors = plugins_of(root), rotors_of(root, links)
    properties = root.first('properties')
    whole = _take_bodies(draft, links, rotors)
    for rotor in rotors:
        axis = rotor.axis if rotor.moves and not plugins else np.array([0.0, 0.0, 1.0])
        along = rotor.pose.rotation @ axis / max(float(np.linalg.norm(axis)), 1e-12)
        # A joint may turn about -z just as well: its thrust is along +z.
        check_axis(draft, along if plugins else along * math.copysign(1.0, along[2]),
                   (rotor.joint or rotor.element).where)
    draft.data['gravity'] = PYBULLET_GRAVITY if properties is not None else GRAVITY
    draft.assumed.append(f'gravity {draft.data["gravity"]:g} m/s2: a URDF has none'
                         + (', gym-pybullet-drones takes this' if properties is not None else ''))
    if plugins:
        _take_plugins(draft, plugins, rotors, whole)
    elif properties is not None and set(PROPS) <= links.keys():
        _take_properties(draft, properties, rotors, whole, source)
        _take_damping(draft)
        others = [name for name in links if _ROTOR.search(name) and name not in PROPS]
        if others:
            draft.assumed.append('gym-pybullet-drones flies with prop0_link to prop3_link; these '
                                 f'carry nothing: {", ".join(others[:5])}')
    else:
        _take_names(draft, rotors, whole)
    return draft


def links_of(source: Source, root: Element) -> dict[str, Link]:
    """Return the links of the vehicle in a <robot>, by name; InputError."""
    return one_of(source, _heavy(root, trees_of(root)), 'tree of links')


def plugins_of(root: Element) -> list[MotorPlugin]:
    """Return the motor plugins of Gazebo in a <robot>, by their numbers."""
    return sorted((plugin for holder in root.all('gazebo')
                   for plugin in motor_plugins(holder)), key=lambda each: each.number)


def rotors_of(root: Element, links: dict[str, Link]) -> list[Link]:
    """Return the links that are rotors, by plugins, properties or names."""
    plugins = plugins_of(root)
    if plugins:
        check_numbers(plugins)
        return [_known(links, plugin.link, plugin.element) for plugin in plugins]
    if root.first('properties') is not None and set(PROPS) <= links.keys():
        return [links[name] for name in PROPS]
    return _by_name(links)


def _heavy(root: Element, trees: dict[str, dict[str, Link]]) -> dict[str, dict[str, Link]]:
    """Return the trees that have a mass; InputError where none has."""
    heavy = {name: links for name, links in trees.items()
             if any(link.body is not None and link.body.mass > 0.0 for link in links.values())}
    if not heavy:
        raise InputError(f'{root.where}: no link of it has an <inertial> with a mass, so that '
                         'only its shapes are known; add mass and inertia to its base link')
    return heavy


def _by_name(links: dict[str, Link]) -> list[Link]:
    """Return the links that are rotors by their names: those that turn, else all of them."""
    named = [link for name, link in links.items()
             if _ROTOR.search(name) or link.joint is not None
             and _ROTOR.search(link.joint.get('name'))]
    turning = [link for link in named if link.joint is not None
               and link.joint.get('type') in ('continuous', 'revolute')]
    return turning or named


def bodies_of(draft: Draft, links: dict[str, Link], rotors: Sequence[Link]) -> dict[str, Body]:
    """Return the bodies of the links that have a mass, by name, in the axes of the root."""
    bodies: dict[str, Body] = {}
    bare, moving = [], []
    for name, link in links.items():
        if link.body is None:
            if link.element.all('visual', 'collision'):
                bare.append(name)
            continue
        remark = check_body(link.element.where, link.body)
        if remark:
            draft.assumed.append(f'{link.element.place()}: {remark}')
        body = link.body
        if link.moves and any(link is rotor for rotor in rotors):
            body = spun(body, link.axis)
        elif link.moves:
            moving.append(name)
        if body.mass > 0.0:
            draft.note(f'link {name}', body.mass, 'kg', link.element.place('inertial'))
            bodies[name] = body.placed(link.pose)
    for names, said in ((bare, 'links with shapes and no <inertial> are taken without mass'),
                        (moving, 'links that move and are not rotors are taken as fixed where '
                         'they start')):
        if names:
            draft.assumed.append(f'{said}: {", ".join(names[:5])}')
    if any(rotor.moves and rotor.body is not None and rotor.body.mass > 0 for rotor in rotors):
        draft.assumed.append('the inertia of a rotor is its mean over a turn')
    return bodies


def _take_bodies(draft: Draft, links: dict[str, Link], rotors: Sequence[Link]) -> Body:
    """Enter mass and inertia of all links, and return them as one."""
    whole = combined(list(bodies_of(draft, links, rotors).values()))
    base = next(link for link in links.values() if link.joint is None)
    draft.take_body(whole, f'{base.element.place()} with all links attached to it')
    return whole


def _take_names(draft: Draft, rotors: Sequence[Link], whole: Body) -> None:
    """Enter rotors whose names say what they are."""
    for key in ('thrust_coefficient', 'torque_coefficient'):
        draft.reasons[key] = 'a URDF says nothing of thrust'
    if not rotors:
        draft.reasons['rotors'] = 'no link or joint is called rotor or prop'
        return
    spins = []
    for rotor in rotors:
        names = f'{rotor.element.get("name")} {rotor.joint.get("name") if rotor.joint else ""}'
        spins.append(next((spin for pattern, spin in _TURNS if pattern.search(names)), None))
    draft.reasons['spins'] = 'the names of the rotors do not say cw or ccw'
    draft.take_rotors([rotor.centre - whole.centre for rotor in rotors], spins,
                      f'lines {", ".join(str(rotor.element.line) for rotor in rotors)}: <link>')
    draft.assumed.append('rotors are the links or joints with rotor or prop in their names, in '
                         'the order of the file: '
                         + ', '.join(rotor.element.get('name') for rotor in rotors[:8]))


def _take_plugins(draft: Draft, plugins: Sequence[MotorPlugin], rotors: Sequence[Link],
                  whole: Body) -> None:
    """Enter rotors with motor plugins of Gazebo."""
    draft.take_rotors([rotor.centre - whole.centre for rotor in rotors],
                      [plugin.spin for plugin in plugins], plugins[0].element.place()
                      + f' and {len(plugins) - 1} more')
    spinning = []
    for rotor in rotors:
        axis = rotor.axis / np.linalg.norm(rotor.axis)
        inertia = np.zeros((3, 3)) if rotor.body is None else rotor.body.inertia
        spinning.append(float(axis @ inertia @ axis))
    take_motors(draft, plugins, spinning, lambda element, tag: element.place(tag))


def _take_properties(draft: Draft, properties: Element, rotors: Sequence[Link], whole: Body,
                     source: Source) -> None:
    """Enter rotors and coefficients as gym-pybullet-drones has them."""
    turn = -1 if source.stem == RACER else 1
    draft.take_rotors([rotor.centre - whole.centre for rotor in rotors],
                      [turn * spin for spin in PROP_SPINS],
                      f'lines {", ".join(str(rotor.element.line) for rotor in rotors)}: <link>')
    draft.assumed.append('the rotors turn as in the code of gym-pybullet-drones'
                         + (', the other way in racer.urdf' if turn < 0 else ''))
    for key, theirs, unit in (('thrust_coefficient', 'kf', 'N/(rad/s)^2'),
                              ('torque_coefficient', 'km', 'N m/(rad/s)^2')):
        if not properties.number(theirs) > 0.0:
            raise InputError(f'{properties.where}: {theirs}: expected a number above 0')
        draft.take(key, properties.number(theirs) * PER_RPM, unit,
                   properties.place(f'{theirs}, per rpm^2'))
    if 'thrust2weight' in properties.attributes:
        most = properties.number('thrust2weight') * whole.mass * PYBULLET_GRAVITY
        speed = math.sqrt(max(most, 0.0) / (4.0 * draft.data['thrust_coefficient']))
        draft.take('speed_max', speed, 'rad/s', properties.place('thrust2weight'))
    if 'prop_radius' in properties.attributes:
        draft.take('rotor_radius', properties.number('prop_radius'), 'm',
                   properties.place('prop_radius'))
    for theirs, unit, physics in (('drag_coeff_xy', 'kg/rad', 'PYB_DRAG'),
                                  ('drag_coeff_z', 'kg/rad', 'PYB_DRAG'),
                                  ('gnd_eff_coeff', '1', 'PYB_GND')):
        if theirs in properties.attributes:
            draft.note(theirs, properties.number(theirs), unit, properties.place(theirs))
            draft.assumed.append(f'{theirs} is left out: it acts only with Physics.{physics} and '
                                 'Physics.PYB_GND_DRAG_DW, which are not the usual Physics.PYB')


def _take_damping(draft: Draft) -> None:
    """Enter the damping of Bullet, in which a vehicle of gym-pybullet-drones flies."""
    force = DAMPING * draft.data['mass']
    draft.take('linear_drag', [force] * 3, 'N/(m/s)', f'damping of Bullet, {DAMPING:g} x mass')
    draft.note('drag with the square of the speed', force, 'kg/m',
               f'damping of Bullet, {DAMPING:g} x mass')
    draft.effects = lambda _: {'body_drag': {'horizontal': force, 'vertical': force}}
    draft.assumed.append(
        f'the damping of Bullet is on, which gym-pybullet-drones leaves as it is: it slows by '
        f'{DAMPING:g} (1 + v) v m/s2 at v m/s; that of the rate, {DAMPING:g} (1 + w) w rad/s2 at '
        'w rad/s, is left out, because no effect is such a moment')


def _known(links: dict[str, Link], name: str, element: Element) -> Link:
    if name not in links:
        raise InputError(f'{element.where}: no link {name[:50]!r} is in the robot; correct '
                         'linkName')
    return links[name]
