# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The body of a simulator's file that makes the whole vehicle as heavy as it is to be."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.bodies import Body, check_body, combined
from quad_ident_ros.vehicle_files.edits import differs, SAME

if TYPE_CHECKING:
    from quad_ident_ros.vehicle_files.out_base import Base

MOMENTS = (0, 0), (1, 1), (2, 2)
PRODUCTS = (0, 1), (0, 2), (1, 2)
ENTRIES = {f'i{"xyz"[i]}{"xyz"[j]}': (i, j) for i, j in (*MOMENTS, *PRODUCTS)}
"""Where in a matrix of inertia the six numbers stand, by the names that URDF and SDF have."""


def body_for(base: Base, where: str, main: Body, rest: Sequence[Body]) -> Body:
    """
    Return what the body that carries the rotors is to be, all in the same axes.

    The other bodies stay, and all together have the mass, the centre of mass and the inertia about
    it that are wanted. Returns main itself where nothing changes. Raises InputError where no body
    can do that; where: file and place of it.
    """
    wanted, whole = base.wanted, combined([main, *rest])
    mass = wanted.mass if differs(base.mass, wanted.mass) else whole.mass
    moved = wanted.inertia - base.inertia
    size = float(np.max(np.abs(base.inertia)))
    moved[np.abs(moved) <= SAME * size] = 0.0
    if mass == whole.mass and not moved.any() and not wanted.centre.any():
        return main
    said = ', less the other bodies' if rest else ''
    left = mass - sum(body.mass for body in rest)
    if not left > 0.0:
        raise InputError(f'{where}: the other bodies weigh {mass - left:.6g} kg, the whole '
                         f'vehicle is to weigh {mass:.6g} kg; correct their masses')
    body = remainder(Body(mass, whole.centre + wanted.centre, whole.inertia + moved), rest)
    check_body(f'{where}: as the vehicle has it{said}', body)
    return body


def remainder(whole: Body, rest: Sequence[Body]) -> Body:
    """Return the body that together with others, in the same axes, makes a whole one."""
    if not rest:
        return whole
    left = whole.mass - sum(body.mass for body in rest)
    others = sum((body.mass * body.centre for body in rest), np.zeros(3))
    place = (whole.mass * whole.centre - others) / left
    # What the body has about the common centre is what the others leave of the whole.
    about = whole.inertia
    for body in (*rest, Body(left, place, np.zeros((3, 3)))):
        arm = body.centre - whole.centre
        about = about - body.inertia - body.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Body(left, place, about)
