# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of lags, delays, drag and wind that the twenty-fourth draw flies: what each does."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import HOVER, PARAMS, part_of, PLACES, REST, stepped, still

from withheld.constants import arm_length
from withheld.forms.bends import Bending
from withheld.forms.boosts import Boosted
from withheld.forms.cascades import Cascaded
from withheld.forms.facades import Facade
from withheld.forms.fans import Sweeping
from withheld.forms.fuselages import Slender
from withheld.forms.modems import HalfDuplex
from withheld.forms.observers import PhaseLocked
from withheld.forms.silhouettes import Projected


@pytest.mark.parametrize('kind', [PhaseLocked, Boosted])
def test_a_command_that_is_held_is_reached_and_is_the_same_in_one_step_or_in_many(kind):
    command = np.array([1.1, 0.9, 1.0, 1.2])
    assert stepped(kind(2.0, PARAMS, None), command)[-1] == pytest.approx(command, abs=1e-6)
    assert stepped(kind(2.0, PARAMS, None), 1.0) == pytest.approx(np.ones((2000, 4)))
    one = stepped(kind(2.0, PARAMS, None), command, 0.004, 0.04)[-1]
    many = stepped(kind(2.0, PARAMS, None), command, 0.0001, 0.04)[-1]
    assert one == pytest.approx(many, abs=1e-6 if kind is PhaseLocked else 5e-3)


def test_a_motor_that_is_seen_late_starts_with_the_whole_slope_and_swings_past():
    motor, step = PhaseLocked(2.0, PARAMS, None), 0.0005
    time = motor.parameters['time']
    turns = stepped(motor, 1.1, step)[:, 0]
    missing = (1.1 - turns) / 0.1
    # It is as late in the mean as its time says, by the trapezium from the step on.
    assert step * (0.5 + np.sum(missing)) == pytest.approx(time, rel=1e-3)
    gain = (1.0 - 2.0 * motor.DAMPING / motor.RATE) / time
    assert (1.0 - missing[3]) / (4.0 * step) == pytest.approx(gain, rel=0.01)
    # The same gain without the loop would only come near.
    assert -0.1 < missing.min() < -0.04
    k = int(np.argmax(missing < 0.0))
    assert missing[k - 1] < np.exp(-gain * step * k) and abs(missing[-1]) < 1e-6


def test_a_loop_that_is_far_faster_than_the_controller_leaves_a_lag_of_the_first_order():
    motor = PhaseLocked(2.0, PARAMS, None)
    motor.RATE = 400.0
    turns = stepped(motor, 1.1)[:, 0]
    since = 0.0005 * np.arange(1, len(turns) + 1)
    lag = motor.parameters['time']
    assert turns == pytest.approx(1.1 - 0.1 * np.exp(-since / lag), abs=5e-4)


def test_what_turns_the_body_has_the_whole_lag_and_the_throttle_leads():
    step, differ = 0.0005, 0.1 * np.array([1.0, -1.0, -1.0, 1.0])
    motor = Boosted(2.0, PARAMS, None)
    time, slow = motor.parameters['time'], motor.SLOW * motor.parameters['time']
    since = step * np.arange(1, 2001)[:, None]
    turns = stepped(motor, 1.0 + differ, step)
    assert turns == pytest.approx(1.0 + differ * (1.0 - np.exp(-since / time)), abs=1e-9)
    # Together, by the solution of the filter and the lag; it is less late and swings past.
    both = stepped(Boosted(2.0, PARAMS, None), 1.1 + differ, step)
    mean = both.mean(axis=1)
    boost = motor.BOOST * slow / (slow - time) * (np.exp(-since / slow) - np.exp(-since / time))
    assert mean == pytest.approx((1.1 + 0.1 * (boost - np.exp(-since / time)))[:, 0], abs=3e-4)
    assert both - mean[:, None] == pytest.approx(turns - 1.0, abs=1e-9)
    missed = step * (0.5 + np.sum(1.1 - mean) / 0.1)
    assert missed == pytest.approx(time - motor.BOOST * slow, rel=0.01) and missed < 0.4 * time
    assert 1.1 < mean.max() < 1.11


def test_a_boost_ends_at_the_whole_throttle():
    motor = Boosted(2.0, PARAMS, None)
    full = PARAMS['rotor_speed_max'] / HOVER
    turns = stepped(motor, full)[:, 0]
    since = 0.0005 * np.arange(1, len(turns) + 1)
    assert turns == pytest.approx(
        full - (full - 1.0) * np.exp(-since / motor.parameters['time']))
    assert stepped(Boosted(2.0, PARAMS, None), 0.05).min() >= 0.0


def test_a_modem_has_its_mean_delay_in_a_flight():
    line, waits = part_of(HalfDuplex), []
    for seed in range(60):
        line.begin(np.random.default_rng(seed))
        waits += [line.waits(t) for t in np.arange(0.0, 20.0, 0.0131)]
    assert np.mean(waits) == pytest.approx(line.delay, rel=0.05)
    assert np.min(waits) == pytest.approx(line.OWN * line.delay)
    assert np.max(waits) < 4.0 * line.delay


def test_in_ones_own_turn_a_command_goes_at_once_and_else_at_the_end_of_the_others():
    line = part_of(HalfDuplex)
    t = np.arange(0.0, 20.0, 0.0005)
    held = np.array([line.waits(one) for one in t]) - line.OWN * line.delay
    own = held < 1e-12
    leaves = t + held
    assert np.all(np.diff(leaves) > -1e-9) and 0.3 < own.mean() < 0.5
    # All of one of the other's turns leave together, as the own begins.
    groups = np.unique(leaves[~own].round(9))
    for end in groups[1:-1]:
        together = t[~own][np.abs(leaves[~own] - end) < 1e-8]
        assert np.ptp(together) == pytest.approx(end - together[0], abs=0.001)
    turns = np.diff(np.flatnonzero(np.diff(own.astype(int)))) * 0.0005
    one, other = (turns[k::2] for k in ((0, 1) if own[np.flatnonzero(np.diff(own))[0] + 1]
                                        else (1, 0)))
    share = np.mean(line.GROUND) / np.mean(line.VEHICLE)
    assert np.mean(one) / np.mean(other) == pytest.approx(share, rel=0.1)
    assert one.max() / one.min() < 1.1 * line.GROUND[1] / line.GROUND[0]


def test_turns_come_again_in_a_flight_that_is_longer_than_they_are():
    line = part_of(HalfDuplex, 1.0)
    again = (1.0 - line.OWN) * line.delay * line.begins[-1]
    for t in (0.0, 0.123, 7.7):
        assert line.waits(again + t) == pytest.approx(line.waits(t), abs=1e-6)


def sent(line, commands, step=0.002):
    """Return what a line gives (N, 4) on average over each step of commands (N, 4)."""
    given = []
    for k, command in enumerate(commands):
        parts = line.pass_on(step * k, command, step)
        assert sum(duration for duration, _ in parts) == pytest.approx(step)
        assert all(duration > 0.0 for duration, _ in parts)
        given.append(sum(duration * values for duration, values in parts) / step)
    return np.array(given)


@pytest.mark.slow
def test_in_a_cascade_what_turns_the_body_comes_first_and_evenly():
    line, step = part_of(Cascaded), 0.002
    t = step * np.arange(1000)[:, None]
    waves = 0.1 * np.sin(9.0 * t) * [1.0, -1.0, -1.0, 1.0]
    late = 0.1 * np.sin(9.0 * (t - line.TURNS * line.delay)) * [1.0, -1.0, -1.0, 1.0]
    given = sent(line, 1.0 + waves)[100:]
    assert given == pytest.approx(1.0 + late[100:], abs=0.1 * 9.0 * 1.01 * step)
    assert given.mean(axis=1) == pytest.approx(np.ones(900))


@pytest.mark.slow
def test_in_a_cascade_the_thrust_comes_late_and_in_steps():
    line, step = part_of(Cascaded), 0.002
    t = step * np.arange(1000)[:, None]
    given = sent(line, np.full((1000, 4), 1.0) + 0.1 * t)[200:]
    assert np.ptp(given, axis=1) == pytest.approx(np.zeros(800), abs=1e-12)
    rises = np.diff(given[:, 0])
    # Each new thrust comes as much after the one before, and holds all the time in between.
    comes = np.flatnonzero(rises > 1e-9)
    comes = comes[np.diff(comes, prepend=-9) > 1]
    assert step * np.mean(np.diff(comes)) == pytest.approx(line.every, rel=0.02)
    late = (1.0 + 0.1 * t[200:, 0] - given[:, 0]) / 0.1
    mean = (line.THRUST + 0.5 * line.EVERY) * line.delay
    assert late.mean() == pytest.approx(mean, abs=step)
    assert np.ptp(late) == pytest.approx(line.every, abs=2.0 * step)


def test_of_a_cascade_the_delay_of_the_thrust_is_that_of_its_outer_loop():
    line = part_of(Cascaded)
    t = np.arange(0.0, 5.0, 0.0007)
    leaves = t + np.array([line.waits(one) for one in t]) - line.THRUST * line.delay
    ticks = (leaves - line.first) / line.every
    assert ticks == pytest.approx(ticks.round(), abs=1e-6)
    waits = leaves - t
    assert waits.min() >= 0.0 and waits.max() <= line.every
    # The commands before the first have come are held as they were, whatever their mean.
    first = HOVER * np.array([1.2, 0.8, 1.0, 1.1])
    [(_, given)] = part_of(Cascaded).pass_on(0.0, first, 0.004)
    assert given == pytest.approx(first)


def test_stiff_blades_lean_as_the_solution_of_their_first_harmonic():
    part = part_of(Bending)
    for turn in (0.7, 1.0, 1.3):
        back, aside = part.leans(np.array([turn]))
        # b'' + n b' + (1 + s) b = n a sin(psi), over a turn, by what each harmonic is of.
        stiff, n = part.STIFF / turn ** 2, part.DAMPED
        behind, beside = np.linalg.solve([[stiff, n], [-n, stiff]], [0.0, n])
        one = np.linalg.solve([[part.STIFF, n], [-n, part.STIFF]], [0.0, n])[0]
        # The flow is over the speed of the tips, and the thrust with the square of that.
        assert back == pytest.approx([turn * behind / one]) and behind < 0.0
        assert aside == pytest.approx([-turn * beside / one]) and beside > 0.0
    soft = part_of(Bending)
    soft.STIFF = 0.0
    assert soft.leans(np.array([0.7, 1.3])) == (pytest.approx([0.7, 1.3]), pytest.approx([0, 0]))


def test_at_equal_speeds_what_is_aside_cancels_and_fast_rotors_drag_by_far_more():
    part = part_of(Bending)
    shares = []
    for turn in (0.8, 1.0, 1.2):
        now = still(air=np.array([2.0, 1.0, -0.5]), speeds=np.full(4, turn * HOVER))
        force, moment = part.wrench(now)
        assert force[1] / force[0] == pytest.approx(0.5) and force[2] == 0.0
        assert moment == pytest.approx(REST, abs=1e-12)
        shares.append(-force[0] / (2.0 * part.coefficient))
    assert shares[1] == pytest.approx(1.0)
    powers = np.diff(np.log(shares)) / np.diff(np.log([0.8, 1.0, 1.2]))
    assert 2.0 < powers.min() and powers.max() < 4.0


def test_a_rotor_that_turns_left_is_pushed_left_in_flight_ahead():
    part = part_of(Bending)
    lefts = part.spins > 0.0
    # The reaction of one that turns left is to the right, about the axis that points up.
    assert np.all(np.asarray(PARAMS['rotor_directions'])[lefts] < 0.0)
    speeds = HOVER * np.where(lefts, 1.1, 0.9)
    force, moment = part.wrench(still(air=np.array([2.0, 0.0, 0.0]), speeds=speeds))
    assert force[1] > 0.0 > force[0]
    aside = part.wrench(still(air=np.array([0.0, 2.0, 0.0]), speeds=speeds))[0]
    # The same wherever it flies to.
    assert aside == pytest.approx([-force[1], force[0], 0.0]) and moment[2] == pytest.approx(0.0)
    ahead = part.wrench(still(air=np.array([2.0, 0.0, 0.0]), speeds=HOVER * np.where(
        PLACES[:, 1] > 0.0, 1.1, 0.9)))
    # Those on the left drag by more, which turns it to the left.
    assert ahead[1][2] > 0.0


def test_an_ellipsoid_drags_along_the_flow_by_the_area_that_it_shows():
    part = part_of(Projected)
    axes = (np.diag(1.0 / np.array(part.AREAS)) @ part.areas).T
    assert axes @ axes.T == pytest.approx(np.eye(3))
    assert Rotation.from_matrix(axes).magnitude() <= np.sqrt(3.0) * part.ASKEW
    for axis, area in zip(axes.T, part.AREAS, strict=True):
        force, moment = part.wrench(still(air=2.0 * axis))
        assert force == pytest.approx(-4.0 * part.coefficient * area * axis)
        assert not np.any(moment)
    # The area by points: an ellipsoid whose areas along its axes, over pi, are those of the part.
    one, two, three = part.AREAS
    halves = np.sqrt(one * two * three) / np.array(part.AREAS)
    for flow in np.random.default_rng(2).normal(size=(4, 3)):
        flow /= np.linalg.norm(flow)
        side = np.cross(flow, [1.0, 0.0, 0.0])
        side /= np.linalg.norm(side)
        across = np.stack([side, np.cross(flow, side)])
        angles = np.linspace(0.0, 2.0 * np.pi, 20001)
        ways = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ across
        # What is farthest out on each way bounds what is seen: its support, and the area of that.
        support = np.linalg.norm(halves[:, None] * (axes.T @ ways.T), axis=0)
        slopes = np.gradient(support, angles, edge_order=2)
        area = 0.5 * np.trapezoid(support ** 2 - slopes ** 2, angles) / np.pi
        force = part.wrench(still(air=3.0 * flow))[0]
        assert force == pytest.approx(-9.0 * part.coefficient * area * flow, rel=1e-4)


def test_a_slender_pod_drags_little_along_and_much_across():
    part = part_of(Slender)
    side = np.cross(part.axis, [0.0, 0.0, 1.0])
    side /= np.linalg.norm(side)
    assert part.axis[0] > np.cos(1.5 * part.ASKEW)
    for flow, share in ((part.axis, part.ALONG), (-part.axis, part.ALONG), (side, part.ACROSS)):
        force, moment = part.wrench(still(air=3.0 * flow))
        assert force == pytest.approx(-9.0 * part.coefficient * share * flow)
        assert moment == pytest.approx(REST, abs=1e-12)
    # What is across is as it is without what is along.
    force, _ = part.wrench(still(air=4.0 * part.axis + 2.0 * side))
    assert force == pytest.approx(-part.coefficient * (
        16.0 * part.ALONG * part.axis + 4.0 * part.ACROSS * side))


def test_a_slender_pod_turns_its_side_to_the_flow_and_takes_no_energy_of_still_air():
    part = part_of(Slender)
    part.axis = np.array([1.0, 0.0, 0.0])
    wide = part.WIDE * arm_length(PARAMS)
    # Flight ahead and to the left turns the nose to the right; a climb ahead turns it down.
    for angle in (0.1, 0.25 * np.pi, 0.4 * np.pi):
        most = 0.5 * 9.0 * np.sin(2.0 * angle) * (
            part.TAKES * wide * part.ACROSS * part.coefficient)
        ahead, off = 3.0 * np.cos(angle), 3.0 * np.sin(angle)
        assert part.wrench(still(air=np.array([ahead, off, 0.0])))[1] == pytest.approx(
            [0.0, 0.0, -most])
        assert part.wrench(still(air=np.array([ahead, 0.0, off])))[1] == pytest.approx(
            [0.0, most, 0.0])
    for air in np.random.default_rng(1).normal(size=(50, 3)):
        force, moment = part.wrench(still(air=air))
        assert force @ air < 0.0 and moment @ air == pytest.approx(0.0, abs=1e-12)
        back, same = part.wrench(still(air=-air))
        assert back == pytest.approx(-force) and same == pytest.approx(moment)


@pytest.mark.parametrize('seed', range(4))
def test_a_fan_that_sweeps_is_its_mean_in_the_middle_and_stronger_as_it_looks_there(seed):
    wind = part_of(Sweeping, seed=seed)
    middle = np.array([0.0, 0.0, wind.place[2]])
    times = 2.0 * np.pi / wind.rate * np.linspace(0.0, 1.0, 2000, endpoint=False)
    air = np.array([wind.wind(t, middle) for t in times])
    assert air.mean(axis=0) == pytest.approx(wind.mean, rel=1e-3)
    assert np.cross(air, wind.mean) == pytest.approx(np.zeros_like(air), abs=1e-9)
    speeds = np.linalg.norm(air, axis=1)
    assert speeds.max() == pytest.approx(wind.most, rel=1e-3) and wind.most < 3.0 * speeds.mean()
    # It looks there twice in each period, and is fastest then.
    assert np.sum((speeds > np.roll(speeds, 1)) & (speeds > np.roll(speeds, -1))) == 2
    assert speeds.min() == pytest.approx(
        wind.most * np.exp(-(wind.SWINGS / wind.WIDE) ** 2), rel=1e-3)


def test_a_jet_widens_slows_down_and_comes_later_farther_away():
    wind = part_of(Sweeping)
    onto = np.array([np.cos(wind.onto), np.sin(wind.onto), 0.0])
    times, peaks, when = np.arange(0.0, 12.0, 0.002), [], []
    for far in (0.5, 1.0, 1.5):
        speeds = np.array([np.linalg.norm(wind.wind(t, wind.place + far * wind.away * onto))
                           for t in times])
        peaks.append(speeds.max())
        tops = np.flatnonzero((speeds[1:-1] > speeds[:-2]) & (speeds[1:-1] > speeds[2:]))
        when.append(times[tops[tops > 1200][0] + 1] % (np.pi / wind.rate))
    assert peaks == pytest.approx(wind.most * np.array([2.0, 1.0, 2.0 / 3.0]), rel=1e-3)
    late = np.diff(when) % (np.pi / wind.rate)
    assert late == pytest.approx(wind.LATE * np.diff([0.25, 1.0, 2.25]), abs=0.01)
    # As far off the axis, by the angle, it is the same above and beside; near it, no faster.
    still_fan = part_of(Sweeping)
    still_fan.rate, still_fan.phase = 0.0, 0.0
    up = still_fan.place + 2.0 * (np.cos(0.3) * onto + np.sin(0.3) * np.array([0.0, 0.0, 1.0]))
    side = still_fan.place + 2.0 * np.array(
        [np.cos(wind.onto + 0.3), np.sin(wind.onto + 0.3), 0.0])
    speeds = [np.linalg.norm(still_fan.wind(0.0, one)) for one in (up, side)]
    assert speeds[0] == pytest.approx(speeds[1])
    assert speeds[0] == pytest.approx(wind.most * wind.away / 2.0 * np.exp(
        -(0.3 / wind.WIDE) ** 2))
    near = [np.linalg.norm(still_fan.wind(0.0, still_fan.place + far * onto))
            for far in (0.2, wind.NEAR)]
    assert near[0] == pytest.approx(near[1])


@pytest.mark.parametrize('seed', range(6))
def test_air_before_a_front_is_neither_squeezed_nor_turned_and_passes_no_wall(seed):
    wind, step = part_of(Facade, seed=seed), 1e-5
    assert wind.wind(0.0, REST) == pytest.approx(wind.mean)
    for place in np.random.default_rng(1).uniform(-1.0, 1.0, (10, 3)) + [0.0, 0.0, 1.2]:
        slopes = np.array([(wind.wind(3.0, place + step * axis) - wind.wind(
            3.0, place - step * axis)) / (2.0 * step) for axis in np.eye(3)])
        assert np.trace(slopes) == pytest.approx(0.0, abs=1e-6)
        assert slopes == pytest.approx(slopes.T, abs=1e-6)
    for aside in (-1.0, 2.0):
        wall = wind.away * wind.onto + aside * wind.aside + [0.0, 0.0, 1.0]
        assert wind.wind(0.0, wall) @ wind.onto == pytest.approx(0.0, abs=1e-9)
        assert wind.wind(0.0, wall + wind.onto) @ wind.onto == pytest.approx(0.0, abs=1e-9)
    assert wind.wind(0.0, np.array([0.3, -0.7, 0.0]))[2] == 0.0


def test_air_slows_down_before_a_front_and_parts_aside_and_up():
    wind = part_of(Facade)

    def at(left, off, high):
        place = (wind.away - left) * wind.onto + (off - wind.off) * wind.aside
        air = wind.wind(0.0, place + [0.0, 0.0, high])
        return np.array([air @ wind.onto, air @ wind.aside, air[2]])

    assert at(0.0, 0.0, 0.0) == pytest.approx(REST, abs=1e-12)      # where it stagnates
    assert np.all(at(wind.away, 0.0, 1.0)[[0, 2]] > 0.0)
    assert at(2.0, 0.0, 0.0)[0] == pytest.approx(2.0 * at(1.0, 3.0, 1.0)[0])
    assert 0.0 < at(1.0, 1.0, 1.0)[1] == pytest.approx(-at(2.0, -1.0, 0.0)[1])
    assert at(1.0, 0.0, 2.0)[2] == pytest.approx(2.0 * at(3.0, 1.0, 1.0)[2])
    far = wind.FAR * wind.away
    assert at(far + 3.0, 0.0, 0.0) == pytest.approx(at(far, 0.0, 0.0))
