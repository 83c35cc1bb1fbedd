# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The experiments of the reproduction: four flights of ours, and the responses of Table 3."""

from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.experiment import fly, INPUTS, load_experiment
from quad_ident_ros.identify.signals import INPUT_OF, OUTPUTS
from quad_ident_ros.paper import reference, table3
from quad_ident_ros.paper.printed import DURATION

COLUMN = {'phi': 'phi', 'theta': 'theta', 'psi': 'psi', 'z': 'pz'}

# The long flight: sampled often enough to follow the yaw spin, then thinned to 1 s.
LONG_PERIOD = 0.05  # s
LONG_THINNED = 20


@dataclass(frozen=True)
class Reference:
    """A value that is known of a response: computed and expected, at t s, and from where."""

    output: str
    t: float
    computed: float
    expected: float
    source: str


@dataclass(frozen=True)
class Preset:
    """
    An experiment of the reproduction.

    records: FlightRecords to identify; references: known results for them; truth: (K, a, b) by
    output where the responses are of the model's class by construction.
    """

    name: str
    title: str
    records: tuple
    references: tuple = ()
    truth: dict | None = None

    @property
    def duration(self):
        """Length of the longest record, s."""
        return float(max(record.t[-1] for record in self.records))

    @property
    def infeasible(self):
        """Why no rotors could give these inputs, or None."""
        found = [record.info['infeasible'] for record in self.records
                 if record.info.get('infeasible')]
        return found[0] if found else None


def load_preset(name):
    """Return the Preset of a name in PRESETS, flown or computed."""
    return PRESETS[name](name)


def _single_axis(name):
    experiment = load_experiment(name)
    records = tuple(fly(experiment, run).record for run in experiment.runs)
    vehicle = experiment.vehicle
    references = []
    for record in records:
        output = record.info['outputs'][0]
        axis = OUTPUTS.index(output)
        column = int(INPUT_OF[output][1]) - 1
        step = record.inputs()[0, column] - record.info['trim'][column]
        end = record.t[-1]
        if output == 'z':
            expected = reference.climbed(step, vehicle.mass, vehicle.linear_drag[2], end)
        else:
            lever = 1.0 if output == 'psi' else vehicle.arm_length
            expected = reference.turned(lever * step, vehicle.inertia[axis],
                                        vehicle.rotational_drag[axis], end)
        computed = record.columns[COLUMN[output]][-1] - record.info['initial'][output]
        references.append(Reference(output, float(end), float(computed), expected, 'exact'))
    return Preset(name, experiment.description, records, tuple(references))


def _unit_steps(name):
    experiment = load_experiment(name)
    record = fly(experiment, experiment.runs[0]).record
    references = []
    for t, values in reference.UNIT_STEPS[experiment.model].items():
        k = int(np.argmin(np.abs(record.t - t)))
        references += [Reference(output, t, float(record.columns[COLUMN[output]][k]), value,
                                 'adaptive integrators')
                       for output, value in zip(OUTPUTS, values, strict=True)]
    return Preset(name, experiment.description, (record,), tuple(references))


def _unit_steps_long(name):
    experiment = load_experiment('paper_unit_steps_newton_euler')
    run = replace(experiment.runs[0], duration=DURATION)
    experiment = replace(experiment, period=LONG_PERIOD, runs=(run,))
    full = fly(experiment, run).record
    record = FlightRecord(full.t[::LONG_THINNED],
                          {name: values[::LONG_THINNED] for name, values in full.columns.items()},
                          full.info)
    title = (f'{experiment.description.replace("5 s", f"{DURATION:.0f} s")}. Yaw reaches its '
             'final speed within a sample: only K/a and b of its model are known, a ends at a '
             'bound of the search, and the ranking of the methods for yaw compares only bounds')
    return Preset(name, title, (record,))


def _table_3(name):
    t = table3.sample_times()
    columns = {COLUMN[output]: table3.step_response(*model)
               for output, model in table3.RESPONSES.items()}
    columns.update({name.lower(): np.ones(len(t)) for name in INPUTS})
    info = {'name': name, 'trim': [0.0] * len(INPUTS), 'starts_at_rest': True, 'unwrapped': True,
            'initial': dict.fromkeys(OUTPUTS, 0.0)}
    return Preset(name, "The four responses that the paper's Table 3 implies, "
                        f'{DURATION:.0f} s (not a flight)',
                  (FlightRecord(t, columns, info),), truth=dict(table3.RESPONSES))


PRESETS = {
    'hover_single_axis': _single_axis,
    'paper_unit_steps_printed': _unit_steps,
    'paper_unit_steps_newton_euler': _unit_steps,
    'paper_unit_steps_newton_euler_500s': _unit_steps_long,
    'small_angle': _single_axis,
    'paper_table3': _table_3,
}
