# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers of Gazebo's motor plugins that change."""

from collections.abc import Sequence
import math

from quad_ident_ros.vehicle_files.edit_xml import Edited
from quad_ident_ros.vehicle_files.gz_motors import MotorPlugin
from quad_ident_ros.vehicle_files.out_base import Base


def write_motors(edited: Edited, base: Base, plugins: Sequence[MotorPlugin]) -> dict[str, str]:
    """Have motor plugins hold what is wanted; return {key of Wanted: why it is lacking}."""
    wanted, lacking = base.wanted, {}
    thrust, torque = wanted.stds.get('thrust', (0.0,))[0], wanted.stds.get('torque', (0.0,))[0]
    ratio = wanted.torque / wanted.thrust
    # Tag, value, unit, standard error, the key of Wanted that says what it comes from.
    rows = [('motorConstant', wanted.thrust, 'N/(rad/s)^2', thrust * wanted.thrust, 'thrust'),
            ('momentConstant', ratio, 'm', math.hypot(thrust, torque) * ratio, 'torque'),
            ('timeConstantUp', wanted.rise, 's', 0.0, 'rise'),
            ('timeConstantDown', wanted.fall, 's', 0.0, 'fall')]
    if wanted.rotor_drag < 0.0:
        lacking['rotor_drag'] = 'the plugin has no drag below 0'
    else:
        rows.append(('rotorDragCoefficient', wanted.rotor_drag, 'kg/rad', 0.0, 'rotor_drag'))
    if math.isinf(wanted.speed_max):
        lacking['speed_max'] = 'the plugin needs a limit; that of the file stays'
    else:
        rows.append(('maxRotVelocity', wanted.speed_max, 'rad/s',
                     wanted.stds.get('speed_max', (0.0,))[0], 'speed_max'))
    for plugin in plugins:
        for tag, value, unit, std, key in rows:
            source = wanted.sources[key]
            if tag == 'momentConstant':
                source = f'{source} over {wanted.sources["thrust"]}'
            if tag == 'rotorDragCoefficient':
                source = f'{source} over the hover speeds'
            edited.content(plugin.element, tag, [value], unit, source, [std or None],
                           usual=[plugin.numbers[tag]])
    return lacking
