# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Volume, surface and inertia of the shapes of MJCF, as MuJoCo has them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
import math

THOMSEN = 1.6075    # power by which the surface of an ellipsoid is off by 1.1 % at most


@dataclass(frozen=True)
class Shape:
    """
    A shape of some sizes: radii and halves, m.

    measure(*sizes): its volume, m^3, or surface, m^2; moments(*sizes): of inertia per mass about
    x, y and z through its centre, m^2.
    """

    sizes: int
    measure: Callable[..., float]
    moments: Callable[..., tuple[float, ...]]


def _capsule(r: float, half: float) -> tuple[float, float, float]:
    """Return the moments of a cylinder with half balls at its ends."""
    height = 2.0 * half
    balls = 4.0 * r / (4.0 * r + 3.0 * height)
    across = ((1.0 - balls) * (3.0 * r * r + height * height) / 12.0
              + balls * (0.4 * r * r + 0.25 * height * height + 0.375 * height * r))
    return across, across, (1.0 - balls) * r * r / 2.0 + balls * 0.4 * r * r


def _capsule_shell(r: float, half: float) -> tuple[float, float, float]:
    height = 2.0 * half
    balls = 2.0 * r / (2.0 * r + height)
    across = ((1.0 - balls) * (r * r / 2.0 + height * height / 12.0)
              + balls * (2.0 * r * r / 3.0 + height * height / 4.0 + height * r / 2.0))
    return across, across, (1.0 - balls) * r * r + balls * 2.0 * r * r / 3.0


def _cylinder_shell(r: float, half: float) -> tuple[float, float, float]:
    ends = r / (r + 2.0 * half)
    across = ((1.0 - ends) * (r * r / 2.0 + half * half / 3.0)
              + ends * (r * r / 4.0 + half * half))
    return across, across, (1.0 - ends) * r * r + ends * r * r / 2.0


def _box_shell(a: float, b: float, c: float) -> tuple[float, float, float]:
    faces = b * c, a * c, a * b
    whole = sum(faces)
    # Of the square of the place along each axis, the mean over the surface.
    x, y, z = (size * size * (whole + 2.0 * face) / (3.0 * whole)
               for size, face in zip((a, b, c), faces, strict=True))
    return y + z, x + z, x + y


def _ellipsoid_surface(a: float, b: float, c: float) -> float:
    pairs = (a * b) ** THOMSEN, (a * c) ** THOMSEN, (b * c) ** THOMSEN
    return 4.0 * math.pi * (sum(pairs) / 3.0) ** (1.0 / THOMSEN)


def _ellipsoid_shell(a: float, b: float, c: float) -> tuple[float, float, float]:
    """Return the moments of a shell by which all three radii grow alike, as MuJoCo has it."""
    thick = 1.0 / a + 1.0 / b + 1.0 / c
    x, y, z = (size * size / 5.0 * (1.0 + 2.0 / (size * thick)) for size in (a, b, c))
    return y + z, x + z, x + y


SOLIDS = {
    'sphere': Shape(1, lambda r: 4.0 / 3.0 * math.pi * r ** 3, lambda r: (0.4 * r * r,) * 3),
    'capsule': Shape(2, lambda r, h: math.pi * r * r * (2.0 * h + 4.0 / 3.0 * r), _capsule),
    'cylinder': Shape(2, lambda r, h: math.pi * r * r * 2.0 * h,
                      lambda r, h: ((3 * r * r + 4 * h * h) / 12.0,) * 2 + (r * r / 2.0,)),
    'ellipsoid': Shape(3, lambda a, b, c: 4.0 / 3.0 * math.pi * a * b * c,
                       lambda a, b, c: ((b * b + c * c) / 5, (a * a + c * c) / 5,
                                        (a * a + b * b) / 5)),
    'box': Shape(3, lambda a, b, c: 8.0 * a * b * c,
                 lambda a, b, c: ((b * b + c * c) / 3, (a * a + c * c) / 3,
                                  (a * a + b * b) / 3))}
"""Shapes full of mass, by the type of their geom."""

SHELLS = {
    'sphere': Shape(1, lambda r: 4.0 * math.pi * r * r, lambda r: (2.0 * r * r / 3.0,) * 3),
    'capsule': Shape(2, lambda r, h: 4.0 * math.pi * r * (r + h), _capsule_shell),
    'cylinder': Shape(2, lambda r, h: 2.0 * math.pi * r * (r + 2.0 * h), _cylinder_shell),
    'ellipsoid': Shape(3, _ellipsoid_surface, _ellipsoid_shell),
    'box': Shape(3, lambda a, b, c: 8.0 * (a * b + a * c + b * c), _box_shell)}
"""Shapes whose mass is on their surface (shellinertia), by the type of their geom."""
