# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the tests of the withheld check's forms share: a vehicle, moments of a flight, parts."""

import copy
from dataclasses import replace

import numpy as np

from withheld.constants import GRAVITY, hover_speed
from withheld.forms import form_of
from withheld.influence import Instant

PARAMS = {
    'mass': 0.5, 'Ixx': 3e-3, 'Iyy': 3e-3, 'Izz': 5e-3, 'Ixy': 0.0, 'Ixz': 0.0, 'Iyz': 0.0,
    'num_rotors': 4, 'k_eta': 5e-6, 'k_m': 1e-7, 'rotor_radius': 0.1,
    'rotor_speed_max': 800.0,
    'rotor_directions': np.array([1, -1, 1, -1]), 'linear_drag': np.array([0.05, 0.05, 0.06]),
    'rotor_pos': {'r1': np.array([0.12, 0.12, 0.0]), 'r2': np.array([0.12, -0.12, 0.0]),
                  'r3': np.array([-0.12, -0.12, 0.0]), 'r4': np.array([-0.12, 0.12, 0.0])}}
HOVER = hover_speed(PARAMS)                             # rad/s, of each rotor
PLACES = np.array(list(PARAMS['rotor_pos'].values()))   # (4, 3) m
RADIUS = PARAMS['rotor_radius']                         # m
SPINS = PARAMS['rotor_directions']
WEIGHT = PARAMS['mass'] * GRAVITY                       # N
LIFT = PARAMS['k_eta'] * 4.0 * HOVER ** 2               # N, of all rotors in hover

REST = np.zeros(3)
LEVEL = np.eye(3)
# States (13,): position, velocity, attitude as a quaternion (x, y, z, w), rate.
HANGING = np.array([*np.zeros(9), 1.0, *np.zeros(3)])
STATE = np.array([*np.arange(1.0, 7.0), 0.0, 0.0, 0.6, 0.8, 0.4, -1.0, 0.2])


def fresh(params=PARAMS):
    """Return parameters for a reality to alter, as the plant has them before any part has."""
    return copy.deepcopy(params) | {'centre': np.zeros(3)}


def part_of(kind, size=2.0, seed=3, flight=None, params=PARAMS):
    """
    Return a part of a kind as it is when a flight begins, with its changes of the vehicle made.

    seed draws what is the case's, flight what is the flight's own: seed + 1 unless given.
    """
    part = kind(size, params, np.random.default_rng(seed))
    part.begin(np.random.default_rng(seed + 1 if flight is None else flight))
    if hasattr(part, 'alter'):      # no line, motor or battery has it
        part.alter(fresh(params), params)
    return part


def made(effect, form, size):
    """Return the part of a form that the lists of forms have."""
    return part_of(form_of(effect, form), size)


def instant(velocity=(1.0, -0.5, 0.3), turn=(1.1, 0.9, 1.0, 1.05), height=0.3, time=7.0,
            rate=(0.5, -0.3, 0.2)):
    """Return an Instant of level flight in calm air; turn (4,) is over the speed in hover."""
    return Instant(time, np.array([0.2, 0.1, height]), np.array(velocity), np.eye(3),
                   np.array(rate), np.array(velocity), HOVER * np.array(turn),
                   np.full(4, height), PLACES)


def still(**others):
    """Return the Instant of a hover, but for what is given otherwise."""
    return replace(instant(velocity=REST, rate=REST, turn=np.ones(4)), **others)


def above(radii, **others):
    """Return the Instant of a hover with all rotors some radii above ground."""
    return still(heights=np.full(4, radii * RADIUS), **others)


def turning(part, turn, seconds, step=0.01, **others):
    """Let a part see rotors of a speed over that in hover for some seconds; return the Instant."""
    now = still(**{'speeds': np.full(4, turn * HOVER)} | others)
    for _ in range(round(seconds / step)):
        part.gain(now), part.wrench(now)
        part.after(step, LEVEL, REST)
    return now


def stepped(motor, command, step=0.0005, seconds=1.0, before=1.0):
    """
    Return the turns (N, 4) after each step, from one command that was held to another.

    A command is for all rotors or for each (4,), over the speed in hover, as are the turns.
    """
    before, command = (np.broadcast_to(HOVER * np.asarray(one, float), (4,))
                       for one in (before, command))
    speeds, turns = motor.turn(before, before, step), []
    for _ in range(round(seconds / step)):
        speeds = motor.turn(speeds, command, step)
        turns.append(speeds / HOVER)
    return np.array(turns)


def drained(battery, turns, step=0.01):
    """Return the ratios (N,) after each step; each turn is of all rotors or of each (4,)."""
    ratios = []
    for k, turn in enumerate(turns):
        battery.drain(step * k, step, np.broadcast_to(turn, (4,)))
        ratios.append(battery.ratio)
    return np.array(ratios)
