# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles back into SDF models of Gazebo."""

import numpy as np

from quad_ident_ros.vehicle_files.bodies import Body
from quad_ident_ros.vehicle_files.edit_xml import EditedXml
from quad_ident_ros.vehicle_files.new_sdf import new
from quad_ident_ros.vehicle_files.out_base import Base
from quad_ident_ros.vehicle_files.out_body import body_for, ENTRIES, MOMENTS
from quad_ident_ros.vehicle_files.out_motors import HOLDS, write_motors
from quad_ident_ros.vehicle_files.reading import Draft
from quad_ident_ros.vehicle_files.sdf import flying_model, layout_of, pose_of_inertial
from quad_ident_ros.vehicle_files.target import Target
from quad_ident_ros.vehicle_files.ways import BODY
from quad_ident_ros.vehicle_files.xml_tree import Element, parse


def write(base: Base) -> EditedXml:
    """Return the Edits that give an SDF model what is wanted; raises InputError."""
    path, edited = base.source.path, EditedXml(base.source.text)
    _, tree = flying_model(base.source, parse(path, base.source.text))
    layout = layout_of(Draft(path, ''), tree)
    link = tree.links[layout.base]
    rest = [body for name, body in layout.bodies.items() if name != layout.base]
    main = layout.bodies[layout.base]
    body = body_for(base, edited, link.where, main, rest)
    if link.path != path:
        edited.lack(BODY, f'it stands in {link.path}; give the whole model as `gz sdf -p` prints '
                    'it')
    elif body is not main:
        _write_body(edited, base, link, body)
        edited.say_several(link, len(layout.bodies))
    plugins = [plugin for plugin, _ in layout.plugins]
    if any(plugin.element.path != path for plugin in plugins):
        edited.lack(HOLDS, f'the motors are in {plugins[0].element.path}; give the whole model '
                    'as `gz sdf -p` prints it')
    else:
        write_motors(edited, base, plugins)
    return edited


def _write_body(edited: EditedXml, base: Base, link: Element, body: Body) -> None:
    """Have the <inertial> of a link hold a Body that is given in the axes of the link."""
    wanted, inertial = base.wanted, link.first('inertial')
    assert inertial is not None
    _, rotation = pose_of_inertial(link)
    edited.content(inertial, 'mass', [body.mass], 'kg', wanted.sources['mass'], usual=[1.0])
    pose = inertial.first('pose')
    if pose is None or not pose.text.strip():
        edited.content(inertial, 'pose', [*body.centre, 0, 0, 0], 'm', wanted.sources['centre'],
                       usual=[0.0] * 6, size=1.0)
    else:
        stated = [float(word) for word in pose.text.split()]
        edited.content(inertial, 'pose', [*body.centre, *stated[3:]], 'm',
                       wanted.sources['centre'], size=1.0)
    matrix = inertial.first('inertia')
    assert matrix is not None
    turned = rotation.T @ body.inertia @ rotation
    size = float(np.max(np.abs(turned)))
    for tag, at in ENTRIES.items():
        edited.content(matrix, tag, [turned[at]], 'kg m2', wanted.sources['inertia'],
                       usual=[1.0 if at in MOMENTS else 0.0], size=size)


TARGET = Target('sdf', ('.sdf', '.world', '.xml'), frozenset((*BODY, *HOLDS)), write, new)
