# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The forms that the sixteenth draw is the first to fly: what each does."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import HOVER, instant, made, PARAMS, turning

from withheld.forms import brakes, changing, hubs, shades

STILL = {'velocity': np.zeros(3), 'rate': np.zeros(3)}


def test_a_motor_coasts_when_little_is_too_much_and_is_braked_when_much_is():
    motor, goal = brakes.LateBrake(2.0, PARAMS, None), np.full(2, HOVER)
    speeds = HOVER * np.array([1.03, 1.08])
    for _ in range(40):
        speeds = motor.turn(speeds, goal, 0.0005)
    little, much = speeds / HOVER - 1.0
    assert little > 0.4 * 0.03 and much < 0.25 * 0.08
    driven = motor.turn(HOVER * np.full(2, 0.9), goal, motor.parameters['time'])
    assert 1.0 - driven / HOVER == pytest.approx(np.full(2, 0.1 * np.exp(-1.0)))


def test_a_motor_whose_load_comes_late_overshoots_and_creeps_back():
    motor, shown, speeds = brakes.LoadedLate(2.0, PARAMS, None), [], np.full(1, HOVER)
    for _ in range(4000):
        speeds = motor.turn(speeds, np.full(1, 1.1 * HOVER), 0.0002)
        shown.append((speeds[0] / HOVER - 1.0) / 0.1)
    assert 1.03 < max(shown) < 1.0 + motor.OVER and shown[-1] == pytest.approx(1.0, abs=1e-3)
    assert np.all(np.diff(shown[int(np.argmax(shown)):]) < 0.0)
    # What is missing on average, over the time: the fast lag less what the load adds.
    mean = 0.0002 * np.sum(1.0 - np.array(shown)) / motor.parameters['time']
    assert mean == pytest.approx(motor.FAST - motor.OVER * motor.SLOW, abs=0.01)


@pytest.mark.parametrize('form', ['hopping', 'fading'])
def test_a_radio_has_its_mean_delay(form):
    line, waits = made('actuation_delay', form, 2.0), []
    for seed in range(20):
        line.begin(np.random.default_rng(seed))
        waits += [line.waits(t) for t in np.arange(0.0, 100.0, 0.013)]
    assert np.mean(waits) == pytest.approx(line.delay, rel=0.06)
    assert np.min(waits) >= line.OWN * line.delay


def test_channels_come_back_in_their_order():
    line = made('actuation_delay', 'hopping', 2.0)
    around = line.STAYS * len(line.LEVELS)
    one, next_one = ([line.waits(t + late) for t in np.arange(0.005, around, 0.01)]
                     for late in (0.0, around))
    assert one == pytest.approx(next_one) and len(set(one)) == 5


def test_a_rotor_behind_another_one_has_less_drag_and_more_so_in_fast_flight():
    part = shades.Shaded(2.0, PARAMS, None)
    shares = [-part.wrench(instant(velocity=np.array(v), turn=np.ones(4)))[0] @ v
              / (part.coefficient * np.dot(v, v))
              for v in ((0.01, 0.0, 0.0), (4.0, 0.0, 0.0), (2.83, 2.83, 0.0))]
    assert shares[0] == pytest.approx(1.0, abs=1e-3)
    # Two of four are behind others on the way ahead, one of four askew.
    assert shares[1] < shares[2] - 0.05 < shares[0] - 0.1


def test_a_box_is_pushed_on_to_the_side_and_not_along_its_faces_or_edges():
    part = made('body_drag', 'boxy', 2.0)
    for angle, pushes in ((0.0, 0.0), (0.2, 1.0), (np.pi / 4, 0.0), (np.pi / 2 - 0.2, -1.0)):
        c, s = np.cos(angle), np.sin(angle)
        force = part.wrench(instant(velocity=(2.0 * c, 2.0 * s, 0.0)))[0]
        aside = force @ [-s, c, 0.0]
        assert aside == pytest.approx(0.0, abs=1e-9) if not pushes else aside * pushes > 0.0
        assert force @ [c, s, 0.0] < 0.0


def test_a_banner_goes_on_fluttering_below_the_speed_at_which_it_began():
    part, shown = made('body_drag', 'fluttering', 2.0), []
    for speed in (1.6, 2.2, 1.6, 1.0, 1.6):
        for _ in range(200):
            force = part.wrench(instant(velocity=(speed, 0.0, 0.0)))[0]
            part.after(0.01, np.eye(3), np.zeros(3))
        shown.append(-force[0] / (part.coefficient * speed ** 2))
    assert shown == pytest.approx([0.5, 1.5, 1.5, 0.5, 0.5], abs=1e-3)


def test_rolls_of_air_lose_nothing_and_let_nothing_through_the_floor():
    wind, h = made('wind', 'rolls', 2.0), 1e-5
    place = np.array([0.5, -0.3, 0.7])
    slopes = [(wind.wind(0.0, place + h * axis) - wind.wind(0.0, place - h * axis)) @ axis / h
              for axis in np.eye(3)]
    assert sum(slopes) == pytest.approx(0.0, abs=1e-6) and abs(slopes[2]) > 1e-3
    assert wind.wind(0.0, place * [1.0, 1.0, 0.0])[2] == pytest.approx(0.0)
    assert wind.wind(0.0, place + 2.0 * wind.WIDE * wind.across) == pytest.approx(
        wind.wind(0.0, place))


def test_turbulence_is_carried_past_as_it_is():
    wind = made('wind', 'carried', 2.0)
    speed = np.linalg.norm(wind.mean)
    there = 1.5 * wind.mean / speed
    assert wind.wind(3.0 + 1.5 / speed, there) == pytest.approx(wind.wind(3.0, np.zeros(3)))
    air = np.array([wind.wind(t, np.zeros(3)) for t in np.arange(0.0, 300.0, 0.1)])
    assert air.mean(axis=0) == pytest.approx(wind.mean, abs=0.05 * speed)
    assert air[:, 2].std() == pytest.approx(wind.SHARES[2] * speed, rel=0.1)


def test_calm_air_gives_more_thrust_than_air_that_is_stirred():
    rotor = made('inflow', 'stirred', 2.0)
    moves = turning(rotor, 1.0, 3.0, air=np.array([2.0, 0.0, 0.0]))
    calm = rotor.gain(moves)[0] - 1.0
    share = (1.0 / rotor.TIME) / (1.0 / rotor.TIME + 2.0 / rotor.REACH)
    assert calm == pytest.approx(0.06 * (1.0 - share), rel=1e-2)
    assert rotor.gain(turning(rotor, 1.0, 12.0))[0] == pytest.approx(1.0, abs=1e-4)


def test_descents_shake_rotors_and_climbs_do_not():
    rotor, shakes = made('inflow', 'buffeted', 2.0), []
    for z in (-0.6, 0.6):
        gains = np.array([rotor.gain(instant(velocity=(0.0, 0.0, z), rate=np.zeros(3), time=t,
                                             turn=np.ones(4))) for t in np.arange(0, 60, 0.05)])
        shakes.append(gains.std(axis=0))
        assert np.sign(gains.mean(axis=0) - 1.0) == pytest.approx(-np.sign(z))
    assert shakes[0] == pytest.approx(np.full(4, 2.0 * rotor.SHAKES), rel=0.2)
    assert shakes[1] == pytest.approx(np.zeros(4), abs=1e-12)


def test_a_crest_lifts_more_than_a_trough_and_waves_run_past():
    part, times = made('ground_effect', 'waves', 1.0), np.arange(0.0, 6.0, 0.01)
    gains = np.array([part.gain(instant(height=0.3, time=t))[0] for t in times])
    least, most = (0.4 / (1.0 + (0.3 + side * part.HIGH) / 0.1) ** 2 for side in (1.0, -1.0))
    assert gains.min() - 1.0 == pytest.approx(least, rel=0.01)
    assert gains.max() - 1.0 == pytest.approx(most, rel=0.01)
    period = 2.0 * np.pi / np.sqrt(9.81 * part.number)
    assert part.gain(instant(time=1.0 + period)) == pytest.approx(
        part.gain(instant(time=1.0)), rel=1e-3)


def test_a_vehicle_that_leans_loses_its_cushion():
    part, gains = made('ground_effect', 'leaning', 1.0), []
    for lean in (0.0, part.LEANS):
        now = replace(instant(), rotation=Rotation.from_euler('x', lean).as_matrix())
        gains.append(part.gain(now)[0] - 1.0)
    assert gains[1] / gains[0] == pytest.approx(np.exp(-1.0), rel=0.03)


@pytest.mark.slow
def test_of_two_packs_the_fuller_one_does_all_until_the_load_is_high():
    battery = made('battery_sag', 'parallel', 1.0)
    shown = []
    for load in (0.5, 1.0, 2.0, 3.0):
        battery.drain(0.0, 1e-9, np.full(4, load ** (1.0 / 3.0)))
        shown.append(1.0 - battery.ratio)
    assert shown == pytest.approx(0.012 * np.array([0.5, 1.0, 1.5, 2.0]), rel=1e-4)
    for _ in range(60000):      # until both are equally full: then they share
        battery.drain(0.0, 0.01, np.ones(4))
    assert battery._taken[0] - battery._taken[1] == pytest.approx(30.0, rel=0.01)


def test_the_contact_of_a_worn_plug_wanders_about_its_mean():
    levels = []
    for seed in range(40):
        battery = made('battery_sag', 'fretting', 1.0)
        battery.begin(np.random.default_rng(seed))
        battery.drain(0.0, 0.01, np.ones(4))
        levels.append(battery.levels)
        assert 1.0 - battery.ratio == pytest.approx(battery.RESISTS * battery.levels[0])
    assert np.mean(levels) == pytest.approx(1.0, rel=0.1) and np.min(levels) > 0.0


def test_on_a_step_of_a_staircase_the_thrust_hardly_grows():
    part, turn = made('thrust_scale', 'staircase', 2.0), np.arange(0.8, 1.2, 0.001)
    gains = np.array([part.gain(instant(turn=np.full(4, one)))[0] for one in turn])
    changes = np.diff(gains) / part.share
    jumps = np.abs(changes) > 1.0
    assert jumps.sum() in (4, 5)
    assert changes[~jumps] == pytest.approx(-2.0 * part.DEPTH * 0.001 / part.STEP)
    assert np.mean(gains) - 1.0 == pytest.approx(part.share, rel=0.15)


def test_loads_that_are_shared_or_scattered_have_their_mean():
    shared, scattered = (made('mass_offset', form, 2.0) for form in ('shared', 'scattered'))
    masses = np.array([[one.mass(t) for one in (shared, scattered)]
                       for t in np.arange(0.0, 20.0, 0.01)]) / shared.parameters['mass']
    assert masses.mean(axis=0) == pytest.approx(np.ones(2), abs=0.15)
    steps = np.diff(masses[:, 1])
    assert steps[steps != 0.0] == pytest.approx(np.full(5, -0.2))
    assert 0.5 < masses[:, 0].min() < 0.8 < 1.2 < masses[:, 0].max() < 1.5


def test_legs_that_fold_out_are_more_to_turn_and_slow_down_what_turns():
    part = changing.Morphing(2.0, PARAMS, np.random.default_rng(1))
    part.alter(dict(PARAMS), PARAMS)
    part.begin(np.random.default_rng(2))
    times = np.arange(0.0, 12.0, 0.01)
    shares = np.array([part.share(t) for t in times])
    assert (shares.min(), shares.max()) == pytest.approx((1.0 - part.SWING, 1.0 + part.SWING))
    assert np.abs(np.diff(shares)).max() < 0.03 and shares.mean() == pytest.approx(1.0, abs=0.01)
    out = times[int(np.argmax(shares))]
    moment = part.wrench(instant(time=out, rate=(0.1, 0.0, 0.0)))[1]
    assert moment[0] == pytest.approx(-part.loads[0] * (1.0 + part.SWING) * 0.1 / part.TIME)
    part._turning, part._share = np.ones(3), 1.0
    part.wrench(instant(time=out, rate=np.zeros(3)))
    part.after(1e-9, np.eye(3), np.zeros(3))
    assert part._turning == pytest.approx(np.full(3, 1.0 / (1.0 + part.SWING)))


def test_a_camera_looks_the_same_way_when_the_body_turns():
    part, arms = made('com_offset', 'filming', 2.0), []
    for heading in (0.0, 1.3):
        turn = Rotation.from_euler('z', heading)
        now = replace(instant(turn=np.ones(4)), rotation=turn.as_matrix())
        arms.append(turn.apply(part.wrench(now)[1]))
    lift = PARAMS['k_eta'] * 4.0 * HOVER ** 2
    assert arms[0] == pytest.approx(arms[1])
    assert np.linalg.norm(arms[0]) == pytest.approx(
        part.SWINGS * lift * np.linalg.norm(part.centre[:2]))


def test_a_controller_takes_power_back_until_it_has_cooled():
    part, loss = made('rotor_fault', 'folded_back', 2.0), []
    for _ in range(4000):
        now = turning(part, 1.0, 0.01)
        loss.append((1.0 - part.gain(now)[part.rotor]) / 0.01)
    assert min(loss) == pytest.approx(part.LOSSES[0], abs=0.01)
    assert max(loss) == pytest.approx(part.LOSSES[1], abs=0.01)
    assert 7 <= np.sum(np.diff(np.array(loss) > 1.0)) <= 24
    assert np.mean(loss) == pytest.approx(1.0, abs=0.2)


def test_a_blade_stays_folded_or_open_between_two_speeds():
    part, loss = made('rotor_fault', 'half_folded', 2.0), []
    for turn in (1.0, 1.1, 1.0, 0.9, 1.0):
        now = turning(part, turn, 2.0)
        loss.append((1.0 - part.gain(now)[part.rotor]) / 0.01)
    assert loss == pytest.approx([1.7, 0.3, 0.3, 1.7, 1.7], abs=1e-3)
    assert 1.0 - part.torque(now)[part.rotor] == pytest.approx(0.6 * 0.017, rel=1e-3)


def test_a_clutch_that_slips_speeds_up_slowly_and_is_slowed_down_fast():
    part = hubs.SlipperClutch(2.0, PARAMS, None)
    part.begin(None)
    turning(part, 1.0, 0.2)
    turning(part, 1.1, 0.1)
    up = np.mean(part._blades) / HOVER - 1.0
    assert 0.0 < up < 0.1 * part.SLOWS * (part.HOLDS - 1.0) * 1.01
    part.begin(None)
    turning(part, 1.0, 0.2)
    turning(part, 0.9, 0.1)
    assert np.mean(part._blades) / HOVER == pytest.approx(0.9, abs=2e-3)


def test_a_hinge_bumps_beyond_a_speed():
    part = hubs.Bumping(2.0, PARAMS, None)
    slow, fast = (part.wrench(instant(velocity=(x, 0.0, 0.0), rate=np.zeros(3),
                                      turn=np.ones(4)))[1][1] / (part.moment * x)
                  for x in (1.0, 2.4))
    assert slow == pytest.approx(part.SOFT)
    assert fast == pytest.approx(part.SOFT + 0.5 * part.STEEP)


def test_a_plate_with_play_stays_behind_to_the_end_of_its_play():
    part = made('attitude_misalignment', 'playing', 2.0)
    state = np.array([*np.zeros(9), 1.0, 0.3, 0.0, 0.0])
    at_rest = Rotation.from_quat(part.tilted(state)[0][6:10])
    for time, rate, behind in ((0.0, 0.3, 0.0), (0.02, 0.3, 0.006), (1.0, 0.3, 0.01),
                               (1.02, -0.3, 0.004), (2.0, -0.3, -0.01)):
        state[10] = rate
        seen = part.measured(time, state, 1.0)
        turn = (at_rest.inv() * Rotation.from_quat(seen[6:10])).as_rotvec()
        assert turn == pytest.approx([-behind, 0.0, 0.0], abs=1e-9)
        assert seen[10:] == pytest.approx(state[10:])


def test_a_bias_swings_faster_the_faster_the_rotors_turn():
    for turn in (1.0, 1.2):
        bias, times = made('gyro_bias', 'aliased', 2.0), np.arange(0.0, 40.0, 0.01)
        shares = np.array([bias.share(t, turn ** 2) for t in times])
        crossings = np.sum(np.diff(np.sign(shares[:, 0] - 1.0)) != 0.0) / 2.0 / 40.0
        assert crossings == pytest.approx(bias.HOVERS + bias.MORE * (turn - 1.0), rel=0.1)
        assert np.abs(shares - 1.0).max() == pytest.approx(bias.SWING, rel=0.01)
