# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers of Gazebo's motor plugins that change."""

from collections.abc import Sequence
import math

import numpy as np

from quad_ident_ros.vehicle_files.edit_xml import EditedXml
from quad_ident_ros.vehicle_files.gz_motors import MotorPlugin
from quad_ident_ros.vehicle_files.out_base import Base
from quad_ident_ros.vehicle_files.ways import Keys, LAGS
from quad_ident_ros.vehicle_files.weak_rotors import losses_of

HOLDS: Keys = ('thrust', 'losses', 'torque', 'torque_losses', 'speed_max', *LAGS, 'rotor_drag')


def write_motors(edited: EditedXml, base: Base, plugins: Sequence[MotorPlugin]) -> None:
    """Have motor plugins hold what is wanted."""
    wanted = base.wanted
    losses, torque_losses = wanted.losses, wanted.torque_losses
    if np.max(losses) >= 1.0:
        losses = torque_losses = np.zeros(len(losses))
        edited.lack(['losses'], 'the plugin needs a motorConstant above 0; take it out')
    # Tag, value, unit, the key of Wanted that says what it comes from.
    rows = [('timeConstantUp', wanted.rise, 's', 'rise'),
            ('timeConstantDown', wanted.fall, 's', 'fall')]
    if wanted.rotor_drag < 0.0:
        edited.lack(['rotor_drag'], 'the plugin has no drag below 0')
    else:
        rows.append(('rotorDragCoefficient', wanted.rotor_drag, 'kg/rad', 'rotor_drag'))
    if math.isinf(wanted.speed_max):
        edited.lack(['speed_max'], 'the plugin needs a limit; that of the file stays')
    else:
        rows.append(('maxRotVelocity', wanted.speed_max, 'rad/s', 'speed_max'))
    before, _ = losses_of(base.effects, len(plugins))
    for plugin, loss, torque_loss, faulty in zip(plugins, losses, torque_losses,
                                                 (before > 0.0) | (losses > 0.0), strict=True):
        constant = wanted.thrust * (1.0 - loss)
        ratio = wanted.torque * (1.0 - torque_loss) / constant
        more = f', {wanted.sources["losses"]}' if faulty else ''
        for tag, value, unit, key in (
                ('motorConstant', constant, 'N/(rad/s)^2', 'thrust'),
                ('momentConstant', ratio, 'm', 'torque'), *rows):
            source = wanted.sources[key] + (more if key == 'thrust' else '')
            if tag == 'momentConstant':
                source = f'{source} over {wanted.sources["thrust"]}{more}'
            if tag == 'rotorDragCoefficient':
                source = f'{source} over the hover speeds'
            edited.content(plugin.element, tag, [value], unit, source,
                           usual=[plugin.numbers[tag]])
