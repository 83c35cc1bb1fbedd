# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Effects of any size, and the size at which one opens a gap so many times the noise's."""

import numpy as np

from withheld import outside
from withheld.fly import fly, Lost
from withheld.nominal import Nominal, nominal_errors, rms
from withheld.plant import Reality
from withheld.vehicles import GRAVITY, hover_speed

TRIES = 5
CLOSE = 0.1        # of the strength that was asked for


def shape_of(name, params, rng):
    """
    Return how an effect's parameters grow: a function size -> {parameter: value}.

    What does not depend on the size (which rotor, which direction) is drawn here. Size 1 is
    about strength 1; a size is at most LARGEST.
    """
    mass, arm = params['mass'], float(np.linalg.norm(list(params['rotor_pos'].values())[0]))
    sign = rng.choice([-1.0, 1.0])
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    along = np.array([*(rng.choice([-1.0, 1.0], 2) * rng.uniform(0.3, 1.0, 2)),
                      rng.uniform(-0.3, 0.3)])
    share = rng.uniform(0.5, 1.5)
    rotor = int(rng.integers(1, params['num_rotors'] + 1))
    inertia = rng.uniform(0.4, 1.0, 3) * sign
    xyz = 'xyz'
    shapes = {
        'motor_lag': lambda s: {'time_constant': 0.012 * s},
        'actuation_delay': lambda s: {'delay': 0.012 * s},
        'rotor_drag': lambda s: {'coefficient': 0.08 * s * mass},
        'body_drag': lambda s: {'horizontal': 0.08 * s * mass,
                                'vertical': 0.08 * s * share * mass},
        'wind': lambda s: dict(zip(xyz, 0.7 * s * along, strict=True)),
        'inflow': lambda s: {'axial': 0.1 * s * mass, 'translational': 0.03 * s * share * mass},
        'ground_effect': lambda s: {'strength': 1.0 * s},
        'battery_sag': lambda s: {'exponent': 2.0, 'share': 0.01 * s},
        'thrust_scale': lambda s: {'factor': 1.0 + 0.007 * s * sign},
        'mass_offset': lambda s: {'mass': 0.007 * s * sign * mass},
        'inertia_mismatch': lambda s: {f'factor_{axis}': float(np.exp(0.1 * s * inertia[k]))
                                       for k, axis in enumerate(xyz)},
        'com_offset': lambda s: {axis: 0.002 * s * arm * along[k] for k, axis in enumerate(xyz)},
        'rotor_fault': lambda s: {f'loss_{rotor}': 0.005 * s},
        'rotor_gyro': lambda s: {'rotor_inertia': 0.01 * s * params['Ixx']},
        'blade_flapping': lambda s: {'coefficient': 0.002 * s * mass * arm},
        'attitude_misalignment': lambda s: dict(zip(('roll', 'pitch', 'yaw'), 0.008 * s * along,
                                                    strict=True)),
        'gyro_bias': lambda s: dict(zip(xyz, 0.03 * s * direction, strict=True)),
    }
    return lambda s: {key: float(value) for key, value in shapes[name](s).items()}


LARGEST = {'motor_lag': 12.0, 'actuation_delay': 6.0, 'inertia_mismatch': 12.0,
           'rotor_gyro': 60.0, 'rotor_fault': 60.0, 'ground_effect': 12.0, 'battery_sag': 20.0}


class World:
    """
    A reality as a thing that one can fly: a vehicle, its effects, and perhaps a stranger.

    sizes: {effect: size}; stranger: (kind, size) or None; stranger_seed draws what it is like.
    """

    def __init__(self, params, shapes, sizes, stranger=None, stranger_seed=0, fall=0.03):
        """Set the effects; fall is the share of the voltage lost in 30 s where nothing sags."""
        self.params = params
        self.effects = {name: shapes[name](size) for name, size in sizes.items()}
        self.stranger, self.stranger_seed = stranger, stranger_seed
        self.fall = self.effects.get('battery_sag', {}).get('share', fall)

    def fly(self, path, seconds, step, noise, rng, voltage):
        """Return the Flown along a path."""
        return fly(Reality(self.params, self.effects, self._stranger()), self.params, path,
                   seconds, step, noise, rng, self._sensors(), voltage, self.fall)

    def _stranger(self):
        if self.stranger is None:
            return None
        kind, size = self.stranger
        made, by = outside.KINDS[kind]
        measure = {'weight': self.params['mass'] * GRAVITY, 'mass': self.params['mass'],
                   'hover': hover_speed(self.params)}[by]
        return made(size, measure, np.random.default_rng(self.stranger_seed))

    def _sensors(self):
        tilt, bias = (self.effects.get(name, {}) for name in ('attitude_misalignment',
                                                              'gyro_bias'))
        return {'tilt': np.array([tilt.get(key, 0.0) for key in ('roll', 'pitch', 'yaw')]),
                'bias': np.array([bias.get(key, 0.0) for key in 'xyz'])}


def gaps_of(flown, params):
    """Return the RMS errors of the nominal model by group: with exact states, noise's alone."""
    model = Nominal(params)
    exact = nominal_errors(model, flown.exact, flown.commands, flown.step)
    measured = nominal_errors(model, flown.measured, flown.commands, flown.step)
    return rms(exact), rms(measured - exact), rms(measured)


def size_of(flown_of, params, strength, largest):
    """
    Return the size at which the gap is `strength` times the noise's, and the strength reached.

    Args: flown_of(size) the Flown, or raises Lost; largest size that may be. Raises Lost where
    none of the sizes tried can be flown.
    """
    size, best = min(strength, largest), None
    for _ in range(TRIES):
        try:
            gap, alone, _ = gaps_of(flown_of(size), params)
        except Lost:
            largest = 0.7 * size
            size = 0.5 * size
            continue
        reached = gap['velocity'] / alone['velocity']
        if best is None or abs(np.log(reached / strength)) < abs(np.log(best[1] / strength)):
            best = size, reached
        if abs(reached / strength - 1.0) < CLOSE or (size >= largest and reached < strength):
            break
        size = min(largest, size * float(np.clip(strength / reached, 0.1, 10.0)))
    if best is None:
        raise Lost
    return best
