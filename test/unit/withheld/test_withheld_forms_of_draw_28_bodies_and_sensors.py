# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of ordinary loads, rotors and sensors, and two ordinary strangers."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import (
    HOVER,
    LEVEL,
    PARAMS,
    part_of,
    REST,
    SPINS,
    STATE,
    still,
    turning,
    WEIGHT,
)

from withheld import outside
from withheld.constants import arm_length, induced_velocity
from withheld.forms.asymmetries import TwoScales
from withheld.forms.balls import Stiffening
from withheld.forms.brands import Brands
from withheld.forms.cants import Canted
from withheld.forms.definitions import DefinedApart
from withheld.forms.diagonals import TwoTypes
from withheld.forms.horizons import Shaken
from withheld.forms.leads import OnLead
from withheld.forms.pairs import Unmatched
from withheld.forms.solders import ColdSoldered
from withheld.forms.spares import Spare
from withheld.forms.stabilisers import Stabilised
from withheld.forms.wake_boxes import InWake


def test_a_box_in_the_wake_is_pressed_down_until_flight_sweeps_the_wake_off():
    part, induced = part_of(InWake), induced_velocity(PARAMS)
    mass = part.parameters['mass']

    def seems(air=REST, turn=1.0):
        force, moment = part.wrench(still(air=np.asarray(air), speeds=np.full(4, turn * HOVER)))
        assert not np.any(force[:2]) and not np.any(moment)
        return (part.mass(0.0) - force[2] / 9.81) / mass
    assert seems() == pytest.approx(1.0)
    assert seems(turn=1.2) == pytest.approx(part.OWN + 1.44 * (1.0 - part.OWN))
    shares = [seems([far * induced, 0.0, 0.0]) for far in (0.2, 0.5, 1.0, 3.0)]
    assert np.all(np.diff(shares) < 0.0) and shares[-1] == pytest.approx(part.OWN, abs=1e-3)
    assert seems([0.0, 0.0, 0.2 * induced]) > 1.0 > seems([0.0, 0.0, -0.2 * induced])
    # By momentum theory, w^2 (w^2 + v^2) = 1: the induced velocity w in level flight at v, each
    # over the induced velocity in hover.
    far, press = 0.5, (shares[1] - part.OWN) / (1.0 - part.OWN)
    wake = np.sqrt(np.sqrt(1.0 + 0.25 * far ** 4) - 0.5 * far ** 2)
    assert wake ** 2 * (wake ** 2 + far ** 2) == pytest.approx(1.0)
    assert press == pytest.approx(wake ** 2 * np.exp(-(0.9 * far / wake / 0.8) ** 2))


def test_each_flight_has_a_pack_that_stays():
    part, packs = part_of(Brands), []
    for seed in range(200):
        part.begin(np.random.default_rng(seed))
        packs.append(part.mass(0.0))
        assert part.mass(19.0) == packs[-1]
    shares = np.array(packs) / part.parameters['mass']
    assert sorted(set(shares.round(9))) == pytest.approx(sorted(part.WEIGH))
    assert shares.mean() == pytest.approx(1.0, abs=0.06)


def test_a_camera_follows_the_heading_beyond_its_dead_band():
    part, step = part_of(Stabilised), 0.001

    def turn(rate, seconds):
        given = REST
        for _ in range(round(seconds / step)):
            force, moment = part.wrench(still(rate=np.asarray(rate)))
            assert not np.any(force)
            given = given - step * moment
            part.after(step, LEVEL, REST)
        return given
    # A small turn leaves the camera where it looks: only the arms have come along.
    given = turn([0.5, 0.0, 0.4], 0.14)
    assert given[0] == pytest.approx(0.5 * part.loads[0], rel=0.03)
    assert given[2] == pytest.approx(0.4 * part.ARMS * part.loads[2], rel=0.03)
    assert part._looks == 0.0
    # In a long one it turns as fast, behind by the band and by what it follows with.
    given = given + turn([0.5, 0.0, 0.4], 4.0)
    assert part._looks == pytest.approx(0.4)
    assert part._behind == pytest.approx(part.DEAD + 0.4 / part.FOLLOWS)
    assert given[2] == pytest.approx(0.4 * part.loads[2], rel=0.03)
    turn(REST, 8.0)
    assert part._looks == pytest.approx(0.0, abs=1e-6)
    assert part._behind == pytest.approx(part.DEAD, abs=1e-6)


def test_balls_of_rubber_are_stiffer_for_large_turns():
    part = part_of(Stiffening)

    def pull(angle):
        part._angle = np.array([angle, 0.0, 0.0])
        return part._pull()[0] / (part.FREQUENCY ** 2 * angle)
    assert pull(1e-6) == pytest.approx(1.0)
    assert pull(part.TWICE) == pytest.approx(2.0) and pull(-2.0 * part.TWICE) == pytest.approx(5.0)
    part, rate, given, step = part_of(Stiffening), np.array([0.3, -0.2, 0.1]), REST, 0.0005
    for _ in range(8000):
        force, moment = part.wrench(still(rate=rate))
        given = given - step * moment
        part.after(step, LEVEL, REST)
    assert not np.any(force) and given == pytest.approx(part.loads * rate, rel=0.02)


def test_a_lead_weighs_by_the_height_at_the_end_of_an_arm():
    part = part_of(OnLead)
    x, y = (part.parameters[axis] for axis in 'xy')
    assert np.linalg.norm(part.place) == pytest.approx(arm_length(PARAMS))
    for height in (0.0, 0.5, 1.0, 2.0):
        force, moment = part.wrench(still(position=np.array([0.3, 0.1, height])))
        assert moment == pytest.approx(WEIGHT * height * np.array([-y, x, 0.0]))
        # It weighs little: as much of the weight as the offset is of the arm.
        far = np.hypot(x, y) / arm_length(PARAMS)
        assert force == pytest.approx([0.0, 0.0, -far * WEIGHT * height])
    assert not np.any(part.wrench(still(position=np.array([0.0, 0.0, -0.1])))[0])
    leans = Rotation.from_rotvec([0.4, 0.0, 0.0])
    force, _ = part.wrench(still(rotation=leans.as_matrix()))
    assert leans.apply(force)[:2] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_a_propeller_of_less_pitch_lacks_more_in_a_climb():
    part, induced = part_of(Spare), induced_velocity(PARAMS)

    def lost(climb, turn=1.0):
        now = still(air=np.array([0.5, 0.0, climb * induced]), speeds=np.full(4, turn * HOVER))
        gain, torque = part.gain(now), part.torque(now)
        assert np.delete(gain, part.rotor) == pytest.approx(np.ones(3))
        assert 1.0 - torque == pytest.approx(part.TORQUE * (1.0 - gain))
        return (1.0 - gain[part.rotor]) / part.loss
    assert lost(0.0) == pytest.approx(1.0) and lost(0.0, 1.3) == pytest.approx(1.0)
    assert lost(0.3) == pytest.approx(1.9) and lost(0.3, 1.2) == pytest.approx(1.75)
    assert lost(-0.2) == pytest.approx(0.4) and lost(-1.0) == 0.0
    assert lost(5.0) == pytest.approx(part.MOST)


def test_a_bad_joint_takes_voltage_by_the_current_and_heats():
    part = part_of(ColdSoldered)

    def lost(turn):
        now = still(speeds=np.full(4, turn * HOVER))
        gain = part.gain(now)
        assert np.delete(gain, part.rotor) == pytest.approx(np.ones(3))
        assert np.array_equal(part.torque(now), gain)
        return (1.0 - gain[part.rotor]) / part.loss
    assert lost(1.2) == pytest.approx(1.2 * part.COLD)
    turning(part, 1.0, part.TIME)
    assert part._heat == pytest.approx(1.0 - np.exp(-1.0))
    turning(part, 1.0, 80.0)
    assert lost(1.0) == pytest.approx(1.0) and lost(0.8) == pytest.approx(0.8)
    turning(part, 1.2, 80.0)
    assert lost(1.2) == pytest.approx(1.2 * (part.COLD + (1.0 - part.COLD) * 1.2 ** 4))


def passed_on(part, turns):
    """Return the momentum, (3,) N m s, that rotors which speed up from hover give the body."""
    given, step = REST, 0.0025
    part.wrench(still())
    for _ in range(400):
        force, moment = part.wrench(still(speeds=turns * HOVER))
        assert not np.any(force)
        given = given + step * moment
        part.after(step, LEVEL, REST)
    return given


def test_the_momentum_of_canted_motors_leans_across_the_arms():
    part = part_of(Canted)
    places = np.array(list(PARAMS['rotor_pos'].values()))
    assert np.linalg.norm(part.axes, axis=1) == pytest.approx(np.ones(4))
    assert np.sum(part.axes * places, axis=1) == pytest.approx(np.zeros(4))
    # Thrust and reaction turn the body the same way about the vertical.
    assert np.all(SPINS * np.cross(places, part.axes)[:, 2] > 0.0)
    for turns in (np.full(4, 1.1), np.array([1.1, 1.0, 0.9, 1.0])):
        change = part.inertia * HOVER * (SPINS * (turns - 1.0)) @ part.axes
        assert passed_on(part_of(Canted), turns) == pytest.approx(change, abs=1e-9)
    assert np.linalg.norm(change[:2]) > 1e-3 * abs(part.inertia * HOVER)


def test_a_roll_turns_a_body_whose_propellers_differ_between_front_and_back():
    heavier = part_of(Unmatched).spins / SPINS
    assert sorted(heavier.round(9)) == [0.6, 0.6, 1.4, 1.4] and heavier[0] == heavier[1]
    inertia = part_of(Unmatched).inertia
    for turns, alike in (([1.1, 0.9, 0.9, 1.1], False), ([1.1, 1.1, 0.9, 0.9], True),
                         ([1.1, 1.1, 1.1, 1.1], True)):
        turns = np.array(turns)
        given = passed_on(part_of(Unmatched), turns)
        assert given == pytest.approx(
            [0.0, 0.0, inertia * HOVER * (SPINS * heavier) @ (turns - 1.0)], abs=1e-12)
        assert alike == (abs(given[2]) < 1e-12)


def test_unlike_diagonals_roll_the_body_aside():
    part, induced = part_of(TwoTypes), induced_velocity(PARAMS)

    def moment(air, turn=1.0):
        force, moment = part.wrench(still(air=np.array(air), speeds=np.full(4, turn * HOVER)))
        assert not np.any(force) and moment[2] == 0.0
        return moment[:2] / part.moment
    aside = float(np.mean(part.broader * SPINS))
    assert abs(aside) == pytest.approx(part.BROADER)
    for flow in (0.3 * induced, induced):
        x, y = moment([flow, 0.0, 0.0])
        assert x == pytest.approx(part.SIDE * aside * flow)
        assert y == pytest.approx(2.0 * flow * flow / (flow + induced))
        assert moment([0.0, flow, 0.0]) == pytest.approx([-y, x])
    # A climb straightens the wake, and does not change what the blade ahead lifts.
    climbs, flow = moment([induced, 0.0, 0.5 * induced]), moment([induced, 0.0, 0.0])
    assert climbs[0] == pytest.approx(flow[0]) and climbs[1] == pytest.approx(0.8 * flow[1])


def test_attitude_and_rates_are_off_by_two_tilts():
    part = part_of(DefinedApart)
    out = part.measured(3.0, STATE, 1.0)
    tilt = Rotation.from_quat(STATE[6:10]).inv() * Rotation.from_quat(out[6:10])
    assert tilt.as_euler('ZYX') == pytest.approx(part.angles[::-1])
    assert np.array_equal(out[:6], STATE[:6])
    assert part.sits.apply(out[10:]) == pytest.approx(STATE[10:])
    apart = (tilt.inv() * part.sits).magnitude()
    assert apart > 0.3 * tilt.magnitude() and part.sits.magnitude() > 0.3 * tilt.magnitude()
    other = part.measured(9.0, STATE, 2.0)
    assert np.array_equal(other, out)


def test_vibration_tilts_the_horizon_by_and_by():
    part = part_of(Shaken)

    def share(time, thrust):
        out = part.measured(time, STATE, thrust)
        assert np.array_equal(np.delete(out, range(6, 10)), np.delete(STATE, range(6, 10)))
        tilt = Rotation.from_quat(STATE[6:10]).inv() * Rotation.from_quat(out[6:10])
        yaw, *lean = tilt.as_euler('ZYX')
        assert yaw == pytest.approx(0.0, abs=1e-12)
        shares = np.array(lean) / part.angles[1::-1]
        assert shares[0] == pytest.approx(shares[1])
        return shares[0]
    assert part.parameters['yaw'] == 0.0
    assert share(0.0, 1.3) == pytest.approx(1.0)
    once = part.OWN + (1.0 - part.OWN) * (1.0 + 0.69 * (1.0 - np.exp(-1.0)))
    assert share(part.TIME, 1.3) == pytest.approx(once) == share(part.TIME, 1.3)
    assert share(60.0, 1.3) == pytest.approx(part.OWN + (1.0 - part.OWN) * 1.69)
    assert share(120.0, 0.0) == pytest.approx(part.OWN)
    assert share(180.0, 9.0) == pytest.approx(part.OWN + (1.0 - part.OWN) * part.MOST)


def test_turns_of_either_way_add_to_a_bias_alike():
    part = part_of(TwoScales)

    def bias(rate):
        state = np.array([*STATE[:10], *rate])
        out = part.measured(1.0, state, 1.0)
        assert np.array_equal(out[:10], STATE[:10])
        return out[10:] - state[10:]
    assert bias(REST) == pytest.approx(part.OWN * part.bias)
    rate = np.array([0.5, -1.0, 0.2])
    assert bias(-rate) == pytest.approx(bias(rate))
    assert bias(rate) - bias(REST) == pytest.approx(part.by_axis * np.abs(rate))
    assert bias(np.full(3, 99.0)) == pytest.approx(bias(np.full(3, part.MOST)))


def test_guards_brake_a_turn_and_push_nowhere():
    part = outside.Hoops(2.0, WEIGHT, 0.1, HOVER, np.random.default_rng(1))
    assert part.moment == pytest.approx(0.006 * WEIGHT * 0.1)
    assert not np.any(part.wrench(still())[1])
    for turn in (1.0, 1.2):
        for axis, share in zip(np.eye(3), (1.0, 1.0, part.THIN), strict=True):
            force, slow = part.wrench(still(rate=0.01 * axis, speeds=np.full(4, turn * HOVER)))
            assert not np.any(force)
            assert slow == pytest.approx(-0.01 * turn * share * part.moment * axis, rel=1e-4)
    # A turn much faster than the wake is braked with the square of its rate.
    _, fast = part.wrench(still(rate=np.array([40.0, 0.0, 0.0])))
    assert fast[0] == pytest.approx(-part.moment * 1600.0 / part.WAKE, rel=1e-2)


def test_a_wrong_wand_scales_lengths_alone():
    part = outside.Wand(2.0, np.random.default_rng(1))
    assert abs(part.off) == pytest.approx(0.02)
    out = part.measured(1.0, STATE, 1.0)
    assert out[:6] == pytest.approx((1.0 + part.off) * STATE[:6])
    assert np.array_equal(out[6:], STATE[6:])
    assert part.wrench(SimpleNamespace()) is None
