# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Frames of an SDF model: where its links, joints and frames stand in one another."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
import math

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.bodies import fixed_axes, Pose, pose, turned
from quad_ident_ros.vehicle_files.xml_tree import Element, SHOWN

MODEL = '__model__'
DEEPEST = 10        # models in one another
MOST_FRAMES = 10_000
Include = Callable[[Element], Element]


@dataclass(frozen=True)
class Frame:
    """A frame: its element, its Pose, and the name of the frame that the Pose is in."""

    element: Element
    pose: Pose
    parent: str


@dataclass
class Tree:
    """
    A model with what it includes: frames, links, joints and plugins, by full names.

    A full name has the names of nested models and :: before it; scopes: of each joint and plugin
    the names that stand before names in it.
    """

    frames: dict[str, Frame] = field(default_factory=dict)
    links: dict[str, Element] = field(default_factory=dict)
    joints: dict[str, tuple[Element, str]] = field(default_factory=dict)
    holders: list[tuple[Element, str]] = field(default_factory=list)

    def place_of(self, name: str) -> Pose:
        """Return the Pose of a frame in that of the whole model; InputError for a circle."""
        result, at = pose(), name
        seen: list[str] = []
        while at != MODEL:
            frame = self.frames[at]
            if at in seen:
                circle = ' -> '.join(name[:SHOWN] for name in seen[:3])
                raise InputError(f'{frame.element.where}: its pose is relative to itself by '
                                 f'{circle}; name another frame')
            seen.append(at)
            result, at = frame.pose @ result, frame.parent
        return result


def tree_of(model: Element, include: Include) -> Tree:
    """Return the Tree of a <model>; include: returns the <model> of an <include>; InputError."""
    tree = Tree()
    _gather(tree, model, '', MODEL, include, 0)
    for frame in tree.frames.values():
        if frame.parent != MODEL and frame.parent not in tree.frames:
            raise InputError(f'{frame.element.where}: relative to {frame.parent[:SHOWN]!r}, which '
                             'is not in the model; name a link, joint or frame of it')
    return tree


def pose_of(element: Element, tag: str = 'pose') -> tuple[Pose, str]:
    """Return the Pose that a child of an element states, and what it is relative to, or ''."""
    child = element.first(tag)
    if child is None or not child.text.strip():
        return pose(), '' if child is None else child.get('relative_to')
    if child.get('rotation_format') == 'quat_xyzw':
        values = child.content(7)
        if not values[3:].any():
            raise InputError(f'{child.where}: a quaternion of zeros is not a rotation; correct it')
        rotation = turned([values[6], *values[3:6]])
    else:
        values = child.content(6)
        unit = math.pi / 180.0 if child.get('degrees') in ('true', '1') else 1.0
        rotation = fixed_axes(*(unit * values[3:]))
    return pose(values[:3], rotation), child.get('relative_to')


def child_text(element: Element, tag: str) -> str:
    """Return the text of a child; InputError where there is none."""
    child = element.first(tag)
    if child is None or not child.text.strip():
        raise InputError(f'{element.where}: <{tag}> is missing; add it')
    return child.text.strip()


def name_of(element: Element, model: Element) -> str:
    """Return the name of a <model>, or that which an <include> of it gives."""
    given = element.first('name')
    return given.text.strip() if given is not None else model.get('name')


def _gather(tree: Tree, model: Element, scope: str, frame: str, include: Include,
            depth: int) -> None:
    """Enter what a <model> holds; scope: before its names; frame: the full name of its frame."""

    def full(name: str) -> str:
        return frame if name in ('', MODEL) else scope + name

    for element in model.children:
        name = element.get('name')
        if element.tag in ('link', 'frame', 'joint'):
            if not name or scope + name in tree.frames:
                raise InputError(f'{element.where}: this name appears twice; give each link, '
                                 'joint and frame one of its own')
            stated, parent = pose_of(element)
            if not parent and element.tag == 'joint':
                parent = child_text(element, 'child')
            elif not parent and element.tag == 'frame':
                parent = element.get('attached_to')
            tree.frames[scope + name] = Frame(element, stated, full(parent))
            if element.tag == 'link':
                tree.links[scope + name] = element
            elif element.tag == 'joint':
                tree.joints[scope + name] = element, scope
        elif element.tag in ('model', 'include'):
            _nest(tree, element, scope, full, include, depth + 1)
    tree.holders.append((model, scope))


def _nest(tree: Tree, element: Element, scope: str, full: Callable[[str], str],
          include: Include, depth: int) -> None:
    """Enter a nested or included model."""
    if depth > DEEPEST or len(tree.frames) > MOST_FRAMES:
        raise InputError(f'{element.where}: models include one another without end')
    inner = include(element) if element.tag == 'include' else element
    if any(each.get('placement_frame') or each.first('placement_frame') is not None
           for each in (element, inner)):
        raise InputError(f'{element.where}: placement_frame is not read; state the pose of the '
                         'model without it')
    name = name_of(element, inner)
    stated, parent = pose_of(element if element.first('pose') is not None else inner)
    merged = element.get('merge') in ('true', '1')
    frame = f'{scope}_merged__{name}__model__' if merged else f'{scope}{name}'
    if frame in tree.frames:
        raise InputError(f'{element.where}: a model {name[:SHOWN]!r} appears twice; name each')
    tree.frames[frame] = Frame(element, stated, full(parent))
    _gather(tree, inner, scope if merged else f'{scope}{name}::', frame, include, depth)
