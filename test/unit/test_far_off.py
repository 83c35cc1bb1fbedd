# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Real flights whose nominal model is lost within half a second."""

import numpy as np
import pytest
from quality import NANOBENCH

from docs.real_flights import pushed, same
from quad_ident_ros.data.load import load
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.diagnose.select import COLOURED
from quad_ident_ros.greybox.noise import whole_noise
from quad_ident_ros.model.vehicle import load_nominal


@pytest.fixture(scope='module')
def found():
    vehicle = load_nominal(NANOBENCH / 'vehicle.yaml')
    flights = [load(path) for path in sorted(NANOBENCH.glob('*.csv.gz'))]
    return [diagnose([change(flight, vehicle) for flight in flights], vehicle)
            for change in (same, pushed)]


def test_the_errors_are_weighed_by_what_is_left_of_them(found):
    for one in found:
        selection = one.selection
        left = [whole_noise(raw, 1.0 - 1.0 / raw.shape[1]) for raw in selection.best.estimate.left]
        ratio = np.median(np.array(left) / selection.noise, axis=0)
        assert (ratio < COLOURED).all() and (ratio > 1.0 / COLOURED).all()


def test_a_constant_moment_more_changes_no_verdict(found):
    as_flown, moved = (one.data for one in found)
    assert as_flown['verdict'] == moved['verdict']
    # Several times smaller, and yet far above the noise.
    for data in (as_flown, moved):
        gap = {when: data['gap'][when]['attitude'] for when in ('before', 'after', 'noise')}
        assert 3.0 * gap['noise'] < gap['after'] < 0.3 * gap['before']
        assert data['verdict'][-1] == 'unknown'
