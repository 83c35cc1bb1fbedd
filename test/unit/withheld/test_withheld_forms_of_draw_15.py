# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The forms that the fifteenth draw is the first to fly: what each does."""


import numpy as np
import pytest
from withheld_parts import HOVER, instant, made, PARAMS, turning

from withheld.constants import GRAVITY
from withheld.forms import aboard, clutches, disks, profiles, swings


def test_a_motor_with_a_profile_takes_as_long_as_the_root_of_its_step():
    motor = profiles.Profiled(2.0, PARAMS, None)
    assert motor.over == pytest.approx(3.0 * motor.parameters['time'])
    speeds, goal = HOVER * np.array([0.95, 0.8]), np.full(2, HOVER)
    missing = 0.0
    for _ in range(2000):
        missing = missing + motor.over / 2000 * (goal - speeds) / HOVER
        speeds = motor.turn(speeds, goal, motor.over / 2000)
    assert missing[0] / 0.05 == pytest.approx(motor.parameters['time'], rel=1e-2)
    assert (goal - speeds) / HOVER == pytest.approx([0.0, 0.2 * 0.25], abs=1e-6)


def test_hot_windings_slow_a_motor_down():
    motor = made('motor_lag', 'hot_windings', 2.0)

    def time():
        speeds = motor.turn(np.full(4, HOVER), np.full(4, 1.01 * HOVER), 1e-4)
        return -1e-4 / np.log(1.0 - (speeds[0] / HOVER - 1.0) / 0.01) / motor.parameters['time']

    assert time() == pytest.approx(motor.COLD, rel=1e-3)
    for _ in range(10):
        motor.turn(np.full(4, HOVER), np.full(4, HOVER), 5.0)
    assert time() == pytest.approx(motor.COLD + motor.GROWS, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize('form', ['multiplexed', 'buffered'])
def test_a_line_has_its_mean_delay(form):
    line, waits = made('actuation_delay', form, 2.0), []
    for seed in range(20):
        line.begin(np.random.default_rng(seed))
        waits += [line.waits(t) for t in np.arange(0.0, 100.0, 0.013)]
    assert np.mean(waits) == pytest.approx(line.delay, rel=0.04)
    assert np.min(waits) >= line.OWN * line.delay


def test_a_buffer_jumps_up_and_comes_down_slowly():
    line, times = made('actuation_delay', 'buffered', 2.0), np.arange(0.0, 60.0, 0.001)
    changes = np.diff([line.waits(t) for t in times])
    assert changes.max() > 0.2 * line.delay and changes.min() > -0.003 * line.delay


def test_rotors_that_share_a_line_are_never_served_together():
    line = made('actuation_delay', 'multiplexed', 2.0)
    comes = np.sort((0.1 + line.waits(0.1)) % line.period)
    assert np.diff(comes) == pytest.approx(np.full(3, line.period / 4))


def test_a_fuse_trips_under_load_and_comes_back():
    battery, shown = made('battery_sag', 'fused', 2.0), []
    for load in (1.5, 0.6):
        for _ in range(3000):
            battery.drain(0.0, 0.01, np.full(4, load ** (1.0 / 3.0)))
        shown.append((1.0 - battery.ratio) / (2.0 * load))
    assert shown == pytest.approx([battery.HOT, battery.COLD], rel=0.05)


def test_a_heater_makes_a_bias_rise_and_fall_about_its_mean():
    bias = made('gyro_bias', 'thermostat', 2.0)
    shares = np.array([bias.share(t, 1.0) for t in np.arange(0.0, 60.0, 0.01)])
    assert np.abs(np.diff(shares, axis=0)).max() < 0.02        # without a jump
    assert shares.max(axis=0) - 1.0 == pytest.approx(np.abs(bias.by_axis), rel=0.01)
    assert 1.0 - shares.min(axis=0) == pytest.approx(np.abs(bias.by_axis), rel=0.01)


def test_puffs_and_the_air_between_them_are_the_mean_wind():
    means = []
    for seed in range(300):
        wind = made('wind', 'puffs', 2.0)
        wind.begin(np.random.default_rng(seed))
        means.append(wind.wind(12.0, np.zeros(3))[0] / wind.mean[0])
    assert np.mean(means) == pytest.approx(1.0, abs=0.06) and min(means) >= wind.BASE


def test_air_that_comes_down_on_the_ground_spreads_and_is_not_lost():
    wind = made('wind', 'impinging', 2.0)
    place, h = np.array([0.5, -0.3, 0.4]), 1e-5
    slopes = [(wind.wind(0.0, place + h * axis) - wind.wind(0.0, place - h * axis)) @ axis / h
              for axis in np.eye(3)]
    assert sum(slopes) == pytest.approx(0.0, abs=1e-6) and abs(slopes[2]) > 0.1
    above = np.array([*wind.place, 0.5])
    assert wind.wind(0.0, above)[:2] == pytest.approx(wind.mean[:2])
    assert wind.wind(0.0, above)[2] < 0.0


def test_the_thrust_overshoots_until_the_inflow_has_followed():
    rotor = made('inflow', 'overshooting', 2.0)
    turning(rotor, 1.0, 1.0)
    now = turning(rotor, 1.2, 0.0)
    assert rotor.gain(now) == pytest.approx(1.0 + 0.12 * (1.0 - 1.0 / 1.2))
    assert rotor.gain(turning(rotor, 1.2, 2.0)) == pytest.approx(1.0, abs=1e-5)


def test_a_flow_stays_on_its_branch_within_the_loop():
    blades = made('thrust_scale', 'two_branches', 2.0)
    shown = [float(np.mean(blades.gain(turning(blades, turn, 1.0))) - 1.0) / blades.share
             for turn in (1.0, 0.9, 1.0, 1.1, 1.0)]
    up, down = 1.0 + blades.STEP, 1.0 - blades.STEP
    assert shown == pytest.approx([up, down, down, up, up], abs=1e-4)


def test_a_skewed_inflow_is_flapping_in_slow_flight_and_less_in_a_climb():
    part = disks.SkewedInflow(2.0, PARAMS, None)
    still = {'turn': np.ones(4), 'rate': (0.0, 0.0, 0.0)}
    slow, climbing = (part.wrench(instant(velocity=(0.01, 0.0, z), **still))[1]
                      for z in (0.0, 3.0))
    assert slow == pytest.approx([0.0, 0.01 * part.moment, 0.0], rel=1e-3)
    assert 0.0 < climbing[1] < 0.7 * slow[1]


def test_a_balloon_carries_and_has_to_be_moved():
    part = aboard.Buoyant(3.0, PARAMS, None)
    part.begin(None)
    carried = 0.021 * PARAMS['mass']
    assert part.wrench(instant())[0] == pytest.approx([0.0, 0.0, carried * GRAVITY])
    part.after(0.01, np.eye(3), np.array([1.0, 0.0, 0.0]))
    assert part.wrench(instant())[0][0] == pytest.approx(-part.MOVED * carried)


@pytest.mark.slow
def test_a_winch_brings_a_load_down_and_back():
    part = made('mass_offset', 'winched', 3.0)
    times = np.arange(0.0, 50.0, 0.001)
    rises = np.array([-part.wrench(instant(time=t))[0][2] for t in times])
    way = np.cumsum(np.cumsum(rises / part.parameters['mass'])) * 0.001 ** 2
    way = way - np.polyval(np.polyfit(times, way, 1), times)   # of how the flight begins
    assert rises.mean() == pytest.approx(0.0, abs=1e-3 * part.parameters['mass'] * GRAVITY)
    assert np.ptp(way) == pytest.approx(part.REEL, rel=0.05)


def test_baffles_hold_with_the_square_of_the_slip():
    part = made('inertia_mismatch', 'baffled', 2.0)
    part.alter(dict(PARAMS), PARAMS)
    slow, fast = (part.wrench(instant(rate=(p, 0.0, 0.0)))[1][0] for p in (0.1, 0.2))
    assert fast == pytest.approx(4.0 * slow) and slow < 0.0
    part.after(0.5, np.eye(3), np.zeros(3))         # ds/dt = -15 s^2 from 0.2
    assert 0.2 - part._turning[0] == pytest.approx(1.0 / (1.0 / 0.2 + 15.0 * 0.5))


def test_what_swings_stays_behind_and_then_comes_along():
    swing = swings.Swing(10.0, 0.3)
    swing.go(np.array([1.0, 0.0, 0.0]), 0.01)
    assert swing.angle[0] == pytest.approx(0.01, rel=0.1)
    swing.go(np.array([1.0, 0.0, 0.0]), 20.0)
    assert swing.angle == pytest.approx(np.zeros(3), abs=1e-6)
    assert swing.turning == pytest.approx([1.0, 0.0, 0.0])


def test_a_rocking_board_is_a_tilted_one_that_rests():
    board = made('attitude_misalignment', 'rocking', 2.0)
    state = np.array([*np.zeros(9), 1.0, 0.3, 0.0, 0.0])
    at_rest, _ = board.tilted(state)
    assert board.measured(0.0, state, 1.0) == pytest.approx(
        at_rest - 0.8 * np.array([*np.zeros(10), 0.3, 0.0, 0.0]))
    assert board.measured(0.1, state, 1.0)[6] != pytest.approx(at_rest[6], abs=1e-3)
    assert board.measured(30.0, state, 1.0) == pytest.approx(at_rest, abs=1e-6)


def test_a_screen_lets_air_in_from_the_side():
    part = made('rotor_fault', 'clogged', 2.0)
    loss = [1.0 - part.gain(instant(velocity=(x, 0.0, 0.0), rate=np.zeros(3)))[part.rotor]
            for x in (0.0, 3.0)]
    assert loss[0] == pytest.approx(0.01 * part.MORE) and loss[1] < 0.2 * loss[0]


def test_a_propeller_scrapes_as_the_body_turns():
    part = made('rotor_fault', 'scraping', 2.0)
    loss = [1.0 - part.gain(instant(turn=np.ones(4), rate=(rate, 0.0, 5.0)))[part.rotor]
            for rate in (0.0, 0.4)]
    assert loss == pytest.approx([0.01 * part.BENT, 0.01 * (part.BENT + 1.0)])


def test_a_clutch_grips_upwards_and_runs_free_downwards():
    part = clutches.Freewheeling(2.0, PARAMS, None)
    part.begin(None)
    turning(part, 1.0, 0.1)
    turning(part, 1.2, 0.2)
    assert part._blades / HOVER == pytest.approx(np.full(4, 1.2), rel=1e-3)
    turning(part, 0.5, 0.2)         # 1 / w grows by 1.5 / s in terms of hover
    assert HOVER / part._blades == pytest.approx(np.full(4, 1.0 / 1.2 + 0.3), rel=1e-2)


def test_disks_that_lag_resist_a_turn():
    part = made('rotor_drag', 'lagging_disks', 2.0)
    still = {'velocity': np.zeros(3), 'turn': np.ones(4)}
    force = part.wrench(instant(rate=(0.0, 1.0, 0.0), **still))[0]
    assert force == pytest.approx([-part.coefficient * part.LEVER, 0.0, 0.0])


def test_a_fin_turns_the_body_into_the_flow():
    part = made('body_drag', 'finned', 2.0)
    assert part.wrench(instant(velocity=(2.0, 0.0, 0.0)))[1] == pytest.approx(np.zeros(3))
    # What goes to the left is turned to the left.
    assert part.wrench(instant(velocity=(2.0, 1.0, 0.0)))[1][2] > 0.0


def test_a_body_that_turns_back_meets_its_own_wake():
    part = made('body_drag', 'own_wake', 2.0)
    ahead, back = (instant(velocity=(x, 0.0, 0.0)) for x in (2.0, -2.0))
    first = part.wrench(ahead)[0][0]
    for _ in range(2000):
        part.wrench(ahead), part.after(0.01, np.eye(3), np.zeros(3))
    assert part.wrench(ahead)[0][0] == pytest.approx(first * (1.0 - part.SHARE) ** 2)
    assert part.wrench(back)[0][0] == pytest.approx(-first * (1.0 + part.SHARE) ** 2)


def test_ground_gives_close_by_takes_above_and_holds_what_sinks():
    dipping, squeezed = (made('ground_effect', form, 1.0) for form in ('dipping', 'squeezed'))
    gains = [dipping.gain(instant(height=h))[0] - 1.0 for h in (0.1, 0.4, 1.5)]
    assert gains[0] > 0.0 > gains[1] and abs(gains[2]) < 1e-4
    sinks, hovers, climbs = (squeezed.gain(instant(velocity=(0.0, 0.0, z)))[0] - 1.0
                             for z in (-0.5, 0.0, 0.5))
    assert sinks > hovers > climbs > 0.0 and sinks - hovers == pytest.approx(hovers - climbs)


def test_a_payload_that_is_switched_on_takes_from_the_voltage():
    battery = made('battery_sag', 'consumer', 2.0)
    ratios = []
    for k in range(3000):
        battery.drain(0.01 * k, 0.01, np.ones(4))
        ratios.append(1.0 - battery.ratio - 2.0 * battery.SLOPE * 0.01 * k / 30.0)
    assert min(ratios) == pytest.approx(0.0, abs=1e-6)
    assert max(ratios) == pytest.approx(2.0 * battery.DRAWS, rel=1e-3)


def test_translational_lift_sets_in_at_a_speed():
    part, still = made('inflow', 'outrun', 1.0), {'rate': np.zeros(3), 'turn': np.ones(4)}
    slow, fast = (part.gain(instant(velocity=(x * part.induced, 0.0, 0.0), **still))[0] - 1.0
                  for x in (0.1, 0.8))
    assert slow < 0.0 and fast == pytest.approx(0.03, rel=0.02)


def test_a_battery_in_a_sling_pulls_back_against_a_turn():
    part = made('com_offset', 'swaying', 2.0)
    now = instant(velocity=np.zeros(3), turn=np.ones(4), rate=(1.0, 0.0, 0.0))
    assert part.wrench(now)[1] == pytest.approx(np.zeros(3))
    part.after(0.02, np.eye(3), np.zeros(3))
    roll, pitch, yaw = part.wrench(now)[1]
    assert roll < 0.0 and pitch == yaw == 0.0
