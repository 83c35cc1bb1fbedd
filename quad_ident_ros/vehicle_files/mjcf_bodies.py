# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Bodies of an MJCF model: mass and inertia, stated or from their shapes, and their sites."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.bodies import Body, check_body, combined, Pose, pose, symmetric
from quad_ident_ros.vehicle_files.mjcf_defaults import Model
from quad_ident_ros.vehicle_files.mjcf_shapes import SHELLS, SOLIDS
from quad_ident_ros.vehicle_files.xml_tree import Element

DENSITY = 1000.0    # kg/m^3 of shapes that state neither mass nor density, as in MuJoCo
NOTHING = Body(0.0, np.zeros(3), np.zeros((3, 3)))


@dataclass(frozen=True)
class Part:
    """
    A body of a vehicle: its element, its Body and Pose in the axes of the vehicle's body.

    joints: those with which it moves against the body around it; sites: (Pose, element with its
    defaults) by name; source: what its mass comes from, 'inertial' or its shapes; remark: on its
    inertia, or ''.
    """

    element: Element
    body: Body
    pose: Pose
    joints: tuple[Element, ...]
    sites: dict[str, tuple[Pose, Element]]
    source: str
    remark: str


def parts_of(model: Model, body: Element, inherited: str = '') -> Iterator[Part]:
    """Give the parts of a vehicle, itself first, whose <body> is given; InputError."""
    yield from _parts(model, body, pose(), inherited)


def vehicles_of(model: Model) -> dict[str, tuple[Element, str]]:
    """Return the bodies of the world by name, each with the childclass that holds there."""
    found: dict[str, tuple[Element, str]] = {}
    for world in model.root.all('worldbody'):
        for _, element, inherited in _within(model, world, pose(), ''):
            if element.tag == 'body':
                found[element.get('name') or f'body in line {element.line}'] = element, inherited
    return found


def is_free(body: Element) -> bool:
    """Whether a body moves freely."""
    return bool(body.all('freejoint') or any(joint.get('type') == 'free'
                                             for joint in body.all('joint')))


def _within(model: Model, holder: Element, frame: Pose, inherited: str
            ) -> Iterator[tuple[Pose, Element, str]]:
    """Give the children of a body, those in <frame> elements too, with the Pose around them."""
    for child in holder.children:
        if child.tag == 'frame':
            yield from _within(model, child, frame @ model.pose_of(child),
                               child.get('childclass') or inherited)
        else:
            yield frame, child, inherited


def _parts(model: Model, element: Element, place: Pose, inherited: str) -> Iterator[Part]:
    inherited = element.get('childclass') or inherited
    joints, geoms, below = [], [], []
    sites: dict[str, tuple[Pose, Element]] = {}
    for frame, child, held in _within(model, element, pose(), inherited):
        if child.tag in ('joint', 'freejoint'):
            joints.append(model.whole(child, held))
        elif child.tag == 'geom':
            geoms.append((frame, model.whole(child, held)))
        elif child.tag == 'site':
            site = model.whole(child, held)
            if not child.get('name'):
                continue    # no actuator can name it: nothing acts there
            within = (model.along(site)[0] if 'fromto' in site.attributes else
                      model.pose_of(site))
            sites[child.get('name')] = place @ frame @ within, site
        elif child.tag == 'body':
            below.append((frame, child, held))
    body, source = _inertia(model, element, geoms)
    body = bounded(model, element, body)
    remark = check_body(element.where, body)
    yield Part(element, body.placed(place), place, tuple(joints), sites, source, remark)
    for frame, child, held in below:
        yield from _parts(model, child, place @ frame @ model.pose_of(child), held)


def _inertia(model: Model, element: Element, geoms: list[tuple[Pose, Element]]
             ) -> tuple[Body, str]:
    """Return the Body of a <body> in its frame, and what it comes from."""
    stated, how = element.first('inertial'), model.compiler.get('inertiafromgeom', 'auto')
    if how == 'false' or how == 'auto' and stated is not None:
        return (NOTHING, '') if stated is None else (_stated(model, stated), 'inertial')
    low, high = model.setting('inertiagrouprange', (0.0, 5.0))
    shapes = [_shape(model, geom).placed(frame) for frame, geom in geoms
              if low <= geom.number('group', 0.0) <= high]
    shapes = [shape for shape in shapes if shape.mass > 0.0]
    if shapes:
        return combined(shapes), 'its shapes'
    return (NOTHING, '') if stated is None else (_stated(model, stated), 'inertial')


def bounded(model: Model, element: Element, body: Body) -> Body:
    """Return a body with the mass and principal moments that the compiler has it have."""
    [mass], [moment] = model.setting('boundmass', (0.0,)), model.setting('boundinertia', (0.0,))
    balanced = model.compiler.get('balanceinertia') == 'true'
    if body.mass >= mass and not moment > 0.0 and not balanced:
        return body
    # MuJoCo has the centre of a body without mass as far from its origin as that from its parent.
    centre = body.centre if body.mass > 0.0 else model.pose_of(element).position
    moments, axes = np.linalg.eigh(body.inertia)
    moments = np.maximum(moments, moment)
    if balanced and moments[0] + moments[1] < moments[2]:
        moments = np.full(3, moments.mean())    # of what no body has, MuJoCo makes a ball
    return Body(max(body.mass, mass), centre, axes @ np.diag(moments) @ axes.T)


def _stated(model: Model, inertial: Element) -> Body:
    """Return the Body of an <inertial>."""
    mass, frame = inertial.number('mass'), model.pose_of(inertial)
    if 'fullinertia' in inertial.attributes:
        moments = symmetric(*inertial.numbers('fullinertia', 6))
    else:
        moments = np.diag(inertial.numbers('diaginertia', 3))
    return Body(mass, np.zeros(3), moments).placed(frame)


def _shape(model: Model, geom: Element) -> Body:
    """Return the Body of a <geom>, in the frame around it."""
    kind = geom.get('type', 'sphere')
    if kind in ('plane', 'hfield') or geom.get('mass') and geom.number('mass') == 0.0:
        return NOTHING
    if not geom.get('mass') and geom.number('density', DENSITY) == 0.0:
        return NOTHING
    if kind in ('mesh', 'sdf') or 'mesh' in geom.attributes:
        raise InputError(f'{geom.where}: its mass and inertia are those of the mesh '
                         f'{geom.get("mesh")[:50]!r}, which is not read; give its body an '
                         '<inertial>, or the geom mass="0"')
    if kind not in SOLIDS:
        raise InputError(f'{geom.where}: no geom has the type {kind[:20]!r}')
    shape = (SHELLS if geom.get('shellinertia') == 'true' else SOLIDS)[kind]
    count = shape.sizes
    frame = model.pose_of(geom)
    if 'fromto' in geom.attributes:
        frame, length = model.along(geom)
        if kind == 'sphere':
            raise InputError(f'{geom.where}: fromto: no {kind} lies between these points')
        across = geom.numbers('size', max(len(geom.get('size').split()), 1))
        size = np.array([*across[:1], *(across[:1] if count == 3 else ()), length / 2.0])
    else:
        words = geom.get('size').split()[:count]
        if len(words) < count:
            raise InputError(f'{geom.where}: size: a {kind} has {count}, got {len(words)}')
        size = geom.numbers('size', len(geom.get('size').split()))[:count]
    if not (size > 0.0).all():
        raise InputError(f'{geom.where}: size: expected numbers above 0')
    mass = (geom.number('mass') if geom.get('mass') else
            geom.number('density', DENSITY) * shape.measure(*size))
    return Body(mass, np.zeros(3), np.diag(shape.moments(*size)) * mass).placed(frame)
