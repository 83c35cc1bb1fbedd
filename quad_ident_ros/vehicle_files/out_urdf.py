# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles back into URDF files."""

from collections.abc import Sequence
import math

import numpy as np

from quad_ident_ros.vehicle_files.bodies import Body, nearest_common
from quad_ident_ros.vehicle_files.edit_xml import EditedXml
from quad_ident_ros.vehicle_files.new_urdf import new
from quad_ident_ros.vehicle_files.out_base import Base
from quad_ident_ros.vehicle_files.out_body import body_for, ENTRIES, told_by_body
from quad_ident_ros.vehicle_files.out_motors import HOLDS, write_motors
from quad_ident_ros.vehicle_files.out_places import beside_others, lack_part
from quad_ident_ros.vehicle_files.reading import Draft
from quad_ident_ros.vehicle_files.target import Target
from quad_ident_ros.vehicle_files.urdf import (
    bodies_of,
    links_of,
    PER_RPM,
    plugins_of,
    PROPS,
    PYBULLET_GRAVITY,
    rotors_of,
)
from quad_ident_ros.vehicle_files.urdf_links import end_of, Link, origin_of
from quad_ident_ros.vehicle_files.ways import BODY, LAGS
from quad_ident_ros.vehicle_files.xml_tree import Element, parse


def write(base: Base) -> EditedXml:
    """Return the Edits that give a URDF what is wanted; raises InputError."""
    root, edited = parse(base.source.path, base.source.text), EditedXml(base.source.text)
    links = links_of(base.source, root)
    rotors = rotors_of(root, links)
    bodies = bodies_of(Draft(base.source.path, ''), links, rotors)
    name = _carrier(bodies, links, rotors)
    rest = [body for other, body in bodies.items() if other != name]
    shifted = None
    if _move_rotors(edited, base, links, rotors):
        after = parse(base.source.path, edited.result())
        there = links_of(base.source, after)
        moved = bodies_of(Draft(base.source.path, ''), there, rotors_of(after, there))
        shifted = [body for other, body in moved.items() if other != name]
    body = body_for(base, edited, links[name].element.where, bodies[name], rest, shifted)
    if body is not bodies[name]:
        _write_body(edited, told_by_body(base, rest, shifted), links[name],
                    body.placed(links[name].pose.inverse))
        edited.say_several(links[name].element, len(bodies))
    plugins, properties = plugins_of(root), root.first('properties')
    if plugins:
        write_motors(edited, base, plugins)
        return edited
    if properties is None or not set(PROPS) <= links.keys():
        lack_part(edited, base.wanted, 'torque', 'a URDF says nothing of the torque of its rotors')
    edited.lack(('losses', 'torque_losses', *LAGS, 'rotor_drag'),
                'a URDF without motor plugins of Gazebo has no motors')
    if properties is None or not set(PROPS) <= links.keys():
        edited.lack(('thrust', 'torque', 'speed_max'), 'a URDF says nothing of thrust')
    else:
        _write_properties(edited, base, properties)
    return edited


def _move_rotors(edited: EditedXml, base: Base, links: dict[str, Link],
                 rotors: Sequence[Link]) -> bool:
    """Have the rotors' joints stand where they are wanted; return whether any moves."""
    wanted = base.wanted
    if not (wanted.arms != 1.0).any():
        return False
    if not base.shifts.any() or any(rotor.joint is None for rotor in rotors):
        lack_part(edited, wanted, 'arms', 'the file has no rotors that hang on joints')
        return False
    shifts = {rotor.element.get('name'): shift
              for rotor, shift in zip(rotors, base.shifts, strict=True)}
    above = {name: end_of(link.joint, 'parent') for name, link in links.items() if link.joint}
    for name, shift in beside_others(shifts, above).items():
        joint = links[name].joint
        assert joint is not None
        _write_origin(edited, joint, origin_of(joint).position
                      + links[above[name]].pose.rotation.T @ shift, wanted.sources['moments'])
    return True


def _write_origin(edited: EditedXml, element: Element, position: np.ndarray, source: str) -> None:
    """Have the <origin> of an element hold a position (3,), m."""
    origin = element.first('origin')
    if origin is not None:
        edited.attribute(origin, 'xyz', position, 'm', source, usual=(0.0, 0.0, 0.0), size=1.0)
    elif np.linalg.norm(position) > 1e-9:
        x, y, z = (float(value) for value in position)
        edited.child(element, f'<origin xyz="{x:.12g} {y:.12g} {z:.12g}"/>')
        for axis, value in zip('xyz', (x, y, z), strict=True):
            if value != 0.0:
                edited.note(element.place(f'origin {axis}'), 0.0, value, 'm', source)


def _carrier(bodies: dict[str, Body], links: dict[str, Link], rotors: Sequence[Link]) -> str:
    """Return the name of the link that carries the rotors, the heaviest where that has no mass."""
    above = {name: end_of(link.joint, 'parent') for name, link in links.items() if link.joint}
    parents = [above[name] for rotor in rotors if (name := rotor.element.get('name')) in above]
    common = nearest_common(parents, above, bodies) if parents else ''
    if common in bodies:
        return common
    others = [name for name in bodies if not any(links[name] is rotor for rotor in rotors)]
    return max(others or bodies, key=lambda name: bodies[name].mass)


def _write_properties(edited: EditedXml, base: Base, properties: Element) -> None:
    """Have the properties of gym-pybullet-drones hold thrust, torque and limit."""
    wanted = base.wanted
    for name, value, key in (('kf', wanted.thrust, 'thrust'), ('km', wanted.torque, 'torque')):
        edited.attribute(properties, name, [value / PER_RPM], 'per rpm^2', wanted.sources[key])
    if (wanted.arms != 1.0).any() and 'arm' in properties.attributes:
        edited.remarks.append(f'{properties.place("arm")} stays as it is: Physics.DYN alone flies '
                              'by it')
    if 'thrust2weight' not in properties.attributes:
        edited.lack(['speed_max'], 'the file has no thrust2weight')
        return
    if math.isinf(wanted.speed_max):
        edited.lack(['speed_max'], 'the file needs a limit; the one that it has stays')
        return
    # It stands for the highest speed, which stays as it is where thrust or mass change.
    ratio = 4.0 * wanted.thrust * wanted.speed_max ** 2 / (wanted.mass * PYBULLET_GRAVITY)
    edited.attribute(properties, 'thrust2weight', [ratio], '1',
                     'speed_max, with thrust and mass as above')


def _write_body(edited: EditedXml, base: Base, link: Link, body: Body) -> None:
    """Have the <inertial> of a link hold a Body that is given in its axes."""
    wanted, inertial = base.wanted, link.element.first('inertial')
    assert inertial is not None
    mass, moments = inertial.first('mass'), inertial.first('inertia')
    assert mass is not None and moments is not None
    edited.attribute(mass, 'value', [body.mass], 'kg', wanted.sources['mass'])
    _write_origin(edited, inertial, body.centre, wanted.sources['centre'])
    frame = origin_of(inertial)
    turned = frame.rotation.T @ body.inertia @ frame.rotation
    size = float(np.max(np.abs(turned)))
    for name, at in ENTRIES.items():
        edited.attribute(moments, name, [turned[at]], 'kg m2', wanted.sources['inertia'],
                         usual=(0.0,), size=size)


TARGET = Target('urdf', ('.urdf', '.xml'), frozenset((*BODY, 'moments', *HOLDS)), write, new)
