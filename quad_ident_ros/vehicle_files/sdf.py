# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""SDF models of Gazebo with motor plugins."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
import os
from pathlib import Path

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.bodies import (
    Body,
    check_body,
    combined,
    nearest_common,
    spun,
    symmetric,
)
from quad_ident_ros.vehicle_files.gz_motors import (
    check_numbers,
    motor_plugins,
    MotorPlugin,
    take_motors,
)
from quad_ident_ros.vehicle_files.reading import Draft
from quad_ident_ros.vehicle_files.rotor_axes import check_axis
from quad_ident_ros.vehicle_files.sdf_frames import (
    child_text,
    MODEL,
    name_of,
    pose_of,
    Tree,
    tree_of,
)
from quad_ident_ros.vehicle_files.source import is_file, one_of, Source, text_of
from quad_ident_ros.vehicle_files.xml_tree import Element, parse, root_of, SHOWN

GRAVITY = 9.8       # m/s^2, of SDF where a world does not say it
PATHS = 'GZ_SIM_RESOURCE_PATH', 'GAZEBO_MODEL_PATH'
"""Variables of the environment with the folders in which Gazebo looks for models."""


def recognises(text: str) -> bool:
    """Whether a text is an SDF file."""
    return root_of(text) == 'sdf'


def read(source: Source) -> Draft:
    """Return the Draft of an SDF model; raises InputError."""
    root = parse(source.path, source.text)
    gravity = GRAVITY, ''
    for holder in (root, *root.all('world')):
        for stated in holder.all('gravity'):
            gravity = float(np.linalg.norm(stated.content(3))), stated.place()
    model, tree = flying_model(source, root)
    draft = Draft(source.path, model.get('name') or source.stem)
    _take_tree(draft, model, tree)
    if gravity[1]:
        draft.take_gravity(*gravity)
    else:
        draft.data['gravity'] = GRAVITY
        draft.assumed.append(f'gravity {GRAVITY:g} m/s2: that of SDF where no world says it')
    return draft


@dataclass(frozen=True)
class Layout:
    """
    A model by its parts: its motor plugins with the scope of the names in each, and its bodies.

    links: full names of the rotors; base: that of the link which carries them; bodies: of all
    links by full name, in the axes of the base; spinning: of the rotors about their axes, kg m^2.
    """

    plugins: list[tuple[MotorPlugin, str]]
    links: list[str]
    base: str
    bodies: dict[str, Body]
    spinning: list[float]


def flying_model(source: Source, root: Element) -> tuple[Element, Tree]:
    """Return the <model> of a file that has motors, and its Tree; InputError."""
    trees: dict[str, tuple[Element, Tree]] = {}
    for holder in (root, *root.all('world')):
        for name, element, model in _models(holder, source):
            tree = tree_of(model, _included)
            if not _plugins(tree):
                continue
            if name in trees:
                raise InputError(f'{element.where}: a model {name[:SHOWN]!r} appears twice; give '
                                 'each a <name> of its own')
            trees[name] = model, tree
    if not trees and not source.wanted:
        raise InputError(f'{source.path}: no model in it has a plugin MulticopterMotorModel; give '
                         'the model.sdf that has the motors')
    return one_of(source, trees, 'model with motors')


def layout_of(draft: Draft, tree: Tree) -> Layout:
    """Return the Layout of a model; remarks on its links go into the Draft."""
    plugins = _plugins(tree)
    check_numbers([plugin for plugin, _ in plugins])
    joints = [_joint(tree, plugin, scope) for plugin, scope in plugins]
    links = [_link(tree, scope + plugin.link, plugin.element) for plugin, scope in plugins]
    base = _carrier(tree, joints)
    frame = tree.place_of(base).inverse
    spinning: list[float] = []
    bodies: dict[str, Body] = {}
    for name, link in tree.links.items():
        body, fixed = _body(draft, link), frame @ tree.place_of(name)
        if name in links:
            axis = _axis(tree, joints[links.index(name)], link)
            spinning.append(float(axis @ body.inertia @ axis))
            body = spun(body, axis)
        if body.mass > 0.0:
            draft.note(f'link {name}', body.mass, 'kg', _place(draft, link, 'inertial'))
        bodies[name] = body.placed(fixed)
    return Layout(plugins, links, base, bodies, spinning)


def _take_tree(draft: Draft, model: Element, tree: Tree) -> None:
    """Enter the bodies, rotors and motors of a model."""
    layout = layout_of(draft, tree)
    plugins, base, bodies = layout.plugins, layout.base, layout.bodies.values()
    if not sum(body.mass for body in bodies) > 0.0:
        raise InputError(f'{model.where}: no link of it has a mass; add <inertial>')
    whole = combined(list(bodies))
    frame = tree.place_of(base).inverse
    draft.take_body(whole, _place(draft, model, f'{len(bodies)} links, axes of {base}'))
    places = []
    for (plugin, _), name in zip(plugins, layout.links, strict=True):
        at = frame @ tree.place_of(name)
        check_axis(draft, at.rotation[:, 2], plugin.element.where)
        hub = at.position + at.rotation @ pose_of_inertial(tree.links[name])[0]
        places.append(hub - whole.centre)
    draft.take_rotors(places, [plugin.spin for plugin, _ in plugins],
                      ', '.join(_place(draft, plugin.element) for plugin, _ in plugins[:1])
                      + f' and {len(plugins) - 1} more')
    draft.assumed.append('the inertia of a rotor is its mean over a turn')
    moving = [name for name, (joint, _) in tree.joints.items()
              if joint.get('type') != 'fixed' and name not in
              [scope + plugin.joint for plugin, scope in plugins]]
    if moving:
        draft.assumed.append(f'joints that move and are not rotors ({", ".join(moving[:5])}) are '
                             'taken as fixed where they start')
    take_motors(draft, [plugin for plugin, _ in plugins], layout.spinning,
                lambda element, tag: _place(draft, element, tag))


def pose_of_inertial(link: Element) -> tuple[np.ndarray, np.ndarray]:
    """Return the centre of mass (3,) of a link in its frame, m, and the axes of its inertia."""
    inertial = link.first('inertial')
    if inertial is None:
        return np.zeros(3), np.eye(3)
    stated, _ = pose_of(inertial)
    return stated.position, stated.rotation


def _body(draft: Draft, link: Element) -> Body:
    """Return the Body of a link, in its frame."""
    inertial = link.first('inertial')
    if inertial is None:
        raise InputError(f'{link.where}: it has no <inertial>, for which Gazebo takes 1 kg and '
                         '1 kg m2; state its mass and inertia')
    if inertial.get('auto') in ('true', '1'):
        raise InputError(f'{inertial.where}: auto="true" has Gazebo compute it from the shapes; '
                         'write its mass and inertia as numbers')
    matrix = inertial.first('inertia')
    if matrix is None:
        raise InputError(f'{inertial.where}: <inertia> is missing, for which Gazebo takes 1 kg '
                         'm2; state it')
    centre, rotation = pose_of_inertial(link)
    moments = symmetric(*(matrix.value(tag) for tag in ('ixx', 'iyy', 'izz')),
                        *(matrix.value(tag, 0.0) for tag in ('ixy', 'ixz', 'iyz')))
    body = Body(inertial.value('mass'), centre, rotation @ moments @ rotation.T)
    remark = check_body(f'{inertial.where} of link {link.get("name")!r}', body)
    if remark:
        draft.assumed.append(f'{_place(draft, link, "inertial")}: {remark}')
    return body


def _plugins(tree: Tree) -> list[tuple[MotorPlugin, str]]:
    """Return the motor plugins of a tree with the scope of the names in each, in their order."""
    found = [(plugin, scope) for holder, scope in tree.holders for plugin in motor_plugins(holder)]
    return sorted(found, key=lambda each: each[0].number)


def _joint(tree: Tree, plugin: MotorPlugin, scope: str) -> tuple[Element, str]:
    """Return the joint of a motor, with the scope of the names in it."""
    if scope + plugin.joint not in tree.joints:
        raise InputError(f'{plugin.element.where}: no joint {plugin.joint[:SHOWN]!r} is in the '
                         'model; correct jointName, or give the file that has it')
    return tree.joints[scope + plugin.joint]


def _link(tree: Tree, name: str, element: Element) -> str:
    if name not in tree.links:
        raise InputError(f'{element.where}: no link {name[:SHOWN]!r} is in the model; correct '
                         'the name')
    return name


def _parent(tree: Tree, joint: Element, scope: str) -> str:
    """Return the full name of the link that a rotor's joint hangs on."""
    return _link(tree, scope + child_text(joint, 'parent'), joint)


def _carrier(tree: Tree, joints: Sequence[tuple[Element, str]]) -> str:
    """Return the full name of the link that all rotors hang on, be it by arms of their own."""
    above = {scope + child_text(joint, 'child'): scope + child_text(joint, 'parent')
             for joint, scope in tree.joints.values()}
    return nearest_common([_parent(tree, *joint) for joint in joints], above, tree.links)


def _axis(tree: Tree, joint: tuple[Element, str], link: Element) -> np.ndarray:
    """Return the unit axis (3,) of a joint in the axes of its link."""
    element, scope = joint
    stated = element.first('axis')
    vector = None if stated is None else stated.first('xyz')
    axis = np.array([0.0, 0.0, 1.0]) if vector is None else vector.content(3)
    if not np.linalg.norm(axis) > 0.0:
        raise InputError(f'{element.where}: its axis is 0 0 0; correct it')
    name = scope + element.get('name')
    given = vector.get('expressed_in') if vector is not None else ''
    at = name if not given else MODEL if given == MODEL else scope + given
    if at != MODEL and at not in tree.frames:
        raise InputError(f'{element.where}: expressed_in {given[:SHOWN]!r} is not in the model')
    this = next(key for key, each in tree.links.items() if each is link)
    rotation = tree.place_of(this).rotation.T @ tree.place_of(at).rotation
    return rotation @ axis / np.linalg.norm(axis)


def _models(holder: Element, source: Source) -> Iterator[tuple[str, Element, Element]]:
    """
    Give the models of a world or a file: name, the element that places it, the <model>.

    Of those that a world includes, the ones that exist or that it puts motors on.
    """
    yield from ((model.get('name'), model, model) for model in holder.all('model')
                if not (model.first('static') is not None
                        and child_text(model, 'static') in ('true', '1')))
    for include in holder.all('include'):
        uri = child_text(include, 'uri')
        if _found(source.path, uri) is not None or motor_plugins(include):
            model = _included(include)
            yield name_of(include, model), include, model


def _included(element: Element) -> Element:
    """Return the <model> of the file that an <include> names, with its plugins; InputError."""
    uri = child_text(element, 'uri')
    found = _found(element.path, uri)
    if found is None:
        raise InputError(f'{element.where}: {uri[:100]} was not found beside the model or in '
                         f'{PATHS[0]}; set that to the folder of the models, or give the whole '
                         'model as `gz sdf -p` prints it')
    models = parse(str(found), text_of(found)).all('model')
    if len(models) != 1:
        raise InputError(f'{found}: expected one <model>, got {len(models)}')
    changes = element.first('experimental:params')
    if changes is not None:
        raise InputError(f'{changes.where}: what it changes in the included model is not read; '
                         'give the whole model as `gz sdf -p` prints it')
    return replace(models[0], children=[*models[0].children, *element.all('plugin')])


def _found(path: str, uri: str) -> Path | None:
    """Return the SDF file that a URI stands for in a file, or None."""
    scheme, sign, name = uri.partition('://')
    if sign and scheme not in ('model', 'file'):
        return None
    name = name if sign else uri
    folders = [Path(path).resolve().parent.parent, Path(path).resolve().parent]
    for variable in PATHS:
        folders += [Path(each) for each in os.environ.get(variable, '').split(os.pathsep) if each]
    for folder in folders:
        place = folder / name
        for file in (place, place / 'model.sdf'):
            if is_file(file):
                return file
    return None


def _place(draft: Draft, element: Element, what: str = '') -> str:
    """Return the place of an element, with its file where it is another than that of the draft."""
    other = '' if element.path == draft.where else (
        os.path.relpath(element.path, Path(draft.where).parent) + ' ')
    return other + element.place(what)
