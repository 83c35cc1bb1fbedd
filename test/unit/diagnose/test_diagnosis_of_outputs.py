# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A flight whose commands are no rotor speeds has the diagnosis of those in rad/s."""

from dataclasses import replace
import math

import numpy as np
import pytest
from test_diagnosis import flown, HOVER, VEHICLE

from quad_ident_ros.data.outputs import commanded
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.model.motors import motors_from

pytestmark = pytest.mark.slow
FULL = 1.5 * HOVER
THRUST = VEHICLE.thrust_coefficient * FULL ** 2
TRUTH = {'motor_lag': {'time_constant': 0.03}, 'rotor_drag': {'coefficient': 0.15}}
NOWHERE = replace(VEHICLE, speed_min=0.0, speed_max=math.inf)
CURVE = {'kind': 'duty16', 'thrust': [0.0, 0.2 * THRUST, 0.8 * THRUST]}


def duty(speeds):
    """Return the duty by which CURVE gives the thrust of these speeds."""
    share = VEHICLE.thrust_coefficient * speeds ** 2 / THRUST
    return np.round(65535 * (-0.2 + np.sqrt(0.04 + 3.2 * share)) / 1.6)


def with_outputs(record, told):
    columns = {name: values for name, values in record.columns.items()
               if not name.startswith(('cmd', 'rotor'))}
    columns |= {f'output{k}': told(record.columns[f'cmd{k}']) for k in range(1, 5)}
    return FlightRecord(record.t, columns, record.info)


@pytest.mark.parametrize(('vehicle', 'told'), [
    (replace(VEHICLE, speed_min=0.0, speed_max=FULL), lambda speed: 1000 + 1000 * speed / FULL),
    (replace(VEHICLE, motors=motors_from('v', CURVE)), duty),
    (NOWHERE, lambda speed: speed / FULL)], ids=['pwm', 'duty16 by a thrust curve', 'by weight'])
def test_the_diagnosis_is_that_of_rotor_speeds(vehicle, told):
    records = [commanded([with_outputs(record, told)], vehicle)[0] for record in flown(TRUTH)]
    found = diagnose(records, vehicle)
    assert set(found.verdict) == set(TRUTH) and found.gap.closed > 0.98
    for row in found.ranking:
        for name, value in TRUTH.get(row.effect, {}).items():
            assert row.parameters[name].value == pytest.approx(value, rel=0.02)
    codes = {one['code'] for one in found.findings}
    assert 'commands' in codes
    assert ('thrust_level' in codes) == (vehicle is NOWHERE)
    assert ({'thrust_scale', 'mass_offset'} <= set(found.not_shown)) == (vehicle is NOWHERE)


def test_a_curve_that_is_bent_is_named_where_the_weight_sets_its_scale():
    records = [commanded([with_outputs(record, lambda speed: speed / FULL)], NOWHERE)[0]
               for record in flown({'thrust_scale': {'at_hover': 1.2, 'offset': 0.4}})]
    found = diagnose(records, NOWHERE)
    assert found.verdict[0] == 'thrust_scale' and 'mass_offset' not in found.verdict
    [row] = [one for one in found.ranking if one.effect == 'thrust_scale']
    assert row.parameters.keys() == {'offset'}
    # 1.2 ((speed + 0.4) / 1.4)^2 is the weight at this speed, which the commands have as 1.
    hover = 1.4 / math.sqrt(1.2) - 0.4
    assert row.parameters['offset'].value == pytest.approx(0.4 / hover, abs=0.02)
