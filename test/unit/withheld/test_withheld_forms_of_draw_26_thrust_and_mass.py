# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of inflow, ground, battery, thrust and mass that the twenty-sixth draw flies."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import above, drained, HOVER, PARAMS, part_of, RADIUS, still

from withheld.constants import GRAVITY
from withheld.forms.cans import Pressurised
from withheld.forms.coaxials import Coaxial
from withheld.forms.contacts import Chattering
from withheld.forms.dusts import Dusted
from withheld.forms.linkages import Surging
from withheld.forms.nozzles import Nozzled
from withheld.forms.pulleys import Balanced
from withheld.forms.roofs import Gabled
from withheld.forms.strakes import Fenced


@pytest.mark.parametrize('kind', [Coaxial, Nozzled])
def test_rotors_at_rest_are_nominal_and_a_climb_takes_thrust(kind):
    part = part_of(kind)
    assert part.gain(still()) == pytest.approx(np.ones(4))
    climbs = part.gain(still(air=np.array([0.0, 0.0, 2.0])))
    assert np.all(climbs < 0.99) and np.ptp(climbs) < 1e-12


def test_a_lower_rotor_has_the_upper_ones_wake_until_flight_sweeps_it_off():
    part = part_of(Coaxial)
    # All that has come through the upper disk is within its wake's radius, by continuity.
    speed = 1.0 + part.APART / np.hypot(1.0, part.APART)
    assert part.narrow() ** 2 * speed == pytest.approx(1.0)
    narrow = part.narrow()
    assert part.meets(np.array([0.0, 1.0 - narrow, 1.0, 1.0 + narrow, 3.0])) == pytest.approx(
        [1.0, 1.0, 0.5, 0.0, 0.0])
    climb, across = (one.ravel() for one in np.meshgrid(
        np.linspace(part.LEAST, 3.0, 14), np.linspace(0.0, 4.0, 9)))
    flow = part.flow(climb, across)
    assert flow * np.hypot(across, climb + flow) == pytest.approx(np.ones(126), abs=2e-3)
    # Fast, both are alone: through each goes what goes through one.
    fast = part.gain(still(air=np.array([4.0 * part.induced, 0.0, 0.0])))
    alone = part.flow(np.zeros(1), np.array([4.0]))[0]
    assert fast == pytest.approx(np.full(4, 1.0 + part.size * part.TAKES * (
        part.HOVER - 2.0 * alone)))


def test_a_jet_has_the_pressure_of_its_fan_and_the_momentum_that_it_adds():
    part = part_of(Nozzled)
    for climb, across in ((0.0, 0.0), (0.4, 0.0), (-0.3, 0.2), (0.2, 0.5)):
        jet = float(part.jet(np.array(climb), np.array(across)))
        fan = (1.0 + part.LOSES) * (1.0 + part.FALLS * (1.0 - jet))
        lip = part.LIP * max(across - part.CLINGS, 0.0) ** 2
        assert fan + climb * abs(climb) - lip == pytest.approx((1.0 + part.LOSES) * jet ** 2)
    whole = part.induced * np.sqrt(2.0 / part.NOZZLE)
    gain = part.gain(still(air=np.array([0.0, 0.0, 0.4 * whole])))
    jet = float(part.jet(np.array(0.4), np.array(0.0)))
    assert jet > 1.0 and gain == pytest.approx(np.full(4, 1.0 + part.size * part.SHARE * (
        jet * (jet - 0.4) - 1.0)))


def test_level_flight_gives_a_jet_nothing_and_takes_some_once_the_flow_parts():
    part = part_of(Nozzled)
    whole = part.induced * np.sqrt(2.0 / part.NOZZLE)
    clings, parts = (part.gain(still(air=np.array([0.0, share * whole, 0.0]))) for share in (
        part.CLINGS, 3.0 * part.CLINGS))
    assert clings == pytest.approx(np.ones(4)) and np.all(parts < 0.99)


def test_a_fountain_is_held_between_strakes_in_still_hover_near_ground():
    part = part_of(Fenced)
    image = 1.0 / (1.0 - 1.0 / 64.0) - 1.0
    assert part.gain(above(2.0)) == pytest.approx(np.full(
        4, 1.0 + part.size * (image + part.HOLDS * np.exp(-2.0 * part.FADES))))
    assert part.gain(above(40.0)) == pytest.approx(np.ones(4), abs=2e-4)
    # Half of it goes past where it is so far behind.
    flies = above(2.0, air=np.array([part.HALF / 2.0 * part.induced, 0.0, 0.0]))
    assert part.shift(2.0, flies) == pytest.approx([-part.HALF, 0.0])
    swept = (1.0 / 64.0) / (1.0 + (part.HALF / 2.0) ** 2)
    assert part.gain(flies)[0] == pytest.approx(1.0 + part.size * (
        swept / (1.0 - swept) + 0.5 * part.HOLDS * np.exp(-2.0 * part.FADES)))


def test_a_fountain_rises_upright_and_away_from_strong_rotors():
    part = part_of(Fenced)
    strong = HOVER * np.sqrt([1.1, 0.9, 0.9, 1.1])      # those to the left
    shift = part.shift(2.0, above(2.0, speeds=strong))
    assert shift == pytest.approx([0.0, -part.MOVES * 0.1 * 0.12 / RADIUS])
    lean = Rotation.from_euler('y', 0.2).as_matrix()
    # Nose down: what rises from below the middle passes behind it, for the body's up leans ahead.
    assert part.shift(2.0, above(2.0, rotation=lean)) == pytest.approx(
        [-2.0 * np.tan(0.2), 0.0])


def test_a_roof_falls_off_to_both_sides_of_its_ridge():
    part = part_of(Gabled)
    part.across, part.ridge = np.array([1.0, 0.0, 0.0]), 0.1

    def gain(place, **others):
        return part.gain(above(2.0, position=np.array([place, 3.0, 1.0]),
                               places=np.zeros((4, 3)), **others))[0] - 1.0

    assert gain(0.1 + 0.4) == pytest.approx(gain(0.1 - 0.4))
    # Far off, a radius aside counts as its fall, at right angles to the slope.
    slope = np.exp(-part.FADES * np.sin(part.PITCH))
    assert gain(1.6) / gain(1.5) == pytest.approx(slope, rel=2e-3)
    ridge = part.size * part.GAINS * np.exp(-part.FADES * 2.0 * np.cos(part.PITCH))
    assert gain(0.1) == pytest.approx((1.0 - part.SPLITS) * ridge)
    # A wake that flight leaves behind by 4 radii meets the roof there.
    flow = np.array([4.0 / 2.0 / part.TRAILS * part.induced / 2.0, 0.0, 0.0])
    assert gain(0.6, air=flow) == pytest.approx(gain(0.6 - 2.0 * RADIUS))
    drawn = Gabled(2.0, PARAMS, np.random.default_rng(5))
    assert np.linalg.norm(drawn.across) == pytest.approx(1.0) and drawn.ridge != part.ridge


def test_contacts_resist_most_where_all_rotors_turn_at_their_resonance():
    battery = part_of(Chattering)
    worst = battery.resists(np.full(4, battery.resonance))
    assert worst == pytest.approx((1.0 - battery.TAKES) ** -0.5)
    assert battery.resists(np.full(4, 3.0)) == pytest.approx(1.0, abs=2e-3)
    # Half of it a width aside, and half of it for half of the rotors.
    half = (1.0 - 0.5 * battery.TAKES) ** -0.5
    assert battery.resists(np.full(4, battery.resonance + battery.WIDE)) == pytest.approx(half)
    two = np.array([0.0, 0.0, 9.0, 9.0]) + [battery.resonance, battery.resonance, 0.0, 0.0]
    assert battery.resists(two) == pytest.approx(half, rel=1e-3)
    ratios = drained(battery, np.ones(3000))
    assert ratios[-1] == pytest.approx(1.0 - battery.size * (
        battery.RESISTS * battery.resists(np.ones(4)) + battery.FALLS))


def test_a_governor_without_play_answers_a_load_by_its_oscillation_that_dies_away():
    battery = part_of(Surging)
    battery.PLAY, battery._gives, battery.FINE = 0.0, 1.0, 0.0005
    load, t = 1.2, 0.01 * np.arange(1, 301)
    ratios = drained(battery, np.full(300, load ** (1.0 / 3.0)))
    natural = np.sqrt(battery.INTEGRAL / battery.INERTIA)
    dies = 0.5 * battery.GAIN / battery.INERTIA
    swings = np.sqrt(natural ** 2 - dies ** 2)
    speed = -0.2 / (battery.INERTIA * swings) * np.exp(-dies * t) * np.sin(swings * t)
    wanted = 1.0 - battery.size * (battery.RESISTS * load - battery.SWINGS * speed)
    assert ratios == pytest.approx(wanted, abs=2e-2 * np.ptp(wanted))


def test_an_engine_with_play_hunts_for_ever_by_as_much_as_there_is_play():
    def hunts(play):
        battery = part_of(Surging)
        battery.PLAY, battery._gives = play, 1.0 + 0.9 * play
        return drained(battery, np.ones(4000)) - (1.0 - battery.size * battery.RESISTS)

    one, two = hunts(0.25), hunts(0.5)
    assert two == pytest.approx(2.0 * one, abs=1e-12)
    assert np.ptp(one[2000:3000]) == pytest.approx(np.ptp(one[3000:]), rel=0.02)
    assert np.ptp(one[3000:]) > 0.2 * Surging.SWINGS
    crossings = np.count_nonzero(np.diff(np.sign(one[2000:])) > 0)
    assert 8 < crossings < 40      # in 20 s


def test_dust_acts_from_the_tips_to_a_radius_by_the_speed_and_the_dust():
    part = part_of(Dusted)
    assert part.gain(still(time=0.0)) == pytest.approx(np.ones(4))
    turn = np.array([0.5, 1.0, 1.1, 2.2])
    gain = part.gain(still(time=0.0, speeds=HOVER * turn))
    assert gain == pytest.approx([1.0, 1.0, 1.0, 1.0 + part.share * 7.0 / 8.0])
    # Twice the dust: from half the speed on.
    gain = part.gain(still(time=part.TIME, speeds=HOVER * turn))
    assert gain == pytest.approx(1.0 + part.share * (
        1.0 - np.minimum(0.55 / turn, 1.0) ** 3))
    shares = {Dusted(2.0, PARAMS, np.random.default_rng(k)).share for k in range(20)}
    assert shares == {-0.04, 0.04}


def test_a_counterweight_takes_from_the_weight_what_it_adds_to_the_mass():
    part, lean = part_of(Balanced), Rotation.from_euler('xy', [0.2, -0.3]).as_matrix()
    weight = -part.parameters['mass'] * GRAVITY
    assert weight > 0.0
    for rises in (0.0, 2.0, -3.0):
        part.after(0.01, lean, np.array([1.0, 2.0, rises]))
        force, moment = part.wrench(still(rotation=lean))
        assert lean @ force == pytest.approx([0.0, 0.0, weight * (1.0 - rises / GRAVITY)])
        assert not np.any(moment)
    # Atwood's machine: let go, the line pulls by twice the product of the masses over the sum.
    mass, other = PARAMS['mass'], -part.parameters['mass']
    falls = (mass - other) / (mass + other) * GRAVITY
    part.after(0.01, np.eye(3), np.array([0.0, 0.0, -falls]))
    assert part.wrench(still())[0][2] == pytest.approx(
        2.0 * mass * other / (mass + other) * GRAVITY)


def test_a_pulley_rubs_against_the_way_and_a_slack_line_does_not_push():
    part = part_of(Balanced)
    up, rest, down = (part.wrench(still(velocity=np.array([0.0, 0.0, v])))[0][2]
                      for v in (5.0, 0.0, -5.0))
    assert [up / rest, down / rest] == pytest.approx([1.0 - part.RUBS, 1.0 + part.RUBS])
    part.after(0.01, np.eye(3), np.array([0.0, 0.0, 15.0]))
    assert not np.any(part.wrench(still())[0])


def test_a_can_empties_by_the_root_of_the_pressure_of_its_gas():
    part, mean = part_of(Pressurised), part_of(Pressurised).parameters['mass']
    part.times, part.opened = np.array([0.0, 100.0]), np.array([0.0, 100.0])
    assert part.mass(0.0) == pytest.approx(part.FIRST * mean)
    assert part.mass(part.LASTS) == pytest.approx((part.FIRST - part.SPRAYS) * mean)
    assert part.mass(50.0) == part.mass(part.LASTS)
    for time in (0.5, 3.0, 6.0):
        out = part.out(time)
        rate = (part.out(time + 0.05) - part.out(time - 0.05)) / 0.1
        # Boyle: the pressure by the room that the gas has.
        over = part.PRESSURE * part.GAS / (part.GAS + out) - 1.0
        assert rate == pytest.approx(
            part.rate * np.sqrt(over / (part.PRESSURE - 1.0)), rel=5e-3)
    assert part.root(0.0) == pytest.approx(1.0) and part.root(1.0) > 0.2


def test_a_can_sprays_in_bursts_whose_jets_push_up_and_the_mean_is_as_said():
    part, t = part_of(Pressurised), np.arange(0.0, 20.0, 0.01)
    for time in t[::7]:
        wrench = part.wrench(still(time=time))
        flow = -(part.mass(time + 1e-6) - part.mass(time)) / 1e-6
        if wrench is None:
            assert flow == pytest.approx(0.0, abs=1e-9)
        else:
            force, moment = wrench
            jet = part.JET * float(part.root(part.out(time)))
            assert force == pytest.approx([0.0, 0.0, flow * jet], rel=2e-2)
            assert not np.any(moment)
    means = []
    for k in range(200):
        part.begin(np.random.default_rng(k))
        means.append(np.mean([part.mass(time) for time in t[::50]]))
        assert part.times[-1] > 60.0
    assert np.mean(means) == pytest.approx(part.parameters['mass'], rel=0.1)
