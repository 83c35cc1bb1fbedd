# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of lags, delays, drag and wind that the twenty-second draw flies: what each does."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import HOVER, PARAMS, part_of, REST, still, turning

from withheld.forms.belts import Belted, FieldWeakened
from withheld.forms.corners import Corner, Draughty
from withheld.forms.exposures import Compiling, Exposing
from withheld.forms.stacks import Stacked
from withheld.forms.tandems import Radiating, Tandem


def test_a_propeller_on_a_belt_swings_past_its_motor_but_is_no_later_in_the_mean():
    motor, step, missing = Belted(2.0, PARAMS, None), 0.0005, []
    speeds = np.full(4, HOVER)
    for _ in range(4000):
        missing.append(1.1 - speeds[0] / HOVER)
        speeds = motor.turn(speeds, np.full(4, 1.1 * HOVER), step)
    time = motor.parameters['time']
    assert step * np.sum(missing) / 0.1 == pytest.approx(time, rel=0.02)
    assert np.min(missing) < -0.02 and abs(missing[-1]) < 1e-4
    # A wave of the belt, from a swing too low to the next one.
    late = np.array(missing)
    lows = np.flatnonzero((late[1:-1] < late[:-2]) & (late[1:-1] < late[2:]))
    wave = 2.0 * np.pi * time / (motor.RATE * np.sqrt(1.0 - motor.DAMPING ** 2))
    assert step * np.mean(np.diff(lows[:4])) == pytest.approx(wave, rel=0.03)


def test_a_belt_is_the_same_in_one_step_or_in_many():
    ends = []
    for parts in (1, 40):
        motor, speeds = Belted(2.0, PARAMS, None), np.full(4, 0.9 * HOVER)
        for _ in range(parts):
            speeds = motor.turn(speeds, np.array([1.0, 1.1, 0.9, 0.8]) * HOVER, 0.02 / parts)
        ends.append(speeds / HOVER)
    assert ends[0] == pytest.approx(ends[1], abs=1e-6) and ends[0][2] == pytest.approx(0.9)


def test_above_a_speed_a_weakened_field_slows_a_motor_with_the_square_of_it():
    motor, times = FieldWeakened(2.0, PARAMS, None), []
    for turn in (0.6, 0.85, 0.9, 1.0, 1.2):
        speeds = motor.turn(np.full(4, turn * HOVER), np.full(4, (turn + 1e-4) * HOVER), 1e-6)
        times.append(-1e-6 / np.log1p(-(speeds[0] / HOVER - turn) / 1e-4))
    over = np.maximum(np.array([0.6, 0.85, 0.9, 1.0, 1.2]) / motor.CORNER, 1.0) ** 2
    assert times == pytest.approx(motor.LEAST * motor.parameters['time'] * over, rel=1e-3)
    assert times[3] == pytest.approx(motor.parameters['time'], rel=0.1)


@pytest.mark.parametrize('kind', [Exposing, Compiling])
def test_a_line_has_its_mean_delay_in_a_flight(kind):
    line, waits = part_of(kind, 2.0), []
    for seed in range(60):
        line.begin(np.random.default_rng(seed))
        waits += [line.waits(t) for t in np.arange(0.0, 20.0, 0.0131)]
    assert np.mean(waits) == pytest.approx(line.delay, rel=0.05)
    assert np.min(waits) > 0.3 * line.delay


def test_exposures_go_from_sun_to_shade_by_an_equal_share_with_each_picture():
    line = part_of(Exposing, 2.0)
    waits = np.array([line.waits(line.EVERY * (k + 0.5)) for k in range(2000)])
    exposures = waits / line.delay - line.OWN
    assert exposures.max() / exposures.min() == pytest.approx(line.RATIO, rel=0.05)
    keep = np.exp(-line.EVERY / line.FOLLOWS)
    logs = np.log(exposures / exposures.min())
    goals = (logs[1:] - keep * logs[:-1]) / (1.0 - keep)
    shade = goals > 0.5 * np.log(line.RATIO)
    assert goals[shade] == pytest.approx(np.full(shade.sum(), np.log(line.RATIO)), abs=0.1)
    assert goals[~shade] == pytest.approx(np.zeros((~shade).sum()), abs=0.1)
    stays = line.EVERY * np.diff(np.flatnonzero(np.diff(shade)))
    assert stays.min() > 0.9 and stays.max() < 5.1 and 0.2 < shade.mean() < 0.5


def test_a_program_gets_faster_twice_and_falls_back_for_a_while():
    line = part_of(Compiling, 2.0)
    t = np.arange(0.0, 60.0, 0.01)
    levels = np.array([line.waits(one) for one in t]) / line.delay
    levels = levels.round(9)
    slow, middle, fast = line.LEVELS
    early = levels[t < line.compiled[1]]
    assert np.all(np.diff(early) <= 0.0) and set(early) == {slow, middle}
    late = levels[t >= line.compiled[1]]
    assert set(late) == {slow, fast}
    edges = np.flatnonzero(np.diff(late))
    assert 0.01 * (edges[1::2] - edges[::2][:len(edges[1::2])]) == pytest.approx(
        np.full(len(edges) // 2, line.LASTS), abs=0.011)
    assert 0.01 * np.diff(edges[::2]).min() > line.LASTS + line.BETWEEN[0] - 0.02


def test_a_lower_rotor_is_all_in_the_wake_in_hover_and_out_of_it_when_that_is_swept_away():
    part = part_of(Stacked, 2.0)
    r = part.NARROWS
    # Two circles: one in the other, one half out by the closed form, one beside the other.
    assert part.covered(np.array([0.0, 1.0 - r, 1.0 + r, 9.0])) == pytest.approx(
        [1.0, 1.0, 0.0, 0.0], abs=1e-6)
    rng = np.random.default_rng(1)
    spots = r * np.sqrt(rng.random((40000, 1))) * np.array(
        [[np.cos(a), np.sin(a)] for a in rng.uniform(0.0, 2.0 * np.pi, 40000)])
    for away in (0.5, 1.0, 1.5):
        inside = np.mean(np.linalg.norm(spots + [away, 0.0], axis=1) < 1.0)
        assert part.covered(np.array([away])) == pytest.approx([inside], abs=0.01)
    shares = []
    for speed in (0.01, 3.0, 100.0):
        force, _ = part.wrench(still(air=np.array([speed, 0.0, 0.0])))
        assert force[1:] == pytest.approx([0.0, 0.0])
        shares.append(-force[0] / speed / part.coefficient)
    assert shares[0] == pytest.approx(2.0 * part.OWN + part.MORE)
    assert shares[2] == pytest.approx(2.0 * part.OWN) and shares[2] < shares[1] < shares[0]


def test_a_climb_keeps_the_wake_on_the_lower_rotor_and_what_that_loses_turns_the_body():
    part, drags = part_of(Stacked, 2.0), []
    for climb in (-1.5, 0.0, 1.5):
        force, moment = part.wrench(still(air=np.array([3.0, 0.0, climb])))
        drags.append(-force[0])
        lost = 3.0 * part.coefficient * (2.0 * part.OWN + part.MORE) + force[0]
        assert moment == pytest.approx([0.0, -part.below[2] * lost, 0.0])
    assert np.all(np.diff(drags) > 0.0)
    assert (part.above + part.below)[2] == pytest.approx(part.GAP * PARAMS['rotor_radius'])
    _, moment = part.wrench(still(air=np.array([0.5, 0.0, 0.0])))
    assert moment == pytest.approx(REST, abs=1e-9)


def test_of_two_pods_the_rear_one_saves_its_drag_along_their_line_either_way():
    part = part_of(Tandem, 2.0)
    across = np.cross(part.line, [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    drags = []
    for flow in (part.line, -part.line, across):
        force, moment = part.wrench(still(air=2.0 * flow))
        drags.append(-force @ flow / (4.0 * part.coefficient * part.ONE))
        assert np.cross(force, flow) == pytest.approx(REST, abs=1e-12) and not np.any(moment)
    assert drags == pytest.approx([2.0 - part.SAVES] * 2 + [2.0], abs=0.01)
    angles = np.linspace(0.0, 0.5 * np.pi, 10)
    pushes = [np.linalg.norm(part.wrench(still(
        air=np.cos(a) * part.line + np.sin(a) * across))[0]) for a in angles]
    assert np.all(np.diff(pushes) > 0.0)
    fast = part.wrench(still(air=4.0 * part.line))[0] / part.wrench(still(air=part.line))[0]
    assert fast == pytest.approx(np.full(3, 16.0))


def test_flaps_open_when_it_is_hot_and_shut_when_it_is_cold():
    part, drags, heats = part_of(Radiating, 2.0), [], []
    for _ in range(4000):
        now = turning(part, 1.0, 0.01, air=np.array([2.0, 0.0, 0.0]))
        drags.append(-part.wrench(now)[0][0] / (4.0 * part.coefficient))
        heats.append(part._heat)
    drags, heats = np.array(drags), np.array(heats)[500:]
    assert drags.min() == pytest.approx(part.OWN, abs=0.01)
    assert drags.max() == pytest.approx(part.OWN + part.OPEN, abs=0.01)
    assert [heats.min(), heats.max()] == pytest.approx([part.SHUTS, part.OPENS], abs=2e-3)
    shut, opened = part.COOLS
    period = sum(part.HEATS / cools * np.log((one - 1.0 / cools) / (other - 1.0 / cools))
                 for cools, one, other in ((shut, part.SHUTS, part.OPENS),
                                           (opened, part.OPENS, part.SHUTS)))
    peaks = np.flatnonzero((heats[1:-1] > heats[:-2]) & (heats[1:-1] >= heats[2:]))
    assert 0.01 * np.mean(np.diff(peaks)) == pytest.approx(period, rel=0.02)


def test_a_radiator_drags_ahead_alone_and_stays_open_at_a_high_load():
    part = part_of(Radiating, 2.0)
    turning(part, 1.3, 20.0)
    force, moment = part.wrench(still(air=np.array([0.0, 2.0, 0.0])))
    assert force == pytest.approx([0.0, -4.0 * part.coefficient * part.OWN, 0.0])
    assert not np.any(moment)
    force, _ = part.wrench(still(air=np.array([-2.0, 0.0, 0.0])))
    assert force[0] == pytest.approx(4.0 * part.coefficient * (part.OWN + part.OPEN))
    turning(part, 0.8, 20.0)
    assert part._flaps == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize('seed', range(6))
def test_air_around_a_corner_is_neither_squeezed_nor_turned_and_follows_the_walls(seed):
    wind, step = Corner(2.0, PARAMS, np.random.default_rng(seed)), 1e-5
    assert wind.wind(0.0, np.array([0.0, 0.0, 1.0])) == pytest.approx(wind.mean)
    for place in np.random.default_rng(1).uniform(-1.0, 1.0, (10, 3)):
        slopes = np.array([(wind.wind(3.0, place + step * axis) - wind.wind(
            3.0, place - step * axis)) / (2.0 * step) for axis in np.eye(3)])
        assert np.trace(slopes) == pytest.approx(0.0, abs=1e-6)
        assert slopes == pytest.approx(slopes.T, abs=1e-6)
    for side in (-1.0, 1.0):
        wall = Rotation.from_euler('z', wind.halfway + side * 0.7499 * np.pi).apply([1.5, 0, 0])
        air = wind.wind(0.0, wall + [*wind.edge, 1.0])
        assert np.cross(wall, air)[2] == pytest.approx(0.0, abs=2e-3)


def test_air_is_the_faster_the_nearer_to_the_edge_up_to_a_distance():
    wind = part_of(Corner, 2.0)
    out = -wind.edge / wind.away

    def speed(away):
        return np.linalg.norm(wind.wind(0.0, np.array([*(wind.edge + away * out), 1.0])))

    mean = np.linalg.norm(wind.mean)
    assert [speed(8.0 * wind.away), speed(wind.away / 2.0)] == pytest.approx(
        [0.5 * mean, 2.0 ** (1.0 / 3.0) * mean])
    assert speed(0.0) == pytest.approx(speed(0.5 * wind.NEAR)) == pytest.approx(
        (wind.away / wind.NEAR) ** (1.0 / 3.0) * mean)


def test_a_draught_comes_up_as_doors_open_and_dies_down_to_what_leaks():
    wind = part_of(Draughty, 2.0)
    t = np.arange(0.0, 60.0, 0.01)
    mean = np.linalg.norm(wind.mean)
    air = np.array([wind.wind(one, np.array([0.0, 0.0, 1.0])) for one in t])
    assert np.cross(air, wind.mean) == pytest.approx(np.zeros_like(air), abs=1e-9)
    speeds = air @ wind.mean / mean ** 2 / wind.OPEN
    assert speeds.min() >= wind.LEAKS - 1e-9 and speeds.max() <= 1.0 + 1e-9
    assert speeds.max() > 0.99 and speeds.min() < 1.6 * wind.LEAKS
    # Its slope is what the pressure pushes by, less what is lost with the square.
    pushes = wind.TIME * np.gradient(speeds, 0.01) + speeds ** 2
    opened = wind.opened[np.searchsorted(wind.times, t, side='right') - 1]
    calm = np.abs(t[:, None] - wind.times).min(axis=1) > 0.02
    assert pushes[opened & calm] == pytest.approx(np.ones((opened & calm).sum()), abs=0.01)
    assert pushes[~opened & calm] == pytest.approx(
        np.full((~opened & calm).sum(), wind.LEAKS ** 2), abs=0.01)


def test_a_draught_is_about_its_mean_and_less_beside_its_middle():
    wind, speeds = part_of(Draughty, 2.0), []
    for seed in range(40):
        wind.begin(np.random.default_rng(seed))
        speeds += [np.linalg.norm(wind.wind(t, REST)) for t in np.arange(0.0, 20.0, 0.1)]
    mean = np.linalg.norm(wind.mean)
    assert np.mean(speeds) == pytest.approx(mean, rel=0.1)
    along = wind.mean / mean
    aside = wind.WIDE * np.array([-along[1], along[0], 0.0])
    assert wind.wind(3.0, aside + 7.0 * along) == pytest.approx(
        np.exp(-1.0) * wind.wind(3.0, REST))
