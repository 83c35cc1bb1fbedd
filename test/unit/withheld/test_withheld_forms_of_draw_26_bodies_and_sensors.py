# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of inertia, rotors and sensors that the twenty-sixth draw flies, and a stranger."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import HANGING, HOVER, LEVEL, PARAMS, part_of, REST, still, turning

from withheld import outside
from withheld.constants import induced_velocity
from withheld.forms.detectors import Detecting
from withheld.forms.hosepipes import Pouring
from withheld.forms.latches import Unglued, Unlatched
from withheld.forms.nacelles import Tilting
from withheld.forms.savers import Banded
from withheld.forms.thermopiles import Infrared
from withheld.forms.toothing import Toothed
from withheld.forms.transmitters import Transmitting


def test_hoses_take_up_a_turn_and_brake_it_only_while_they_spray():
    part, rate, step = part_of(Pouring), np.array([0.5, -1.0, 0.2]), 0.001
    taken = REST
    for k in range(200):        # shut
        assert part.times[0] > 0.2
        force, moment = part.wrench(still(rate=rate, time=k * step))
        assert not np.any(force)
        taken = taken - step * moment
        part.after(step, LEVEL, REST)
    assert taken == pytest.approx(part.loads * rate, rel=0.03)
    for k, is_open in enumerate((False, True, False, True)):
        before = part.times[k] - 0.01
        _, moment = part.wrench(still(rate=rate, time=before))
        braked = -part.FLOWS * part.loads * rate if is_open else REST
        assert moment == pytest.approx(braked, abs=1e-2 * np.abs(part.loads).max())


def test_an_arm_reaches_out_by_what_its_length_leaves_beside_the_height():
    part, lift = part_of(Detecting), PARAMS['mass'] * 9.81
    for height in (0.2, 0.6, 1.0, 1.2):
        there = np.array([0.3, 0.4, height])
        now = turning(part, 1.0, 2.0, position=there)
        force, moment = part.wrench(now)
        reach = np.sqrt(1.0 - ((height - part.HEIGHT) / part.LENGTH) ** 2)
        x, y, _ = part.SWINGS * (reach - part.MIDDLE) * part.centre
        assert not np.any(force) and moment == pytest.approx(lift * np.array([-y, x, 0.0]))
    # Far up it hangs at its stop, and it gets there as fast as its motor.
    part = part_of(Detecting)
    turning(part, 1.0, 0.1, position=REST)
    assert part._arm == part.LEVEL
    turning(part, 1.0, 0.5, position=np.array([0.0, 0.0, 9.0]))
    assert part._arm == pytest.approx(0.5 * part.FAST)
    turning(part, 1.0, 1.0, position=np.array([0.0, 0.0, 9.0]))
    assert part._arm == part.STEEP


def test_a_rotor_beside_its_neighbour_lacks_what_the_wake_of_that_takes():
    part, induced = part_of(Unlatched), induced_velocity(PARAMS)
    places = still().places
    between = places[part.rotor] - places[part.other]
    assert np.linalg.norm(between) == pytest.approx(0.24)
    assert part.towards == pytest.approx(between[:2] / 0.24)

    def lost(own, other, flow=0.0):
        speeds = np.full(4, HOVER)
        speeds[[part.rotor, part.other]] = own * HOVER, other * HOVER
        air = np.array([*flow * induced * part.towards, 0.0])
        gain = part.gain(still(speeds=speeds, air=air))
        assert np.delete(gain, part.rotor) == pytest.approx(np.ones(3))
        return (1.0 - gain[part.rotor]) * own ** 2 / part.loss     # of the thrust in hover
    assert lost(1.0, 1.0) == pytest.approx(1.0)
    assert lost(0.8, 1.25) == pytest.approx(1.0)
    assert lost(1.0, 1.2, -0.6) == pytest.approx(1.2 * 1.5)     # the wake is blown onto it
    assert lost(1.0, 1.0, 0.5) == pytest.approx(0.5)
    assert lost(1.0, 1.0, 2.0) == 0.0 and lost(1.0, 1.0, -3.0) == pytest.approx(part.MOST)
    assert np.all(part.torque(still()) == 1.0)


def test_a_loose_magnet_lifts_at_a_speed_and_falls_at_a_lower_one():
    part, losses = part_of(Unglued), []
    turns = (1.0, 0.9, 1.1, 1.16, 1.1, 1.0, 0.97, 1.0)
    for turn in turns:
        now = turning(part, turn, 0.1)
        gain = part.gain(now)
        losses.append((1.0 - gain[part.rotor]) * turn ** 2 / part.loss)
        assert np.delete(gain, part.rotor) == pytest.approx(np.ones(3))
        assert np.array_equal(part.torque(now), gain)
    # While it rubs, the friction falls evenly with the square of the speed, to none.
    rubs = np.array([1, 1, 1, 0, 0, 0, 1, 1], bool)
    square = np.square(turns)
    wanted = (part.LIFTS ** 2 - square) / (part.LIFTS ** 2 - 1.0)
    assert losses == pytest.approx(np.where(rubs, wanted, 0.0), abs=1e-9)
    assert losses[0] == pytest.approx(1.0)


def test_rotors_that_tilt_turn_the_body_by_the_change_of_their_momentum():
    part, step = part_of(Tilting), 0.0005
    times = step * np.arange(6000)
    spins, rate = PARAMS['rotor_directions'], np.array([0.4, -0.3, 0.2])
    momenta, moments = [], []
    for t in times:
        speeds = HOVER * (1.0 + 0.1 * np.sin(3.0 * t) * (spins > 0))
        now = still(speeds=speeds, air=np.array([2.0 * np.sin(2.0 * t), 0.5, 0.1]), rate=rate)
        force, moment = part.wrench(now)
        assert not np.any(force)
        axis = np.array([np.sin(part._tilt), 0.0, np.cos(part._tilt)])
        momenta.append(part.inertia * (spins @ part._blades) * axis)
        moments.append(moment)
        part.after(step, LEVEL, REST)
    momenta, moments = np.array(momenta), np.array(moments)
    wanted = np.gradient(momenta, step, axis=0) + np.cross(rate, momenta)
    # After the shafts have yielded to how it begins.
    assert moments[200:-2] == pytest.approx(wanted[200:-2], abs=3e-3 * np.abs(wanted).max())


def test_servos_tilt_rotors_with_the_velocity_up_to_a_stop():
    part = part_of(Tilting)
    part.wrench(still())
    for ahead, tilt in ((1.0, part.TILTS), (9.0, part.MOST), (-9.0, -part.MOST)):
        before = part._tilt
        turning(part, 1.0, part.SERVO, air=np.array([ahead, 0.0, 0.0]))
        assert part._tilt == pytest.approx(tilt + (before - tilt) / np.e)
        turning(part, 1.0, 4.0, air=np.array([ahead, 0.0, 0.0]))
        assert part._tilt == pytest.approx(tilt)


def test_a_belt_is_a_spring_that_is_softer_with_a_slack_strand_and_jumps():
    part = part_of(Toothed)
    drag, stiff = part.SLOWS * HOVER, part.RATE ** 2

    def pulls(start, angle):
        part._pull = start * drag * np.ones(4)
        return part._turned(np.full(4, angle * drag / stiff))[0] / drag
    assert pulls(0.0, 0.6) == pytest.approx(0.6)
    assert pulls(0.0, -1.1) == pytest.approx(-part.SLACK - part.SOFT * 0.2)
    assert pulls(1.0, 0.4) == pytest.approx(1.0 + part.SOFT * 0.4)
    assert pulls(1.0, -1.0) == pytest.approx(0.9 - 0.8)      # 0.2 of the angle down to the kink
    for side in (1.0, -1.0):
        assert side * pulls(side * 1.7, side * 0.19) == pytest.approx(1.795)
        assert side * pulls(side * 1.7, side * 0.21) == pytest.approx(1.805 - part.LOSES)


def test_propellers_behind_belts_give_the_body_what_they_lose():
    part, given, step = part_of(Toothed), 0.0, 0.0025
    assert part.wrench(still())[1] == pytest.approx(REST, abs=1e-12)
    spins = PARAMS['rotor_directions']
    turns = 1.0 + 0.1 * (spins > 0)
    for _ in range(4000):
        force, moment = part.wrench(still(speeds=turns * HOVER))
        given += step * moment[2]
        part.after(step, LEVEL, REST)
    assert not np.any(force) and moment == pytest.approx(REST, abs=1e-7)
    assert part._blades == pytest.approx(turns * HOVER)
    assert given == pytest.approx(part.inertia * spins @ (part._blades - HOVER))


def test_a_banded_propeller_is_a_fixed_one_until_it_rocks():
    part = part_of(Banded)

    def lean(flow, turn=1.0):
        force, moment = part.wrench(still(
            air=np.array([0.0, flow, 0.3]), speeds=np.full(4, turn * HOVER)))
        assert not np.any(force) and moment[1:] == pytest.approx([0.0, 0.0])
        return -moment[0] / part.moment
    assert lean(0.5) == pytest.approx(0.5) and lean(part.ROCKS) == pytest.approx(part.ROCKS)
    assert lean(3.0) == pytest.approx(part.ROCKS + part.SOFT * (3.0 - part.ROCKS))
    # Faster rotors push more by as much flow, and rock earlier.
    holds = part.ROCKS * (1.0 - part.LIFTS * 0.44)
    assert lean(0.5, 1.2) == pytest.approx(0.6)
    assert lean(3.0, 1.2) == pytest.approx(holds + part.SOFT * (3.6 - holds))
    assert lean(3.0, 2.0) == pytest.approx(
        part.ROCKS * part.LEAST + part.SOFT * (6.0 - part.ROCKS * part.LEAST))
    assert lean(0.0) == 0.0


@pytest.mark.parametrize('heading', [0.0, 2.0])
def test_thermopiles_miss_a_share_of_every_lean_whatever_the_heading(heading):
    part, state = part_of(Infrared), HANGING.copy()
    assert abs(part.off) == 2.0 * part.MISSES
    part.angles = REST          # not askew
    for pitch, roll in ((0.2, 0.0), (0.0, -0.3)):
        state[6:10] = Rotation.from_euler('ZYX', [heading, pitch, roll]).as_quat()
        out = part.measured(1.0, state, 1.0)
        assert np.array_equal(np.delete(out, range(6, 10)), np.delete(state, range(6, 10)))
        seen = Rotation.from_quat(out[6:10]).as_euler('ZYX')
        leans = np.array([pitch, roll])
        assert seen == pytest.approx([heading, *(leans + part.off * np.sin(leans))])


def test_level_thermopiles_say_by_what_they_sit_askew():
    part = part_of(Infrared)
    out = part.measured(1.0, HANGING, 1.0)
    assert Rotation.from_quat(out[6:10]).as_euler('ZYX') == pytest.approx(part.angles[::-1])
    assert abs(part_of(Infrared, 50.0).off) == part.MOST


def test_a_transmitter_sends_by_the_square_of_the_distance_in_steps():
    part, state, shares = part_of(Transmitting), HANGING.copy(), []
    powers = np.array([1.0, 1.4, 1.6, 1.8, 1.2, 1.3, 1.1, 4.0, 1e4, 0.25])
    for power in powers:
        state[:3] = part.place + [0.0, 0.0, part.MIDDLE * np.sqrt(power)]
        out = part.measured(0.0, state, 1.0)
        assert np.array_equal(out[:10], state[:10])
        shares.append(out[10:] @ part.bias / (part.bias @ part.bias))
        assert out[10:] == pytest.approx(shares[-1] * part.bias)
    sent = (np.array(shares) - part.OWN) / (1.0 - part.OWN)
    assert sent == pytest.approx([1, 1, 1, 2, 2, 2, 1, 4, 8, 0.25])
    far = np.linalg.norm(part.place[:2])
    assert part.AWAY[0] <= far <= part.AWAY[1] and part.place[2] == part.HIGH


def test_a_spanned_rope_pulls_by_its_tension_and_by_how_much_longer_it_gets():
    weight = 9.81 * PARAMS['mass']
    part = outside.Roped(2.0, weight, np.random.default_rng(1))
    middle, (one, other) = part.ends.mean(axis=0), part.ends
    assert np.linalg.norm(one - other) == pytest.approx(part.SPAN) and one[2] == other[2]
    half = 0.5 * part.SPAN
    for far in (0.1, 0.8):
        aside = far * np.cross((one - other) / part.SPAN, [0.0, 0.0, 1.0])
        length = np.hypot(half, far)
        tension = 0.05 * weight * (1.0 + 2.0 * part.STIFF * (length - half))
        force = part.force(0.0, middle + aside, REST)
        assert force == pytest.approx(-2.0 * tension * aside / length)
        # For little it is a string's: of its tension, and by the cube.
        cube = 2.0 * 0.05 * weight / half * (far + part.STIFF * far ** 3 / half)
        assert np.linalg.norm(force) == pytest.approx(cube, rel=0.1 * far)
    along = middle + 0.3 * (one - other)
    assert part.force(0.0, along, REST) == pytest.approx(REST, abs=1e-12)
    force, moment = part.wrench(still(position=middle + [0.0, 0.0, 0.5]))
    assert force[2] < 0.0 and not np.any(moment)
    nothing = outside.Roped(0.0, weight, np.random.default_rng(1))
    assert not np.any(nothing.force(0.0, middle + 0.5, REST))
