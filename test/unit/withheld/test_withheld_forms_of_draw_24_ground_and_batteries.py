# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of inflow, ground, battery, thrust and mass that the twenty-fourth draw flies."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import above, drained, HOVER, PARAMS, part_of, PLACES, REST, still

from withheld.constants import arm_length, GRAVITY
from withheld.forms.bilges import Draining
from withheld.forms.echelons import Echeloned
from withheld.forms.fountains import Adrift
from withheld.forms.hooks import Preloaded
from withheld.forms.regenerations import Regenerating
from withheld.forms.resistances import Faltering
from withheld.forms.spans import TipLosing
from withheld.forms.suckdowns import SuckedDown
from withheld.forms.throttles import Lifted

FRONT, LEFT = PLACES[:, 0] > 0.0, PLACES[:, 1] > 0.0


@pytest.mark.parametrize('kind', [Echeloned, TipLosing])
def test_flow_is_measured_by_what_a_rotor_moves_itself_and_rest_is_nothing(kind):
    rotor, air = part_of(kind), np.array([0.0, 0.0, 0.9])
    slow = rotor.gain(still(air=air))
    fast = rotor.gain(still(air=1.2 * air, speeds=np.full(4, 1.2 * HOVER)))
    assert fast == pytest.approx(slow) and np.all(slow < 1.0)
    assert rotor.gain(still(speeds=np.full(4, 0.7 * HOVER))) == pytest.approx(np.ones(4), abs=1e-5)


def test_vortices_of_one_wing_do_what_biot_and_savart_say():
    part, forward = part_of(Echeloned), np.array([3.0, 0.0])
    part.CORE, part.SINKS = 1e-3, 0.0
    strength = 3.0 / (9.0 + part.STARTS ** 2) / (4.0 * part.HALF)

    def met(x, y):
        away = np.array([[[0.0, 0.0], [x, y]], [[-x, -y], [0.0, 0.0]]])
        return part.met(forward, away, np.array([1.0, 0.0]))[1] / strength

    # By the sum over short pieces of a horseshoe; down is positive.
    b, far = part.HALF, np.arange(0.0005, 400.0, 0.001)
    across = np.linspace(-b, b, 4001)
    across = 0.5 * (across[1:] + across[:-1])
    for x, y in ((-2.4, 0.3), (-1.0, 2.0), (1.5, 2.5), (0.0, 2.4)):
        bound = 2.0 * b / 4000 * np.sum(-x / (x * x + (y - across) ** 2) ** 1.5)
        trails = sum(0.001 * np.sum(off / ((x + far) ** 2 + off ** 2) ** 1.5)
                     for off in (b + y, b - y))
        assert met(x, y) == pytest.approx(bound + trails, rel=2e-3, abs=2e-3)
    # Far behind, it is that of the two that trail alone, twice that of their beginning.
    assert met(-300.0, 0.0) == pytest.approx(4.0 / b, rel=1e-2)
    assert met(-300.0, 3.0) == pytest.approx(2.0 / (b + 3.0) + 2.0 / (b - 3.0), rel=1e-2)


def test_rotors_behind_lose_and_those_at_the_sides_of_a_corner_gain():
    part, speed = part_of(Echeloned), 2.0
    ahead = part.gain(still(air=np.array([speed * part.induced, 0.0, 0.0])))
    back = part.gain(still(air=np.array([-speed * part.induced, 0.0, 0.0])))
    aside = part.gain(still(air=np.array([0.0, speed * part.induced, 0.0])))
    assert np.ptp(ahead[FRONT]) < 1e-12 and np.ptp(ahead[~FRONT]) < 1e-12
    assert ahead[FRONT][0] > ahead[~FRONT][0] + 0.01
    assert back[FRONT] == pytest.approx(ahead[~FRONT])
    assert aside[LEFT] == pytest.approx(ahead[FRONT])
    corner = part.gain(still(air=speed * part.induced * np.array([1.0, 1.0, 0.0]) / 2.0 ** 0.5))
    first, last = np.flatnonzero(FRONT & LEFT)[0], np.flatnonzero(~FRONT & ~LEFT)[0]
    sides = np.flatnonzero(FRONT != LEFT)
    assert corner[sides[0]] == pytest.approx(corner[sides[1]])
    assert corner[sides[0]] > corner[first] > corner[last]


def test_vortices_come_with_flight_and_leave_with_fast_flight():
    part, differs = part_of(Echeloned), []
    for speed in (0.01, 1.5, 30.0):
        gain = part.gain(still(air=np.array([speed * part.induced, 0.0, 0.0])))
        differs.append(gain[FRONT][0] - gain[~FRONT][0])
    assert differs[1] > 0.01 and max(differs[0], differs[2]) < 0.15 * differs[1]
    # A stronger rotor in front takes more of the one behind.
    now, strong = still(air=np.array([8.0, 0.0, 0.0])), np.where(FRONT, 1.2, 1.0)
    assert part.gain(replace(now, speeds=HOVER * strong))[~FRONT][0] < part.gain(now)[~FRONT][0]


def test_blades_and_momentum_agree_on_thrust_and_inflow():
    part = part_of(TipLosing)
    climb, across = (one.ravel() for one in np.meshgrid(
        np.linspace(part.LEAST, 3.0, 14), np.linspace(0.0, 4.0, 9)))
    thrust, flow = part.thrust(climb, across)
    assert flow * np.hypot(across, climb + flow) == pytest.approx(thrust, abs=2e-3)
    assert part.thrust(0.0, 0.0) == pytest.approx((1.0, 1.0), abs=1e-5)
    level = part.thrust(np.zeros(9), np.linspace(0.0, 4.0, 9))[0]
    axial = part.thrust(np.linspace(-0.9, 3.0, 14), np.zeros(14))[0]
    assert np.all(np.diff(level) > 0.0) and np.all(np.diff(axial) < 0.0)


def test_the_span_that_lifts_is_what_the_loss_at_the_tips_leaves():
    part = part_of(TipLosing)
    for inflow in (0.03, 0.1):
        # Prandtl's factor, by how far from the tip, over the radius, of two blades.
        sine = inflow / np.sqrt(1.0 + inflow ** 2)
        away = np.linspace(0.0, 60.0 * sine, 400001)
        lost = 1.0 - 2.0 / np.pi * np.arccos(np.exp(-away / sine))
        lost = np.sum(0.5 * (lost[1:] + lost[:-1])) * away[1]
        assert 1.0 - part.span(inflow) == pytest.approx(lost, rel=1e-3)
    assert part.span(0.0) == part.span(-0.1) == 1.0


def test_without_a_loss_at_the_tips_a_climb_costs_less():
    part, air = part_of(TipLosing), np.array([0.0, 0.0, 2.0])
    with_loss = part.gain(still(air=air))
    part.TIPS = 0.0
    assert np.all(with_loss < part.gain(still(air=air)))
    # Then there is a closed form without flow across: a square in what goes through.
    hover, pitch = part.lift(1.0, 0.0), part.PITCH / 3.0
    climb, half = 0.6, 0.5 * part.INFLOW / hover
    through = 0.5 * (climb - half + np.sqrt((climb - half) ** 2 + 4.0 * pitch / hover))
    assert part.thrust(climb, 0.0)[1] + climb == pytest.approx(through)


def test_a_plate_is_sucked_down_by_the_power_that_was_measured():
    part = part_of(SuckedDown)
    plate = 2.0 * (arm_length(PARAMS) + part.BEYOND * part.radius)
    assert part.wider * part.radius == pytest.approx(plate - 4.0 * part.radius)
    sucked = []
    for height in (1.5, 3.0):
        image = 1.0 / (1.0 - (0.25 / height) ** 2) - 1.0
        sucks = image - (part.gain(above(height))[0] - 1.0) / part.size
        sucked.append(1.0 / (1.0 / sucks - 1.0 / part.MOST))    # without a limit
    assert sucked[0] / sucked[1] == pytest.approx(2.0 ** part.POWER)
    assert sucked[1] == pytest.approx(part.SUCKS * (part.wider / 3.0) ** part.POWER)


def test_near_ground_a_plate_takes_more_than_ground_gives_and_flight_leaves_both():
    part = part_of(SuckedDown)
    gains = [part.gain(above(h))[0] for h in (1.0, 1.5, 2.0, 3.0, 6.0, 100.0)]
    assert np.all(np.diff(gains) > 0.0) and gains[0] < 0.95 and 1.0 - gains[-1] < 1e-4
    assert part.gain(above(0.5))[0] > 1.0
    fast = part.gain(above(2.0, air=np.array([3.0 * part.induced, 0.0, 0.0])))[0]
    assert fast - 1.0 == pytest.approx((gains[2] - 1.0) / 10.0, rel=0.1)
    assert part.gain(above(0.0)) == pytest.approx(part.gain(above(0.5)))
    # What is sucked down is one plate: of rotors, the nearer one still has more.
    tilted = part.gain(still(heights=part.radius * np.array([1.5, 2.0, 2.5, 2.0])))
    assert tilted[0] > tilted[1] == tilted[3] > tilted[2]


def test_a_fountain_lifts_in_the_middle_where_it_is_level_and_at_rest():
    part, weight = part_of(Adrift), PARAMS['mass'] * GRAVITY
    for height in (1.0, 2.0):
        force, moment = part.wrench(above(height))
        lift = part.size * part.LIFTS * weight * np.exp(-part.FALLS * height)
        assert force == pytest.approx([0.0, 0.0, lift]) and moment == pytest.approx(REST)
        strong, _ = part.wrench(above(height, speeds=np.full(4, 1.1 * HOVER)))
        assert strong == pytest.approx(1.21 * force)
        assert part.gain(above(height)) == pytest.approx(np.full(
            4, 1.0 + part.size * part.ROTORS * np.exp(-part.FADES * height)))
    assert np.linalg.norm(part.wrench(above(30.0))[0]) < 1e-6


def test_flight_leaves_the_fountain_behind_which_turns_the_nose_down_until_it_misses():
    part, moments = part_of(Adrift), []
    for speed in (0.1, 1.0, 10.0):
        now = above(1.0, air=np.array([speed, 0.0, 0.0]))
        assert part.place(now) == pytest.approx([-speed / part.induced * part.radius, 0.0, 0.0])
        force, moment = part.wrench(now)
        # Lift behind the centre turns the nose down: about y, in x forward and z up.
        assert moment == pytest.approx([0.0, -part.place(now)[0] * force[2], 0.0])
        moments.append(moment[1])
    assert min(moments) >= 0.0 and moments[1] > 2.0 * max(moments[0], moments[2])
    left = part.wrench(above(1.0, air=np.array([0.0, 1.0, 0.0])))[1]
    assert left == pytest.approx([-moments[1], 0.0, 0.0])


def test_a_fountain_rises_upright_from_where_the_body_s_axis_points():
    part, heading = part_of(Adrift), Rotation.from_euler('z', 0.7).as_matrix()
    lean = Rotation.from_euler('y', 0.2).as_matrix()
    now = above(1.5, rotation=lean)
    # The axis goes up ahead, so that the wakes meet the ground behind.
    assert part.place(now) == pytest.approx([-1.5 * part.radius * np.tan(0.2), 0.0, 0.0])
    force, moment = part.wrench(now)
    assert lean @ force == pytest.approx([0.0, 0.0, np.linalg.norm(force)])
    turned = part.wrench(above(1.5, rotation=heading @ lean))
    assert turned[0] == pytest.approx(force) and turned[1] == pytest.approx(moment)
    assert np.isfinite(part.wrench(above(1.5, rotation=np.diag([1.0, -1.0, -1.0])))).all()


def test_rotors_that_spin_up_take_voltage_and_those_that_slow_down_give_some_back():
    battery = part_of(Regenerating)
    ratios = drained(battery, np.repeat([1.0, 1.2, 1.0], 100))
    steady = 1.0 - battery.size * battery.RESISTS * 1.2 ** 3
    assert ratios[0] == pytest.approx(1.0 - battery.size * battery.RESISTS, abs=1e-4)
    assert ratios[100] < ratios[199] - 0.005 and ratios[200] > ratios[0]
    assert ratios[199] == pytest.approx(steady, abs=5e-3)
    assert ratios[299] < ratios[0]


def test_what_rotors_have_is_what_they_took_and_some_of_it_is_lost():
    charges = []
    for turns in (np.ones(200), np.repeat([1.0, 1.3], 100),
                  np.repeat([1.0, 1.3, 1.0], [50, 75, 75])):
        battery = part_of(Regenerating)
        battery.FOLLOWS = 1e-9
        drained(battery, turns)
        charges.append(battery._taken - 0.01 * np.sum(turns ** 3))
    stored = battery.STORES * (1.3 ** 2 - 1.0)
    assert charges == pytest.approx([0.0, stored, (1.0 - battery.RETURNS) * stored])
    # As one gives what another one takes, little is left of it.
    battery, one = part_of(Regenerating), np.array([1.1, 0.9, 1.0, 1.0])
    battery.FOLLOWS = 1e-9
    drained(battery, [np.ones(4), one])
    spins = battery.STORES * np.array([1.1 ** 2 - 1.0, battery.RETURNS * (0.9 ** 2 - 1.0)])
    assert battery._taken == pytest.approx(0.01 * (1.0 + np.mean(one ** 3)) + np.sum(spins) / 4.0)


def test_a_power_is_what_voltage_and_current_make_and_half_of_the_voltage_gives_the_most():
    battery = part_of(Faltering)
    loads = np.linspace(0.1, 2.0, 20)
    volts = np.array([battery.voltage(one) for one in loads])
    assert volts * (1.0 - volts) / battery.RESISTS == pytest.approx(loads)
    most = 0.25 / battery.RESISTS
    assert battery.voltage(most) == battery.voltage(2.0 * most) == pytest.approx(0.5)
    assert battery.voltage(0.0) == 1.0
    # It falls the faster, the higher the load is already.
    assert np.all(np.diff(volts, 2) < 0.0)


def test_charge_goes_with_a_current_that_grows_as_the_voltage_falls():
    battery = part_of(Faltering)
    first = 1.0 - battery.size * battery.SHARE * (1.0 - battery.voltage(1.0))
    ratios = drained(battery, np.ones(3000))
    falls = -np.diff(ratios)
    assert np.all(falls > 0.0) and falls[-1] > 1.3 * falls[0]
    assert ratios[0] == pytest.approx(first)
    weak = part_of(Faltering)
    assert np.all(drained(weak, np.full(6000, 1.5)) > 0.849) and weak._open >= 0.5


def test_a_wrong_start_of_the_throttle_is_right_at_full_and_a_constant_part_below():
    part, full = part_of(Lifted), PARAMS['rotor_speed_max']
    assert part.gain(still()) == pytest.approx(1.0 + part.share)
    assert part.gain(still(speeds=np.full(4, full))) == pytest.approx(1.0)
    turns = np.array([0.5, 0.8, 1.0, 1.3])
    more = [(part.gain(still(speeds=np.full(4, HOVER * turn))) - 1.0) * turn ** 2
            for turn in turns]
    # A constant part, and one with the square of the speed: nothing at full throttle.
    fit = np.polyfit(turns, more, 2)
    assert fit[1] == pytest.approx(0.0, abs=1e-9)
    assert fit[2] == pytest.approx(-part.full ** 2 * fit[0])
    assert np.isfinite(part.gain(still(speeds=np.zeros(4))))
    # It is that of all rotors together.
    uneven = HOVER * np.array([0.9, 1.1, 0.9, 1.1])
    assert part.gain(still(speeds=uneven)) == pytest.approx(part.gain(still()))


def test_a_thrust_curve_is_more_or_less_by_the_draw_and_full_throttle_is_above_hover():
    shares = {Lifted(2.0, PARAMS, np.random.default_rng(k)).share for k in range(20)}
    assert shares == {-0.014, 0.014}
    weak = Lifted(2.0, PARAMS | {'rotor_speed_max': HOVER}, np.random.default_rng(0))
    assert weak.full == weak.LEAST


def flown(part, pulls, step=0.01, rotation=None):
    """Let a part see accelerations (n,) along its vertical; return what it had and pushed."""
    rotation, seen = np.eye(3) if rotation is None else rotation, []
    for pull in pulls:
        part.after(step, rotation, pull * rotation[:, 2] - [0.0, 0.0, GRAVITY])
        seen.append((part.mass(0.0), (part.wrench(still()) or (REST,))[0][2]))
    return np.array(seen).T


def test_water_runs_out_by_the_root_until_it_is_out():
    part, t = part_of(Draining), np.linspace(0.0, 20.0, 2001)
    masses, mean = np.array([part.mass(time) for time in t]), part.parameters['mass']
    over = np.sqrt(masses - mean * part.STAYS)
    assert np.diff(over[t <= part.LASTS], 2) == pytest.approx(0.0, abs=1e-9)
    assert masses[0] == pytest.approx(mean * (part.STAYS + part.MORE))
    assert np.all(masses[t >= part.LASTS] == pytest.approx(mean * part.STAYS))
    assert np.mean(masses) == pytest.approx(mean, rel=0.02)


def test_a_hook_is_rigid_up_to_its_preload_and_yields_beyond():
    part = part_of(Preloaded)
    _, pushes = flown(part, GRAVITY + np.linspace(-8.0, part.YIELDS - 1e-9, 300))
    assert not np.any(pushes) and part._out == 0.0
    # Beyond, it comes to rest where the spring has the rest of the pull.
    _, pushes = flown(part, np.full(1000, GRAVITY + 2.0))
    assert part._out == pytest.approx((2.0 - part.YIELDS) / part.FREQUENCY ** 2, rel=1e-3)
    assert pushes[0] > 0.0 and pushes[-1] == pytest.approx(0.0, abs=1e-4 * pushes[0])


def test_what_a_hook_takes_it_gives_back_and_the_stop_takes_the_rest():
    part = part_of(Preloaded)
    pulls = GRAVITY + np.where(np.arange(200) < 20, 3.0, -1.0)
    _, pushes = flown(part, pulls)
    # In sum there is no momentum, as it is at the stop at both ends; there, it does not rebound.
    assert part._out == part._speed == 0.0 and np.any(pushes < 0.0)
    assert np.sum(pushes) == pytest.approx(0.0, abs=1e-9)
    back = int(np.argmax(np.cumsum(pushes)[30:] > -1e-12)) + 30
    assert not np.any(pushes[back + 30:])
    # The stop takes the speed with which it comes, at once: that is the strongest of all.
    assert pushes[back] == np.max(pushes) > pushes[0] > 0.0


def test_a_hook_swings_with_its_own_frequency_while_it_is_off_its_stop():
    part, outs = part_of(Preloaded), []
    for _ in range(300):
        flown(part, [GRAVITY + 3.0])
        outs.append(part._out)
    outs = np.array(outs)
    highs = np.flatnonzero((outs[1:-1] > outs[:-2]) & (outs[1:-1] >= outs[2:]))
    wave = 2.0 * np.pi / part.FREQUENCY / np.sqrt(1.0 - part.DAMPING ** 2)
    assert 0.01 * (highs[1] - highs[0]) == pytest.approx(wave, abs=0.011)
    assert outs.min() > 0.0
