# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The forms that the twenty-first draw is the first to fly: what each does."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import fresh, HOVER, instant, LIFT, made, PARAMS, PLACES, REST, still, turning

from withheld.constants import GRAVITY
from withheld.forms import dampers, gains, multiples, vanes


def test_a_controller_changes_to_keener_gains_above_a_speed_and_back_below_another():
    motor, rates = gains.Scheduled(2.0, PARAMS, None), []
    for turn in (0.9, 1.0, 1.05, 1.0, 0.95, 1.0):
        speeds = motor.turn(np.full(4, turn * HOVER), np.full(4, (turn + 1e-3) * HOVER), 1e-6)
        left = (turn + 1e-3) - speeds[0] / HOVER
        rates.append(-np.log(left / 1e-3) * motor.parameters['time'] / 1e-6)
    g, k = motor.GENTLE, motor.KEEN
    assert rates == pytest.approx([g, g, k, k, g, g], rel=1e-3)


def test_a_controller_that_empties_its_integral_is_there_at_once_and_stays():
    motor, step, missing = gains.Resetting(2.0, PARAMS, None), 0.0002, []
    speeds, goal = np.array([0.9, 1.1, 1.0, 0.8]) * HOVER, np.full(4, HOVER)
    for _ in range(2000):
        speeds = motor.turn(speeds, goal, step)
        missing.append((goal - speeds) / HOVER)
    missing = np.array(missing)
    assert step * missing.sum(axis=0)[[0, 1, 3]] / [0.1, -0.1, 0.2] == pytest.approx(
        np.full(3, motor.parameters['time']), rel=0.01)
    assert missing.min(axis=0)[[0, 3]] == pytest.approx([0.0, 0.0])
    there = int(np.argmax(missing[:, 0] == 0.0))
    # In a linear one the last part takes longer than the first.
    assert missing[there // 2, 0] > 0.03 and not np.any(missing[there:, 0])


def test_a_controller_is_the_same_in_one_step_or_in_many():
    ends = []
    for parts in (1, 50):
        motor, speeds = gains.Resetting(2.0, PARAMS, None), np.full(4, 0.9 * HOVER)
        for _ in range(parts):
            speeds = motor.turn(speeds, np.full(4, HOVER), 0.02 / parts)
        ends.append(speeds[0] / HOVER)
    assert ends[0] == pytest.approx(ends[1], abs=1e-9) and 0.9 < ends[0] < 1.0


@pytest.mark.slow
@pytest.mark.parametrize('form', ['iterating', 'orbiting'])
def test_a_line_has_its_mean_delay(form):
    line, waits = made('actuation_delay', form, 2.0), []
    for seed in range(40):
        line.begin(np.random.default_rng(seed))
        waits += [line.waits(t) for t in np.arange(0.0, 100.0, 0.0131)]
    assert np.mean(waits) == pytest.approx(line.delay, rel=0.04)
    assert np.min(waits) > 0.15 * line.delay


def test_a_solver_takes_whole_rounds_up_to_its_limit():
    line = made('actuation_delay', 'iterating', 2.0)
    assert set(line.rounds) == set(range(1, line.MOST + 1))
    waits = np.array([line.waits(line.EVERY * (k + 0.5)) for k in range(2000)])
    rounds = (waits / line.delay - line.OWN) / (1.0 - line.OWN) * np.mean(line.rounds)
    assert rounds == pytest.approx(np.ceil(rounds.round(6) - 0.5))
    stays = np.diff(np.flatnonzero(np.diff(line.rounds)))
    assert line.EVERY * np.mean(stays) > 0.02


def test_a_satellite_comes_nearer_or_leaves_until_another_one_takes_its_place():
    line = made('actuation_delay', 'orbiting', 2.0)
    t = np.arange(0.0, 60.0, 0.01)
    waits = np.array([line.waits(one) for one in t]) / line.delay
    jumps = t[1:][np.abs(np.diff(waits)) > 0.1]
    firsts = jumps[np.diff(jumps, prepend=-1.0) > 1.0]
    assert np.diff(firsts) == pytest.approx(np.full(len(firsts) - 1, line.EVERY), abs=0.011)
    late = (t + line.phase) % line.EVERY > 2.0
    bends = np.diff(waits, 2)[late[2:] & late[:-2]]
    assert np.abs(bends).max() < 2e-6


def test_blades_that_are_shaken_lean_back_most_near_a_speed_of_theirs():
    part, drags = multiples.Excited(2.0, PARAMS, None), []
    for turn in (part.AT, part.AT + part.WIDE, part.AT - part.WIDE, 0.2):
        force, moment = part.wrench(still(
            air=np.array([1.5, 0.0, 1.0]), speeds=np.full(4, turn * HOVER)))
        drags.append(-force[0] / (1.5 * turn * part.coefficient))
        assert force[1:] == pytest.approx([0.0, 0.0]) and moment == pytest.approx(REST)
    half = part.OWN + 0.5 * part.PEAK
    assert drags[:3] == pytest.approx([part.OWN + part.PEAK, half, half])
    assert drags[3] == pytest.approx(part.OWN, abs=0.01)


def test_a_propeller_starts_in_fast_flow_and_drags_along_its_shaft():
    part, more = made('body_drag', 'windmilling', 2.0), []
    for speed in (1.1, 2.0, 1.0, 0.4, 1.1, -2.0):
        now = turning(part, 1.0, 6.0, air=np.array([speed, 0.0, 0.0]))
        drag = -part.wrench(now)[0][0] / part.coefficient
        more.append((drag - part.OWN * speed * abs(speed)) / (speed * abs(speed)))
    turns = part.TURNS
    assert more == pytest.approx([0.0, turns, turns, 0.0, 0.0, turns], abs=2e-3)
    force, _ = part.wrench(still(air=np.array([0.0, 1.5, 0.0])))
    assert force == pytest.approx([0.0, -part.coefficient * part.OWN * 2.25, 0.0])
    # It follows by a way: within that, all but one part in e.
    part.begin(None)
    turning(part, 1.0, part.WAY / 2.0, step=0.001, air=np.array([2.0, 0.0, 0.0]))
    assert part._spin == pytest.approx(2.0 * (1.0 - np.exp(-1.0)), rel=0.01)


def test_a_propeller_that_still_turns_the_other_way_does_not_push():
    part = made('body_drag', 'windmilling', 2.0)
    turning(part, 1.0, 6.0, air=np.array([2.0, 0.0, 0.0]))
    force, _ = part.wrench(still(air=np.array([-1.0, 0.0, 0.0])))
    assert force == pytest.approx([part.coefficient * part.OWN, 0.0, 0.0])


def test_an_aerial_pushes_along_its_normal_which_points_at_its_station():
    part = made('body_drag', 'pointing', 2.0)
    place, turn = np.array([0.3, -0.2, 1.0]), Rotation.from_euler('z', 0.8)
    normal = np.array([*(part.station - place[:2]), 0.0])
    normal /= np.linalg.norm(normal)
    along = np.cross(normal, [0.0, 0.0, 1.0])
    pushes = []
    for flow in (normal, along, -normal):
        force, moment = part.wrench(still(
            position=place, rotation=turn.as_matrix(), air=turn.inv().apply(2.0 * flow)))
        pushes.append(turn.apply(force) / (-4.0 * part.coefficient))
        assert not np.any(moment)
    face = part.OWN + part.FACE
    assert np.array(pushes) == pytest.approx(np.array(
        [face * normal, part.OWN * along, -face * normal]), abs=1e-12)


def test_behind_a_wall_air_goes_back_below_a_layer_that_sinks():
    wind = made('wind', 'lee', 2.0)

    def speed(on, height, time=0.0):
        place = (on - wind.before) * wind.onto + [0.0, 0.0, height]
        return wind.wind(time, place) @ wind.onto / np.linalg.norm(wind.mean)

    assert speed(0.5, 0.2) == pytest.approx(wind.BACK, abs=0.01)
    assert speed(0.5, 3.0) == pytest.approx(wind.ABOVE, abs=0.01)
    assert speed(3.0, 0.2) < 0.3 < speed(wind.REACH, 0.4)
    heights = np.arange(0.0, 3.0, 0.1)
    for on in (1.0, 3.0, 5.0):
        assert np.all(np.diff([speed(on, z) for z in heights]) > 0.0)
    flaps = [speed(4.0, 0.9, t) for t in np.arange(0.0, wind.PERIOD, 0.1)]
    assert 0.05 < np.ptp(flaps) < 0.5
    assert wind.wind(0.0, np.array([0.0, 0.0, 1.0]))[2] == 0.0


def test_air_over_swell_is_neither_squeezed_nor_turned_and_fades_with_the_height():
    wind, step = made('wind', 'swell', 2.0), 1e-4
    for place in np.random.default_rng(1).uniform(0.2, 1.5, (10, 3)):
        slopes = np.array([(wind.wind(3.0, place + step * axis) - wind.wind(
            3.0, place - step * axis)) / (2.0 * step) for axis in np.eye(3)])
        assert np.trace(slopes) == pytest.approx(0.0, abs=1e-6)
        assert slopes == pytest.approx(slopes.T, abs=1e-6)
    speed, period = np.sqrt(GRAVITY / wind.number), wind.LENGTH / np.sqrt(GRAVITY / wind.number)
    here = np.array([0.3, 0.2, 0.5])
    assert wind.wind(1.0, here) == pytest.approx(wind.wind(1.4, here + 0.4 * speed * wind.onto))
    for height in (0.0, 1.0):
        times = np.arange(0.0, period, period / 40)
        air = np.array([wind.wind(t, np.array([0.0, 0.0, height])) for t in times])
        assert np.mean(air, axis=0) == pytest.approx(wind.mean, abs=1e-9)
        size = wind.SHARE * np.linalg.norm(wind.mean) * np.exp(-wind.number * height)
        assert np.linalg.norm(air - wind.mean, axis=1) == pytest.approx(np.full(40, size))


def test_vanes_add_less_in_a_climb_and_in_a_descent_than_in_hover():
    rotor = vanes.Vaned(2.0, PARAMS, None)

    def lost(z):
        gain = rotor.gain(still(air=np.array([0.0, 0.0, z * rotor.induced])))[0]
        return (1.0 - gain) / 2.0 - rotor.TAKES * z

    assert lost(0.0) == pytest.approx(0.0)
    assert [lost(rotor.WIDE), lost(-rotor.WIDE)] == pytest.approx([0.5 * rotor.ADDS] * 2)
    assert lost(1.0) == pytest.approx(rotor.ADDS, rel=0.02)


def test_flow_from_a_side_climbs_through_rotors_that_lean_along_their_turn():
    rotor = vanes.Canted(2.0, PARAMS, None)
    still_air = rotor.gain(still(air=REST))
    assert still_air == pytest.approx(np.ones(4))
    climb = rotor.gain(still(air=np.array([0.0, 0.0, 0.3 * rotor.induced])))
    assert climb == pytest.approx(np.full(4, 1.0 - 2.0 * rotor.TAKES * 0.3))
    for angle in (0.0, 1.0, 2.5):
        flow = 0.3 * np.array([np.cos(angle), np.sin(angle), 0.0])
        change = rotor.gain(still(air=flow * rotor.induced)) - 1.0 - 2.0 * rotor.LEVEL * 0.09
        out = PLACES / np.linalg.norm(PLACES, axis=1, keepdims=True)
        onto = rotor.spins * (out[:, 0] * flow[1] - out[:, 1] * flow[0])
        assert change == pytest.approx(-2.0 * rotor.TAKES * rotor.LEAN * onto)
        assert np.sum(change) == pytest.approx(0.0, abs=1e-12)


def test_the_ground_is_nearer_above_a_pad_that_drives_by():
    part, gains_there = made('ground_effect', 'driven', 1.0), []
    for t in np.arange(0.0, part.PERIOD, 0.05):
        car = part.WAY * np.sin(2.0 * np.pi * t / part.PERIOD + part.phase)
        place = car * part.onto[0]
        high = still(time=t, position=place, heights=np.full(4, 0.4))
        gains_there.append(part.gain(high))
    assert np.array(gains_there) == pytest.approx(
        np.full((len(gains_there), 4), 1.0 + 0.12 * np.exp(-0.6 * 2.0)), rel=2e-3)
    away = still(time=0.0, position=5.0 * part.onto[1], heights=np.full(4, 0.4))
    assert part.gain(away) == pytest.approx(np.full(4, 1.0 + 0.12 * np.exp(-0.6 * 4.0)))
    here = [np.mean(part.gain(still(time=t, position=REST, heights=np.full(4, 0.4))))
            for t in np.arange(0.0, part.PERIOD, 0.05)]
    assert np.ptp(here) > 0.6 * 0.12 * (np.exp(-1.2) - np.exp(-2.4))


def test_a_sheet_gives_to_strong_rotors_that_are_near_and_swings_after_them():
    part, deep = made('ground_effect', 'membrane', 1.0), []
    for turn in (1.0, 1.2):
        now = turning(part, turn, 12.0, heights=np.full(4, 0.2))
        deep.append(part._deep)
        goal = part.GIVES * turn ** 2 * np.exp(-part.FADES * (2.0 + part._deep))
        assert part._deep == pytest.approx(goal, rel=1e-3)
        assert part.gain(now) == pytest.approx(
            np.full(4, 1.0 + 0.12 * np.exp(-0.7 * (2.0 + part._deep))))
    assert deep[1] > deep[0] > 0.3
    after = []
    for _ in range(300):
        turning(part, 1.0, 0.01, heights=np.full(4, 3.0))
        after.append(part._deep)
    assert np.min(after) < -0.5 * deep[1]
    turning(part, 1.0, 12.0, heights=np.full(4, 3.0))
    assert part._deep == pytest.approx(0.0, abs=1e-3)


def test_each_module_sags_by_what_its_own_rotor_draws():
    battery = made('battery_sag', 'modular', 2.0)
    turns = np.array([0.9, 1.0, 1.1, 1.0])
    for k in range(1000):
        battery.drain(0.01 * k, 0.01, turns)
    sags = 1.0 - battery.gain(turns) ** (1.0 / battery.exponent)
    loads = turns ** 3
    assert sags == pytest.approx(2.0 * loads * (
        battery.RESISTS + battery.FALLS / 3.0 / battery.charges))
    assert battery.ratio == pytest.approx(1.0 - np.mean(sags))
    assert np.abs(battery.charges - 1.0).max() <= battery.SPREAD


def test_the_pack_that_rests_recovers_while_the_other_one_serves():
    battery, sags = made('battery_sag', 'alternated', 2.0), []
    battery.FALLS = 0.0
    for k in range(8000):
        battery.drain(0.01 * k, 0.01, np.ones(4))
        sags.append((1.0 - battery.ratio) / 2.0 - battery.RESISTS)
    last = np.array(sags[-round(2.0 * battery.EVERY / 0.01):])
    # As often as not a pack sags to 1 / (1 + exp(-T / time)) of all, and recovers from there.
    most = battery.SAGS / (1.0 + np.exp(-battery.EVERY / battery.TIME))
    assert last.max() == pytest.approx(most, rel=1e-2)
    assert last.min() == pytest.approx(battery.SAGS - most, rel=2e-2)
    assert last[:400] == pytest.approx(last[400:])


def test_frost_goes_in_flight_and_sooner_from_fast_rotors():
    part = made('thrust_scale', 'frosted', 2.0)
    frost = part._frost.copy()
    assert np.ptp(frost) > 0.0 and np.abs(frost - 1.0).max() <= part.SPREAD

    def losses():
        return (part.gain(still()) - 1.0) / part.share

    assert losses() == pytest.approx(part.LEFT + part.MORE * frost) and part.share < 0.0
    speeds = np.array([0.8, 1.0, 1.2, 1.0]) * HOVER
    turning(part, 1.0, part.LASTS, speeds=speeds)
    assert losses() == pytest.approx(part.LEFT + part.MORE * frost * np.exp(
        -(speeds / HOVER) ** part.POWER), rel=1e-6)


def test_water_carries_what_of_a_sonde_is_below_it():
    part, true = made('mass_offset', 'immersed', 2.0), fresh()
    part.alter(true, PARAMS)
    mass = part.parameters['mass']
    assert true['mass'] == pytest.approx(PARAMS['mass'] + part.OWN * mass)
    carried = [part.wrench(still(position=np.array([0.0, 0.0, z])))[0][2] / (mass * GRAVITY)
               for z in (0.3, part.HALF, 1.5)]
    assert carried == pytest.approx([part.FLOATS, 0.5 * part.FLOATS, 0.0])
    leans = Rotation.from_euler('x', 0.3).as_matrix()
    deep = still(position=REST, velocity=np.array([0.0, 0.0, 0.5]), rotation=leans)
    part.after(0.01, leans, np.array([0.0, 0.0, 2.0]))
    force, moment = part.wrench(deep)
    up = mass * (part.FLOATS * GRAVITY - 2.0 * part.ALONG - 0.25 * part.PARTS)
    assert leans @ force == pytest.approx([0.0, 0.0, up]) and not np.any(moment)


def swung(part, accelerations, step=0.01):
    """Return what the ropes pull by, over the mass, m/s^2, as the body accelerates upwards."""
    out = []
    for one in accelerations:
        part.after(step, np.eye(3), np.array([0.0, 0.0, one]))
        out.append(part.wrench(still())[0][2] / part.parameters['mass'])
    return np.array(out)


def test_ropes_of_wire_are_stiff_for_small_moves_and_soft_for_large_ones():
    part = made('mass_offset', 'isolated', 2.0)
    t, moves = np.arange(0.0, 20.0, 0.01), {}
    for size in (0.05, 0.5, 3.0):
        part.begin(None)
        moves[size] = np.ptp(swung(part, size * np.sin(2.0 * np.pi * 0.8 * t))[1000:]) / size
    # A mass on a spring, without friction: 1 / ((f / 0.8)^2 - 1), either way.
    stiff = 2.0 / ((part.FREQUENCY / (1.6 * np.pi)) ** 2 - 1.0)
    assert moves[0.05] == pytest.approx(stiff, rel=0.15)
    assert moves[0.05] < moves[0.5] < moves[3.0]
    # After that it hangs where it is, as the ropes hold it.
    assert swung(part, np.zeros(4000))[-1] == pytest.approx(0.0, abs=0.02)


def test_the_law_of_ropes_bounds_what_sticks():
    part = made('mass_offset', 'isolated', 2.0)
    for side in (1.0, -1.0):
        swung(part, np.full(3000, side * 4.0))
        assert abs(part._stuck) <= 1.001 * part.play
        # A steady pull is held by the whole of it.
        assert part._held() == pytest.approx(side * 4.0, rel=1e-2)


def test_panels_take_air_along_and_part_it():
    part = made('inertia_mismatch', 'panelled', 2.0)
    part.alter(fresh(), PARAMS)
    now = still(rate=np.array([1.5, 0.0, -0.5]))
    for _ in range(100):
        part.wrench(now)
        part.after(0.01, np.eye(3), REST)
    parts = part.loads * part.PARTS
    assert part.wrench(now)[1] == pytest.approx(parts * [-2.25, 0.0, 0.25])
    part.begin(None)
    for k in range(100):
        moment = part.wrench(still(rate=np.array([0.05 * k, 0.0, 0.0])))[1]
        part.after(0.01, np.eye(3), REST)
    lag = 0.01 / (1.0 - np.exp(-0.01 / part.TIME))
    along = -5.0 * lag / part.TIME * part.loads[0]
    assert moment[0] == pytest.approx(along - parts[0] * 4.95 ** 2)


def test_a_magazine_turns_by_a_slot_now_and_then():
    part = made('com_offset', 'revolving', 2.0)
    t = np.arange(0.0, 60.0, 0.01)
    slots = np.array([part.slots(one) for one in t])
    assert slots[0] == 0.0 and np.all(np.diff(slots) >= 0.0)
    moves = np.abs(slots - np.round(slots)) > 1e-6
    assert 0.05 < np.mean(moves) < 0.3
    assert np.diff(slots).max() == pytest.approx(1.875 * 0.01 / part.TURNS, rel=0.02)
    away = part.SWINGS * np.linalg.norm(part.centre[:2])
    shifts = np.array([part.wrench(still(time=one))[1] for one in t]) / LIFT
    assert np.linalg.norm(shifts, axis=1) == pytest.approx(np.full(len(t), away))
    assert not np.any(shifts[:, 2])
    angles = np.unwrap(np.arctan2(-shifts[:, 0], shifts[:, 1]))
    assert angles - angles[0] == pytest.approx(2.0 * np.pi / part.SLOTS * slots)


def test_a_motor_hangs_at_a_resonance_on_its_way_up_and_not_on_its_way_down():
    part, losses = made('rotor_fault', 'hanging', 2.0), []
    for turn in (0.9, 1.08, 1.2, 1.08, 0.9, 1.08):
        now = turning(part, turn, 1.0)
        losses.append((1.0 - part.gain(now)[part.rotor]) / part.loss)
    hangs = part.FIRST + part.MORE * (1.0 - (part.HANGS / 1.08) ** 2)
    assert losses == pytest.approx([part.FIRST, hangs, part.FIRST, part.FIRST, part.FIRST, hangs])
    assert part.torque(instant()) == pytest.approx(part.gain(instant()))
    assert np.count_nonzero(part.gain(instant()) != 1.0) == 1


def test_a_controller_hunts_at_little_load_and_calms_down_at_more():
    part, losses = made('rotor_fault', 'hunting', 2.0), []
    for turn in (0.95, 1.15, 0.95):
        turning(part, turn, 5.0)
        shown = [(1.0 - part.gain(still(time=t))[part.rotor]) / part.loss
                 for t in np.arange(0.0, 5.0 / part.RATE, 0.01)]
        losses.append((np.mean(shown), np.max(shown), np.min(shown)))
    wild, calm = (1.0, 1.0 + part.SWINGS, 1.0 - part.SWINGS), (1.0, 1.0, 1.0)
    assert np.array(losses) == pytest.approx(np.array([wild, calm, wild]), abs=0.01)
    assert part.torque(instant()) == pytest.approx(part.gain(instant()))


def test_a_loose_ring_is_left_behind_by_fast_changes_until_it_is_as_fast():
    part, true = dampers.Damped(2.0, PARAMS, None), fresh()
    part.begin(None)
    part.alter(true, PARAMS)
    assert true['rotor_inertia'] == pytest.approx(part.OWN * part.inertia)
    ring, most = (1.0 - part.OWN) * part.inertia, part.HOLDS * HOVER
    turning(part, 1.0, 1.0)
    speeds = np.array([1.1, 1.0, 1.0, 1.0]) * HOVER
    moment = part.wrench(still(speeds=speeds))[1]
    assert moment == pytest.approx([0.0, 0.0, ring * part.spins[0] * most])
    # What it takes up until then is its own momentum.
    took = 0.0
    for _ in range(1000):
        took += 0.0025 * part.wrench(still(speeds=speeds))[1][2]
        part.after(0.0025, np.eye(3), REST)
    assert took == pytest.approx(ring * part.spins[0] * 0.1 * HOVER, rel=1e-3)
    turns = part.wrench(still(speeds=speeds, rate=np.array([0.0, 2.0, 0.0])))[1]
    assert turns[0] == pytest.approx(ring * 2.0 * (part.spins @ speeds), rel=1e-3)


def test_a_disk_whose_hinges_stick_leans_on_once_the_flow_has_changed_enough():
    part, leans = made('blade_flapping', 'sticking', 2.0), []
    for speed in (0.4, 1.5, 1.2, 0.4, 0.0):
        now = turning(part, 1.0, 0.1, air=np.array([speed, 0.0, 0.0]))
        force, moment = part.wrench(now)
        leans.append(moment[1] / (part.LEANS * part.moment))
        assert not np.any(force) and moment[[0, 2]] == pytest.approx([0.0, 0.0])
    sticks = part.STICKS
    assert leans == pytest.approx([0.0, 1.5 - sticks, 1.5 - sticks, 0.4 + sticks, sticks])
    now = turning(part, 1.1, 0.1, air=np.array([0.0, 3.0, 0.0]))
    x, y, _ = part.wrench(now)[1] / (1.1 * part.LEANS * part.moment)
    assert np.hypot(y, -x - 3.0) == pytest.approx(sticks) and y > 0.0 > x


def test_a_tracker_is_tilted_by_which_side_a_lighthouse_lights():
    part = made('attitude_misalignment', 'lighthouse', 2.0)
    away, angle = part.place / np.linalg.norm(part.place), np.arctan2(part.most[1], part.most[0])
    stands = np.arctan2(part.place[1], part.place[0])
    state, shares = np.array([*np.zeros(9), 1.0, 0.1, 0.2, 0.3]), []
    for turn in (0.0, np.pi, 0.5 * np.pi):
        heads = Rotation.from_euler('z', stands - angle + turn)
        state[6:10] = heads.as_quat()
        out = part.measured(0.0, state, 1.0)
        assert out[:6] == pytest.approx(state[:6]) and out[10:] == pytest.approx(state[10:])
        said = (heads.inv() * Rotation.from_quat(out[6:10])).as_euler('ZYX')[::-1]
        shares.append(said @ part.angles / (part.angles @ part.angles))
        assert said == pytest.approx(shares[-1] * part.angles)
    level = part.SWINGS * float(np.hypot(*away[:2]))
    assert shares == pytest.approx([1.0 + level, 1.0 - level, 1.0])


def test_two_gyroscopes_beat_more_and_more_slowly():
    part = made('gyro_bias', 'beating', 2.0)
    t = np.arange(0.0, 60.0, 0.01)
    shares = np.array([part.share(one, 1.0) for one in t])
    assert shares.max() == pytest.approx(1.0 + part.SWING, rel=1e-3)
    assert shares.min() == pytest.approx(1.0 - part.SWING, rel=2e-3)
    crossed = t[1:][np.diff(shares[:, 0] > 1.0)]
    apart = np.diff(crossed)
    assert np.all(np.diff(apart) > -0.02)
    assert apart[0] < 2.0 < apart[-1] < 0.5 / part.LAST
    out = part.measured(1.0, np.zeros(13), 1.0)
    assert out[10:] == pytest.approx(part.share(1.0, 1.0) * part.bias) and not np.any(out[:10])
