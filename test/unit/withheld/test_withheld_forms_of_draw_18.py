# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The forms that the eighteenth draw is the first to fly: what each does."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import HOVER, instant, made, PARAMS, PLACES, REST, still, turning

from withheld.constants import GRAVITY
from withheld.forms import buses, couplings, decks, foams, loops, phases, polars, towed


def test_an_integral_winds_up_in_a_large_step_alone():
    motor = loops.WoundUp(2.0, PARAMS, None)
    steps, shown, time = np.array([0.02, 0.3]), [], motor.parameters['time']
    speeds = np.full(2, HOVER)
    for _ in range(6000):
        speeds = motor.turn(speeds, HOVER * (1.0 + steps), 0.01 * time)
        shown.append((speeds / HOVER - 1.0) / steps)
    small, large = np.array(shown).T
    assert small[99] == pytest.approx(1.0 - np.exp(-1.0), abs=5e-3) and small.max() < 1.001
    assert large[99] < 0.6 < 1.03 < large.max()
    assert shown[-1] == pytest.approx([1.0, 1.0], abs=5e-3)


def test_one_motor_brakes_by_what_the_others_need_and_all_together_coast():
    motor, step = buses.GivenBack(2.0, PARAMS, None), 0.0005
    goal, alone, all_ = (HOVER * np.array(one) for one in (
        np.ones(4), [1.05, 1.0, 1.0, 1.0], np.full(4, 1.05)))
    for _ in range(20):
        alone, all_ = motor.turn(alone, goal, step), motor.turn(all_, goal, step)
    assert (alone[0] / HOVER - 1.0) / 0.05 == pytest.approx(
        np.exp(-0.01 / motor.parameters['time']))
    # The solution of dx/dt = -B x^2.
    assert all_ / HOVER == pytest.approx(np.full(4, 1.05 / (1.0 + 0.01 * motor.SLOWING * 1.05)))
    rising = motor.turn(np.full(4, 0.9 * HOVER), goal, motor.parameters['time'])
    assert 1.0 - rising / HOVER == pytest.approx(np.full(4, 0.1 * np.exp(-1.0)))


@pytest.mark.slow
@pytest.mark.parametrize(('form', 'exact'), [('relayed', 0.05), ('probing', 0.05)])
def test_a_line_through_a_net_has_its_mean_delay(form, exact):
    line, waits = made('actuation_delay', form, 2.0), []
    for seed in range(40):
        line.begin(np.random.default_rng(seed))
        waits += [line.waits(t) for t in np.arange(0.0, 100.0, 0.03)]
    assert np.mean(waits) == pytest.approx(line.delay, rel=exact) and np.min(waits) > 0.0


def test_a_route_has_one_vehicle_more_or_less_than_the_last():
    line = made('actuation_delay', 'relayed', 2.0)
    assert set(np.abs(np.diff(line.routes))) == {1} and set(line.routes) == {1, 2, 3, 4}
    ways = {line.waits(t) * line.MEAN / line.delay for t in np.arange(0.0, 60.0, 0.1)}
    assert sorted(ways) == pytest.approx([1.0, 2.0, 3.0, 4.0])


def test_a_queue_that_is_probed_falls_at_once_and_stays_about_where_it_fell():
    line = made('actuation_delay', 'probing', 2.0)
    lost = np.flatnonzero(np.diff(line.levels) < 0.0)
    assert len(lost) > 20
    before, after = line.levels[lost], line.levels[lost + 1]
    assert after / before == pytest.approx(np.full(len(lost), line.LEFT), rel=0.1)
    # A cubic is level where it was lost last, if it comes that far.
    comes = [k for k, end in zip(lost[:-1], lost[1:], strict=True)
             if end - k > line.BACK / line.EVERY + 5]
    slopes = np.diff(line.levels)
    levels = [k + 1 + round(line.BACK / line.EVERY) for k in comes]
    assert comes and np.all(slopes[levels] < 0.05 * slopes[np.array(comes) + 1])


def test_thick_blades_have_less_drag_when_they_turn_fast():
    part = polars.Laminar(2.0, PARAMS, None)

    def share(speed, turn):
        now = instant(velocity=(speed, 0.0, 0.5), rate=REST, turn=np.full(4, turn))
        force = part.wrench(now)[0]
        assert force[2] == 0.0
        return -force[0] / (part.coefficient * speed * turn)

    assert share(1.0, 0.8) == pytest.approx(part.FAST + part.MORE, rel=1e-3)
    assert share(1.0, 1.2) == share(2.0, 1.2) == pytest.approx(part.FAST, rel=1e-3)
    assert share(1.0, 1.0) == pytest.approx(part.FAST + 0.5 * part.MORE)


def test_a_drogue_pulls_where_its_line_is_taut_and_not_after_a_turn_back():
    part, ahead = made('body_drag', 'drogue', 2.0), np.array([2.0, 0.0, 0.0])
    pulls = []
    for air, seconds in ((ahead, 0.05), (ahead, 1.0), (-ahead, 0.1), (-ahead, 1.0)):
        pulls.append(-part.wrench(turning(part, 1.0, seconds, air=air))[0] @ air / 8.0)
    free, taut = (part.coefficient * share for share in (part.OWN, part.OWN + part.MORE))
    assert pulls == pytest.approx([free, taut, free, taut])
    assert not np.any(part.wrench(still())[0])


def test_flaps_fold_back_and_have_less_drag_in_fast_flow():
    def drag(velocity):
        part = made('body_drag', 'flaps', 2.0)
        now = turning(part, 1.0, 3.0, air=np.array(velocity))
        return np.linalg.norm(part.wrench(now)[0]) / part.coefficient

    for square in (0.0, 0.3, 1.0, 5.0, 20.0):
        angle = towed.folded(square)
        assert angle == pytest.approx(square * np.cos(angle)) and 0.0 <= angle < 0.5 * np.pi
    part = towed.Flaps
    alone = part.OWN * part.FOLDS ** 2
    folded = part.MORE * np.cos(0.7390851) ** 2 * part.FOLDS ** 2
    assert drag((part.FOLDS, 0.0, 0.0)) == pytest.approx(alone + folded, rel=1e-6)
    assert drag((0.0, 0.0, part.FOLDS)) == pytest.approx(alone)
    assert drag((4.0, 0.0, 0.0)) / 16.0 < 0.4 * drag((0.5, 0.0, 0.0)) / 0.25


def test_wind_goes_around_a_silo_and_not_through_its_wall():
    wind = made('wind', 'silo', 2.0)
    mean = wind.mean[:2]
    along, speed = mean / np.linalg.norm(mean), np.linalg.norm(mean)
    across = np.array([-along[1], along[0]])

    def at(away):
        return wind.wind(0.0, np.array([*(wind.place + away), 1.0]))

    for angle in np.linspace(0.0, 6.0, 7):
        onto = np.array([np.cos(angle), np.sin(angle)])
        assert at(wind.RADIUS * onto)[:2] @ onto == pytest.approx(0.0, abs=1e-12)
    assert at(wind.RADIUS * across)[:2] == pytest.approx(2.0 * mean)
    before = at(-2.0 * wind.RADIUS * along)
    assert before[:2] == pytest.approx(0.75 * mean) and before[2] == 0.0
    assert np.linalg.norm(at(1e4 * across)[:2]) == pytest.approx(speed)


def test_a_lorry_pushes_air_ahead_and_takes_air_along():
    wind = made('wind', 'lorries', 2.0)
    wind.times, wind.ways = np.array([5.0]), np.array([1.0])
    speed = np.linalg.norm(wind.mean)

    def share(time, place):
        return (wind.wind(time, place) - wind.OWN * wind.mean) @ wind.along / speed

    assert share(5.0, REST) == pytest.approx(-wind.PUSH)
    assert share(5.0, wind.place + wind.AWAY * wind.along) == pytest.approx(2.0 * wind.PUSH)
    assert share(20.0, REST) == 0.0 < share(6.5, wind.place)
    # Behind it the air follows more than it goes ahead at the same distance.
    ahead, behind = (share(5.0 + side * 0.6, wind.place) for side in (-1.0, 1.0))
    assert behind > ahead > 0.0


def test_nets_take_pressure_with_the_square_of_the_flow():
    rotor = made('inflow', 'screened', 2.0)

    def more(x, z):
        air = rotor.induced * np.array([x, 0.0, z])
        return (rotor.gain(still(air=air))[0] - 1.0) / (2.0 * rotor.TAKES)

    assert [more(0.0, z) for z in (0.0, 0.5, -0.5, -1.0)] == pytest.approx(
        [0.0, 1.0 - 1.5 ** 2, 1.0 - 0.5 ** 2, 1.0])
    assert 0.0 < more(0.5, 0.0) < more(2.0, 0.0) < 1.0


def test_a_column_of_air_follows_a_climb_and_no_roll():
    rotor = made('inflow', 'columned', 2.0)

    def lost(seconds, **others):
        rotor.begin(None)
        return 1.0 - rotor.gain(turning(rotor, 1.0, seconds, **others))

    climb = np.array([0.0, 0.0, 0.5 * rotor.induced])
    assert lost(0.0, air=climb) == pytest.approx(np.full(4, rotor.TAKES))
    assert lost(6.0, air=climb) == pytest.approx(
        np.full(4, rotor.TAKES * (1.0 - rotor.COMES)), rel=1e-3)
    rolls = {'rate': np.array([2.0, 0.0, 0.0])}
    assert lost(0.0, **rolls) == pytest.approx(lost(6.0, **rolls))
    assert np.sum(lost(6.0, **rolls)) == pytest.approx(0.0, abs=1e-12)
    level = rotor.induced * np.array([3.0, 0.0, 0.0])
    come = lost(0.0, air=level + climb) - lost(6.0, air=level + climb)
    assert come == pytest.approx(np.full(4, rotor.TAKES * rotor.COMES / 19.0), rel=1e-3)


def test_a_deck_that_comes_up_gives_more_and_rolls_below():
    part = made('ground_effect', 'deck', 1.0)
    part.phases, part.across = np.zeros(2), np.array([1.0, 0.0, 0.0])
    heave, roll = 2.0 * np.pi / part.PERIODS
    gains = part.gain(still(time=0.0, heights=np.full(4, 0.2))) - 1.0
    rises = part.HEAVES * heave + part.ROLLS * roll * PLACES[:, 0] / 0.1
    assert gains == pytest.approx(0.16 * np.exp(-1.6) * (1.0 + part.PRESSES * rises))
    high = part.gain(still(time=0.25 * part.PERIODS[0], heights=np.full(4, 0.2))) - 1.0
    low = part.gain(still(time=0.75 * part.PERIODS[0], heights=np.full(4, 0.2))) - 1.0
    assert np.mean(high) / np.mean(low) == pytest.approx(
        np.exp(1.6 * part.HEAVES), rel=0.1)


def test_rotors_feel_the_ground_alone_when_near_and_as_one_when_far():
    part = decks.Merging(1.0, PARAMS, None)

    def more(height, forward=0.0):
        now = still(heights=np.full(4, 0.1 * height),
                    air=part.induced * np.array([forward, 0.0, 0.0]))
        return part.gain(now)[0] - 1.0

    reach = 1.0 + np.hypot(0.12, 0.12) / 0.1
    assert part.reach == pytest.approx(reach)
    assert more(0.5) == pytest.approx(part.OWN * np.exp(-0.125), rel=0.06)
    assert more(3.5) == pytest.approx(part.ALL * np.exp(-0.5 * (3.5 / reach) ** 2), rel=0.02)
    # Level flight takes it away sooner, the higher the vehicle is over its rotors' size.
    assert more(3.5, 0.5) / more(3.5) < 0.8 < more(0.5, 0.5) / more(0.5)
    assert more(12.0) < 1e-4


def test_a_wire_takes_what_a_constant_power_asks_for_and_more_when_it_is_hot():
    battery, shown = made('battery_sag', 'wired', 2.0), []
    for _ in range(4000):
        battery.drain(0.0, 0.01, np.ones(4))
        shown.append(battery.ratio)
    lost = np.array(shown) * (1.0 - np.array(shown))        # voltage times what the wire takes
    cold, hot = (2.0 * battery.RESISTS * (1.0 + heat) for heat in (0.0, battery.HEATS))
    assert lost[0] == pytest.approx(cold, rel=2e-3) and lost[-1] == pytest.approx(hot, rel=2e-3)
    battery.drain(0.0, 0.01, np.full(4, 1.1))
    assert 1.0 - battery.ratio > 1.33 * (1.0 - shown[-1])


def test_the_sun_charges_a_pack_whose_rotors_take_little():
    battery = made('battery_sag', 'sunlit', 2.0)
    assert 0.0 < battery.light.min() < 0.3 * battery.light.max() < 0.3 * battery.SUN
    battery.light[:] = 0.6
    ratios = []
    for turn in (1.0, 0.7):
        for _ in range(2):
            battery.drain(0.0, 1.0, np.full(4, turn))
            ratios.append(battery.ratio)
    assert ratios[1] - ratios[0] == pytest.approx(-2.0 * battery.FALLS * 0.4 / 30.0)
    assert ratios[3] - ratios[2] == pytest.approx(2.0 * battery.FALLS * (0.6 - 0.343) / 30.0)
    assert ratios[2] > 1.0 > ratios[1]


def test_fast_tips_have_more_lift_up_to_a_speed_and_less_beyond():
    part = made('thrust_scale', 'fast_tips', 2.0)
    gains = [(part.gain(still(speeds=np.full(4, turn * HOVER)))[0] - 1.0) / part.share
             for turn in (0.8, 1.0, part.DIVERGES / part.MACH, 1.15)]
    assert gains[0] < gains[1] == pytest.approx(1.0) and gains[1] < gains[2] > gains[3]
    assert gains[0] == pytest.approx(1.0 + part.GROWS * (
        (1.0 - 0.48 ** 2) ** -0.5 - (1.0 - 0.6 ** 2) ** -0.5))
    assert gains[2] - gains[3] == pytest.approx(part.FALLS * (0.69 - part.DIVERGES))


def test_a_bottle_weighs_nothing_in_the_water_and_leaves_it_full():
    part, weights = made('mass_offset', 'sampler', 2.0), []
    for height, seconds in ((1.5, 10.0), (0.3, 5.0), (1.5, 0.01), (1.5, 60.0)):
        now = turning(part, 1.0, seconds, position=np.array([0.0, 0.0, height]))
        weights.append(-part.wrench(now)[0][2] / (part.parameters['mass'] * GRAVITY))
    assert weights == pytest.approx(
        [part.WATER * np.exp(-10.0 / part.DRIPS), 0.0, part.WATER,
         part.WATER * np.exp(-60.0 / part.DRIPS)], rel=2e-3, abs=1e-9)


def test_snow_settles_and_slides_off_a_vehicle_that_leans_by_much():
    part, leans = made('mass_offset', 'snowed', 2.0), []
    for angle, seconds in ((0.1, 10.0), (0.5, 2.0), (0.1, 2.0)):
        for _ in range(round(100 * seconds)):
            part.after(0.01, Rotation.from_euler('x', angle).as_matrix(), REST)
        leans.append(1.0 - part.wrench(still())[0][2] / (part.parameters['mass'] * GRAVITY))
    assert leans[0] == pytest.approx(part.FIRST + 10.0 * part.FALLS)
    assert leans[1] == pytest.approx(part.STICKS, abs=0.1)
    assert leans[2] == pytest.approx(leans[1] + 2.0 * part.FALLS, abs=0.02)


def test_foam_takes_all_along_in_the_end_and_is_stiffer_at_first():
    part = foams.Bedded(2.0, PARAMS, np.random.default_rng(1))
    part.alter(dict(PARAMS), PARAMS)
    part.begin(None)
    moments = []
    for _ in range(4000):
        moments.append(part.wrench(instant(rate=(1.0, 0.0, 0.0)))[1][0])
        part.after(0.0005, np.eye(3), REST)
    moments = np.array(moments) / part.loads[0]
    assert 0.0005 * np.sum(moments) == pytest.approx(-1.0, rel=0.01)
    # At first spring and damper's spring push together: their stiffness times the angle.
    assert moments[8] == pytest.approx(
        -0.004 * part.FREQUENCY ** 2 * (1.0 + part.MORE), rel=0.1)
    assert np.abs(moments[-100:]).max() < 0.02 * np.abs(moments).max()


def test_tanks_are_emptied_in_turn_and_faster_at_more_power():
    part = made('com_offset', 'cross_fed', 2.0)

    def offs(turn, count=3600):
        out = []
        for _ in range(count):
            turning(part, turn, 0.01)
            out.append(part._off)
        return np.array(out)

    hover, strong = offs(1.0), offs(1.26)
    turns = [np.sum(np.diff(np.sign(np.diff(one))) != 0) for one in (hover, strong)]
    assert turns == [8, 16] and np.abs(hover).max() == pytest.approx(1.0, abs=0.01)
    assert hover.mean() == pytest.approx(0.0, abs=0.02)
    moment = part.wrench(still())[1]
    lift = PARAMS['k_eta'] * 4.0 * HOVER ** 2
    assert moment == pytest.approx(lift * part._off * np.array([-part.onto[1], part.onto[0], 0.0]))


def test_magnets_lose_for_good_what_the_hottest_moment_takes():
    part, loss = made('rotor_fault', 'weakened', 2.0), []
    for turn, seconds in ((0.9, 5.0), (1.1, 8.0), (0.9, 8.0), (1.05, 8.0), (1.15, 8.0)):
        now = turning(part, turn, seconds)
        loss.append((1.0 - part.gain(now)[part.rotor]) / 0.01)
    assert loss[0] == pytest.approx(part.FIRST)
    assert loss[1] == loss[2] == loss[3] == pytest.approx(
        part.FIRST + part.STEEP * (1.1 ** 4 - part.COOL), rel=1e-2)
    assert loss[4] > loss[3] and part.torque(now) == pytest.approx(part.gain(now))


@pytest.mark.slow
def test_sand_takes_now_more_and_now_less_and_counts_less_at_high_speed():
    part = made('rotor_fault', 'gritty', 2.0)

    def loss(time, turn=1.0):
        return (1.0 - part.gain(instant(time=time, turn=np.full(4, turn)))[part.rotor]) / 0.01

    shown = []
    for seed in range(20):
        part.begin(np.random.default_rng(seed))
        shown += [loss(t) for t in np.arange(0.0, 100.0, 0.1)]
    assert np.mean(shown) == pytest.approx(1.0, abs=0.1) and 0.4 < np.std(shown) < 1.0
    assert loss(3.0, 1.2) == pytest.approx(loss(3.0) / 1.44)
    assert part.torque(instant()) == pytest.approx(part.gain(instant()))


def test_a_coupling_of_magnets_is_softer_upwards_and_leads_by_its_angle():
    fastest = []
    for goal in (1.15, 0.85):
        part, behind = couplings.Magnetic(2.0, PARAMS, None), []
        part.begin(None)
        turning(part, 1.0, 0.1)
        for _ in range(800):
            turning(part, goal, 0.0025, step=0.0025)
            behind.append((np.mean(part._blades) / HOVER - 1.0) / (goal - 1.0))
        assert behind[-1] == pytest.approx(1.0, abs=1e-3)
        assert part._angle == pytest.approx(
            np.full(4, np.arcsin(goal ** 2 / part.HOLDS)), abs=1e-3)
        fastest.append(int(np.argmax(behind)))
        assert 1.05 < max(behind) < 2.0
    assert fastest[0] > fastest[1]


def test_soft_blades_lean_back_less_and_aside_more_when_they_turn_slowly():
    part = phases.Phased(2.0, PARAMS, None)
    back, side = part.tilts(np.array([0.8, 1.0, 1.2]))
    assert back[1] == pytest.approx(1.0) and np.all(np.diff(back) > 0.0)
    assert side / back == pytest.approx(
        (part.OWN / np.array([0.8, 1.0, 1.2])) ** 2 / part.DAMPS)
    level = instant(velocity=(1.0, 0.0, 0.0), rate=REST, turn=np.ones(4))
    assert part.wrench(level)[1] == pytest.approx([0.0, part.moment, 0.0])
    # Rotors of the other spin that turn more slowly lean more to their own side.
    uneven = replace(level, speeds=HOVER * np.where(part.spins > 0, 1.0, 0.8))
    assert part.wrench(uneven)[1][0] == pytest.approx(
        0.5 * part.moment * (side[1] - side[0]))


def test_a_tilted_floor_tilts_a_vehicle_by_the_way_that_it_heads():
    part = made('attitude_misalignment', 'askew_floor', 2.0)
    part.angles = np.array([0.02, 0.0, 0.0])
    state, seen = np.array([1.0, 2.0, 3.0, 0.0, 0.0, 1.0, *REST, 1.0, 0.1, 0.2, 0.3]), []
    for yaw in (0.0, np.pi):
        heads = Rotation.from_euler('z', yaw)
        state[6:10] = heads.as_quat()
        out = part.measured(0.0, state, 1.0)
        seen.append((heads.inv() * Rotation.from_quat(out[6:10])).as_rotvec())
        assert out[3:6] == pytest.approx([0.0, -np.sin(0.02), np.cos(0.02)])
        assert np.linalg.norm(out[:3]) == pytest.approx(np.sqrt(14.0))
        assert out[10:] == pytest.approx(state[10:])
    assert seen[0] == pytest.approx([0.02, 0.0, 0.0]) and seen[1] == pytest.approx(
        [-0.02, 0.0, 0.0])


@pytest.mark.slow
def test_a_gyroscope_that_learns_its_bias_takes_a_long_turn_for_one():
    part, state = made('gyro_bias', 'learnt', 2.0), np.array([*np.zeros(9), 1.0, *REST])
    times = np.arange(0.0, 400.0, 0.02)
    bias = np.array([part.measured(t, state, 1.0)[10:] for t in times])
    left = np.exp(-2.0 * part.LEARNS * times)
    assert bias == pytest.approx(left[:, None] * part.bias, rel=2e-3)
    state[12] = 0.2
    first, *_, last = (part.measured(t, state, 1.0)[12] for t in 400.0 + times)
    assert first == pytest.approx(0.2, abs=1e-4) and abs(last) < 1e-4
