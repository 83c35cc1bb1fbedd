# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Experiments: which model is flown, under which inputs, with which measurement noise."""

from dataclasses import dataclass, field, fields, replace

import numpy as np

from quad_ident_ros import __version__, resources, schema
from quad_ident_ros.data.record import ARM, FlightRecord
from quad_ident_ros.effects import registry
from quad_ident_ros.errors import InputError
from quad_ident_ros.excitation import excite
from quad_ident_ros.flight.fly import fly_closed_loop, LONGEST, MOST_SAMPLES, RATES, SHORTEST
from quad_ident_ros.flight.measure import Noise, SENSORS
from quad_ident_ros.flight.trajectories import TRAJECTORIES
from quad_ident_ros.identify.signals import OUTPUTS
from quad_ident_ros.model import attitude, mixing
from quad_ident_ros.model.simulate import (
    LONGEST_STEP,
    MODELS,
    omega_r_of,
    simulate,
    Simulation,
)
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.load import load_any_vehicle

INPUTS = ('U1', 'U2', 'U3', 'U4')
NOISE_UNITS = {'attitude': 'rad', 'altitude': 'm', 'position': 'm', 'velocity': 'm/s',
               'rate': 'rad/s'}

# A model of its own in experiment files: the vehicle under control, along trajectories.
CLOSED_LOOP = 'closed_loop'


@dataclass(frozen=True)
class Run:
    """
    One flight of an experiment: its name, length (s), excitations and outputs to identify.

    In closed loop it has a trajectory (of flight.trajectories), sensors (of flight.measure) and
    changes (time s, {effect: {parameter: value}}): what the vehicle has from then on in the place
    of what it had of these effects.
    """

    name: str
    duration: float
    inputs: dict = field(default_factory=dict)
    outputs: tuple = ()
    trajectory: str | None = None
    sensors: str = 'clean'
    changes: tuple = ()


@dataclass(frozen=True)
class Experiment:
    """
    A set of flights from rest.

    model: of MODELS, or CLOSED_LOOP; period s between samples; trim 'hover' (the weight on U1) or
    'zero'; altitude m at the start;
    omega_r 'zero', 'from_rotors' or rad/s; noise: standard deviation per channel (NOISE_UNITS).
    """

    name: str
    description: str
    model: str
    vehicle: Vehicle
    period: float
    trim: str
    altitude: float
    runs: tuple
    omega_r: object = 'zero'
    omega_r_sign: int = 1
    step: float | None = None
    noise: dict = field(default_factory=dict)

    def trim_input(self):
        """Return the inputs U1..U4 (4,) from which the excitations deviate."""
        return self.vehicle.hover_input if self.trim == 'hover' else np.zeros(4)

    def sample_times(self, run):
        """Return the sample times of a run, (N,) s from 0 to its duration."""
        return np.arange(int(np.floor(run.duration / self.period + 1e-9)) + 1) * self.period

    def input_signals(self, run):
        """Return the inputs U1..U4 of a run, (N, 4): trim plus excitations."""
        t = self.sample_times(run)
        signals = np.tile(self.trim_input(), (len(t), 1))
        for name, spec in run.inputs.items():
            where = f'experiment {self.name}, run {run.name}, {name}'
            signals[:, INPUTS.index(name)] += excite(where, spec, t)
        return signals

    def infeasible(self, run):
        """Say why no rotor speeds give the inputs of a run, or return None where some do."""
        if self.model == CLOSED_LOOP:
            return None
        return mixing.infeasibility(self.vehicle, self.input_signals(run), self.sample_times(run))

    def with_effects(self, effects, where='effects'):
        """Return the experiment whose vehicle has {effect: {parameter: value}}; InputError."""
        theta = registry.vector(effects, self.vehicle, where)
        return replace(self, vehicle=replace(self.vehicle, effects=registry.mapping(theta)))

    def check(self, noise):
        """Raise InputError where the runs cannot be flown with this noise (of NOISE_UNITS)."""
        for run in self.runs:
            if self.model == CLOSED_LOOP:
                _sensors(run, noise)
            else:
                self.input_signals(run)


def load_experiment(name_or_path, vehicle=None):
    """
    Return the experiment of a shipped name or of an experiment file.

    Args: vehicle: a name or path that replaces the experiment's own vehicle.
    Raises InputError that names file and key where the file does not describe an experiment.
    """
    path = resources.find('experiments', name_or_path)
    where = str(path)
    data = resources.read_yaml(path)
    required = ('name', 'model', 'vehicle', 'period', 'runs')
    schema.check_keys(where, data, [each.name for each in fields(Experiment)], required)
    model = schema.choice(f'{where}: model', data['model'], (*MODELS, CLOSED_LOOP))
    if model == CLOSED_LOOP:
        schema.check_keys(f'{where} (model {model})', data, (*required, 'description', 'noise'))
        data = {**data, 'trim': 'hover'}
    schema.check_keys(where, data, data, ('trim',))
    omega_r = data.get('omega_r', 'zero')
    if omega_r not in ('zero', 'from_rotors'):
        omega_r = schema.number(f'{where}: omega_r (zero, from_rotors or rad/s)', omega_r)
    step = data.get('step')
    if step is not None:
        step = schema.number(f'{where}: step', step, 0.0, exclusive=True)
    period = schema.number(f'{where}: period', data['period'], 0.0, exclusive=True)
    runs = data['runs']
    if not isinstance(runs, list) or not runs:
        raise InputError(f'{where}: runs: expected a list of runs')
    if model == CLOSED_LOOP:
        schema.number(f'{where}: period', period, 1 / RATES[1], 1 / RATES[0])
        runs = tuple(_closed_loop_run(f'{where}: runs[{i}]', run) for i, run in enumerate(runs))
    else:
        runs = tuple(_run(f'{where}: runs[{i}]', run, period, path.parent)
                     for i, run in enumerate(runs))
    if len({run.name for run in runs}) != len(runs):
        raise InputError(f'{where}: runs: two runs have the same name')
    noise = check_noise(f'{where}: noise', data.get('noise', {}))
    if model == CLOSED_LOOP:
        _sensors(runs[0], noise, f'{where}: noise')
    return Experiment(
        name=schema.name(f'{where}: name', data['name']),
        description=str(data.get('description', '')), model=model,
        vehicle=load_any_vehicle(vehicle) if vehicle else _vehicle(where, data['vehicle']),
        period=period,
        trim=schema.choice(f'{where}: trim', data['trim'], ('hover', 'zero')),
        altitude=schema.number(f'{where}: altitude', data.get('altitude', 0.0)),
        runs=runs, omega_r=omega_r,
        omega_r_sign=schema.choice(f'{where}: omega_r_sign', data.get('omega_r_sign', 1), (1, -1)),
        step=step, noise=noise)


def _vehicle(where, name):
    """Return the vehicle that an experiment file names; InputError that names the file."""
    try:
        return load_any_vehicle(name)
    except InputError as error:
        raise InputError(f'{where}: vehicle: {error}') from None


def _run(where, data, period, folder):
    schema.check_keys(where, data, ('name', 'duration', 'inputs', 'outputs'),
                      ('name', 'duration', 'inputs', 'outputs'))
    schema.check_keys(f'{where}: inputs', data['inputs'], INPUTS)
    duration = schema.number(f'{where}: duration', data['duration'], period)
    if duration / period > MOST_SAMPLES - 1:
        raise InputError(f'{where}: duration: {duration:g} s at {period:g} s a sample are more '
                         f'than {MOST_SAMPLES} samples; shorten it or lengthen the period')
    outputs = _outputs(where, data['outputs'])
    inputs = {name: _located(spec, folder) for name, spec in data['inputs'].items()}
    return Run(schema.name(f'{where}: name', data['name']), duration, inputs, outputs)


def _outputs(where, names):
    if not isinstance(names, list) or not names:
        raise InputError(f'{where}: outputs: expected a list of {", ".join(OUTPUTS)}')
    return tuple(schema.choice(f'{where}: outputs', name, OUTPUTS) for name in names)


def _closed_loop_run(where, data):
    schema.check_keys(where, data, ('name', 'duration', 'trajectory', 'sensors', 'changes',
                                    'outputs'),
                      ('name', 'duration', 'trajectory'))
    return Run(schema.name(f'{where}: name', data['name']),
               schema.number(f'{where}: duration', data['duration'], SHORTEST, LONGEST),
               outputs=_outputs(where, data['outputs']) if 'outputs' in data else (),
               trajectory=schema.choice(f'{where}: trajectory', data['trajectory'],
                                        tuple(TRAJECTORIES)),
               sensors=schema.choice(f'{where}: sensors', data.get('sensors', 'clean'),
                                     tuple(SENSORS)),
               changes=_changes(f'{where}: changes', data.get('changes', [])))


def _changes(where, entries):
    """Return ((time s, effects), ...) of the changes of a run; flight.fly checks the rest."""
    if not isinstance(entries, list):
        raise InputError(f'{where}: expected a list of changes, each with at (s) and effects')
    found = []
    for number, entry in enumerate(entries):
        here = f'{where}[{number}]'
        schema.check_keys(here, entry, ('at', 'effects'), ('at', 'effects'))
        schema.check_keys(f'{here}: effects', entry['effects'], registry.EFFECTS)
        found.append((schema.number(f'{here}: at', entry['at'], 0.0, exclusive=True),
                      entry['effects']))
    return tuple(found)


def _in_flight(effects, changes):
    """Return the changes with all that the vehicle has from each of them on."""
    found = []
    for time, changed in changes:
        effects = {**effects, **changed}
        found.append((time, effects))
    return tuple(found)


def _located(spec, folder):
    """Return a spec whose relative file counts from the folder of the experiment file."""
    if isinstance(spec, dict) and isinstance(spec.get('file'), str):
        return {**spec, 'file': str(folder / spec['file'])}
    return spec


def check_noise(where, noise):
    """Return the noise as floats per channel; raises InputError for an unknown channel."""
    schema.check_keys(where, noise, NOISE_UNITS)
    return {name: schema.number(f'{where}: {name}', value, 0.0) for name, value in noise.items()}


def fly(experiment, run, *, noise=None, seed=0, on_progress=lambda share: None):
    """
    Simulate one run of an experiment and measure it.

    Args: noise: standard deviations that replace the experiment's; seed of the noise, in closed
    loop of the trajectory too; on_progress as in simulate.
    Returns a Simulation whose record carries its provenance in `info`: the same seed gives the
    same bytes.
    """
    if experiment.model == CLOSED_LOOP:
        return _fly_closed_loop(experiment, run, experiment.noise if noise is None else noise,
                                seed)
    inputs = experiment.input_signals(run)
    t = experiment.sample_times(run)
    noise = experiment.noise if noise is None else noise
    info = {
        'name': f'{experiment.name}/{run.name}', 'experiment': experiment.name, 'run': run.name,
        'model': experiment.model, 'vehicle': experiment.vehicle.name,
        'outputs': list(run.outputs), 'trim': experiment.trim_input().tolist(),
        'initial': {'phi': 0.0, 'theta': 0.0, 'psi': 0.0, 'z': experiment.altitude},
        'starts_at_rest': True, 'unwrapped': True, 'infeasible': experiment.infeasible(run),
        'noise': dict(noise),
        'seed': seed, 'step': experiment.step or LONGEST_STEP[experiment.model],
        ARM: experiment.vehicle.arm_length,
        'version': __version__}
    omega_r = omega_r_of(experiment.omega_r, experiment.vehicle, inputs, t,
                         experiment.omega_r_sign)
    flight = simulate(experiment.vehicle, experiment.model, inputs, experiment.period,
                      omega_r=omega_r, altitude=experiment.altitude, step=experiment.step,
                      info=info, on_progress=on_progress)
    # Each run has a stream of its own, so that a run's noise does not depend on the others.
    stream = np.random.default_rng([seed, experiment.runs.index(run)])
    info = {**info, 'status': flight.status, 'end_time': flight.end_time}
    record = measure(flight.record, noise, stream)
    return type(flight)(FlightRecord(record.t, record.columns, info), flight.status,
                        flight.end_time)


def _fly_closed_loop(experiment, run, noise, seed):
    # Each run has a seed of its own, so that two runs of one trajectory are two flights.
    own = int(np.random.SeedSequence([seed, experiment.runs.index(run)]).generate_state(1)[0])
    nominal = replace(experiment.vehicle, effects={})
    record = fly_closed_loop(nominal, experiment.vehicle.effects, run.trajectory,
                             duration=run.duration, rate=1.0 / experiment.period, seed=own,
                             noise=_sensors(run, noise),
                             changes=_in_flight(experiment.vehicle.effects, run.changes))
    commands = record.stack(*(f'cmd{j}' for j in range(1, len(nominal.rotors) + 1)))
    inputs = commands ** 2 @ mixing.allocation_matrix(nominal).T
    columns = {**record.columns, **dict(zip(('u1', 'u2', 'u3', 'u4'), inputs.T, strict=True)),
               **dict(zip(('phi', 'theta', 'psi'), record.euler().T, strict=True))}
    # Only the simulator knows the effects of the vehicle: a diagnosis must not see them.
    info = {'name': f'{experiment.name}/{run.name}', 'experiment': experiment.name,
            'run': run.name, 'model': experiment.model, 'vehicle': nominal.name,
            **({'outputs': list(run.outputs)} if run.outputs else {}),
            'trajectory': run.trajectory, 'sensors': run.sensors, 'noise': dict(noise),
            'trim': experiment.trim_input().tolist(), 'starts_at_rest': False,
            'unwrapped': True, 'infeasible': None, 'seed': seed, 'status': 'complete',
            ARM: nominal.arm_length,
            'end_time': float(record.t[-1]), 'version': __version__}
    return Simulation(FlightRecord(record.t, columns, info), 'complete', float(record.t[-1]))


def _sensors(run, noise, where='noise of a flight in closed loop'):
    """Return the Sensors of a run in closed loop with other white noise; raises InputError."""
    schema.check_keys(where, noise, [each.name for each in fields(Noise)])
    sensors = SENSORS[run.sensors]
    return replace(sensors, white=replace(sensors.white, **noise))


def measure(record, noise, random):
    """
    Return the record with white Gaussian noise added to its measured columns.

    Args: noise: standard deviation per channel of NOISE_UNITS; attitude noise is added to the
    Euler angles, and the quaternion is that of the noisy angles; random: a NumPy generator.
    """
    columns = dict(record.columns)

    def add(channel, names):
        draws = random.standard_normal((len(names), len(record)))
        for name, draw in zip(names, draws, strict=True):
            if noise.get(channel, 0.0) > 0:
                columns[name] = columns[name] + noise[channel] * draw

    add('position', ('px', 'py'))
    add('altitude', ('pz',))
    add('velocity', ('vx', 'vy', 'vz'))
    add('rate', ('wx', 'wy', 'wz'))
    draws = random.standard_normal((3, len(record)))
    if noise.get('attitude', 0.0) > 0:
        for name, draw in zip(('phi', 'theta', 'psi'), draws, strict=True):
            columns[name] = columns[name] + noise['attitude'] * draw
        euler = np.stack([columns[name] for name in ('phi', 'theta', 'psi')], axis=-1)
        quaternion = attitude.quaternion_from_euler(euler)
        columns.update(zip(('qw', 'qx', 'qy', 'qz'), quaternion.T, strict=True))
    return FlightRecord(record.t, columns, record.info)
