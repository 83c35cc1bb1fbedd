# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of bodies, rotors and sensors that the twenty-second draw is the first to fly."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import fresh, HOVER, LIFT, PARAMS, part_of, PLACES, REST, still, turning

from withheld import outside
from withheld.forms import aerials, closures, gels, interactions, liquids, tools


def test_a_gel_comes_along_with_all_that_the_body_gives_it():
    part, step, given = part_of(gels.Thixotropic), 1e-4, np.zeros(3)
    now = still(rate=np.array([0.8, 0.0, -0.4]))
    for _ in range(20000):
        given -= step * part.wrench(now)[1]
        part.after(step, np.eye(3), REST)
    assert given == pytest.approx(part.loads * now.rate, rel=5e-3)
    assert part.wrench(now)[1] == pytest.approx(REST, abs=1e-5)


def test_a_gel_thins_as_it_is_sheared_and_sets_again_at_rest():
    part, t = part_of(gels.Thixotropic), np.arange(0.0, 6.0, 0.005)
    assert part._grips() == pytest.approx(1.0 / part.FIRM)
    grips = []
    for one in t:
        shakes = np.sin(12.0 * one) if one < 3.0 else 0.0
        part.wrench(still(rate=np.array([shakes, 0.0, 0.0])))
        part.after(0.005, np.eye(3), REST)
        grips.append(part._grips())
    firm, loose = 1.0 / part.FIRM, 1.0 / part.LOOSE
    shaken, last = grips[599], grips[-1]
    assert loose < shaken < 0.4 * firm < 0.9 * firm < last < firm
    # At rest what is missing goes as an exponential does.
    first, later = (firm - grips[k] for k in (799, 999))
    assert later / first == pytest.approx(np.exp(-1.0 / part.SETS), rel=0.02)


def test_a_tool_stays_over_its_place_until_it_is_out_of_reach():
    part, speed, step = part_of(tools.Stippling), 0.2, 0.01
    turn, places, shifts = Rotation.from_euler('z', 0.7), [], []
    velocity = turn.apply([speed, 0.0, 0.0])
    now = still(velocity=velocity, rotation=turn.as_matrix())
    for k in range(2000):
        moment = part.wrench(now)[1]
        part.after(step, turn.as_matrix(), REST)
        size = LIFT * part.SWINGS * np.linalg.norm(part.centre[:2])
        shifts.append(np.array([moment[1], -moment[0]]) / size)
        places.append(speed * step * k + part.REACH * shifts[-1][0])
        assert moment[2] == 0.0
    shifts, moves = np.array(shifts), np.diff(places)
    assert shifts[:, 1] == pytest.approx(np.zeros(2000), abs=1e-12)
    assert -1.0 <= shifts[:, 0].min() < -0.9 and 0.6 < shifts[500:, 0].max() <= part.AHEAD
    # Most of the time it does not move over the ground.
    assert np.mean(np.abs(moves) < 0.01 * speed * step) > 0.7
    assert np.max(moves) > 5.0 * speed * step


def test_a_tool_is_held_below_in_hover():
    part, mean = part_of(tools.Stippling), fresh()
    part.alter(mean, PARAMS)
    assert mean['centre'] == pytest.approx(part.centre)
    assert part.wrench(turning(part, 1.0, 3.0))[1] == pytest.approx(REST)


def test_a_motor_whose_phases_are_switched_at_a_wrong_angle_is_right_at_one_speed():
    part, losses = part_of(aerials.Mistimed), []
    assert abs(part.right - 1.0) == pytest.approx(part.OFF)
    for off in (0.0, 0.1, -0.1, 0.2, 0.5, -0.5):
        now = still(speeds=np.full(4, (part.right + off) * HOVER))
        losses.append((1.0 - part.gain(now)[part.rotor]) / part.loss - part.LEAST)
        assert np.count_nonzero(part.gain(now) != 1.0) == 1
        assert part.torque(now) == pytest.approx(part.gain(now))
    most = part.MORE * part.MOST ** 2
    assert losses[0] == pytest.approx(0.0) and losses[4:] == pytest.approx([most, most])
    assert losses[1:4] == pytest.approx(part.MORE * np.array([0.01, 0.01, 0.04]))


def test_a_rotor_loses_most_where_the_wake_of_an_aerial_falls_onto_it():
    part, (x, y) = part_of(aerials.Masked), part_of(aerials.Masked).towards

    def lost(*air):
        gain = part.gain(still(air=np.array(air)))
        assert np.count_nonzero(gain != 1.0) == 1
        return (1.0 - gain[part.rotor]) / part.loss - part.ALWAYS

    assert lost(0.0, 0.0, 0.0) == pytest.approx(0.0) == lost(0.0, 0.0, 3.0)
    slow, fast = (lost(speed * x, speed * y, 0.0) for speed in (part.SLOW, 1e3))
    assert slow == pytest.approx(0.5 * part.MORE) and fast == pytest.approx(part.MORE, rel=1e-3)
    c, s = np.cos(part.WIDE), np.sin(part.WIDE)
    sides = [part.SLOW * np.array([c * x - side * s * y, c * y + side * s * x])
             for side in (1.0, -1.0)]
    assert [lost(*one, 0.0) for one in sides] == pytest.approx([slow / np.e] * 2)
    assert lost(-2.0 * x, -2.0 * y, 0.0) == pytest.approx(0.0, abs=1e-6)
    assert np.all(part.torque(still(air=np.array([x, y, 0.0]))) == 1.0)


def test_a_liquid_turns_along_later_and_takes_up_its_momentum():
    part, true = part_of(liquids.Filled), fresh()
    part.alter(true, PARAMS)
    assert true['rotor_inertia'] == pytest.approx(part.OWN * part.inertia)
    ring = (1.0 - part.OWN) * part.inertia
    turning(part, 1.0, 0.1)
    speeds = np.array([1.1, 1.0, 1.0, 1.0]) * HOVER
    now, took = still(speeds=speeds), 0.0
    assert part.wrench(now)[1] == pytest.approx(
        [0.0, 0.0, ring * part.spins[0] * 0.1 * HOVER / part.TIME])
    for _ in range(1600):
        took += 0.0025 * part.wrench(now)[1][2]
        part.after(0.0025, np.eye(3), REST)
    assert took == pytest.approx(ring * part.spins[0] * 0.1 * HOVER, rel=1e-3)
    turns = part.wrench(still(speeds=speeds, rate=np.array([0.0, 2.0, 0.0])))[1]
    assert turns[0] == pytest.approx(ring * 2.0 * (part.spins @ speeds), rel=1e-3)


def test_a_liquid_comes_along_sooner_in_a_fast_ring():
    part, lefts = part_of(liquids.Filled), []
    for turn in (0.64, 1.44):
        part.begin(None)
        turning(part, turn, 0.1)
        speeds = np.full(4, (turn + 1e-4) * HOVER)
        turning(part, turn, part.TIME / np.sqrt(turn), step=0.001, speeds=speeds)
        lefts.append((speeds - part._blades)[0] / (1e-4 * HOVER))
    assert lefts == pytest.approx([np.exp(-1.0)] * 2, rel=0.02)


def test_wheels_in_a_wake_resist_a_turn_and_nothing_else():
    part, true = part_of(liquids.Wheeled), fresh()
    part.alter(true, PARAMS)
    assert true['rotor_inertia'] == pytest.approx(part.OWN * part.inertia)
    wheels, turn = (1.0 - part.OWN) * part.inertia, np.array([1.1, 0.9, 1.1, 0.9])
    turning(part, 1.0, 0.1)
    rate, resists = np.array([0.5, -0.4, 0.3]), []
    for seconds in (0.0, 20.0 * part.TIME):
        turning(part, 1.0, seconds, speeds=turn * HOVER)
        moment = part.wrench(still(speeds=turn * HOVER, rate=rate))[1]
        # Not a moment about the axes, and no work.
        assert moment[2] == 0.0 and moment @ rate == pytest.approx(0.0, abs=1e-12)
        resists.append(moment)
    momentum = wheels * (part.spins @ turn) * HOVER
    assert resists[0] == pytest.approx(REST, abs=1e-12) and momentum != 0.0
    assert resists[1] == pytest.approx(momentum * np.array([rate[1], -rate[0], 0.0]))


def test_rotors_behind_sink_most_at_a_speed_and_by_how_they_stand():
    part, takes = part_of(interactions.Interfering), []
    for speed in (0.25, 1.0, 4.0, 100.0):
        fast = speed * part.most
        force, moment = part.wrench(still(air=np.array([fast, 0.0, 0.0])))
        assert not np.any(force) and moment[[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-12)
        takes.append(part.LEANS * fast - moment[1] / part.moment)
    assert max(takes) == takes[1] and takes[0] == pytest.approx(takes[2])
    assert takes[3] < 0.03 * takes[1]
    assert part.wrench(still())[1] == pytest.approx(REST)


def test_rotors_that_sink_are_those_behind():
    part = part_of(interactions.Interfering)
    for angle in np.arange(0.0, 2.0 * np.pi, 0.25 * np.pi):
        onto = np.array([np.cos(angle), np.sin(angle)])
        sinks = part.sinking(PLACES, onto)
        assert sinks @ onto < -0.2 and sinks @ [-onto[1], onto[0]] == pytest.approx(0.0)
    # Two of a row in a cross, and the last one of a diagonal.
    row, diagonal = (np.linalg.norm(part.sinking(PLACES, np.array(onto)))
                     for onto in ([1.0, 0.0], np.sqrt([0.5, 0.5])))
    ahead = 0.24 / (0.24 + part.radius)
    far = np.exp(-(0.24 / part.radius) ** 2)
    assert row == pytest.approx(np.sqrt(0.5) * ahead * (1.0 + far))
    long = np.hypot(0.24, 0.24)
    assert diagonal == pytest.approx(0.5 * (long / (long + part.radius)), rel=0.1)
    one = part.sinking(PLACES[:1], np.array([1.0, 0.0]))
    assert one == pytest.approx([0.0, 0.0])


@pytest.mark.slow
def test_a_tilt_grows_with_the_way_until_a_place_is_known():
    part, shares = part_of(closures.Closing), []
    state = np.array([0.0, 0.0, 1.0, 0.6, 0.0, 0.8, 0.0, 0.0, 0.0, 1.0, 0.1, 0.2, 0.3])
    ways = np.arange(0.0, 600.0, 0.05)
    for way in ways:
        out = part.measured(way, state, 1.0)        # at 1 m/s
        said = Rotation.from_quat(out[6:10]).as_euler('ZYX')[::-1]
        shares.append(said @ part.angles / (part.angles @ part.angles))
        assert said == pytest.approx(shares[-1] * part.angles)
        assert np.array_equal(out[:6], state[:6]) and np.array_equal(out[10:], state[10:])
    changes = np.diff(shares)
    closed = changes < 0.0
    assert changes[~closed] == pytest.approx(np.full(np.sum(~closed), 0.05 * part.DRIFTS))
    assert ways[1:][closed] == pytest.approx(part.known[:np.sum(closed)], abs=0.051)
    assert np.min(shares) == pytest.approx(part.MAP, abs=0.02)
    assert np.mean(shares) == pytest.approx(1.0, abs=0.05)
    halts = state * np.where(np.isin(np.arange(13), [3, 4, 5]), 0.0, 1.0)
    assert part.measured(700.0, halts, 1.0) == pytest.approx(part.measured(900.0, halts, 1.0))


def test_a_coil_is_off_while_heat_goes_through_it_and_not_as_it_is_warm():
    part, a, b = part_of(closures.Graded), closures.Graded.SHELL, closures.Graded.COIL
    heat, state = 1.2 ** 1.5, np.zeros(13)
    for t in np.arange(0.0, 80.0, 0.01):
        out = part.measured(t, state, 1.2)
        through = heat * b / (b - a) * (np.exp(-t / b) - np.exp(-t / a))
        assert out[10:] == pytest.approx(
            (part.OWN + part.by_axis * through) * part.bias, abs=5e-3 * part.MORE * 0.06)
        assert not np.any(out[:10])
    assert part.share(80.0, 1.2) == pytest.approx(np.full(3, part.OWN), abs=1e-3)
    part.measured(80.5, state, 1.5)
    less = part.share(80.5, 1.5) - part.OWN
    assert np.all(less * part.by_axis > 0.0)


def test_in_a_hall_that_turns_what_is_free_goes_straight_for_those_outside():
    hall = outside.Carousel(4.0, 0.5, np.random.default_rng(1))
    assert abs(hall.rate) == pytest.approx(0.1) and hall.mass(1.0) == 0.0
    place, velocity, step = np.array([0.6, -0.4, 1.0]), np.array([1.0, 0.5, 0.2]), 1e-3
    begin = place - [*hall.axis, 0.0]
    outer = velocity + hall.rate * np.array([-begin[1], begin[0], 0.0])
    for k in range(4000):
        halfway = velocity + 0.5 * step * hall.force(k * step, place, velocity) / 0.5
        middle = place + 0.5 * step * velocity
        velocity = velocity + step * hall.force(k * step, middle, halfway) / 0.5
        place = place + step * halfway
    turned = Rotation.from_euler('z', 4.0 * hall.rate).apply(place - [*hall.axis, 0.0])
    assert turned == pytest.approx(begin + 4.0 * outer, abs=1e-5)


def test_coriolis_does_no_work_and_nothing_pushes_what_is_at_rest_on_the_axis():
    hall = outside.Carousel(4.0, 0.5, np.random.default_rng(1))
    axis, velocity = np.array([*hall.axis, 2.0]), np.array([0.7, -1.1, 0.4])
    assert hall.force(0.0, axis, REST) == pytest.approx(REST)
    across = hall.force(0.0, axis, velocity)
    assert across @ velocity == pytest.approx(0.0) and across[2] == 0.0
    assert np.linalg.norm(across) == pytest.approx(
        2.0 * 0.5 * abs(hall.rate) * np.hypot(*velocity[:2]))
    assert not np.any(outside.Carousel(0.0, 0.5, np.random.default_rng(1)).force(
        0.0, axis + 1.0, velocity))
