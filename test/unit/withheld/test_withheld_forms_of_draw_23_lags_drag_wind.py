# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of lags, delays, drag and wind that the twenty-third draw flies: what each does."""


import numpy as np
import pytest
from scipy.optimize import brentq
from withheld_parts import HOVER, PARAMS, part_of, REST, stepped, still

from withheld.forms.alleys import Alley
from withheld.forms.lulls import Lulled
from withheld.forms.ramps import Averaged, Ramped
from withheld.forms.reliefs import Relieved
from withheld.forms.segments import Coalesced, Throttled
from withheld.forms.skids import Skidded
from withheld.forms.wings import Winged


def flown(part, *air):
    """Return the force of a part that flies level at a velocity, over its coefficient."""
    force, moment = part.wrench(still(air=np.array(air)))
    assert not np.any(moment)
    return force / part.coefficient


@pytest.mark.parametrize('kind', [Averaged, Ramped])
def test_a_command_that_is_held_is_reached_and_kept(kind):
    motor = kind(2.0, PARAMS, None)
    assert stepped(motor, 1.0)[:, 0] == pytest.approx(np.ones(2000))
    for end in (1.2, 0.8):
        assert stepped(kind(2.0, PARAMS, None), end)[-1, 0] == pytest.approx(end, abs=1e-6)


@pytest.mark.parametrize('before', [0, 3, 7])
def test_a_mean_of_the_window_before_is_late_by_the_mean_time_wherever_the_step_is(before):
    motor, step = Averaged(3.0, PARAMS, None), 0.0005
    motor.window = 20 * step
    for _ in range(before):
        motor.turn(np.full(4, HOVER), np.full(4, HOVER), step)
    turns = stepped(motor, 1.1, step)[:, 0]
    own = motor.OWN * motor.parameters['time']
    # Of the first step the mean is of what came before as well; each sample is seen at its end.
    assert step * np.sum(1.1 - turns) / 0.1 == pytest.approx(motor.window + own, abs=1.1 * step)


def test_a_peak_counts_in_the_mean_of_its_window_alone_by_how_long_it_lasts():
    motor, step = Averaged(3.0, PARAMS, None), 0.0005
    motor.window = 20 * step
    one, more = np.full(4, HOVER), HOVER * np.array([1.2, 1.0, 0.8, 1.0])
    goals = []
    for k in range(60):
        motor.turn(one, more if 25 <= k < 30 else one, step)
        goals.append(motor._goal / HOVER)
    assert goals[18] == pytest.approx(np.ones(4)) and goals[38] == pytest.approx(np.ones(4))
    assert goals[39] == pytest.approx(1.0 + 0.25 * np.array([0.2, 0.0, -0.2, 0.0]))
    assert goals[59] == pytest.approx(np.ones(4))


def test_a_bounded_rise_grows_with_the_speed_and_a_fall_is_free():
    motor = Ramped(2.0, PARAMS, None)
    time, step = motor.parameters['time'], 0.0005
    turns = stepped(motor, 1.6, step, before=0.6)[:, 0]
    # Behind a lag, what grows by an equal share in each step is later by a constant factor.
    rises = np.log(turns[1:] / turns[:-1]) / step
    on = (turns[1:] > 0.75) & (turns[1:] < 1.3)
    assert rises[on] == pytest.approx(np.full(on.sum(), motor.rises), rel=0.05)
    fall = stepped(Ramped(2.0, PARAMS, None), 0.6, step, before=1.6)[:, 0]
    since = step * np.arange(1, len(fall) + 1)
    assert fall == pytest.approx(0.6 + np.exp(-since / time), abs=1e-6)


def test_a_small_rise_is_a_lag_and_a_large_one_takes_longer():
    motor, step, times = Ramped(2.0, PARAMS, None), 0.0005, []
    for end in (1.001, 1.1, 1.3):
        turns = stepped(Ramped(2.0, PARAMS, None), end, step)[:, 0]
        times.append(step * np.sum(end - turns) / (end - 1.0))
        assert np.all(turns <= end)
    assert times[0] == pytest.approx(motor.parameters['time'], rel=0.03)
    # What a rise by a constant share misses until it is there, and the lag.
    for end, took in zip((1.1, 1.3), times[1:], strict=True):
        ramp = (end * np.log(end) - end + 1.0) / (end - 1.0) / motor.rises
        assert took == pytest.approx(motor.parameters['time'] + ramp, rel=0.03)


def test_a_bounded_rise_starts_from_rest_and_is_the_same_in_one_step_or_in_many():
    turns = stepped(Ramped(1.0, PARAMS, None), 1.0, seconds=2.0, before=0.0)[:, 0]
    assert turns[-1] == pytest.approx(1.0, abs=1e-4)
    goals = []
    for parts in (1, 20):
        motor, speeds = Ramped(2.0, PARAMS, None), np.full(4, HOVER)
        for _ in range(parts):
            speeds = motor.turn(speeds, np.full(4, 1.5 * HOVER), 0.02 / parts)
        goals.append(motor._goal)
    assert goals[0] == pytest.approx(goals[1])


@pytest.mark.parametrize('kind', [Coalesced, Throttled])
def test_a_line_has_its_mean_delay_in_a_flight(kind):
    line, waits = part_of(kind, 2.0), []
    for seed in range(60):
        line.begin(np.random.default_rng(seed))
        waits += [line.waits(t) for t in np.arange(0.0, 20.0, 0.0131)]
    assert np.mean(waits) == pytest.approx(line.delay, rel=0.05)
    assert np.min(waits) > 0.3 * line.delay and np.max(waits) < 3.0 * line.delay


def test_what_comes_before_an_acknowledgement_goes_all_together_with_it():
    line = part_of(Coalesced, 2.0)
    t = np.arange(0.0, 20.0, 0.0005)
    leaves = np.array([t + line.waits(t) for t in t]) - line.OWN * line.delay
    assert np.all(leaves >= t) and np.all(np.diff(leaves) > -1e-9)
    groups = np.unique(leaves.round(9))
    takes = np.diff(groups) / ((1.0 - line.OWN) * line.delay)
    # Two kinds of them, of which some in ten are kept back for four times as long.
    unit = takes[takes > takes.max() / 2.0].mean() / line.KEPT
    kept = takes > 1.1 * unit
    assert kept.mean() == pytest.approx(line.OFTEN, abs=0.06)
    assert takes[~kept].mean() == pytest.approx(line.SOON * unit, rel=0.05)
    for some, mean in ((takes[kept], line.KEPT), (takes[~kept], line.SOON)):
        assert np.all(np.abs(some / (mean * unit) - 1.0) < line.SPREAD + 0.06)


def test_acknowledgements_come_again_in_a_flight_that_is_longer_than_they_are():
    line = part_of(Coalesced, 1.0)
    held = (1.0 - line.OWN) * line.delay
    turns = held * line.comes[-1]
    assert line.waits(turns + 0.123) == pytest.approx(line.waits(0.123), abs=1e-9)
    assert line.waits(turns - 1e-9) == pytest.approx(line.OWN * line.delay, abs=1e-6)


def test_a_hot_computer_lowers_its_clock_step_by_step_and_stays_about_its_limit():
    line = part_of(Throttled, 2.0)
    t = line.EVERY * (np.arange(line.COUNT) + 0.5)
    waits = np.array([line.waits(one) for one in t])
    clocks = (1.0 - line.OWN) / line.MEAN / (waits / line.delay - line.OWN)
    assert set(clocks.round(6)) <= set(line.CLOCKS)
    places = np.array([line.CLOCKS.index(one) for one in clocks.round(6)])
    assert np.abs(np.diff(places)).max() == 1 and places[0] == 0
    assert np.all(np.flatnonzero(np.diff(places)) % line.LOOKS == line.LOOKS - 1)
    # It is cool at first, then warms up, and then is neither hot for long nor cold.
    reached = int(np.argmax(line.heats > 1.0))
    assert 0.0 < t[reached] < 8.0 and np.all(places[:reached] == 0)
    late = line.heats[t > t[reached] + 10.0]
    assert late.min() > line.LEAVES - 0.1 and late.max() < 1.1
    # What makes heat goes with the square of the clock.
    part = 1.0 - np.exp(-line.EVERY / line.HEATS)
    goals = line.heats[:-1] + np.diff(line.heats) / part
    hot = goals / line.clocks[:-1] ** 2
    assert hot == pytest.approx(np.full(len(hot), hot[0])) and line.HOT[0] < hot[0] < line.HOT[1]


@pytest.mark.parametrize('turn', [0.8, 1.2])
def test_what_rotors_induce_is_what_momentum_theory_asks_for(turn):
    part = part_of(Relieved, 2.0)
    for along in (-0.8, -0.3, 0.0, 0.6, 2.0):
        for across in (0.0, 0.4, 1.0, 3.0):
            x = part.inflow(np.array([across]), np.array([along]), np.array([turn]))
            known = brentq(lambda x, a=along, b=across: x * np.hypot(b, a + x) - turn ** 2,
                           max(-along, 0.0) if across == 0.0 else 0.0, 9.0)
            assert x == pytest.approx([known], abs=2e-3)
    # By the closed forms of a climb, and of fast level flight.
    one, none = np.ones(1), np.zeros(1)
    assert part.inflow(none, one, one) == pytest.approx(0.5 * (np.sqrt(5.0) - 1.0))
    assert part.inflow(20.0 * one, none, one) == pytest.approx(1.0 / 20.0, rel=1e-3)


def test_fast_flight_relieves_rotors_of_the_force_that_goes_with_their_inflow():
    part = part_of(Relieved, 2.0)

    def share(speed, climb=0.0):
        force = flown(part, speed, 0.0, climb)
        assert force[1:] == pytest.approx([0.0, 0.0])
        return -force[0] / speed

    assert share(1e-4) == pytest.approx(part.BLADES + part.MORE)
    shares = [share(speed) for speed in (0.5, 1.0, 2.0, 4.0, 8.0)]
    assert np.all(np.diff(shares) < 0.0) and shares[-1] > part.BLADES
    # What they induce falls with one over the speed: its part of the force is bounded.
    fast = 30.0 * part.induced
    assert (share(fast) - part.BLADES) * fast == pytest.approx(part.MORE * part.induced, rel=0.01)
    # A climb adds to the inflow, though less than it is, and a descent takes.
    assert share(1.0, 1.0) - share(1.0) == pytest.approx(part.MORE * 0.5 / part.induced, rel=0.15)
    assert share(1.0, -1.0) < share(1.0) < share(1.0, 1.0)


def test_each_rotor_has_its_own_force_so_that_a_turn_of_the_body_is_braked():
    part = part_of(Relieved, 2.0)
    force, moment = part.wrench(still(rate=np.array([0.0, 0.0, 2.0])))
    assert force == pytest.approx(REST, abs=1e-12) and moment[2] < 0.0
    assert moment[:2] == pytest.approx([0.0, 0.0], abs=1e-12)
    quick = still(air=np.array([1.0, 0.0, 0.0]), speeds=HOVER * np.array([1.2, 1.0, 1.0, 1.2]))
    assert part.wrench(quick)[1][2] > 0.0       # those on the left drag by more


def test_a_wing_lifts_with_the_angle_up_to_a_stall_and_is_a_plate_beyond():
    part = part_of(Winged, 2.0)
    for angle in (-0.1, 0.0, 0.1):
        lift, drag = part.wing(angle)
        assert lift == pytest.approx(part.LIFTS * angle, abs=0.02)
        assert drag == pytest.approx(part.SMOOTH + part.INDUCED * lift ** 2, abs=0.01)
    angles = np.linspace(0.0, 0.5, 201)
    lifts = np.array([part.wing(angle)[0] for angle in angles])
    assert angles[np.argmax(lifts)] == pytest.approx(part.STALLS, abs=0.08)
    assert lifts[-1] < 0.8 * lifts.max()
    for angle in (0.8, 0.5 * np.pi, 2.4):
        lift, drag = part.wing(angle)
        # All of the force of a plate is across it.
        assert lift * np.sin(angle) - (drag - part.SMOOTH) * np.cos(angle) == pytest.approx(
            0.0, abs=1e-3)
    assert part.wing(0.5 * np.pi) == pytest.approx((0.0, 2.0 + part.SMOOTH), abs=1e-6)
    for angle in angles:
        (lift, drag), (other, same) = part.wing(angle), part.wing(-angle)
        assert [lift, drag] == pytest.approx([-other, same])


def test_a_wing_lifts_in_flight_ahead_and_does_nothing_in_flight_along_it():
    part = part_of(Winged, 2.0)
    lift, drag = part.wing(part.SET)
    assert flown(part, 3.0, 0.0, 0.0) == pytest.approx(
        [-9.0 * (part.BODY + part.WING * drag), 0.0, 9.0 * part.WING * lift])
    assert flown(part, 0.0, 3.0, 0.0) == pytest.approx([0.0, -9.0 * part.BODY, 0.0])
    # A sinking body has more lift, and one that climbs less than none.
    assert flown(part, 3.0, 0.0, -0.4)[2] > flown(part, 3.0, 0.0, 0.0)[2] > 0.0
    assert flown(part, 3.0, 0.0, 0.6)[2] < 0.0
    # Up and down it is a plate, and it grows with the square.
    down = part.BODY + part.WING * part.wing(0.5 * np.pi + part.SET)[1]
    assert flown(part, 0.0, 0.0, -2.0)[2] == pytest.approx(4.0 * down, rel=0.01)
    assert flown(part, 4.0, 1.0, -0.8) == pytest.approx(4.0 * flown(part, 2.0, 0.5, -0.4))


def test_a_wing_never_gains_energy_of_still_air():
    part = part_of(Winged, 2.0)
    for air in np.random.default_rng(1).normal(size=(200, 3)):
        assert flown(part, *air) @ air < 0.0


def test_skids_are_easy_along_and_each_rod_feels_the_flow_across_it_alone():
    part = part_of(Skidded, 2.0)
    ahead, aside = flown(part, 2.0, 0.0, 0.0), flown(part, 0.0, 2.0, 0.0)
    # Along the skids only the legs drag, across them both; by the square of the speed.
    assert ahead == pytest.approx([-4.0 * part.LEGS, 0.0, 0.0])
    upright = np.cos(part.SPLAY)
    assert aside == pytest.approx([0.0, -4.0 * (part.ALONG + part.LEGS * upright ** 3), 0.0])
    assert flown(part, 2.0, 4.0, -1.0) == pytest.approx(4.0 * flown(part, 1.0, 2.0, -0.5))
    for air in np.random.default_rng(1).normal(size=(50, 3)):
        assert flown(part, *air) @ air < 0.0
        assert flown(part, *(air * [1, -1, 1])) == pytest.approx(flown(part, *air) * [1, -1, 1])


@pytest.mark.parametrize('seed', range(6))
def test_air_in_an_alley_is_not_squeezed_and_does_not_pass_walls_and_ground(seed):
    wind, step = Alley(2.0, PARAMS, np.random.default_rng(seed)), 1e-5
    middle = (0.5 * wind.WIDE - wind.place) * wind.across
    assert wind.wind(0.0, middle + [0.0, 0.0, wind.HEIGHT]) == pytest.approx(wind.mean)
    for place in np.random.default_rng(1).uniform(-1.0, 1.0, (10, 3)) + [0.0, 0.0, 1.5]:
        slopes = np.array([(wind.wind(3.0, place + step * axis) - wind.wind(
            3.0, place - step * axis)) / (2.0 * step) for axis in np.eye(3)])
        assert np.trace(slopes) == pytest.approx(0.0, abs=1e-6)
    for side in (-0.5, 0.5):
        wall = middle + side * wind.WIDE * wind.across + [0.0, 0.0, 1.3]
        assert wind.wind(0.0, wall) @ wind.across == pytest.approx(0.0, abs=1e-9)
    ground = wind.wind(0.0, middle + 0.3 * wind.across)
    assert [ground[2], ground @ wind.along] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_air_in_an_alley_comes_back_below_goes_up_at_one_wall_and_down_at_the_other():
    wind = part_of(Alley, 2.0)
    middle = (0.5 * wind.WIDE - wind.place) * wind.across

    def at(on, height):
        return wind.wind(0.0, middle + on * wind.across + [0.0, 0.0, height])

    below, above = (at(0.0, height) @ wind.across for height in (0.2, wind.HIGH))
    assert below * above < 0.0 and abs(above) > 2.0 * abs(below)
    # With the air above the roofs, down is where it comes against a wall.
    side = np.sign(above)
    assert at(2.0 * side, 2.0)[2] < 0.0 < at(-2.0 * side, 2.0)[2]
    assert at(0.0, 2.0)[2] == pytest.approx(0.0, abs=1e-9)
    assert at(0.0, wind.HIGH)[2] == pytest.approx(0.0, abs=1e-9)
    # Along it, there is a profile, the same all across.
    for on in (-1.5, 0.7):
        ratio = (at(on, 2.0) @ wind.along) / (at(on, 0.5) @ wind.along)
        assert ratio == pytest.approx(np.log1p(100.0) / np.log1p(25.0))


def test_a_gust_has_a_lull_before_and_after_and_the_same_direction():
    wind = part_of(Lulled, 2.0)
    mean = float(np.linalg.norm(wind.mean))
    for k in (1, 2, 3):
        t = wind.times[k] + wind.lasts[k] * np.linspace(0.0, 1.0, 201)
        air = np.array([wind.wind(one, REST) for one in t])
        assert np.cross(air, wind.mean) == pytest.approx(np.zeros_like(air), abs=1e-9)
        speeds = air @ wind.mean / mean ** 2
        assert speeds == pytest.approx(speeds[::-1])
        assert [speeds[0], speeds[-1]] == pytest.approx([1.0, 1.0])
        # Twice 0.37 of it in the middle, and less than half of that in the lulls.
        assert speeds.max() == speeds[100] == pytest.approx(1.0 + 0.74 * wind.strong[k])
        lull = (1.0 - speeds.min()) / wind.strong[k]
        assert 0.25 < lull < 0.37 and np.argmin(speeds[:100]) == pytest.approx(50, abs=8)
        between = 0.5 * (t[-1] + wind.times[k + 1])
        assert wind.wind(between, REST) == pytest.approx(wind.mean)


def test_gusts_with_lulls_are_about_the_mean_and_come_without_a_jump():
    wind, speeds = part_of(Lulled, 2.0), []
    mean = np.linalg.norm(wind.mean)
    for seed in range(40):
        wind.begin(np.random.default_rng(seed))
        speeds.append([np.linalg.norm(wind.wind(t, REST)) for t in np.arange(0.0, 20.0, 0.05)])
    assert np.mean(speeds) == pytest.approx(mean, rel=0.1)
    assert np.abs(np.diff(speeds)).max() < 0.12 * mean and np.min(speeds) > 0.4 * mean
