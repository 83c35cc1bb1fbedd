# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Problem P3: flights of a vehicle of known constants, and the Cramer-Rao bound of these."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.greybox.parameters import INDEX, nominal
from quad_ident_ros.model.attitude import product, turn
from quad_ident_ros.model.dynamics import course_of, predict, STATES, states_of
from quad_ident_ros.model.rigid_body import vehicle_vector
from quad_ident_ros.model.vehicle import Rotor, Vehicle

NAMES = ('mass', 'inertia_x', 'inertia_y', 'inertia_z', 'thrust_coefficient',
         'torque_coefficient', 'linear_drag_x', 'linear_drag_y')
VEHICLE = Vehicle(
    name='p3', mass=1.0, inertia=(8e-3, 9e-3, 1.2e-2), gravity=9.806, thrust_coefficient=1e-5,
    torque_coefficient=1.6e-7, linear_drag=(0.25, 0.2, 0.0), speed_max=1500.0,
    rotors=tuple(Rotor((x, y, 0.0), spin) for x, y, spin in
                 ((0.16, 0.16, 1), (0.16, -0.16, -1), (-0.16, -0.16, 1), (-0.16, 0.16, -1))))
NOISE = np.repeat([0.002, 0.02, 0.004, 0.02], 3)    # m, m/s, rad, rad/s
SECONDS, RATE = 20.0, 100.0
SAMPLES, ROLLOUTS = 50, 40      # of a rollout, and how many
FAR = 0.3       # how far from the truth the starts of a fit lie, at most
STEP = 1e-5     # relative, of the central differences that give the bound


@dataclass(frozen=True)
class FlightProblem:
    """
    A flight without noise, to which white noise is added; number: that of its random numbers.

    The mass is known: with all of NAMES free, one factor on all of them changes nothing.
    """

    trajectory: str = 'lissajous'
    vehicle: Vehicle = VEHICLE
    number: int = 3

    @cached_property
    def clean(self):
        """Return the record without noise."""
        return fly_closed_loop(self.vehicle, {}, self.trajectory, duration=SECONDS, rate=RATE,
                               seed=self.number)

    @property
    def truth(self):
        """Return the constants of NAMES but the mass, (7,)."""
        return nominal(self.vehicle)[[INDEX[name] for name in NAMES[1:]]]

    def draw(self, seed):
        """Return the record with white noise on all states."""
        random = np.random.default_rng([self.number, seed])
        states = states_of(self.clean)
        noise = NOISE * random.standard_normal((len(states), len(NOISE)))
        states[:, :6] += noise[:, :6]
        states[:, 6:10] = product(states[:, 6:10], turn(noise[:, 6:9]))
        states[:, 10:] += noise[:, 9:]
        return FlightRecord(self.clean.t, {**self.clean.columns,
                                           **dict(zip(STATES, states.T, strict=True))},
                            {'name': f'p3_{seed}'})

    def start(self, seed):
        """
        Return a vehicle whose constants, but the mass, are off by up to FAR.

        One factor for all moments of inertia, so that they remain those of a body.
        """
        random = np.random.default_rng([self.number, seed, 1])
        factors = random.uniform(1 - FAR, 1 + FAR, len(NAMES) - 1)
        factors[:3] = factors[0]
        return with_constants(self.vehicle, dict(zip(NAMES[1:], self.truth * factors,
                                                     strict=True)))

    @cached_property
    def bound(self):
        """
        Return the Cramer-Rao bound of the standard deviations of NAMES but the mass, (7,).

        The initial states of the rollouts are unknown as well. From central differences of
        predictions; nothing here comes from the estimation.
        """
        course, states = course_of(self.clean, self.vehicle), states_of(self.clean)
        first = SAMPLES * np.arange(ROLLOUTS)
        constants = vehicle_vector(self.vehicle)
        places = [INDEX[name] for name in NAMES[1:]]
        theta = nominal(self.vehicle)[len(constants):]

        def flown(constants, starts):
            return predict(self.vehicle, theta, course, starts, first, SAMPLES,
                           constants=constants[None])

        def slope(plus, minus, step):
            turned = product(minus[..., 6:10] * [1, -1, -1, -1], plus[..., 6:10])
            change = np.concatenate([plus[..., :6] - minus[..., :6], 2 * turned[..., 1:],
                                     plus[..., 10:] - minus[..., 10:]], axis=-1)
            return (change / (2 * step) / NOISE).reshape(ROLLOUTS, -1)

        columns = []
        for place in places:
            step = np.zeros(len(constants))
            step[place] = STEP * constants[place]
            columns.append(slope(flown(constants + step, states[first]),
                                 flown(constants - step, states[first]), step[place]))
        for axis in range(len(NOISE)):
            step = np.zeros(len(NOISE))
            step[axis] = STEP
            columns.append(slope(flown(constants, _shifted(states[first], step)),
                                 flown(constants, _shifted(states[first], -step)), STEP))
        table = np.stack(columns, axis=-1)
        count = len(places)
        information = np.zeros((count, count))
        for own, starts in zip(table[..., :count], table[..., count:], strict=True):
            left = own - starts @ np.linalg.lstsq(starts, own)[0]
            information += left.T @ left
        return np.sqrt(np.diag(np.linalg.inv(information)))


def with_constants(vehicle, values):
    """Return a vehicle with constants by their NAMES."""
    data = {field: getattr(vehicle, field) for field in vehicle.__dataclass_fields__}
    for name, value in values.items():
        if name in data:
            data[name] = float(value)
        else:
            key, axis = name[:-2], 'xyz'.index(name[-1])
            data[key] = (*data[key][:axis], float(value), *data[key][axis + 1:])
    return Vehicle(**data)


def _shifted(states, step):
    out = states.copy()
    out[:, :6] += step[:6]
    out[:, 6:10] = product(out[:, 6:10], turn(step[6:9]))
    out[:, 10:] += step[9:]
    return out
