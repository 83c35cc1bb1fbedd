# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Loads, rotors and sensors of other forms: what each does."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import fresh, HOVER, instant, made, PARAMS

from withheld.constants import GRAVITY
from withheld.forms import carried, damage, readings


def test_a_load_soaks_fast_at_first_and_has_its_mass_on_average():
    load = carried.Soaking(2.0, PARAMS, None)
    shares = np.array([load.mass(t) for t in np.arange(0.0, 20.0, 0.01)]) / load.parameters['mass']
    assert shares[0] == pytest.approx(0.3) and np.mean(shares) == pytest.approx(1.0, abs=0.02)
    assert shares[600] - shares[0] > 5.0 * (shares[1999] - shares[1399]) > 0.0


def lifted(height, climb=0.0, rises=0.0, rotation=None):
    """Return the force of a chain over the mass at 1 m, and what the hook has of that."""
    part, true = carried.Chain(2.0, PARAMS, None), fresh()
    part.alter(true, PARAMS)
    part.begin(None)
    part.after(0.01, np.eye(3), np.array([0.0, 0.0, rises]))
    now = replace(instant(velocity=(0.0, 0.0, climb)), position=np.array([0.3, 0.2, height]))
    if rotation is not None:
        now = replace(now, rotation=rotation)
    mass = part.parameters['mass']
    return part.wrench(now)[0] / mass, (true['mass'] - PARAMS['mass']) / mass


def test_a_chain_weighs_what_is_off_the_ground():
    for height, links in ((0.5, 0.2), (1.0, 0.4), (2.0, 0.8), (2.5, 1.0), (4.0, 1.0)):
        force, hook = lifted(height)
        assert force == pytest.approx([0.0, 0.0, -links * GRAVITY]) and hook == pytest.approx(0.6)


def test_a_chain_that_rises_has_to_be_set_in_motion():
    assert lifted(1.0, rises=2.0)[0][2] == pytest.approx(-0.4 * (GRAVITY + 2.0))
    assert lifted(1.0, climb=1.5)[0][2] == pytest.approx(-0.4 * (GRAVITY + 1.5 ** 2))
    assert lifted(1.0, climb=-1.5)[0][2] == pytest.approx(-0.4 * GRAVITY)
    assert lifted(3.0, climb=1.5)[0][2] == pytest.approx(-GRAVITY)      # none is picked up


def test_a_chain_pulls_towards_the_ground_however_the_body_leans():
    tilt = Rotation.from_rotvec([0.3, -0.2, 0.5])
    force, _ = lifted(1.0, rotation=tilt.as_matrix())
    assert tilt.apply(force) == pytest.approx([0.0, 0.0, -0.4 * GRAVITY])


def test_a_battery_with_play_is_free_until_it_hits_a_wall():
    part = made('inertia_mismatch', 'rattling', 3.0)
    part.alter(fresh(), PARAMS)
    moments = []
    for _ in range(80):
        moments.append(part.wrench(instant(rate=(0.5, 0.0, 0.0)))[1][0])
        part.after(0.002, np.eye(3), np.zeros(3))
    moments = np.array(moments)
    # 0.01 rad at 0.5 rad/s, then a wall that only pushes back.
    assert not np.any(moments[:10]) and moments[10:].min() < 0.0 and moments.max() <= 0.0
    # What it takes up sets the load in motion, and makes it bounce: of 0.5 rad/s it has gone
    # ahead by a share of that.
    taken = -0.002 * np.sum(moments) / part.loads[0]
    assert moments[-1] == 0.0 and 0.5 < taken < 1.0
    assert not np.any(part.wrench(instant(rate=(0.5, 0.0, 0.0)))[1][1:])


def test_a_load_with_play_takes_no_energy_from_nowhere():
    part = made('inertia_mismatch', 'rattling', 3.0)
    part.alter(fresh(), PARAMS)
    now = instant(rate=(0.0, 0.0, 0.0))
    part._turning = np.full(3, 1.0)
    for _ in range(1000):
        part.wrench(now)
        part.after(0.01, np.eye(3), np.zeros(3))
    assert np.all(np.abs(part._turning) < 0.2)      # each hit of a wall damps it


def test_a_camera_that_pans_swings_the_centre_about_its_mean():
    part = made('com_offset', 'panning', 3.0)
    moments = np.array([part.wrench(instant(time=t, turn=(1.0,) * 4))[1]
                        for t in np.arange(0.0, 6.0, 0.01)])
    lift = PARAMS['mass'] * GRAVITY
    off = np.column_stack([moments[:, 1], -moments[:, 0]]) / lift
    places = part.centre[:2] + off
    assert np.mean(off, axis=0) == pytest.approx(np.zeros(2), abs=1e-3 * np.linalg.norm(places[0]))
    reach = np.linalg.norm(places, axis=1)
    assert reach == pytest.approx(np.full(600, np.linalg.norm(part.centre[:2]) / part.MEAN))
    turns = np.arctan2(places[:, 1], places[:, 0]) - np.arctan2(part.centre[1], part.centre[0])
    assert np.abs((turns + np.pi) % (2.0 * np.pi) - np.pi).max() == pytest.approx(0.9, rel=1e-3)


def test_a_loose_contact_comes_and_goes():
    part = made('rotor_fault', 'intermittent', 2.0)
    times = np.arange(0.0, 200.0, 0.05)
    losses = np.array([1.0 - part.gain(instant(time=t)) for t in times])
    assert not np.any(np.delete(losses, part.rotor, axis=1))
    shares = losses[:, part.rotor] / 0.01
    assert np.unique(np.round(shares, 9)) == pytest.approx([0.1, 1.9])
    assert 60 < np.count_nonzero(np.diff(shares)) < 220
    assert np.mean(shares) == pytest.approx(1.0, abs=0.2)
    assert part.torque(instant()) == pytest.approx(part.gain(instant()))


def test_rough_blades_lose_more_in_a_descent():
    part = damage.Rough(4.0, PARAMS, np.random.default_rng(1))
    still = {'rate': (0.0, 0.0, 0.0), 'turn': (1.0,) * 4}
    losses = {z: 1.0 - part.gain(instant(velocity=(0.0, 0.0, z * part.induced), **still))
              for z in (-0.2, 0.0, 0.2, 0.4)}
    assert [losses[z][part.rotor] for z in losses] == pytest.approx([0.036, 0.02, 0.004, 0.0])
    assert part.torque(instant(velocity=(0.0, 0.0, 0.0), **still))[part.rotor] == pytest.approx(
        1.0 + 0.3 * 0.02)


def test_a_propeller_on_a_rubber_ring_rings_and_takes_up_its_momentum():
    part = made('rotor_gyro', 'rubber_ring', 5.0)
    passed = []
    for k in range(1000):
        turn = 1.1 if k else 1.0
        now = instant(rate=(0.0, 0.0, 0.0), turn=(turn, 1.0, turn, 1.0))
        passed.append(part.wrench(now)[1][2])
        part.after(0.001, np.eye(3), np.zeros(3))
    change = 2.0 * part.inertia * 0.1 * HOVER
    assert passed[0] == 0.0 and 0.001 * np.sum(passed[1:]) == pytest.approx(change, rel=0.02)
    # Over and back again: damped by 0.25, and by the zero of the damper.
    turned = np.cumsum(passed) * 0.001 / change
    assert 1.4 < turned.max() < 1.6 and turned[turned.argmax():].min() < 0.9


def test_an_attitude_tilts_by_place():
    part = made('attitude_misalignment', 'distorted', 3.0)

    def tilt(along, beside=0.0, height=1.0):
        side = np.array([-part.onto[1], part.onto[0], 0.0])
        place = along * part.onto + beside * side + [0.0, 0.0, height]
        state = np.array([*place, *np.zeros(6), 1.0, 0.1, 0.2, 0.3])
        seen = part.measured(0.0, state, 1.0)
        assert seen[[0, 1, 2, 10, 11, 12]] == pytest.approx([*place, 0.1, 0.2, 0.3])
        return np.linalg.norm(Rotation.from_quat(seen[6:10]).as_rotvec())

    mean = tilt(0.0)
    assert mean == pytest.approx(np.linalg.norm(part.angles), rel=0.01)
    assert [tilt(1.5) / mean, tilt(-1.5) / mean] == pytest.approx(
        [1.0 + 0.8 * np.tanh(1.0), 1.0 - 0.8 * np.tanh(1.0)], rel=0.01)
    assert tilt(0.0, 2.0, 0.3) == pytest.approx(mean)


def test_a_bias_walks_with_the_root_of_the_time():
    walks = []
    for seed in range(200):
        part = readings.Walking(1.0, PARAMS, np.random.default_rng(1))
        part.begin(np.random.default_rng(seed))
        walks.append([part.share(t, 1.0) - 1.0 for t in (0.0, 4.0, 16.0)])
    none, early, late = np.moveaxis(np.array(walks), 1, 0)
    assert not np.any(none)
    assert np.std(early) == pytest.approx(0.3, rel=0.1)
    assert np.std(late) == pytest.approx(0.6, rel=0.1)
    assert abs(np.corrcoef(late.T)[0, 1]) < 0.2
    assert np.all(np.isfinite(part.share(1e4, 1.0)))
