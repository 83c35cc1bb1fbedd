# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Mismatch of the whole matrix of inertia: different moments, and products beside them."""

import math

from quad_ident_ros.compiled import compiled
from quad_ident_ros.effects.base import Axis, Form, Parameter, Table
from quad_ident_ros.model.situation import IX, IXY, IXZ, IY, IYZ, IZ


@compiled(fused=True, inlined=True)
def body(p: Table, k: int, s: Table) -> None:
    """Scale the moments of inertia and add products."""
    for i in range(s.shape[1]):
        s[IX, i] *= p[k, i]
        s[IY, i] *= p[k + 1, i]
        s[IZ, i] *= p[k + 2, i]
        s[IXY, i] += p[k + 3, i] * math.sqrt(s[IX, i] * s[IY, i])
        s[IXZ, i] += p[k + 4, i] * math.sqrt(s[IX, i] * s[IZ, i])
        s[IYZ, i] += p[k + 5, i] * math.sqrt(s[IY, i] * s[IZ, i])


MOMENTS: tuple[tuple[str, Axis], ...] = (('xx', 'roll'), ('yy', 'pitch'), ('zz', 'yaw'))
WIDEST = 0.4        # of a product: less than half, so that the matrix stays positive definite
PRODUCTS: tuple[tuple[str, Axis], ...] = (('xy', 'roll'), ('xz', 'roll'), ('yz', 'pitch'))

FORM = Form(
    name='matrix', title="a different inertia matrix, with axes that are not the body's",
    parameters=(*(Parameter(axes, '1', 0.2, 5.0, 0.1,
                            f'factor on the moment of inertia about body {axes[0]}', null=1.0,
                            excited_by=turn, gain=-1)
                  for axes, turn in MOMENTS),
                *(Parameter(axes, '1', -WIDEST, WIDEST, 0.1,
                            f'element {axes} of the matrix of inertia, added to that of the file, '
                            'over the root of the two moments', excited_by=turn)
                  for axes, turn in PRODUCTS)),
    source="six numbers of a symmetric matrix; Euler's equations, Goldstein, Classical "
           'Mechanics, section 5.5',
    on_rotors=False,
    body=body)
