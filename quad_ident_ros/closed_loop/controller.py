# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The controller that closes the loop: ours, or a class in a user's Python file."""

from dataclasses import dataclass

import numpy as np
import scipy

from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.controller import Controller, Tracking, WANTED
from quad_ident_ros.model.rigid_body import STATE
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.user_class import UserClass

OURS = 'ours'
METHODS = 'reset() and control(state, reference, dt)'
STEP = 0.01     # s, of the one step for which a controller is tried

INTERFACE = """\
class Name:                                # made without arguments
    def reset(self): ...                   # before each flight, which begins in hover
    def control(self, state, reference, dt): ...   # each dt s; return cmd1 ... cmdn (n,) rad/s
        # state (13,): px py pz m, vx vy vz m/s, world, z up; qw qx qy qz, body to world;
        # wx wy wz rad/s, body, x forward, y left
        # reference (14,): position m, velocity, acceleration, jerk (3 each, world), yaw rad,
        # yaw rate rad/s"""


class UserController:
    """
    The controller FILE.py:NAME of a vehicle, a Controller.

    Its commands end at the limits of the rotors. Raises InputError for what is wrong with it.
    """

    def __init__(self, spec: str, vehicle: Vehicle) -> None:
        self._user = UserClass(spec, '--controller')
        self._reset = self._user.method('reset', METHODS)
        self._control = self._user.method('control', METHODS)
        self._limits = vehicle.speed_min, vehicle.speed_max
        still, reference = np.zeros(STATE + 5), np.zeros(WANTED)
        still[2] = reference[2] = 1.0
        still[6:15] = np.eye(3).ravel()
        self.reset()
        self.control(still, reference, STEP, np.empty(len(vehicle.rotors)))  # told at once

    def reset(self) -> None:
        """Begin a flight, in hover."""
        self._user.call('reset', self._reset)

    def control(self, seen: np.ndarray, wanted: np.ndarray, dt: float, command: np.ndarray
                ) -> None:
        """Write the commands (n,) rad/s that the user's controller gives."""
        turned = scipy.spatial.transform.Rotation.from_matrix(seen[6:15].reshape(3, 3)).as_quat()
        state = np.concatenate([seen[:6], turned[3:], turned[:3], seen[15:]])
        made = self._user.call('control', self._control, state, wanted.copy(), dt)
        found = self._user.array('control', self._control, made,
                                 f'an array of {len(command)} rotor speeds')
        if found.shape != command.shape:
            raise InputError(f'{self._user.returns("control", self._control)} an array of shape '
                             f'{found.shape}; expected {command.shape}: a speed (rad/s) for each '
                             'rotor')
        if not np.isfinite(found).all():
            rotor = int(np.argmin(np.isfinite(found)))
            raise InputError(f'{self._user.returns("control", self._control)} cmd{rotor + 1} = '
                             f'{found[rotor]:g}; expected finite speeds, rad/s')
        np.clip(found, *self._limits, out=command)


@dataclass(frozen=True, eq=False)
class NamedController:
    """A Controller and its name in --controller."""

    spec: str
    controller: Controller


def controller_of(spec: str, vehicle: Vehicle) -> NamedController:
    """Return the controller that --controller names: `ours`, or FILE.py:NAME; InputError."""
    if spec != OURS and ':' not in spec:
        raise InputError(f'--controller {spec}: expected FILE.py:NAME, a class in a Python file, '
                         f'or {OURS}')
    return NamedController(spec, Tracking(vehicle) if spec == OURS
                           else UserController(spec, vehicle))
