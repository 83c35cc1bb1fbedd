# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How much each axis moves, and so what a flight can show at all."""

import numpy as np

from quad_ident_ros.data.quality.finding import Finding
from quad_ident_ros.data.quality.series import Grid
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.model.vehicle import Vehicle

LEAST = {'roll': 0.05, 'pitch': 0.05, 'yaw': 0.1, 'vertical': 0.1, 'horizontal': 0.3}
"""Least excitation: rms body rate, rad/s; rms vertical acceleration, m/s^2; speed, m/s."""

UNTOLD = {'roll': 'Ixx and roll moments', 'pitch': 'Iyy and pitch moments',
          'yaw': 'Izz and the torque coefficient', 'vertical': 'mass apart from thrust',
          'horizontal': 'drag'}


def excitation(record: FlightRecord) -> dict[str, float]:
    """
    Return the excitation of each axis that the record has the columns for, as LEAST has it.

    roll, pitch, yaw: rms of the smoothed body rate about its mean, rad/s; vertical: rms of the
    smoothed vertical acceleration, m/s^2; horizontal: 95 % quantile of the horizontal speed, m/s.
    """
    grid = Grid.of(record)
    if grid is None:
        return {}
    found: dict[str, float] = {}
    if record.has('wx', 'wy', 'wz'):
        rate = grid.smooth(grid.signal('wx', 'wy', 'wz'))[grid.good]
        found.update(zip(('roll', 'pitch', 'yaw'), rate.std(axis=0).tolist(), strict=True))
    if record.has('vx', 'vy', 'vz'):
        velocity = grid.signal('vx', 'vy', 'vz')
        found['vertical'] = float(grid.derivative(velocity[:, 2:])[grid.good].std())
        speed = np.linalg.norm(grid.smooth(velocity)[grid.good, :2], axis=1)
        found['horizontal'] = float(np.quantile(speed, 0.95))
    return found


def axes(record: FlightRecord, vehicle: Vehicle | None) -> list[Finding]:
    """Find axes that are hardly moved."""
    units = {'vertical': 'm/s^2', 'horizontal': 'm/s'}
    return [Finding('excitation', 'info', name,
                    f'the {name} axis is hardly excited ({value:.3f} {units.get(name, "rad/s")}): '
                    f'the flight says little about {UNTOLD[name]}',
                    f'add a flight that moves the {name} axis')
            for name, value in excitation(record).items() if value < LEAST[name]]
