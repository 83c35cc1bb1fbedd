# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Links and joints of a URDF: where they stand, and their bodies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.bodies import Body, fixed_axes, Pose, pose, symmetric
from quad_ident_ros.vehicle_files.xml_tree import Element

SHORTEST = 1e-9      # of an axis: less counts as 0


@dataclass(frozen=True)
class Link:
    """
    A link: its element, its Pose in the axes of the root, the joint that it hangs on, or None.

    body: its Body in its frame, or None where it states no inertial.
    """

    element: Element
    pose: Pose
    joint: Element | None
    body: Body | None

    @property
    def moves(self) -> bool:
        """Whether it moves against the link that it hangs on."""
        return self.joint is not None and self.joint.get('type') != 'fixed'

    @property
    def centre(self) -> np.ndarray:
        """Its centre of mass (3,), m, in the axes of the root, its origin where it has none."""
        inside = np.zeros(3) if self.body is None else self.body.centre
        return self.pose.position + self.pose.rotation @ inside

    @property
    def axis(self) -> np.ndarray:
        """Return what its joint turns about, (3,), in its frame."""
        stated = None if self.joint is None else self.joint.first('axis')
        axis = (np.array([1.0, 0.0, 0.0]) if stated is None else
                stated.numbers('xyz', 3, (1.0, 0.0, 0.0)))
        if stated is not None and not np.linalg.norm(axis) > SHORTEST:
            raise InputError(f'{stated.where}: zeros are not an axis; correct it')
        return axis


def trees_of(root: Element) -> dict[str, dict[str, Link]]:
    """
    Return {root link: {link: Link}} of the trees in a <robot>; InputError.

    What moves by a floating joint flies: it is a tree of its own.
    """
    for element in root.walk():
        for value in (element.text, *element.attributes.values()):
            if '${' in value or '$(' in value:
                raise InputError(f'{element.where}: {value.strip()[:60]!r} is not expanded; run '
                                 '`xacro FILE -o vehicle.urdf` and give that file')
    links = _named(root, 'link')
    above: dict[str, Element] = {}
    for joint in _named(root, 'joint').values():
        for end in ('parent', 'child'):
            if end_of(joint, end) not in links:
                raise InputError(f'{joint.where}: its {end} {end_of(joint, end)[:50]!r} is not a '
                                 'link of the robot')
        other = above.setdefault(end_of(joint, 'child'), joint)
        if other is not joint:
            raise InputError(f'{joint.where}: its child is attached to the joint in line '
                             f'{other.line} too; a URDF is a tree')
    above = {child: joint for child, joint in above.items() if joint.get('type') != 'floating'}
    trees: dict[str, dict[str, Link]] = {}
    for name in links:
        _place(name, links, above, trees)
    return trees


def origin_of(element: Element) -> Pose:
    """Return the Pose of the <origin> of an element."""
    origin = element.first('origin')
    if origin is None:
        return pose()
    return pose(origin.numbers('xyz', 3, (0.0, 0.0, 0.0)),
                fixed_axes(*origin.numbers('rpy', 3, (0.0, 0.0, 0.0))))


def _place(name: str, links: dict[str, Element], above: dict[str, Element],
           trees: dict[str, dict[str, Link]]) -> None:
    """Enter a link into the tree that it belongs to."""
    at, place, seen = name, pose(), set()
    while at in above:
        if at in seen:
            raise InputError(f'{above[at].where}: the links form a circle')
        seen.add(at)
        place, at = origin_of(above[at]) @ place, end_of(above[at], 'parent')
    trees.setdefault(at, {})[name] = Link(links[name], place, above.get(name),
                                          _body(links[name]))


def _body(link: Element) -> Body | None:
    """Return the Body of a link in its frame, or None where it states no inertial."""
    inertial = link.first('inertial')
    if inertial is None:
        return None
    mass, moments = inertial.first('mass'), inertial.first('inertia')
    if mass is None or moments is None:
        raise InputError(f'{inertial.where} of link {link.get("name")!r}: expected <mass '
                         'value=""/> and <inertia ixx="" .../>')
    matrix = symmetric(*(moments.number(key) for key in ('ixx', 'iyy', 'izz')),
                       *(moments.number(key, 0.0) for key in ('ixy', 'ixz', 'iyz')))
    if mass.number('value') < 0.0:
        raise InputError(f'{mass.where} of link {link.get("name")!r}: a mass below 0 is '
                         'impossible; correct it')
    return Body(mass.number('value'), np.zeros(3), matrix).placed(origin_of(inertial))


def _named(root: Element, tag: str) -> dict[str, Element]:
    """Return the children of a tag by name; InputError where one has none, or another's."""
    found: dict[str, Element] = {}
    for element in root.all(tag):
        name = element.get('name')
        if not name or name in found:
            raise InputError(f'{element.where}: expected a name of its own for each {tag}')
        found[name] = element
    return found


def end_of(joint: Element, end: str) -> str:
    """Return the name of a joint's parent or child link."""
    element = joint.first(end)
    if element is None:
        raise InputError(f'{joint.where}: <{end} link=""/> is missing; add it')
    return element.get('link')
