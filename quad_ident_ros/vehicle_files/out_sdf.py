# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles back into SDF models of Gazebo."""

import numpy as np

from quad_ident_ros.vehicle_files.bodies import Body
from quad_ident_ros.vehicle_files.edit_xml import EditedXml
from quad_ident_ros.vehicle_files.new_sdf import new
from quad_ident_ros.vehicle_files.out_base import Base
from quad_ident_ros.vehicle_files.out_body import body_for, ENTRIES, MOMENTS, told_by_body
from quad_ident_ros.vehicle_files.out_motors import HOLDS, write_motors
from quad_ident_ros.vehicle_files.out_places import beside_others, lack_part
from quad_ident_ros.vehicle_files.reading import Draft
from quad_ident_ros.vehicle_files.sdf import flying_model, Layout, layout_of, pose_of_inertial
from quad_ident_ros.vehicle_files.sdf_frames import Tree
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
    main, shifted = layout.bodies[layout.base], None
    if base.shifts.any() and _move_rotors(edited, base, tree, layout):
        _, after = flying_model(base.source, parse(path, edited.result()))
        shifted = [body for name, body in layout_of(Draft(path, ''), after).bodies.items()
                   if name != layout.base]
    body = body_for(base, edited, link.where, main, rest, shifted)
    if link.path != path:
        edited.lack(BODY, f'it stands in {link.path}; give the whole model as `gz sdf -p` prints '
                    'it')
    elif body is not main:
        _write_body(edited, told_by_body(base, rest, shifted), link, body)
        edited.say_several(link, len(layout.bodies))
    plugins = [plugin for plugin, _ in layout.plugins]
    if any(plugin.element.path != path for plugin in plugins):
        edited.lack(HOLDS, f'the motors are in {plugins[0].element.path}; give the whole model '
                    'as `gz sdf -p` prints it')
        lack_part(edited, base.wanted, 'torque', edited.lacking['torque'])
    else:
        write_motors(edited, base, plugins)
    return edited


def _move_rotors(edited: EditedXml, base: Base, tree: Tree, layout: Layout) -> bool:
    """Have the rotors' links and joints stand where they are wanted; return whether they do."""
    axes = tree.place_of(layout.base).rotation
    shifts: dict[str, np.ndarray] = {}
    for (plugin, scope), name, shift in zip(layout.plugins, layout.links, base.shifts,
                                            strict=True):
        shifts |= dict.fromkeys((name, scope + plugin.joint), axes @ shift)
    paths = {tree.links[layout.base].path, *(tree.frames[name].element.path for name in shifts)}
    others = sorted(paths - {base.source.path})
    if others:
        lack_part(edited, base.wanted, 'arms', f'the rotors stand in {others[0]}; give the whole '
                  'model as `gz sdf -p` prints it')
        return False
    source = base.wanted.sources['moments']
    for name, shift in beside_others(shifts, {each: frame.parent for each, frame in
                                              tree.frames.items()}).items():
        frame = tree.frames[name]
        if np.linalg.norm(shift) > 0.0:
            inside = tree.place_of(frame.parent).rotation.T @ shift
            _write_place(edited, frame.element, frame.pose.position + inside, source)
    return True


def _write_place(edited: EditedXml, element: Element, position: np.ndarray, source: str) -> None:
    """Have the <pose> of an element hold a position (3,), m, and the rotation that it has."""
    pose = element.first('pose')
    if pose is None or not pose.text.strip():
        edited.content(element, 'pose', [*position, 0, 0, 0], 'm', source, usual=[0.0] * 6,
                       size=1.0)
    else:
        stated = [float(word) for word in pose.text.split()]
        edited.content(element, 'pose', [*position, *stated[3:]], 'm', source, size=1.0)


def _write_body(edited: EditedXml, base: Base, link: Element, body: Body) -> None:
    """Have the <inertial> of a link hold a Body that is given in the axes of the link."""
    wanted, inertial = base.wanted, link.first('inertial')
    assert inertial is not None
    _, rotation = pose_of_inertial(link)
    edited.content(inertial, 'mass', [body.mass], 'kg', wanted.sources['mass'], usual=[1.0])
    _write_place(edited, inertial, body.centre, wanted.sources['centre'])
    matrix = inertial.first('inertia')
    assert matrix is not None
    turned = rotation.T @ body.inertia @ rotation
    size = float(np.max(np.abs(turned)))
    for tag, at in ENTRIES.items():
        edited.content(matrix, tag, [turned[at]], 'kg m2', wanted.sources['inertia'],
                       usual=[1.0 if at in MOMENTS else 0.0], size=size)


TARGET = Target('sdf', ('.sdf', '.world', '.xml'), frozenset((*BODY, 'moments', *HOLDS)), write,
                new)
