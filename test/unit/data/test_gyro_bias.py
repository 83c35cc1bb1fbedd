# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The bias of the gyro, of records of accelerometer and gyro alone, where the vehicle stands."""

import re

import numpy as np
import pytest
from standing import brisk, standing_first, VEHICLE, WITHOUT, without

from quad_ident_ros.data.quality.gyro import bias
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.diagnose.rules import RULES

LONE = WITHOUT['accelerometer and gyro']
TRUTH = np.array([0.03, -0.02, 0.005])


def biased(record, values=TRUTH):
    columns = {name: record.columns[name] + value
               for name, value in zip(('wx', 'wy', 'wz'), values, strict=True)}
    return FlightRecord(record.t, {**record.columns, **columns}, dict(record.info))


def told(finding):
    """Return the bias and its standard errors that a finding says, (2, 3)."""
    return np.array(re.findall(r'(-?[\d.e-]+) ± ([\d.e-]+)', finding.message), float).T


def test_the_bias_is_what_the_gyro_reads_at_rest():
    [finding] = bias(biased(without(standing_first(brisk()), LONE)), VEHICLE)
    value, std = told(finding)
    assert (np.abs(value - TRUTH) < 4 * std).all() and (std < 1.5e-3).all()
    assert finding.severity == 'info' and 'for 3 s' in finding.message


@pytest.mark.slow
def test_a_diagnosis_has_it_though_it_leaves_the_ground_out():
    whole = biased(without(standing_first(brisk()), LONE))
    findings = take_in([whole], VEHICLE, None, RULES).findings
    assert [one['code'] for one in findings].count('gyro_bias') == 1


def test_nothing_is_said_of_what_flies_or_is_held_in_a_hand():
    assert bias(biased(without(brisk(), LONE)), VEHICLE) == []
    whole = without(standing_first(brisk()), LONE)
    held, t = whole.t < 3.0, whole.t
    moved = {name: whole.columns[name] + held * 0.3 * np.sin(rate * t) for name, rate in
             (('wx', 5.0), ('wy', 7.0), ('wz', 6.0))}
    assert bias(FlightRecord(t, {**whole.columns, **moved}), VEHICLE) == []


def test_a_measured_attitude_tells_it_in_flight():
    """The effect of that name, for all of the flight."""
    assert bias(biased(standing_first(brisk())), VEHICLE) == []


@pytest.mark.parametrize('name', ['wx', 'ax'])
def test_without_gyro_or_accelerometer_nothing_is_said(name):
    whole = without(standing_first(brisk()), (*LONE, name[0]))
    assert bias(whole, VEHICLE) == []
