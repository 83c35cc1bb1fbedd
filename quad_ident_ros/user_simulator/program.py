# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A simulator that is a class in a user's Python file: loaded, called, and its errors reported."""

import inspect
from typing import Any

import numpy as np

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.dynamics import STATES
from quad_ident_ros.model.rigid_body import STATE
from quad_ident_ros.user_class import UserClass

WRENCH = ('force', 'moment')
METHODS = 'reset(state) and step(commands, dt)'
UNIT = 1e-3         # that the length of a quaternion may differ from 1: float32 is far below

INTERFACE = """\
class Name:                                # made without arguments
    def reset(self, state): ...            # begin at a state (13 + n,), n rotors:
        # px py pz m, vx vy vz m/s, world, z up; qw qx qy qz, body to world;
        # wx wy wz rad/s, body, x forward, y left; rotor1 ... rotorn rad/s
    def step(self, commands, dt): ...      # hold cmd1 ... cmdn (n,) rad/s for dt s; return
        # the state then, (13 + n,), or (13,) where it does not know its rotors' speeds
    # instead of (commands, dt): (commands, dt, force, moment), which act on the body's
    # origin, (3,) N and (3,) N m, body axes; else effects push between two steps, by reset
    # instead of both, for many states (B, 13 + n) at once, dt (B,):
    # def step_many(self, states, commands, dt[, force, moment])"""


class Program:
    """
    An instance of the class that FILE.py:NAME names.

    spec: the same, in any folder; at_once: whether it has step_many; takes_wrench: whether it
    takes force and moment. Raises InputError for all that is wrong with the file, in one line that
    says where.
    """

    def __init__(self, spec: str) -> None:
        self._user = UserClass(spec, '--simulator')
        self.spec = f'{self._user.path}:{self._user.name}'
        self.at_once = self._user.optional('step_many') is not None
        if not self.at_once:
            self._reset = self._user.method('reset', METHODS)
        self._name = 'step_many' if self.at_once else 'step'
        self._step = self._user.method(self._name, METHODS)
        signature = self._user.call(self._name, inspect.signature, self._step)
        self.takes_wrench = set(WRENCH) <= set(signature.parameters)

    def reset(self, state: np.ndarray) -> None:
        """Begin at a state (13 + n,)."""
        self._user.call('reset', self._reset, state.copy())

    def step(self, states: np.ndarray, commands: np.ndarray, dt: np.ndarray, *wrench: np.ndarray
             ) -> np.ndarray:
        """
        Return the states (B, 13) or (B, 13 + n) after a step.

        Args: states (B, 13 + n) before it, which a simulator that steps one at a time has by
        itself; commands (B, n) rad/s; dt (B,) s; wrench: force (B, 3) N and moment (B, 3) N m,
        body, or nothing. B is 1 where it is not at_once.
        """
        wrench = wrench or (np.zeros((len(dt), 3)),) * 2
        pushes = wrench if self.takes_wrench else ()
        if self.at_once:
            made = self._user.call(self._name, self._step, states.copy(), commands.copy(),
                                   dt.copy(), *pushes)
        else:
            made = self._user.call(self._name, self._step, commands[0].copy(), float(dt[0]),
                                   *(push[0] for push in pushes))
        return self._checked(made, states)

    def _checked(self, made: Any, states: np.ndarray) -> np.ndarray:
        """Return what a step returned as states of (B, 13) or (B, 13 + n); InputError."""
        where = self._user.returns(self._name, self._step)
        shapes = [(*(states.shape[:1] if self.at_once else ()), width)
                  for width in (STATE, states.shape[1])]
        found = self._user.array(self._name, self._step, made,
                                 f'an array of {shapes[0]} or {shapes[1]} numbers')
        if found.shape not in shapes:
            raise InputError(f'{where} an array of shape {found.shape}; expected {shapes[0]} or '
                             f'{shapes[1]}: {" ".join(STATES)}, and the speeds of the rotors')
        found = np.array(found.reshape(len(states), -1))
        bad = ~np.isfinite(found).all(axis=0)
        if bad.any():
            names = [*STATES, *(f'rotor{k + 1}' for k in range(states.shape[1] - STATE))]
            one = int(np.argmax(~np.isfinite(found).all(axis=1)))
            raise InputError(f'{where} {names[int(np.argmax(bad))]} = '
                             f'{found[one, int(np.argmax(bad))]:g} after a step from '
                             + ' '.join(f'{name} {value:.4g}' for name, value
                                        in zip(names, states[one], strict=True)))
        length = np.linalg.norm(found[:, 6:10], axis=1, keepdims=True)
        if np.max(np.abs(length - 1.0)) > UNIT:
            raise InputError(f'{where} a quaternion qw qx qy qz of length '
                             f'{length.flat[np.argmax(np.abs(length - 1.0))]:.4g}; expected 1')
        found[:, 6:10] /= length
        return found
