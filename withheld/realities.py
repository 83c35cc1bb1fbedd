# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Effects of any size, and the size at which one opens a gap so many times the noise's."""

from dataclasses import dataclass, field

import numpy as np

from withheld import outside
from withheld.actuators import Battery, Line, Motor
from withheld.constants import GRAVITY, hover_speed
from withheld.fly import fly, Lost
from withheld.forms import form_of
from withheld.gusts import Gusts
from withheld.influence import Influence
from withheld.logs import Charge, Logging
from withheld.nominal import Nominal, nominal_errors, rms
from withheld.plant import Reality

TRIES = 5
CLOSE = 0.1        # of the strength that was asked for
TOO_MUCH = 2.0     # times that strength: the vehicle is about to be lost


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
        'rotor_gyro': lambda s: {'rotor_inertia': 0.002 * s * params['Ixx']},
        'blade_flapping': lambda s: {'coefficient': 0.002 * s * mass * arm},
        'attitude_misalignment': lambda s: dict(zip(('roll', 'pitch', 'yaw'), 0.008 * s * along,
                                                    strict=True)),
        'gyro_bias': lambda s: dict(zip(xyz, 0.03 * s * direction, strict=True)),
    }
    return lambda s: {key: float(value) for key, value in shapes[name](s).items()}


LARGEST = {'motor_lag': 12.0, 'actuation_delay': 6.0, 'inertia_mismatch': 12.0,
           'rotor_gyro': 60.0, 'rotor_fault': 60.0, 'ground_effect': 12.0, 'battery_sag': 20.0}


@dataclass(frozen=True, eq=False)
class Setting:
    """
    What flights share beside the vehicle.

    told: rotorpy's parameters as the vehicle file has them; controller: of CONTROLLERS; logging:
    a Logging; floor m or None; fall: share of the voltage lost in 30 s where nothing sags;
    bodies: in MuJoCo; gusts: their size.
    """

    told: dict
    controller: str = 'geometric'
    logging: Logging = field(default_factory=Logging)
    floor: float | None = None
    fall: float = 0.03
    bodies: bool = False
    gusts: float = 0.0


# Sizes of what a vehicle has whose file is a data sheet: thrust off by 20 to 30 %, inertia by up
# to 30 %, a lag of 20 to 50 ms, drag of 0.15 to 0.4 of the mass per second.
DATASHEET = {'thrust_scale': lambda rng: rng.uniform(28.6, 42.8),
             'inertia_mismatch': lambda rng: rng.uniform(2.0, 2.6),
             'motor_lag': lambda rng: rng.uniform(1.7, 4.2),
             'rotor_drag': lambda rng: rng.uniform(2.0, 5.0)}


class World:
    """
    A reality as a thing that one can fly: a vehicle, its effects, and perhaps a stranger.

    sizes: {effect or stranger: size}; shapes: {effect: shape_of} of those that have the library's
    form; forms: {effect: form} of the others; seed draws what forms and strangers are like.
    """

    def __init__(self, params, setting, shapes, forms, sizes, seed=0):
        """Set the effects."""
        self.params, self.setting, self.seed = params, setting, seed
        self.effects = {name: shapes[name](size) for name, size in sizes.items()
                        if name in shapes and name not in forms}
        self.made = {name: (form_of(name, forms[name]), size) for name, size in sizes.items()
                     if name in forms}
        self.strangers = {name: size for name, size in sizes.items() if name in outside.KINDS}

    def parts(self):
        """Return the parts {effect or stranger: Part} that are no forms of the library's."""
        parts = {name: kind(size, self.params, self._rng(name))
                 for name, (kind, size) in self.made.items()}
        for name, size in self.strangers.items():
            kind, *by = outside.KINDS[name]
            measures = {'weight': self.params['mass'] * GRAVITY, 'mass': self.params['mass'],
                        'hover': hover_speed(self.params),
                        'radius': self.params['rotor_radius'],
                        'rotors': self.params['num_rotors']}
            parts[name] = kind(size, *(measures[one] for one in by), self._rng(name))
        if self.setting.gusts:
            parts['gusts'] = Gusts(self.setting.gusts, self.params, self._rng('gusts'))
        return parts

    def _rng(self, name):
        return np.random.default_rng([self.seed, *name.encode()])

    def reality(self, rng, charge=1.0):
        """Return the Reality of one flight; charge is the factor on its thrust, rng its own."""
        parts = list(self.parts().values())
        flight = int(rng.integers(2 ** 31))
        for number, part in enumerate(parts):
            part.begin(np.random.default_rng([flight, number]))
        if charge != 1.0:
            parts.append(Charge(charge))
        sag = self.effects.get('battery_sag', {})
        battery = Battery(sag.get('share', self.setting.fall), sag.get('exponent', 0.0))

        def only(kind, otherwise=None):
            return next((part for part in parts if isinstance(part, kind)), otherwise)

        arguments = (
            self.params, self.effects, [part for part in parts if isinstance(part, Influence)],
            only(Line), only(Motor), only(Battery, battery), self.setting.floor)
        options = {key: value for part in parts for key, value in part.bodies().items()}
        if not (self.setting.bodies or options):
            return Reality(*arguments)
        from withheld.bodies import Bodies  # MuJoCo takes a second to load
        return Bodies(*arguments, **options)

    def fly(self, path, seconds, step, noise, rng, voltage, charge=1.0):
        """Return the Flown along a path."""
        setting, reality = self.setting, self.reality(rng, charge)
        return fly(reality, setting.told, path, seconds, step, noise, rng, self._sensors(),
                   voltage, setting.controller, setting.logging)

    def _sensors(self):
        tilt, bias = (self.effects.get(name, {}) for name in ('attitude_misalignment',
                                                              'gyro_bias'))
        return {'tilt': np.array([tilt.get(key, 0.0) for key in ('roll', 'pitch', 'yaw')]),
                'bias': np.array([bias.get(key, 0.0) for key in 'xyz'])}


def gaps_of(flown, params, span=None):
    """
    Return the RMS errors of the nominal model by group: of exact states, of noise, of measured.

    Args: span (begin, end), s: what is not on the floor; None for all of the flight.
    """
    model = Nominal(params)
    rows = slice(None) if span is None else slice(*(round(t / flown.step) for t in span))
    commands = flown.commands[rows]
    exact = nominal_errors(model, flown.exact[rows], commands, flown.step)
    measured = nominal_errors(model, flown.measured[rows], commands, flown.step)
    return rms(exact), rms(measured - exact), rms(measured)


def strength_of_gap(flown, params):
    """Return how many times the gap of the noise the nominal model misses a flight by."""
    gap, alone, _ = gaps_of(flown, params)
    return gap['velocity'] / alone['velocity']


def size_of(flown_of, params, strength, largest):
    """
    Return the size at which the gap is `strength` times the noise's, and the strength reached.

    Args: flown_of(size) the Flown, or raises Lost; largest size that may be. Raises Lost where
    none of the sizes tried can be flown, or all of them are far too strong; an effect may remain
    weaker than asked.
    """
    size, best = min(strength, largest), None
    for _ in range(TRIES):
        try:
            reached = strength_of_gap(flown_of(size), params)
        except Lost:
            largest = 0.7 * size
            size = 0.5 * size
            continue
        if best is None or abs(np.log(reached / strength)) < abs(np.log(best[1] / strength)):
            best = size, reached
        if abs(reached / strength - 1.0) < CLOSE or (size >= largest and reached < strength):
            break
        size = min(largest, size * float(np.clip(strength / reached, 0.1, 10.0)))
    if best is None or best[1] > TOO_MUCH * strength:
        raise Lost
    return best
