# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Drag, wind, inflow, flapping and ground effect of other forms: what each does."""

from dataclasses import replace

import numpy as np
import pytest
from withheld_parts import instant, made, PARAMS, PLACES

from withheld.constants import AIR_DENSITY, GRAVITY
from withheld.forms import blades, floors, flows

INDUCED = np.sqrt(PARAMS['mass'] * GRAVITY / (8.0 * AIR_DENSITY * np.pi * 0.1 ** 2))     # m/s
STILL = {'rate': (0.0, 0.0, 0.0), 'turn': (1.0,) * 4}


def moving(x=0.0, y=0.0, z=0.0, **others):
    """Return an Instant without rates, with velocities over the induced one in hover."""
    return instant(velocity=tuple(INDUCED * np.array([x, y, z])), **STILL | others)


def test_the_drag_of_a_wake_comes_later():
    part = made('rotor_drag', 'trailing', 2.0)
    forces = []
    for k in range(300):
        now = moving(x=0.2 if k else 0.0)
        forces.append(part.wrench(now)[0][0])
        part.after(0.01, np.eye(3), np.zeros(3))
    full = -part.coefficient * 0.2 * INDUCED
    assert forces[0] == 0.0 and forces[1] == pytest.approx(0.4 * full)
    assert forces[-1] == pytest.approx(full, rel=1e-3)
    # Ten radii of the wake's own way.
    k = 1 + round(10.0 * 0.1 / INDUCED / 0.01)
    assert full - forces[k] == pytest.approx(0.6 * np.exp(-1.0) * full, rel=0.03)
    assert part.wrench(moving(z=1.0))[0][2] == 0.0


def test_round_arms_feel_what_flows_across_them():
    part = flows.Arms(2.0, PARAMS, np.random.default_rng(1))
    along, side, up = (part.wrench(moving(*v))[0] for v in (
        np.sqrt(0.5) * np.array([1.0, 1.0, 0.0]), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)))
    unit = -1.6 * part.coefficient * INDUCED ** 2
    # Along two arms of four, across the others; at 45 degrees to all of them.
    assert along == pytest.approx(0.5 * unit * np.sqrt(0.5) * np.array([1.0, 1.0, 0.0]))
    assert side == pytest.approx([0.5 * np.sqrt(0.5) * unit, 0.0, 0.0])
    assert up == pytest.approx([0.0, 0.0, unit])


def test_a_gear_that_is_retracted_takes_drag_with_it():
    part = made('body_drag', 'retracting', 2.0)
    before, midway, after = (part.wrench(moving(x=1.0, time=part.when + t))[0][0]
                             for t in (-0.1, 1.5, 3.1))
    assert after / before == pytest.approx(0.6 / 1.4)
    assert midway == pytest.approx(0.5 * (before + after))
    assert part.wrench(moving(x=2.0, time=0.0))[0][0] == pytest.approx(4.0 * before)


def test_a_jet_is_fastest_on_its_axis_and_slows_down_along_it():
    jet = made('wind', 'jet', 2.0)
    across = np.array([-jet.along[1], jet.along[0], 0.0])

    def share(on, beside):
        air = jet.wind(0.0, jet.place + on * jet.along + beside * across)
        assert np.cross(air, jet.mean) == pytest.approx(np.zeros(3), abs=1e-12)
        return air @ jet.mean / (jet.mean @ jet.mean)

    assert share(0.0, 0.0) == pytest.approx(1.5)
    assert share(2.0, 0.0) == pytest.approx(1.5 * 14.0 / 16.0)
    assert share(0.0, 0.11 * 14.0) == pytest.approx(1.5 * np.exp(-1.0)) and share(0.0, 6.0) < 1e-4


def test_vortices_pass_with_the_frequency_of_strouhal():
    street = made('wind', 'street', 3.0)
    speed = np.linalg.norm(street.mean)
    side = np.array([-street.mean[1], street.mean[0], 0.0]) / speed
    period = 1.5 / (0.2 * speed)
    times = np.arange(0.0, 10.0 * period, 0.01 * period)
    air = np.array([street.wind(t, np.zeros(3)) for t in times])
    assert air @ street.mean / speed == pytest.approx(np.full(len(times), speed))
    across = air @ side
    assert np.argmax(np.abs(np.fft.rfft(across))) == 10
    assert across.max() == pytest.approx(0.4 * speed, rel=1e-3)
    # Four fifths of the wind's speed carry them on.
    later = street.wind(1.0 + 0.5, 0.5 * 0.8 * street.mean)
    assert later == pytest.approx(street.wind(1.0, np.zeros(3)))


def test_a_climb_takes_thrust_of_a_stalled_propeller_only_from_a_speed_on():
    part = blades.Pitched(5.0, PARAMS, None)
    gain = {z: part.gain(moving(z=z))[0] for z in (-0.4, -0.2, 0.0, 0.2, 0.4)}
    assert gain[0.0] == pytest.approx(1.0)
    assert 0.0 < gain[-0.4] - 1.0 < 0.3 * (gain[0.0] - gain[0.2])
    assert gain[0.2] - gain[0.4] == pytest.approx(5.0 * 0.09 * 0.2, rel=0.05)
    assert part.gain(moving(x=0.5))[0] > 1.0


def test_the_induced_velocity_of_level_flight_is_that_of_momentum_theory():
    for forward in (0.0, 0.5, 1.0, 3.0):
        flow = blades.swept(forward)
        assert flow * np.hypot(flow, forward) == pytest.approx(1.0)


def test_a_descent_adds_hardly_any_thrust_where_a_climb_takes_some():
    part = blades.Descending(5.0, PARAMS, None)
    climb, rest, descent, forward = (part.gain(one)[0] - 1.0 for one in (
        moving(z=0.2), moving(), moving(z=-0.2), moving(x=1.0)))
    theory = np.sqrt(0.25 * 0.2 ** 2 + 1.0) + 0.1 - 1.0         # of flow through the disk
    assert climb == pytest.approx(-0.4 * theory) and rest == pytest.approx(0.0)
    assert 0.0 < descent < -0.3 * climb and forward > 0.0
    # The curve ends where momentum theory holds again.
    assert np.polyval(part.CURVE, -2.0) == pytest.approx(1.0, abs=0.05)


def test_the_thrust_of_blades_steps_where_the_flow_clings():
    part = made('thrust_scale', 'bubble', 3.0)
    below, middle, above = (part.gain(instant(turn=(x,) * 4))[0] for x in (
        0.6, part.middle, 1.4))
    assert middle == pytest.approx(1.0 + part.share)
    assert [above - middle, middle - below] == pytest.approx([0.0168, 0.0168], rel=1e-3)


def test_inflow_takes_from_the_moment_of_flapping():
    part = blades.ThroughFlow(3.0, PARAMS, None)
    slow, climb, descent, fast = (part.wrench(one)[1] / one.air[0] / part.moment for one in (
        moving(x=0.01), moving(x=0.01, z=0.2), moving(x=0.01, z=-0.2), moving(x=1.0)))
    assert slow == pytest.approx([0.0, 1.0, 0.0], abs=1e-3)
    assert [climb[1], descent[1]] == pytest.approx([1.0 - 0.8 * 0.2, 1.0 + 0.8 * 0.2], rel=1e-3)
    assert fast[1] == pytest.approx(1.0 + 0.8 * (1.0 - blades.swept(1.0)))
    side = part.wrench(moving(y=0.01))
    assert side[1][0] == pytest.approx(-0.01 * INDUCED * part.moment, rel=1e-3)
    assert not np.any(side[0])


def test_a_vortex_over_ground_takes_thrust_in_slow_forward_flight():
    part = floors.GroundVortex(3.0, PARAMS, None)
    rest, slow, fast, high = (part.gain(one)[0] - 1.0 for one in (
        moving(height=0.15), moving(x=0.9, height=0.15), moving(x=3.0, height=0.15),
        moving(height=2.0)))
    assert rest == pytest.approx(0.6 * np.exp(-0.8 * 1.5))
    assert -0.5 * rest < slow < -0.1 * rest and abs(fast) < 0.01 * rest and abs(high) < 1e-5


def test_a_cushion_of_air_builds_up_and_dies_away():
    part = made('ground_effect', 'slow_cushion', 2.0)
    gains = []
    for k in range(301):
        gains.append(part.gain(moving(height=0.1 if 1 <= k < 151 else 0.6))[0] - 1.0)
        part.after(0.01, np.eye(3), np.zeros(3))
    near, far = 0.24 / 1.5 ** 2, 0.24 / 6.5 ** 2
    assert [gains[0], gains[1]] == pytest.approx([far, far])
    assert near - gains[32] == pytest.approx(np.exp(-1.0) * (near - far), rel=0.05)
    assert gains[150] == pytest.approx(near, rel=0.02) and gains[300] < 1.3 * far


@pytest.mark.parametrize(('effect', 'form'), [
    ('rotor_drag', 'trailing'), ('ground_effect', 'slow_cushion')])
def test_what_takes_its_time_is_steady_from_the_beginning(effect, form):
    part, now = made(effect, form, 3.0), replace(moving(x=0.5), places=PLACES)
    first = np.append(part.wrench(now) or 0.0, part.gain(now))
    for _ in range(50):
        part.after(0.01, np.eye(3), np.zeros(3))
    assert np.append(part.wrench(now) or 0.0, part.gain(now)) == pytest.approx(first)
