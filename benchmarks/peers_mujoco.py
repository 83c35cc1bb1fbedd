# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The same vehicle in MuJoCo, and its constants by `mujoco.sysid`."""

import numpy as np

from benchmarks.flights import NAMES, NOISE, SAMPLES
from quad_ident_ros.model.dynamics import states_of

SENSORS = {'place': 'framepos', 'velocity': 'framelinvel', 'attitude': 'framequat', 'rate': 'gyro'}
BOX = (0.2, 5.0)    # bounds, times the start


def fit_default(record, vehicle):
    """Return NAMES but the mass (7,) of a flight as mujoco.sysid finds them by its defaults."""
    return _fit(record, vehicle, None)


def fit_weighted(record, vehicle):
    """Return the same with the residual over the standard deviation of the noise."""
    return _fit(record, vehicle, _over_noise)


def residual(record, vehicle):
    """Return the residuals of a flight with a vehicle's constants, over the noise."""
    problem, parameters = _problem(record, vehicle, _over_noise)
    return np.concatenate([part.ravel() for part in
                           problem(parameters.as_vector(), parameters)[0]])


def _fit(record, vehicle, modify):
    from mujoco import sysid
    problem, parameters = _problem(record, vehicle, modify)
    found, _ = sysid.optimize(parameters, problem, verbose=False)
    return found.as_vector()


def _problem(record, vehicle, modify):
    """Return the residual function of a flight cut into rollouts, and the parameters."""
    import mujoco
    from mujoco import sysid
    spec = _model(vehicle, record.period())
    model = spec.compile()
    commands = record.stack(*(f'cmd{j}' for j in range(1, len(vehicle.rotors) + 1))) ** 2
    # The last controls are those of the drag, which needs none.
    commands = np.concatenate([commands, np.zeros((len(commands), 2))], axis=1)
    commands = np.concatenate([commands, commands[-1:]])
    states = states_of(record)
    t = record.period() * np.arange(SAMPLES + 2)
    starts, controls, measured = [], [], []
    for first in range(0, len(record) - SAMPLES, SAMPLES):
        rows = states[first:first + SAMPLES + 1].copy()
        rows[:, 6:10] *= np.where(rows[:, 6:10] @ rows[0, 6:10] < 0, -1.0, 1.0)[:, None]
        starts.append(sysid.create_initial_state(
            model, np.concatenate([rows[0, :3], rows[0, 6:10]]),
            np.concatenate([rows[0, 3:6], rows[0, 10:]])))
        controls.append(sysid.TimeSeries.from_control_names(
            t, commands[first:first + SAMPLES + 2], model))
        # What a sensor reads before a step has the time after it there.
        measured.append(sysid.TimeSeries.from_names(t[1:], rows, model))
    sequences = sysid.ModelSequences('flight', spec, [f'rollout_{k}' for k in range(len(starts))],
                                     starts, controls, measured)
    parameters = sysid.ParameterDict()
    for name in NAMES[1:]:
        start = _value(vehicle, name)
        parameters.add(sysid.Parameter(name, start, BOX[0] * start, BOX[1] * start,
                                       modifier=_modifier(mujoco, vehicle, name)))
    # One core, as for everything that is measured here.
    return sysid.build_residual_fn(models_sequences=[sequences], modify_residual=modify,
                                   n_threads=1), parameters


def _model(vehicle, period):
    """Return the MjSpec of a vehicle: a free body, a motor per rotor, drag along body axes."""
    import mujoco
    spec = mujoco.MjSpec()
    spec.option.timestep = period
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.gravity = [0.0, 0.0, -vehicle.gravity]
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    body = spec.worldbody.add_body(name='vehicle', mass=vehicle.mass, inertia=vehicle.inertia,
                                   explicitinertial=True)
    body.add_freejoint(name='free')
    body.add_site(name='middle')
    for j, rotor in enumerate(vehicle.rotors, 1):
        body.add_site(name=f'rotor{j}', pos=rotor.position)
        spec.add_actuator(name=f'rotor{j}', target=f'rotor{j}',
                          trntype=mujoco.mjtTrn.mjTRN_SITE, gear=_gear(vehicle, rotor))
    for axis in range(2):
        spec.add_actuator(
            name='drag_' + 'xy'[axis], target='middle', trntype=mujoco.mjtTrn.mjTRN_SITE,
            gear=np.eye(6)[axis], gainprm=np.zeros(10),
            biastype=mujoco.mjtBias.mjBIAS_AFFINE, biasprm=_drag(vehicle.linear_drag[axis]))
    for name, kind in SENSORS.items():
        spec.add_sensor(name=name, type=getattr(mujoco.mjtSensor, f'mjSENS_{kind.upper()}'),
                        objtype=mujoco.mjtObj.mjOBJ_SITE, objname='middle')
    return spec


def _gear(vehicle, rotor):
    return [0.0, 0.0, vehicle.thrust_coefficient, 0.0, 0.0,
            rotor.spin * vehicle.torque_coefficient]


def _drag(coefficient):
    return np.concatenate([[0.0, 0.0, -coefficient], np.zeros(7)])


def _value(vehicle, name):
    """Return the constant of a vehicle by its name."""
    return getattr(vehicle, name) if hasattr(vehicle, name) else \
        getattr(vehicle, name[:-2])['xyz'.index(name[-1])]


def _modifier(mujoco, vehicle, name):
    """Return the function that writes a parameter into an MjSpec."""
    def inertia(spec, parameter):
        body = spec.body('vehicle')
        values = np.array(body.inertia)
        values['xyz'.index(name[-1])] = parameter.value[0]
        body.inertia = values

    def coefficient(spec, parameter):
        for j, rotor in enumerate(vehicle.rotors, 1):
            gear = np.array(spec.actuator(f'rotor{j}').gear)
            if name == 'thrust_coefficient':
                gear[2] = parameter.value[0]
            else:
                gear[5] = rotor.spin * parameter.value[0]
            spec.actuator(f'rotor{j}').gear = gear

    def drag(spec, parameter):
        spec.actuator('drag_' + name[-1]).biasprm = _drag(parameter.value[0])

    return {'i': inertia, 't': coefficient, 'l': drag}[name[0]]


def _over_noise(_parameters, predicted, measured, _model, _return_all, **_more):
    """Return residuals over the noise; the attitude as a rotation vector."""
    from quad_ident_ros.model.attitude import product
    guess, truth = predicted.data, measured.data
    turned = 2.0 * product(guess[:, 6:10] * [1, -1, -1, -1], truth[:, 6:10])[:, 1:]
    left = np.concatenate([truth[:, :6] - guess[:, :6], turned, truth[:, 10:] - guess[:, 10:]],
                          axis=1) / NOISE
    # The two must share one mapping, by identity.
    return left, predicted, type(measured)(measured.times, measured.data,
                                           predicted.signal_mapping)
