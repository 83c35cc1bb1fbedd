# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""More forms of ordinary loads, rotors and sensors, and two ordinary strangers."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import (
    fresh,
    HOVER,
    LEVEL,
    PARAMS,
    part_of,
    REST,
    SPINS,
    STATE,
    still,
    WEIGHT,
)

from withheld import outside
from withheld.constants import induced_velocity
from withheld.forms.bells import HeavyBell
from withheld.forms.cogs import SwitchedOff
from withheld.forms.cutbacks import CutBack
from withheld.forms.ducts import Broken
from withheld.forms.lances import Washing
from withheld.forms.lookups import LookedUp
from withheld.forms.magnets import Sorting
from withheld.forms.operators import Tilted
from withheld.forms.sessions import Uncharged
from withheld.forms.trims import Trimmed

TIMES = np.arange(0.0, 20.0, 0.02)


def test_a_magnet_carries_a_part_or_none_and_no_two_parts_alike():
    part, true, means = part_of(Sorting), fresh(), []
    part.alter(true, PARAMS)
    own = true['mass'] - PARAMS['mass']
    assert own == pytest.approx(part.OWN * part.parameters['mass'])
    for seed in range(60):
        part.begin(np.random.default_rng(seed))
        carried = np.array([part.mass(t) for t in TIMES]) / part.parameters['mass']
        assert carried[0] == 0.0 and part.mass(400.0) >= 0.0
        some = np.unique(carried[carried > 0.0])
        assert len(some) >= 2 and part.LIGHT <= some.min() and some.max() <= part.HEAVY
        # Between two parts it carries none.
        steps = carried[np.flatnonzero(np.diff(carried)) + 1]
        assert np.all(steps[::2] > 0.0) and not np.any(steps[1::2])
        means.append(carried.mean() + part.OWN)
    assert np.mean(means) == pytest.approx(1.0, abs=0.1)


def hangs(part, height, full, rises=0.0):
    """Return what a lance and its hose take of the thrust, kg, at a height and so full."""
    true = fresh()
    part.alter(true, PARAMS)
    part._full = full
    leans = Rotation.from_rotvec([0.3, -0.2, 0.4])
    part.after(1e-9, LEVEL, np.array([0.5, -0.4, rises]))
    force, moment = part.wrench(still(position=np.array([0.3, 0.2, height]),
                                      rotation=leans.as_matrix()))
    down = leans.apply(force)
    assert not np.any(moment) and down[:2] == pytest.approx([0.0, 0.0], abs=1e-12)
    return (true['mass'] - PARAMS['mass'] - down[2] / 9.81) / part.parameters['mass']


def test_of_a_hose_hangs_what_is_above_the_ground_with_water_or_without():
    part = part_of(Washing)
    part.begin(np.random.default_rng(1))
    assert hangs(part, 1.0, 0.5) == pytest.approx(1.0)
    assert hangs(part, 0.0, 1.0) == pytest.approx(Washing.LANCE)
    assert hangs(part, 2.0, 0.0) == pytest.approx(Washing.LANCE + 2.0 * Washing.HOSE)
    water = hangs(part, 2.0, 1.0) - hangs(part, 2.0, 0.0)
    assert water == pytest.approx(2.0 * Washing.WATER)
    assert hangs(part, 9.0, 1.0) == hangs(part, Washing.LENGTH, 1.0)
    # What hangs has to be lifted as well as held.
    more = hangs(part, 1.0, 1.0, rises=9.81) - hangs(part, 1.0, 1.0)
    assert more == pytest.approx(Washing.HOSE + Washing.WATER)


def test_a_hose_fills_while_its_pump_runs_and_runs_empty_then():
    part, step, full = part_of(Washing), 0.01, []
    part.times, part.first = np.array([8.0, 16.0]), 1
    for k in range(2400):
        part.wrench(still(time=step * k))
        part.after(step, LEVEL, REST)
        full.append(part._full)
    assert full[99] == pytest.approx(1.0 - 0.5 * np.exp(-1.0 / part.TIME))
    assert full[799] == pytest.approx(1.0, abs=1e-3)
    assert full[1599] == pytest.approx(0.0, abs=1e-3) and full[2399] > 0.99
    assert full[879] == pytest.approx(np.exp(-0.8 / part.TIME), rel=0.05)
    firsts = {part_of(Washing, flight=seed).first for seed in range(20)}
    assert firsts == {0, 1}


def follows(part, rates, step=0.002):
    """Return the moments (N, 3) on a body that turns at rates (N, 3)."""
    moments = []
    for rate in rates:
        force, moment = part.wrench(still(rate=rate))
        assert not np.any(force)
        moments.append(moment)
        part.after(step, LEVEL, REST)
    return np.array(moments)


def test_a_camera_that_is_off_rings_in_its_notch_after_a_soft_turn_and_ends_with_the_body():
    part, rate = part_of(SwitchedOff), np.array([0.01, -0.02, 0.015])
    moments = follows(part, np.tile(rate, (5000, 1)))
    given = -0.002 * np.cumsum(moments, axis=0)
    assert given[-1] == pytest.approx(part.loads * rate, rel=1e-2)
    # Of small turns, notches and cable are two springs side by side.
    crossings = np.flatnonzero(np.diff(np.sign(given[:1000, 1] - given[-1, 1])))
    stiff = np.hypot(part.FREQUENCY, part.CABLE)
    damped = np.sqrt(stiff ** 2 - (part.DAMPING * part.FREQUENCY) ** 2)
    assert 0.002 * np.mean(np.diff(crossings)) == pytest.approx(np.pi / damped, rel=0.01)


def test_a_camera_that_is_off_gives_way_to_a_hard_turn_and_is_notches_further_then():
    part, step = part_of(SwitchedOff), 0.002
    yields = part.FREQUENCY ** 2 / part.NOTCHES
    hard = np.zeros((100, 3))
    hard[:, 0] = 4.0 * yields * step * np.arange(100)       # four times what the notches hold
    moments = follows(part, hard)
    damper = 2.0 * part.DAMPING * part.FREQUENCY * np.abs(hard[:, 0]).max()
    cable = part.CABLE ** 2 * np.abs(part._behind[0])
    assert np.abs(moments[:, 0]).max() <= part.loads[0] * (yields + damper + cable)
    follows(part, np.zeros((3000, 3)))
    notches = part._behind[0] * part.NOTCHES / (2.0 * np.pi)
    assert abs(notches) > 0.5 and part._behind[1:] == pytest.approx([0.0, 0.0])
    # At rest between a notch that holds it and the cable, which draws it back.
    notch = part.FREQUENCY ** 2 / part.NOTCHES * np.sin(part.NOTCHES * part._behind[0])
    assert notch == pytest.approx(-part.CABLE ** 2 * part._behind[0], abs=0.02 * yields)


def test_a_camera_that_is_tilted_down_has_its_weight_below_its_axis():
    part, lift = part_of(Tilted), PARAMS['k_eta'] * 4.0 * HOVER ** 2

    def offset(time):
        force, moment = part.wrench(still(time=time))
        assert not np.any(force) and moment[2] == 0.0
        return part.centre[:2] + np.array([moment[1], -moment[0]]) / lift
    part.times, part.tilts = np.array([0.0, 1.0, 3.0]), np.array([0.0, 0.0, 0.5 * np.pi])
    assert offset(0.5) == pytest.approx(0.5 * np.pi * part.centre[:2])
    assert offset(2.0) == pytest.approx(0.5 * np.pi * np.cos(0.25 * np.pi) * part.centre[:2])
    assert offset(4.0) == pytest.approx([0.0, 0.0], abs=1e-12)


def test_an_operator_tilts_a_camera_evenly_and_then_leaves_it_for_a_while():
    means = []
    for seed in range(60):
        part = part_of(Tilted, flight=seed)
        assert part.times[-1] > 40.0 and np.all(np.diff(part.times) >= 0.0)
        tilts = np.interp(TIMES, part.times, part.tilts)
        assert 0.0 <= tilts.min() and tilts.max() <= 0.5 * np.pi
        rates = np.abs(np.diff(tilts)) / 0.02
        assert rates.max() <= Tilted.FAST * (1.0 + 1e-9)
        assert 0.2 < np.mean(rates < 1e-9) < 0.95
        means.append(np.mean(np.cos(tilts)))
    assert np.mean(means) == pytest.approx(Tilted.MEAN, abs=0.05)


def test_a_broken_duct_costs_most_in_hover_and_nothing_in_fast_flight():
    part, induced = part_of(Broken), induced_velocity(PARAMS)

    def lacks(air, turn=1.0):
        now = still(air=np.array(air), speeds=np.full(4, turn * HOVER))
        gain, torque = part.gain(now), part.torque(now)
        assert np.delete(gain, part.rotor) == pytest.approx(np.ones(3))
        # The blades have to make more of the thrust, which takes more torque.
        assert torque - 1.0 == pytest.approx(part.TORQUE * (1.0 - gain))
        return 1.0 - gain[part.rotor]
    hover = lacks(REST)
    assert hover == pytest.approx(part.SHARE * part.loss)
    half = part.HALVES * induced
    for way in ([1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.8, 0.0]):
        assert lacks(half * np.array(way)) == pytest.approx(0.5 * hover)
    assert lacks([0.0, 0.0, -half]) == pytest.approx(hover)
    # By the flow over that of the rotor itself, which goes with its speed.
    assert lacks([1.2 * half, 0.0, 0.0], 1.2) == pytest.approx(0.5 * hover)
    assert 0.0 < lacks([50.0 * half, 0.0, 0.0]) < 1e-3 * hover


def test_a_controller_cuts_back_in_proportion_to_what_is_beyond_its_limit():
    part = part_of(CutBack)
    speeds = HOVER * np.array([0.0, 0.5, 0.9, 0.95, 1.0, 1.2, 1.5])
    given = []
    for speed in speeds:
        now = still(speeds=np.full(4, speed))
        gain = part.gain(now)
        assert np.delete(gain, part.rotor) == pytest.approx(np.ones(3))
        assert np.array_equal(part.torque(now), gain)
        given.append(gain[part.rotor] * speed ** 2)
    asked, given, limit = speeds ** 2, np.array(given), (part.LIMIT * HOVER) ** 2
    beyond = asked > limit * (1.0 + 1e-9)
    assert given[~beyond] == pytest.approx(asked[~beyond])
    assert beyond.sum() == 4
    # Of a governor with a droop: what it takes back is in proportion to what is still too much.
    droop = (asked - given)[beyond] / (given[beyond] - limit)
    assert droop == pytest.approx(np.full(4, droop[0])) and droop[0] > 0.0
    worst = part_of(CutBack, 1e3).gain(still(speeds=np.full(4, 3.0 * HOVER)))
    assert worst.min() > 0.05


def test_most_of_the_momentum_is_that_of_the_rotor_with_the_heavy_bell():
    part = part_of(HeavyBell)
    inertias = part.inertia * part.spins / SPINS
    assert inertias.mean() == pytest.approx(part.parameters['rotor_inertia'])
    assert np.sort(inertias) / inertias.min() == pytest.approx([1.0, 1.0, 1.0, part.TIMES])
    # In a turn at speeds that stay: the moment of the momentum, by which a rotor holds its axis.
    rate, speeds = np.array([0.5, -0.3, 0.8]), HOVER * np.array([1.2, 1.0, 1.1, 0.9])
    part.wrench(still(speeds=speeds))
    force, moment = part.wrench(still(rate=rate, speeds=speeds))
    momentum = np.array([0.0, 0.0, -(inertias * SPINS) @ speeds])
    assert not np.any(force) and moment == pytest.approx(-np.cross(rate, momentum))


@pytest.mark.parametrize('step', [0.002, 0.01, 0.02])
def test_a_heavy_bell_hands_over_its_momentum_once_however_long_the_steps_are(step):
    for rotor in range(4):
        part, given = part_of(HeavyBell), 0.0
        part.wrench(still())
        part.after(step, LEVEL, REST)
        speeds = HOVER * (1.0 + 0.1 * (np.arange(4) == rotor))
        for _ in range(int(0.3 / step)):
            force, moment = part.wrench(still(speeds=speeds))
            assert not np.any(force) and not np.any(moment[:2])
            given += step * moment[2]
            part.after(step, LEVEL, REST)
        assert given == pytest.approx(0.1 * HOVER * part.inertia * part.spins[rotor])


def test_trims_are_added_to_the_angles_and_are_a_tilt_of_the_block_only_at_level():
    part = part_of(Trimmed)

    def said(roll, pitch, yaw):
        turn = Rotation.from_euler('ZYX', [yaw, pitch, roll])
        state = np.array([*STATE[:6], *turn.as_quat(), *STATE[10:]])
        out = part.measured(1.0, state, 1.0)
        assert np.array_equal(np.delete(out, range(6, 10)), np.delete(state, range(6, 10)))
        return turn, Rotation.from_quat(out[6:10])
    for angles in ([0.3, -0.2, 1.0], [-0.4, 0.5, 3.0], [0.0, 0.0, -2.0]):
        _, seen = said(*angles)
        off = seen.as_euler('ZYX')[::-1] - angles
        assert (off + np.pi) % (2.0 * np.pi) - np.pi == pytest.approx(part.angles)
    turn, seen = said(0.0, 0.0, 1.3)
    block = Rotation.from_euler('ZYX', part.angles[::-1])
    assert (block.inv() * turn.inv() * seen).magnitude() == pytest.approx(0.0, abs=1e-9)
    # On its side, what is added to the pitch turns it about its own vertical, to the left.
    part.angles = np.array([0.0, 0.02, 0.0])
    turn, seen = said(0.5 * np.pi, 0.0, 1.3)
    assert (turn.inv() * seen).as_rotvec() == pytest.approx([0.0, 0.0, -0.02], abs=1e-9)


def test_a_bias_goes_off_between_two_entries_and_jumps_back_at_each():
    part, out = part_of(LookedUp), []
    for t in TIMES:
        seen = part.measured(t, STATE, 1.0)
        assert np.array_equal(seen[:10], STATE[:10])
        out.append(seen[10:] - STATE[10:] - part.bias)
    # Each axis goes with the one temperature.
    share = np.array(out) @ part.goes / (part.goes @ part.goes)
    assert np.array(out) == pytest.approx(share[:, None] * part.goes)
    assert -0.5 <= share.min() < -0.4 and 0.4 < share.max() < 0.5
    assert share[0] == pytest.approx(part.from_entry - 0.5)
    steps = np.diff(share)
    jumps = np.flatnonzero(steps < 0.0)
    passed = part.WARMS * (1.0 - np.exp(-TIMES[-1] / part.TIME)) / part.EVERY
    assert len(jumps) == int(passed + part.from_entry) >= 3
    assert steps[jumps] == pytest.approx(np.full(len(jumps), -1.0), abs=0.02)
    # Ever more slowly, as it warms.
    assert np.all(np.diff(jumps) > 0.0) and np.diff(jumps)[-1] > np.diff(jumps)[0]
    assert steps[0] == pytest.approx(0.02 * part.WARMS / part.TIME / part.EVERY, rel=0.01)


def ratio_at(charge, load=0.0, seconds=0.0, size=1.0):
    battery = Uncharged(size, PARAMS, None)
    battery.begin(np.random.default_rng(1))
    battery.charge = charge
    for k in range(max(round(seconds / 0.01), 1)):
        battery.drain(0.01 * k, 0.01, np.full(4, load ** (1.0 / 3.0)))
    return battery


def test_a_pack_that_is_not_charged_falls_steeply_when_full_and_when_empty():
    charges = np.array([1.0, 0.95, 0.6, 0.55, 0.1, 0.05])
    left = np.array([ratio_at(charge).ratio for charge in charges])
    assert left[0] == pytest.approx(1.0)
    falls = (left[::2] - left[1::2]) / 0.05
    assert falls[0] > 2.0 * falls[1] > 0.0 and falls[2] > 10.0 * falls[1]
    assert ratio_at(0.0, 1.0, 60.0).ratio > 0.8


def test_a_pack_that_is_not_charged_resists_at_once_and_within_seconds_and_more_when_empty():
    def resisted(charge, seconds):
        loaded = ratio_at(charge, 2.0, seconds)
        return 1.0 - loaded.fallen(loaded.charge) - loaded.ratio
    assert resisted(1.0, 0.01) == pytest.approx(2.0 * Uncharged.RESISTS, rel=0.01)
    both = 2.0 * (Uncharged.RESISTS + Uncharged.SLOWLY)
    assert resisted(1.0, 30.0) == pytest.approx(both, rel=0.02)
    assert resisted(0.02, 0.01) > 2.5 * resisted(1.0, 0.01)
    # Its charge goes with the load.
    assert ratio_at(0.8, 1.0, 15.0).charge == pytest.approx(0.8 - 15.0 / Uncharged.LASTS)
    assert ratio_at(0.8, 2.0, 15.0).charge == pytest.approx(0.8 - 30.0 / Uncharged.LASTS)


def test_flights_begin_with_what_the_pack_has():
    begins = []
    battery = Uncharged(1.0, PARAMS, None)
    for seed in range(200):
        battery.begin(np.random.default_rng(seed))
        begins.append(battery.charge)
    assert Uncharged.LEAST <= min(begins) < 0.2 and 0.95 < max(begins) <= 1.0


def test_a_lead_turns_back_what_winds_it_up_about_the_vertical():
    part = outside.Lead(2.0, WEIGHT, PARAMS['rotor_radius'], np.random.default_rng(1))

    def held(yaws, lean=(0.3, -0.2)):
        part.begin(np.random.default_rng(2))
        part._wound = 0.0
        for yaw in yaws:
            turn = Rotation.from_euler('ZYX', [yaw, *lean])
            force, moment = part.wrench(still(rotation=turn.as_matrix()))
            part.after(0.01, turn.as_matrix(), REST)
        world = turn.apply(moment)
        assert not np.any(force) and world[:2] == pytest.approx([0.0, 0.0], abs=1e-12)
        return world[2]
    assert held([2.0, 2.0]) == 0.0
    assert held([2.0, 3.0]) == pytest.approx(-part.moment)
    # Through the south, where the angle that one writes down jumps.
    assert held([3.0, 3.5 - 2.0 * np.pi]) == pytest.approx(-0.5 * part.moment)
    turns = np.arange(0.0, 10.0, 0.1)
    assert held(turns) == pytest.approx(-part.GIVES * part.moment)
    # Once it has slipped it does not pull back to where it was at first.
    assert held([*turns, turns[-1] - part.GIVES]) == pytest.approx(0.0, abs=1e-12)
    assert held([*turns, turns[-1] - 2.0 * part.GIVES]) == pytest.approx(part.GIVES * part.moment)
    firsts = []
    for seed in range(30):
        part.begin(np.random.default_rng(seed))
        firsts.append(part.wrench(still())[1][2] / part.moment)
    assert np.ptp(firsts) > part.WOUND and np.abs(firsts).max() <= part.WOUND


def test_a_rangefinder_takes_a_box_for_the_floor_and_the_edge_of_it_for_a_climb():
    part = outside.Rangefinder(2.0, np.random.default_rng(1))
    part.places, part.wide = np.array([[0.0, 0.0], [0.1, 0.0]]), np.array([[0.4, 0.4], [0.1, 0.1]])
    part.high = np.array([0.03, 0.05])
    part.begin(np.random.default_rng(2))
    step, times = 0.001, np.arange(0.0, 6.0, 0.001)
    off = []
    for t in times:
        state = np.array([t - 3.0, 0.3, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.1, 0.2, 0.3])
        out = part.measured(t, state, 1.0)
        assert np.array_equal(np.delete(out, [2, 5]), np.delete(state, [2, 5]))
        off.append(out[[2, 5]] - state[[2, 5]])
    aside, climbs = np.array(off).T
    assert not aside[times < 2.6].any() and aside[-1] == pytest.approx(0.0, abs=1e-6)
    assert aside.min() == pytest.approx(-0.03, rel=0.02)
    # The climb is that of the height that is said, but for the moments of the edges.
    missed = np.abs(np.gradient(aside, step) - climbs)
    assert np.mean(missed > 1e-3) < 2e-3
    assert climbs.min() == pytest.approx(-0.03 / part.TIME, rel=0.02)


def test_a_rangefinder_sees_the_higher_of_two_boxes_and_looks_where_the_body_leans():
    part = outside.Rangefinder(2.0, np.random.default_rng(1))
    part.places, part.wide = np.array([[0.0, 0.0], [0.1, 0.0]]), np.array([[0.4, 0.4], [0.1, 0.1]])
    part.high = np.array([0.03, 0.05])

    def low(place, turn):
        part.begin(np.random.default_rng(2))
        state = np.array([*place, *REST, *turn.as_quat(), *REST])
        for t in (0.0, 10.0):
            out = part.measured(t, state, 1.0)
        return place[2] - out[2]
    level = Rotation.identity()
    assert low([0.1, 0.0, 1.0], level) == pytest.approx(0.05)
    assert low([-0.3, 0.0, 1.0], level) == pytest.approx(0.03)
    assert low([0.7, 0.0, 1.0], level) == 0.0
    # Nose down by 0.54 it looks 0.6 m per metre behind, whatever its heading.
    down = Rotation.from_euler('y', np.arctan(0.6))
    assert low([0.7, 0.0, 1.0], down) == pytest.approx(0.05)
    assert low([-0.7, 0.0, 1.0], down) == 0.0
    around = Rotation.from_euler('z', np.pi) * down
    assert low([-0.5, 0.0, 1.0], around) == pytest.approx(0.05)
    for seed in range(5):
        made = outside.Rangefinder(3.0, np.random.default_rng(seed))
        assert 0.0 < made.high.min() and made.high.max() <= 0.06
