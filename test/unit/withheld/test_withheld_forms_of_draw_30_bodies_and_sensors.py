# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of ordinary loads, rotors and sensors, and three ordinary strangers."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import (
    fresh,
    HOVER,
    LEVEL,
    PARAMS,
    part_of,
    PLACES,
    REST,
    SPINS,
    STATE,
    still,
    WEIGHT,
)

from withheld import outside
from withheld.constants import arm_length
from withheld.forms.bits import CutOff
from withheld.forms.brackets import Nodding
from withheld.forms.cantilevers import BentUp
from withheld.forms.doses import Dosed
from withheld.forms.drizzles import Drizzled
from withheld.forms.extrinsics import Aligning
from withheld.forms.followers import FollowsAll
from withheld.forms.injections import Injected
from withheld.forms.oscillators import SlowClock
from withheld.forms.sweeps import SweptBack


def weighs(part, now):
    """Return the mass, kg, that a part seems to have, by what it takes of the thrust in hover."""
    true = fresh()
    part.alter(true, PARAMS)
    force, moment = part.wrench(now)
    assert not np.any(moment)
    assert (now.rotation @ force)[:2] == pytest.approx([0.0, 0.0], abs=1e-12)
    return true['mass'] - PARAMS['mass'] - (now.rotation @ force)[2] / 9.81


def test_a_sprayer_gets_lighter_by_the_way_flown_and_not_by_time():
    def left(speed, seconds, step=0.01):
        part, now = part_of(Dosed), still(velocity=np.array([0.6 * speed, -0.8 * speed, 0.4]))
        for _ in range(round(seconds / step)):
            part.wrench(now)
            part.after(step, LEVEL, REST)
        return weighs(part, now) / part.parameters['mass']
    assert left(0.0, 20.0) == pytest.approx(Dosed.FULL)
    for speed in (1.0, 2.0, 4.0):
        assert left(speed, 10.0 / speed) == pytest.approx(Dosed.FULL - 10.0 * Dosed.TAKES)
    assert left(4.0, 30.0) == pytest.approx(Dosed.REST)
    # What is there has inertia as well as weight.
    part, pull = part_of(Dosed), np.array([1.0, -2.0, 3.0])
    leans = Rotation.from_rotvec([0.4, 0.2, 0.0])
    part.after(0.01, LEVEL, pull)
    force, _ = part.wrench(still(rotation=leans.as_matrix()))
    more = (Dosed.FULL - 1.0) * part.parameters['mass']
    assert leans.apply(force) == pytest.approx(-more * (pull + [0.0, 0.0, 9.81]))


def test_drizzle_runs_off_and_more_of_it_lies_there_after_fast_flight():
    def wet(speed, rains, seconds, step=0.01):
        part = part_of(Drizzled)
        part.rains = np.full(part.COUNT + 1, rains)
        for k in range(round(seconds / step)):
            now = still(time=step * k, air=np.array([0.0, speed, 0.0]))
            part.wrench(now)
            part.after(step, LEVEL, REST)
        return weighs(part, now) / part.parameters['mass']
    assert wet(2.0, 1.0, 3.0) == pytest.approx(1.0)
    assert wet(2.0, 0.0, Drizzled.RUNS) == pytest.approx(np.exp(-1.0))
    slow, fast = wet(0.0, 1.0, 60.0), wet(4.0, 1.0, 60.0)
    assert fast / slow == pytest.approx(1.0 + 4.0 * Drizzled.FRONT, rel=1e-4)
    # A climb through drops that fall anyway is left out; what is met is what is across them.
    part, leans = part_of(Drizzled), Rotation.from_rotvec([0.5, 0.0, 0.0])
    comes = []
    for air in (REST, leans.inv().apply([0.0, 0.0, 3.0]), leans.inv().apply([3.0, 0.0, 0.0])):
        part.wrench(still(time=0.0, air=air, rotation=leans.as_matrix()))
        comes.append(part._comes)
    assert comes[1] == pytest.approx(comes[0])
    assert comes[2] == pytest.approx((1.0 + 3.0 * part.FRONT) * comes[0])


def test_squalls_have_the_mean_as_their_average():
    rains = []
    for seed in range(60):
        part = part_of(Drizzled)
        part.begin(np.random.default_rng(seed))
        assert part.times[-1] > 60.0
        rains.append(part.rains)
    assert np.mean(rains) == pytest.approx(1.0, abs=0.05) and np.min(rains) > 0.0


def given_by(part, rate, seconds, step=0.001):
    """Return the momenta, (N, 3) N m s, that a body has handed to a load as it turns at a rate."""
    given = []
    for _ in range(round(seconds / step)):
        force, moment = part.wrench(still(rate=rate))
        assert not np.any(force)
        given.append(-step * moment)
        part.after(step, LEVEL, REST)
    return np.cumsum(given, axis=0)


def test_a_camera_that_follows_takes_up_its_momentum_and_hardly_swings():
    part, rate = part_of(FollowsAll), np.array([0.3, -0.2, 0.1])
    # At once nothing holds it; after a while it turns as fast, and lags behind as its damper says.
    shares = given_by(part, rate, 4.0) / (part.loads * rate)
    assert shares[:, 1:] == pytest.approx(shares[:, [0, 0]])
    share = shares[:, 0]
    assert share[4] < 0.01 and share[-1] == pytest.approx(1.0)
    # By the theory of an oscillator of the second order: how far it overshoots.
    over = np.exp(-np.pi * part.DAMPING / np.sqrt(1.0 - part.DAMPING ** 2))
    assert share.max() - 1.0 == pytest.approx(over, rel=0.05)
    assert part._turning == pytest.approx(rate)
    assert part._behind == pytest.approx(2.0 * part.DAMPING / part.FREQUENCY * rate)
    assert part.wrench(still(rate=rate))[1] == pytest.approx(REST, abs=1e-9)


def test_a_camera_on_a_bracket_nods_when_it_is_lifted_and_weighs_what_it_weighs_at_rest():
    def pulled(part, seconds, turn=1.0, step=0.002):
        pulls = []
        for _ in range(round(seconds / step)):
            force, moment = part.wrench(still(speeds=np.full(4, turn * HOVER)))
            assert not np.any(force[:2])
            assert np.array_equal(moment, np.cross(part.place, force))
            pulls.append(force[2])
            part.after(step, LEVEL, REST)
        return np.array(pulls)
    part, true = part_of(Nodding), fresh()
    part.alter(true, PARAMS)
    assert np.linalg.norm(part.place) == pytest.approx(arm_length(PARAMS))
    # Its own weight is what moves the centre of all.
    assert part.load * part.place == pytest.approx(PARAMS['mass'] * true['centre'])
    assert np.abs(pulled(part, 1.0)).max() == pytest.approx(0.0, abs=1e-9)
    lifted = 0.21 * 9.81
    pulls = pulled(part, 8.0, 1.1)
    # At first it stays where it is, as if it were not there; at last it is taken along.
    assert pulls[0] == pytest.approx(part.load * lifted)
    assert pulls[-1] == pytest.approx(0.0, abs=1e-3 * part.load * lifted)
    crossings = np.flatnonzero(np.diff(np.sign(pulls[:1000])))
    assert 0.002 * np.mean(np.diff(crossings)) == pytest.approx(
        np.pi / (part.FREQUENCY * np.sqrt(1.0 - part.DAMPING ** 2)), rel=0.01)
    assert part._up == pytest.approx(-lifted / part.FREQUENCY ** 2, rel=1e-2)


def test_a_turn_that_lifts_the_edge_has_a_camera_nod():
    part, step = part_of(Nodding), 0.01
    turning = np.array([2.0, -3.0, 5.0])
    for k in range(2):
        part.wrench(still(rate=0.01 * k * turning))
        part.after(step, LEVEL, REST)
    part._up, part._rises = 0.0, 0.0
    force, _ = part.wrench(still())
    assert force[2] == pytest.approx(part.load * np.cross(turning, part.place)[2])
    assert abs(force[2]) > 0.01 * part.load


def test_a_fault_is_injected_once_in_each_flight_and_stays():
    part, means = part_of(Injected), []
    times = np.arange(0.0, 20.0, 0.1)
    for seed in range(30):
        part.begin(np.random.default_rng(seed))
        lost = []
        for t in times:
            now = still(time=t, speeds=HOVER * np.array([1.1, 0.9, 1.0, 1.05]))
            gain = part.gain(now)
            assert np.all(np.delete(gain, part.rotor) == 1.0)
            assert np.array_equal(part.torque(now), gain)
            lost.append(1.0 - gain[part.rotor])
        lost = np.array(lost) / part.loss
        assert not np.any(lost[times < part.when])
        assert lost[times >= part.when] == pytest.approx(part.THEN)
        assert part.WHEN[0] <= part.when <= part.WHEN[1]
        means.append(lost.mean())
    assert np.ptp(means) > 0.1 and np.mean(means) == pytest.approx(1.0, abs=0.05)


def test_a_slow_clock_costs_slow_rotors_more_and_goes_wrong_as_it_warms():
    part = part_of(SlowClock)

    def slower(turn, time):
        now = still(time=time, speeds=np.full(4, turn * HOVER))
        gain = part.gain(now)
        assert np.delete(gain, part.rotor) == pytest.approx(np.ones(3))
        assert np.array_equal(part.torque(now), gain)
        return 1.0 - np.sqrt(gain[part.rotor])
    assert slower(1.0, 0.0) == pytest.approx(0.5 * part.FIRST * part.loss)
    assert slower(1.0, 900.0) == pytest.approx(0.5 * part.WARM * part.loss)
    half = part.FIRST + (part.WARM - part.FIRST) * (1.0 - np.exp(-1.0))
    assert slower(1.0, part.TIME) == pytest.approx(0.5 * half * part.loss)
    # A pulse is read too short by a share of itself: what that takes of the speed goes with the
    # pulse, which is a fixed part and one that goes with the speed.
    speeds = [turn * slower(turn, 900.0) for turn in (0.6, 1.0, 1.4)]
    assert speeds[2] - speeds[1] == pytest.approx(speeds[1] - speeds[0])
    assert speeds[0] / speeds[1] == pytest.approx((part.FIXED + 0.6) / (part.FIXED + 1.0))


def test_the_momentum_on_arms_that_bend_leans_with_the_load():
    part = part_of(BentUp)

    def momentum(turns):
        lean = part.LEANS * turns ** 2
        out = PLACES / np.linalg.norm(PLACES, axis=1)[:, None]
        axes = np.cos(lean)[:, None] * [0.0, 0.0, 1.0] - np.sin(lean)[:, None] * out
        return part.inertia * HOVER * (SPINS * turns) @ axes

    def passed_on(turns):
        given, made = REST, part_of(BentUp)
        made.wrench(still())
        for _ in range(1000):
            force, moment = made.wrench(still(speeds=turns * HOVER))
            assert not np.any(force)
            given = given + 0.0001 * moment
            made.after(0.0001, LEVEL, REST)
        return given
    for turns in (np.full(4, 1.1), np.array([1.1, 0.9, 0.9, 1.1]), np.array([1.2, 1.0, 1.0, 1.0])):
        change = momentum(turns) - momentum(np.ones(4))
        assert passed_on(turns) == pytest.approx(change, abs=2e-3 * part.inertia * HOVER)
    assert np.linalg.norm(change[:2]) > 0.02 * part.inertia * HOVER
    # A turn at speeds that stay takes the moment of their momentum alone.
    rate, steady = np.array([0.5, -0.3, 0.8]), part_of(BentUp)
    turns = np.array([1.2, 1.0, 1.1, 0.9])
    _, moment = steady.wrench(still(rate=rate, speeds=turns * HOVER))
    assert moment == pytest.approx(np.cross(rate, momentum(turns)))


def test_swept_blades_give_way_the_more_the_faster_they_turn():
    part, air = part_of(SweptBack), np.array([1.5, -0.5, 0.7])

    def moment(turn, share=1.0):
        force, moment = part.wrench(still(air=share * air, speeds=np.full(4, turn * HOVER)))
        assert not np.any(force) and moment[2] == 0.0
        assert moment @ air == pytest.approx(0.0, abs=1e-12)
        return moment[1] / air[0]
    assert moment(1.0) == pytest.approx(part.parameters['coefficient'])
    assert moment(1.0, 3.0) == pytest.approx(3.0 * moment(1.0))
    # By the slope of the lift over that of stiff blades: one over one and the air's stiffness.
    for turn in (0.5, 0.8, 1.2, 2.0):
        stiff = turn * moment(1.0)
        assert moment(turn) / stiff == pytest.approx(
            (1.0 + part.SOFT) / (1.0 + part.SOFT * turn ** 2))
    assert abs(moment(1.2) / moment(0.8) - 1.0) < 0.3 < 1.2 / 0.8 - 1.0


def test_what_is_unknown_of_a_tilt_shrinks_by_turns_alone():
    def share(turns, seconds=10.0):
        part, state = part_of(Aligning), STATE.copy()
        state[10:] = turns
        for time in (0.0, 0.5 * seconds, seconds):
            out = part.measured(time, state, 1.0)
        assert np.array_equal(np.delete(out, range(6, 10)), np.delete(state, range(6, 10)))
        tilt = Rotation.from_quat(STATE[6:10]).inv() * Rotation.from_quat(out[6:10])
        shares = tilt.as_euler('ZYX')[::-1] / part.angles
        assert shares == pytest.approx(np.full(3, shares[0]))
        return shares[0]
    at_first = Aligning.REMAINS + Aligning.UNKNOWN
    assert share(REST) == pytest.approx(at_first)
    rate = np.array([0.3, 0.0, -0.2])
    half = Aligning.TELLS / (rate @ rate)
    assert share(rate, half) == pytest.approx(Aligning.REMAINS + 0.5 * Aligning.UNKNOWN)
    assert share(2.0 * rate, 0.25 * half) == pytest.approx(share(rate, half))
    assert share(rate, 1e5) == pytest.approx(Aligning.REMAINS, abs=1e-3)


def test_rates_in_bytes_are_cut_off_to_the_step_below():
    part, rng = part_of(CutOff), np.random.default_rng(1)
    for rate in rng.uniform(-3.0, 3.0, (200, 3)):
        state = np.array([*STATE[:10], *rate])
        out = part.measured(1.0, state, 1.0)
        assert np.array_equal(out[:10], state[:10])
        counts = out[10:] / part.step
        assert counts == pytest.approx(np.round(counts), abs=1e-9)
        off = rate - out[10:]
        assert np.all(off >= 0.0) and np.all(off < part.step)
    rates = rng.uniform(-3.0, 3.0, (4000, 3))
    off = [part.measured(1.0, np.array([*STATE[:10], *rate]), 1.0)[10:] - rate for rate in rates]
    bias = np.array([part.parameters[axis] for axis in 'xyz'])
    assert np.mean(off, axis=0) == pytest.approx(bias, rel=0.05)
    assert np.linalg.norm(bias) == pytest.approx(0.06)
    assert np.std(off, axis=0) == pytest.approx(part.step / np.sqrt(12.0) * np.ones(3), rel=0.05)


def test_a_reel_pays_out_slowly_and_locks_where_it_is_pulled_fast():
    part = outside.Retractor(2.0, WEIGHT, np.random.default_rng(1))
    part.begin(np.random.default_rng(2))
    light = part.stiffness * part.LIGHT

    def pull(below, falls):
        force = part.force(0.0, part.reel - [0.0, 0.0, below], np.array([0.0, 0.0, -falls]))
        assert not np.any(force[:2])
        part.after(0.01, LEVEL, REST)
        return force[2]
    assert pull(1.0, 0.9 * part.LOCKS) == pytest.approx(light)
    assert pull(2.0, 0.9 * part.LOCKS) == pytest.approx(light)
    assert pull(2.0, 1.1 * part.LOCKS) == pytest.approx(light)
    # Locked there, it pulls by how far it is drawn out beyond, until it is slack.
    assert pull(2.3, 0.0) == pytest.approx(light + 0.3 * part.stiffness)
    assert pull(2.1, -2.0) == pytest.approx(light + 0.1 * part.stiffness)
    assert pull(1.9, -2.0) == pytest.approx(light)
    assert pull(2.3, 0.0) == pytest.approx(light)


def test_a_reflection_draws_places_and_velocities_aside_together_and_lets_them_go():
    part = outside.Glitch(2.0, np.random.default_rng(1))
    part.begin(np.random.default_rng(2))
    step, times = 0.001, np.arange(0.0, 20.0, 0.001)
    out = np.array([part.measured(t, STATE, 1.0) for t in times])
    assert np.array_equal(out[:, 6:], np.broadcast_to(STATE[6:], (len(times), 7)))
    aside, drifts = out[:, :3] - STATE[:3], out[:, 3:6] - STATE[3:6]
    # The velocity is that of the place, but for the moments in which a reflection comes or goes.
    slopes = np.gradient(aside, step, axis=0)
    missed = np.abs(slopes - drifts).max(axis=1)
    assert np.mean(missed > 1e-3 * part.far / part.TIME) < 5e-3
    sizes = np.linalg.norm(aside, axis=1)
    assert not np.any(aside[times < part.times[0]])
    assert 0.8 * part.far < sizes.max() < 1.6 * part.far
    far_later = part.measured(1e4, STATE, 1.0)
    assert far_later == pytest.approx(STATE) and part.wrench(SimpleNamespace()) is None


def test_a_push_is_level_comes_and_goes_and_leaves_long_pauses():
    part = outside.Pushed(2.0, WEIGHT, np.random.default_rng(1))
    part.begin(np.random.default_rng(2))
    t = np.arange(0.0, 20.0, 0.005)
    forces = np.array([part.force(time, REST, REST) for time in t])
    size = np.linalg.norm(forces, axis=1)
    assert not forces[:, 2].any() and 0.5 * part.most < size.max() <= part.most
    pushed = size > 1e-6 * part.most
    ends = np.flatnonzero(np.diff(pushed))
    lasts, pauses = (np.diff(t[ends])[k::2] for k in range(2))
    assert not pushed[0] and len(lasts) > 5
    assert lasts.max() < 0.46 and pauses.min() > 0.79
    # One direction in each push.
    begin = part.begins[0] + np.array([0.2, 0.5, 0.8]) * part.lasts[0]
    one = np.array([part.force(time, REST, REST) for time in begin])
    assert np.linalg.matrix_rank(one, tol=1e-9 * part.most) == 1
