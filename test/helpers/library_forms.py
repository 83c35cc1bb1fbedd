# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How much of a force and moment no form of the library can be, over what is flown."""

import copy

import numpy as np
from scipy.optimize import least_squares

from quad_ident_ros.model import situation as at
from withheld.influence import Instant

STEP, COUNT = 0.04, 500     # s, samples of a flight of 20 s


def flown(params, hover, seed=5):
    """Return {name: (COUNT, ...)} over the range that the check flies, smooth in time."""
    rng = np.random.default_rng(seed)
    t = STEP * np.arange(COUNT)

    def smooth(count, size):
        rates = 2.0 * np.pi * np.exp(rng.uniform(np.log(0.1), np.log(1.5), (count, 6)))
        waves = np.sin(rates[:, :, None] * t + rng.uniform(0.0, 6.28, (count, 6, 1)))
        return size * np.sqrt(2.0 / 6.0) * waves.sum(axis=1).T

    rotors = params['num_rotors']
    return {'time': t, 'air': smooth(3, np.array([1.8, 1.8, 0.7])), 'rate': smooth(3, 0.5),
            'speeds': hover * (1.0 + smooth(1, 0.12) + smooth(rotors, 0.03)),
            'heights': params['rotor_radius'] * np.exp(1.2 + smooth(1, 0.6)) + np.zeros(rotors)}


def nominal(params, flight):
    """Return the thrust (COUNT, n) of the nominal rotors."""
    return params['k_eta'] * flight['speeds'] ** 2


def summed(places, forces, force=0.0, moment=0.0):
    """Return force and moment (COUNT, 6) of the rotors' forces (COUNT, n, 3) and the body's."""
    turning = np.cross(places[None], forces).sum(axis=1) + moment
    return np.concatenate([forces.sum(axis=1) + force, turning], axis=1)


def of_part(part, params, places, flight):
    """Return the force and moment (COUNT, 6) that a form adds to the nominal ones."""
    thrust, out = nominal(params, flight), np.zeros((COUNT, 6))
    part.alter(copy.deepcopy(params) | {'centre': np.zeros(3)}, params)
    for k, now in enumerate(instants(places, flight)):
        gain = part.gain(now) * np.ones(len(places))
        forces = np.zeros((1, len(places), 3))
        forces[0, :, 2] = (gain - 1.0) * thrust[k]
        force, moment = part.wrench(now) or (np.zeros(3), np.zeros(3))
        reaction = (part.torque(now) * np.ones(len(places)) - 1.0) * params['rotor_directions']
        yaw = params['k_m'] * reaction @ flight['speeds'][k] ** 2
        out[k] = summed(places, forces, force, moment + [0.0, 0.0, yaw])[0]
        part.after(STEP, np.eye(3), np.zeros(3))
    return out


def of_battery(battery, params, places, hover, flight):
    """Return the force and moment (COUNT, 6) that a battery takes from the nominal ones."""
    thrust, out = nominal(params, flight), np.zeros((COUNT, 6))
    for k, speeds in enumerate(flight['speeds'] / hover):
        battery.drain(flight['time'][k], STEP, speeds)
        forces = np.zeros((1, len(places), 3))
        forces[0, :, 2] = (battery.gain(speeds) - 1.0) * thrust[k]
        out[k] = summed(places, forces)[0]
    return out


def instants(places, flight):
    """
    Return the Instants of a flight, level unless it has a 'rotation' (COUNT, 3, 3).

    In one place unless it has a 'position' (COUNT, 3) m.
    """
    turned = flight.get('rotation', np.broadcast_to(np.eye(3), (COUNT, 3, 3)))
    place = flight.get('position', np.zeros((COUNT, 3)))
    return [Instant(flight['time'][k], place[k], flight['air'][k], turned[k],
                    flight['rate'][k], flight['air'][k], flight['speeds'][k],
                    flight['heights'][k], places) for k in range(COUNT)]


def of_library(form, values, params, places, flight, hover):
    """Return the force and moment (COUNT, 6) that a form of the library adds, by its kernels."""
    rotors, thrust = len(places), nominal(params, flight)
    s, table = np.zeros((at.ROWS, COUNT)), np.zeros((rotors, at.ROTOR_ROWS, COUNT))
    s[at.AX:at.AZ + 1], s[at.RADIUS], s[at.TIME] = flight['air'].T, params['rotor_radius'], \
        flight['time']
    s[at.PER_HOVER] = 1.0 / (rotors * hover)
    hubs = flight['air'][:, None] + np.cross(flight['rate'][:, None], places[None])
    for j in range(rotors):
        table[j, at.SPEED], table[j, at.HEIGHT] = flight['speeds'][:, j], flight['heights'][:, j]
        table[j, at.UX:at.UZ + 1], table[j, [at.GAIN, at.REACTION]] = hubs[:, j].T, 1.0
        table[j, at.RX:at.RZ + 1] = places[j][:, None]
    p = np.repeat(np.asarray(values, float)[:, None], COUNT, axis=1)
    if form.thrust is not None:
        form.thrust(p, 0, s, table)
    for j in range(rotors):
        table[j, at.HZ] = thrust[:, j] * table[j, at.GAIN]
    if form.wrench is not None:
        form.wrench(p, 0, s, table)
    forces = np.transpose(table[:, at.HX:at.HZ + 1], (2, 0, 1)).copy()
    forces[:, :, 2] -= thrust
    reaction = params['k_m'] * flight['speeds'] ** 2 * (table[:, at.REACTION].T - 1.0)
    moment = s[at.MX:at.MZ + 1].T.copy()
    moment[:, 2] += reaction @ params['rotor_directions']
    return summed(places, forces, s[at.FX:at.FZ + 1].T, moment)


def remainder(target, form, params, places, flight, hover):
    """Return which share of a target (COUNT, 6), rms, the best parameters of a form leave."""
    weight = params['mass'] * 9.81
    scale = np.repeat([weight, weight * np.linalg.norm(places[0])], 3)
    wanted = target / scale
    null = np.array([one.null for one in form.parameters])
    size = np.array([one.size for one in form.parameters])

    def missed(x):
        made = of_library(form, null + size * x, params, places, flight, hover) / scale
        return (made - wanted).ravel() / np.sqrt(np.mean(wanted ** 2))

    lower, upper = ((np.array([getattr(one, name) for one in form.parameters]) - null) / size
                    for name in ('lower', 'upper'))
    best = min((least_squares(missed, np.clip(sign * 0.3, lower + 1e-3, upper - 1e-3),
                              bounds=(lower, upper), max_nfev=60)
                for sign in (1.0, -1.0)), key=lambda one: one.cost)
    return float(np.sqrt(np.mean(best.fun ** 2)))
