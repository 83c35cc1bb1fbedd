# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What the columns of a table are, where their names and values leave no doubt.

One module per subject, each with steps that take columns from a Draft, in the order of STEPS.
"""

from dataclasses import replace
import warnings

import numpy as np

from quad_ident_ros.data.guess import attitude, clock, motion, motors, programs, time_check
from quad_ident_ros.data.guess.draft import Draft, Guess
from quad_ident_ros.data.mapping import Mapping
from quad_ident_ros.data.tabular import shown, Table

STEPS = (clock.time, programs.blackbox_decode, programs.vicon, programs.qualisys,
         programs.crazyflie, motion.vectors, attitude.quaternion, attitude.angles, attitude.rates,
         motion.positions, programs.motive, motion.forces, motion.axes, motion.velocities,
         motors.motors, motors.battery)
BEYOND = 1e30   # no quantity of a flight, in any unit, is as large


def guess(table: Table, given: Mapping | None = None) -> Guess:
    """
    Return the Guess of a table.

    Args: table tabular.Table; given Mapping or None: what it says of frames and quaternions holds.
    """
    given = given or Mapping()
    # Values that are not numbers of a flight are ignored.
    finite = {name: np.where(np.abs(values) < BEYOND, values, np.nan)
              for name, values in table.columns.items()}
    made = _made(replace(table, columns=finite), given)
    made.guess.mapping = Mapping({}, made.world, made.body, {}, given.actuators, made.columns,
                                 made.order, given.separator)
    if made.free:
        made.guess.said.append(f'not taken for anything: {shown(made.free)}')
    if not made.guess.roles:
        made.guess.doubts.append('no column is a position, velocity, attitude, rate or specific '
                                 'force by its name')
    return made.guess


def _made(table: Table, given: Mapping) -> Draft:
    """Return the finished Draft; a blind one, where its columns contradict the time."""
    with warnings.catch_warnings(), np.errstate(all='ignore'):
        warnings.simplefilter('ignore', RuntimeWarning)     # of rows without any value
        made = Draft(table, given)
        for step in STEPS:
            step(made)
        # What another unit in the name of the time would make of the others is doubted as well.
        doubt = time_check.doubt_of(made) if made.unsure or made.guess.doubts else None
        if doubt is None:
            return made
        made = Draft(table, given, blind=True)
        for step in STEPS:
            step(made)
    doubt.enter(made)
    return made
