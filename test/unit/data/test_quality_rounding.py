# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Commands that a log rounds."""

from dataclasses import replace

import numpy as np
import pytest

from quad_ident_ros.data.quality import findings
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.model.vehicle import load_vehicle

IRIS = load_vehicle('iris')
SWING = 20.0    # rad/s of the command, at 3 Hz


@pytest.fixture(scope='module')
def flown():
    return fly_closed_loop(IRIS, {}, 'lissajous', duration=10.0, seed=1)


def told(record):
    """Return the finding on coarse commands, or None."""
    return next((one for one in findings(record, IRIS) if one.code == 'coarse_commands'), None)


def with_commands(record, change):
    """Return a record whose commands are changed."""
    return replace(record, columns={name: change(values) if name.startswith('cmd') else values
                                    for name, values in record.columns.items()})


@pytest.mark.parametrize('step', [6.0, 8.0])
def test_rounding_is_told_with_its_step_and_share(step):
    t = np.arange(0.0, 10.0, 0.02)
    swing = np.stack([700.0 + SWING * np.sin(6.0 * np.pi * t + k) for k in range(4)])
    names = [f'cmd{j}' for j in range(1, 5)]
    rounded = FlightRecord(t, dict(zip(names, step * np.round(swing / step), strict=True)))
    # Of the swing's variance and its own, both in closed form.
    share = step ** 2 / 12.0 / (SWING ** 2 / 2.0 + step ** 2 / 12.0)
    finding = told(rounded)
    assert finding.severity == 'warning' and finding.where == 'cmd1 to cmd4'
    assert f'steps of {step:g}' in finding.message
    percent = float(finding.message.split(' % of the variance')[0].split()[-1])
    assert percent == pytest.approx(100.0 * share, abs=0.2 * 100.0 * share + 0.5)


def test_what_is_not_rounded_or_finely_is_not_told(flown):
    assert told(flown) is None
    assert told(with_commands(flown, lambda values: np.round(values, 1))) is None
    # Held over ten samples: few levels, of which none is a multiple of a step.
    assert told(with_commands(flown, lambda values: np.repeat(values[::10], 10)[:len(values)])
                ) is None


def test_a_flight_with_coarse_commands_is_told_in_speeds_of_any_curve(flown):
    coarse = with_commands(flown, lambda values: 8.0 * np.round(values / 8.0))
    assert told(coarse) is not None
    curved = with_commands(coarse, lambda values: values ** 1.3)
    assert told(curved) is not None
