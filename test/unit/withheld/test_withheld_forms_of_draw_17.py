# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The forms that the seventeenth draw is the first to fly: what each does."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import HOVER, instant, made, PARAMS, PLACES, REST, turning

from withheld.constants import GRAVITY
from withheld.forms import gears, lips, notches, straps
from withheld.forms.radios import wandering


def test_a_notch_lets_a_step_come_and_takes_part_of_it_back_for_a_while():
    motor, shown, speeds = notches.Notched(2.0, PARAMS, None), [], np.full(1, HOVER)
    for _ in range(4000):
        speeds = motor.turn(speeds, np.full(1, 1.1 * HOVER), 0.0001)
        shown.append((speeds[0] / HOVER - 1.0) / 0.1)
    first = int(np.argmax(np.array(shown) > 0.5))
    assert min(shown[first + 100:]) < 0.9 * max(shown[:first + 100])
    assert shown[-1] == pytest.approx(1.0, abs=1e-3)
    assert 0.0001 * np.sum(1.0 - np.array(shown)) == pytest.approx(
        motor.parameters['time'], rel=0.02)


def test_a_large_rise_comes_in_pieces_and_a_small_one_or_a_fall_does_not():
    motor, shown = notches.Demagnetised(2.0, PARAMS, None), []
    steps, time = np.array([0.02, 0.3, -0.3]), motor.parameters['time']
    speeds = np.full(3, HOVER)
    for _ in range(400):
        speeds = motor.turn(speeds, HOVER * (1.0 + steps), 0.01 * time)
        shown.append((speeds / HOVER - 1.0) / steps)
    small, rise, fall = np.array(shown).T
    assert (small[99], fall[99]) == pytest.approx(np.full(2, 1.0 - np.exp(-1.0)))
    pieces = np.diff(rise) > 0.0
    assert np.sum(np.diff(pieces.astype(int)) == 1) >= 2 and rise[99] < 0.5 < 0.7 < rise[399]


@pytest.mark.slow
@pytest.mark.parametrize(('form', 'exact'), [('polled', 0.01), ('governed', 0.05)])
def test_a_line_that_waits_has_its_mean_delay(form, exact):
    line, waits = made('actuation_delay', form, 2.0), []
    for seed in range(20):
        line.begin(np.random.default_rng(seed))
        waits += [np.mean(line.waits(t)) for t in np.arange(0.0, 100.0, 0.013)]
    assert np.mean(waits) == pytest.approx(line.delay, rel=exact)
    assert np.min(waits) >= line.OWN * line.delay


def test_one_rotor_after_another_is_asked():
    line = made('actuation_delay', 'polled', 2.0)
    asked = [int(np.argmax(line.waits(t))) for t in np.arange(0.0, 8.0, 1.0) * line.LASTS]
    assert np.all(np.diff(asked) % 4 == 1)


def test_a_clock_goes_up_at_once_and_comes_down_step_by_step():
    line = made('actuation_delay', 'governed', 2.0)
    work = wandering(np.random.default_rng(4), line.TIME / line.EVERY, line.DEPTH, line.MOST,
                     line.COUNT)
    at = np.array([line.CLOCKS.index(round(one, 6)) for one in work / line.levels])
    changes = np.diff(at)
    assert changes.min() == -1 and changes.max() == 2
    assert set(at[1:][changes > 0]) == {2} and line.levels[:-1][changes > 0].min() > line.BUSY


def test_blades_that_stall_have_more_drag_beyond_a_speed_and_sooner_when_slow():
    part = lips.Retreating(2.0, PARAMS, None)

    def share(speed, turn):
        now = instant(velocity=(speed, 0.0, 0.0), rate=REST, turn=np.full(4, turn))
        return -part.wrench(now)[0][0] / (part.coefficient * speed * turn)

    assert [share(0.5, 1.0), share(1.0, 1.0)] == pytest.approx([part.BEFORE] * 2)
    assert share(2.2, 1.0) == pytest.approx(part.BEFORE + part.STEEP)
    assert share(1.0, 0.5) > share(1.0, 1.0)


def test_a_lip_lifts_until_the_flow_parts_from_it():
    part = lips.Lipped(2.0, PARAMS, None)
    moments = [part.wrench(instant(velocity=(x, 0.0, 0.0), rate=REST, turn=np.ones(4)))[1][1]
               for x in (0.1, 0.8, 1.2, 3.0)]
    assert moments[0] == pytest.approx(0.1 * part.MORE * part.moment, rel=1e-3)
    assert moments[0] < moments[1] < moments[2] > moments[3] > 0.0


def test_a_hose_has_more_drag_the_higher_the_vehicle_is_and_none_along_itself():
    part = made('body_drag', 'hose', 2.0)
    low, high, up = (part.wrench(instant(velocity=velocity, height=height))[0]
                     for velocity, height in (((2.0, 0.0, 0.0), 0.5), ((2.0, 0.0, 0.0), 1.5),
                                              ((0.0, 0.0, 2.0), 1.5)))
    assert low[0] - high[0] == pytest.approx(4.0 * part.HOSE * part.coefficient)
    assert up[2] == pytest.approx(-4.0 * part.OWN * part.coefficient)


def test_a_scanner_pushes_across_and_takes_no_power():
    part, velocity = made('body_drag', 'spinning', 2.0), np.array([1.2, -0.5, 0.3])
    force, still = (part.wrench(instant(velocity=one))[0] for one in (velocity, REST))
    square = np.linalg.norm(velocity) ** 3
    assert force @ velocity == pytest.approx(-part.coefficient * square)
    assert np.cross(velocity, force)[2] == pytest.approx(
        -part.coefficient * part.SPIN * (1.2 ** 2 + 0.5 ** 2)) and not np.any(still)


def test_air_below_a_layer_is_calmer_than_above_it_and_the_layer_has_waves():
    wind, times = made('wind', 'layered', 2.0), np.arange(0.0, 10.0, 0.05)
    shares = [[wind.wind(t, np.array([0.3, 0.2, z])) @ wind.mean / (wind.mean @ wind.mean)
               for t in times] for z in (0.0, 1.0, 2.5)]
    assert np.mean(shares, axis=1) == pytest.approx([wind.BELOW, 1.0, wind.ABOVE], abs=0.03)
    assert np.ptp(shares[1]) > 0.5 > 0.1 > max(np.ptp(shares[0]), np.ptp(shares[2]))


def test_air_below_a_vehicle_that_passes_comes_down_for_a_while():
    wind = made('wind', 'overflown', 2.0)
    place = np.array([*(wind.place + [wind.CIRCLES, 0.0]), 1.0])
    down = np.array([-wind.wind(t, place)[2] for t in np.arange(0.0, 3 * wind.AROUND, 0.01)])
    assert down.max() == pytest.approx(wind.sinks, rel=1e-3) and down.min() < 0.01 * wind.sinks
    passes = np.diff((down > 0.5 * wind.sinks).astype(int)) == 1
    assert passes.sum() == 3
    assert wind.wind(1.0, place)[:2] == pytest.approx(wind.mean[:2])


def test_level_flight_frees_the_lower_rotors_and_those_ahead_first():
    rotor = made('inflow', 'overlapping', 2.0)
    hovers, flies = (rotor.gain(instant(velocity=(x, 0.0, 0.0), rate=REST, turn=np.ones(4))) - 1.0
                     for x in (0.0, 3.0))
    assert hovers == pytest.approx(np.zeros(4)) and flies[~rotor.lower] == pytest.approx(
        np.zeros(2))
    ahead, behind = (flies[rotor.lower & (side * PLACES[:, 0] > 0.0)] for side in (1.0, -1.0))
    assert ahead > 2.0 * behind > 0.0


def test_most_of_what_a_climb_takes_comes_back_as_the_motors_speed_up():
    rotor = made('inflow', 'unloaded', 2.0)
    air, lost = np.array([0.0, 0.0, 0.5 * rotor.induced]), []
    for seconds in (0.0, 3.0):
        rotor.begin(None)
        lost.append(1.0 - rotor.gain(turning(rotor, 1.0, seconds, air=air))[0])
    assert lost == pytest.approx([0.05, 0.015], rel=1e-3)


def test_grass_that_strong_rotors_bend_down_is_further_away():
    gains = []
    for turn in (0.9, 1.1):
        part = made('ground_effect', 'grass', 1.0)
        now = turning(part, turn, 3.0, heights=np.full(4, 0.15))
        gains.append(part.gain(now)[0] - 1.0)
    bends = part.DEEP * 1.1 ** 2 / (1.0 + 0.75 ** 2)
    assert gains[0] > 1.1 * gains[1] == pytest.approx(1.1 * 0.4 / (2.0 + bends) ** 2, rel=1e-2)


def test_a_rotor_above_a_crate_has_more_thrust_than_beside_it():
    part = made('ground_effect', 'crates', 1.0)
    part.stand, part.wide, part.high = np.array([[0.12, 0.12]]), np.array([0.1]), np.array([1.0])
    now = replace(instant(height=0.25), position=np.array([0.0, 0.0, 0.25]))
    gains = part.gain(now) - 1.0
    on = int(np.argmin(np.linalg.norm(PLACES[:, :2] - 0.12, axis=1)))
    bare = 0.04 / (1.0 + (2.5 / 1.2) ** 3)
    assert gains[on] == pytest.approx(0.04 / (1.0 + (1.5 / 1.2) ** 3), rel=0.1)
    assert np.delete(gains, on) == pytest.approx(np.full(3, bare), rel=0.05)


def test_a_purge_gives_back_what_water_took():
    battery, shown = made('battery_sag', 'fuel_cell', 1.0), []
    for _ in range(2400):
        battery.drain(0.0, 0.01, np.ones(4))
        shown.append(battery.ratio)
    changes = np.diff(shown)
    assert np.sum(np.diff((changes > 5e-5).astype(int)) == 1) == 4
    assert np.ptp(shown) == pytest.approx(battery.FLOODS, rel=0.15)
    falls = []
    for load in (0.5, 1.0, 2.0):
        battery.drain(0.0, 1e-9, np.full(4, load ** (1.0 / 3.0)))
        falls.append(shown[-1] - battery.ratio)
    assert falls[2] - falls[1] < 2.0 * (falls[1] - falls[0])    # by the logarithm


def test_a_generator_swings_about_what_a_load_takes_in_the_end():
    battery, shown = made('battery_sag', 'generator', 1.0), []
    for _ in range(3000):
        battery.drain(0.0, 0.01, np.ones(4))
        shown.append((1.0 - battery.ratio) / battery.DROOP)
    assert 1.2 < max(shown) < 1.7 and shown[-1] == pytest.approx(1.0, abs=0.01)
    assert min(shown[int(np.argmax(shown)):]) < 1.0


def test_propellers_creep_under_a_load_and_come_back():
    part, gains = made('thrust_scale', 'yielding', 2.0), []
    for turn, seconds in ((1.0, 1.0), (1.1, 0.05), (1.1, 6.0), (1.0, 6.0)):
        gains.append((part.gain(turning(part, turn, seconds))[0] - 1.0) / part.share)
    assert (gains[0], gains[3]) == pytest.approx((1.0, 1.0), abs=1e-3)
    assert 1.0 < gains[1] < 1.1 and gains[2] == pytest.approx(1.0 + 4.0 * 0.21, abs=2e-3)


def test_a_battery_that_comes_flying_is_there_or_not():
    part = made('mass_offset', 'docking', 2.0)
    masses = np.array([part.mass(t) for t in np.arange(0.0, 60.0, 0.01)])
    shares = masses / part.parameters['mass']
    assert (shares.min(), shares.max()) == pytest.approx(part.LEVELS)
    assert shares.mean() == pytest.approx(1.0, abs=0.1)
    assert np.abs(np.diff(shares)).max() == pytest.approx(0.01 / part.LASTS)


def test_a_spool_is_lighter_by_the_way_that_was_flown():
    part = made('mass_offset', 'spool', 2.0)
    shares = []
    for speed, seconds in ((0.0, 5.0), (3.0, 5.0), (3.0, 20.0)):
        now = turning(part, 1.0, seconds, velocity=np.array([speed, 0.0, 0.0]))
        shares.append(1.0 - part.wrench(now)[0][2] / (part.parameters['mass'] * GRAVITY))
    assert shares == pytest.approx([part.FULL, 1.0, part.LEFT], abs=1e-6)


def test_straps_are_flung_out_by_a_turn_and_keep_their_momentum():
    part = straps.Flung(2.0, PARAMS, np.random.default_rng(1))
    part.alter(dict(PARAMS), PARAMS)
    part.begin(None)
    for rate, share in ((0.1, part.LEAST + part.MORE * 0.01 / 1.01), (1.0, part.LEAST + 1.0)):
        for _ in range(400):
            part.wrench(instant(rate=(0.0, 0.0, rate)))
            part.after(0.01, np.eye(3), REST)
        assert part._share == pytest.approx(share, rel=1e-3)
    part._turning, part._share, part._rate = np.ones(3), 1.0, np.ones(3)
    part.TIME = 1e3                     # nothing takes it along meanwhile
    part.after(0.5, np.eye(3), REST)
    assert part._share > 1.2 and part._turning * part._share == pytest.approx(
        np.ones(3), abs=1e-3)


def test_a_strap_is_blown_below_a_rotor_from_one_side():
    part, loss = made('rotor_fault', 'strapped', 2.0), []
    for side in (-3.0, 0.0, 3.0):
        now = turning(part, 1.0, 2.0, air=side * part.onto)
        loss.append((1.0 - part.gain(now)[part.rotor]) / 0.01)
    assert loss == pytest.approx([2.0, 1.0, 0.0], abs=2e-3)


def test_a_bearing_runs_itself_warm():
    part, loss = made('rotor_fault', 'cold_grease', 2.0), []
    for _ in range(2000):
        now = turning(part, 1.0, 0.01)
        loss.append((1.0 - part.gain(now)[part.rotor]) / 0.01)
    assert loss[0] == pytest.approx(part.COLD, rel=0.01)
    assert loss[-1] == pytest.approx(part.WARM, abs=0.1) and np.all(np.diff(loss) < 0.0)
    assert np.mean(loss) == pytest.approx(1.0, abs=0.1)
    assert part.torque(now) == pytest.approx(part.gain(now))


def test_seeds_settle_fast_and_then_ever_more_slowly():
    part, arms = made('com_offset', 'compacting', 2.0), []
    for _ in range(2000):
        now = turning(part, 1.0, 0.01)
        arms.append(np.linalg.norm(part.wrench(now)[1]) * np.sign(part.wrench(now)[1][1]))
    arms = np.array(arms) * np.sign(arms[0])
    lift = PARAMS['k_eta'] * 4.0 * HOVER ** 2 * np.linalg.norm(part.centre[:2])
    assert np.mean(arms) == pytest.approx(0.0, abs=0.01 * lift)
    assert arms[0] - arms[200] > 10.0 * (arms[1799] - arms[1999]) > 0.0


def test_behind_gears_with_play_a_propeller_runs_on_and_is_then_slowed_down():
    part = gears.Geared(2.0, PARAMS, None)
    part.begin(None)
    turning(part, 1.0, 0.2)
    behind = []
    for _ in range(160):
        turning(part, 0.9, 0.0025, step=0.0025)
        behind.append(np.mean(part._blades) / HOVER)
    coasted = HOVER * (1.0 - np.array(behind))
    fastest = -np.diff(coasted).max() / 0.0025 / HOVER
    assert fastest < -1.3 * part.SLOWS and behind[-1] == pytest.approx(0.9, abs=5e-3)
    assert coasted[0] / 0.0025 == pytest.approx(part.SLOWS * HOVER, rel=0.01)
    now = turning(part, 0.9, 0.0, rate=np.array([1.0, 0.0, 0.0]), speeds=HOVER * np.array(
        [0.9, 0.8, 0.9, 0.8]))
    part._blades = part._motors = now.speeds
    momentum = part.inertia * (part.spins @ now.speeds)
    assert part.wrench(now)[1][1] == pytest.approx(-(1.0 - part.COUNTER) * momentum)


def test_a_filter_that_believes_its_accelerometer_goes_to_level_in_a_lean():
    part = made('attitude_misalignment', 'levelled', 2.0)
    state = np.array([*np.zeros(6), *Rotation.from_euler('x', 0.2).as_quat(), *np.zeros(3)])
    first, *_, last = (Rotation.from_quat(part.measured(t, state, 1.0)[6:10])
                       for t in np.arange(0.0, 10.0, 0.01))
    went = (first.inv() * last).as_rotvec()
    pulled = np.sin(0.2) * (1.0 - np.exp(-2.0 * part.PULLS * 9.99))
    assert went == pytest.approx([-pulled, 0.0, 0.0], rel=1e-2, abs=1e-9)
    level = made('attitude_misalignment', 'levelled', 2.0)
    state[6:10] = 0.0, 0.0, 0.0, 1.0
    tilts = [level.measured(t, state, 1.0)[6:10] for t in (0.0, 5.0)]
    assert tilts[0] == pytest.approx(tilts[1])


def test_a_gyroscope_is_cooled_by_fast_flight():
    bias, state = made('gyro_bias', 'cooled', 2.0), np.array([*np.zeros(9), 1.0, *np.zeros(3)])
    shares = []
    for speed, times in ((0.0, np.arange(0.0, 5.0, 0.01)), (4.0, np.arange(5.0, 25.0, 0.01))):
        state[3] = speed
        for t in times:
            shares.append(bias.measured(t, state, 1.0)[10:] / bias.bias)
    assert shares[499] == pytest.approx(1.0 + bias.by_axis)
    assert shares[-1] == pytest.approx(1.0 - bias.by_axis, abs=1e-3)
