# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of inflow, ground, battery, thrust and mass that the twenty-fifth draw flies."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import above, drained, HOVER, PARAMS, part_of, RADIUS, REST, still

from withheld.constants import GRAVITY
from withheld.forms.chargers import ToppedUp
from withheld.forms.collisions import Colliding
from withheld.forms.estimators import Converging
from withheld.forms.governors import Drooping
from withheld.forms.harnesses import DaisyChained
from withheld.forms.hoppers import Arching
from withheld.forms.kites import Kiting
from withheld.forms.sheets import Spanning
from withheld.forms.tarmacs import Sunbaked


def passed(part, seconds, step=0.005):
    for _ in range(round(seconds / step)):
        part.after(step, np.eye(3), REST)


@pytest.mark.parametrize('kind', [Drooping, Spanning])
def test_rotors_at_rest_are_nominal_and_a_climb_takes_thrust(kind):
    part = part_of(kind)
    assert part.gain(still()) == pytest.approx(np.ones(4))
    assert np.all(part.gain(still(air=np.array([0.0, 0.0, 2.0]))) < 1.0)
    assert np.all(part.gain(still(air=np.array([5.0, 0.0, 0.0]))) > 1.0)


def test_an_engine_slows_down_in_a_climb_by_its_two_times_until_the_governor_has_made_up():
    part = part_of(Drooping)
    climb = still(air=np.array([0.0, 0.0, part.induced]))
    at_once = part.gain(climb)
    # As much again goes through the disks: that of the power.
    assert part._asks == pytest.approx(1.0)
    assert at_once == pytest.approx(np.full(4, 1.0 - part.size * part.TAKES))
    fast, slow = np.roots([part.ENGINE, 1.0, 1.0 / part.GOVERNS])
    for wait, until in ((0.3, 0.3), (0.7, 1.0), (2.0, 3.0)):
        passed(part, wait, step=0.0005)
        droop = part.DROOPS / part.ENGINE / (fast - slow) * (
            np.exp(fast * until) - np.exp(slow * until))
        assert part._droop == pytest.approx(droop, rel=5e-3)
        assert part.gain(climb) == pytest.approx(at_once * (1.0 - part.size * part._droop) ** 2)
    passed(part, 20.0)
    assert part.gain(climb) == pytest.approx(at_once, abs=1e-5)
    # What the governor has opened is too much as soon as the climb ends.
    part.gain(still())
    passed(part, 0.5)
    assert np.all(part.gain(still()) > 1.0)


def test_an_engine_slows_down_for_all_rotors_together_and_not_for_a_load():
    part = part_of(Drooping)
    part.gain(still(speeds=np.full(4, 1.2 * HOVER)))
    assert part._asks == pytest.approx(0.0)
    turns = still(rate=np.array([2.0, 0.0, 0.0]))
    at_once = part.gain(turns)
    passed(part, 0.5)
    assert np.ptp(at_once) > 0.0 and part.gain(turns) / at_once == pytest.approx(
        np.full(4, (1.0 - part.size * part._droop) ** 2))


def test_in_fast_flight_all_rotors_have_the_downwash_of_a_wing():
    part = part_of(Spanning)
    ahead, corner = (part.wing(still(air=np.array(air))) for air in (
        [3.0, 0.0, 0.0], [3.0, 3.0, 0.0]))
    reach = np.hypot(0.12, 0.12)
    assert ahead == pytest.approx((0.12 + RADIUS) ** 2 / (4.0 * RADIUS ** 2))
    assert corner == pytest.approx((reach + RADIUS) ** 2 / (4.0 * RADIUS ** 2))
    # Prandtl's wing: lift over twice the density, the circle around the span and the speed.
    for wing in (ahead, corner):
        flow = part.flow(np.zeros(1), np.array([30.0]), wing)
        assert flow[0] * 30.0 * wing == pytest.approx(1.0, rel=1e-4)
    gains = [part.gain(still(air=np.array(air)))[0] for air in (
        [4.0, 0.0, 0.0], [0.0, -4.0, 0.0], [8.0 ** 0.5, 8.0 ** 0.5, 0.0])]
    assert gains[0] == pytest.approx(gains[1]) and gains[2] > gains[0] + 1e-3


def test_air_that_is_moved_and_its_velocity_make_the_thrust():
    part = part_of(Spanning)
    climb, across = (one.ravel() for one in np.meshgrid(
        np.linspace(part.LEAST, 3.0, 14), np.linspace(0.0, 4.0, 9)))
    for wing in (0.8, 1.0, 2.5):
        flow = part.flow(climb, across, wing)
        total = np.hypot(across, climb + flow)
        sine = across ** 2 / total ** 2
        assert flow * total * (1.0 + (wing - 1.0) * sine) == pytest.approx(np.ones(126), abs=2e-3)
    axial = part.flow(np.array([2.0]), np.zeros(1), 2.5)
    assert axial == pytest.approx(np.sqrt(2.0) - 1.0)


def test_heat_takes_thrust_by_the_power_of_free_convection():
    part = part_of(Sunbaked)
    high = part.TOP ** (-1.0 / 3.0)
    lower, upper = part.heat(np.array([2.0, 16.0])) + high
    assert lower / upper == pytest.approx(2.0)
    assert part.gain(above(25.0)) == pytest.approx(np.ones(4), abs=5e-4)
    assert part.gain(above(80.0))[0] == pytest.approx(1.0, abs=5e-5)
    taken = part.size * part.THINS * ((4.0 * RADIUS) ** (-1.0 / 3.0) - high)
    image = 1.0 / (1.0 - 1.0 / 256.0) - 1.0
    assert part.gain(above(4.0)) == pytest.approx(np.full(4, 1.0 + part.size * image - taken))
    assert part.gain(above(1.0))[0] > 1.0 > part.gain(above(4.0))[0]


def test_hover_blows_hot_air_away_and_flight_comes_to_it_again():
    part, hovers = part_of(Sunbaked), above(3.0)
    part.gain(hovers)
    passed(part, 2.0)
    blown = np.exp(-2.0 * np.exp(-part.FADES * 3.0) / part.GOES)
    assert part._hot == pytest.approx(blown)
    part.gain(above(3.0, air=np.array([0.0, 4.0, 0.0])))
    passed(part, 20.0)
    comes, goes = 4.0 / (part.COMES * RADIUS), np.exp(-part.FADES * 3.0) / part.GOES
    assert part._hot == pytest.approx(comes / (comes + goes))
    # High up, hover leaves it.
    part.gain(above(1e4))
    passed(part, 5.0)
    assert part._hot == pytest.approx(comes / (comes + goes))


def test_wakes_collide_where_their_momentum_is_the_same():
    part = part_of(Colliding)
    speeds = HOVER * np.array([1.0, 1.2, 1.0, 1.2])
    meets = part.meets(speeds)
    # Momentum of each falls by the way: the same where the ways are as the squares of the speeds.
    assert meets / meets.T == pytest.approx(speeds[:, None] ** 2 / speeds[None] ** 2)
    assert meets + meets.T == pytest.approx(np.ones((4, 4)))
    assert part.beside_each == pytest.approx(0.5 * np.array(
        [[0, 1, 0, 1], [1, 0, 1, 0], [0, 1, 0, 1], [1, 0, 1, 0]]))
    weak, strong = part.gain(above(2.0, speeds=speeds))[:2]
    even = part.gain(above(2.0))[0]
    assert weak < even - 0.01 and strong > even
    taken = part.TAKES * np.exp(-part.RISES * 2.0)
    assert even == pytest.approx(
        1.0 + part.size * (part.GAINS * np.exp(-part.FADES * 2.0) - taken))
    assert weak - even == pytest.approx(
        -part.size * taken * (np.exp(part.NEAR * (0.5 - 1.0 / 2.44)) - 1.0))


def test_a_rotor_is_beside_the_nearest_ones_and_height_and_flight_end_it():
    angles = np.arange(6) * np.pi / 3.0
    ring = {f'r{k}': np.array([0.25 * np.cos(a), 0.25 * np.sin(a), 0.0])
            for k, a in enumerate(angles)}
    six = part_of(Colliding, params=PARAMS | {'num_rotors': 6, 'rotor_pos': ring})
    assert np.count_nonzero(six.beside_each, axis=1).tolist() == [2] * 6
    part, speeds = part_of(Colliding), HOVER * np.array([0.8, 1.2, 0.8, 1.2])
    assert part.gain(above(40.0, speeds=speeds)) == pytest.approx(np.ones(4), abs=1e-5)
    hovers = part.gain(above(2.0, speeds=speeds)) - 1.0
    flies = part.gain(above(2.0, speeds=speeds, air=np.array([3.0 * part.induced, 0, 0]))) - 1.0
    assert flies == pytest.approx(0.1 * hovers)
    assert np.isfinite(part.gain(above(0.0, speeds=np.zeros(4)))).all()


def test_the_drop_along_a_wire_is_that_of_its_stretches_one_after_another():
    battery, turns = part_of(DaisyChained), np.array([1.1, 0.9, 1.2, 1.0])
    battery.drain(0.0, 1e-9, turns)
    loads, voltage, drops = turns ** 3, 0.0, np.empty(4)
    for place in range(1, 5):
        # A stretch has what all that are further on take, beyond hover.
        voltage += battery.STRETCH * np.sum((loads - 1.0)[battery.order >= place])
        drops[battery.order == place] = voltage
    ratios = 1.0 - battery.size * (battery.RESISTS * np.mean(loads) + drops)
    assert battery.gain(turns) == pytest.approx(ratios ** 1.8)
    assert battery.ratio == pytest.approx(np.mean(ratios))
    orders = {tuple(DaisyChained(2.0, PARAMS, np.random.default_rng(k)).order) for k in range(9)}
    assert len(orders) > 4


def test_in_hover_all_rotors_of_a_wire_have_the_same_and_the_pack_falls():
    battery = part_of(DaisyChained)
    ratios = drained(battery, np.ones(3000))
    assert np.ptp(battery.gain(np.ones(4))) < 1e-12
    assert ratios[-1] == pytest.approx(1.0 - battery.size * (battery.RESISTS + battery.FALLS))
    # The load of the last one takes most from itself, and least from the first one.
    first, last = np.argmin(battery.order), np.argmax(battery.order)
    battery.drain(30.0, 1e-9, np.where(battery.order == 4, 1.2, 1.0))
    falls = ratios[-1] - battery._ratios
    share = battery.size * battery.STRETCH * (1.2 ** 3 - 1.0)
    assert falls[last] - falls[first] == pytest.approx(3.0 * share)


def test_a_tether_holds_the_voltage_up_to_its_limit_and_the_pack_gives_the_rest():
    battery, turn = part_of(ToppedUp), 0.8 ** (1.0 / 3.0)
    assert drained(battery, np.full(500, turn)) == pytest.approx(np.ones(500))
    # Beyond, in constant hover, the pack falls evenly by the current that it gives.
    ratios = drained(battery, np.ones(1000))
    more = 1.0 - battery.GIVES
    assert ratios[0] == pytest.approx(1.0 - battery.size * battery.RESISTS * more)
    assert ratios[-1] - ratios[0] == pytest.approx(
        -battery.size * battery.FALLS * more * 9.99 / 30.0)


def test_what_the_rotors_leave_charges_the_pack_up_to_the_voltage_of_the_tether():
    battery = part_of(ToppedUp)
    drained(battery, np.ones(2000))
    was = battery._open
    # At first by all that is left, then by what the voltage that is held drives through it.
    weak = battery.GIVES - 0.5 * was / battery.RESISTS
    ratios = drained(battery, np.full(10, weak ** (1.0 / 3.0)))
    assert ratios[0] == pytest.approx(1.0 - battery.size * 0.5 * was)
    assert was - battery._open == pytest.approx(
        0.1 / 30.0 * battery.FALLS * (battery.GIVES - weak), rel=1e-6)
    was = battery._open
    ratios = drained(battery, np.full(1000, 0.5))
    assert ratios == pytest.approx(np.ones(1000))
    time = battery.RESISTS * 30.0 / battery.FALLS
    assert battery._open == pytest.approx(was * np.exp(-10.0 / time), rel=1e-3)


def test_an_autopilot_learns_in_hover_and_not_while_it_climbs_hard():
    part = part_of(Converging)
    assert part.gain(still()) == pytest.approx(1.0 + part.share * part.FIRST)
    passed(part, 5.0)
    error = part.STAYS + (part.FIRST - part.STAYS) * np.exp(-5.0 / part.TIME)
    assert part.gain(still()) == pytest.approx(1.0 + part.share * error)
    # Thrust that is off by as much as it is near: half as fast.
    off = still(speeds=np.full(4, HOVER * np.sqrt(1.0 + part.NEAR)))
    assert part.gain(off) == pytest.approx(1.0 + part.share * error)
    passed(part, 5.0)
    error = part.STAYS + (error - part.STAYS) * np.exp(-2.5 / part.TIME)
    assert part.gain(off) == pytest.approx(1.0 + part.share * error)
    part.gain(still(speeds=np.full(4, 1.4 * HOVER)))
    passed(part, 5.0)
    assert part._error == pytest.approx(error, rel=0.05)
    part.gain(still())
    passed(part, 100.0)
    assert part.gain(still()) == pytest.approx(1.0 + part.share * part.STAYS)
    shares = {Converging(2.0, PARAMS, np.random.default_rng(k)).share for k in range(20)}
    assert shares == {-0.014, 0.014}


def test_a_bird_carries_itself_the_more_the_faster_it_is_towed():
    part, true = part_of(Kiting), dict(PARAMS)
    part.alter(true, PARAMS)
    weight = (true['mass'] - PARAMS['mass']) * GRAVITY
    assert weight == pytest.approx(part.HANGS * part.parameters['mass'] * GRAVITY)
    lifts = []
    for speed in (0.1, 0.2, part.HALF, 100.0):
        now = still(air=np.array([0.6 * speed, 0.8 * speed, 1.0]))
        part.wrench(now)
        passed(part, 10.0)
        force, moment = part.wrench(now)
        assert force[:2] == pytest.approx([0.0, 0.0]) and not np.any(moment)
        lifts.append(force[2] / weight)
    assert lifts[1] / lifts[0] == pytest.approx(4.0, rel=0.02)
    assert lifts[2:] == pytest.approx([0.5 * part.CARRIES, part.CARRIES], rel=1e-3)


def test_the_lift_of_a_bird_is_upright_and_takes_its_time():
    part, lean = part_of(Kiting), Rotation.from_euler('xy', [0.2, -0.3]).as_matrix()
    now = still(rotation=lean, air=lean.T @ [2.0, 0.0, 0.5])
    assert not np.any(part.wrench(now)[0])
    passed(part, part.TIME)
    force = lean @ part.wrench(now)[0]
    square = (2.0 / part.HALF) ** 2
    share = part.CARRIES * square / (1.0 + square) * (1.0 - np.exp(-1.0))
    assert force == pytest.approx([0.0, 0.0, part.bird * GRAVITY * share])


def test_grains_run_out_evenly_or_not_at_all():
    part, t = part_of(Arching), np.arange(0.0, 20.0, 0.01)
    masses, mean = np.array([part.mass(time) for time in t]), part.parameters['mass']
    rates = -np.diff(masses) / 0.01 / mean
    even = part.RUNS / 20.0
    assert masses[0] == pytest.approx(part.FIRST * mean)
    between = (np.abs(rates) > 1e-9) & (np.abs(rates - even) > 1e-9)
    assert np.count_nonzero(between) <= np.count_nonzero(part.times < 20.0)
    assert 0.2 < np.mean(rates > 0.5 * even) < 0.95
    # Without a jam the last ones stay at last.
    part.times, part.ran = np.array([0.0, 100.0]), np.array([0.0, 100.0])
    assert part.mass(10.0) == pytest.approx((part.FIRST - 0.5 * part.RUNS) * mean)
    assert part.mass(99.0) == pytest.approx(part.STAYS * mean)


def test_jams_last_for_times_by_a_power_law_and_the_mean_is_as_said():
    part, jams, means = part_of(Arching), [], []
    for k in range(200):
        part.begin(np.random.default_rng(k))
        jams.append(np.diff(part.times)[1::2])
        means.append(np.mean([part.mass(time) for time in np.arange(0.0, 20.0, 0.5)]))
        assert np.diff(part.times)[::2] == pytest.approx(np.diff(part.ran)[::2])
        assert part.times[-1] > 60.0
    jams = np.concatenate(jams)
    for long in (0.8, 1.6, 3.2):
        share = (long / part.JAMS) ** (1.0 - part.POWER)
        assert np.mean(jams > long) == pytest.approx(share, rel=0.1)
    assert np.min(jams) >= part.JAMS and np.max(jams) == pytest.approx(part.MOST)
    assert np.mean(means) == pytest.approx(part.parameters['mass'], rel=0.1)
    # The same flight draws the same.
    part.begin(np.random.default_rng(7))
    one = part.times
    part.begin(np.random.default_rng(7))
    assert np.array_equal(one, part.times)
