# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of lags, drag, wind, thrust and batteries of common vehicles: what each does."""


import numpy as np
import pytest
from withheld_parts import drained, HOVER, PARAMS, part_of, PLACES, REST, SPINS, stepped, still

from withheld.forms.advances import Advancing
from withheld.forms.axes import ThrottleSmoothed, YawSmoothed
from withheld.forms.boxes import BatteryBelow
from withheld.forms.breezes import Fickle
from withheld.forms.charts import Charted
from withheld.forms.circuits import TwoPairs
from withheld.forms.conditioners import Conditioned
from withheld.forms.decays import Fading
from withheld.forms.disturbances import HeightAlone
from withheld.forms.domes import Domed
from withheld.forms.endpoints import Uncalibrated
from withheld.forms.executors import Executed
from withheld.forms.gauges import SeldomRead
from withheld.forms.latencies import LongTailed
from withheld.forms.powers import ConstantPower
from withheld.forms.tilts import LeaningThrust


@pytest.mark.parametrize('kind', [YawSmoothed, ThrottleSmoothed])
def test_a_command_that_is_held_is_reached_and_is_the_same_in_one_step_or_in_many(kind):
    command = np.array([1.1, 0.9, 1.0, 1.2])
    assert stepped(part_of(kind), command)[-1] == pytest.approx(command, abs=1e-4)
    assert stepped(part_of(kind), 1.0) == pytest.approx(np.ones((2000, 4)))
    one = stepped(part_of(kind), command, 0.004, 0.04)[-1]
    assert one == pytest.approx(stepped(part_of(kind), command, 0.0001, 0.04)[-1], abs=5e-3)


PATTERNS = {YawSmoothed: SPINS, ThrottleSmoothed: np.ones(4)}


@pytest.mark.parametrize('kind', PATTERNS)
@pytest.mark.parametrize('pattern', [(1, 1, 1, 1), (1, 1, -1, -1), (1, -1, -1, 1), (1, -1, 1, -1)])
def test_what_is_not_smoothed_has_the_lag_of_the_motors_alone(kind, pattern):
    motor, step, change = part_of(kind), 0.0005, 0.1 * np.array(pattern)
    missing = 1.0 - (stepped(motor, 1.0 + change, step) - 1.0) / change
    since = step * np.arange(1, len(missing) + 1)
    lag = np.exp(-since / motor.parameters['time'])
    slow = np.any(missing > lag[:, None] + 0.05)
    assert slow == np.array_equal(pattern, PATTERNS[kind])
    if not slow:
        assert missing == pytest.approx(np.tile(lag[:, None], 4), abs=1e-9)


@pytest.mark.parametrize('kind', PATTERNS)
def test_what_is_smoothed_comes_later_by_the_time_of_the_low_pass(kind):
    motor, step, pattern = part_of(kind), 0.0005, PATTERNS[kind]
    turns = stepped(motor, 1.0 + 0.1 * pattern, step)
    missing = 1.0 - (turns - 1.0) @ pattern / 0.4
    own, smooths = motor.parameters['time'], motor.parameters['smooths']
    since = step * np.arange(1, len(missing) + 1)
    # Two lags, one behind the other.
    assert missing == pytest.approx((smooths * np.exp(-since / smooths) - own * np.exp(
        -since / own)) / (smooths - own), abs=1e-3)
    assert (turns - 1.0) == pytest.approx(np.outer(1.0 - missing, 0.1 * pattern))


def test_a_wireless_link_is_soon_mostly_and_very_late_at_times():
    line = part_of(LongTailed)
    waits = np.array([line.waits(t) for t in np.arange(0.0, 200.0, 0.01)]) / line.delay
    assert waits.mean() == pytest.approx(1.0, rel=0.02)
    assert waits.min() > line.LEAST and np.median(waits) < 0.9
    assert 1e-3 < np.mean(waits > 4.0) < 0.02
    # What is above the least has a logarithm that is normal.
    logs = np.log(waits - line.LEAST)
    assert logs.std() == pytest.approx(line.SPREAD, rel=0.03)
    assert np.mean((logs - logs.mean()) ** 3) == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize('seed', range(3))
def test_a_command_waits_for_what_the_thread_does(seed):
    line = part_of(Executed, seed=seed)
    times = np.arange(0.0, 100.0, 0.00737)
    waits = np.array([line.waits(t) for t in times])
    assert waits.mean() == pytest.approx(line.delay, rel=0.05)
    # Where there is nothing to do it waits for nothing but itself.
    assert waits.min() == pytest.approx(line.OWN * line.delay)
    assert np.mean(waits < 1.001 * waits.min()) > 0.1
    # No more than two rounds of all that there is, and what comes later is not done sooner.
    assert waits.max() <= line.OWN * line.delay + 2.0 * line.unit * line.TAKES.sum()
    assert np.all(np.diff(times + waits) > -1e-9)


def test_rounds_do_not_overlap_and_take_what_is_ready():
    line = part_of(Executed)
    line.waits(10.0)
    begins, ends = np.array(line._begins), np.array(line._ends[1:])
    assert np.all(begins[1:] >= ends[:-1])
    sums = {round(float(s @ line.TAKES), 6) for s in np.ndindex(2, 2, 2) for s in [np.array(s)]}
    assert {round(one, 6) for one in (ends - begins).tolist()} <= sums
    # All pictures and scans are done.
    assert np.sum(ends - begins) == pytest.approx(
        ends[-1] * np.sum(line.TAKES / line.EVERY), rel=0.08)


def test_the_force_of_an_advancing_rotor_gets_a_square():
    part = part_of(Advancing)
    even = part.EVEN * PARAMS['rotor_radius'] * HOVER
    slow = part.LINE * part.coefficient
    for over in (0.1, 1.0, 2.0):
        force, moment = part.wrench(still(air=np.array([0.0, over * even, 1.0])))
        assert force == pytest.approx([0.0, -slow * over * even * (1.0 + over), 0.0])
        assert moment == pytest.approx(REST, abs=1e-12)
    # That square does not go with the speed of the rotors.
    fast = part.wrench(still(air=np.array([even, 0.0, 0.0]), speeds=np.full(4, 2.0 * HOVER)))[0]
    assert fast == pytest.approx([-slow * even * 3.0, 0.0, 0.0])


def test_thrust_that_leans_back_goes_with_the_thrust():
    part = part_of(LeaningThrust)
    for turn in (1.0, 1.5):
        force, moment = part.wrench(still(air=np.array([2.0, -1.0, 3.0]),
                                          speeds=np.full(4, turn * HOVER)))
        assert force == pytest.approx(-part.coefficient * turn ** 2 * np.array([2.0, -1.0, 0.0]))
        assert moment == pytest.approx(REST, abs=1e-12)
    left = PLACES[:, 1] > 0.0
    _, moment = part.wrench(still(air=np.array([2.0, 0.0, 0.0]),
                                  speeds=HOVER * np.where(left, 1.2, 0.8)))
    assert moment == pytest.approx([0.0, 0.0, 0.12 * part.coefficient * (1.44 - 0.64)])


def test_a_battery_below_drags_and_turns_the_body():
    part = part_of(BatteryBelow)
    for axis, area in enumerate(part.AREAS):
        for speed in (1.0, 3.0):
            force, moment = part.wrench(still(air=speed * np.eye(3)[axis]))
            assert force == pytest.approx(-part.coefficient * area * speed ** 2 * np.eye(3)[axis])
            assert moment == pytest.approx(np.cross(part.place, force))
    # Flight ahead lowers the nose, as what is below stays behind.
    assert part.wrench(still(air=np.array([2.0, 0.0, 0.0])))[1][1] > 0.0 > part.place[2]


def test_a_cover_climbs_easily_and_is_lifted_by_level_flow():
    part = part_of(Domed)
    up, down = (part.wrench(still(air=np.array([0.0, 0.0, v])))[0] for v in (1.0, -1.0))
    assert -down[2] / up[2] == pytest.approx(3.0) and up[2] < 0.0
    level = part.wrench(still(air=np.array([0.0, 2.0, 0.0])))[0]
    assert level / part.coefficient == pytest.approx([0.0, -4.0 * part.LEVEL, 4.0 * part.LIFTS])


@pytest.mark.parametrize('seed', range(3))
def test_air_conditioning_blows_its_mean_in_the_middle_over_its_swings(seed):
    wind = part_of(Conditioned, seed=seed)
    place = np.array([0.0, 0.0, wind.ASKED])
    times = np.arange(0.0, 40.0, 0.01) * 2.0 * np.pi / wind.rate
    air = np.array([wind.wind(t, place) for t in times])
    assert air.mean(axis=0)[:2] == pytest.approx(wind.mean[:2], rel=1e-3)
    along = air @ wind.onto
    assert along.max() > 1.5 * along.mean() and along.min() < 0.5 * along.mean()
    assert np.all(air[:, 2] <= 0.0)


def test_its_jet_sinks_slows_down_and_spreads():
    wind = part_of(Conditioned)
    high = np.array([[*(far - wind.away) * wind.onto[:2], z]
                     for far in (1.0, 3.0) for z in np.arange(0.0, 2.5, 0.002)]).reshape(2, -1, 3)
    speeds = np.linalg.norm([[wind.jet(-1.0, place) for place in one] for one in high], axis=2)
    near, far = speeds.max(axis=1)
    assert near / far == pytest.approx(np.sqrt(3.0), rel=0.15)
    middles = [one[k.argmax(), 2] for one, k in zip(high, speeds, strict=True)]
    straight = wind.HIGH - np.tan(wind.DOWN - wind.SWINGS) * np.array([1.0, 3.0])
    assert straight - middles == pytest.approx(wind.SINKS * np.array([1.0, 9.0]), abs=0.03)
    assert not np.any(wind.wind(1.0, -1.1 * wind.away * wind.onto))


def test_a_fickle_wind_wanders_and_has_its_mean():
    means, turns, logs, later = [], [], [], []
    for seed in range(60):
        wind = part_of(Fickle, seed=seed)
        air = np.array([wind.wind(t, REST)[:2] for t in np.arange(0.0, 20.0, 4.0)])
        strong = np.log(np.linalg.norm(air, axis=1) / np.linalg.norm(wind.mean))
        x, y = wind.mean[:2]
        turn = np.arctan2(air @ [-y, x], air @ [x, y])
        means.append(np.exp(strong))
        turns.append(turn)
        logs.append(strong + 0.5 * wind.STRONG ** 2)
        later.append(logs[-1][1:] * logs[-1][:-1])
    assert np.mean(means) == pytest.approx(1.0, abs=0.06)
    assert np.std(turns) == pytest.approx(Fickle.TURNS, rel=0.15)
    assert np.std(logs) == pytest.approx(Fickle.STRONG, rel=0.15)
    # After the time of the strength, 4 s, it has forgotten all but 1 / e.
    assert np.mean(later) / np.mean(np.square(logs)) == pytest.approx(np.exp(-1.0), abs=0.12)


def test_a_fickle_wind_is_the_same_everywhere_at_a_time():
    wind = part_of(Fickle)
    assert wind.wind(3.0, REST) == pytest.approx(wind.wind(3.0, np.array([1.0, 2.0, 3.0])))


@pytest.mark.parametrize('across', [0.0, 1.0, 3.0])
@pytest.mark.parametrize('climb', [-0.8, 0.0, 1.5])
def test_thrust_times_the_flow_through_the_disk_is_the_power(climb, across):
    part = part_of(ConstantPower)
    air = part.induced * np.array([across, 0.0, climb])
    thrust = 1.0 + (part.gain(still(air=air)) - 1.0) / (part.size * part.SHARE)
    through = 1.0 / thrust
    # The induced velocity is what momentum theory has for the thrust of hover.
    assert (through - climb) * np.hypot(across, through) == pytest.approx(np.ones(4), rel=1e-3)


def test_a_climb_costs_and_level_flight_gives_more_and_more():
    part = part_of(ConstantPower)
    gains = [part.gain(still(air=np.array([v, 0.0, 0.0])))[0] for v in (0.0, 4.0, 8.0, 12.0)]
    assert gains[0] == pytest.approx(1.0) and np.all(np.diff(gains, 2) > 0.0)
    assert part.gain(still(air=np.array([0.0, 0.0, 2.0])))[0] < 1.0


def test_a_chart_falls_gently_and_then_steeply():
    part = part_of(Charted)
    tips = PARAMS['rotor_radius'] * HOVER
    assert part.chart(0.0) == 1.0 and part.chart(part.NONE) == pytest.approx(0.0)
    slope = part.LINE / part.NONE
    assert part.chart(-0.1) == pytest.approx(1.0 + 0.1 * slope)
    assert 1.0 - part.chart(0.1) > 0.1 * slope
    climb = part.gain(still(air=np.array([0.0, 0.0, 0.05 * tips])))
    assert climb == pytest.approx(1.0 + part.size * part.SHARE * (
        part.chart(0.05 * np.pi) - 1.0) * np.ones(4))
    side = part.gain(still(air=np.array([0.1 * tips, 0.0, 0.0])))
    assert side == pytest.approx((1.0 + part.size * part.SHARE * 0.015) * np.ones(4))


def test_what_the_ground_takes_fades_exponentially_with_height_and_speed():
    part, radius = part_of(Fading, 1.0), PARAMS['rotor_radius']

    def takes(height, speed=0.0):
        gain = part.gain(still(air=np.array([0.0, speed, 0.0]),
                               heights=radius * np.asarray(height) * np.ones(4)))
        return np.ones(4) - 1.0 / gain

    assert takes(1.0) == pytest.approx(part.TAKES * np.exp(-part.FADES) * np.ones(4))
    assert takes(3.0) / takes(1.0) == pytest.approx(np.exp(-2.0 * part.FADES) * np.ones(4))
    fast = part.LEAVES * part.induced
    assert takes(1.0, 2.0 * fast) / takes(1.0) == pytest.approx(np.exp(-2.0) * np.ones(4))
    # All rotors have the same of it, also where some are nearer.
    assert takes([0.8, 0.9, 1.1, 1.2]) == pytest.approx(takes(1.0))


def test_a_lift_by_the_height_alone_is_the_same_for_slow_and_fast_rotors():
    part = part_of(HeightAlone)
    heights = PARAMS['rotor_radius'] * np.array([1.0, 2.0, 3.0, 8.0])
    lifts = [(part.gain(still(heights=heights, speeds=np.full(4, turn * HOVER))) - 1.0) * turn ** 2
             for turn in (0.7, 1.0, 1.3)]
    assert lifts[0] == pytest.approx(lifts[1]) and lifts[2] == pytest.approx(lifts[1])
    assert lifts[1] == pytest.approx(part.size * part.MOST / np.array([2.0, 3.0, 4.0, 9.0]) ** 2)


def test_a_load_takes_a_part_at_once_and_the_rest_by_two_times():
    battery = part_of(TwoPairs)
    battery.LASTS = np.inf
    since = 0.01 * np.arange(1, 1501)
    pairs = sum(one * (1.0 - np.exp(-since / time))
                for one, time in zip(battery.PAIRS, battery.TIMES, strict=True))
    taken = 1.0 - drained(battery, np.ones(1500))
    assert taken == pytest.approx(battery.size * (battery.RESISTS + pairs))
    # It recovers as slowly.
    assert 1.0 - drained(battery, np.zeros(1))[0] == pytest.approx(
        battery.size * pairs[-1], rel=0.02)


@pytest.mark.parametrize('seed', range(3))
def test_the_voltage_at_rest_falls_with_the_charge_by_its_curve(seed):
    battery = part_of(TwoPairs, seed=seed)
    battery.RESISTS, battery.PAIRS, first = 0.0, np.zeros(2), battery._charge
    ratios = drained(battery, np.ones(3000))
    charge = np.array([first - 0.01 * k / battery.LASTS for k in (0, 3000)])
    curve = np.polyval([0.3201, -0.1178, 0.2156, 3.685], charge) - 1.031 * np.exp(-35.0 * charge)
    assert 1.0 - ratios[-1] == pytest.approx(battery.size * (1.0 - curve[1] / curve[0]))


def test_what_a_load_takes_comes_back_in_part_as_the_voltage_is_read():
    battery = part_of(SeldomRead)
    battery.FALLS, battery.STEPS = 0.0, 1e-9
    battery.begin(np.random.default_rng(1))
    drained(battery, np.ones(300))
    battery.drain(3.0, 0.01, np.full(4, 2.0 ** (1.0 / 3.0)))
    low, seen = (1.0 - battery.size * battery.RESISTS * load for load in (2.0, 1.0))
    assert battery.gain(1.0) == pytest.approx(low ** 1.8 / seen)
    gains = []
    for k in range(301, 450):
        battery.drain(0.01 * k, 0.01, np.full(4, 2.0 ** (1.0 / 3.0)))
        gains.append(battery.gain(1.0))
    assert np.count_nonzero(np.diff(gains)) == 1
    assert gains[-1] == pytest.approx(low ** 0.8)


def test_a_gauge_has_steps():
    battery, seen = part_of(SeldomRead), []
    for k in range(2000):
        battery.drain(0.01 * k, 0.01, np.ones(4))
        seen.append(battery._seen)
    steps = (1.0 - np.array(seen)) / (battery.size * battery.STEPS)
    assert steps == pytest.approx(np.round(steps), abs=1e-9)
    assert len(set(seen)) >= 3 and np.count_nonzero(np.diff(seen)) <= 20


@pytest.mark.parametrize('seed', range(4))
def test_full_throttle_is_right_and_slow_rotors_are_off_by_more(seed):
    part = part_of(Uncalibrated, seed=seed)
    gains = np.array([part.gain(still(speeds=np.full(4, turn * HOVER))) - 1.0
                      for turn in (part.full, 1.2, 1.0, 0.7)])
    assert gains[0] == pytest.approx(np.zeros(4), abs=1e-12)
    assert np.all(np.diff(np.abs(gains), axis=0) > 0.0)
    assert np.all(np.sign(gains[1:]) == -np.sign(part.zones))
    # A straight line from where each begins: the root of thrust over that of hover.
    turns = (1.2, 1.0, 0.7)
    roots = [np.sqrt(1.0 + one) * turn for one, turn in zip(gains[1:], turns, strict=True)]
    assert (roots[0] - roots[1]) / 0.2 == pytest.approx((roots[1] - roots[2]) / 0.3)
    assert np.ptp(part.zones) > 0.0
