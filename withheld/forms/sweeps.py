# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Moments of propellers whose blades are swept back."""

from withheld.forms.hubs import HubMoment


class SweptBack(HubMoment):
    """
    Quiet propellers whose blades are swept back, so that lift that bends them also untwists them.

    As with the wings of jets: a blade that meets more air takes some of its lift off again, the
    more, the faster it turns, as the air grows stiffer and the plastic does not. So the moment
    hardly grows with the speed of the rotors. R. L. Bisplinghoff, H. Ashley, R. L. Halfman,
    Aeroelasticity, 1955, chapter 8.
    """

    SOFT = 1.5          # of the twist's stiffness: what the air has in hover

    def per_velocity(self, across, turn):
        """Return the moments (n,) per velocity, of the usual one at the speed of hover."""
        return turn * (1.0 + self.SOFT) / (1.0 + self.SOFT * turn ** 2)
