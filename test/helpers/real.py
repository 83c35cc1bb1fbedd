# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Real flights beside the checkout, in ../shared; where they are not their tests are skipped."""

from functools import cache
from pathlib import Path

import pytest

from quad_ident_ros.data.load import load
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.vehicle import load_vehicle, Vehicle

PLACE = Path('shared') / 'flights' / 'nanobench'
NANOBENCH = next((folder / PLACE for folder in Path(__file__).resolve().parents
                  if (folder / PLACE).is_dir()), None)
SHARED = next((folder / PLACE.parent for folder in Path(__file__).resolve().parents
               if (folder / PLACE.parent).is_dir()), None)
WHY = f'the real flights are not there: {PLACE}'
needs_real_flights = pytest.mark.skipif(NANOBENCH is None, reason=WHY)
CUTS = {'star_fast': 8.0, 'oval_fast': 10.0}    # s at which a cut begins, in full flight
LENGTH = 800                                    # samples of a cut, 8 s


def real_vehicle() -> Vehicle:
    """Return the nominal vehicle of the real flights."""
    return load_vehicle(NANOBENCH / 'vehicle.yaml')


@cache
def whole_real_flight(name: str) -> FlightRecord:
    """Return a real flight, from take-off to landing."""
    return load(NANOBENCH / f'{name}.csv.gz')


def real_flight(name: str) -> FlightRecord:
    """Return a cut of a real flight, one of CUTS."""
    whole = whole_real_flight(name)
    first = int((whole.t - whole.t[0] < CUTS[name] - 1e-6).sum())
    return whole.slice(first, first + LENGTH)
