# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Rollouts of the vehicle with all effects: speed beside NumPy and rotorpy, memory, starts."""

import os
from pathlib import Path
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

from benchmarks import rollout_numpy
from benchmarks.machine import timed
from benchmarks.tables import markdown, number, targets
from docs.effects import flown
from quad_ident_ros.effects.registry import bounds, EFFECTS, NULL, PLACES, SLICES, vector
from quad_ident_ros.model.actuators import actuated
from quad_ident_ros.model.dynamics import Course, predict, states_of
from quad_ident_ros.model.rigid_body import INPUT, rotor_table, STATE, vehicle_vector
from quad_ident_ros.model.rollout import roll_out, roll_out_one
from quad_ident_ros.model.sensors import NO_GUIDE
from quad_ident_ros.model.vehicle import load_vehicle

SAMPLES, PERIOD, BATCH = 100, 0.01, 1024
LONGER = 10             # times the samples, for the memory
LEAST_STEPS, NUMPY_RATIO, ROTORPY_RATIO, FARTHEST = 2e6, 10, 200, 1e-9
MORE_MEMORY = 1024      # kB
SENSORS = ('attitude_misalignment', 'gyro_bias')    # they act on records, not in a rollout


class Problem:
    """Rollouts of the Iris with every effect at twice its usual size, from states of their own."""

    def __init__(self, samples=SAMPLES, batch=BATCH):
        random = np.random.default_rng(0)
        self.vehicle = load_vehicle('iris')
        self.theta = _with_everything(self.vehicle)
        self.t = PERIOD * np.arange(2 * samples + 1)
        hover = np.sqrt(self.vehicle.mass * self.vehicle.gravity
                        / (4 * self.vehicle.thrust_coefficient))
        changes = random.uniform(0.95, 1.05, (len(self.t) // 8 + 1, 4))
        commands = hover * np.repeat(changes, 8, axis=0)[:len(self.t)]
        self.acted = actuated(self.t, self.t, commands, self.theta[None])
        self.inputs = np.zeros((len(self.t), INPUT))
        self.inputs[:, 5] = 0.2 * self.t
        self.first = random.integers(0, samples, batch)
        self.x0 = np.zeros((batch, STATE))
        self.x0[:, 2], self.x0[:, 6] = 5.0, 1.0
        self.x0[:, 3:6] = random.normal(0, 1, (batch, 3))
        self.samples = samples
        self.out = np.full((batch, samples + 1, STATE), 1.0)    # written, to claim its memory

    def compiled(self, kernel):
        """Roll out by a compiled kernel into `out`."""
        kernel(vehicle_vector(self.vehicle)[None], rotor_table(self.vehicle), self.theta[None],
               np.zeros(len(self.x0), np.int64), self.x0, self.t, *self.acted, self.inputs,
               self.first, self.samples, 1, *NO_GUIDE, self.out)
        return self.out

    def in_numpy(self):
        """Return what plain NumPy rolls out."""
        return rollout_numpy.roll_out(self.vehicle, self.theta, self.x0, self.t,
                                      *(each[0] for each in self.acted[:3]), self.inputs[:, 5],
                                      self.first, self.samples)

    def speed(self, function, repeats):
        """Return the steps per second of CPU time, the median of so many calls after a first."""
        function()
        took = np.median([timed(function)[1] for _ in range(repeats)])
        return len(self.x0) * self.samples / took


def _with_everything(vehicle):
    sizes, theta = 2 * bounds(vehicle)[2], NULL.copy()
    for part in (*(SLICES[name] for name in EFFECTS if name not in SENSORS),
                 PLACES['battery_sag', 'time']):
        theta[part] += sizes[part]
    losses = SLICES['rotor_fault']
    theta[losses.start + 1:losses.stop] = 0.0
    return theta


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    problem = Problem()
    with bar('rollouts', 6) as advance:
        batch = problem.speed(lambda: problem.compiled(roll_out), size.rollouts)
        advance()
        alone = problem.speed(lambda: problem.compiled(roll_out_one), size.rollouts)
        advance()
        reference = problem.in_numpy()
        apart = float(np.abs(problem.compiled(roll_out) - reference).max())
        array = problem.speed(problem.in_numpy, max(1, size.rollouts // 7))
        advance()
        flights = _flights(size.rollouts)
        advance()
        with tempfile.TemporaryDirectory() as folder:
            starts = []
            for _ in range(2):
                starts.append(_start(folder))
                advance()
    (first, first_call, *_), (later, later_call, allocated, longer, grown) = starts
    ours, theirs, difference = flights
    ratio = None if theirs is None else theirs / ours
    goals = [
        ('steps per second, all effects', '≥ 2 million', number(batch), batch >= LEAST_STEPS),
        ('beside a batch in plain NumPy', f'≥ {NUMPY_RATIO} ×', f'{number(batch / array)} ×',
         batch / array >= NUMPY_RATIO),
        ('largest difference from it', f'≤ {FARTHEST:g}', f'{apart:.0e}', apart <= FARTHEST),
        ('beside rotorpy, the same flight', f'≥ {ROTORPY_RATIO} ×',
         'rotorpy is missing' if ratio is None else f'{number(ratio)} ×',
         ratio is not None and ratio >= ROTORPY_RATIO),
        (f'allocations, flights of {SAMPLES} and {SAMPLES * LONGER} samples', 'as many',
         f'{allocated:.0f}, {longer:.0f}', allocated == longer),
        ('more memory for the longer flights', '< 1 MB', f'{grown:.0f} kB', grown < MORE_MEMORY)]
    rows = [('compiled, many side by side', number(batch), '1'),
            ('compiled, one by one', number(alone), number(batch / alone)),
            ('plain NumPy, many side by side', number(array), number(batch / array))]
    same = [('compiled, by itself', number(1e3 * ours), '1'),
            ('rotorpy', number(None if theirs is None else 1e3 * theirs), number(ratio))]
    begun = [('import', number(first), number(later)),
             ('first rollouts', number(first_call), number(later_call))]
    tables = [targets(goals),
              markdown((f'{BATCH:,} rollouts of {SAMPLES} samples', 'steps per second', 'slower'),
                       rows),
              markdown(('one flight of 1 s', 'CPU, ms', 'slower'), same)]
    if difference is not None:
        tables.append(f'The two flights end {difference:.0e} m apart.')
    tables.append(markdown(('CPU time in s', 'first start, compiling', 'later, cached'), begun))
    return '\n\n'.join(tables)


def _flights(repeats):
    """Return the CPU time, s, of a flight of 1 s here and by rotorpy, and how far apart, m."""
    vehicle, record = flown('hummingbird')
    commands = np.repeat(record.stack('cmd1', 'cmd2', 'cmd3', 'cmd4'), 2, axis=0)[:SAMPLES + 1]
    course = Course(PERIOD * np.arange(SAMPLES + 1), commands, np.zeros(SAMPLES + 1))
    start = states_of(record)[:1]
    theta = vector(vehicle.effects, vehicle)

    def here():
        return predict(vehicle, theta, course, start, [0], SAMPLES)[0]

    here()
    ours = float(np.median([timed(here)[1] for _ in range(10 * repeats)]))
    try:
        from rotorpy.vehicles.hummingbird_params import quad_params
        from rotorpy.vehicles.multirotor import Multirotor
    except ImportError:
        return ours, None, None
    # Its defaults, with the flapping and the wind that the vehicle file has.
    hover = 4 * np.sqrt(vehicle.mass * vehicle.gravity / (4 * vehicle.thrust_coefficient))
    flapping = vehicle.effects['blade_flapping']['coefficient'] / hover
    peer = Multirotor({**quad_params, 'k_flap': flapping})
    wind = np.array(list(vehicle.effects['wind'].values()))

    def there():
        x = start[0]
        state = {'x': x[:3], 'v': x[3:6], 'q': x[[7, 8, 9, 6]], 'w': x[10:], 'wind': wind,
                 'rotor_speeds': commands[0]}
        for command in commands[:-1]:
            state = {**peer.step(state, {'cmd_motor_speeds': command}, PERIOD), 'wind': wind}
        return state

    last, _ = timed(there)
    theirs = float(np.median([timed(there)[1] for _ in range(max(1, repeats // 3))]))
    return ours, theirs, float(np.linalg.norm(last['x'] - here()[-1, :3]))


def _start(folder):
    done = subprocess.run([sys.executable, '-m', 'benchmarks.rollout'], capture_output=True,
                          text=True, check=True, env={**os.environ, 'NUMBA_CACHE_DIR': folder,
                                                      'NUMBA_NRT_STATS': '1'})
    return [float(value) for value in done.stdout.split()]


def _measure():
    """Print CPU times, s: until here, of the first call; allocations of two calls; kB between."""
    from numba.core.runtime import rtsys
    until = time.process_time()
    short, long = Problem(batch=64), Problem(SAMPLES * LONGER, batch=64)
    took = timed(short.compiled, roll_out)[1]

    def allocations(problem):
        before = rtsys.get_allocation_stats().alloc
        problem.compiled(roll_out)
        return rtsys.get_allocation_stats().alloc - before

    allocated = allocations(short)
    before = _resident()
    longer = allocations(long)
    print(until, took, allocated, longer, _resident() - before)


def _resident():
    """Return the memory of this process, kB."""
    pages = int(Path('/proc/self/statm').read_text(encoding='ascii').split()[1])
    return pages * resource.getpagesize() / 1024


if __name__ == '__main__':
    _measure()
