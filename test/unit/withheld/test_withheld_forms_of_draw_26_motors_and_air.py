# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of lags, delays, drag and wind that the twenty-sixth draw flies: what each does."""


import numpy as np
import pytest
from withheld_parts import HOVER, PARAMS, part_of, PLACES, REST, stepped, still

from withheld.forms.arrays import HandedOn
from withheld.forms.batches import Batched
from withheld.forms.collectives import Collective
from withheld.forms.devils import DustDevil
from withheld.forms.engines import Carburetted
from withheld.forms.hums import Humming
from withheld.forms.mouths import Breathing
from withheld.forms.shapers import Shaped
from withheld.forms.stalls import LateParting


@pytest.mark.parametrize('kind', [Carburetted, Shaped])
def test_a_command_that_is_held_is_reached_and_is_the_same_in_one_step_or_in_many(kind):
    command = np.array([1.1, 0.9, 1.0, 1.2])
    assert stepped(kind(2.0, PARAMS, None), command)[-1] == pytest.approx(command, abs=1e-6)
    assert stepped(kind(2.0, PARAMS, None), 1.0) == pytest.approx(np.ones((2000, 4)))
    one = stepped(kind(2.0, PARAMS, None), command, 0.004, 0.04)[-1]
    many = stepped(kind(2.0, PARAMS, None), command, 0.0001, 0.04)[-1]
    assert one == pytest.approx(many, abs=5e-3)


@pytest.mark.parametrize(('kind', 'change'), [(Carburetted, 1e-3), (Shaped, 0.2)])
def test_a_step_misses_its_mean_time(kind, change):
    motor, step = kind(2.0, PARAMS, None), 0.0005
    missing = (1.0 + change - stepped(motor, 1.0 + change, step)[:, 0]) / change
    assert step * (0.5 + missing.sum()) == pytest.approx(motor.parameters['time'], rel=5e-3)


def test_of_fuel_a_part_burns_at_once_and_the_rest_as_it_dries():
    motor, step = Carburetted(2.0, PARAMS, None), 0.0005
    time, change = motor.parameters['time'], 1e-3
    turns = stepped(motor, 1.0 + change, step)[:, 0]
    since = step * np.arange(1, len(turns) + 1)
    own, dries = motor.SPEED * time, (1.0 - motor.SPEED) / motor.WETS * time
    # Partial fractions of a lag behind what is short by WETS at first.
    slow = motor.WETS * dries / (dries - own)
    missing = slow * np.exp(-since / dries) + (1.0 - slow) * np.exp(-since / own)
    assert (1.0 + change - turns) / change == pytest.approx(missing, abs=2e-3)


def test_an_engine_without_fuel_is_braked_by_its_propeller_alone():
    motor, step = Carburetted(2.0, PARAMS, None), 0.0005
    motor.WETS = 1e-9
    turns = stepped(motor, 0.0, step, 0.2)[:, 0]
    since = step * np.arange(1, len(turns) + 1)
    own = motor.SPEED * motor.parameters['time']
    assert turns == pytest.approx(1.0 / (1.0 + since / (2.0 * own)), rel=2e-3)


def test_a_shaper_gives_the_rest_half_a_swing_later_and_nothing_swings_on():
    motor, step = Shaped(2.0, PARAMS, None), 0.0005
    time, later = motor.parameters['time'], motor.later
    turns = stepped(motor, 1.2, step)[:, 0]
    since = step * np.arange(1, len(turns) + 1)
    lag = motor.MOTOR * time
    first, rest = ((1.0 - np.exp(-np.maximum(since - at, 0.0) / lag)) for at in (0.0, later))
    assert (turns - 1.0) / 0.2 == pytest.approx(
        (1.0 - motor.second) * first + motor.second * rest, abs=5e-3)
    # What swings with half a period of `later` has nothing left, once both parts are over.
    damping = motor.DAMPED
    rate = np.pi / later / np.sqrt(1.0 - damping ** 2)
    pole = rate * complex(damping, np.sqrt(1.0 - damping ** 2))
    assert abs(1.0 - motor.second + motor.second * np.exp(pole * later)) < 1e-9
    assert 0.4 < motor.second < 0.5


def test_modules_hand_a_command_on_outwards_with_the_mean_delay():
    line = part_of(HandedOn)
    waits = np.array([line.waits(t) for t in np.arange(0.0, 60.0, 0.00377)])
    assert waits.mean() == pytest.approx(line.delay, rel=0.06)
    means = waits.mean(axis=0)
    assert means[0] < min(means[1], means[3]) < max(means[1], means[3]) < means[2]
    # One, two, three and two clocks.
    looks = means / (line.takes + 0.5 * np.mean(line.every))
    assert looks == pytest.approx([1.0, 2.0, 3.0, 2.0], abs=0.45)
    # What is given later does not come sooner.
    assert np.all(np.diff(waits, axis=0) > -0.00377 - 1e-9)


def test_a_module_hands_on_at_its_own_looks():
    line = part_of(HandedOn)
    at = np.array([t + line.waits(t) for t in np.arange(0.0, 5.0, 0.0037)]) - line.takes
    for k in range(4):
        looks = (at[:, k] - line.first[k]) / line.every[k]
        assert looks == pytest.approx(np.round(looks), abs=1e-6)
    assert [source for _, source in sorted(line.order)] == [0, 1, 0]


def waits_of(line, size, rate, step=0.002, seconds=6.0):
    """Return the delays of commands that differ by a sine, as they are given."""
    seen, ask = [], line.waits
    line.waits = lambda time: seen.append(ask(time)) or seen[-1]
    signs = np.array([1.0, -1.0, -1.0, 1.0])
    for time in np.arange(0.0, seconds, step):
        line.pass_on(time, HOVER * (1.0 + size * np.sin(rate * time) * signs), step)
    return np.array(seen)


def test_a_batch_is_full_late_in_calm_flight_and_early_in_lively_flight():
    calm, lively = part_of(Batched), part_of(Batched)
    own = calm.OWN * calm.delay
    waits = waits_of(calm, 0.0, 1.0)
    assert waits.mean() == pytest.approx(own + 0.5 * calm.full / calm.CALM, rel=0.03)
    assert np.ptp(waits) == pytest.approx(calm.full / calm.CALM, rel=0.05)
    waits = waits_of(lively, 0.5, 6.0)
    # But for where a swing turns back, as fast as it gets.
    assert waits.min() == pytest.approx(own, rel=0.1)
    assert np.median(waits) == pytest.approx(own + 0.5 * lively.full / lively.MOST, rel=0.1)


def test_a_batch_has_its_mean_delay_at_the_usual_pace():
    line = part_of(Batched)
    waits = np.array([line.waits(t) for t in np.arange(0.0, 20.0, 0.00137)])
    assert waits.mean() == pytest.approx(line.delay, rel=0.01)
    # What differs by a steady share is a turn of that, times what it takes to fade.
    share = line.USUAL / line.FADES
    for time in np.arange(0.0, 3.0, 0.01):
        line.pass_on(time, HOVER * (1.0 + share * np.array([1.0, -1.0, 1.0, -1.0])), 0.01)
    assert line._pace == pytest.approx(1.0, rel=1e-3)


def test_rotors_of_variable_pitch_drag_by_what_they_lift():
    part, air = part_of(Collective), np.array([3.0, -1.0, 2.0])
    level = part.coefficient * np.array([3.0, -1.0, 0.0])
    force, moment = part.wrench(still(air=air))
    assert force == pytest.approx(-level) and moment == pytest.approx(REST, abs=1e-12)
    # Without lift what is always there is left.
    assert part.wrench(still(air=air, speeds=np.zeros(4)))[0] == pytest.approx(
        -part.ALWAYS * level)
    force, _ = part.wrench(still(air=air, speeds=HOVER * np.full(4, np.sqrt(2.0))))
    share = part.ALWAYS + part.LEANS * 2.0 ** 1.5 + part.POLAR * 4.0
    assert force == pytest.approx(-share * level)


def test_what_lifts_more_on_one_side_turns_the_vehicle():
    part = part_of(Collective)
    left = PLACES[:, 1] > 0.0
    force, moment = part.wrench(still(air=np.array([2.0, 0.0, 0.0]),
                                      speeds=HOVER * np.where(left, 1.2, 0.8)))
    more, less = (part.ALWAYS + part.LEANS * t ** 3 + part.POLAR * t ** 4 for t in (1.2, 0.8))
    assert force[0] == pytest.approx(-part.coefficient * (more + less))
    assert moment == pytest.approx([0.0, 0.0, 0.12 * part.coefficient * (more - less)])


def held(part, air, seconds, step=0.005):
    """Return the forces (N, 3), over the coefficient, of a flow that is held."""
    forces = []
    for _ in range(round(seconds / step)):
        force, moment = part.wrench(still(air=air))
        assert not np.any(moment)
        forces.append(force / part.coefficient)
        part.after(step, np.eye(3), REST)
    return np.array(forces)


@pytest.mark.parametrize('seed', range(3))
def test_rods_hum_in_a_band_of_speeds_and_drag_by_more_there(seed):
    shares = []
    for over in (0.2, 1.0, 3.0):
        part = part_of(Humming, seed=seed)
        speed = over * part.locks
        shares.append(-held(part, np.array([0.0, speed, 0.0]), 5.0)[-1, 1] / speed ** 2)
    rods = np.array([1.0, 1.0 + part.MORE, 1.0])
    assert shares == pytest.approx(part.OWN + part.RODS * rods, rel=0.01)


def test_rods_take_a_while_to_hum_and_feel_nothing_along_them():
    part = part_of(Humming)
    speed = part.locks
    forces = held(part, np.array([speed, 0.0, 0.0]), part.TAKES + 0.005)
    assert -forces[0, 0] == pytest.approx((part.OWN + part.RODS) * speed ** 2)
    more = part.MORE * (1.0 - np.exp(-1.0)) ** part.POWER
    assert -forces[-1, 0] == pytest.approx((part.OWN + part.RODS * (1.0 + more)) * speed ** 2)
    climbs = held(part, np.array([0.0, 0.0, 2.0]), 0.01)
    assert climbs[0] == pytest.approx([0.0, 0.0, -4.0 * part.OWN])


def test_a_flow_that_clings_or_has_parted_presses_as_kirchhoff_has_it():
    for angle, clings in ((0.05, 1.0), (0.8, 0.0)):
        for sign in (1.0, -1.0):
            part = part_of(LateParting)
            air = 3.0 * np.array([np.cos(angle), 0.0, sign * np.sin(angle)])
            force = held(part, air, 6.0)[-1]
            across = part.ACROSS * (0.5 + 0.5 * np.sqrt(clings)) ** 2 * 3.0 * air[2]
            assert force == pytest.approx(-part.OWN * 3.0 * air - [0.0, 0.0, across], rel=0.03)
    half = part_of(LateParting)
    held(half, np.array([np.cos(half.PARTS), 0.0, np.sin(half.PARTS)]), 20.0)
    assert half._clings == pytest.approx(0.5, rel=1e-3)


def test_a_flow_parts_and_clings_again_after_a_way_however_fast():
    lag = []
    for speed in (1.0, 4.0):
        part = part_of(LateParting)
        steep = speed * np.array([0.0, np.cos(0.8), np.sin(0.8)])
        held(part, steep, part.LENGTHS * part.long / speed, 0.001)
        lag.append(part._clings)
    assert lag == pytest.approx([np.exp(-1.0)] * 2, abs=2e-3)
    # On the way back it presses less than on the way there.
    part = part_of(LateParting)
    lean = 2.0 * np.array([np.cos(0.15), 0.0, np.sin(0.15)])
    there = held(part, lean, 0.5)[-1, 2]
    held(part, steep, 2.0)
    assert abs(held(part, lean, 0.005)[0, 2]) < 0.6 * abs(there)


@pytest.mark.parametrize('seed', range(4))
def test_a_dust_devil_turns_fastest_at_its_core(seed):
    wind = part_of(DustDevil, seed=seed)
    x, y = wind.middle(5.0)
    speeds = {}
    for over in (1e-3, 0.9, 1.0, 1.1, 10.0):
        air = wind.wind(5.0, np.array([x + over * wind.core, y, 0.0])) - wind.mean
        speeds[over] = air[1]
        assert air[0] == pytest.approx(-wind.inwards * wind.core * over * np.exp(-over ** 2))
    assert speeds[1.0] == pytest.approx(wind.turns, rel=1e-4)
    assert abs(speeds[1.0]) > max(abs(speeds[0.9]), abs(speeds[1.1]))
    # As a body that turns within, and as a line vortex far away.
    assert speeds[1e-3] == pytest.approx(1e-3 * wind.turns * wind.SPREAD / wind.FASTEST, rel=1e-3)
    assert speeds[10.0] == pytest.approx(wind.turns / (10.0 * wind.FASTEST), rel=1e-3)


def test_a_dust_devil_takes_no_air_away_and_rises_in_its_middle():
    wind, h = part_of(DustDevil), 1e-4
    for place in np.random.default_rng(1).uniform([-2.0, -2.0, 0.1], [2.0, 2.0, 4.0], (12, 3)):
        spreads = sum(
            (wind.wind(3.0, place + h * axis) - wind.wind(3.0, place - h * axis)) @ axis
            for axis in np.eye(3)) / (2.0 * h)
        assert spreads == pytest.approx(0.0, abs=1e-6)
    at = np.array([*wind.middle(3.0), 1.0])
    assert wind.wind(3.0, at) - wind.mean == pytest.approx([0.0, 0.0, 2.0 * wind.inwards])
    assert wind.wind(3.0, at + [1.5 * wind.core, 0.0, 0.0])[2] < 0.0


@pytest.mark.parametrize('seed', range(3))
def test_what_a_hall_breathes_in_is_its_mean_wind_in_the_middle(seed):
    wind = part_of(Breathing, seed=seed)
    middle = np.array([0.0, 0.0, wind.place[2]])
    air = np.array([wind.wind(t, middle) for t in np.arange(0.0, 2000.0, 0.0513)])
    along = air @ wind.onto
    assert air[along > 0.0].mean(axis=0) == pytest.approx(wind.mean, rel=0.03)
    # It comes in as a jet and leaves from all sides: so it is fast and slow by turns.
    assert along.max() > 6.0 * -along.min() > 0.0
    assert np.mean(along > 0.0) == pytest.approx(0.5, abs=0.02)


def test_air_comes_in_as_a_jet_and_goes_out_from_all_sides():
    wind = part_of(Breathing)
    times = np.arange(0.0, 10.0, 0.01)
    swings = np.array([wind.swing(t) for t in times])
    into, out = times[swings.argmax()], times[swings.argmin()]
    fast = wind.most * swings.max()
    # The momentum of a jet stays: so do its speed times its width.
    aside = np.cross(wind.onto, [0.0, 0.0, 1.0])
    for far in (0.0, 1.0, 3.0):
        wide = wind.WIDE * (far + wind.behind)
        axis = wind.wind(into, wind.place + far * wind.onto)
        assert np.linalg.norm(axis) * wide == pytest.approx(fast * np.sqrt(wind.area / np.pi))
        edge = wind.wind(into, wind.place + far * wind.onto + wide * aside)
        assert edge == pytest.approx(np.exp(-1.0) * axis)
    for way in np.random.default_rng(1).normal(size=(9, 3)):
        air, square = wind.wind(out, wind.place + way), float(way @ way)
        assert np.cross(air, way) == pytest.approx(REST, abs=1e-9) and air @ way < 0.0
        through = np.linalg.norm(air) * (wind.area + 2.0 * np.pi * square)
        assert through == pytest.approx(-wind.most * swings.min() * wind.area)
