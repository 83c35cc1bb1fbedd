# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Some thirty small cases of diagnosis, flown by the library's own simulator with fixed seeds."""

from dataclasses import dataclass, replace

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle, Vehicle

COURSES = ('figure8', 'steps', 'lissajous')     # the last one is held out
LOW = ('figure8', 'low_passes', 'low_passes')
DURATION = 13.0     # s: long enough for every verdict, short enough for thirty of them


@dataclass(frozen=True)
class Case:
    """A name, the shipped vehicle, {effect: {parameter: value}} of the truth, noise, courses."""

    name: str
    vehicle: str
    truth: dict
    noise: str = 'mocap_imu'
    courses: tuple = COURSES

    def nominal(self) -> Vehicle:
        """Return the vehicle as its file says, with a drag without which no wind is felt."""
        vehicle = load_vehicle(self.vehicle)
        return replace(vehicle, linear_drag=(0.3 * vehicle.mass,) * 3)

    def flights(self) -> list[FlightRecord]:
        """Return its flights, the same ones at each call."""
        seed = 100 * [case.name for case in CASES].index(self.name)
        return [fly_closed_loop(self.nominal(), self.truth, course, duration=DURATION,
                                seed=seed + k, noise=SENSORS[self.noise])
                for k, course in enumerate(self.courses)]


def truths(vehicle: Vehicle) -> dict:
    """Return {effect: {parameter: value}} of each effect at a size that matters to a vehicle."""
    mass, arm, (inertia, *_) = vehicle.mass, vehicle.arm_length, vehicle.inertia
    return {
        'motor_lag': {'time_constant': 0.03}, 'actuation_delay': {'delay': 0.02},
        'rotor_drag': {'coefficient': 0.3 * mass},
        'body_drag': {'horizontal': 0.2 * mass, 'vertical': 0.2 * mass},
        'wind': {'x': 1.0, 'y': -0.7, 'z': 0.1},
        'inflow': {'axial': 0.4 * mass, 'translational': 0.1 * mass},
        'ground_effect': {'strength': 3.0}, 'battery_sag': {'per_second': 0.003},
        'thrust_scale': {'factor': 0.95}, 'mass_offset': {'mass': 0.06 * mass},
        'inertia_mismatch': {'factor_x': 1.4, 'factor_y': 1.3, 'factor_z': 1.4},
        'com_offset': {'x': 0.02 * arm, 'y': -0.015 * arm, 'z': 0.02 * arm},
        'rotor_fault': {'loss_2': 0.05}, 'rotor_gyro': {'rotor_inertia': 0.003 * inertia},
        'blade_flapping': {'coefficient': 0.1 * mass * arm},
        'attitude_misalignment': {'roll': 0.03, 'pitch': -0.02, 'yaw': 0.04},
        'gyro_bias': {'x': 0.04, 'y': -0.03, 'z': 0.05}}


def _case(vehicle: str, *effects: str, name: str | None = None, **settings) -> Case:
    truth = truths(load_vehicle(vehicle))
    if 'ground_effect' in effects:
        settings.setdefault('courses', LOW)
    return Case(name or '+'.join(effects), vehicle, {effect: truth[effect] for effect in effects},
                **settings)


CASES = (
    _case('hummingbird', name='none'),
    _case('crazyflie', name='none_crazyflie'),
    _case('iris', name='none_faulty', noise='faulty'),
    *(_case(('hummingbird', 'iris', 'crazyflie')[k % 3], effect)
      for k, effect in enumerate(truths(load_vehicle('hummingbird')))),
    _case('hummingbird', 'motor_lag', 'rotor_drag'),
    _case('iris', 'rotor_drag', 'battery_sag'),
    _case('crazyflie', 'mass_offset', 'motor_lag'),
    _case('hummingbird', 'com_offset', 'wind'),
    _case('iris', 'thrust_scale', 'inertia_mismatch'),
    _case('crazyflie', 'motor_lag', 'rotor_drag', 'battery_sag'),
    _case('hummingbird', 'mass_offset', name='mass_offset_faulty', noise='faulty'),
    _case('iris', 'motor_lag', name='motor_lag_faulty', noise='faulty'),
    _case('crazyflie', 'rotor_drag', 'com_offset', name='rotor_drag+com_offset_faulty',
          noise='faulty'),
    _case('hummingbird', 'thrust_scale', name='thrust_scale_in_hover', courses=('hover',) * 3),
    _case('iris', 'rotor_drag', name='rotor_drag_alone', courses=('lissajous',)),
)
