# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The paper's equations as printed, flown where they end in finite time."""

from dataclasses import dataclass, replace

from quad_ident_ros.experiment import fly, load_experiment, Run
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.paper.printed import DURATION
from quad_ident_ros.paper.reference import blow_up

SHORT = 5.0         # s
AXES = {'U2': 'phi', 'U3': 'theta', 'U4': 'psi'}
PRINTED, CORRECTED = 'paper_quadrotor', 'paper_quadrotor_izz_corrected'

# Omega_r of unit steps, rad/s, by how the squares below zero are read: magnitudes, set to zero,
# signed roots.
ROTORS = (61.45, 582.76, 1104.07)


@dataclass(frozen=True)
class Case:
    """
    A run of the printed equations, and how it ended.

    duration: s to be flown; expected: time of divergence, s, or None where it is not known; source
    says from where; status and end_time as in Simulation; derived: the status of the derived
    equations under the same inputs, for SHORT at most.
    """

    label: str
    vehicle: str
    duration: float
    expected: float | None
    source: str
    status: str
    end_time: float
    derived: str


def cases():
    """Return all Cases; each of them flies within a second."""
    return [*_single_axis(), *_unit_steps()]


def _single_axis():
    """Return the Cases of one input at a time from hover: their blow-up has an exact time."""
    plan = (('U4', 1.0, PRINTED), ('U4', 1.0, CORRECTED), ('U4', 0.1, PRINTED),
            ('U2', -1.0, PRINTED), ('U3', -1.0, PRINTED), ('U2', 1.0, PRINTED))
    found = []
    for name, size, vehicle in plan:
        experiment = replace(load_experiment('hover_single_axis', vehicle), model='paper')
        run = Run('case', SHORT, {name: {'type': 'step', 'amplitude': size}}, (AXES[name],))
        known, expected, source = experiment.vehicle, None, 'friction that slows'
        # In print the friction of yaw feeds energy in, that of roll and pitch for negative rates.
        if name == 'U4' or size < 0:
            axis = int(name[1]) - 2
            lever = 1.0 if name == 'U4' else known.arm_length
            expected = blow_up(lever * abs(size), known.inertia[axis],
                               known.rotational_drag[axis])
            source = 'exact'
        unit = 'N m' if name == 'U4' else 'N'
        found.append(_case(replace(experiment, runs=(run,)), f'{name} = {size:g} {unit} alone',
                           expected, source))
    return found


def _unit_steps():
    """Return the Cases of all four unit steps at once."""
    experiment = load_experiment('paper_unit_steps_printed')
    other = replace(experiment, vehicle=load_vehicle(CORRECTED))
    found = [_case(other, 'unit steps', 0.871, 'adaptive integrator')]
    for speed in ROTORS:
        known = (0.128, 'adaptive integrator') if speed == ROTORS[0] else \
            (None, 'stiff: depends on the step')
        found.append(_case(replace(experiment, omega_r=speed),
                           f'unit steps, Ωr = {speed:g} rad/s', *known))
    long = replace(experiment, runs=(replace(experiment.runs[0], duration=DURATION),))
    for step in (1e-5, 1e-4, 1e-3):
        found.append(_case(replace(long, step=step),
                           f'unit steps for {DURATION:.0f} s, integrated at {step:g} s', None,
                           'chaotic: depends on the step'))
    return found


def _case(experiment, label, expected, source):
    run = experiment.runs[0]
    flight = fly(experiment, run)
    # The equations derived correctly under the same inputs; a preset flies them for all 500 s.
    derived = replace(experiment, model='newton_euler', step=None,
                      runs=(replace(run, duration=min(run.duration, SHORT)),))
    return Case(label, experiment.vehicle.name, run.duration, expected, source, flight.status,
                flight.end_time, fly(derived, derived.runs[0]).status)
