# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of lags, delays, drag and wind that the twenty-fifth draw flies: what each does."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import HOVER, PARAMS, part_of, PLACES, REST, stepped, still

from withheld.forms.mixtures import Unlike
from withheld.forms.nets import Netted
from withheld.forms.pulses import PulseTrain
from withheld.forms.servos import Servoed
from withheld.forms.slings import Slung
from withheld.forms.smoothings import MovingCorner
from withheld.forms.tasks import Preempted
from withheld.forms.tunnels import PastBend
from withheld.forms.vents import Extracted

UP = np.array([0.0, 0.0, 1.0])


@pytest.mark.parametrize('kind', [Servoed, MovingCorner])
def test_a_command_that_is_held_is_reached_and_is_the_same_in_one_step_or_in_many(kind):
    command = np.array([1.1, 0.9, 1.0, 1.2])
    assert stepped(kind(2.0, PARAMS, None), command)[-1] == pytest.approx(command, abs=1e-6)
    assert stepped(kind(2.0, PARAMS, None), 1.0) == pytest.approx(np.ones((2000, 4)))
    one = stepped(kind(2.0, PARAMS, None), command, 0.004, 0.04)[-1]
    many = stepped(kind(2.0, PARAMS, None), command, 0.0001, 0.04)[-1]
    assert one == pytest.approx(many, abs=5e-3)


def test_a_servo_swings_past_a_small_change_of_the_thrust_by_what_its_damping_says():
    motor, step = Servoed(2.0, PARAMS, None), 0.0005
    thrust = stepped(motor, np.sqrt(1.01), step)[:, 0] ** 2
    d = motor.DAMPING
    over = np.exp(-np.pi * d / np.sqrt(1.0 - d ** 2))
    assert (thrust.max() - 1.01) / 0.01 == pytest.approx(over, rel=0.01)
    missing = (1.01 - thrust) / 0.01
    assert step * (0.5 + missing.sum()) == pytest.approx(motor.parameters['time'], rel=1e-3)


def test_a_servo_has_a_top_rate_and_blades_give_no_less_than_no_thrust():
    motor, step = Servoed(2.0, PARAMS, None), 0.0005
    thrust = stepped(motor, np.sqrt([2.0, 0.2, 1.0, 1.0]), step)[:, :2] ** 2
    slopes = np.diff(thrust, axis=0) / step
    most = motor.FASTEST / motor.parameters['time']
    assert np.abs(slopes).max() == pytest.approx(most)
    # It goes at that rate for most of the way, up as down.
    assert np.median(slopes[:round(0.5 / most / step)], axis=0) == pytest.approx([most, -most])
    assert stepped(Servoed(2.0, PARAMS, None), 0.0)[-1] == pytest.approx(np.zeros(4),
                                                                         abs=1e-3)


def test_behind_a_moving_corner_the_thrust_is_fast_and_the_turns_are_slow():
    motor, step = MovingCorner(2.0, PARAMS, None), 0.0005
    time = motor.parameters['time']
    together = (1.1 - stepped(motor, 1.1, step)[:, 0]) / 0.1
    since = step * np.arange(1, len(together) + 1)
    assert together == pytest.approx(np.exp(-since / (motor.MOTOR * time)), abs=1e-6)
    turns = stepped(MovingCorner(2.0, PARAMS, None), [1.1, 0.9, 0.9, 1.1], step)
    assert turns.mean(axis=1) == pytest.approx(np.ones(2000))
    missing = (1.1 - turns[:, 0]) / 0.1
    assert step * (0.5 + missing.sum()) == pytest.approx(time, rel=2e-3)
    # Two lags, one behind the other.
    one, two = motor.MOTOR * time, (1.0 - motor.MOTOR) * time
    lags = (two * np.exp(-since / two) - one * np.exp(-since / one)) / (two - one)
    assert missing == pytest.approx(lags, abs=2e-3)


@pytest.mark.parametrize(('mean', 'corner'), [(0.9, 0.7), (1.2, 1.6), (0.5, 0.4), (1.6, 2.5)])
def test_the_corner_moves_with_the_throttle_between_its_ends(mean, corner):
    motor, step = MovingCorner(2.0, PARAMS, None), 0.0005
    turns = stepped(motor, mean + np.array([0.1, -0.1, -0.1, 0.1]), step, 2.0, before=mean)
    missing = (mean + 0.1 - turns[:, 0]) / 0.1
    time = motor.MOTOR + (1.0 - motor.MOTOR) / corner
    assert step * (0.5 + missing.sum()) == pytest.approx(time * motor.parameters['time'], rel=5e-3)


@pytest.mark.slow
def test_pulses_have_their_mean_delay_and_come_one_after_another():
    line = part_of(PulseTrain)
    waits = np.array([line.waits(t) for t in np.arange(0.0, 20.0, 0.000773)])
    assert waits.mean() == pytest.approx(line.delay, rel=2e-3)
    pulse = line.SHORTEST + line.LONGER * HOVER / PARAMS['rotor_speed_max']
    assert np.diff(waits, axis=1) == pytest.approx(np.full((len(waits), 3), line.unit * pulse))
    assert np.ptp(waits[:, 0]) == pytest.approx(line.FRAME * line.unit, rel=0.05)
    # The pulses of the fastest rotors fit into a frame.
    assert 4.0 * (line.SHORTEST + line.LONGER) < line.FRAME


def test_the_pulses_of_fast_rotors_take_longer_and_all_that_are_behind_wait_for_them():
    line, full = part_of(PulseTrain), PARAMS['rotor_speed_max']
    line.pass_on(0.0, full * np.array([0.0, 1.0, 2.0, 0.5]), 0.01)
    waits = line.waits(0.0) - (line.taken(0.0) - 0.0)
    assert waits / line.unit == pytest.approx([1.0, 3.0, 5.0, 6.5])


def test_a_frame_has_the_newest_command_alone():
    line, step = part_of(PulseTrain, 3.0), 0.002
    frame = line.FRAME * line.unit
    given = []
    for k in range(500):
        command = np.full(4, 100.0 + 0.1 * k)
        given += [(step * k, *one) for one in line.pass_on(step * k, command, step)]
    changes, before = [], given[0][2]
    for begun, _, values in given:
        changes += [(begun, value) for value in values[values != before]]
        before = values
    values = np.unique([value for _, value in changes])
    # One command for each frame, each that of the last moment before it.
    assert len(values) == pytest.approx(500 * step / frame, abs=1.5)
    assert np.diff(values) / 0.1 * step == pytest.approx(frame, abs=1.01 * step)
    assert len(changes) <= 4 * len(values)


def test_a_task_that_is_interrupted_has_its_mean_delay():
    line = part_of(Preempted)
    waits = np.array([line.waits(t) for t in np.arange(0.0, 30.0, 0.00137)])
    assert waits.mean() == pytest.approx(line.delay, rel=0.03)
    assert waits.min() == pytest.approx(line.unit, rel=0.05) and waits.max() < 4.0 * line.delay
    # What is given later is not done sooner.
    assert np.all(np.diff(waits) > -0.00137 - 1e-9)


def test_a_command_is_done_when_the_others_have_left_it_its_work():
    line = part_of(Preempted)
    starts = np.linspace(0.0, 0.99 * line.times[-1], 999)
    ends = line.done(starts)
    left = np.interp(ends, line.times, line.idle) - np.interp(starts, line.times, line.idle)
    inside = ends < line.times[-1]
    assert inside.mean() > 0.98 and left[inside] == pytest.approx(np.ones(inside.sum()))
    # They leave what their work over their periods is short of one.
    share = 1.0 - np.sum(np.array(line.WORK) / line.PERIODS)
    assert line.idle[-1] / line.times[-1] == pytest.approx(share, rel=0.03)
    slopes = np.diff(line.idle) / np.diff(line.times)
    # By turns all of the time is left and none.
    assert slopes[0::2] == pytest.approx(1.0) and slopes[1::2] == pytest.approx(0.0)
    again = line.times[-1] * line.unit
    assert line.waits(again + 0.7) == pytest.approx(line.waits(0.7), abs=1e-9)


def test_rotors_of_two_kinds_drag_as_of_one_and_turn_the_vehicle_in_flight_to_the_side():
    part = part_of(Unlike)
    force, moment = part.wrench(still(air=np.array([3.0, 0.0, 1.0])))
    assert force == pytest.approx([-3.0 * part.coefficient, 0.0, 0.0])
    assert moment == pytest.approx(REST, abs=1e-12)
    force, moment = part.wrench(still(air=np.array([0.0, 3.0, 0.0])))
    assert force == pytest.approx([0.0, -3.0 * part.coefficient, 0.0])
    more = np.sign(part.shares[0] - 1.0)        # the first rotor is in front
    assert moment == pytest.approx(
        [0.0, 0.0, -more * part.APART * 0.12 * 3.0 * part.coefficient])
    assert {float(np.sign(part_of(Unlike, seed=k).shares[0] - 1.0)) for k in range(9)} == {-1, 1}


def test_an_end_with_more_blades_drags_by_its_own_speed():
    part = part_of(Unlike)
    front = PLACES[:, 0] > 0.0
    force, _ = part.wrench(still(air=np.array([2.0, 0.0, 0.0]),
                                 speeds=HOVER * np.where(front, 1.2, 0.8)))
    more = part.shares[0]
    assert force[0] == pytest.approx(-part.coefficient * (1.2 * more + 0.8 * (2.0 - more)))


def test_a_net_leans_until_its_weight_and_the_flow_are_even():
    part = part_of(Netted)
    for speed in (0.0, 0.01, 1.0, 3.0, 9.0):
        sine = part.leans(speed)
        assert sine == pytest.approx((speed / part.EVEN) ** 2 * (1.0 - sine ** 2), abs=1e-12)
        assert part.leans(-speed) == pytest.approx(-sine) and 0.0 <= sine < 1.0
    part.OWN = part.ALONG = 0.0
    # The weight, over the coefficient, has no moment about the hinge with the flow.
    weight = part.NET * part.EVEN ** 2
    for speed in (0.5, 3.0, 8.0):
        force = part.wrench(still(air=speed * part.looks))[0] / part.coefficient
        sine = part.leans(speed)
        down = -sine * part.looks - np.sqrt(1.0 - sine ** 2) * UP
        assert np.cross(down, force - weight * UP) == pytest.approx(REST, abs=1e-9)
        assert force @ part.looks < 0.0 < force[2]


def test_a_net_drags_as_a_plate_in_slow_flow_less_in_fast_and_hardly_along_it():
    part = part_of(Netted)
    along = np.cross(UP, part.looks)
    share = part.wrench(still(air=2.0 * along))[0] / (4.0 * part.coefficient)
    assert share == pytest.approx(-(part.OWN + part.ALONG) * along)
    shares = [part.wrench(still(air=v * part.looks))[0] @ part.looks / v ** 2 / part.coefficient
              for v in (0.05, 2.0, 4.0, 8.0)]
    assert shares[0] == pytest.approx(-part.OWN - part.NET, rel=1e-3)
    assert np.all(np.diff(shares) > 0.1) and shares[-1] < -part.OWN
    for air in np.random.default_rng(1).normal(size=(50, 3)):
        force, moment = part.wrench(still(air=3.0 * air))
        assert force @ air < 0.0 and not np.any(moment)


def test_a_net_hangs_down_however_the_body_leans():
    part = part_of(Netted)
    level, leant = np.eye(3), Rotation.from_rotvec(0.3 * np.cross(part.looks, UP)).as_matrix()
    air = 2.0 * part.looks
    one = part.wrench(still(air=air, rotation=level))[0]
    # Body and net about the same axis: only the axis of the body in the world has changed.
    other = part.wrench(still(air=leant.T @ air, rotation=leant))[0]
    assert leant @ other == pytest.approx(one)


def spun(part, air, seconds, step=0.005):
    """Return the forces (N, 3) of a flow that is held."""
    forces = []
    for _ in range(round(seconds / step)):
        forces.append(part.wrench(still(air=air))[0])
        part.after(step, np.eye(3), REST)
    return np.array(forces)


def test_a_box_spins_as_fast_as_it_is_flown_and_shows_its_sides_by_turns():
    part, speed = part_of(Slung), 3.0
    air = np.array([speed, 0.0, 0.0])
    spun(part, air, 12.0)
    rate = speed / part.WAY
    spin = part.SPIN * speed * rate / (rate + 1.0 / part.LASTS)
    assert part._spin == pytest.approx(part.way * spin, rel=1e-3)
    turn = 2.0 * np.pi / spin
    forces = spun(part, air, turn) / (part.coefficient * speed ** 2)
    assert -forces[:, 0].min() == pytest.approx(part.OWN + part.BROAD, rel=1e-2)
    # Of a |cos|^3 + b |sin|^3 the least is a b over the root of a^2 + b^2.
    least = part.BROAD * part.NARROW / np.hypot(part.BROAD, part.NARROW)
    assert -forces[:, 0].max() == pytest.approx(part.OWN + least, rel=1e-2)
    # The mean of |cos|^3 is 4 over 3 pi; aside it is as often this way as that.
    sides = 4.0 / (3.0 * np.pi) * (part.BROAD + part.NARROW)
    assert forces.mean(axis=0) == pytest.approx([-part.OWN - sides, 0.0, 0.0], abs=0.02)
    assert np.ptp(forces[:, 1]) > 0.4
    powers = np.abs(np.fft.rfft(forces[:, 0] - forces[:, 0].mean()))
    assert np.argmax(powers) == 2


def test_a_box_does_not_turn_with_the_body_and_stops_in_still_air():
    part = part_of(Slung)
    air, turned = np.array([2.0, -1.0, 0.5]), Rotation.from_euler('zyx', [1.0, 0.2, -0.1])
    one = part.wrench(still(air=air))[0]
    other, moment = part.wrench(still(air=turned.inv().apply(air), rotation=turned.as_matrix()))
    assert turned.apply(other) == pytest.approx(one) and not np.any(moment)
    spun(part, air, 5.0)
    before = part._spin
    part.wrench(still())
    part.after(part.LASTS, np.eye(3), REST)
    assert part._spin == pytest.approx(np.exp(-1.0) * before)
    climbs = part.wrench(still(air=2.0 * UP))[0]
    assert climbs == pytest.approx(-4.0 * part.coefficient * (part.OWN + part.BELOW) * UP)


def across(wind, x, z):
    """Return the wind outwards, up and along at places in a tunnel, over its radius."""
    place = wind.radius * x * wind.outer + (wind.high + wind.radius * z) * UP
    air = wind.wind(0.0, place + 1.7 * wind.along) / wind.speed
    return np.array([air @ wind.outer, air[2], air @ wind.along])


@pytest.mark.parametrize('seed', range(4))
def test_air_behind_a_bend_is_its_mean_on_the_axis_and_calm_at_the_wall(seed):
    wind = part_of(PastBend, seed=seed)
    assert wind.wind(0.0, wind.high * UP) == pytest.approx(wind.mean) and wind.speed > 0.0
    for angle in np.linspace(0.0, 6.0, 7):
        wall = across(wind, np.cos(angle) * (1.0 - 1e-9), np.sin(angle) * (1.0 - 1e-9))
        assert wall == pytest.approx(REST, abs=1e-6)
    assert not np.any(across(wind, 0.9, 0.9))
    # Outwards in the middle, back above and below, and faster at the outer side.
    assert across(wind, 0.0, 0.0) == pytest.approx([wind.ROLLS, 0.0, 1.0])
    assert across(wind, 0.0, 0.7)[0] < 0.0 and across(wind, 0.0, -0.7)[0] < 0.0
    assert across(wind, 0.5, 0.0)[2] > 1.3 * across(wind, -0.5, 0.0)[2] > 0.0


def test_air_behind_a_bend_moves_as_dean_has_it():
    wind, h = part_of(PastBend), 1e-3
    for x, z in np.random.default_rng(1).uniform(-0.6, 0.6, (10, 2)):
        here, right, left, over, under = (across(wind, x + a, z + b) for a, b in (
            (0.0, 0.0), (h, 0.0), (-h, 0.0), (0.0, h), (0.0, -h)))
        # It is not squeezed.
        spreads = (right[0] - left[0] + over[1] - under[1]) / (2.0 * h)
        assert spreads == pytest.approx(0.0, abs=1e-4)
        # The rolls carry the wind of a straight tunnel, 1 - r^2, and friction smooths it out.
        curved = (right[2] + left[2] + over[2] + under[2] - 4.0 * here[2]) / h ** 2
        carried = -2.0 * (x * here[0] + z * here[1]) / wind.ROLLS
        assert curved + 4.0 == pytest.approx(wind.OUTER * 160.0 / 19.0 * carried, abs=2e-3)


@pytest.mark.parametrize('seed', range(4))
def test_air_goes_straight_to_a_vent_and_with_the_square_of_the_distance(seed):
    wind = part_of(Extracted, seed=seed)
    assert wind.wind(0.0, REST)[:2] == pytest.approx(wind.mean[:2])
    speeds, rng = [], np.random.default_rng(seed)
    for place in rng.uniform(-1.0, 1.0, (9, 3)) + UP:
        air, way = wind.wind(3.0, place), wind.place - place
        assert np.cross(air, way) == pytest.approx(REST, abs=1e-9) and air @ way > 0.0
        # As much goes through every ball around it, but for what the opening takes.
        speeds.append(np.linalg.norm(air) * (wind.SPREADS * way @ way + wind.area))
    assert speeds == pytest.approx(np.full(9, speeds[0]))
    into = np.linalg.norm(wind.wind(0.0, wind.place - [1e-6, 0.0, 0.0]))
    assert into == pytest.approx(speeds[0] / wind.area)
    one, two = (np.linalg.norm(wind.wind(0.0, wind.place + [0.0, far, 0.0])) for far in (3.0, 6.0))
    assert one / two == pytest.approx(4.0, rel=0.03)
