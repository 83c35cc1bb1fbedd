# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of inertia, rotors and sensors that the twenty-fourth draw flies, and a stranger."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import (
    fresh,
    HANGING,
    HOVER,
    instant,
    LEVEL,
    PARAMS,
    part_of,
    PLACES,
    REST,
    still,
    turning,
)

from withheld import outside
from withheld.constants import hover_speed, induced_velocity
from withheld.forms.cages import Caged
from withheld.forms.cracks import Cracked
from withheld.forms.fits import Grommeted, Pressed
from withheld.forms.flutters import StallFlutter
from withheld.forms.lenses import Zooming
from withheld.forms.polynomials import Fitted
from withheld.forms.reflections import Reflected
from withheld.forms.skews import Easing


def test_a_cage_catches_up_with_a_turn_in_a_time_and_not_before():
    part, rate = part_of(Caged), np.array([0.5, -1.0, 0.2])
    moments, step = [], 0.001
    for _ in range(600):
        moments.append(part.wrench(still(rate=rate))[1])
        part.after(step, LEVEL, REST)
    moments = np.array(moments)
    assert moments[0] == pytest.approx(
        -np.sign(rate) * part.loads * part.GRIPS * np.abs(rate) ** (2.0 / 3.0))
    # By the solution: the cube root of the slip falls evenly until it is zero.
    ends = 3.0 / part.GRIPS * np.cbrt(np.abs(rate))
    assert step * np.count_nonzero(moments, axis=0) == pytest.approx(ends, abs=2.0 * step)
    # What the body has given is what the cage has.
    assert step * moments.sum(axis=0) == pytest.approx(-part.loads * rate, rel=0.01)
    assert np.all(np.diff(np.abs(moments), axis=0) <= 0.0)


def test_a_cage_is_the_same_in_one_step_or_in_many():
    ends = []
    for count in (1, 30):
        part = part_of(Caged)
        part.wrench(still(rate=np.array([0.5, -1.0, 0.2])))
        for _ in range(count):
            part.after(0.1 / count, LEVEL, REST)
        ends.append(part._turning)
    assert ends[0] == pytest.approx(ends[1]) and ends[0][1] < -0.5


def test_a_lens_goes_out_by_an_equal_way_for_an_equal_ratio_between_its_stops():
    part, shares = part_of(Zooming), []
    for ratio in (0.1, 1.0 / part.RATIO, part.RATIO ** -0.5, 1.0, part.RATIO ** 0.5, 3.0):
        there = part.place + [0.0, 0.0, part.MIDDLE * ratio]
        now = turning(part, 1.0, 2.0, position=there)
        force, moment = part.wrench(now)
        lift = PARAMS['mass'] * 9.81
        x, y = moment[1] / lift, -moment[0] / lift
        assert not np.any(force) and moment[2] == 0.0
        assert x * part.centre[1] == pytest.approx(y * part.centre[0], abs=1e-12)
        shares.append(x / part.centre[0] / part.SWINGS)
    assert shares == pytest.approx([-1.0, -1.0, -0.5, 0.0, 0.5, 1.0])


def test_a_lens_is_no_faster_than_its_motor():
    part = part_of(Zooming)
    far = part.place + [0.0, 0.0, 9.0]
    turning(part, 1.0, 0.2, position=far)
    assert part._lens == pytest.approx(0.2 * part.FAST)
    turning(part, 1.0, 2.0, position=far)
    assert part._lens == pytest.approx(1.0)
    true = fresh()
    part.alter(true, PARAMS)
    assert true['centre'] == pytest.approx(part.centre)


def test_a_crack_grows_by_the_law_of_paris_and_costs_the_square_of_the_speed():
    part, step, lengths = part_of(Cracked), 0.01, []
    for _ in range(1500):
        turning(part, 1.1, step, step)
        lengths.append(part._crack)
    lengths = np.array(lengths)
    middle = 0.5 * (lengths[1:] + lengths[:-1])
    stress = 1.1 ** 2 * np.sqrt(middle)
    grows = middle < 0.98 * part.MOST
    assert (np.diff(lengths) / step)[grows] == pytest.approx(
        (1.1 * part.GROWS * stress ** part.POWER)[grows], rel=1e-4)
    assert lengths[-1] <= part.MOST * (1.0 + 1e-9) and lengths[0] < part.FIRST[1] * 1.01
    for turn in (0.7, 1.0, 1.3):
        gain = part.gain(still(speeds=np.full(4, turn * HOVER)))
        assert np.delete(gain, part.rotor) == pytest.approx(np.ones(3))
        assert 1.0 - gain[part.rotor] == pytest.approx(part.loss * part._crack * turn ** 2)
    assert np.array_equal(part.torque(still()), part.gain(still()))


def test_a_crack_grows_fast_at_high_load_is_no_less_after_and_ends_at_its_most():
    ends = []
    for turn in (0.8, 1.0, 1.2):
        part = part_of(Cracked)
        turning(part, turn, 5.0)
        ends.append(part._crack)
        turning(part, 0.2, 2.0)
        assert part._crack == pytest.approx(ends[-1], rel=1e-4)
    first = part.FIRST[0]
    assert first < ends[0] < ends[1] < ends[2]
    assert ends[2] - ends[1] > 3.0 * (ends[1] - ends[0])
    turning(part, 1.5, 30.0)
    assert part._crack == pytest.approx(part.MOST)


def test_flutter_grows_out_of_the_noise_above_a_speed_and_dies_below():
    part = part_of(StallFlutter)
    turning(part, 0.9, 5.0)
    assert part._square == pytest.approx(part.NOISE)
    ends = []
    for turn in (1.0, 1.1, 1.2):
        turning(part, turn, 8.0)
        ends.append(part._square)
    assert ends == pytest.approx(part.STEEP * (np.array([1.0, 1.1, 1.2]) - part.ONSET), rel=1e-3)
    gain = part.gain(still())
    assert 1.0 - gain[part.rotor] == pytest.approx(part.loss * (part.OWN + part.MORE * ends[2]))
    assert np.delete(gain, part.rotor) == pytest.approx(np.ones(3))
    turning(part, 0.85, 3.0)
    assert part._square == pytest.approx(part.NOISE) and part.torque(still()) == 1.0


def test_flutter_is_the_same_in_one_step_or_in_many_and_grows_first_by_an_equal_share():
    for turn in (0.8, StallFlutter.ONSET, 1.1):
        ends = []
        for count in (1, 50):
            part = part_of(StallFlutter)
            part._square = 0.1
            turning(part, turn, 0.3, 0.3 / count)
            ends.append(part._square)
        assert ends[0] == pytest.approx(ends[1])
    part, squares = part_of(StallFlutter), []
    for _ in range(3):
        turning(part, 1.1, 0.05)
        squares.append(part._square)
    rate = part.GROWS * part.STEEP * (1.1 - part.ONSET)
    assert np.diff(np.log(squares)) == pytest.approx(np.full(2, 0.05 * rate), rel=0.05)


def followed(part, turns, step=0.0025):
    """Let propellers see hubs (k,) of the speed in hover; return their own, and their pull."""
    blades, pulls = [], []
    for turn in turns:
        part.wrench(still(speeds=np.full(4, turn * HOVER)))
        blades.append(part._blades[0] / HOVER)
        pulls.append(part._pull[0] / (part.SLOWS * HOVER))
        part.after(step, LEVEL, REST)
    return np.array(blades), np.array(pulls)


@pytest.mark.parametrize('kind', [Pressed, Grommeted])
def test_what_pulls_a_propeller_is_its_drag_in_the_end_and_nothing_is_felt(kind):
    part = part_of(kind)
    blades, pulls = followed(part, np.concatenate([np.ones(50), np.full(4000, 1.2)]))
    assert blades[:50] == pytest.approx(np.ones(50)) and pulls[0] == pytest.approx(1.0)
    assert blades[-1] == pytest.approx(1.2, abs=1e-3)
    assert pulls[-1] == pytest.approx(1.2 ** 2, rel=0.01) and blades.max() > 1.21
    assert part.wrench(still(speeds=np.full(4, 1.2 * HOVER)))[1] == pytest.approx(REST, abs=1e-9)


@pytest.mark.parametrize('kind', [Pressed, Grommeted])
def test_the_body_gets_the_momentum_that_propellers_lose_and_resists_a_turn(kind):
    part, given, step = part_of(kind), 0.0, 0.0025
    spins = PARAMS['rotor_directions']
    turns = 1.0 + 0.2 * (spins > 0)         # what turns the body to one side
    part.wrench(still())
    for _ in range(4000):
        force, moment = part.wrench(still(speeds=turns * HOVER))
        given += step * moment[2]
        part.after(step, LEVEL, REST)
    assert not np.any(force)
    assert given == pytest.approx(part.inertia * spins @ (turns - 1.0) * HOVER, rel=0.01)
    # A reaction that turns the body one way is of a rotor that turns the other way.
    momentum = part.inertia * np.array([0.0, 0.0, -spins @ turns * HOVER])
    rate = np.array([0.4, -0.7, 0.3])
    moment = part.wrench(still(speeds=turns * HOVER, rate=rate))[1]
    assert moment == pytest.approx(-np.cross(rate, momentum), rel=0.01, abs=1e-9)


def test_a_pressed_propeller_creeps_and_never_pulls_by_more_than_its_friction():
    part = part_of(Pressed)
    most = part.HOLDS * part.SLOWS * HOVER
    part.wrench(still())
    part._slope()
    for angle in (0.02, 0.1, 5.0, -5.0):
        before = part._pull
        after, little = (part._turned(np.full(4, one)) for one in (angle, 1e-7 * np.sign(angle)))
        # Stiff as a spring where nothing pulls, less towards the limit, and more back from it.
        assert (little - before) / (1e-7 * np.sign(angle)) == pytest.approx(
            part.RATE ** 2 * (1.0 - np.sign(angle) * before / most), rel=1e-3)
        assert np.all(np.abs(after) <= most)
        part._pull = after
    assert after == pytest.approx(np.full(4, -most), rel=1e-3)
    # There and back is not the same: work is lost.
    part._pull = np.zeros(4)
    part._pull = part._turned(np.full(4, 0.3))
    assert np.all(part._turned(np.full(4, -0.3)) < 0.0)


def test_rubber_is_soft_up_to_the_stop_hard_beyond_and_gives_all_back():
    part = part_of(Grommeted)
    stop, step = part.STOP * part.SLOWS * HOVER, 1e-6
    for pull, rate in ((0.0, part.RATE), (0.99 * stop, part.RATE), (1.2 * stop, part.HARD),
                       (-1.2 * stop, part.HARD)):
        part._pull = np.full(4, pull)
        assert (part._turned(step) - pull) / step == pytest.approx(np.full(4, rate ** 2))
    part._pull = np.full(4, 0.5 * stop)
    part._pull = part._turned(0.3)
    over = 0.3 - 0.5 * stop / part.RATE ** 2
    assert part._pull == pytest.approx(np.full(4, stop + part.HARD ** 2 * over))
    assert part._turned(-0.3) == pytest.approx(np.full(4, 0.5 * stop))


def test_a_disk_leans_at_once_and_eases_as_its_wake_leans():
    part = part_of(Easing)
    part.wrench(still())
    part.after(0.01, LEVEL, REST)
    now, step, moments = still(air=np.array([2.0, 0.0, 0.0])), 0.002, []
    for _ in range(2000):
        moments.append(part.wrench(now)[1])
        part.after(step, LEVEL, REST)
    moments = np.array(moments)
    assert part.time == pytest.approx(
        part.WAY * PARAMS['rotor_radius'] / induced_velocity(PARAMS))
    eases = 1.0 + part.MORE * np.exp(-step * np.arange(2000) / part.time)
    assert moments[:, 1] == pytest.approx(2.0 * part.moment * eases)
    assert moments[:, [0, 2]] == pytest.approx(np.zeros((2000, 2)))


def test_a_leaning_disk_knows_no_direction_and_faster_rotors_ease_sooner():
    part = part_of(Easing)
    for angle in (0.3, 1.9, 4.0):
        air = np.array([np.cos(angle), np.sin(angle), -0.4])
        part.begin(np.random.default_rng(1))
        force, moment = part.wrench(still(air=air))
        assert not np.any(force)
        assert moment == pytest.approx(part.moment * np.cross([0.0, 0.0, 1.0], air))
    lefts = []
    for turn in (0.8, 1.2):
        part.begin(np.random.default_rng(1))
        part.wrench(still(speeds=np.full(4, turn * HOVER)))
        now = still(air=np.array([1.0, 0.0, 0.0]), speeds=np.full(4, turn * HOVER))
        part.wrench(now)
        part.after(part.time, LEVEL, REST)
        lefts.append(part.wrench(now)[1][1] / (turn * part.moment) - 1.0)
    assert lefts == pytest.approx(part.MORE * np.exp([-0.8, -1.2]))


def tilt_of(part, state):
    out = part.measured(1.0, state, 1.0)
    assert np.array_equal(np.delete(out, range(6, 10)), np.delete(state, range(6, 10)))
    return (Rotation.from_quat(state[6:10]).inv() * Rotation.from_quat(out[6:10])).as_euler('ZYX')


@pytest.mark.slow
def test_signals_that_the_ground_reflects_swing_pitch_and_heading_with_the_height_alone():
    part, state, tilts = part_of(Reflected), HANGING.copy(), []
    state[6:10] = Rotation.from_euler('ZYX', [0.7, 0.2, -0.1]).as_quat()
    heights = np.linspace(0.0, 40.0, 8000)
    for height in heights:
        state[:3] = 0.3, -2.0, height
        tilts.append(tilt_of(part, state))
    shares = np.array(tilts) / part.angles[::-1]
    assert shares[:, 2] == pytest.approx(np.ones(8000))
    assert shares.mean(axis=0) == pytest.approx(np.ones(3), abs=0.02)
    assert shares[:, :2].std(axis=0) == pytest.approx(
        np.full(2, part.SWING * np.sqrt(0.5 * part.COUNT)), rel=0.1)
    # Each satellite has its line: the path is longer by twice the height times the sine.
    for wave, line in zip(part.waves, part.WAVE / 2.0 / (part.waves * part.WAVE / 4.0 / np.pi),
                          strict=True):
        assert wave * line == pytest.approx(2.0 * np.pi)
        swings = (shares[:, :2] - 1.0).T @ np.exp(1j * wave * heights) / 8000
        assert np.abs(swings) == pytest.approx(np.full(2, 0.5 * part.SWING), rel=0.25)
    state[:2] = 5.0, 7.0
    assert tilt_of(part, state) == pytest.approx(tilts[-1])


def test_what_a_cubic_leaves_of_a_bias_swings_between_equal_tops_as_it_warms():
    part = part_of(Fitted)
    warms = np.linspace(-1.0, 1.0, 2001)
    shares = []
    for part._warm in warms:
        shares.append((part.share(0.0, 1.0) - 1.0) / part.by_axis)
    left = np.array(shares)[:, 0]
    assert np.abs(left).max() == pytest.approx(1.0)
    assert np.sum((left[1:-1] - left[:-2]) * (left[2:] - left[1:-1]) < 0.0) == 3
    # No cubic takes anything off its greatest.
    fit = np.polynomial.chebyshev.chebfit(warms, left, 4)
    assert fit == pytest.approx([0.0, 0.0, 0.0, 0.0, 1.0], abs=1e-9)
    part._warm = 3.0
    assert part.share(0.0, 1.0) == pytest.approx(1.0 + part.by_axis)


def test_a_gyroscope_warms_with_the_power_by_a_time_of_its_own():
    for thrust in (0.8, 1.0, 1.1):
        part, state = part_of(Fitted), HANGING + 0.0
        for k in range(501):
            out = part.measured(0.02 * k, state, thrust)
            assert out[10:] == pytest.approx(part.share(0.0, thrust) * part.bias)
            assert np.array_equal(out[:10], state[:10])
        part_left = np.exp(-10.0 / part.TIME)
        assert part._warm == pytest.approx(
            part.COLD + part.WARMS * thrust ** 1.5 * (1.0 - part_left))
    part.begin(np.random.default_rng(1))
    first = part.measured(0.0, state, 1.0)[10:]
    assert first == pytest.approx((1.0 + part.by_axis) * part.bias)


def bent(size, seed=1):
    weight = 9.81 * PARAMS['mass']
    return outside.Bent(size, 4, weight, hover_speed(PARAMS), np.random.default_rng(seed)), weight


def test_a_bent_motor_pushes_by_its_own_thrust_and_loses_what_it_leans():
    for seed in range(10):
        part, weight = bent(3.0, seed)
        turn = np.ones(4)
        turn[part.rotor] = 1.3
        force, moment = part.wrench(still(speeds=turn * HOVER))
        thrust = 1.3 ** 2 * weight / 4.0
        whole = force + [0.0, 0.0, thrust]
        assert np.linalg.norm(whole) == pytest.approx(thrust)
        assert np.arccos(whole[2] / thrust) == pytest.approx(0.12)
        place = PLACES[part.rotor]
        assert moment == pytest.approx(np.cross(place, force))
        # Mostly across its arm, so that it turns the body about its vertical.
        aside = np.linalg.norm(force[:2]) * np.linalg.norm(place[:2])
        assert np.cos(part.ASIDE) <= abs(moment[2]) / aside <= 1.0
        others = np.where(np.arange(4) == part.rotor, turn, 0.5)
        assert part.wrench(still(speeds=others * HOVER))[0] == pytest.approx(force)


def test_a_bent_motor_leans_to_either_side_and_may_be_any():
    parts = [bent(2.0, seed)[0] for seed in range(60)]
    assert {part.rotor for part in parts} == {0, 1, 2, 3}
    signs = {np.sign(part.wrench(still())[1][2]) for part in parts}
    assert signs == {-1.0, 1.0}
    assert not np.any(bent(0.0)[0].wrench(instant()))
