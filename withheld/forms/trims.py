# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Attitudes that are trimmed by angles."""

from scipy.spatial.transform import Rotation

from withheld.forms.body import Tilt


class Trimmed(Tilt):
    """
    Roll, pitch and heading each with a trim that is added to the angle, and that is wrong.

    As ground stations and drivers of motion capture let one do: it is a tilt of the block only
    where the vehicle is level. As it leans aside, the pitch that is added turns about another axis
    of the body, and the heading about the vertical of the world. J. Diebel, Representing
    Attitude: Euler Angles, Unit Quaternions, and Rotation Vectors, Stanford University, 2006.
    """

    def measured(self, time, state, thrust):
        """Return what is said."""
        out = state.copy()
        angles = Rotation.from_quat(state[6:10]).as_euler('ZYX') + self.angles[::-1]
        out[6:10] = Rotation.from_euler('ZYX', angles).as_quat()
        return out
