# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The realities of the withheld check: other forms of the effects, wrong files, logs."""

from importlib.util import find_spec
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import fresh, HOVER, instant, made, PARAMS, PLACES

from withheld.actuators import Battery, Line, Motor
from withheld.files import FARTHEST, misread, SPREADS
from withheld.forms import (
    air,
    batteries,
    body,
    cells,
    escs,
    EVENTS,
    FORMS,
    links,
    loads,
    motors,
    rotors,
    wakes,
)
from withheld.influence import Influence, Instant
from withheld.lists import NOISES
from withheld.logs import Grounded, Logging, LowPass
from withheld.sensors import declared, moved, Noise, noise_of, WHITE

FLAT = [(effect, form) for table in (*FORMS.values(), EVENTS) for effect, forms in table.items()
        for form in forms if form not in ('brushed', 'brushless')]


@pytest.mark.parametrize(('effect', 'form'), FLAT)
def test_a_form_of_size_zero_is_no_effect(effect, form):
    part, now, command = made(effect, form, 0.0), instant(), HOVER * np.array([1.2, 0.8, 1.0, 1.1])
    assert part.bodies().get('hull', 0.0) == 0.0 and 'payload' not in part.bodies()
    if isinstance(part, Line):
        [(duration, given)] = part.pass_on(0.0, command, 0.01)
        assert duration == pytest.approx(0.01) and np.array_equal(given, command)
    if isinstance(part, Motor):
        np.testing.assert_allclose(part.turn(np.full(4, HOVER), command, 0.002), command)
    if isinstance(part, Battery):
        for k in range(2000):
            part.drain(0.01 * k, 0.01, now.speeds / HOVER)
        np.testing.assert_allclose(part.ratio, 1.0)
        np.testing.assert_allclose(part.gain(now.speeds / HOVER), 1.0)
    if isinstance(part, Influence):
        true, state = fresh(), np.array([*np.arange(6.0), 0.0, 0.0, 0.6, 0.8, 0.1, 0.2, 0.3])
        part.alter(true, PARAMS)
        for key, value in fresh().items():
            same = true[key]
            for one, other in ([(same, value)] if key != 'rotor_pos' else
                               zip(same.values(), value.values(), strict=True)):
                np.testing.assert_allclose(one, other, atol=1e-15)
        assert not np.any(true.get('rotor_inertia', 0.0))
        np.testing.assert_allclose(part.given(command), command)
        # What has a state of its own is no effect however long it flies.
        for k in range(100):
            t = 0.2 * k
            np.testing.assert_allclose(np.ones(4) * part.gain(now), 1.0, atol=1e-12)
            np.testing.assert_allclose(np.ones(4) * part.torque(now), 1.0, atol=1e-12)
            np.testing.assert_allclose(part.measured(t, state, 1.1), state, atol=1e-12)
            assert not np.any(part.wind(t, now.position)) and part.mass(t) == 0.0
            for extra in part.wrench(now) or ():
                np.testing.assert_allclose(extra, 0.0, atol=1e-12)
            part.after(0.01, np.eye(3), np.array([0.5, 0.0, 3.0]))


@pytest.mark.parametrize(('effect', 'form'), FLAT)
def test_a_form_is_the_same_in_every_flight_of_a_case(effect, form):
    one, other = made(effect, form, 2.0), made(effect, form, 2.0)
    assert one.parameters == other.parameters and one.parameters
    assert isinstance(one.comparable, bool)


def test_a_line_passes_commands_on_after_their_delay():
    line, first, second = Line(0.013), np.full(4, 1.0), np.full(4, 2.0)
    assert [d for d, _ in line.pass_on(0.0, first, 0.01)] == pytest.approx([0.01])
    [(held, old)] = line.pass_on(0.01, second, 0.01)[:1]
    assert old[0] == 1.0
    parts = line.pass_on(0.02, second, 0.01)
    assert [d for d, _ in parts] == pytest.approx([0.003, 0.007])
    assert [command[0] for _, command in parts] == [1.0, 2.0]


def test_rotors_of_a_bus_get_their_commands_one_after_another():
    bus = motors.Staggered(0.5, PARAMS, None)       # 3.6 to 8.4 ms
    bus.pass_on(0.0, np.zeros(4), 0.01)
    parts = bus.pass_on(0.01, np.ones(4), 0.01)
    assert sum(d for d, _ in parts) == pytest.approx(0.01)
    assert [int(command.sum()) for _, command in parts] == [0, 1, 2, 3, 4]


def test_a_command_that_is_overtaken_is_lost():
    line = Line()
    line.waits = {0.0: 0.02, 0.01: 0.002}.__getitem__
    line.pass_on(0.0, np.full(4, 1.0), 0.01)
    line.pass_on(0.01, np.full(4, 2.0), 0.01)
    line.waits = lambda time: 0.05
    assert [command[0] for _, command in line.pass_on(0.02, np.full(4, 3.0), 0.01)] == [2.0]


def test_an_oscillating_motor_overshoots_by_what_its_damping_says():
    motor = motors.Underdamped(2.0, PARAMS, None)
    speeds, shown = np.full(4, HOVER), []
    for _ in range(1000):
        speeds = motor.turn(speeds, np.full(4, 1.2 * HOVER), 0.0005)
        shown.append(speeds[0])
    over = np.exp(-np.pi * 0.5 / np.sqrt(1.0 - 0.5 ** 2))
    assert (max(shown) - 1.2 * HOVER) / (0.2 * HOVER) == pytest.approx(over, rel=0.02)
    assert shown[-1] == pytest.approx(1.2 * HOVER, rel=1e-4)


def test_a_motor_with_a_dead_band_stops_at_its_edge_on_either_side():
    motor = motors.DeadBand(2.0, PARAMS, None)
    speeds, command = np.array([0.8, 1.2, 1.0, 1.0]) * HOVER, np.array([1.0, 1.0, 1.005, 1.0])
    for _ in range(2000):
        speeds = motor.turn(speeds, command * HOVER, 0.0005)
    assert speeds / HOVER == pytest.approx([0.99, 1.01, 1.0, 1.0], abs=1e-6)


def test_a_motor_in_balance_of_torque_rises_faster_than_it_falls():
    motor, step = motors.TorqueBalance(2.0, PARAMS, None), 0.0005
    speeds = np.array([0.8, 1.2, 1.0, 1.0]) * HOVER
    for _ in range(40):
        speeds = motor.turn(speeds, np.array([1.2, 0.8, 1.0, 1.0]) * HOVER, step)
    # w = c tanh(c t / (2 wh T) + artanh(w0 / c)), by separation of the variables.
    rise = 1.2 * np.tanh(1.2 * 0.02 / (2 * 0.024) + np.arctanh(0.8 / 1.2))
    assert speeds[0] / HOVER == pytest.approx(rise, rel=1e-3)
    assert 1.2 - speeds[0] / HOVER < speeds[1] / HOVER - 0.8


def test_a_full_cell_drops_first_and_then_falls_slowly():
    battery, shown = batteries.ExponentialZone(3.0, PARAMS, None), []
    for _ in range(2000):
        battery.drain(0.0, 0.01, np.ones(4))
        shown.append(battery.ratio)
    assert shown[0] == pytest.approx(1.0, abs=1e-3)
    assert shown[0] - shown[500] > 3.0 * (shown[1000] - shown[1500]) > 0.0


def test_a_cold_cell_recovers_as_it_warms_and_then_falls():
    battery, shown = batteries.Warming(3.0, PARAMS, None), []
    for k in range(6000):
        battery.drain(0.01 * k, 0.01, np.ones(4))
        shown.append(battery.ratio)
    assert shown[0] < shown[1000] > shown[5999]


def test_a_cell_polarises_within_its_time_constant():
    battery = batteries.Recovery(1.0, PARAMS, None)
    for _ in range(600):
        battery.drain(0.0, 0.01, np.ones(4))
    assert 1.0 - battery.ratio == pytest.approx(0.012 * (1.0 - np.exp(-1.0)), rel=0.01)


def test_past_its_knee_a_battery_falls_faster():
    battery, falls = batteries.Knee(4.0, PARAMS, None), []
    for time in (0.0, 5.0, 15.0, 20.0):
        battery.drain(time, 0.01, np.ones(4))
        falls.append(battery.ratio)
    assert falls[0] == pytest.approx(1.0)
    assert falls[2] - falls[3] > 2.0 * (falls[0] - falls[1]) > 0.0


@pytest.mark.parametrize(('kind', 'power'), [(air.Power16, 1.6), (air.Steeper, 1.25)])
def test_drag_grows_with_its_power(kind, power):
    part = kind(1.0, PARAMS, np.random.default_rng(1))
    slow, fast = (np.linalg.norm(part.wrench(instant(velocity=(v, 0.0, 0.0)))[0])
                  for v in (1.0, 2.0))
    assert fast / slow == pytest.approx(2.0 ** power)


def test_momentum_theory_leaves_the_thrust_at_rest_alone():
    part = air.Momentum(10.0, PARAMS, None)
    rest = part.gain(instant(velocity=(0.0, 0.0, 0.0), rate=(0.0, 0.0, 0.0)))
    np.testing.assert_allclose(rest, 1.0, atol=1e-4)
    climb, forward = (part.gain(instant(velocity=v)).mean() for v in ((0, 0, 2.0), (5.0, 0, 0)))
    assert climb < 1.0 < forward


def test_the_induced_velocity_is_that_of_momentum_theory():
    part, now = air.Momentum(10.0, PARAMS, None), instant(rate=(0.0, 0.0, 0.0), turn=(1.0,) * 4)
    gain, c2 = part.gain(now)[0], 0.1
    flow = (1.0 - gain + c2) / c2 - now.air[2] / part.induced     # of that in hover
    speed = np.hypot(np.hypot(*now.air[:2]), now.air[2] + flow * part.induced)
    assert flow * speed / part.induced == pytest.approx(gain, rel=1e-3)


@pytest.mark.parametrize('kind', [air.Rational, air.Cushion, air.Swept, air.Bounded,
                                  wakes.Fountain])
def test_the_ground_gives_thrust_that_fades_with_height(kind):
    part = kind(2.0, PARAMS, None)
    gains = [part.gain(instant(height=height)).mean() for height in (0.1, 0.2, 0.3, 3.0)]
    assert np.all(np.diff(gains) < 0.0) and gains[-1] == pytest.approx(1.0, abs=2e-3)


def test_a_payload_moves_centre_and_inertia_by_steiner():
    true = fresh()
    body.add_mass(true, 0.1, np.array([0.0, 0.0, -0.06]))
    assert true['mass'] == pytest.approx(0.6)
    assert true['centre'] == pytest.approx([0.0, 0.0, -0.01])
    about = 3e-3 + 0.5 * 0.01 ** 2 + 0.1 * 0.05 ** 2
    assert true['Ixx'] == pytest.approx(about) and true['Izz'] == pytest.approx(5e-3)


def test_products_of_inertia_leave_a_body_that_can_be():
    true = fresh()
    body.Products(3.0, PARAMS, np.random.default_rng(2)).alter(true, PARAMS)
    moments = np.linalg.eigvalsh(body.inertia_of(true))
    assert np.all(moments > 0.0) and true['Ixy'] != 0.0


def test_another_torque_is_the_ratio_of_inertia_to_moment():
    true = fresh()
    torque = body.TorqueCoefficient(3.0, PARAMS, np.random.default_rng(2))
    torque.alter(true, PARAMS)
    assert 1e-7 / true['k_m'] == pytest.approx(torque.parameters['factor_z'])


def test_an_entrained_inertia_resists_until_it_turns_as_fast():
    part = body.Entrained(3.0, PARAMS, np.random.default_rng(2))
    part.begin(None)
    part.alter(fresh(), PARAMS)
    now, moments = instant(rate=(1.0, 0.0, 0.0)), []
    for _ in range(100):
        moments.append(part.wrench(now)[1][0])
        part.after(0.002, np.eye(3), np.zeros(3))
    # All that it takes up is the angular momentum of its inertia.
    assert 0.002 * np.sum(moments) == pytest.approx(-part.loads[0], rel=0.05)
    assert abs(moments[-1]) < 0.05 * abs(moments[0])


def test_a_thrust_curve_that_levels_off_has_a_kink_in_hover():
    part = body.Levelling(3.0, PARAMS, np.random.default_rng(2))
    gains = [part.gain(instant(turn=(x,) * 4))[0] - 1.0 for x in (0.8, 0.9, 1.0, 1.1, 1.2)]
    assert np.diff(gains)[2:] == pytest.approx([0.0, 0.0])
    assert np.diff(gains)[:2] == pytest.approx(np.full(2, -0.6 * part.share))


def test_rotors_behind_lose_thrust_in_forward_flight():
    part = air.Shadowed(3.0, PARAMS, None)
    gain = part.gain(instant(velocity=(3.0, 0.0, 0.0), rate=(0.0, 0.0, 0.0), turn=(1.0,) * 4))
    assert gain[:2] == pytest.approx(np.ones(2)) and np.all(gain[2:] < 0.99)


def test_a_rotor_fails_more_and_more():
    part = body.Incipient(4.0, PARAMS, np.random.default_rng(2))
    losses = [1.0 - part.gain(instant(time=t))[part.rotor] for t in (0.0, 10.0, 20.0)]
    assert losses == pytest.approx([0.01, 0.02, 0.03])


def test_a_motor_that_is_not_braked_coasts_down_and_is_driven_up():
    motor, step = escs.Coasting(3.0, PARAMS, None), 0.001
    speeds = np.array([0.7, 1.3, 1.0, 1.0]) * HOVER
    for _ in range(50):
        speeds = motor.turn(speeds, np.array([1.3, 0.7, 1.0, 1.0]) * HOVER, step)
    grown = 3.0 ** 0.7      # dw/dt = -B w^2 with B w = 10 / grown per s in hover; upwards a lag
    assert speeds[1] / HOVER == pytest.approx(1.3 / (1.0 + 1.3 * 0.05 * 10.0 / grown), rel=1e-3)
    assert 1.3 - speeds[0] / HOVER == pytest.approx(0.6 * np.exp(-0.05 / (0.009 * grown)),
                                                    rel=1e-3)


def test_a_motor_with_a_slow_tail_has_the_mean_lag_of_its_time():
    motor, step, missing = escs.SlowTail(2.0, PARAMS, None), 0.0005, []
    speeds = np.full(4, HOVER)
    for _ in range(2000):
        speeds = motor.turn(speeds, np.full(4, 1.2 * HOVER), step)
        missing.append(1.2 - speeds[0] / HOVER)
    assert step * np.sum(missing) / 0.2 == pytest.approx(0.024, rel=0.03)
    # 0.1 s on, a lag would be at 0.015 of the step.
    assert 0.05 < missing[199] / 0.2 < 0.1


def test_a_link_is_fast_mostly_and_slow_now_and_then():
    link = links.Congested(1.0, PARAMS, None)
    link.begin(np.random.default_rng(1))
    waits = np.array([link.waits(t) for t in np.arange(0.0, 200.0, 0.01)]) / link.delay
    assert set(waits) == {0.6, 2.2} and waits.mean() == pytest.approx(1.0, abs=0.1)
    assert 100 < np.count_nonzero(np.diff(waits)) < 800


def test_fast_rotors_fall_short_and_slow_ones_keep_their_speed():
    battery = cells.Headroom(2.0, PARAMS, None)
    battery.drain(10.0, 0.01, np.ones(4))
    slow, hover, fast = battery.gain(np.array([0.6, 1.0, 1.2]))
    assert slow == pytest.approx(1.0, abs=1e-3) and 1.0 - fast > 2.0 * (1.0 - hover) > 0.0


def test_a_cell_near_its_end_falls_faster_and_faster():
    battery, shown = cells.Rundown(2.0, PARAMS, None), []
    for _ in range(2000):
        battery.drain(0.0, 0.01, np.ones(4))
        shown.append(battery.ratio)
    assert shown[0] == pytest.approx(1.0, abs=1e-3)
    assert shown[1500] - shown[1999] > 3.0 * (shown[0] - shown[500]) > 0.0


def test_a_load_on_a_bungee_weighs_what_it_weighs_at_rest_and_bounces_after_a_jerk():
    load, forces = loads.Bungee(3.0, PARAMS, np.random.default_rng(1)), []
    load.begin(None)
    for k in range(1000):
        up = np.array([0.0, 0.0, 2.0 if 10 <= k < 20 else 0.0])
        load.after(0.01, np.eye(3), up)
        forces.append(load.wrench(instant())[0][2])
    assert np.abs(forces[:10]).max() < 1e-9 < np.abs(forces[10:30]).max()
    assert abs(forces[-1]) < 1e-3 * np.abs(forces[10:30]).max()


def test_a_loose_battery_takes_no_more_moment_than_its_friction():
    part = loads.Slipping(3.0, PARAMS, np.random.default_rng(2))
    part.begin(None)
    part.alter(fresh(), PARAMS)
    moments = []
    for k in range(200):
        moments.append(part.wrench(instant(rate=(0.05 * k, 0.0, 0.0)))[1][0] / part.loads[0])
        part.after(0.01, np.eye(3), np.zeros(3))
    # 5 rad/s^2 is more than it can.
    assert min(moments) == pytest.approx(-4.0, rel=0.01)


def test_ground_under_one_side_lifts_that_side():
    platform = wakes.Platform(3.0, PARAMS, np.random.default_rng(1))
    now = instant(height=0.12)
    place = now.position + (platform.edge - now.position @ platform.onto) * platform.onto
    gain = platform.gain(Instant(**{**vars(now), 'position': place}))
    side = PLACES @ platform.onto
    assert gain[np.argmax(side)] > 1.03 and gain[np.argmin(side)] < 1.01


def test_the_ring_of_vortices_takes_thrust_in_descent_alone():
    def thrust(velocity):
        part = wakes.Settling(3.0, PARAMS, None)
        part.begin(None)
        now = instant(velocity=velocity, rate=(0.0, 0.0, 0.0), turn=(1.0,) * 4)
        first = part.gain(now)[0]
        for _ in range(200):
            part.after(0.01, np.eye(3), np.zeros(3))
        return part.gain(now)[0] - first

    sinking, forward, climbing = (thrust(v) for v in ((0, 0, -2.0), (6.0, 0, -2.0), (0, 0, 2.0)))
    assert sinking < -0.01 and abs(forward) < 0.2 * abs(sinking) and climbing == 0.0


def test_a_hub_slips_only_above_its_torque():
    part = rotors.SlippingHub(10.0, PARAMS, np.random.default_rng(2))
    losses = [1.0 - part.gain(instant(turn=(x,) * 4))[part.rotor] for x in (0.6, 1.0, 1.3)]
    assert losses[0] < 0.001 < losses[1] < 0.5 * losses[2]


def test_blades_on_hinges_pass_a_change_of_speed_on_later():
    part, passed = rotors.Folding(5.0, PARAMS, None), []
    for turn in (1.0, *[1.1] * 100):
        now = instant(rate=(0.0, 0.0, 0.0), turn=(turn, 1.0, turn, 1.0))
        passed.append(part.wrench(now)[1][2])
        part.after(0.002, np.eye(3), np.zeros(3))
    # In the end all of the momentum, that of 0.6 w + 0.4 w^3 in terms of hover.
    change = 2.0 * part.inertia * HOVER * (0.6 * 0.1 + 0.4 * (1.1 ** 3 - 1.0))
    assert 0.002 * np.sum(passed) == pytest.approx(change, rel=0.05)
    assert passed[-1] < 0.02 * passed[1]


def test_a_dropped_payload_is_gone_from_then_on():
    part = made('mass_offset', 'dropped', 3.0)
    assert part.mass(part.when - 0.01) == part.parameters['mass'] > 0.0 == part.mass(part.when)


def test_a_tilted_block_turns_rates_with_the_attitude_and_moves_with_its_lever():
    part = made('attitude_misalignment', 'block_with_lever', 4.0)
    state = np.array([*np.arange(6.0), 0.0, 0.0, 0.6, 0.8, 0.1, 0.2, 0.3])
    seen = part.measured(0.0, state, 1.0)
    before, after = (Rotation.from_quat(one[6:10]) for one in (state, seen))
    # In the world the rate is what it was.
    np.testing.assert_allclose(after.apply(seen[10:]), before.apply(state[10:]), atol=1e-12)
    assert np.linalg.norm(seen[:3] - state[:3]) == pytest.approx(np.linalg.norm(part.lever))


def test_a_wrong_file_says_by_how_much():
    told, factors = misread(PARAMS, np.random.default_rng(5))
    assert set(factors) == set(SPREADS)
    for name, spread in SPREADS.items():
        assert abs(np.log(factors[name])) <= FARTHEST * spread + 1e-12
    assert told['k_m'] / PARAMS['k_m'] == pytest.approx(factors['torque_coefficient'])
    assert told['Iyy'] / PARAMS['Iyy'] == pytest.approx(factors['inertia_y'])
    assert told['rotor_pos']['r1'] == pytest.approx(factors['arms'] * PARAMS['rotor_pos']['r1'])
    for right in ('mass', 'k_eta'):
        assert told[right] == PARAMS[right]


def test_a_log_has_commands_to_half_a_step_of_its_bits():
    commands = np.random.default_rng(1).uniform(0.0, 1000.0, (50, 4))
    assert Logging().logged(commands, 1000.0) is commands
    off = Logging(bits=8).logged(commands, 1000.0) - commands
    assert 0.4 * 1000 / 255 < np.abs(off).max() <= 0.5 * 1000 / 255 + 1e-9


def test_a_low_pass_has_the_time_constant_of_its_frequency():
    smooth = LowPass(20.0, 0.0001)
    smooth(np.zeros(3))
    for _ in range(round(1.0 / (2.0 * np.pi * 20.0) / 0.0001)):
        last = smooth(np.ones(3))
    assert last == pytest.approx(np.full(3, 1.0 - np.exp(-1.0)), abs=0.005)
    assert LowPass(0.0, 0.01)(np.ones(3)) == pytest.approx(np.ones(3))


def circle(t):
    c, s = np.cos(t), np.sin(t)
    return {'x': np.array([c, s, 1.0]), 'x_dot': np.array([-s, c, 0.0]),
            'x_ddot': np.array([-c, -s, 0.0]), 'yaw': 0.3, 'yaw_dot': 0.0}


@pytest.mark.slow
def test_a_flight_with_take_off_stands_climbs_and_lands():
    path = Grounded(SimpleNamespace(update=circle), 20.0, 0.07)
    assert path.update(0.5)['idle'] and path.update(19.9)['idle']
    assert not path.update(2.0)['idle']
    t = np.arange(0.0, 20.0, 0.001)
    aims = [path.update(one) for one in t]
    places, speeds = (np.array([one[key] for one in aims]) for key in ('x', 'x_dot'))
    assert places[0, 2] == places[-1, 2] == 0.07 and np.all(places[:, 2] >= 0.07 - 1e-9)
    assert np.abs(np.gradient(places, t, axis=0) - speeds)[1:-1].max() < 2e-3


def test_states_are_measured_at_the_body_origin_and_moved_by_the_noise():
    rotation = Rotation.from_rotvec([0.1, 0.5, -0.4])
    state = np.array([1.0, 2.0, 3.0, 0.1, 0.2, 0.3, *rotation.as_quat(), 0.5, -0.6, 0.7])
    centre, tilt = np.array([0.01, 0.02, -0.03]), Rotation.from_rotvec([0.02, -0.01, 0.03])
    seen = declared(state, rotation.as_matrix(), centre, tilt.as_quat(), np.full(3, 0.1))
    assert seen[:3] == pytest.approx(state[:3] - rotation.apply(centre))
    assert seen[3:6] == pytest.approx(
        state[3:6] - rotation.apply(np.cross(state[10:], centre)))
    assert (rotation.inv() * Rotation.from_quat(seen[6:10])).as_rotvec() == pytest.approx(
        tilt.as_rotvec())
    change = np.arange(1.0, 13.0) / 100.0
    off = moved(state, change)
    assert off[:6] - state[:6] == pytest.approx(change[:6])
    assert (rotation.inv() * Rotation.from_quat(off[6:10])).as_rotvec() == pytest.approx(
        change[6:9])


@pytest.mark.parametrize('kind', [kind for kinds in NOISES.values() for kind in kinds])
def test_every_noise_has_its_deviations_over_a_flight(kind):
    noise = noise_of(kind, np.random.default_rng(1))
    drawn = noise.draw(20000, 0.01, np.random.default_rng(2)) / noise.sizes()
    assert np.sqrt(np.mean(drawn ** 2)) == pytest.approx(1.0, abs=0.1)
    assert np.mean(drawn) == pytest.approx(0.0, abs=0.02)


def test_the_noise_of_the_evaluation_differs_in_kind():
    drawn = {kind: Noise(kind=kind).draw(20000, 0.01, np.random.default_rng(2)) / Noise().sizes()
             for kind in WHITE}
    beyond = {kind: np.mean(np.abs(one) > 4.0) for kind, one in drawn.items()}
    assert beyond['laplace'] > 20.0 * max(beyond['normal'], 6e-5)
    parts = {kind: one.reshape(200, 100, 12).std(axis=(1, 2)) for kind, one in drawn.items()}
    assert np.ptp(parts['breathing']) > 5.0 * np.ptp(parts['normal'])
    assert drawn['uneven'][:, 2].std() > 1.5 * drawn['uneven'][:, 0].std()
    assert noise_of('normal', np.random.default_rng(1)) == Noise()


needs_rotorpy = pytest.mark.skipif(find_spec('rotorpy') is None, reason='rotorpy is not installed')


@needs_rotorpy
def test_the_plant_moves_by_rotorpys_law():
    from rotorpy.vehicles.multirotor import Multirotor

    from withheld.plant import Reality
    from withheld.vehicles import vehicle_of
    rng = np.random.default_rng(0)
    params = vehicle_of('px4_quadrotor', rng, False)
    plant = Reality(params, {
        'inflow': {'axial': 0.1, 'translational': 0.05}, 'rotor_drag': {'coefficient': 0.2},
        'body_drag': {'horizontal': 0.1, 'vertical': 0.2}, 'blade_flapping': {'coefficient': 0.01},
        'motor_lag': {'time_constant': 0.05}, 'com_offset': {'x': 0.01, 'y': 0.02, 'z': 0.03}})
    state = rng.normal(size=20)
    state[6:10] /= np.linalg.norm(state[6:10])
    state[16:] = plant.hover * rng.uniform(0.8, 1.2, 4)
    command = plant.hover * rng.uniform(0.8, 1.2, 4)
    ours = plant._s_dot_fn(0.0, state, command)
    plant.compute_body_wrench = lambda *args: Multirotor.compute_body_wrench(plant, *args)
    np.testing.assert_allclose(ours, Multirotor._s_dot_fn(plant, 0.0, state, command), rtol=1e-9)


@needs_rotorpy
@pytest.mark.parametrize('effects', [
    {}, {'motor_lag': {'time_constant': 0.02}}, {'rotor_gyro': {'rotor_inertia': 1e-4}},
    {'rotor_drag': {'coefficient': 0.3}, 'actuation_delay': {'delay': 0.013}}])
def test_a_step_of_the_plant_is_as_good_as_many(effects):
    from withheld.plant import Reality
    from withheld.vehicles import vehicle_of
    params = vehicle_of('px4_quadrotor', np.random.default_rng(0), False)
    commands = 1.0 + 0.05 * np.random.default_rng(1).normal(size=(50, 4))
    ends = []
    for parts in (1, 20):
        plant = Reality(params, effects)
        state = np.concatenate([[0, 0, 2, 0, 0, 0, 0, 0, 0, 1.0], np.zeros(6),
                                np.full(4, plant.hover)])
        for command in plant.hover * commands:
            for _ in range(parts):
                state = plant.hold(state, command, 0.01 / parts)
        ends.append(state)
    # After 0.5 s, far below what is measured: m, m/s, quaternion, rad/s.
    assert np.abs(ends[1] - ends[0])[:13].max() < 2e-5
    assert np.abs(ends[0][:3] - (0, 0, 2)).max() > 0.01


@needs_rotorpy
def test_the_controller_is_rotorpys():
    from rotorpy.controllers.quadrotor_control import SE3Control

    from withheld.controllers import Geometric
    from withheld.paths import Sines
    from withheld.vehicles import vehicle_of
    rng = np.random.default_rng(0)
    control = Geometric(vehicle_of('px4_quadrotor', rng, False))
    aim = Sines(rng, 2.0, 2.5, 0.2, 2.0).update(1.0)
    state = {'x': aim['x'] + 0.1, 'v': aim['x_dot'] - 0.1, 'w': np.array([0.3, -0.2, 0.1]),
             'q': Rotation.from_rotvec([0.1, 0.2, 0.5]).as_quat()}
    np.testing.assert_allclose(control.update(0.0, state, aim)['cmd_motor_speeds'],
                               SE3Control.update(control, 0.0, state, aim)['cmd_motor_speeds'])


@needs_rotorpy
def test_rotors_that_jump_hand_their_momentum_over():
    from withheld.plant import Reality
    from withheld.vehicles import vehicle_of
    params = vehicle_of('px4_quadrotor', np.random.default_rng(0), False)
    plant = Reality(params, {'rotor_gyro': {'rotor_inertia': 1e-4}})
    state = np.zeros(20)
    state[2], state[9], state[16:] = 1.0, 1.0, plant.hover
    step = plant.rotor_dir * 0.01 * plant.hover
    turned = plant.advance(state, state[16:] + step, 1e-6)[12]
    assert turned == pytest.approx(1e-4 * plant.rotor_dir @ step / params['Izz'], rel=1e-3)


@needs_rotorpy
def test_a_floor_holds_what_stands_on_it():
    from withheld.plant import Reality
    from withheld.vehicles import vehicle_of
    params = vehicle_of('px4_quadrotor', np.random.default_rng(0), False)
    plant = Reality(params, {}, floor=0.05)
    state = np.zeros(20)
    state[2], state[9], state[16:] = 0.05, 1.0, 0.4 * plant.hover
    for _ in range(20):
        state = plant.hold(state, np.full(4, 0.4 * plant.hover), 0.01)
    assert state[2] == 0.05 and not np.any(state[3:6])
    assert plant.hold(state, np.full(4, 1.1 * plant.hover), 0.01)[5] > 0.0


@pytest.mark.parametrize('exponent', [1.0, 1.8])
def test_a_battery_that_is_empty_gives_no_thrust(exponent):
    battery = Battery(3.0, exponent)
    battery.drain(29.0, 0.01, np.ones(4))
    assert battery.ratio < 0.0 and battery.gain(np.ones(4)) == 0.0
