# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
What the columns of a table are, where their names and values leave no doubt.

One module per subject, each with steps that take columns from a Draft, in the order of STEPS.
"""

from dataclasses import replace
import warnings

import numpy as np

from quad_ident_ros.data.guess import attitude, clock, motion, motors, programs
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
    made = Draft(replace(table, columns=finite), given)
    with warnings.catch_warnings(), np.errstate(all='ignore'):
        warnings.simplefilter('ignore', RuntimeWarning)     # of rows without any value
        for step in STEPS:
            step(made)
    made.guess.mapping = Mapping({}, made.world, made.body, {}, given.actuators, made.columns,
                                 made.order, given.separator)
    if made.free:
        made.guess.said.append(f'not taken for anything: {shown(made.free)}')
    if not made.guess.roles:
        made.guess.doubts.append('no column is a position, velocity, attitude, rate or specific '
                                 'force by its name')
    return made.guess
