# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The kinds of files that vehicles are read from, by their content."""

from collections.abc import Callable
from dataclasses import dataclass

from quad_ident_ros.vehicle_files import drone_models, mjcf, px4_sih, rotorpy, sdf, urdf
from quad_ident_ros.vehicle_files.reading import Draft
from quad_ident_ros.vehicle_files.source import Source


@dataclass(frozen=True)
class Kind:
    """A kind of file: name, what it is called, whether a text is one, and its reader."""

    name: str
    title: str
    recognises: Callable[[str], bool]
    read: Callable[[Source], Draft]


KINDS = (
    Kind('mjcf', 'an MJCF model of MuJoCo', mjcf.recognises, mjcf.read),
    Kind('sdf', 'an SDF model of Gazebo', sdf.recognises, sdf.read),
    Kind('urdf', 'a URDF', urdf.recognises, urdf.read),
    Kind('rotorpy', 'a dictionary of rotorpy', rotorpy.recognises, rotorpy.read),
    Kind('drone_models', 'parameters of drone-models, as crazyflow has them',
         drone_models.recognises, drone_models.read),
    # Others' files may name parameters of PX4 in a comment.
    Kind('px4_sih', "parameters of PX4's SIH", px4_sih.recognises, px4_sih.read),
)


def kind_of(text: str) -> Kind | None:
    """Return the kind of a text, or None."""
    return next((kind for kind in KINDS if kind.recognises(text)), None)
