# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The demo of the gap: three nodes fly, record and diagnose a reality with a hidden effect."""

from dataclasses import dataclass
from pathlib import Path
import time

from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import CLOSED_LOOP, load_experiment
from quad_ident_ros.flight.hidden_effect import draw_reality
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.nodes.demo import prepared, recording_of, watch, Watcher

NOMINAL, REALITY = 'nominal.yaml', 'reality.yaml'


@dataclass(frozen=True)
class GapOutcome:
    """
    What the demo gave: the diagnosis as data, and the effects in truth.

    folder: that of the run; nominal: path of the vehicle file that the diagnosis was given;
    recording: folder.
    """

    diagnosis: dict
    effects: dict
    folder: str
    nominal: str
    recording: str
    seconds: float
    samples: int
    dropped: int

    @property
    def found(self):
        """Whether the verdict is the truth."""
        return set(self.diagnosis['verdict']) == set(self.effects)


def run_gap_demo(options, on_progress):
    """
    Fly, record and diagnose a reality in three processes; return a GapOutcome.

    Only the simulator gets the file with the hidden effect; the diagnoser knows the nominal
    vehicle and the recorder's records. Args: as those of demo.run_demo. Raises
    InputError where a node fails or refuses.
    """
    started = time.monotonic()
    experiment = load_experiment(options.experiment)
    if experiment.model != CLOSED_LOOP:
        raise InputError(f'--experiment {options.experiment}: --gap needs flights in closed loop '
                         f'(model: {CLOSED_LOOP}), which excite the effects')
    folder = prepared(options.output)
    output = folder.resolve()
    nominal, reality = output / NOMINAL, output / REALITY
    write_vehicle(nominal, experiment.vehicle)
    write_vehicle(reality, draw_reality(experiment.vehicle, options.seed))
    file = Path(options.experiment)
    watcher = Watcher(len(experiment.runs), 'diagnoser', 'diagnosis', on_progress)
    watch(watcher, {
        'diagnoser': {'vehicle': str(nominal)},
        'recorder': {'output': str(output)},
        'simulator': {'experiment': str(file.resolve()) if file.is_file() else options.experiment,
                      'vehicle': str(reality), 'seed': options.seed,
                      'real_time_factor': float(options.real_time_factor)},
    }, output / 'log')
    recording = recording_of(watcher.statistics, folder)
    return GapOutcome(watcher.result, load_vehicle(reality).effects, str(folder),
                      str(folder / NOMINAL), str(recording),
                      time.monotonic() - started, watcher.statistics['joined'],
                      watcher.statistics['missing'])
