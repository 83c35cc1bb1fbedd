# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Print what the integration step costs: the table in docs/paper.md (python docs/accuracy.py)."""

import numpy as np

from quad_ident_ros.model.simulate import simulate
from quad_ident_ros.model.vehicle import load_vehicle

STEPS = {'newton_euler': (1e-3, 1e-4), 'paper': (1e-4, 1e-5)}
OUTPUTS = ('phi', 'theta', 'psi', 'pz')


def main():
    """Simulate the unit steps with each step and compare with a quarter of the smallest."""
    vehicle, inputs = load_vehicle('paper_quadrotor'), np.ones((501, 4))
    for model, steps in STEPS.items():
        def last(step, model=model):
            columns = simulate(vehicle, model, inputs, 0.01, step=step).record.columns
            return np.array([columns[name][-1] for name in OUTPUTS])
        exact = last(steps[-1] / 4)
        for step in steps:
            errors = ', '.join(f'{name} {error:.0e}' for name, error
                               in zip(OUTPUTS, np.abs(last(step) - exact), strict=True))
            print(f'{model}, step {step:g} s: {errors}')


if __name__ == '__main__':
    main()
