# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of thrust, ground, battery and mass that the twenty-third draw is the first to fly."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import (
    drained,
    fresh,
    HOVER,
    PARAMS,
    part_of,
    PLACES,
    REST,
    still,
    turning,
)

from withheld.constants import GRAVITY
from withheld.forms.brushes import OpenLoop
from withheld.forms.cinewhoops import Choked
from withheld.forms.downloads import Downloaded
from withheld.forms.gratings import Grated
from withheld.forms.kinetics import Kinetic
from withheld.forms.parcels import Upwashed
from withheld.forms.rimes import Rimed
from withheld.forms.tethers import Tethered
from withheld.forms.windings import Warmed


@pytest.mark.parametrize('kind', [Upwashed, Downloaded])
def test_flow_is_measured_by_what_a_rotor_moves_itself_and_rest_is_nothing(kind):
    rotor, air = part_of(kind), np.array([0.8, -0.5, 0.3])
    slow = rotor.gain(still(air=air))
    fast = rotor.gain(still(air=1.2 * air, speeds=np.full(4, 1.2 * HOVER)))
    assert fast == pytest.approx(slow) and np.ptp(slow) > 1e-3
    assert rotor.gain(still(speeds=np.full(4, 0.7 * HOVER))) == pytest.approx(np.ones(4))


def test_air_around_a_parcel_slides_along_it_and_is_not_squeezed():
    part, velocity, step = part_of(Upwashed), np.array([2.0, -1.0, 0.5]), 1e-5
    for way in np.random.default_rng(1).normal(size=(10, 3)):
        out = way / np.linalg.norm(way)
        skin = part.middle + part.wide * out
        # What is at its skin goes along with it, as far as it goes out.
        assert out @ part.parted(skin[None], velocity)[0] == pytest.approx(out @ velocity)
        place = skin + 0.1 * out
        slopes = np.array([(part.parted((place + step * axis)[None], velocity)
                            - part.parted((place - step * axis)[None], velocity))[0]
                           for axis in np.eye(3)]) / (2.0 * step)
        assert np.trace(slopes) == pytest.approx(0.0, abs=1e-6)
        assert slopes == pytest.approx(slopes.T, abs=1e-6)
    away = np.linalg.norm(PLACES - part.middle, axis=1)
    assert np.all(away > 1.2 * part.wide)


def test_a_parcel_lifts_rotors_in_front_as_much_as_it_takes_behind():
    part, speed = part_of(Upwashed), 0.3
    gains = part.gain(still(air=np.array([speed * part.induced, 0.0, 0.0])))
    back = part.gain(still(air=np.array([-speed * part.induced, 0.0, 0.0])))
    front, behind = gains[PLACES[:, 0] > 0.0], gains[PLACES[:, 0] < 0.0]
    assert np.ptp(front) < 1e-12 and np.ptp(behind) < 1e-12 and front[0] > behind[0]
    assert back == pytest.approx(gains[[3, 2, 1, 0]])
    # By hand, from the doublet in the middle of the parcel.
    long, low = np.hypot(*PLACES[0, :2]), part.BELOW * np.hypot(*PLACES[0, :2])
    share = 1.5 * part.wide ** 3 * PLACES[0, 0] * low / np.hypot(long, low) ** 5
    assert front[0] - behind[0] == pytest.approx(2.0 * 2.0 * part.TAKES * share * speed)
    assert np.mean(gains) > 1.0


def test_a_climb_meets_more_air_beside_a_parcel():
    part = part_of(Upwashed)
    up, down = (part.gain(still(air=np.array([0.0, 0.0, z * part.induced]))) for z in (0.4, -0.4))
    assert np.ptp(up) < 1e-12 and np.ptp(down) < 1e-12
    less, more = 1.0 - up[0], down[0] - 1.0
    # At rotors that are not far above its middle, it goes down past them as it comes up.
    assert less > 2.0 * 0.4 * part.TAKES and less == pytest.approx(more, rel=0.1)


def test_how_much_of_an_arm_is_in_the_wake_by_points_on_it():
    part, long = part_of(Downloaded), 1.7
    points = np.linspace(0.0, long, 20001)
    for inwards, across in ((0.0, 0.0), (0.4, 0.0), (-0.4, 0.0), (1.2, 0.3), (0.1, 0.7),
                            (0.0, 1.0), (-1.0, 0.0), (3.0, 0.0)):
        inside = np.hypot(points - inwards, across) < part.WIDE
        assert part.covered(*np.array([[inwards], [across], [long]])) == pytest.approx(
            [np.mean(inside) * long / part.WIDE], abs=1e-3)


def test_flight_takes_the_wake_off_arms_across_and_onto_those_ahead():
    part, arm = part_of(Downloaded), PLACES[0, :2] / np.linalg.norm(PLACES[0, :2])

    def change(air):
        return (part.gain(still(air=part.induced * np.array([*air, 0.0]))) - 1.0) / 2.0

    ahead = change(0.4 * arm)
    # Of the first rotor it blows along the arm, inwards; of the third, outwards; others, across.
    assert ahead[1] == pytest.approx(ahead[3]) and ahead[0] < ahead[1] < ahead[2]
    assert change(-0.4 * arm) == pytest.approx(ahead[[2, 3, 0, 1]])
    fast = [np.mean(change(speed * arm)) for speed in (0.0, 0.3, 0.6, 1.0, 2.0, 3.0)]
    assert np.all(np.diff(fast) > 0.0) and fast[0] == pytest.approx(0.0, abs=1e-12)
    assert fast[-1] == pytest.approx(part.PRESSES, rel=0.05)


def test_a_climb_presses_with_the_square_of_the_flow():
    part = part_of(Downloaded)
    for climb in (-0.5, -0.1, 0.2, 0.6):
        gain = part.gain(still(air=np.array([0.0, 0.0, climb * part.induced])))
        assert gain == pytest.approx(np.full(4, 1.0 - 2.0 * part.PRESSES * (
            (1.0 + climb) ** 2 - 1.0)))


def test_ducts_have_most_of_the_ground_at_a_radius():
    part = part_of(Choked)
    heights = np.linspace(0.5, 12.0, 2000)
    gains = np.array([part.gain(still(heights=np.full(4, one * part.radius)))[0]
                      for one in heights])
    best = heights[np.argmax(gains)]
    assert best == pytest.approx(np.log(
        part.LIPS * part.CHOKES / (part.BLADES * part.FADES)) / (part.CHOKES - part.FADES),
        abs=0.01)
    assert 0.8 < best < 1.5
    assert np.all(np.diff(gains[heights > best + 0.1]) < 0.0)
    assert gains[-1] == pytest.approx(1.0, abs=1e-3) and gains[0] < gains.max()
    # Each rotor by its own height.
    own = part.gain(still(heights=np.array([0.1, 0.2, 0.1, 0.2])))
    assert own[0] == own[2] != own[1] == own[3]


def test_slow_flight_clears_the_outlets_and_fast_flight_takes_the_cushion():
    part, gains = part_of(Choked), []
    for speed in (0.0, 0.2, part.CLEARS, 2.0, 8.0):
        ways = [part.gain(still(heights=np.full(4, 0.06), air=speed * part.induced * np.array(
            [np.cos(angle), np.sin(angle), 0.0])))[0] for angle in (0.0, 1.0, 4.0)]
        assert np.ptp(ways) < 1e-12
        gains.append(ways[0])
    assert gains[0] < gains[1] < gains[2] > gains[3] > gains[4]
    assert gains[4] == pytest.approx(1.0, abs=0.02)


def test_a_grating_holds_what_comes_askew_across_its_bars():
    part = part_of(Grated)
    along = np.array([-part.across[1], part.across[0], 0.0])
    for speed in (0.1, 0.4, 1.0, 3.0):
        for turned in (np.eye(3), Rotation.from_euler('z', 1.1).as_matrix()):
            def held(air, turned=turned):
                return part.held(still(air=turned.T @ (part.induced * air), rotation=turned))
            assert held(speed * along) == pytest.approx(part.HOLDS)
            assert held(speed * part.across) == pytest.approx(held(-speed * part.across))
            share = speed ** 2 / (speed ** 2 + part.ASKEW ** 2)
            assert held(speed * part.across) == pytest.approx(
                part.HOLDS + (1.0 - part.HOLDS) * share)


def test_a_grating_gives_what_it_holds_and_the_floor_below_the_rest():
    part = part_of(Grated)
    near, deep = part.GAIN / 2.0 ** 2, part.GAIN / (2.0 + part.FLOOR) ** 2
    rest = (part.gain(still(heights=np.full(4, part.radius))) - 1.0) / 2.0
    assert rest == pytest.approx(np.full(4, part.HOLDS * near + (1.0 - part.HOLDS) * deep))
    fast = part.gain(still(heights=np.full(4, part.radius), air=50.0 * part.across))
    assert (fast - 1.0) / 2.0 == pytest.approx(np.full(4, near), rel=0.01)
    heights = np.linspace(0.5, 10.0, 50) * part.radius
    gains = [part.gain(still(heights=np.full(4, one)))[0] for one in heights]
    assert np.all(np.diff(gains) < 0.0)


def sagged(battery, turns, step=0.01):
    """Return the sags over the size, for speeds of all rotors over that in hover."""
    return (1.0 - drained(battery, turns, step)) / battery.size


def test_a_voltage_is_what_the_speed_and_what_the_current_take():
    battery = part_of(OpenLoop)
    battery.ratio = 0.9
    for turns in (np.full(4, 0.7), np.ones(4), np.array([0.8, 1.3, 1.0, 1.1])):
        gains = battery.gain(turns)
        assert battery.share(turns * np.sqrt(gains)) == pytest.approx(0.9 * battery.share(turns))
        assert np.all((gains > 0.9 ** 2) & (gains < 0.9))
    battery.ratio = 0.0
    assert battery.gain(np.ones(4)) == pytest.approx(np.zeros(4), abs=1e-12)
    assert battery.share(np.ones(4)) == pytest.approx(np.ones(4))


def test_fast_rotors_and_worn_brushes_lose_less_of_a_sag():
    battery = part_of(OpenLoop)
    battery.ratio = 0.95
    gains = np.array([battery.gain(np.full(4, turn)) for turn in (0.6, 0.8, 1.0, 1.3)])
    assert np.all(np.diff(gains, axis=0) > 0.0)
    by_wear = np.argsort(battery.takes)
    assert np.all(np.diff(gains[2][by_wear]) > 0.0)
    # By the power 2 / (1 + takes) for small sags, in hover.
    battery.ratio = 1.0 - 1e-6
    assert (1.0 - battery.gain(np.ones(4))) / 1e-6 == pytest.approx(
        2.0 / (1.0 + battery.takes), rel=1e-4)


def test_a_cell_of_small_motors_falls_by_what_they_draw():
    battery = part_of(OpenLoop)
    sags = sagged(battery, np.ones(3000))
    assert sags[0] == pytest.approx(battery.RESISTS, rel=1e-3)
    assert sags[-1] == pytest.approx(battery.RESISTS + battery.FALLS)
    more = sagged(part_of(OpenLoop), [1.2], step=1e-9)[0]
    assert more / battery.RESISTS == pytest.approx(1.2 ** 2 * np.mean(
        battery.share(np.full(4, 1.2))))


def test_a_cold_cell_is_driven_by_the_inverse_sine_of_its_load():
    for load in (0.1, 0.5, 1.0, 2.0):
        battery = part_of(Kinetic)
        sag = sagged(battery, [load ** (1.0 / 3.0)], step=1e-9)[0]
        assert np.sinh(sag / battery.DRIVES) == pytest.approx(load / (2.0 * battery.EXCHANGES))
    # Warm, it is nearly a resistance; cold, a small load has most already.
    shares = []
    for heat in (0.0, 2.0):
        small, large = (part_of(Kinetic), part_of(Kinetic))
        small._heat = large._heat = heat
        shares.append(sagged(small, [0.5 ** (1.0 / 3.0)])[0] / sagged(large, [1.0])[0])
    assert 0.5 < shares[1] < shares[0] and shares[0] > 0.65
    assert small.gain(np.ones(4)) == pytest.approx(small.ratio ** 1.8)


def test_a_cold_cell_recovers_as_it_warms_and_then_falls():
    battery = part_of(Kinetic)
    sags = sagged(battery, np.ones(6000))
    lowest = int(np.argmin(sags))
    assert 800 < lowest < 5000 and sags[0] > sags[lowest] + 0.005 and sags[-1] > sags[lowest]
    warm = battery.DRIVES * np.arcsinh(
        np.exp(-battery.WARMS * battery._heat) / (2.0 * battery.EXCHANGES))
    assert sags[-1] == pytest.approx(warm + 2.0 * battery.FALLS, rel=1e-3)
    assert battery._heat == pytest.approx(1.0, abs=1e-2)
    drained(battery, np.full(6000, 2.0))
    assert battery._heat == pytest.approx(battery.MOST, abs=1e-2)


def test_motors_lose_more_as_they_warm_each_as_it_is_cooled():
    part = part_of(Warmed)
    cold = (part.gain(still()) - 1.0) / part.share
    assert cold == pytest.approx(np.full(4, part.COLD)) and part.share < 0.0
    losses = []
    for _ in range(20):
        losses.append((part.gain(turning(part, 1.0, 1.0)) - 1.0) / part.share)
    t = np.arange(1.0, 21.0)[:, None]
    assert np.array(losses) == pytest.approx(part.COLD + part.MORE * part.heats * (
        1.0 - np.exp(-t / part.TIME)))
    assert np.mean(losses) == pytest.approx(1.0, abs=0.12)
    # At once, a loss goes with the speed.
    fast = (part.gain(still(speeds=np.full(4, 1.3 * HOVER))) - 1.0) / part.share
    assert fast == pytest.approx(1.3 * losses[-1])


def test_a_motor_heats_with_the_fourth_power_of_its_speed_and_cools_again():
    part = part_of(Warmed)
    turning(part, 1.1, 60.0)
    assert part._heat == pytest.approx(1.1 ** 4 * part.heats, rel=1e-3)
    turning(part, 2.0, 60.0)
    assert part._heat == pytest.approx(np.full(4, part.MOST), rel=1e-3)
    turning(part, 0.0, part.TIME)
    assert part._heat == pytest.approx(np.full(4, part.MOST * np.exp(-1.0)), rel=1e-3)


def test_a_tether_pulls_to_its_winch_by_the_same_everywhere():
    part, weight = part_of(Tethered), part_of(Tethered).parameters['mass'] * GRAVITY
    leans = Rotation.from_euler('xyz', [0.3, -0.2, 1.0]).as_matrix()
    for place in (np.array([*part.winch[:2], 1.0]), np.array([1.0, -2.0, 1.5]),
                  np.array([-0.5, 0.5, 0.3])):
        force, moment = part.wrench(still(position=place, rotation=leans))
        onto = part.winch - place
        assert leans @ force == pytest.approx(weight * onto / np.linalg.norm(onto))
        assert not np.any(moment)
    above, true = still(position=np.array([*part.winch[:2], 2.0])), fresh()
    assert part.wrench(above)[0] == pytest.approx([0.0, 0.0, -weight])
    part.alter(true, PARAMS)
    assert true['mass'] == PARAMS['mass']       # it has no inertia


def test_a_tether_rubs_both_ways_by_the_law_of_the_capstan():
    part, weight = part_of(Tethered), part_of(Tethered).parameters['mass'] * GRAVITY
    pulls = []
    for place in (np.array([*part.winch[:2], 1.0]), np.array([3.0, 0.0, 1.0])):
        along = (place - part.winch) / np.linalg.norm(place - part.winch)
        for speed in (2.0, -2.0):
            force = part.wrench(still(position=place, velocity=speed * along))[0]
            pulls.append(np.linalg.norm(force) / weight)
        bent = part.BENT + np.arccos(along[2])
        assert pulls[-2:] == pytest.approx(np.exp(np.array([1.0, -1.0]) * part.RUBS * bent))
        # What goes around the winch neither pays out nor takes in.
        across = np.cross(along, [0.3, 1.0, 0.2])
        assert np.linalg.norm(part.wrench(still(position=place, velocity=across))[0]) == (
            pytest.approx(weight))
    assert pulls[2] > pulls[0] > 1.0 > pulls[1] > pulls[3]


def test_rime_comes_faster_with_the_flight_as_more_droplets_hit():
    part = part_of(Rimed)
    assert part.hits(1.0) == pytest.approx(1.0) and part.hits(0.0) == 0.0
    # With the square of what is slow, and with what is fast.
    assert part.hits(2e-3) / part.hits(1e-3) == pytest.approx(4.0, rel=1e-2)
    assert part.hits(2e3) / part.hits(1e3) == pytest.approx(2.0, rel=1e-2)
    came = []
    for air in (REST, np.array([part.induced, 0.0, 0.0]), np.array([0.0, -part.induced, 0.0]),
                np.array([0.0, 0.0, -part.induced])):
        before = part._ice.copy()
        part.wrench(still(air=air))
        part.after(1e-6, np.eye(3), REST)
        came.append(np.mean(part._ice - before) / (1e-6 * part.GROWS))
    assert came == pytest.approx([1.0, part.hits(np.sqrt(2.0)), part.hits(np.sqrt(2.0)), 0.0],
                                 rel=1e-4, abs=1e-9)


@pytest.mark.slow
def test_rime_breaks_off_place_by_place_and_is_about_its_mean():
    means = []
    for seed in range(40):
        part = part_of(Rimed, seed=seed)
        ice = []
        for _ in range(2000):
            part.wrench(still(air=np.array([1.0, 0.0, 0.0])))
            part.after(0.01, np.eye(3), REST)
            ice.append(part._ice)
        ice = np.array(ice)
        falls = np.diff(ice, axis=0) < 0.0
        assert np.all(falls.sum(axis=1) <= 3) and falls.any()
        assert ice[1:][falls] == pytest.approx(np.full(falls.sum(), part.LEFT))
        assert ice[:-1][falls] == pytest.approx((part._breaks + 0.0 * ice[:-1])[falls], abs=2e-3)
        means.append(ice.mean())
    assert np.mean(means) == pytest.approx(1.0, abs=0.1)


def test_rime_has_weight_and_inertia():
    part, true = part_of(Rimed), fresh()
    part.alter(true, PARAMS)
    mean = part.parameters['mass']
    assert true['mass'] == pytest.approx(PARAMS['mass'] + mean)
    leans, moves = Rotation.from_euler('xy', [0.3, -0.2]).as_matrix(), np.array([1.0, -2.0, 0.5])
    part.after(0.01, leans, moves)
    more = (np.mean(part._ice) - 1.0) * mean
    force, moment = part.wrench(still(rotation=leans))
    assert leans @ force == pytest.approx(-more * (moves + [0.0, 0.0, GRAVITY]))
    assert not np.any(moment)
