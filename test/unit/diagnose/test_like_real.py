# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The vehicle file that a diagnosis writes: the simulator that flies it is like the reality."""

from dataclasses import replace
import json

import numpy as np
import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import read_csv, write_csv
from quad_ident_ros.diagnose import gap as gaps
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.effects.registry import vector
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.greybox.flights import track_of
from quad_ident_ros.greybox.parameters import nominal, SPLIT
from quad_ident_ros.model.vehicle import load_vehicle

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group('like_real')]     # they share a diagnosis
TRUTH = {'rotor_drag': {'coefficient': 0.25}, 'mass_offset': {'mass': 0.08}}
NOMINAL = load_experiment('closed_loop')
EFFECTS = 'rotor_drag,body_drag,mass_offset,wind'       # few: the search is no matter here


@pytest.fixture(scope='module')
def written(tmp_path_factory):
    """Return the real flights, the diagnosis as data and the path of the vehicle written."""
    folder = tmp_path_factory.mktemp('like_real')
    real = NOMINAL.with_effects(TRUTH)
    paths = []
    for run in real.runs:
        paths.append(str(folder / f'{run.name}.csv'))
        write_csv(paths[-1], fly(real, run, seed=3).record)
    out, data = folder / 'like_real.yaml', folder / 'out.json'
    assert main(['diagnose', *paths, '--vehicle', NOMINAL.vehicle.name, '--json', str(data),
                 '--out-vehicle', str(out), '--effects', EFFECTS]) == 0
    return [read_csv(path) for path in paths], json.loads(data.read_text()), out


def test_the_file_has_the_gap_that_was_reported(written):
    flights, data, out = written
    vehicle = load_vehicle(out)
    assert set(vehicle.effects) == set(data['verdict']) == set(TRUTH)
    z = nominal(NOMINAL.vehicle)
    z[SPLIT:SPLIT + len(vector({}, vehicle))] = vector(vehicle.effects, NOMINAL.vehicle)
    after = gaps.gap([gaps.ends(track_of(flights[-1], NOMINAL.vehicle), NOMINAL.vehicle, z,
                                RULES.horizon)])
    assert after['velocity'] == pytest.approx(data['gap']['after']['velocity'], rel=1e-3)
    assert data['gap']['closed'] > 0.95


def test_the_simulator_that_flies_it_is_like_the_reality(written):
    """The controller gives the commands that reality needs, which the nominal vehicle does not."""
    flights, _, out = written
    like_real = replace(NOMINAL, vehicle=load_vehicle(out))
    for run, real in zip(NOMINAL.runs, flights, strict=True):
        names = [f'cmd{j}' for j in range(1, 5)]
        apart = []
        for one in (NOMINAL, like_real):
            difference = fly(one, run, seed=3).record.stack(*names) - real.stack(*names)
            apart.append(np.sqrt(np.mean(difference ** 2)))
        assert apart[1] < 0.1 * apart[0]
