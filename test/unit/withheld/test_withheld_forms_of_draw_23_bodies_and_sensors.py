# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of bodies, rotors and sensors that the twenty-third draw is the first to fly."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import fresh, HOVER, LIFT, PARAMS, part_of, PLACES, REST, still, turning

from withheld import outside
from withheld.forms import gimbals, leans, scales, suspensions, threads, underslung


def test_a_parcel_on_lines_swings_about_the_vertical_alone_and_faster_under_more_thrust():
    for turn in (0.8, 1.2):
        part, step, moments = part_of(suspensions.Multifilar), 0.0025, []
        part._turning = np.array([0.02, -0.02, 0.02])
        now = still(speeds=np.full(4, turn * HOVER))
        for _ in range(1200):
            moments.append(part.wrench(now)[1])
            part.after(step, np.eye(3), REST)
        moments = np.array(moments)
        assert np.all(np.abs(moments[200:, :2]) < 1e-9)
        assert np.all(np.diff(np.abs(moments[:100, :2]), axis=0) < 0.0)
        crossings = np.flatnonzero(np.diff(np.sign(moments[:, 2])))
        rate = np.sqrt((part.FREQUENCY * turn) ** 2 - (part.FREQUENCY * part.DAMPING) ** 2)
        assert step * np.mean(np.diff(crossings[:5])) == pytest.approx(np.pi / rate, rel=0.02)


def test_a_parcel_on_lines_ends_up_with_all_of_its_momentum():
    part, step, given = part_of(suspensions.Multifilar), 0.001, np.zeros(3)
    now = still(rate=np.array([0.3, -0.2, 0.4]))
    for _ in range(8000):
        given -= step * part.wrench(now)[1]
        part.after(step, np.eye(3), REST)
    assert given[:2] == pytest.approx((part.loads * now.rate)[:2], rel=0.03)
    assert given[2] == pytest.approx((part.loads * now.rate)[2], rel=5e-3)
    assert part.wrench(now)[1] == pytest.approx(REST, abs=1e-6)


def test_lines_as_long_as_they_are_apart_turn_a_parcel_back_by_the_sine_of_half_the_angle():
    part = part_of(suspensions.Multifilar)
    # What lifts it: the height of lines of length 1 between circles of radius 1/2.
    angles, h = np.linspace(0.1, 2.0, 8), 1e-5

    def high(angle):
        return -np.sqrt(1.0 - np.sin(0.5 * angle) ** 2)

    backs = []
    for angle in angles:
        part._twist = angle
        backs.append(part._twists() / part.FREQUENCY ** 2)
    # The slope of the height, to a factor that makes it the angle where that is small.
    slopes = (high(angles + h) - high(angles - h)) / (2.0 * h)
    assert np.array(backs) == pytest.approx(4.0 * slopes, rel=1e-6)


def test_a_camera_that_is_held_level_goes_aside_in_a_body_that_leans():
    part = part_of(gimbals.Gimballed)
    assert part.wrench(still())[1] == pytest.approx(REST)
    far = part.SWINGS * np.linalg.norm(part.centre[:2])
    for lean in ([0.0, 1.0, 0.0], [0.6, -0.8, 0.0]):
        axis, sine = np.array(lean), part.LEAN
        for heading in (0.0, 1.0):
            turned = (Rotation.from_euler('z', heading)
                      * Rotation.from_rotvec(np.arcsin(sine) * axis))
            moment = part.wrench(still(rotation=turned.as_matrix()))[1]
            # Of a nose that goes down, a camera below comes to the front, and presses it down.
            assert moment == pytest.approx(part.below * LIFT * far * axis)
        steep = Rotation.from_rotvec(1.2 * axis).as_matrix()
        assert part.wrench(still(rotation=steep))[1] == pytest.approx(
            part.below * LIFT * far * part.MOST / part.LEAN * axis)
    sides = {part_of(gimbals.Gimballed, seed=seed, flight=4).below for seed in range(20)}
    assert sides == {-1.0, 1.0}
    true = fresh()
    part.alter(true, PARAMS)
    assert true['centre'] == pytest.approx(part.centre)


def test_a_thread_winds_up_by_an_equal_share_and_then_ends():
    part, rubs = part_of(threads.Wound), []
    half = -part._wound
    assert part.HALF[0] <= half <= part.HALF[1]
    for _ in range(3000):
        rubs.append((1.0 - part.gain(still())[part.rotor]) / part.loss)
        part.after(0.01, np.eye(3), REST)
    more = np.array(rubs) - part.OWN
    assert np.all(np.diff(more) > 0.0) and more[-1] == pytest.approx(part.MORE, rel=1e-3)
    assert more[round(100 * half)] == pytest.approx(0.5 * part.MORE, rel=0.01)
    early = more[:round(100 * (half - 3.0 * part.GROWS))]
    assert early[60:] / early[:-60] == pytest.approx(
        np.full(len(early) - 60, np.exp(0.6 / part.GROWS)), rel=0.05)


def test_a_thread_rubs_by_the_same_force_at_every_speed_and_winds_with_it():
    part, losses = part_of(threads.Wound), []
    for turn in (0.7, 1.0, 1.4):
        gain = part.gain(still(speeds=np.full(4, turn * HOVER)))
        assert np.count_nonzero(gain != 1.0) == 1 and np.all(gain > 0.0)
        losses.append((1.0 - gain[part.rotor]) * turn ** 2)
    assert losses == pytest.approx([losses[0]] * 3)
    before = part._wound
    turning(part, 1.4, 2.0)
    assert part._wound - before == pytest.approx(2.8)


@pytest.mark.slow
def test_a_controller_is_hot_in_hover_and_cool_in_flight():
    part, lacks = part_of(threads.Uncooled), []
    for speed in (0.0, 1.0, 4.0):
        now = turning(part, 1.0, 60.0, air=np.array([0.6 * speed, 0.0, 0.8 * speed]))
        gain = part.gain(now)
        lacks.append((1.0 - gain[part.rotor]) / part.loss - part.OWN)
        assert np.count_nonzero(gain != 1.0) == 1 and part.torque(now) == pytest.approx(gain)
    roots = np.array([0.0, 1.0, 2.0])
    assert lacks == pytest.approx(1.0 / (part.REST + part.BLOWN * roots), rel=1e-4)
    turning(part, 1.2, 90.0)
    assert part._heat == pytest.approx(1.2 ** 4 / part.REST)


def test_a_controller_cools_sooner_in_flight():
    part, lefts = part_of(threads.Uncooled), []
    for speed in (0.0, 4.0):
        cools = part.REST + part.BLOWN * np.sqrt(speed)
        part._heat = 1.0 / cools + 1.0
        turning(part, 1.0, part.TIME, air=np.array([speed, 0.0, 0.0]))
        lefts.append(np.log(part._heat - 1.0 / cools))
        assert lefts[-1] == pytest.approx(-cools, rel=1e-6)
    assert lefts[1] < lefts[0]


def test_blades_on_hinges_swing_the_faster_the_faster_they_turn():
    part, true = part_of(leans.Swinging), fresh()
    part.alter(true, PARAMS)
    assert true['rotor_inertia'] == pytest.approx(part.OWN * part.inertia)
    loose = (1.0 - part.OWN) * part.inertia
    for turn in (0.7, 1.3):
        part.begin(None)
        turning(part, turn, 0.1)
        speeds = turn * HOVER + np.array([1.0, 0.0, 0.0, 0.0])
        now, moments = still(speeds=speeds), []
        for _ in range(1500):
            moments.append(part.wrench(now)[1][2])
            part.after(0.001, np.eye(3), REST)
        damps = np.sqrt(1.0 - part.DAMPING ** 2)
        wave = 2.0 * np.pi / (part.FREQUENCY * turn * damps)
        crossings = np.flatnonzero(np.diff(np.sign(moments)))
        assert 0.001 * np.mean(np.diff(crossings[:5])) == pytest.approx(0.5 * wave, rel=0.03)
        assert 0.001 * np.sum(moments) == pytest.approx(loose * part.spins[0], rel=0.02)
        assert moments[-1] == pytest.approx(0.0, abs=1e-4 * np.max(np.abs(moments)))


def test_swinging_blades_resist_a_turn_by_the_momentum_that_they_have():
    part = part_of(leans.Swinging)
    speeds = np.array([1.1, 0.9, 1.1, 0.9]) * HOVER
    now = still(speeds=speeds, rate=np.array([0.5, -0.4, 0.0]))
    moment = part.wrench(now)[1]
    momentum = (1.0 - part.OWN) * part.inertia * (part.spins @ speeds)
    assert moment == pytest.approx(momentum * np.array([-0.4, -0.5, 0.0]))


def test_rotors_that_lean_turn_the_body_about_all_axes_as_they_change_their_speed():
    part = part_of(leans.Leaning)
    assert np.linalg.norm(part.axes, axis=1) == pytest.approx(np.ones(4))
    assert part.axes.sum(axis=0) == pytest.approx([0.0, 0.0, 4.0 * np.cos(part.LEANS)])
    across = np.cross(PLACES, part.axes)[:, 2]
    assert across == pytest.approx(np.zeros(4))
    turning(part, 1.0, 0.1)
    speeds, took = HOVER + np.array([3.0, 1.0, -1.0, 0.0]), np.zeros(3)
    now = still(speeds=speeds)
    for _ in range(400):
        took += 0.0005 * part.wrench(now)[1]
        part.after(0.0005, np.eye(3), REST)
    changes = part.spins * (speeds - HOVER)
    assert took == pytest.approx(part.inertia * changes @ part.axes, rel=0.03)
    assert np.all(np.abs(took) > 1e-8)
    assert part.wrench(now)[1] == pytest.approx(REST, abs=1e-9 * part.inertia * HOVER)


def test_rotors_that_lean_do_no_work_on_a_body_that_turns():
    part, rate = part_of(leans.Leaning), np.array([0.5, -0.3, 0.8])
    speeds = np.array([1.1, 1.0, 0.8, 0.95]) * HOVER
    moment = part.wrench(still(speeds=speeds, rate=rate))[1]
    assert moment @ rate == pytest.approx(0.0, abs=1e-12) and np.all(moment != 0.0)
    upright = part.inertia * part.spins @ speeds * np.cos(part.LEANS)
    part.axes = part.axes * [0.0, 0.0, 1.0]
    assert part.wrench(still(speeds=speeds, rate=rate))[1] == pytest.approx(
        upright * np.array([rate[1], -rate[0], 0.0]))


def test_a_parcel_in_the_wake_turns_the_body_with_the_velocity_and_then_with_its_square():
    part, moments = part_of(underslung.Underslung), []
    for speed in (1e-3, part.wake, 100.0 * part.wake):
        force, moment = part.wrench(still(air=np.array([speed, 0.0, 0.0])))
        assert force[0] < 0.0 and force[1:] == pytest.approx([0.0, 0.0])
        assert moment[[0, 2]] == pytest.approx([0.0, 0.0])
        moments.append(moment[1] / part.moment / speed)
    assert moments == pytest.approx([
        part.OWN + part.PARCEL, part.OWN + np.sqrt(2.0) * part.PARCEL,
        part.OWN + 100.0 * part.PARCEL], rel=1e-3)
    for extra in part.wrench(still()):
        assert extra == pytest.approx(REST)


def test_what_a_parcel_turns_the_body_by_is_its_drag_below_the_centre():
    part = part_of(underslung.Underslung)
    air = np.array([1.0, -0.7, 0.4])
    force, moment = part.wrench(still(air=air))
    assert force @ air < 0.0 and force[2] == 0.0
    rotors = part.OWN * part.moment * np.array([0.7, 1.0, 0.0])
    assert moment - rotors == pytest.approx(np.cross(part.place, force))
    # A climb has more of it, and a descent with the wake has less.
    pushes = [np.linalg.norm(part.wrench(still(air=np.array([1.0, 0.0, climb])))[0])
              for climb in (-part.wake, 0.0, part.wake)]
    assert pushes[0] < pushes[1] < pushes[2]


def said_by(part, rates, step=0.01):
    """Return the angles (n, 3) rad that an attitude is off by while a body turns by rates."""
    turn, offs = Rotation.identity(), []
    for k, rate in enumerate(rates):
        state = np.array([*np.zeros(6), *turn.as_quat(), *rate])
        out = part.measured(step * k, state, 1.0)
        assert np.array_equal(out[:6], state[:6]) and np.array_equal(out[10:], state[10:])
        offs.append((turn.inv() * Rotation.from_quat(out[6:10])).as_rotvec())
        turn = turn * Rotation.from_rotvec(step * np.asarray(rate))
    return np.array(offs)


@pytest.mark.slow
@pytest.mark.parametrize('axis', range(3))
def test_an_attitude_with_wrong_scales_is_off_by_a_share_of_a_turn_and_comes_back(axis):
    part = part_of(scales.Scaled)
    part.angles = np.zeros(3)
    rates = np.zeros((2000, 3))
    rates[1:101, axis] = 0.8
    offs = said_by(part, rates)
    others = np.arange(3) != axis
    assert np.all(np.abs(offs[:, others]) < 1e-9)
    gone = 1.0 - np.exp(-1.0 / part.TIME)
    assert offs[100, axis] == pytest.approx(0.8 * part.TIME * gone * part.scales[axis])
    assert offs[300, axis] / offs[100, axis] == pytest.approx(np.exp(-2.0 / part.TIME), rel=1e-3)
    assert offs[-1] == pytest.approx(REST, abs=1e-4)


def test_wrong_scales_have_a_bound_and_leave_what_sits_askew():
    part, rest = part_of(scales.Scaled), np.zeros((3, 3))
    askew = Rotation.from_euler('ZYX', part.angles[::-1]).as_rotvec()
    assert said_by(part, rest)[-1] == pytest.approx(askew)
    assert np.max(np.abs(part_of(scales.Scaled, 50.0).scales)) <= scales.Scaled.MOST


@pytest.mark.slow
def test_a_bias_flickers_alike_over_short_and_long_times():
    part, walks = part_of(scales.Flickering), []
    for seed in range(80):
        part.begin(np.random.default_rng(seed))
        walks.append(part._walk)
    walks = np.array(walks)
    assert np.mean(walks) == pytest.approx(0.0, abs=0.02)
    assert np.std(walks) == pytest.approx(part.SWING, rel=0.05)
    assert np.abs(np.corrcoef(walks.reshape(-1, 3).T)[0, 1]) < 0.1
    # What is remembered: the mean of the exponentials.
    for wait in (0.2, 1.0, 5.0):
        steps = round(wait / part.EVERY)
        both = np.mean(walks[:, steps:] * walks[:, :-steps]) / part.SWING ** 2
        assert both == pytest.approx(np.mean(np.exp(-wait / part.TIMES)), abs=0.05)
    # Allan's deviation is level, where that of a walk would grow with the root.
    deviations = []
    for time in (0.5, 1.0, 2.0, 4.0):
        many = round(time / part.EVERY)
        means = walks[:, :2400 // many * many].reshape(80, -1, many, 3).mean(axis=2)
        deviations.append(np.sqrt(0.5 * np.mean(np.diff(means, axis=1) ** 2)))
    assert np.max(deviations) / np.min(deviations) < 1.2


def test_a_gyroscope_says_the_bias_that_flickers_and_nothing_else_changes():
    part, state = part_of(scales.Flickering), np.arange(13.0)
    out = part.measured(3.0, state, 1.0)
    assert out[:10] == pytest.approx(state[:10])
    assert out[10:] - state[10:] == pytest.approx((1.0 + part._walk[60]) * part.bias)


def bag_of(size=4.0):
    bag = outside.Sandbag(size, 5.0, np.random.default_rng(1))
    bag.begin(np.random.default_rng(2))
    bag.bag = np.zeros(3)
    return bag


def test_a_line_to_a_sandbag_is_slack_then_taut_and_then_it_drags_the_bag():
    bag, pulls, ways = bag_of(), [], []
    assert bag.most == pytest.approx(0.6)
    for x in np.arange(0.0, 3.0, 0.005):
        place = np.array([x, 0.0, 1.0])
        force = bag.force(0.0, place, REST)
        far = np.linalg.norm(bag.bag - place)
        assert np.cross(force, bag.bag - place) == pytest.approx(REST)
        assert force @ (bag.bag - place) >= 0.0
        assert np.linalg.norm(force) == pytest.approx(
            bag.most * np.clip((far - bag.length) / bag.GIVES, 0.0, 1.0))
        pulls.append(np.linalg.norm(force))
        bag.after(0.01, np.eye(3), REST)
        ways.append(bag.bag[0])
        assert np.linalg.norm(bag.bag - place) <= bag.length + bag.GIVES + 1e-9
    slack = np.sqrt(bag.length ** 2 - 1.0)
    held = np.arange(0.0, 3.0, 0.005) <= slack
    assert not np.any(np.array(pulls)[held]) and pulls[-1] == pytest.approx(bag.most)
    assert ways[-1] == pytest.approx(2.995 - np.sqrt((bag.length + bag.GIVES) ** 2 - 1.0))
    # On the way back it is slack again, and the bag stays.
    assert not np.any(bag.force(0.0, np.array([2.5, 0.0, 1.0]), REST))
    bag.after(0.01, np.eye(3), REST)
    assert bag.bag[0] == ways[-1]


def test_a_bag_that_is_dragged_aside_follows_a_tractrix():
    bag = bag_of()
    reach = np.sqrt((bag.length + bag.GIVES) ** 2 - 1.0)
    for y in np.arange(0.0, 1.0, 1e-4):
        bag.force(0.0, np.array([reach, y, 1.0]), REST)
        bag.after(0.01, np.eye(3), REST)
    x, y, z = bag.bag
    aside = reach - x
    root = np.sqrt(reach ** 2 - aside ** 2)
    assert z == 0.0 and y == pytest.approx(
        reach * np.log((reach + root) / aside) - root, abs=2e-3)


def test_a_bag_that_is_lifted_hangs_straight_below():
    bag = bag_of()
    high = np.array([0.4, -0.3, bag.length + 0.5])
    bag.force(0.0, high, REST)
    bag.after(0.01, np.eye(3), REST)
    assert bag.bag == pytest.approx([0.4, -0.3, 0.0])
    assert bag.force(0.0, high, REST) == pytest.approx([0.0, 0.0, -bag.most])


def test_a_sandbag_of_size_zero_is_none():
    assert not np.any(bag_of(0.0).force(0.0, np.array([3.0, 0.0, 1.0]), REST))
