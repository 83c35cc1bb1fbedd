# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of lags, drag, wind, thrust and batteries of ordinary vehicles: what each does."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import drained, HOVER, PARAMS, part_of, PLACES, RADIUS, REST, stepped, still

from withheld import outside
from withheld.forms.ages import UnlikeAges
from withheld.forms.assortments import TwoPitches
from withheld.forms.avenues import TreeRow
from withheld.forms.ends import UnlikeEnds
from withheld.forms.interpolations import Interpolated
from withheld.forms.levels import TwoLevels
from withheld.forms.quotas import Rationed
from withheld.forms.ratings import ByRating
from withheld.forms.slants import LeaningIn
from withheld.forms.whips import BendingAerials

AHEAD = PLACES[:, 0] > 0.0


@pytest.mark.parametrize('kind', [Interpolated, UnlikeEnds])
def test_a_command_that_is_held_is_reached_and_is_the_same_in_one_step_or_in_many(kind):
    command = np.array([1.1, 0.9, 1.0, 1.2])
    assert stepped(part_of(kind), command, seconds=0.5)[-1] == pytest.approx(command, abs=1e-4)
    assert stepped(part_of(kind), 1.0, seconds=0.5) == pytest.approx(np.ones((1000, 4)))
    # Those that start a little sooner or later have another part of their ramp.
    one = stepped(part_of(kind), command, 0.0005, 0.02)[-1]
    assert one == pytest.approx(stepped(part_of(kind), command, 0.0001, 0.02)[-1], abs=8e-3)


def test_what_is_interpolated_has_no_steps_and_is_late_by_its_time_on_average():
    step, areas, most = 0.0005, [], []
    for seed in range(40):
        motor = part_of(Interpolated, seed=seed)
        missing = 1.0 - (stepped(motor, 1.1, step, 0.5)[:, 0] - 1.0) / 0.1
        areas.append(step * missing.sum())
        most.append(np.abs(np.diff(missing)).max())
        # Nothing at all until a command is picked, which is within the time of a ramp.
        waits = step * np.count_nonzero(missing > 1.0 - 1e-9)
        assert waits <= motor.every + 2.0 * step
    assert np.mean(areas) == pytest.approx(motor.parameters['time'], rel=0.1)
    # A ramp is as steep as it is long, and a lag makes it no steeper.
    assert max(most) <= step / motor.every * 1.001


def test_without_their_lag_the_motors_ramp_in_a_straight_line():
    motor = part_of(Interpolated)
    motor.OWN, step = 1e-9, 0.0005
    turns = stepped(motor, 1.1, step, 0.5)[:, 0]
    rising = turns[(turns > 1.005) & (turns < 1.095)]
    assert len(rising) >= 15
    assert np.diff(rising) == pytest.approx(np.full(len(rising) - 1, 0.1 * step / motor.every))
    assert turns[-1] == pytest.approx(1.1)


@pytest.mark.parametrize('seed', range(4))
def test_one_end_is_slower_and_the_mean_time_stays(seed):
    motor, step = part_of(UnlikeEnds, seed=seed), 0.0005
    late = step * np.sum(1.0 - (stepped(motor, 1.1, step, 0.5) - 1.0) / 0.1, axis=0)
    time = motor.parameters['time']
    assert late.mean() == pytest.approx(time, rel=0.03)
    apart = late[AHEAD].mean() - late[~AHEAD].mean()
    assert abs(apart) == pytest.approx(2.0 * motor.APART * time, rel=0.03)
    assert np.ptp(late[AHEAD]) == pytest.approx(0.0, abs=1e-12)


def test_either_end_may_be_the_slow_one():
    assert len({tuple(part_of(UnlikeEnds, seed=seed).times) for seed in range(8)}) == 2


@pytest.mark.parametrize('size', [1.0, 3.0])
def test_a_program_stands_still_at_the_end_of_its_periods(size):
    line = part_of(Rationed, size)
    times = np.arange(0.0, 100.0, 0.00237)
    waits = np.array([line.waits(t) for t in times])
    assert waits.mean() == pytest.approx(line.delay, rel=0.03)
    least = line.OWN * line.delay
    late = waits > least + 1e-12
    assert waits.min() == pytest.approx(least)
    assert late.mean() == pytest.approx(line.stands / line.PERIOD, rel=0.03)
    # All of one period come at the same time, when the next one begins.
    ends = times[late] + waits[late] - least + line.phase
    assert ends / line.PERIOD == pytest.approx(np.round(ends / line.PERIOD), abs=1e-6)
    assert np.all(np.diff(times + waits) > -1e-9)


def test_what_it_stands_still_differs_between_periods_and_is_never_all():
    line = part_of(Rationed, 6.0)
    assert line.still.max() == pytest.approx(line.MOST * line.PERIOD)
    assert np.std(part_of(Rationed).still) / np.mean(part_of(Rationed).still) == pytest.approx(
        Rationed.VARIES / np.sqrt(3.0), rel=0.05)


@pytest.mark.parametrize('angle', [0.0, 0.6, 2.0])
def test_disks_that_lean_in_turn_the_body_into_the_flow(angle):
    part = part_of(LeaningIn)
    flow = 2.0 * np.array([np.cos(angle), np.sin(angle), 0.0])
    force, moment = part.wrench(still(air=flow))
    # Of the flow, what is along the axes makes no force, on average over the rotors.
    share = 1.0 - 0.5 * np.sin(part.LEAN) ** 2
    assert force == pytest.approx(-part.coefficient * share * flow, abs=1e-12)
    arm = np.hypot(*PLACES[0, :2])
    lever = 0.5 * arm * np.sin(part.LEAN) * np.cos(part.LEAN)
    # Those in front are pressed down: a turn about what is to the left of the flow.
    left = np.array([-flow[1], flow[0], 0.0])
    assert moment == pytest.approx(part.coefficient * lever * left, abs=1e-12)


def test_each_force_is_in_the_plane_of_its_disk_and_half_of_it_by_the_thrust():
    part = part_of(LeaningIn)
    assert np.linalg.norm(part.axes, axis=1) == pytest.approx(np.ones(4))
    assert np.all(np.sum(part.axes * PLACES, axis=1) < 0.0)
    for rotor in range(4):
        alone = np.where(np.arange(4) == rotor, HOVER, 0.0)
        one, two = (part.wrench(still(air=np.array([1.0, 2.0, 0.5]), speeds=turn * alone))[0]
                    for turn in (1.0, 2.0))
        assert one @ part.axes[rotor] == pytest.approx(0.0, abs=1e-12)
        assert two == pytest.approx(3.0 * one) and np.linalg.norm(one) > 0.0
        # Flow along its axis drags nothing.
        assert part.wrench(still(air=part.axes[rotor], speeds=alone))[0] == pytest.approx(
            REST, abs=1e-12)


def test_aerials_bend_and_drag_with_less_than_the_square():
    part = part_of(BendingAerials)
    part.BODY = 0.0
    slow, twice, fast, faster = (
        part.wrench(still(air=np.array([0.0, speed, 0.0])))[0][1]
        for speed in (0.01, 0.02, 100.0, 200.0))
    assert slow == pytest.approx(-part.AERIALS * part.coefficient * 1e-4, rel=1e-3)
    assert twice / slow == pytest.approx(4.0, rel=1e-3)
    assert faster / fast == pytest.approx(2.0 ** (4.0 / 3.0), rel=1e-3)
    # Both meet where they bend.
    bends = part.wrench(still(air=np.array([part.BENDS, 0.0, 0.0])))[0][0]
    assert bends == pytest.approx(
        -part.AERIALS * part.coefficient * part.BENDS ** 2 / 2.0 ** (1.0 / 3.0))


def test_a_climb_flows_along_the_aerials():
    part = part_of(BendingAerials)
    for climb in (2.0, -2.0):
        force, moment = part.wrench(still(air=np.array([0.0, 0.0, climb])))
        assert force == pytest.approx([0.0, 0.0, -part.BODY * part.coefficient * 2.0 * climb])
        assert not np.any(moment)
    # Level flow bends them the same in a climb.
    part.BODY = 0.0
    level, askew = (part.wrench(still(air=np.array([2.0, -1.0, climb])))[0]
                    for climb in (0.0, 3.0))
    assert askew == pytest.approx(level) and np.linalg.norm(level) > 0.0


@pytest.mark.parametrize('seed', range(3))
def test_what_a_row_of_trees_takes_of_the_wind_stays_and_spreads(seed):
    wind = part_of(TreeRow, seed=seed)
    across = np.arange(0.0, wind.APART, 0.005)
    near, far = (np.array([wind.missing(along, one) for one in across]) for along in (3.0, 12.0))
    lacks = wind.SLOWER * wind.WIDENS * wind.TRUNKS * np.sqrt(np.pi / np.log(2.0)) / wind.APART
    assert near.mean() == pytest.approx(lacks, rel=1e-3)
    assert far.mean() == pytest.approx(lacks, rel=0.01)
    assert near.max() > 1.5 * far.max() and np.std(near) > 2.0 * np.std(far) > 0.0


def test_the_mean_along_the_row_is_the_mean_of_the_wind():
    wind = part_of(TreeRow)
    wind.SWINGS = 0.0
    places = np.arange(0.0, wind.APART, 0.01)[:, None] * wind.side
    air = np.array([wind.wind(2.0, place) for place in places])
    assert air.mean(axis=0) == pytest.approx(wind.mean, rel=2e-3)
    assert np.cross(air, wind.onto) == pytest.approx(np.zeros_like(air), abs=1e-12)
    # Slowest straight behind a trunk.
    behind = np.linalg.norm(wind.wind(2.0, wind.trunks[7] * wind.side))
    assert behind == pytest.approx(np.linalg.norm(air, axis=1).min(), rel=1e-3)


def test_a_wind_that_swings_takes_the_wakes_along():
    wind = part_of(TreeRow)
    turn = wind.SWINGS
    time = (0.5 * np.pi - wind.phase) / wind.rate
    place = np.tan(turn) * wind.away * wind.side
    swung, straight = wind.wind(time, place), wind.wind(time - 0.5 * np.pi / wind.rate, REST)
    assert np.linalg.norm(swung) == pytest.approx(np.linalg.norm(straight))
    angle = np.arctan2(swung @ wind.side, swung @ wind.onto)
    assert angle == pytest.approx(turn) and straight @ wind.side == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize('turn', [0.7, 1.0, 1.4])
def test_propellers_of_two_pitches_have_the_same_thrust_at_rest(turn):
    part = part_of(TwoPitches)
    assert part.gain(still(speeds=np.full(4, turn * HOVER))) == pytest.approx(
        np.ones(4))


@pytest.mark.parametrize('seed', range(4))
def test_little_pitch_loses_more_in_a_climb_and_gains_more_in_level_flight(seed):
    part = part_of(TwoPitches, seed=seed)
    low = part.pitches < np.mean(part.pitches)
    assert low.sum() == 2 and low[AHEAD].all() != low[~AHEAD].all()
    up = part.gain(still(air=np.array([0.0, 0.0, 0.5 * part.induced])))
    side = part.gain(still(air=np.array([2.0 * part.induced, 0.0, 0.0])))
    assert np.all(up < 1.0) and np.all(side > 1.0)
    ratio = (part.PITCHES[1] - 1.0) / (part.PITCHES[0] - 1.0)
    for gain in (up, side):
        assert 1.4 < np.mean(gain[low] - 1.0) / np.mean(gain[~low] - 1.0) < ratio


@pytest.mark.parametrize('across', [0.0, 1.5])
@pytest.mark.parametrize('climb', [-0.5, 0.0, 1.0])
def test_blades_and_momentum_agree_on_the_thrust(climb, across):
    part = part_of(TwoPitches)
    thrust = part.thrust(np.ones(4), np.full(4, climb), np.full(4, across))
    flow = part.pitches - climb - thrust * (part.pitches - 1.0)
    assert flow * np.hypot(across, climb + flow) == pytest.approx(thrust, rel=1e-6)


def test_the_image_of_a_cylinder_of_vortices_takes_all_inflow_on_the_ground():
    part = part_of(TwoLevels, 1.0)
    part.off = np.zeros(4)

    def takes(height):
        return part.law(np.full(4, height), None)[0] / part.GIVES

    assert takes(0.0) == pytest.approx(1.0, abs=0.01)
    # Far away, the square of the height over the radius.
    assert takes(50.0) * 50.0 ** 2 == pytest.approx(7.0 / 8.0, rel=1e-2)
    falls = np.diff([takes(height) for height in (0.2, 0.5, 1.0, 2.0, 4.0)])
    assert np.all(falls < 0.0)


def left_of(height):
    """Return what is left of the inflow, by the law of Biot and Savart over both cylinders."""
    depths = (np.arange(200000) + 0.5) * 2.0 * height / 200000
    rings = 0.5 * (1.0 + depths ** 2) ** -1.5
    own, image = rings[depths < height].sum(), rings[depths > height].sum()
    return 2.0 * (own - image) * 2.0 * height / 200000


@pytest.mark.parametrize('height', [0.5, 1.0, 3.0])
def test_what_is_left_of_the_inflow_is_that_of_rings_down_to_the_ground_and_of_their_image(height):
    part = part_of(TwoLevels, 1.0)
    part.off = np.zeros(4)
    assert 1.0 - part.law(np.full(4, height), None) / part.GIVES == pytest.approx(
        np.full(4, left_of(height)), abs=1e-4)


@pytest.mark.parametrize('seed', range(4))
def test_the_lower_end_has_more_of_the_ground(seed):
    part = part_of(TwoLevels, seed=seed)
    low = part.off < 0.0
    assert low.sum() == 2 and low[AHEAD].all() != low[~AHEAD].all()
    gain = part.gain(still(heights=np.full(4, 2.0 * RADIUS)))
    assert gain[low].min() > gain[~low].max() > 1.0
    # As high over ground as the others, it has as much.
    same = part.gain(still(heights=RADIUS * (2.0 - part.off)))
    assert same == pytest.approx(np.full(4, same[0]))
    assert part.gain(still(heights=np.full(4, 100.0 * RADIUS))) == pytest.approx(
        np.ones(4), abs=1e-4)


def packs():
    """Return a battery of the same case with each of its packs."""
    found = {}
    for seed in range(30):
        battery = UnlikeAges(2.0, PARAMS, np.random.default_rng(3))
        battery.begin(np.random.default_rng(seed))
        found[battery.resists] = battery
    return [found[resists] for resists in sorted(found)]


def test_each_flight_has_one_of_three_packs_and_the_older_ones_sag_more():
    used = packs()
    assert [battery.resists for battery in used] == [age[0] for age in UnlikeAges.AGES]
    assert len({tuple(battery.parameters.items()) for battery in used}) == 1
    sags = np.array([1.0 - drained(battery, np.ones(2000)) for battery in used])
    assert np.all(np.diff(sags, axis=0) > 0.0) and np.all(np.diff(sags, axis=1) > 0.0)


def test_a_pack_resists_at_once_and_within_seconds_by_its_age():
    for battery in packs():
        battery.FALLS = 0.0
        taken = (1.0 - drained(battery, np.ones(1500))) / battery.size / battery.resists
        since = 0.01 * np.arange(1, 1501)
        assert taken == pytest.approx(battery.RESISTS + battery.SLOWLY * (
            1.0 - np.exp(-since / battery.TIME)))
        # All of it comes back: what is resisted at once, and the rest later.
        back = 1.0 - drained(battery, np.zeros(1500))
        assert back[0] == pytest.approx(
            battery.size * battery.resists * battery.SLOWLY, rel=0.01)
        assert back[-1] < 1e-3 * back[0]


def test_the_charge_that_is_taken_stays_taken():
    battery = packs()[2]
    drained(battery, np.full(3000, 1.5 ** (1.0 / 3.0)))
    rest = 1.0 - drained(battery, np.zeros(3000))[-1]
    assert rest == pytest.approx(battery.size * 1.4 * 1.5 * battery.FALLS, rel=1e-3)


@pytest.mark.parametrize('turn', [0.4, 1.0, 1.6])
def test_a_motor_turns_by_its_rating_less_what_its_load_takes(turn):
    part = part_of(ByRating, 8.0)
    true = turn * np.sqrt(part.gain(still(speeds=np.full(4, turn * HOVER))))
    assert true + part.droops * true ** 2 == pytest.approx(np.full(4, turn))
    assert np.all(true < turn)


def test_fast_rotors_lack_more_and_none_is_like_another():
    part = part_of(ByRating)
    lacks = np.array([1.0 - part.gain(still(speeds=np.full(4, turn * HOVER)))
                      for turn in (0.5, 1.0, 1.5)])
    # To the first order in the droop, in proportion to the speed.
    assert lacks == pytest.approx(
        2.0 * np.outer([0.5, 1.0, 1.5], part.droops), rel=0.05)
    assert len(set(part.droops)) == 4
    assert np.abs(part.droops / 0.007 - 1.0).max() <= part.APART


STATE = np.array([0.4, -0.2, 1.3, 1.5, -0.8, 0.3, *Rotation.from_euler(
    'xyz', [0.2, -0.1, 0.7]).as_quat(), 0.3, -0.2, 0.1])


def seen(part, state, times):
    part.begin(None)
    return np.array([part.measured(t, state, 1.0) for t in times]) - state


def test_a_barometer_in_the_flow_errs_in_height_and_climb_alone():
    part = outside.Barometer(2.0, np.random.default_rng(1))
    times = np.arange(0.0, 3.0, 0.01)
    off = seen(part, STATE, times)
    assert not np.any(np.delete(off, [2, 5], axis=1))
    assert part.wrench(SimpleNamespace()) is None
    # The climb that it shows is that of the height that it shows.
    assert np.gradient(off[:, 2], 0.01)[1:-1] == pytest.approx(off[1:-1, 5], rel=2e-3, abs=1e-9)
    u, v, _ = Rotation.from_quat(STATE[6:10]).inv().apply(STATE[3:6])
    ahead, left = (part.shares[k, 0 if one > 0.0 else 1] for k, one in enumerate((u, v)))
    assert off[-1, 2] == pytest.approx(ahead * u ** 2 + left * v ** 2)


def test_each_side_of_it_has_its_own_share_and_rest_and_a_climb_have_none():
    part = outside.Barometer(2.0, np.random.default_rng(1))
    ends = []
    for velocity in np.vstack([np.eye(3)[:2], -np.eye(3)[:2], [[0.0, 0.0, 2.0], REST]]):
        state = np.array([0.0, 0.0, 1.0, *velocity, 0.0, 0.0, 0.0, 1.0, *REST])
        ends.append(seen(part, state, np.arange(0.0, 3.0, 0.01))[-1, 2])
    assert ends[:4] == pytest.approx([*part.shares[:, 0], *part.shares[:, 1]])
    assert len(set(np.round(ends[:4], 9))) == 4 and ends[4:] == [0.0, 0.0]
    assert np.ptp(np.sign(part.shares)) == 0.0 and np.abs(part.shares).max() <= 0.004
