# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of inertia, rotors and sensors that the twenty-fifth draw flies, and a stranger."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import fresh, HANGING, HOVER, LEVEL, PARAMS, part_of, REST, still, turning

from withheld import outside
from withheld.constants import induced_velocity
from withheld.forms.body import inertia_of
from withheld.forms.circles import Circling
from withheld.forms.dents import Burst, Shorted
from withheld.forms.legs import Stowing
from withheld.forms.sonars import Pinged
from withheld.forms.syrups import Syrupy
from withheld.forms.tags import Tagged
from withheld.forms.transmissions import Eddied, Hydraulic


def test_syrup_takes_up_a_turn_by_the_root_of_time_at_first_and_all_of_it_in_the_end():
    part, true, rate = part_of(Syrupy), fresh(), np.array([0.5, -1.0, 0.2])
    part.alter(true, PARAMS)
    at_once = np.diag(inertia_of(true) - inertia_of(fresh()))
    assert np.tan(part.ROOTS) == pytest.approx(part.ROOTS, rel=1e-4)
    taken, step = [at_once * rate], 0.0005
    for _ in range(4000):
        taken.append(taken[-1] - step * part.wrench(still(rate=rate))[1])
        part.after(step, LEVEL, REST)
    shares = np.array(taken) / (part.loads * rate)
    assert shares[-1] == pytest.approx(np.ones(3), rel=0.01)
    # The solution for short times: what a flat wall drags along, less as the wall is curved.
    for at in (40, 80):
        short = step * at / part.TIME
        first = 10.0 * np.sqrt(short / np.pi) - 10.0 * short
        assert shares[at] == pytest.approx(np.full(3, first), abs=0.03)
    assert np.all(np.diff(shares, axis=0) > 0.0)


def test_syrup_is_the_same_in_one_step_or_in_many():
    ends = []
    for count in (1, 30):
        part = part_of(Syrupy)
        part.wrench(still(rate=np.array([0.5, -1.0, 0.2])))
        for _ in range(count):
            part.after(0.1 / count, LEVEL, REST)
        ends.append(part._turning)
    assert ends[0] == pytest.approx(ends[1])


def test_legs_fold_above_a_height_and_come_down_below_another_one():
    part, shares = part_of(Stowing), []
    lift, far = PARAMS['mass'] * 9.81, np.linalg.norm(part.centre[:2])
    for height in (0.5, 0.9, 1.05, 1.2, 0.9, 0.82, 0.7, 1.0):
        there = np.array([0.3, 0.4, height])
        turning(part, 1.0, 1.5, position=there)
        force, moment = part.wrench(still(position=there))
        assert not np.any(force) and moment[0] == moment[2] == 0.0
        shares.append(-moment[1] / lift / far / part.SWINGS)
    assert shares == pytest.approx([-1.0, -1.0, -1.0, 1.0, 1.0, 1.0, -1.0, -1.0])
    turning(part, 1.0, 0.5 * part.LASTS, position=np.array([0.0, 0.0, 2.0]))
    assert part._legs == pytest.approx(0.0, abs=1e-9)


def test_shorted_turns_brake_by_a_curve_with_a_peak_and_ease_as_they_heat():
    part = part_of(Shorted)
    assert part.brakes(part.PEAK, 0.0) == pytest.approx(1.0)
    assert part.brakes(0.5 * part.PEAK, 0.0) == part.brakes(2.0 * part.PEAK, 0.0) == 0.8
    cold = part.gain(still())
    turning(part, 1.0, 30.0)
    assert part._heat == pytest.approx(1.0, rel=1e-3)
    warm = part.gain(still())
    assert 1.0 - warm[part.rotor] == pytest.approx(part.loss, rel=1e-3)
    assert 1.0 - cold[part.rotor] == pytest.approx(
        part.loss * part.brakes(1.0, 0.0) / part.brakes(1.0, 1.0))
    assert np.delete(warm, part.rotor) == pytest.approx(np.ones(3))
    for turn in (0.7, 1.3):
        gain = part.gain(still(speeds=np.full(4, turn * HOVER)))
        taken = (1.0 - gain[part.rotor]) * turn ** 2 / part.loss    # of the torque in hover
        assert taken == pytest.approx(part.brakes(turn, 1.0) / part.brakes(1.0, 1.0), rel=1e-3)
    assert np.array_equal(part.torque(still()), part.gain(still()))


def test_a_flow_that_has_parted_comes_back_in_a_climb_alone():
    part, induced, losses = part_of(Burst), induced_velocity(PARAMS), []
    for climb in (0.0, -0.05, -0.15, -0.05, 0.05, -0.05):
        now = turning(part, 1.0, 2.0, air=np.array([0.0, 0.0, climb * induced]))
        losses.append(1.0 - part.gain(now)[part.rotor])
    low, high = part.LOSSES
    assert np.array(losses) / part.loss == pytest.approx([low, low, high, high, low, low])
    assert np.delete(part.gain(now), part.rotor) == pytest.approx(np.ones(3))
    assert part.torque(now) - 1.0 == pytest.approx(part.TORQUE * (1.0 - part.gain(now)))
    # In level flight the induced velocity is less by the root, and slow rotors mind it more.
    for turn in (0.8, 1.0, 1.2):
        part.begin(None)
        across = turn * induced * np.sqrt((1.0 - part.PARTS) ** -2 - 1.0)
        for share, goal in ((0.99, 0.0), (1.01, 1.0)):
            turning(part, turn, 0.1, air=np.array([0.6, 0.8, 0.0]) * share * across)
            assert part._goal == goal


@pytest.mark.parametrize('kind', [Eddied, Hydraulic])
def test_propellers_slip_by_their_drag_and_give_the_body_what_they_lose(kind):
    part, given, step = part_of(kind), 0.0, 0.0025
    assert part.wrench(still())[1] == pytest.approx(REST, abs=1e-12)
    assert part._blades == pytest.approx(np.full(4, (1.0 - part.slip()) * HOVER))
    for _ in range(4000):
        part.wrench(still())
        part.after(step, LEVEL, REST)
    spins, first = PARAMS['rotor_directions'], part._blades
    turns = 1.0 + 0.2 * (spins > 0)
    for _ in range(4000):
        force, moment = part.wrench(still(speeds=turns * HOVER))
        given += step * moment[2]
        part.after(step, LEVEL, REST)
    assert not np.any(force) and moment == pytest.approx(REST, abs=1e-7)
    assert given == pytest.approx(part.inertia * spins @ (part._blades - first))
    assert np.all(part._blades < turns * HOVER) and np.all(part._blades > 0.88 * turns * HOVER)
    rate, momentum = np.array([0.4, -0.7, 0.3]), part.inertia * spins @ part._blades
    moment = part.wrench(still(speeds=turns * HOVER, rate=rate))[1]
    assert moment == pytest.approx(momentum * np.array([rate[1], -rate[0], 0.0]), abs=1e-7)


def test_eddies_pull_most_at_one_slip_and_less_beyond():
    part = part_of(Eddied)
    part._blades, pulls = np.full(4, HOVER), []
    for slip in (0.5, 1.0, 2.0):
        part._hubs = (1.0 + slip * part.PEAK) * part._blades
        pulls.append(part._slope()[0] / part.SLOWS / HOVER + 1.0)
    assert np.array(pulls) / part.HOLDS == pytest.approx([0.8, 1.0, 0.8])


def test_oil_never_pulls_back_and_pulls_no_more_than_its_valve_lets_it():
    part, step, speeds = part_of(Hydraulic), 0.0025, []
    part.wrench(still())
    for turn in (0.3, 3.0):
        for _ in range(80):
            part.wrench(still(speeds=np.full(4, turn * HOVER)))
            part.after(step, LEVEL, REST)
            speeds.append(part._blades[0] / HOVER)
        most = part.MOST * part.SLOWS * HOVER
        assert part._pull == pytest.approx(np.full(4, 0.0 if turn < 1.0 else most))
    # Without pressure the drag alone slows them: 1 / speed grows evenly.
    falls = np.diff(1.0 / np.array(speeds[30:80]))
    assert falls == pytest.approx(np.full(49, step * part.SLOWS), rel=0.01)


def test_oil_springs_at_its_rate_where_little_leaks():
    part, step, pulls = part_of(Hydraulic), 0.0005, []
    part.SLIP = 0.0
    for turn in [1.0] * 10 + [1.01] * 1000:
        part.wrench(still(speeds=np.full(4, turn * HOVER)))
        part.after(step, LEVEL, REST)
        pulls.append(part._blades[0] / HOVER - turn)
    turns = np.flatnonzero(np.diff(np.sign(pulls[10:])))
    damping = part.SLOWS            # s^2 + 2 SLOWS s + RATE^2
    assert np.diff(turns) * step == pytest.approx(
        np.full(len(turns) - 1, np.pi / np.sqrt(part.RATE ** 2 - damping ** 2)), rel=0.03)


def test_disks_circle_to_where_they_lean_and_cancel_to_the_side():
    part, step, moments = part_of(Circling), 0.002, []
    part.wrench(still())
    now = still(air=np.array([2.0, 0.0, 0.0]))
    for _ in range(1000):
        part.wrench(now)
        part.after(step, LEVEL, REST)
        moments.append(part.wrench(now)[1])
    t, side = step * np.arange(1, 1001), part.AROUND * part.TIME
    leans = 1.0 - np.exp(-t / part.TIME) * (np.cos(part.AROUND * t)
                                            - side * np.sin(part.AROUND * t))
    moments = np.array(moments)
    assert moments[:, 1] == pytest.approx(2.0 * part.moment * leans)
    assert moments[:, [0, 2]] == pytest.approx(np.zeros((1000, 2)), abs=1e-12)
    assert leans.max() > 1.1 and leans[-1] == pytest.approx(1.0)


def test_rotors_of_one_spin_lean_to_one_side_and_a_settled_disk_stays():
    part, spins = part_of(Circling), PARAMS['rotor_directions']
    speeds = HOVER * np.where(spins > 0, 1.2, 0.8)
    now = still(air=np.array([0.0, 1.5, 0.3]), speeds=speeds)
    force, moment = part.wrench(now)
    assert not np.any(force)
    side = part.AROUND * part.TIME * 0.2
    assert moment == pytest.approx(1.5 * part.moment * np.array([-1.0, -side, 0.0]))
    part.after(0.3, LEVEL, REST)
    assert part.wrench(now)[1] == pytest.approx(moment)


def tilt_of(part, state, time=1.0):
    out = part.measured(time, state, 1.0)
    assert np.array_equal(np.delete(out, range(6, 10)), np.delete(state, range(6, 10)))
    return (Rotation.from_quat(state[6:10]).inv() * Rotation.from_quat(out[6:10])).as_euler('ZYX')


def test_each_tag_has_a_tilt_of_its_own_and_a_filter_goes_from_one_to_the_next():
    part, state = part_of(Tagged), HANGING.copy()
    state[6:10] = Rotation.from_euler('ZYX', [0.7, 0.2, -0.1]).as_quat()
    state[:3] = 0.2, -0.3, 1.0
    first = tilt_of(part, state) / part.angles[::-1]
    assert first == pytest.approx(part.floor[0, -1])
    state[:3] = 0.01, -0.01, 5.0        # over the same tag
    assert tilt_of(part, state, 2.0) / part.angles[::-1] == pytest.approx(first)
    state[1] = 0.01
    later = tilt_of(part, state, 2.0 + part.TIME) / part.angles[::-1]
    assert later == pytest.approx(part.floor[0, 0] + (first - part.floor[0, 0]) / np.e)
    assert tilt_of(part, state, 9.0) / part.angles[::-1] == pytest.approx(part.floor[0, 0])
    assert np.abs(part.floor - 1.0).max() <= part.SWING
    assert part.floor.mean() == pytest.approx(1.0, abs=0.1)


def test_a_sonar_calls_at_each_echo_and_each_call_is_taken_for_a_turn():
    part, state, biases = part_of(Pinged), HANGING.copy(), []
    heights = np.array([0.2, 0.5, 1.0, 2.0])
    for state[2] in heights:
        out = part.measured(0.0, state, 1.0)
        assert np.array_equal(out[:10], state[:10])
        biases.append(out[10:] @ part.bias / (part.bias @ part.bias))
        assert out[10:] == pytest.approx(biases[-1] * part.bias)
    # The time between calls: that of the way there and back, and a rest.
    between = part.MORE / (np.array(biases) - part.OWN)
    waits = part.RESTS + 2.0 * heights / part.SOUND
    assert between == pytest.approx(waits / waits[2])
    # Leaning by 60 degrees, it looks twice as far.
    state[2], state[6:10] = 1.0, Rotation.from_euler('x', np.pi / 3.0).as_quat()
    assert part.measured(0.0, state, 1.0)[10:] == pytest.approx(biases[-1] * part.bias)


@pytest.mark.slow
def test_a_turret_turns_the_body_back_and_leaves_neither_momentum_nor_force():
    weight, radius = 9.81 * PARAMS['mass'], PARAMS['rotor_radius']
    part = outside.Turret(2.0, weight, radius, np.random.default_rng(1))
    part.begin(np.random.default_rng(2))
    step, moments = 0.0005, []
    times = np.arange(0.0, 20.0, step)
    for t in times:
        force, moment = part.wrench(still(time=t)) or (REST, REST)
        assert not np.any(force)
        moments.append(moment)
    # The angular momentum of the turret, and by how far it has turned.
    momentum = -step * np.cumsum(moments, axis=0)
    angles = step * np.cumsum(momentum, axis=0) / part.inertia
    count = np.count_nonzero(part.times + part.LASTS < 20.0)
    for k in range(count):
        at = int((part.times[k] + part.LASTS + 0.01) / step)
        assert angles[at] == pytest.approx(part.turns[:k + 1].sum(axis=0), abs=0.02)
        assert momentum[at] / part.inertia == pytest.approx(REST, abs=0.02)
    assert count > 10 and np.abs(part.turns[:, 2]).max() <= 2.0 * part.PANS
    assert outside.Turret(0.0, weight, radius, None).inertia == 0.0
