# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Forms of thrust, ground, battery and mass that the twenty-second draw is the first to fly."""


import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from withheld_parts import drained, fresh, HOVER, instant, PARAMS, part_of, still, turning, WEIGHT

from withheld.constants import GRAVITY
from withheld.forms import (
    bellies,
    chambers,
    cyclorotors,
    extenders,
    lids,
    orchards,
    sprays,
    sulphur,
    winches,
)


def test_flow_from_ahead_lifts_rotors_across_more_than_that_from_behind():
    rotor = part_of(cyclorotors.Cycloidal)

    def change(*air):
        gains = rotor.gain(still(air=rotor.induced * np.array(air)))
        assert np.ptp(gains) == pytest.approx(0.0)
        return (gains[0] - 1.0) / 2.0

    for speed in (0.1, 0.5, 1.0):
        ahead, behind = change(speed, 0.0, 0.0), change(-speed, 0.0, 0.0)
        assert ahead - behind == pytest.approx(2.0 * rotor.CURVES * speed)
        assert 0.5 * (ahead + behind) == pytest.approx(rotor.LEVEL * speed ** 2 / (1 + speed ** 2))
        side = change(0.0, speed, 0.0)
        assert side == pytest.approx(change(0.0, -speed, 0.0)) and side < 0.0
    assert change(0.0, 0.0, 0.0) == 0.0
    assert change(0.0, 0.0, 0.4) == pytest.approx(-0.4 * rotor.TAKES)


def test_flow_is_measured_by_what_a_rotor_moves_itself():
    for kind in (cyclorotors.Cycloidal, lids.Lidded):
        rotor, air = part_of(kind), np.array([0.8, -0.5, 0.3])
        slow = rotor.gain(still(air=air))
        fast = rotor.gain(still(air=1.2 * air, speeds=np.full(4, 1.2 * HOVER)))
        assert fast == pytest.approx(slow)


def test_a_plate_above_is_held_up_until_flow_from_the_side_fills_the_gap():
    rotor, losses = part_of(lids.Lidded), []
    for speed in (0.0, rotor.WIDE, 1.0, 2.0):
        here = [rotor.gain(still(air=speed * rotor.induced * np.array(
            [np.cos(angle), np.sin(angle), 0.0])))[0] for angle in (0.0, 1.0, 4.0)]
        assert np.ptp(here) < 1e-12
        losses.append((1.0 - here[0]) / 2.0)
    assert losses[:2] == pytest.approx([0.0, 0.5 * rotor.HOLDS])
    assert np.all(np.diff(losses) > 0.0) and losses[-1] == pytest.approx(rotor.HOLDS, rel=0.05)


def test_a_plate_above_takes_from_what_a_climb_changes():
    rotor = part_of(lids.Lidded)
    up, down = ((rotor.gain(still(air=np.array([0.0, 0.0, z * rotor.induced])))[0] - 1.0) / 2.0
                for z in (0.3, -0.3))
    assert down == pytest.approx(0.3 * rotor.TAKES)
    assert up == pytest.approx(-rotor.BEHIND * down)


def test_a_belly_rides_on_what_flight_presses_below_it():
    part = part_of(bellies.Rammed)

    def lift(x, y, height):
        now = still(air=np.array([x, y, 0.4]) * part.induced, heights=np.full(4, height))
        force, moment = part.wrench(now)
        assert not np.any(moment) and not np.any(force[:2])
        return force[2] / (2.0 * WEIGHT)

    near, far = 0.2, 0.5
    assert lift(0.0, 0.0, near) == 0.0
    for speed in (0.2, 0.5, 1.0):
        assert lift(speed, 0.0, near) == pytest.approx(lift(-speed, 0.0, near))
        assert lift(speed, 0.0, near) > lift(0.0, speed, near) > 0.0
        # It fades with the height alone.
        assert lift(speed, 0.0, near) / lift(speed, 0.0, far) == pytest.approx(
            np.exp(part.REACHES * (far - near) / part.radius))
    most = part.RAM * np.exp(-part.REACHES * near / part.radius)
    assert lift(part.FAST, 0.0, near) == pytest.approx(0.5 * most)
    assert lift(50.0, 0.0, near) == pytest.approx(most, rel=1e-3)
    # What the rotors have of the ground is that at rest.
    gain = 1.0 + 2.0 * part.HOVER * np.exp(-2.0 * part.FADES)
    for speed in (0.0, 3.0):
        flies = still(air=np.array([speed, 0.0, 0.0]), heights=np.full(4, near))
        assert part.gain(flies) == pytest.approx(np.full(4, gain))


def test_only_jets_that_are_strong_enough_tear_spray_from_water():
    part, losses = part_of(sprays.Sprayed), []
    # Where the jet of a rotor in hover tears no more.
    edge = -part.radius * np.log(part.TEARS) / part.JET
    for turn, height in ((1.0, 1.01 * edge), (1.0, 0.5 * edge), (1.2, 0.5 * edge), (1.2, edge)):
        part.begin(None)
        now = turning(part, turn, 6.0, heights=np.full(4, height))
        dry = 1.0 + 2.0 * part.GAIN * np.exp(-part.FADES * height / part.radius)
        losses.append((dry - part.gain(now)[0]) / (2.0 * part.TAKES))
    root = np.sqrt(part.TEARS)
    assert losses == pytest.approx([0.0, root - part.TEARS, 1.44 * root - part.TEARS,
                                    0.44 * part.TEARS], abs=1e-5)


def test_spray_comes_late_and_flight_leaves_it_behind():
    part, near = part_of(sprays.Sprayed), {'heights': np.full(4, 0.1)}
    first = part.gain(still(**near))
    assert first == pytest.approx(np.full(4, 1.0 + 2.0 * part.GAIN * np.exp(-part.FADES)))
    turning(part, 1.0, part.TIME, **near)
    all_of_it = np.exp(-part.JET) - part.TEARS
    assert part._spray == pytest.approx(np.full(4, (1.0 - np.exp(-1.0)) * all_of_it))
    turning(part, 1.0, 8.0, air=np.array([part.BEHIND * part.induced, 0.0, 0.0]), **near)
    assert part._spray == pytest.approx(np.full(4, 0.5 * all_of_it), rel=1e-4)
    turning(part, 1.0, 8.0, heights=np.full(4, 1.0))
    assert part._spray == pytest.approx(np.zeros(4), abs=1e-6)
    # Each rotor has its own.
    part.begin(None)
    turning(part, 1.0, 2.0, heights=np.array([0.1, 0.5, 0.1, 0.5]))
    assert part._spray[0] == part._spray[2] > 0.1 and not np.any(part._spray[[1, 3]])


def sagged(battery, loads, step=0.01):
    """Return the sags over the size, for loads over that in hover."""
    return (1.0 - drained(battery, np.power(loads, 1.0 / 3.0), step)) / battery.size


def test_cells_of_sulphur_step_to_a_lower_plateau_behind_a_dip():
    battery = part_of(sulphur.TwoPlateaus)
    sags = sagged(battery, np.ones(3000))
    taken = np.arange(1, 3001) / 3000
    plain = sags - battery.RESISTS - battery.FALLS * taken
    assert plain[0] == pytest.approx(0.0, abs=1e-4)
    assert plain[-1] == pytest.approx(battery.STEP, rel=1e-3)
    worst = taken[np.argmax(plain)]
    assert battery.FROM < worst < battery.FROM + 2.0 * battery.WIDE
    assert plain.max() > 1.5 * battery.STEP
    assert battery.gain(np.ones(4)) == pytest.approx(battery.ratio ** 1.8)


def test_cells_of_sulphur_resist_most_in_the_dip_and_go_by_the_charge():
    resists = []
    for charge in (0.0, sulphur.TwoPlateaus.FROM + sulphur.TwoPlateaus.WIDE, 1.0):
        battery = part_of(sulphur.TwoPlateaus)
        drained(battery, np.ones(round(3000 * charge)))
        low, high = sagged(battery, [0.5, 1.5], step=1e-6)
        resists.append(high - low)
    own = battery.RESISTS
    assert resists == pytest.approx([own, own * (1.0 + battery.MORE), own], rel=5e-3)
    slow, fast = part_of(sulphur.TwoPlateaus), part_of(sulphur.TwoPlateaus)
    one, other = sagged(slow, np.ones(2000))[-1], sagged(fast, np.full(1000, 2.0))[-1]
    assert slow._taken == pytest.approx(fast._taken)
    assert other - one == pytest.approx(own, rel=0.1)


def test_an_engine_starts_when_the_pack_is_low_and_stops_when_it_is_full():
    battery, taken, runs = part_of(extenders.Extended), [], []
    for k in range(12000):
        battery.drain(0.01 * k, 0.01, np.ones(4))
        taken.append(battery._taken), runs.append(battery._since is not None)
    taken, runs = np.array(taken), np.array(runs)
    starts = np.flatnonzero(np.diff(runs.astype(int)) == 1)
    stops = np.flatnonzero(np.diff(runs.astype(int)) == -1)
    assert len(starts) >= 4 and np.all(stops[:4] > starts[:4])
    assert taken[starts] == pytest.approx(np.full(len(starts), battery.LOW), abs=1e-3)
    assert taken[stops] == pytest.approx(np.full(len(stops), battery.FULL), abs=1e-3)
    # The first time by what hover takes alone.
    assert 0.01 * starts[0] == pytest.approx(30.0 * battery.LOW, abs=0.02)
    assert taken.max() < battery.LOW + 0.1 and taken.min() >= 0.0
    # Every round is as long, but for what steps of 0.01 s round off.
    rounds = np.diff(starts)
    assert np.ptp(rounds) < 0.005 * np.mean(rounds)


def test_a_starter_takes_before_the_engine_gives():
    battery = part_of(extenders.Extended)
    sags = sagged(battery, np.ones(1200))
    start = int(np.ceil(30.0 * battery.LOW / 0.01)) + 1
    rest = sags[start - 3] - battery.FALLS * battery.LOW
    cranks = sags[start + 5] - battery.FALLS * battery.LOW
    assert rest == pytest.approx(battery.RESISTS, rel=0.01)
    assert cranks == pytest.approx(battery.RESISTS * (1.0 + battery.STARTER), rel=0.02)
    assert sags[start + 300] < sags[start - 3]
    # Then it has the vehicle and fills the pack, by a time constant.
    since = 0.01 * 300 - battery.CRANKS
    gives = battery.GIVES * (1.0 - np.exp(-since / battery.TIME))
    assert battery._gives > gives > 1.0


def test_the_air_of_a_chamber_leaks_in_slowly_and_is_pumped_out_faster():
    part = part_of(chambers.Chambered)
    t = np.arange(0.0, 10.0 * (part.LEAKS + part.PUMPS), 0.01)
    missing = np.array([(part.density(one) - 1.0) / part.share for one in t])
    assert np.mean(missing) == pytest.approx(1.0, abs=1e-3) and part.share < 0.0
    assert [missing.min(), missing.max()] == pytest.approx(
        [1.0 - part.SWING, 1.0 + part.SWING], abs=2e-3)
    slopes = np.diff(missing) / 0.01
    leaks = np.mean(slopes < 0.0)
    assert leaks == pytest.approx(part.LEAKS / (part.LEAKS + part.PUMPS), abs=0.01)
    assert slopes.min() == pytest.approx(-2.0 * part.SWING / part.LEAKS)
    assert slopes.max() == pytest.approx(2.0 * part.SWING / part.PUMPS)
    for time in (0.0, 3.0, 6.0):
        now = instant(time=time)
        assert part.gain(now) == part.torque(now) == part.density(time)


def test_a_basket_fills_and_each_stem_pulls_until_it_breaks():
    part, mean = part_of(orchards.Picking), part_of(orchards.Picking).parameters['mass']
    t = np.arange(0.0, 40.0, 0.01)
    masses = np.array([part.mass(one) for one in t]) / mean
    assert masses[0] == pytest.approx(part.BASKET) and np.all(np.diff(masses) >= 0.0)
    assert masses[-1] == pytest.approx(part.BASKET + part.fruits.sum() / mean)
    assert np.mean(masses[t < 20.0]) == pytest.approx(1.0, abs=0.15)
    leans = Rotation.from_euler('xy', [0.3, -0.2]).as_matrix()
    for time, fruit in zip(part.times, part.fruits, strict=True):
        for before, share in ((part.PULLS + 0.01, 0.0), (0.5 * part.PULLS, 0.5), (1e-6, 1.0)):
            force, moment = part.wrench(still(time=time - before, rotation=leans))
            down = -share * part.BREAKS * fruit * GRAVITY
            assert leans @ force == pytest.approx([0.0, 0.0, down], abs=1e-6)
            assert not np.any(moment)
        assert not np.any(part.wrench(still(time=time))[0])
        assert part.mass(time) - part.mass(time - 1e-6) == pytest.approx(fruit)


def held(part, accelerations, step=0.01):
    """Return what a load takes of the thrust, over its mass, as the body accelerates upwards."""
    out = []
    for one in accelerations:
        part.after(step, np.eye(3), np.array([0.0, 0.0, one]))
        more = part.wrench(still())[0][2] / part.parameters['mass']
        out.append(GRAVITY + one - more)
    return np.array(out)


def test_a_clutch_holds_up_to_a_pull_and_lets_the_load_catch_up():
    part, true = part_of(winches.PayingOut), fresh()
    part.alter(true, PARAMS)
    assert true['mass'] == pytest.approx(PARAMS['mass'] + part.parameters['mass'])
    slips = part.SLIPS
    small = 0.9 * slips * np.sin(np.arange(0.0, 6.0, 0.01))
    assert held(part, small) == pytest.approx(GRAVITY + small)
    # Two m/s^2 more for half a second; then it goes on slipping until the speeds are the same.
    pulse = np.concatenate([np.full(50, slips + 2.0), np.zeros(300)])
    takes = held(part, pulse)
    until = 50 + round(0.5 * 2.0 / slips / 0.01)
    assert takes[:until] == pytest.approx(np.full(until, GRAVITY + slips))
    assert takes[until + 1:] == pytest.approx(np.full(len(pulse) - until - 1, GRAVITY))
    # No momentum is lost: in the end the load has the speed of the body.
    assert np.sum(takes - GRAVITY) == pytest.approx(np.sum(pulse))
    assert part._speed == 0.0


def test_a_load_whose_clutch_slips_hangs_along_the_body():
    part, leans = part_of(winches.PayingOut), Rotation.from_euler('x', 0.5).as_matrix()
    part.after(0.01, leans, 3.0 * leans[:, 2] + [0.0, 0.0, -GRAVITY] + GRAVITY * leans[:, 2])
    force, moment = part.wrench(still(rotation=leans))
    assert force == pytest.approx([0.0, 0.0, part.parameters['mass'] * (3.0 - part.SLIPS)])
    assert not np.any(moment)
