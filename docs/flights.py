# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Draw docs/flights.png, the trajectories as flown (python docs/flights.py)."""

from pathlib import Path

import matplotlib

from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.trajectories import plan, TRAJECTORIES
from quad_ident_ros.model.vehicle import load_vehicle

DURATION, SEED = 20.0, 1
FLAT = ('circle', 'figure8', 'lissajous')
EFFECTS = {'motor_lag': {'time_constant': 0.03}, 'rotor_drag': {'coefficient': 0.1},
           'wind': {'x': 2.0}}


def main():
    """Fly all trajectories with some effects and draw them beside what was asked for."""
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt

    vehicle = load_vehicle('hummingbird')
    figure, panels = plt.subplots(3, 4, figsize=(11, 7.5), layout='constrained')
    for panel, name in zip(panels.flat, TRAJECTORIES, strict=False):
        record = fly_closed_loop(vehicle, EFFECTS, name, duration=DURATION, seed=SEED)
        wanted, *_, yaw, _ = plan(name, vehicle, DURATION, SEED)(record.t)
        flown = record.stack('px', 'py', 'pz')
        if name in FLAT:
            panel.plot(wanted[:, 0], wanted[:, 1], color='0.6', lw=3)
            panel.plot(flown[:, 0], flown[:, 1], color='tab:blue', lw=1)
            panel.set_aspect('equal', 'datalim')
            panel.set_xlabel('x (m)')
            panel.set_ylabel('y (m)')
        elif name == 'chirp_yaw':
            panel.plot(record.t, yaw, color='0.6', lw=3)
            panel.plot(record.t, record.euler()[:, 2], color='tab:blue', lw=1)
            panel.set_xlabel('t (s)')
            panel.set_ylabel('yaw (rad)')
        else:
            for axis, colour in zip(range(3), ('tab:blue', 'tab:orange', 'tab:green'),
                                    strict=True):
                panel.plot(record.t, wanted[:, axis], color='0.6', lw=3)
                panel.plot(record.t, flown[:, axis], color=colour, lw=1, label='xyz'[axis])
            panel.set_xlabel('t (s)')
            panel.set_ylabel('position (m)')
        panel.set_title(name, fontsize=10)
    legend = panels.flat[-1]
    legend.axis('off')
    legend.plot([], color='0.6', lw=3, label='asked for')
    for name, colour in (('x, or all', 'tab:blue'), ('y', 'tab:orange'), ('z', 'tab:green')):
        legend.plot([], color=colour, lw=1, label=f'flown: {name}')
    legend.legend(loc='center', frameon=False)
    path = Path(__file__).with_name('flights.png')
    figure.savefig(path, dpi=80)
    print(path)


if __name__ == '__main__':
    main()
