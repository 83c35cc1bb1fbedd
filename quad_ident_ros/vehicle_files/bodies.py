# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Poses of frames, and the mass and inertia of several bodies together."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.attitude import rotation_matrix

# Moments that are estimates or rounded miss the inequality of the triangle by a little: those of
# rotorpy's Crazyflie by 1 %.
ROUNDED = 0.05
# By which an inertia that is written stays below the inequality: on it MuJoCo's compiler finds
# some beyond, by rounding.
INSIDE = 1e-9


@dataclass(frozen=True)
class Pose:
    """A frame in another: rotation (3, 3) and position (3,), m."""

    rotation: np.ndarray
    position: np.ndarray

    def __matmul__(self, other: Pose) -> Pose:
        """Return the pose, in the frame of this one's parent, of a frame that is given in this."""
        return Pose(self.rotation @ other.rotation,
                    self.position + self.rotation @ other.position)

    @property
    def inverse(self) -> Pose:
        """Return the pose of the parent in this frame."""
        return Pose(self.rotation.T, -self.rotation.T @ self.position)


def pose(position: ArrayLike = (0.0, 0.0, 0.0), rotation: ArrayLike | None = None) -> Pose:
    """Return the Pose of a position (3,), m, and a rotation (3, 3)."""
    return Pose(np.eye(3) if rotation is None else np.asarray(rotation, float),
                np.asarray(position, float))


def turned(quaternion: ArrayLike) -> np.ndarray:
    """Return the rotation (3, 3) of a quaternion (4,), scalar first, of any length but 0."""
    values = np.asarray(quaternion, float)
    return rotation_matrix(values / np.linalg.norm(values))


def about(axis: ArrayLike, angle: float) -> np.ndarray:
    """Return the rotation (3, 3) about an axis (3,) of any length by an angle, rad."""
    unit = np.asarray(axis, float) / np.linalg.norm(axis)
    return turned([np.cos(angle / 2.0), *(np.sin(angle / 2.0) * unit)])


def fixed_axes(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """Return the rotation (3, 3) of angles about fixed axes x, y, z, rad, as URDF and SDF do."""
    return about((0, 0, 1), yaw) @ about((0, 1, 0), pitch) @ about((1, 0, 0), roll)


@dataclass(frozen=True)
class Body:
    """A rigid body: mass kg, centre of mass (3,) m, inertia (3, 3) kg m^2 about that centre."""

    mass: float
    centre: np.ndarray
    inertia: np.ndarray

    def placed(self, frame: Pose) -> Body:
        """Return the body in the parent's axes of the frame that it is given in."""
        return Body(self.mass, frame.position + frame.rotation @ self.centre,
                    frame.rotation @ self.inertia @ frame.rotation.T)


def symmetric(xx: float, yy: float, zz: float, xy: float = 0.0, xz: float = 0.0, yz: float = 0.0
              ) -> np.ndarray:
    """Return the inertia matrix (3, 3) of its six numbers; xy, xz, yz are its own entries."""
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], float)


def combined(bodies: Sequence[Body]) -> Body:
    """Return one Body for several that are fixed to one another, by parallel axes."""
    mass = sum(body.mass for body in bodies)
    centre = sum((body.mass * body.centre for body in bodies), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for body in bodies:
        arm = body.centre - centre
        inertia += body.inertia + body.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Body(mass, centre, inertia)


def nearest_common(names: Sequence[str], above: Mapping[str, str], known: Container[str]) -> str:
    """
    Return the nearest body that several hang on, one of them where it carries the others.

    Args: names: at least one; above: what each hangs on, by name; known: what counts as a body.
    The first of the names where they hang on nothing together.
    """
    chains = [list(_upwards(name, above)) for name in names]
    return next((name for name in chains[0] if name in known
                 and all(name in chain for chain in chains)), names[0])


def _upwards(name: str, above: Mapping[str, str]) -> Iterator[str]:
    """Give a name and all that it hangs on, each once."""
    seen: set[str] = set()
    while name not in seen:
        yield name
        seen.add(name)
        name = above.get(name, name)


def spun(body: Body, axis: ArrayLike) -> Body:
    """Return a body as it is on average while it turns about an axis (3,) through its centre."""
    unit = np.asarray(axis, float) / np.linalg.norm(axis)
    along = float(unit @ body.inertia @ unit)
    across = 0.5 * (float(np.trace(body.inertia)) - along)
    return Body(body.mass, body.centre,
                across * np.eye(3) + (along - across) * np.outer(unit, unit))


def check_body(where: str, body: Body) -> str:
    """
    Return a remark on the inertia of a body, or ''.

    Raises InputError for a mass or an inertia that no body can have; where: file and place.
    """
    if not np.isfinite([body.mass, *body.centre, *body.inertia.ravel()]).all():
        raise InputError(f'{where}: mass and inertia must be finite numbers')
    if body.mass < 0.0:
        raise InputError(f'{where}: a mass of {body.mass:g} kg is impossible; correct it')
    moments = np.linalg.eigvalsh(body.inertia)
    if moments[0] < -1e-9 * abs(moments[2]):
        raise InputError(f'{where}: no body has this inertia: about one axis it is '
                         f'{moments[0]:.4g} kg m2; correct its products')
    others = max(float(moments[0] + moments[1]), 1e-12 * float(moments[2]))
    beyond = moments[2] / others - 1.0 if moments[2] > 0.0 else 0.0
    said = (f'a principal moment of {moments[2]:.4g} kg m2 is {100 * beyond:.3g} % more than the '
            f'other two together, {moments[0] + moments[1]:.4g}')
    if beyond > ROUNDED:
        raise InputError(f'{where}: no body has this inertia: {said}; correct it')
    return f'{said}; it was taken as it is' if beyond > 1e-6 else ''


def nearest_body(body: Body) -> Body:
    """
    Return the body whose inertia is the nearest that a body can have; itself where it has that.

    About the same axes, its largest moment is lowered and the others are raised by as much each.
    """
    moments, axes = np.linalg.eigh(body.inertia)
    beyond = float(moments[2] - (1.0 - INSIDE) * (moments[0] + moments[1]))
    if beyond <= 0.0:
        return body
    moved = moments + beyond / 3.0 * np.array([1.0, 1.0, -1.0])
    return Body(body.mass, body.centre, axes @ np.diag(moved) @ axes.T)


def is_body(body: Body) -> bool:
    """Whether there may be a body of this mass and inertia."""
    try:
        check_body('', body)
    except InputError:
        return False
    return body.mass > 0.0


def principal_tilt(inertia: np.ndarray) -> float:
    """
    Return how far the principal axes lie from the body axes, rad.

    It is the largest angle between a principal axis and the body axis nearest to it, of an inertia
    (3, 3). Axes with equal moments are no axes: a turn within their plane counts nothing.
    """
    best = 0.0
    moments, axes = np.linalg.eigh(inertia)
    for column, moment in zip(axes.T, moments, strict=True):
        nearest = int(np.argmax(np.abs(column)))
        others = np.delete(moments, np.argmin(np.abs(moments - moment)))
        if np.min(np.abs(others - moment)) > 1e-6 * moments[2]:
            best = max(best, float(np.arccos(min(abs(column[nearest]), 1.0))))
    return best
