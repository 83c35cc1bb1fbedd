# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles back into SDF models of Gazebo."""

import numpy as np

from quad_ident_ros.vehicle_files.bodies import Body
from quad_ident_ros.vehicle_files.edit_xml import Edited
from quad_ident_ros.vehicle_files.out_base import Base
from quad_ident_ros.vehicle_files.out_body import body_for, MOMENTS, PRODUCTS, spread
from quad_ident_ros.vehicle_files.out_motors import write_motors
from quad_ident_ros.vehicle_files.reading import Draft
from quad_ident_ros.vehicle_files.sdf import flying_model, layout_of, pose_of_inertial
from quad_ident_ros.vehicle_files.xml_tree import Element, parse

MOMENT_TAGS, PRODUCT_TAGS = ('ixx', 'iyy', 'izz'), ('ixy', 'ixz', 'iyz')


def write(edited: Edited, base: Base) -> dict[str, str]:
    """Have an SDF model hold what is wanted; return {key of Wanted: why it is lacking}."""
    path = base.source.path
    _, tree = flying_model(base.source, parse(path, base.source.text))
    layout = layout_of(Draft(path, ''), tree)
    link = tree.links[layout.base]
    rest = [body for name, body in layout.bodies.items() if name != layout.base]
    main = layout.bodies[layout.base]
    body = body_for(base, link.where, main, rest)
    lacking: dict[str, str] = {}
    if link.path != path:
        elsewhere = (f'it stands in {link.path}; give the whole model as `gz sdf -p` prints it')
        lacking |= dict.fromkeys(('mass', 'centre', 'inertia'), elsewhere)
    elif body is not main:
        _write_body(edited, base, link, body)
        edited.say_several(link, len(layout.bodies))
    plugins = [plugin for plugin, _ in layout.plugins]
    if any(plugin.element.path != path for plugin in plugins):
        elsewhere = (f'the motors stand in {plugins[0].element.path}; give the whole model as '
                     '`gz sdf -p` prints it')
        return lacking | dict.fromkeys(('thrust', 'torque', 'rise', 'fall', 'rotor_drag',
                                        'speed_max'), elsewhere)
    return lacking | write_motors(edited, base, plugins)


def _write_body(edited: Edited, base: Base, link: Element, body: Body) -> None:
    """Have the <inertial> of a link hold a Body that is given in the axes of the link."""
    wanted, inertial = base.wanted, link.first('inertial')
    assert inertial is not None
    _, rotation = pose_of_inertial(link)
    edited.content(inertial, 'mass', [body.mass], 'kg', wanted.sources['mass'],
                   [wanted.stds.get('mass', (None,))[0]], usual=[1.0])
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
    stds = spread(rotation, wanted.stds.get('inertia', (0.0, 0.0, 0.0)))
    for tag, at, std in (*zip(MOMENT_TAGS, MOMENTS, stds, strict=True),
                         *zip(PRODUCT_TAGS, PRODUCTS, [None] * 3, strict=True)):
        edited.content(matrix, tag, [turned[at]], 'kg m2', wanted.sources['inertia'], [std],
                       usual=[1.0 if tag in MOMENT_TAGS else 0.0], size=size)
