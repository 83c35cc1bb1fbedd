# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The forms that the twentieth draw is the first to fly: what each does."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import fresh, HOVER, instant, made, PARAMS, PLACES, REST, still, turning

from withheld.constants import GRAVITY
from withheld.forms import adapting, hollows, oils, pitches, twists


def test_a_controller_is_keener_after_large_errors_than_after_a_calm_spell():
    motor = adapting.Adaptive(2.0, PARAMS, None)
    time, hover = motor.parameters['time'], np.full(4, HOVER)

    def rate():
        left = 1.0 - motor.turn(0.999 * hover, hover, 1e-6) / hover
        return -np.log(left[0] / 0.001) * time / 1e-6

    assert rate() == pytest.approx(motor.CALM, rel=1e-2)
    motor.turn((1.0 - motor.HALF) * hover, hover, 50.0 * motor.LEARNS)
    assert rate() == pytest.approx(0.5 * (motor.CALM + motor.KEEN), rel=1e-2)
    motor.turn(hover, hover, 50.0 * motor.LEARNS)
    assert rate() == pytest.approx(motor.CALM, rel=1e-2)


def test_a_median_passes_no_short_peak_and_a_ramp_by_half_its_window_later():
    motor, step = adapting.Median(4.0, PARAMS, None), 0.001
    window = round(motor.WINDOW * motor.parameters['time'] / step)
    peak = np.ones(4 * window)
    peak[window:window + round(0.4 * window)] = 1.3
    seen = [motor._median(np.full(4, one), step)[0] for one in peak]
    assert seen == pytest.approx(np.ones(len(peak)))
    motor = adapting.Median(4.0, PARAMS, None)
    ramp = np.arange(4.0 * window)
    seen = [motor._median(np.array([one, -one]), step) for one in ramp]
    assert sum(held for held, _ in motor._past) == pytest.approx(
        motor.WINDOW * motor.parameters['time'])
    late = np.array(seen)[2 * window:] - np.outer(ramp[2 * window:], [1.0, -1.0])
    assert late == pytest.approx(np.tile([-0.5 * window, 0.5 * window], (len(late), 1)), abs=1.01)


@pytest.mark.slow
@pytest.mark.parametrize('form', ['voted', 'video'])
def test_a_line_has_its_mean_delay(form):
    line, waits = made('actuation_delay', form, 2.0), []
    for seed in range(20):
        line.begin(np.random.default_rng(seed))
        waits += [line.waits(t) for t in np.arange(0.0, 100.0, 0.0131)]
    assert np.mean(waits) == pytest.approx(line.delay, rel=0.04)
    assert np.min(waits) >= line.OWN * line.delay


@pytest.mark.slow
def test_the_second_computer_of_three_decides():
    line = made('actuation_delay', 'voted', 2.0)
    # A moment before a clock's tick, that one has waited least.
    t = np.arange(0.0, 30.0, 0.001)
    waits = np.array([line.waits(one) for one in t]) - line.OWN * line.delay
    each = line.cycles - (t[:, None] + line.phases) % line.cycles
    assert np.sum(each <= waits[:, None] + 1e-12, axis=1) == pytest.approx(np.full(len(t), 2))
    assert waits.max() < line.cycles.max()


def test_a_whole_picture_comes_once_in_a_while_and_holds_the_line_up():
    line = made('actuation_delay', 'video', 2.0)
    levels = line.levels / line.levels.max()
    jumps = np.flatnonzero(np.diff(levels) > 0.5)
    assert np.diff(jumps) == pytest.approx(np.full(len(jumps) - 1, line.PICTURES * line.WHOLE))
    assert 0.05 < np.mean(levels > 0.3) < 0.3


def test_insects_stick_in_flight_and_are_thrown_off_by_fast_rotors():
    part, dirt = made('rotor_drag', 'soiled', 2.0), []
    part.levels[:] = 1.0
    for speed, turn in ((2.0, 1.0), (2.0, 1.2), (1.0, 1.0), (0.0, 1.0)):
        turning(part, turn, 60.0, step=0.1, air=np.array([speed, 0.0, 0.0]))
        dirt.append(part._dirt)
    usual = 2.0 * part.LASTS / part.WAY
    assert dirt == pytest.approx([usual, usual / 1.44, 0.5 * usual, 0.0], rel=1e-3, abs=1e-3)
    part._dirt = 1.0
    force, moment = part.wrench(still(air=np.array([1.5, 0.0, 1.0])))
    assert force == pytest.approx([-1.5 * part.coefficient * (part.OWN + part.MORE), 0.0, 0.0])
    assert moment == pytest.approx(REST)


def test_flow_clings_to_a_round_body_by_a_side_at_a_time_and_parts_later():
    part, states = made('body_drag', 'one_sided', 2.0), []
    for speed in (1.4, 1.6, 1.2, 1.0, 1.6, 2.7, 2.2, 2.0):
        now = turning(part, 1.0, 2.0, air=np.array([speed, 0.0, 0.0]))
        states.append(part._state)
        drag, side, _ = -part.wrench(now)[0] / (part.coefficient * speed ** 2)
        assert drag == pytest.approx(part.LESS[states[-1]])
        assert abs(side) == pytest.approx(part.SIDE * (states[-1] == 1), abs=1e-6)
    assert states == [0, 1, 1, 0, 1, 2, 2, 1]
    assert set(part.sides) == {-1.0, 1.0}


def test_a_blower_adds_drag_below_the_body_while_it_is_on():
    part, drags, moments = made('body_drag', 'inhaling', 2.0), [], []
    ahead = np.array([1.5, 0.0, 0.0])
    for t in np.arange(0.0, 60.0, 0.02):
        force, moment = part.wrench(still(time=t, air=ahead))
        part.after(0.02, np.eye(3), REST)
        drags.append(-force[0] / part.coefficient)
        moments.append(moment[1])
    own = part.OWN * 1.5 ** 2
    assert min(drags) == pytest.approx(own)
    assert max(drags) == pytest.approx(own + part.TAKES * 1.5, rel=1e-2)
    taken = part.coefficient * (np.array(drags) - own)
    assert moments == pytest.approx(part.inlet[2] * -taken)
    assert 0.3 < np.mean(taken > 0.5 * taken.max()) < 0.8


def test_wind_in_a_crop_is_calm_below_and_sweeps_down_over_it():
    wind = made('wind', 'canopy', 2.0)
    heights = np.array([0.2, wind.HIGH - 1e-6, wind.HIGH, 2.0])
    levels = [wind.profile(z / wind.HIGH) for z in heights]
    assert levels[1:3] == pytest.approx([1.0, 1.0], abs=1e-4)
    assert levels[0] < 0.3 < 1.5 < levels[3] < 2.5
    air = np.array([wind.wind(t, np.array([0.0, 0.0, 1.0])) for t in np.arange(0.0, 100.0, 0.01)])
    speeds = air @ wind.mean / (wind.mean @ wind.mean)
    # It is strongest as it comes, and comes at once.
    assert np.diff(speeds).max() > 20.0 * -np.diff(speeds).min()
    assert np.all((speeds > np.mean(speeds)) == (air[:, 2] < np.mean(air[:, 2])))
    assert np.mean(air[:, 2]) == pytest.approx(0.0, abs=0.02 * np.linalg.norm(wind.mean))


def test_cold_air_is_fastest_near_the_ground_and_runs_down():
    wind = made('wind', 'katabatic', 2.0)
    heights = np.arange(0.0, 3.0, 0.01)
    air = np.mean([[wind.wind(t, np.array([0.0, 0.0, z])) for z in heights]
                   for t in np.arange(0.0, wind.PERIOD, wind.PERIOD / 12)], axis=0)
    speeds = air @ wind.mean / (wind.mean @ wind.mean)
    assert heights[np.argmax(speeds)] == pytest.approx(0.25 * np.pi * wind.DEEP, abs=0.01)
    assert speeds.max() == pytest.approx(wind.FASTEST, rel=1e-3)
    assert speeds[-1] < 0.4 * wind.FASTEST and np.all(air[:, 2] <= 0.0)


def test_most_of_what_a_climb_takes_comes_back_as_blades_pitch():
    rotor, taken = pitches.SelfPitching(2.0, PARAMS, None), []
    rotor.begin(None)
    now = still(air=np.array([0.0, 0.0, 0.2 * rotor.induced]))
    for seconds in (0.0, rotor.TIME, 20.0 * rotor.TIME):
        turning(rotor, 1.0, seconds, air=now.air)
        taken.append((1.0 - rotor.gain(now)[0]) / (2.0 * rotor.TAKES * 0.2))
    back = rotor.BACK * (1.0 - np.exp(-1.0))
    assert taken == pytest.approx([1.0, 1.0 - back, 1.0 - rotor.BACK], abs=1e-2)


def test_blades_meet_their_vortices_in_a_shallow_descent_alone():
    rotor = pitches.Slapping(2.0, PARAMS, None)

    def lost(x, z):
        now = still(air=rotor.induced * np.array([x, 0.0, z]))
        return (1.0 - rotor.gain(now)[0]) / 2.0 - rotor.TAKES * z

    shallow = lost(0.6, -0.6 * rotor.SLOPE)
    assert shallow == pytest.approx(rotor.LOSES * 0.36 / (0.36 + rotor.SPEED ** 2))
    assert lost(0.0, -0.2) == pytest.approx(0.0, abs=1e-9)
    for x, z in ((0.6, 0.0), (0.6, -0.4), (0.6, 0.1)):
        assert lost(x, z) < 0.05 * shallow


@pytest.mark.slow
def test_low_flight_leaves_hollows_in_the_snow_where_it_was():
    part = hollows.Scoured(1.0, PARAMS, None)
    part.begin(None)
    here, aside = np.array([0.4, -0.2, 0.2]), np.array([1.5, 1.0, 0.2])

    def more(place):
        return float(np.mean(part.gain(still(position=place, heights=np.full(4, 0.2))))) - 1.0

    fresh_snow = more(here)
    assert fresh_snow == pytest.approx(0.12 * np.exp(-1.4)) and more(aside) == fresh_snow
    turning(part, 1.0, 300.0, step=0.1, position=here, heights=np.full(4, 0.2))
    assert more(here) == pytest.approx(0.12 * np.exp(-0.7 * (2.0 + part.DEEPEST)), rel=0.01)
    assert more(aside) == fresh_snow
    part.begin(None)
    turning(part, 1.0, 60.0, position=here, heights=np.full(4, 2.0))
    assert more(here) > 0.9 * fresh_snow


def test_the_corners_of_a_place_are_those_around_it():
    part = hollows.Scoured(1.0, PARAMS, None)
    for place in (REST[:2], np.array([0.4, -0.2]), np.array([-1.23, 2.34])):
        rows, columns, shares = part._corners(place)
        there = part.CELL * (np.array([rows, columns]) - 0.5 * part.CELLS)
        assert np.sum(shares) == pytest.approx(1.0) and there @ shares == pytest.approx(place)
    rows, columns, _ = part._corners(np.array([1e3, -1e3]))
    assert rows.max() == part.CELLS - 1 and columns.min() == 0


def test_air_between_rotors_goes_to_one_side_and_to_the_other_while_it_hovers():
    part = made('ground_effect', 'switching', 1.0)
    sides, share = PLACES[:, :2] @ part.onto, []
    for speed in (0.0, 2.0 * part.SWEPT * part.induced):
        more = []
        for t in np.arange(0.0, 60.0, 0.02):
            now = still(time=t, heights=np.full(4, 0.2), air=np.array([speed, 0.0, 0.0]))
            more.append((part.gain(now) - 1.0) / (0.12 * np.exp(-1.6)))
            part.after(0.02, np.eye(3), REST)
        more = np.array(more)
        assert np.mean(more, axis=1) == pytest.approx(np.ones(len(more)))
        first = int(np.argmax(np.abs(sides)))
        share.append(np.ptp(more[:, first]))
        assert (more - 1.0) * sides[first] == pytest.approx(
            (more[:, [first]] - 1.0) * sides, abs=1e-12)
    assert share[0] == pytest.approx(2.0 * part.DEPTH, rel=0.02)
    assert share[1] == pytest.approx(0.2 * share[0], rel=0.02)


def test_a_load_that_grows_lacks_air_until_the_blower_brings_it():
    battery = made('battery_sag', 'breathless', 2.0)
    battery.FALLS = 0.0

    def lacks(turn, seconds):
        for _ in range(max(round(seconds / 0.01), 1)):
            battery.drain(0.0, 0.01, np.full(4, turn))
        return (1.0 - battery.ratio) / 2.0 - battery.RESISTS * turn ** 3

    assert lacks(1.0, 5.0) == pytest.approx(0.0, abs=1e-9)
    more = battery.LACKS * (1.1 ** 3 - 1.0)
    assert lacks(1.1, 0.0) == pytest.approx(more)
    assert lacks(1.1, battery.TIME) == pytest.approx(more * np.exp(-1.0), rel=0.02)
    assert lacks(0.9, 0.0) == pytest.approx(0.0, abs=1e-9)


def test_strings_rest_at_a_low_load_and_a_higher_one_takes_less():
    battery, sags = made('battery_sag', 'rested', 2.0), []
    battery.FALLS = 0.0
    for load in (1.0, 1.1, 1.15, 1.0, 0.9, 1.0):
        for _ in range(500):
            battery.drain(0.0, 0.01, np.full(4, load ** (1.0 / 3.0)))
        sags.append((1.0 - battery.ratio) / (2.0 * battery.RESISTS))
    assert sags == pytest.approx([2.0, 2.2, 1.15, 1.0, 1.8, 2.0])


def test_warm_air_below_the_roof_takes_thrust_and_sways():
    part = made('thrust_scale', 'stratified', 2.0)

    def share(height, t=0.0):
        now = still(time=t, heights=np.full(4, height))
        return (part.gain(now)[0] - 1.0) / part.share

    assert share(0.0) == pytest.approx(part.BELOW, abs=0.1)
    assert share(3.0) == pytest.approx(part.ABOVE, abs=0.01) and part.share < 0.0
    here = [share(part.HEIGHT, t) for t in np.arange(0.0, part.PERIOD, 0.1)]
    assert np.ptp(here) > 0.02 and np.mean(here) == pytest.approx(1.0, abs=0.02)


def test_a_tank_is_full_on_the_way_there_and_empty_on_the_way_back():
    part, full = made('mass_offset', 'ferrying', 2.0), []
    onto = np.array([*part.onto, 0.0])
    for at in (-0.6, 0.4, 0.6, -0.4, -0.6):
        turning(part, 1.0, 5.0, position=at * onto)
        full.append(part._full)
    assert full == pytest.approx([1.0, 1.0, 0.0, 0.0, 1.0], abs=1e-4)
    true = fresh()
    part.alter(true, PARAMS)
    assert true['mass'] == pytest.approx(PARAMS['mass'] + part.parameters['mass'])
    force, moment = part.wrench(still(position=REST))
    half = 0.5 * part.MORE * part.parameters['mass']
    assert force == pytest.approx([0.0, 0.0, -half * GRAVITY], rel=1e-3) and not np.any(moment)


def test_a_sprinkler_pushes_as_it_passes_and_its_water_drips_off():
    part, forces = made('mass_offset', 'drenched', 2.0), []
    for t in np.arange(0.0, 100.0, 0.01):
        forces.append(part.wrench(still(time=t))[0][2])
        part.after(0.01, np.eye(3), REST)
    weights = -np.array(forces) / (part.parameters['mass'] * GRAVITY)
    assert np.mean(weights) == pytest.approx(1.0, rel=0.02)
    around = weights[5000:5500]
    assert around.max() > 3.0 > 0.3 > around.min() > 0.0
    assert weights[6000:6500] == pytest.approx(around, rel=1e-3)
    part._comes, part._wet = 0.0, 1.0
    for _ in range(round(part.DRIPS / 0.01)):
        part.after(0.01, np.eye(3), REST)
    assert part._wet == pytest.approx(np.exp(-1.0))


def test_a_boom_that_turns_around_has_its_inertia_across_itself():
    part = made('inertia_mismatch', 'slewing', 2.0)
    part.alter(fresh(), PARAMS)
    times = np.arange(0.0, part.AROUND, part.AROUND / 40)
    mean = np.mean([part.inertia(t) for t in times], axis=0)
    assert mean == pytest.approx(np.diag(part.loads))
    for t in times:
        moments = np.linalg.eigvalsh(part.inertia(t))
        assert moments[0] == pytest.approx(0.0, abs=1e-12 + 1e-9 * moments[2])
    # Faster and faster turns take it along, by its inertia.
    for k in range(100):
        now = instant(rate=(0.05 * k, 0.0, 0.0), time=3.0)
        moment = part.wrench(now)[1]
        part.after(0.01, np.eye(3), REST)
    lag = 0.01 / (1.0 - np.exp(-0.01 / part.TIME))
    assert moment == pytest.approx(-5.0 * lag / part.TIME * part.inertia(3.0)[:, 0])


def test_a_soft_boom_bends_back_with_the_flow():
    part, shifts = made('com_offset', 'bowed', 2.0), []
    lift = PARAMS['k_eta'] * 4.0 * HOVER ** 2
    for speed in (0.0, 0.1, 1.0, 30.0):
        ahead = np.array([speed * part.usual, 0.0, 0.0])
        moment = part.wrench(turning(part, 1.0, 5.0, air=ahead))[1]
        shifts.append(moment[1] / lift / np.linalg.norm(part.centre[:2]))
        assert moment[[0, 2]] == pytest.approx(np.zeros(2))
    once = part.BENDS / (1.0 + part.BENDS / part.MOST)
    assert shifts[:3] == pytest.approx([0.0, -0.01 * part.BENDS, -once], rel=5e-3)
    assert shifts[3] == pytest.approx(-part.MOST, rel=0.01)


def test_a_motor_is_disturbed_as_another_one_turns_alike():
    part = made('rotor_fault', 'crosstalk', 2.0)
    assert part.other != part.rotor

    def loss(apart):
        speeds = np.full(4, HOVER)
        speeds[part.other] += apart * HOVER
        gain = part.gain(still(speeds=speeds))
        assert np.count_nonzero(gain != 1.0) == 1
        return (1.0 - gain[part.rotor]) / part.loss

    assert [loss(0.0), loss(part.WIDE), loss(-part.WIDE)] == pytest.approx(
        [part.FIRST + part.PEAK, *[part.FIRST + 0.5 * part.PEAK] * 2])
    assert loss(0.5) == pytest.approx(part.FIRST, abs=0.01)
    assert part.torque(instant()) == pytest.approx(part.gain(instant()))


def test_a_controller_holds_back_by_the_load_of_all_and_sooner_late_in_the_flight():
    part, held = made('rotor_fault', 'early_cutoff', 2.0), []
    for time, load in ((0.0, 1.0), (0.0, 1.6), (18.0, 1.0), (18.0, 0.5)):
        turning(part, load ** (1.0 / 3.0), 6.0, time=time)
        held.append(part._part)
    assert held == pytest.approx([0.0, 1.0, 1.0, 0.0], abs=5e-3)
    part._part = 1.0
    turning(part, 0.8, part.GOES, time=0.0)
    assert part._part == pytest.approx(np.exp(-1.0), rel=1e-2)
    loss = (1.0 - part.gain(still())[part.rotor]) / part.loss
    assert loss == pytest.approx(part.FIRST + part.MORE * np.exp(-1.0), rel=1e-2)
    assert part.torque(instant()) == pytest.approx(part.gain(instant()))


def test_oil_lets_propellers_slip_and_passes_less_than_its_share_on():
    part = oils.Oiled(2.0, PARAMS, None)
    part.begin(None)
    turning(part, 1.0, 2.0)
    slip = 1.0 - part._blades[0] / HOVER
    assert (slip / part.SLIP) ** part.THINS == pytest.approx((1.0 - slip) ** 2, rel=1e-3)
    slopes = []
    for hubs in (1.02, 1.2):
        part._hubs = np.full(4, hubs * HOVER)
        slopes.append(part._slope()[0] / HOVER)
    assert 0.0 < slopes[1] < 9.0 * slopes[0]
    part._hubs = np.full(4, 0.8 * HOVER)
    assert part._slope()[0] < 0.0


def test_the_moment_of_twisting_blades_turns_about_in_fast_flight():
    part = twists.Twisting(2.0, PARAMS, None)

    def slope(speed, turn=1.0):
        now = still(air=np.array([speed, 0.0, 0.0]), speeds=np.full(4, turn * HOVER))
        return part.wrench(now)[1][1] / (part.moment * speed)

    assert slope(0.01) == pytest.approx(part.FIRST, rel=1e-3)
    assert slope(part.TURNS) == pytest.approx(0.0, abs=1e-9) and slope(3.0) < 0.0
    assert slope(20.0) == pytest.approx(part.FIRST * (1.0 - part.MOST))
    assert slope(1.1 * part.TURNS, 1.1) == pytest.approx(0.0, abs=1e-9)


def test_a_body_that_goes_past_a_camera_seems_to_lean():
    part = made('attitude_misalignment', 'rolling_shutter', 2.0)
    heads = Rotation.from_euler('z', 1.0)
    state, seen = np.array([*np.zeros(6), *heads.as_quat(), 0.1, 0.2, 0.3]), []
    for velocity in (REST, part.USUAL * part.right, part.USUAL * part.looks, [0.0, 0.0, 2.0],
                     -50.0 * part.right):
        state[3:6] = velocity
        out = part.measured(0.0, state, 1.0)
        assert out[:6] == pytest.approx(state[:6]) and out[10:] == pytest.approx(state[10:])
        seen.append(Rotation.from_quat(out[6:10]))
    tilt = np.linalg.norm(part.angles)
    assert (heads.inv() * seen[0]).as_euler('ZYX')[::-1] == pytest.approx(part.angles)
    for one, share in zip(seen[1:], (-part.LEANS, 0.0, 0.0, part.MOST), strict=True):
        assert (one * seen[0].inv()).as_rotvec() == pytest.approx(
            share * tilt * part.looks, abs=1e-12)
    # Its lower end seems to go ahead, to the right.
    below = (seen[1] * seen[0].inv()).apply([0.0, 0.0, -1.0])
    assert below @ part.right > 0.0
    assert np.cross(part.looks, [0.0, 0.0, 1.0]) == pytest.approx(part.right)


def test_a_gyroscope_of_fibres_feels_the_field_along_each_of_its_axes():
    part, state = made('gyro_bias', 'faraday', 2.0), np.array([*np.zeros(9), 1.0, *REST])
    assert np.linalg.norm(part.field) == pytest.approx(1.0) and part.field[2] < -0.5
    level = part.measured(0.0, state, 1.0)[10:]
    assert level == pytest.approx(part.bias + part.felt * part.field)
    state[6:10] = Rotation.from_euler('z', np.pi).as_quat()
    turned = part.measured(0.0, state, 1.0)[10:]
    assert turned == pytest.approx(part.bias + part.felt * part.field * [-1.0, -1.0, 1.0])
