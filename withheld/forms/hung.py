# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of bodies in MuJoCo: loads on cables, hulls; and identified motors."""

from withheld.constants import arm_length
from withheld.influence import Part


class Cable(Part):
    """A payload on a cable from the centre of mass: what swings of it is no mass."""

    comparable = True
    beside = ('unknown',)

    def __init__(self, size, params, rng):
        """Draw how long the cable is."""
        self.parameters = {'mass': 0.007 * size * params['mass']}
        self.length = arm_length(params) * rng.uniform(1.5, 3.0)

    def bodies(self):
        """Ask for the payload; none at size 0."""
        if not self.parameters['mass']:
            return {}
        from withheld.bodies import Payload
        return {'payload': Payload(self.parameters['mass'], self.length)}


class Hull(Part):
    """The drag of an ellipsoid."""

    beside = ('rotor_drag',)

    def __init__(self, size, params, rng):
        """Take the size."""
        self.parameters = {'size': size}

    def bodies(self):
        """Ask for the hull."""
        return {'hull': self.parameters['size']}


def identified(name):
    """Return the form of the motors that drone-models has of a vehicle."""
    def made(size, params, rng):
        from withheld.bodies import Identified
        return Identified(size, params, rng, name)
    return made
