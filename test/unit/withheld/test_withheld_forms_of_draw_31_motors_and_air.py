# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of lags, drag, wind, thrust and batteries of ordinary vehicles: what each does."""

from types import SimpleNamespace

import numpy as np
import pytest
from withheld_parts import HOVER, PARAMS, part_of, PLACES, RADIUS, REST, STATE, stepped, still

from withheld import outside
from withheld.forms.bests import BestBetween
from withheld.forms.boardwalks import Boardwalk
from withheld.forms.converters import LatencyTimer
from withheld.forms.currents import ConstantTorque
from withheld.forms.doubles import InPairs
from withheld.forms.halves import PackPerEnd
from withheld.forms.lags import HingedBlades
from withheld.forms.lanes import Lanes
from withheld.forms.passes import PerPass
from withheld.forms.sprayers import SprayBoom


def test_a_command_that_is_held_is_reached_and_is_the_same_in_one_step_or_in_many():
    command = np.array([1.1, 0.9, 1.0, 1.2])
    assert stepped(part_of(PerPass), command, seconds=0.5)[-1] == pytest.approx(command, abs=1e-4)
    assert stepped(part_of(PerPass), 1.0, seconds=0.5) == pytest.approx(np.ones((1000, 4)))
    one, many = (stepped(part_of(PerPass), command, step, 0.03)[-1] for step in (0.0005, 0.0001))
    assert one == pytest.approx(many, abs=8e-3)


def test_a_program_that_smooths_at_each_pass_is_late_by_its_time_on_average():
    step, late = 0.0005, []
    for seed in range(120):
        motor = part_of(PerPass, seed=seed)
        late.append(step * np.sum(1.0 - (stepped(motor, 1.1, step, 0.5)[:, 0] - 1.0) / 0.1))
    assert np.mean(late) == pytest.approx(PerPass(2.0, PARAMS, None).parameters['time'], rel=0.06)
    # Some of them by much more than others, as they are busy.
    assert np.percentile(late, 90) > 1.5 * np.percentile(late, 10)


def test_each_pass_goes_half_of_what_is_missing_and_takes_longer_while_it_is_busy():
    motor = part_of(PerPass)
    motor.OWN = 0.0
    missing = 1.0 - (stepped(motor, 1.1, 0.0001, 0.5)[:, 0] - 1.0) / 0.1
    levels = np.unique(missing[missing > 1e-3].round(9))[::-1]
    assert levels[:6] == pytest.approx(0.5 ** np.arange(6), abs=1e-6)
    lasts = []
    for time in np.arange(0.0, 60.0, 0.01):
        motor._time = time
        lasts.append(motor.lasts())
    assert set(np.round(lasts, 9)) == set(np.round(
        motor.mean * (1.0 + motor.APART * np.array([-1.0, 1.0])), 9))
    assert np.mean(lasts) == pytest.approx(motor.mean, rel=0.1)


@pytest.mark.parametrize('size', [0.5, 1.0, 3.0])
def test_a_converter_hands_on_when_its_timer_is_over_or_its_buffer_full(size):
    line = part_of(LatencyTimer, size)
    times = np.arange(0.0, 60.0, 0.00137)
    waits = np.array([line.waits(t) for t in times])
    own = line.OWN * line.delay
    assert waits.mean() == pytest.approx(line.delay, rel=0.03)
    assert own < waits.min() and waits.max() <= own + line.timer
    # Nothing overtakes, and what waits goes at the times at which it hands on.
    comes = times + waits - own
    assert np.all(np.diff(comes) > -1e-9)
    known = line.times[np.searchsorted(line.times, comes - 1e-7)]
    assert comes == pytest.approx(known, abs=1e-9)


def test_its_timer_is_about_the_usual_one_and_a_full_buffer_ends_the_other_gaps():
    line = part_of(LatencyTimer, 1.0)
    assert line.timer == pytest.approx(0.0167, abs=1e-4)
    gaps = np.diff(line.times) / line.timer
    soon, late = line.FILLS
    assert gaps.max() == pytest.approx(1.0) and gaps.min() >= soon
    assert np.mean(gaps > 1.0 - 1e-9) == pytest.approx((late - 1.0) / (late - soon), rel=0.05)


def pull(part, speed, turn=1.0):
    """Return the drag of level flow along x, over the coefficient and the turn of the rotors."""
    now = still(air=np.array([speed, 0.0, 0.0]), speeds=np.full(4, turn * HOVER))
    return -part.wrench(now)[0][0] / (part.coefficient * turn)


def test_hinges_hand_on_all_of_a_small_force_and_a_part_of_what_is_beyond():
    part = part_of(HingedBlades)
    for speed in (0.3, 1.0, part.HOLDS):
        assert pull(part, speed) == pytest.approx(speed)
    for speed in (2.0, 5.0):
        assert pull(part, speed) == pytest.approx(
            part.HOLDS + (1.0 - part.FREES) * (speed - part.HOLDS))
    # Fast blades pull harder, so that their hinges slip at less flow.
    assert pull(part, 0.9, 1.2) == pytest.approx(0.9)
    assert pull(part, 1.0, 1.2) < 1.0


def test_hinged_blades_drag_against_the_flow_and_not_in_a_climb():
    part = part_of(HingedBlades)
    force, moment = part.wrench(still(air=np.array([1.5, -2.0, 3.0])))
    assert force[2] == 0.0 and force[:2] @ [2.0, 1.5] == pytest.approx(0.0, abs=1e-12)
    assert force[:2] @ [1.5, -2.0] < 0.0 and moment == pytest.approx(REST, abs=1e-12)
    force, moment = part.wrench(still(rate=np.array([0.0, 0.0, 2.0])))
    assert force == pytest.approx(REST, abs=1e-12) and moment[2] < 0.0


def test_a_boom_drags_ahead_and_upwards_and_the_body_alone_aside():
    part, flow = part_of(SprayBoom), 2.0
    for axis, share in enumerate((part.BOOM + part.BODY, part.BODY, part.BOOM + part.BODY)):
        for side in (-1.0, 1.0):
            force, moment = part.wrench(still(air=side * flow * np.eye(3)[axis]))
            assert force == pytest.approx(
                -side * share * part.coefficient * flow ** 2 * np.eye(3)[axis])
            assert moment == pytest.approx(REST, abs=1e-12)


def test_the_tips_of_a_boom_brake_turns_but_not_one_about_itself():
    part, rate = part_of(SprayBoom), 3.0
    reach = part.REACH * np.linalg.norm(PLACES[0])
    # The mean of the cube of the way along it, by its square.
    most = part.BOOM * part.coefficient * rate ** 2 * reach ** 3 / 4.0
    for axis, brakes in enumerate((most, 0.0, most)):
        force, moment = part.wrench(still(rate=rate * np.eye(3)[axis]))
        assert force == pytest.approx(REST, abs=1e-12)
        assert moment == pytest.approx(-brakes * np.eye(3)[axis], rel=0.02, abs=1e-12)


def test_a_turn_in_flight_drags_at_the_side_that_is_ahead():
    part = part_of(SprayBoom)
    ahead = np.array([2.0, 0.0, 0.0])
    straight = part.wrench(still(air=ahead))[0][0]
    # A turn to the left takes the right tip ahead: more drag in all, and back to the right.
    force, moment = part.wrench(still(air=ahead, rate=np.array([0.0, 0.0, 1.0])))
    assert force[0] < straight < 0.0 and moment[2] < 0.0


@pytest.mark.parametrize('seed', range(3))
def test_the_wind_is_the_mean_over_all_lanes_and_goes_along_with_them(seed):
    wind = part_of(Lanes, seed=seed)
    ways = np.arange(0.0, wind.APART, 0.01)
    air = np.array([wind.wind(3.0, way * wind.side + [0.0, 0.0, 1.5]) for way in ways])
    assert air.mean(axis=0) == pytest.approx(wind.mean, abs=1e-9)
    along = air @ wind.onto
    assert np.ptp(along) == pytest.approx(2.0 * wind.FASTER * wind.fast, rel=1e-3)
    assert air @ wind.side == pytest.approx(np.zeros(len(ways)), abs=1e-12)
    # What is fast comes down.
    assert air[:, 2] == pytest.approx(
        -wind.SINKS / wind.FASTER * (along - wind.fast), abs=1e-12)


def test_the_wind_carries_the_bends_along_and_nothing_goes_through_the_ground():
    wind = part_of(Lanes)
    place = np.array([0.4, -0.3, 0.0])
    assert wind.wind(2.0, place)[2] == 0.0
    for later in (0.7, 4.0):
        carried = place + later * wind.mean
        assert wind.wind(2.0 + later, carried) == pytest.approx(wind.wind(2.0, place))
    # A lane stays where a bend is by a whole length further on.
    assert wind.lane(2.0, place + wind.length * wind.onto) == pytest.approx(
        wind.lane(2.0, place))
    along = [wind.lane(2.0, place + share * wind.length * wind.onto)
             for share in np.arange(0.0, 1.0, 0.05)]
    assert np.ptp(along) > 0.5


def settled(part, now, seconds=3.0):
    """Return the factors at once and once the rotors have settled."""
    first = part.gain(now)
    for _ in range(round(seconds / 0.01)):
        part.gain(now)
        part.after(0.01, np.eye(3), REST)
    return first, part.gain(now)


@pytest.mark.parametrize('climb', [-0.4, 0.5])
def test_rotors_at_a_torque_slow_down_in_a_climb_and_lose_still_more(climb):
    part = part_of(ConstantTorque)
    assert part.gain(still()) == pytest.approx(np.ones(4), abs=1e-6)
    now = still(air=np.array([0.0, 0.0, climb * part.induced]))
    first, last = settled(part, now)
    assert np.all(np.sign(climb) * (1.0 - first) > 0.0)
    assert np.all(np.abs(last - 1.0) > 1.15 * np.abs(first - 1.0))
    assert np.all(np.sign(climb) * (1.0 - part._fast) > 0.0)
    assert np.ones(4) * part.torque(now) == pytest.approx(np.ones(4))
    # Level flight is as a sink, without the sink.
    first, last = settled(part_of(ConstantTorque), still(air=np.array([6.0, 0.0, 0.0])))
    assert np.all(1.0 < first) and np.all(first < last)


@pytest.mark.parametrize('across', [0.0, 1.5])
@pytest.mark.parametrize('climb', [-0.4, 0.0, 1.0])
def test_settled_rotors_have_the_torque_and_the_momentum_of_their_thrust(climb, across):
    part = part_of(ConstantTorque, 1.0)
    part.SHARE = 1.0
    thrust = settled(part, still(air=part.induced * np.array([across, 0.0, climb])))[1][0]
    fast = part._fast[0]
    through = part.PITCH * fast - thrust * (part.PITCH - 1.0) / fast
    assert (through - climb) * np.hypot(across, through) == pytest.approx(thrust, rel=1e-4)
    # The torque is the power by the speed: what the thrust takes, and the drag of the blades.
    power = part.INDUCED * thrust * through + (1.0 - part.INDUCED) * fast ** 3
    assert power / fast == pytest.approx(1.0, rel=1e-4)


def test_a_strip_takes_all_the_view_from_low_and_less_from_high_or_aside():
    part = part_of(Boardwalk)
    half = 0.5 * part.WIDE
    assert part.view(0.0, 1e-4) == pytest.approx(1.0, abs=1e-6)
    # As wide as it is high above its middle: the sine of the angle to its edge.
    assert part.view(0.0, half) == pytest.approx(np.sqrt(0.5))
    assert part.view(half, 1e-4) == pytest.approx(0.5, abs=1e-3)
    assert part.view(2.0 * half, 1e-4) == pytest.approx(0.0, abs=1e-6)
    assert part.view(2.0 * half, half) == pytest.approx(part.view(-2.0 * half, half))
    # Two strips side by side take what one does that is as wide.
    left, right = part.view(-half, 0.3), part.view(half, 0.3)
    part.WIDE = 4.0 * half
    assert left + right == pytest.approx(part.view(0.0, 0.3))


@pytest.mark.parametrize('seed', range(4))
def test_rotors_over_the_boardwalk_have_more_than_those_over_the_water(seed):
    part = part_of(Boardwalk, seed=seed)

    def gain(away, height):
        place = (part.middle + away) * part.side + [0.0, 0.0, height]
        return part.gain(still(position=place, heights=np.full(4, height)))

    edge = gain(0.5 * part.WIDE, 1.5 * RADIUS)
    over = PLACES @ part.side < 0.0
    assert edge[over].min() > edge[~over].max() > 1.0
    assert gain(0.0, 1.5 * RADIUS).min() > edge.max()
    assert gain(3.0, 1.5 * RADIUS).max() < 1.0 + 0.1 * (edge.max() - 1.0)
    assert gain(0.0, 10.0) == pytest.approx(np.ones(4), abs=1e-4)
    assert part.ASIDE[0] <= part.middle <= part.ASIDE[1]


def drained(battery, turns, seconds=20.0, step=0.01):
    """Return the factors (N, 4) after each step of rotors at turns (4,)."""
    gains = []
    for k in range(round(seconds / step)):
        battery.drain(step * k, step, np.asarray(turns, float))
        gains.append(battery.gain(turns))
    return np.array(gains)


@pytest.mark.parametrize('seed', range(4))
def test_the_end_of_the_older_pack_sinks_more_and_more(seed):
    battery = part_of(PackPerEnd, seed=seed)
    gains = drained(battery, np.ones(4))
    [old] = [end for end in battery.ends if end[np.argmin(gains[-1])]]
    assert old.sum() == 2 and np.ptp(PLACES[old, 0]) == 0.0
    apart = gains[:, ~old].mean(axis=1) - gains[:, old].mean(axis=1)
    assert np.all(apart > 0.0) and np.all(np.diff(apart) > 0.0)
    lacks = 1.0 - battery.ratios
    assert np.sort(lacks) == pytest.approx(2.0 * np.array([
        0.8 * 0.008 + 0.9 * 0.008 * 20.0 / 30.0, 1.3 * 0.008 + 1.2 * 0.008 * 20.0 / 30.0]))
    assert battery.ratio == pytest.approx(np.mean(battery.ratios))


def test_each_pack_has_the_load_of_its_own_rotors():
    end = part_of(PackPerEnd).ends[0]
    turns = np.where(end, 1.2, 0.9)
    loaded, calm = part_of(PackPerEnd), part_of(PackPerEnd)
    drained(loaded, turns), drained(calm, np.full(4, 0.9))
    assert loaded.ratios[1] == pytest.approx(calm.ratios[1])
    assert (1.0 - loaded.ratios[0]) / (1.0 - calm.ratios[0]) == pytest.approx((1.2 / 0.9) ** 3)


def test_no_rotor_of_six_is_at_both_ends_and_either_end_may_be_the_older_one():
    angles = np.radians([30, 90, 150, 210, 270, 330])
    six = {'rotor_pos': {k: np.array([np.cos(a), np.sin(a), 0.0]) for k, a in enumerate(angles)}}
    battery = PackPerEnd(1.0, six, np.random.default_rng(1))
    assert battery.ends.sum(axis=0).tolist() == [1] * 6
    assert battery.ends.sum(axis=1).tolist() == [3, 3]
    assert len({part_of(PackPerEnd, seed=seed).resists[0] for seed in range(8)}) == 2


@pytest.mark.parametrize('seed', range(3))
def test_a_propeller_is_best_at_its_own_speed_and_loses_torque_only_as_it_bends(seed):
    part = part_of(BestBetween, seed=seed)
    best = still(speeds=part.best * HOVER)
    assert part.gain(best) == pytest.approx(np.ones(4))
    assert len(set(part.best)) == 4 and len(set(part.best > 1.0)) == 1
    away = np.abs(part.best - 1.0)
    assert part.AWAY[0] <= away.min() and away.max() <= part.AWAY[1]
    slow, fast = (still(speeds=(part.best + off) * HOVER) for off in (-0.3, 0.3))
    assert part.gain(slow) == pytest.approx(np.full(4, 1.0 - 2.0 * part.VISCOUS * 0.09))
    assert part.torque(slow) == pytest.approx(np.ones(4))
    assert part.gain(fast) == pytest.approx(np.full(4, 1.0 - 2.0 * part.BENDS * 0.09))
    assert part.torque(fast) == pytest.approx(part.gain(fast))


def test_in_hover_all_rotors_lack_some_and_none_loses_everything():
    part = part_of(BestBetween)
    lacks = 1.0 - part.gain(still())
    assert np.all(lacks > 0.0) and np.mean(lacks) == pytest.approx(part.parameters['lost'])
    assert len({part_of(BestBetween, seed=seed).best[0] > 1.0 for seed in range(8)}) == 2
    strong = part_of(BestBetween, 30.0)
    for turn in (0.0, 3.0):
        assert np.all(strong.gain(still(speeds=np.full(4, turn * HOVER))) > 0.15)


def test_the_wake_covers_all_of_the_lower_disk_in_hover_and_none_of_it_in_fast_flight():
    part = part_of(InPairs)
    assert part.covered(np.zeros(4), np.ones(4)) == pytest.approx(np.ones(4))
    fast = np.full(4, 4.0 * part.induced)
    assert part.covered(fast, np.ones(4)) == pytest.approx(np.zeros(4))
    # Of circles that are apart by their radius, the known share of the area is in both.
    both = 2.0 / 3.0 - np.sqrt(3.0) / (2.0 * np.pi)
    ratio = 1.0 / part.GAP      # of the velocity to the induced one, there
    across = part.induced * ratio * (1.0 + ratio ** 2) ** -0.25
    assert part.covered(np.full(4, across), np.ones(4)) == pytest.approx(np.full(4, both))
    # Rotors that turn faster send their wake down faster.
    assert np.all(part.covered(np.full(4, across), np.full(4, 1.3)) > both)


def test_pairs_tilt_the_body_back_by_more_than_the_velocity_until_the_wake_is_swept_off():
    part, tilts = part_of(InPairs), []
    for speed in (0.01, 2.0, 20.0):
        force, moment = part.wrench(still(air=np.array([speed, 0.0, 0.0])))
        assert not np.any(force) and moment[[0, 2]] == pytest.approx([0.0, 0.0], abs=1e-12)
        tilts.append(moment[1] / speed)
    assert tilts[0] == pytest.approx(part.moment * (1.0 - 0.5 * part.COVERS), rel=0.01)
    assert tilts[0] < tilts[1] < tilts[2] == pytest.approx(part.moment)
    moment = part.wrench(still(air=np.array([0.0, 2.0, 5.0])))[1]
    assert moment == pytest.approx([-2.0 * tilts[1], 0.0, 0.0], abs=1e-12)


def test_a_pilot_corrects_about_one_axis_to_one_side_and_back_with_less():
    part = outside.Sticks(2.0, 5.0, 0.1, np.random.default_rng(1))
    part.begin(np.random.default_rng(2))
    for begin, last, most in zip(part.begins[:20], part.lasts, part.moments, strict=False):
        moments = np.array([part.wrench(SimpleNamespace(time=begin + share * last))[1]
                            for share in (0.0, 0.25, 0.5, 0.75, 1.0)])
        assert np.count_nonzero(most) == 1 and np.abs(most).max() <= part.most
        assert moments == pytest.approx(np.outer([0.0, 1.0, 0.0, -part.BACK, 0.0], most),
                                        abs=1e-9)
    assert {int(np.argmax(np.abs(one))) for one in part.moments} == {0, 1, 2}


def test_between_corrections_the_sticks_rest_and_they_push_nowhere():
    part = outside.Sticks(2.0, 5.0, 0.1, np.random.default_rng(1))
    part.begin(np.random.default_rng(2))
    assert np.all(part.begins[1:] >= (part.begins + part.lasts)[:-1] + part.PAUSE[0])
    active = []
    for time in np.arange(0.0, 30.0, 0.01):
        force, moment = part.wrench(SimpleNamespace(time=time))
        assert not np.any(force)
        active.append(bool(np.any(moment)))
    assert 0.15 < np.mean(active) < 0.45
    assert not any(active[:int(100.0 * part.begins[0])])
    assert part.begins[-1] > 60.0


def test_from_a_boat_the_place_swings_and_the_velocity_goes_with_it():
    part = outside.MovingBase(2.0, np.random.default_rng(1))
    part.begin(np.random.default_rng(2))
    state, times = np.arange(1.0, 14.0), np.arange(0.0, 60.0, 0.01)
    off = np.array([part.measured(time, state, 1.0) for time in times]) - state
    assert not np.any(off[:, 6:])
    assert np.gradient(off[:, :3], 0.01, axis=0)[1:-1] == pytest.approx(off[1:-1, 3:6], abs=1e-3)
    # Two waves, which add up to twice the acceleration of each at most; the sway is half of it.
    pull = np.abs(np.gradient(off[:, 3:6], 0.01, axis=0))[1:-1]
    assert 0.3 < pull[:, 2].max() <= 0.601
    assert np.linalg.norm(pull[:, :2], axis=1).max() <= 0.301
    assert abs(off[:, 2].mean()) < 0.2 * np.abs(off[:, 2]).max()


def test_a_boat_that_lies_still_hides_nothing():
    part = outside.MovingBase(0.0, np.random.default_rng(1))
    part.begin(np.random.default_rng(2))
    assert np.array_equal(part.measured(3.0, STATE, 1.0), STATE)
