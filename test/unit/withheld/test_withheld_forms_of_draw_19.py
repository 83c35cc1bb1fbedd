# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The forms that the nineteenth draw is the first to fly: what each does."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import (
    fresh,
    HOVER,
    instant,
    made,
    PARAMS,
    PLACES,
    REST,
    still,
    turning,
)

from withheld.constants import GRAVITY
from withheld.forms import cushions, errors, joints, rings, tails, torques


def left_of(motor, steps, share, parts=400):
    """Return what is left of steps (n,) of the speed in hover after a share of the time."""
    speeds, step = HOVER * (1.0 - steps), share * motor.parameters['time'] / parts
    for _ in range(parts):
        speeds = motor.turn(speeds, np.full(len(steps), HOVER), step)
    return (1.0 - speeds / HOVER) / steps


def test_a_held_command_is_followed_alike_in_one_step_and_in_many():
    motor, steps = errors.ErrorSquared(2.0, PARAMS, None), np.array([0.0, 1e-4, 0.05, -0.2])
    once = motor.turn(HOVER * (1.0 - steps), np.full(4, HOVER), 0.8 * motor.parameters['time'])
    assert (1.0 - once / HOVER)[1:] / steps[1:] == pytest.approx(
        left_of(motor, steps[1:], 0.8), rel=1e-9)
    assert once[0] == HOVER


def test_a_large_error_is_answered_by_more_than_its_share():
    motor = errors.ErrorSquared(2.0, PARAMS, None)
    slopes = 1.0 - left_of(motor, np.array([1e-5, motor.EVEN, 3.0 * motor.EVEN]), 0.001)
    assert slopes / 0.001 == pytest.approx(
        [motor.GENTLE, 1.0, 3.0 - 2.0 * motor.GENTLE], rel=3e-3)


def test_a_large_error_is_answered_by_less_where_the_angle_is_lost():
    motor = errors.LostAngle(2.0, PARAMS, None)
    slopes = 1.0 - left_of(motor, np.array([1e-5, motor.HALF, 20.0 * motor.HALF]), 0.001)
    assert slopes / 0.001 == pytest.approx(
        [1.0, 0.5 * (1.0 + motor.LEFT), motor.LEFT], rel=1e-2)
    assert left_of(motor, np.array([1e-5]), 1.0) == pytest.approx(np.exp(-1.0), rel=1e-3)


@pytest.mark.parametrize('form', ['redundant', 'disciplined'])
def test_a_line_has_its_mean_delay(form):
    line, waits = made('actuation_delay', form, 2.0), []
    for seed in range(40):
        line.begin(np.random.default_rng(seed))
        waits += [line.waits(t) for t in np.arange(0.0, 100.0, 0.03)]
    assert np.mean(waits) == pytest.approx(line.delay, rel=0.04) and np.min(waits) > 0.0


def test_the_slow_link_is_the_bound_of_the_fast_one():
    line = made('actuation_delay', 'redundant', 2.0)
    waits = np.array([line.waits(t) for t in np.arange(0.0, 100.0, 0.02)])
    at_bound = np.isclose(waits, line.delay * line.SLOW / line.MEAN)
    assert waits.max() == waits[at_bound][0] and 0.05 < np.mean(at_bound) < 0.35


@pytest.mark.slow
def test_a_clock_swings_as_it_is_set():
    line, offs = made('actuation_delay', 'disciplined', 2.0), []
    for seed in range(300):
        line.begin(np.random.default_rng(seed))
        offs.append(line.offs * np.sign(line.offs[0]))
    offs = np.array(offs)
    mean, half = offs.mean(axis=0), round(np.pi / (line.RATE * line.EVERY))
    assert mean[0] == pytest.approx(line.FIRST, abs=0.02)
    assert mean[half] == pytest.approx(-line.FIRST * np.exp(-np.pi * line.DAMPING), abs=0.1)
    assert np.std(offs[:, 1000:]) == pytest.approx(line.OFF, rel=0.1)


def test_soft_arms_lean_the_thrust_back_later_and_by_more_at_more_thrust():
    part, drags = made('rotor_drag', 'soft_arms', 2.0), []
    for turn, seconds in ((1.0, 0.0), (1.0, 3.0), (1.2, 3.0)):
        part.begin(None)
        now = turning(part, turn, seconds, air=np.array([1.5, 0.0, 0.0]))
        drags.append(-part.wrench(now)[0][0] / (1.5 * part.coefficient))
    assert drags == pytest.approx([part.OWN, part.OWN + part.MORE,
                                   1.2 * part.OWN + 1.2 ** 3 * part.MORE], rel=1e-3)


def test_a_pod_turns_its_nose_into_the_flow_within_a_way():
    part, forces = made('body_drag', 'swivelling', 2.0), {}
    for speed in (1.0, 2.0):
        part.begin(np.random.default_rng(1))
        part._points = 0.5 * np.pi
        ahead = np.array([speed, 0.0, 0.0])
        for way in (0.0, 0.8, 8.0):
            part._points = 0.5 * np.pi
            now = turning(part, 1.0, way / speed, step=0.002, air=ahead)
            forces[speed, way] = part.wrench(now)[0] / (part.coefficient * speed ** 2)
    assert forces[1.0, 0.0] == pytest.approx([-part.OWN - part.SIDE, 0.0, 0.0])
    assert forces[1.0, 8.0] == pytest.approx([-part.OWN, 0.0, 0.0], abs=1e-3)
    assert forces[1.0, 0.8] == pytest.approx(forces[2.0, 0.8], rel=5e-3)
    assert abs(forces[1.0, 0.8][1]) > 0.1


def test_a_pod_points_where_it_points_while_the_body_turns_below_it():
    part = made('body_drag', 'swivelling', 2.0)
    part._points = 0.3
    turning(part, 1.0, 1.0, rate=np.array([0.0, 0.0, 0.2]))
    assert part._points == pytest.approx(0.1)


def test_a_cover_fills_from_its_open_side_alone_and_empties_in_time():
    part, drags = made('body_drag', 'billowing', 2.0), []
    for way, seconds in ((1.0, 5.0), (-1.0, 0.8), (-1.0, 10.0)):
        now = turning(part, 1.0, seconds, air=2.0 * way * part.open)
        drags.append(np.linalg.norm(part.wrench(now)[0]) / (4.0 * part.coefficient))
    full = 2.0 / part.FILLS / (2.0 / part.FILLS + 1.0 / part.EMPTIES)
    assert drags == pytest.approx([part.OWN + part.MORE * full,
                                   part.OWN + part.MORE * full * np.exp(-1.0), part.OWN], abs=1e-4)


def test_wind_behind_a_turbine_is_slower_turns_and_beats():
    wind = made('wind', 'turbine', 2.0)
    speed, times = np.linalg.norm(wind.mean), np.arange(0.0, 40.0, 0.01)
    axis = wind.off * wind.across + [0.0, 0.0, wind.HIGH]
    radius = wind.RADIUS + wind.WIDENS * wind.AWAY
    side = np.array([wind.wind(t, axis + 0.5 * radius * wind.across) for t in times]) / speed
    assert np.mean(side @ wind.along) == pytest.approx(
        1.0 - wind.SLOWER * (wind.RADIUS / radius) ** 2, abs=0.02)
    assert np.mean(side[:, 2]) == pytest.approx(
        -np.sign(wind.spin) * 0.5 * wind.TURNS, rel=0.01)
    spectrum = np.abs(np.fft.rfft(side @ wind.along - np.mean(side @ wind.along)))
    assert np.argmax(spectrum) / 40.0 == pytest.approx(
        wind.BLADES * wind.SPIN / (2.0 * np.pi), abs=0.03)
    away = wind.wind(1.0, axis + 3.0 * radius * wind.across)
    assert away == pytest.approx(wind.mean, abs=1e-6)


def test_every_fan_of_a_wall_blows_as_fast_as_it_does():
    wind, rng = made('wind', 'fan_wall', 2.0), np.random.default_rng(1)
    assert np.mean(wind.speeds) == pytest.approx(1.0)
    air = np.array([wind.wind(0.0, [x, y, z]) for x, y, z in rng.uniform(
        [-1.5, -1.5, 0.2], [1.5, 1.5, 2.0], (300, 3))])
    shares = air @ wind.mean / (wind.mean @ wind.mean)
    assert np.allclose(air, shares[:, None] * wind.mean) and 0.1 < np.std(shares) < 0.6
    along = wind.mean / np.linalg.norm(wind.mean)
    assert wind.wind(3.0, REST + along) == pytest.approx(wind.wind(3.0, REST))
    assert np.linalg.norm(wind.wind(5.0, REST) - wind.wind(3.0, REST)) > 0.01


def test_a_ring_loses_its_lift_beyond_a_ratio_and_sooner_in_a_descent():
    rotor = made('inflow', 'ringed', 2.0)

    def lost(x, z=0.0):
        return (1.0 - rotor.gain(still(air=rotor.induced * np.array([x, 0.0, z])))[0]) / 2.0

    assert lost(0.0) == 0.0 < lost(0.2) < 0.05 * rotor.LIP
    assert lost(rotor.PARTS) == pytest.approx(0.5 * rotor.LIP, rel=1e-3)
    assert lost(1.0) == pytest.approx(rotor.LIP, rel=1e-3)
    assert lost(0.36, -0.2) + 0.2 * rotor.TAKES > 0.7 * rotor.LIP > 0.3 * rotor.LIP > lost(0.36)


def test_flow_that_parted_in_a_descent_clings_again_in_a_climb_alone():
    rotor, parted = rings.Reattaching(2.0, PARAMS, None), []
    rotor.begin(None)
    for climb in (0.02, -0.08, -0.12, -0.08, 0.02, 0.06, -0.08):
        air = np.array([0.0, 0.0, climb * rotor.induced])
        now = turning(rotor, 1.0, 2.0, air=air)
        takes = rotor.gain(now)
        parted.append(float(np.mean(rotor._parted)))
    assert parted == pytest.approx([0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0], abs=1e-6)
    assert takes == pytest.approx(np.full(4, 1.0 + 2.0 * rotor.TAKES * 0.08))
    rotor._parted = np.ones(4)
    assert rotor.gain(now) == pytest.approx(np.full(
        4, 1.0 + 2.0 * (rotor.LESS * rotor.TAKES * 0.08 - rotor.LOSES)))


def test_ground_is_restless_in_hover_and_steadier_in_flight():
    part = made('ground_effect', 'restless', 1.0)
    hover, fast = (np.array([
        part.gain(still(time=t, heights=np.full(4, 0.2), air=np.array([x, 0.0, 0.0]))) - 1.0
        for t in np.arange(0.0, 100.0, 0.05)]) / (0.14 * np.exp(-1.8))
        for x in (0.0, part.SWEPT * part.induced))
    assert np.mean(hover) == pytest.approx(1.0, abs=0.1) and 0.5 < np.std(hover) < 1.1
    assert fast - 1.0 == pytest.approx(0.5 * (hover - 1.0))
    assert abs(np.corrcoef(hover.T)[0, 1]) < 0.3


def test_a_cushion_that_is_left_behind_lifts_the_rotors_at_the_back():
    part = cushions.BlownBack(1.0, PARAMS, None)

    def more(x):
        now = still(heights=np.full(4, 0.2), air=part.induced * np.array([x, 0.0, 0.0]))
        return (part.gain(now) - 1.0) / (0.12 * np.exp(-1.6))

    front = PLACES[:, 0] > 0.0
    assert more(0.0) == pytest.approx(np.ones(4))
    assert np.all(more(0.4)[~front] > 1.1) and np.all(more(0.4)[front] < 0.8)
    assert more(6.0) == pytest.approx(np.zeros(4), abs=1e-3)


def test_an_autopilot_gives_most_of_a_load_s_thrust_back():
    battery = made('battery_sag', 'compensated', 2.0)

    def drained(turn, count):
        for _ in range(count):
            battery.drain(0.0, 0.01, np.full(4, turn))
        return 1.0 - battery.ratio

    assert drained(1.0, 1) == pytest.approx(2.0 * battery.RESISTS, rel=0.01)
    fell = 2.0 * (battery.RESISTS + battery.FALLS)
    # What it measured is late, by its time.
    late = 2.0 * battery.FALLS * battery.TIME / 30.0
    assert drained(1.0, 3000) == pytest.approx(
        (1.0 - battery.MAKES) * fell + battery.MAKES * late, rel=0.1)
    battery = made('battery_sag', 'compensated', 2.0)
    battery.FALLS, more = 0.0, 2.0 * battery.RESISTS * (1.2 ** 3 - 1.0)
    shown = [drained(1.0, 3000), drained(1.2, 1), drained(1.2, 3000)]
    assert np.diff(shown) == pytest.approx([more, -battery.MAKES * more], rel=0.05)


def test_a_buffer_takes_a_peak_until_it_is_empty():
    battery, step = made('battery_sag', 'peak_shaved', 2.0), 0.001
    battery.FALLS, more = 0.0, 1.1 ** 3 - 1.0
    lasts = 0.5 * battery.HOLDS / more
    shown = []
    for _ in range(round(1.5 * lasts / step)):
        battery.drain(0.0, step, np.full(4, 1.1))
        shown.append((1.0 - battery.ratio) / (2.0 * battery.RESISTS))
    assert shown[round(0.8 * lasts / step)] == pytest.approx(1.0, abs=0.02)
    assert shown[-1] == pytest.approx(1.0 + more)
    for _ in range(round(3.0 * battery.HOLDS / step)):
        battery.drain(0.0, step, np.full(4, 0.8))
    assert battery._holds == battery.HOLDS
    assert battery.ratio == pytest.approx(1.0 - 2.0 * battery.RESISTS * 0.8 ** 3)


def test_rain_takes_thrust_and_fast_propellers_throw_it_off():
    part = made('thrust_scale', 'wetted', 2.0)
    part.levels[:] = 1.0
    slow, fast = (part.gain(turning(part, turn, 20.0))[0] - 1.0 for turn in (1.0, 1.2))
    assert slow == pytest.approx(part.share) and fast == pytest.approx(part.share / 1.44)
    part.levels[:] = 0.0
    dries = part.gain(turning(part, 1.0, part.DRIES))[0] - 1.0
    assert dries == pytest.approx(fast * np.exp(-1.0), rel=1e-3) and part.share < 0.0


def test_a_rig_takes_weight_off_and_lags_behind_a_climb():
    part = made('mass_offset', 'offloaded', 2.0)
    true, before = fresh(), fresh()
    part.alter(true, PARAMS)
    assert true['mass'] == before['mass'] and part.parameters['mass'] < 0.0
    weight = -part.parameters['mass'] * GRAVITY

    def pull(rises, seconds):
        now = turning(part, 1.0, seconds, velocity=np.array([0.5, 0.0, rises]))
        return part.wrench(now)[0] / weight

    assert pull(0.0, 0.1) == pytest.approx([0.0, 0.0, 1.0])
    assert pull(1.0, 0.0)[2] == pytest.approx(1.0 - part.LATE - part.RUBS)
    assert pull(1.0, 6.0)[2] == pytest.approx(1.0 - part.RUBS, abs=1e-3)
    assert pull(-1.0, 8.0)[2] == pytest.approx(1.0 + part.RUBS, abs=1e-3)


def test_a_rope_hangs_on_the_vehicle_the_more_the_farther_it_is_from_the_pole():
    part = made('mass_offset', 'strung', 2.0)
    onto = np.array([*part.pole, 0.0]) / part.AWAY
    here, away = (part.wrench(still(position=place))[0] for place in (REST, -2.5 * onto))
    weight = part.parameters['mass'] * GRAVITY
    assert here == pytest.approx(weight * (part.ASIDE * onto - [0.0, 0.0, 1.0]))
    assert away == pytest.approx(2.0 * here)


def test_joints_hold_in_gentle_turns_and_yield_in_sharp_ones():
    def behind(slope):
        part = joints.Jointed(2.0, PARAMS, np.random.default_rng(1))
        part.alter(dict(PARAMS), PARAMS)
        part.begin(None)
        moments = []
        for k in range(200):
            now = instant(rate=(slope * 0.0025 * k, 0.0, 0.0))
            moments.append(part.wrench(now)[1][0] / part.loads[0])
            part.after(0.0025, np.eye(3), REST)
        return np.abs(part._angle[0]), np.mean(moments[100:])

    (gentle, held), (sharp, _) = behind(0.5), behind(10.0)
    assert held == pytest.approx(-0.5, rel=0.2)
    assert sharp > 40.0 * gentle and gentle < joints.Jointed.PLAY


@pytest.mark.slow
def test_a_counterweight_comes_after_its_arm():
    part = made('com_offset', 'counterweight', 2.0)
    offs = []
    for seed in range(30):
        part.begin(np.random.default_rng(seed))
        offs.append(part.offs)
    offs = np.array(offs)
    assert offs.mean(axis=(0, 1)) == pytest.approx(np.zeros(2), abs=0.02)
    assert 0.1 < np.std(offs) < 0.5 and np.mean(np.all(offs == 0.0, axis=2)) > 0.2
    steps = np.linalg.norm(np.diff(offs, axis=1), axis=2) / part.EVERY
    assert steps.max() < part.ARM + part.BATTERY + 1e-9
    now = still(time=2.0)
    x, y = part.FAR * np.linalg.norm(part.centre[:2]) * part.offs[100]
    lift = PARAMS['k_eta'] * 4.0 * HOVER ** 2
    assert part.wrench(now)[1] == pytest.approx(lift * np.array([-y, x, 0.0]))


def test_a_starved_bearing_rubs_below_a_speed():
    part = made('rotor_fault', 'starved', 2.0)
    loss = [(1.0 - part.gain(still(speeds=np.full(4, turn * HOVER)))[part.rotor]) / 0.01
            for turn in (0.8, 1.0, 1.15, 1.3)]
    assert loss[:2] == pytest.approx([part.FLOATS * 0.8 + part.RUBS, 1.0], rel=1e-2)
    assert loss[2:] == pytest.approx([part.FLOATS * 1.15, part.FLOATS * 1.3], abs=0.01)
    assert part.torque(instant()) == pytest.approx(part.gain(instant()))


def test_a_propeller_works_loose_as_it_slows_down_and_stays_so():
    part, loss = made('rotor_fault', 'working_loose', 2.0), []
    for turn in (1.0, 1.2, 1.14, 1.0, 0.9, 1.02):
        now = turning(part, turn, 0.05)
        loss.append((1.0 - part.gain(now)[part.rotor]) / 0.01)
    tight, loose = part.FIRST, part.FIRST + part.MORE
    middle = 0.5 * (tight + loose)
    assert loss == pytest.approx([middle, tight, middle, loose, loose, tight])
    assert part.torque(now) == pytest.approx(part.gain(now))


def test_a_torque_overshoots_until_the_inflow_has_followed():
    part, true = torques.LateInflow(2.0, PARAMS, None), fresh()
    part.alter(true, PARAMS)
    assert true['rotor_inertia'] == pytest.approx(part.OWN * part.inertia)
    part.begin(None)
    turning(part, 1.0, 0.1)
    faster = HOVER * np.where(part.spins > 0, 1.05, 1.0)
    moments = []
    for _ in range(400):
        moments.append(part.wrench(still(speeds=faster, rate=np.array([1.0, 0.5, 0.0])))[1])
        part.after(0.0025, np.eye(3), REST)
    moments = np.array(moments)
    assert not np.any(moments[:, :2]) and abs(moments[-1, 2]) < 1e-3 * moments[0, 2]
    # In all it is as if that much more inertia had been sped up.
    assert 0.0025 * np.sum(moments[:, 2]) == pytest.approx(
        part.MORE * part.inertia * 2.0 * 0.05 * HOVER, rel=0.03)


def test_a_tail_is_pushed_down_at_middling_speeds_ahead():
    part = tails.Tailed(2.0, PARAMS, None)

    def moment(x, y=0.0):
        air = np.array([x, y, 0.0]) * part.induced
        return part.wrench(still(air=air))[1] / part.moment

    for x, y in ((-part.MEETS, 0.0), (0.0, part.MEETS), (1.5, 0.0)):
        assert moment(x, y) == pytest.approx(
            part.OWN * part.induced * np.array([-y, x, 0.0]), abs=0.05)
    ahead = moment(part.MEETS)[1] - part.OWN * part.induced * part.MEETS
    assert ahead == pytest.approx(-part.PUSH, rel=0.05)
    assert np.allclose(moment(0.0), 0.0)


def test_a_mast_bends_back_with_the_square_of_the_speed():
    part, heads = made('attitude_misalignment', 'mast', 2.0), Rotation.from_euler('z', 1.0)
    state, bent = np.array([*np.zeros(6), *heads.as_quat(), 0.1, 0.2, 0.3]), []
    for speed in (0.0, part.USUAL, 0.5 * part.USUAL, 20.0):
        state[3:6] = heads.apply([speed, 0.0, 0.3])
        out = part.measured(0.0, state, 1.0)
        assert out[:6] == pytest.approx(state[:6]) and out[10:] == pytest.approx(state[10:])
        bent.append(Rotation.from_quat(out[6:10]))
    tilt = np.linalg.norm(part.angles)
    assert (heads.inv() * bent[0]).as_euler('ZYX')[::-1] == pytest.approx(part.angles)
    for one, share in zip(bent[1:], (part.BENDS, 0.25 * part.BENDS, part.MOST), strict=True):
        assert (bent[0].inv() * one).as_rotvec() == pytest.approx([0.0, -share * tilt, 0.0])
    # Its top goes back.
    assert (bent[0].inv() * bent[3]).apply([0.0, 0.0, 1.0])[0] < 0.0


def test_a_gyroscope_is_off_most_where_its_plate_resonates():
    part, state = made('gyro_bias', 'resonating', 2.0), np.array([*np.zeros(9), 1.0, *REST])
    shares = [part.measured(0.0, state, thrust)[10:] @ part.bias / (part.bias @ part.bias)
              for thrust in (part.middle ** 2, (part.middle + part.WIDE) ** 2, 0.6, 1.5)]
    assert shares[:2] == pytest.approx([part.FIRST + part.PEAK, part.FIRST + 0.5 * part.PEAK])
    assert max(shares[2:]) < part.FIRST + 0.1
