# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights whose controller flies on an estimate."""

from collections import deque
from dataclasses import replace

import numpy as np

from withheld.constants import hover_speed
from withheld.controllers import CONTROLLERS
from withheld.estimator.estimate import Estimate
from withheld.estimator.line import Seldom
from withheld.estimator.low_pass import LowPass
from withheld.estimator.rotations import quaternion_of
from withheld.estimator.sensors import Sensors
from withheld.fly import FARTHEST, FASTEST, Flown, IDLE, INTEGRAL, Lost
from withheld.logs import Logging
from withheld.realities import World

BEFORE = 1.0        # s flown before the record begins: by then a filter has settled


def fly_on_estimate(reality, params, path, seconds, step, setup, rng, sensors,
                    full_voltage=12.6, controller='geometric', logging=None):
    """
    Return the Flown of a controller that flies on an estimate; raises Lost.

    Args as of fly.fly, but for setup: a Setup, in the place of the noise; of logging only the bits
    of a command count. sensors['bias'] is added to the recorded gyro: an autopilot that logs it
    without correction. sensors['tilt'] is that of the measured attitude, and where none is
    measured that of the whole sensor block. What the influences do to measurements they do to
    the estimate.
    """
    h = 1.0 / setup.imu.rate
    first, every, turns = (round(span / h) for span in (BEFORE, step, 1.0 / setup.control))
    late, assumed, pause = (round(span / h) for span in (setup.aid.latency, setup.assumed,
                                                         1.0 / setup.aid.rate))
    total = first + every * round(seconds / step)
    control, hover = CONTROLLERS[controller](params), hover_speed(params)
    reality.line = Seldom(reality.line, turns)
    rotors = params['num_rotors']
    aim, s = path.update(0.0), np.zeros(16 + rotors)
    s[0:3], s[3:6] = aim['x'], aim['x_dot']
    s[8:10] = np.sin(0.5 * aim['yaw']), np.cos(0.5 * aim['yaw'])
    s[16:] = hover
    on_board = Sensors(setup, reality.centre, sensors['tilt'], hover, rotors, rng)
    place = on_board.at(s)
    estimate = Estimate(place[0], place[1], place[2] @ on_board.tilt, np.zeros(3), np.zeros(3))
    filtered = setup.make_filter(estimate, setup.aid)
    smooth = LowPass(setup.cutoff, setup.order, setup.imu.rate, np.zeros(3))
    places, thoughts = deque([place], late + 1), deque([replace(estimate)], assumed + 1)
    rate, shift, given = np.zeros(3), np.zeros(3), np.full(rotors, hover)
    logged = {name: [] for name in ('states', 'speeds', 'exact', 'measured', 'commands',
                                    'voltage')}
    for k in range(total):
        t = k * h
        if not np.abs(s[10:13]).max() < FASTEST:
            raise Lost
        if k:
            after = on_board.at(s)
            gyro, force = on_board.imu(place, after, s[16:], h)
            filtered.propagate(gyro, force, h)
            rate, place = smooth(gyro) - estimate.gyro_bias + sensors['bias'], after
            places.append(place)
            thoughts.append(replace(estimate))
            if k >= late and (k - late) % pause == 0:
                filtered.correct(on_board.aid(places[0]), thoughts[0])
        reality.battery.drain(t, h, given / hover)
        recorded = k >= first and (k - first) % every == 0
        if recorded or k % turns == 0:
            thrust = float(np.mean((given / hover) ** 2))
            measured = np.concatenate([estimate.position, estimate.velocity,
                                       quaternion_of(estimate.rotation), rate])
            exact = on_board.exact(s[:13], place, sensors['bias'])
            for one in reality.influences:
                measured, exact = (one.measured(t, x, thrust) for x in (measured, exact))
        if k % turns == 0:
            aim = path.update(t)
            away = measured[:3] - aim['x']
            if aim.get('idle'):
                given = np.full(rotors, IDLE * hover)
            elif not np.linalg.norm(away) < FARTHEST:
                raise Lost
            else:
                shift = np.clip(shift - INTEGRAL / setup.control * away, -2.0, 2.0)
                now = {'x': measured[:3] - shift, 'v': measured[3:6], 'q': measured[6:10],
                       'w': measured[10:]}
                given = np.clip(control.update(t, now, aim)['cmd_motor_speeds'], 0.05 * hover,
                                params['rotor_speed_max'])
        if recorded:
            for name, value in zip(logged, (s[:13], s[16:], exact, measured, given,
                                            full_voltage * reality.battery.ratio), strict=True):
                logged[name].append(value)
        s = reality.hold(s, given, h)
    logged = {name: np.array(values) for name, values in logged.items()}
    told = (logging or Logging()).logged(logged['commands'], params['rotor_speed_max'])
    return Flown(step=step, **logged | {'commands': told})


class EstimatedWorld(World):
    """A World whose flights are flown on an estimate; `setup` takes the place of the noise."""

    def __init__(self, *args, setup, **options):
        """Take a World's arguments, and a Setup."""
        super().__init__(*args, **options)
        self.setup = setup

    def fly(self, path, seconds, step, noise, rng, voltage, charge=1.0):
        """Return the Flown along a path; noise is not used."""
        setting, reality = self.setting, self.reality(rng, charge)
        return fly_on_estimate(reality, setting.told, path, seconds, step, self.setup, rng,
                               self._sensors(), voltage, setting.controller, setting.logging)
