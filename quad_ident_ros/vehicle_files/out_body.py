# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The body of a simulator's file that makes the whole vehicle as heavy as it is to be."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.bodies import Body, check_body, combined, is_body, nearest_body
from quad_ident_ros.vehicle_files.edits import differs, Edits, SAME

if TYPE_CHECKING:
    from quad_ident_ros.vehicle_files.out_base import Base

MOMENTS = (0, 0), (1, 1), (2, 2)
PRODUCTS = (0, 1), (0, 2), (1, 2)
ENTRIES = {f'i{"xyz"[i]}{"xyz"[j]}': (i, j) for i, j in (*MOMENTS, *PRODUCTS)}
"""Where in a matrix of inertia the six numbers stand, by the names that URDF and SDF have."""

TOLD = 1e-6     # of the largest moment: less is rounding


def body_for(base: Base, edited: Edits, where: str, main: Body, rest: Sequence[Body],
             shifted: Sequence[Body] | None = None) -> Body:
    """
    Return what the body that carries the rotors is to be, all in the same axes.

    The other bodies stay, or become the shifted ones where rotors move, and all together have the
    mass, the centre of mass and the inertia about it that are wanted. In the place of an inertia
    that no body has, for it is an estimate, comes the nearest, which is said in `edited`. Returns
    main itself where nothing changes. Raises InputError where no body can do that; where: file and
    place of it.
    """
    wanted, whole = base.wanted, combined([main, *rest])
    mass = wanted.mass if differs(base.mass, wanted.mass) else whole.mass
    moved = wanted.inertia - base.inertia
    size = float(np.max(np.abs(base.inertia)))
    moved[np.abs(moved) <= SAME * size] = 0.0
    if mass == whole.mass and not moved.any() and not wanted.centre.any() and shifted is None:
        return main
    rest = rest if shifted is None else shifted
    said = ', less the other bodies' if rest else ''
    left = mass - sum(body.mass for body in rest)
    if not left > 0.0:
        raise InputError(f'{where}: the other bodies weigh {mass - left:.6g} kg, the whole '
                         f'vehicle is to weigh {mass:.6g} kg; correct their masses')
    aim = Body(mass, whole.centre + wanted.centre, whole.inertia + moved)
    # An inertia of the file itself stays, whatever it is.
    body = remainder(nearest_body(aim) if moved.any() else aim, rest)
    check_body(f'{where}: as the vehicle has it{said}', body)
    if moved.any():
        body = nearest_body(body)
        _say_off(edited, aim, combined([body, *rest]))
    off = float(np.max(np.abs(body.inertia - main.inertia)))
    same = (not differs(main.mass, body.mass) and off <= SAME * size
            and np.max(np.abs(body.centre - main.centre)) <= SAME)
    return main if same else body


def told_by_body(base: Base, rest: Sequence[Body], shifted: Sequence[Body] | None) -> Base:
    """
    Return a Base whose sources name all that moves the body of body_for, which has its arguments.

    It makes up for the other bodies: its place and its inertia change with the mass of all of
    them, with their centre of mass and with rotors that move.
    """
    wanted, sources = base.wanted, base.wanted.sources
    mass = ['mass'] * bool(rest and differs(base.mass, wanted.mass))
    centre = ['centre'] * bool(wanted.centre.any())
    moments = ['moments'] * (shifted is not None)
    size = float(np.max(np.abs(base.inertia)))
    inertia = ['inertia'] * bool(np.max(np.abs(wanted.inertia - base.inertia)) > SAME * size)
    told = {'centre': [*centre, *mass, *moments],
            'inertia': [*inertia, *(mass + centre + moments if rest else ())]}
    named = {key: ', '.join(dict.fromkeys(', '.join(sources[each] for each in keys).split(', ')))
             for key, keys in told.items() if keys}
    return replace(base, wanted=replace(wanted, sources={**sources, **named}))


def inertia_for(base: Base, edited: Edits, where: str) -> np.ndarray:
    """
    Return the inertia (3, 3) kg m^2 for a file whose simulator does not test it.

    It is the one that is wanted, or the nearest where no body has that, beyond rounding, which is
    said in `edited`. Raises InputError where there is none; where: file and place of it.
    """
    aim = Body(base.wanted.mass, np.zeros(3), base.wanted.inertia)
    if is_body(aim):
        return aim.inertia
    near = nearest_body(aim)
    check_body(f'{where}: as the vehicle has it', near)
    _say_off(edited, aim, near)
    return near.inertia


def _say_off(edited: Edits, aim: Body, written: Body) -> None:
    """Say by how much the inertia that is written is off that of the vehicle, where it is."""
    moments = np.linalg.eigvalsh(aim.inertia)
    off = float(np.linalg.norm(written.inertia - aim.inertia, 2))
    if off <= TOLD * moments[2]:
        return
    beyond = moments[2] / (moments[0] + moments[1]) - 1.0
    edited.remarks.append(
        f'no body has the inertia of the vehicle, whose principal moments are '
        f'{", ".join(f"{value:.4g}" for value in moments)} kg m2: the largest is '
        f'{100 * beyond:.3g} % more than the other two together; the nearest that a body can have '
        f'is written, which is {off:.2g} kg m2 off, {100 * off / moments[2]:.2g} % of the largest')
    edited.nearest['inertia'] = 'the nearest inertia that a body can have'


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
