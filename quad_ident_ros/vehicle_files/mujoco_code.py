# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A program beside an MJCF model: forces of effects that MuJoCo has no number for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from textwrap import indent

from quad_ident_ros.effects import ground_effect_curve
from quad_ident_ros.effects.thrust_scale_curve import SPEED_OF
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.edits import shown
from quad_ident_ros.vehicle_files.mjcf_thrust import Push
from quad_ident_ros.vehicle_files.target import Code
from quad_ident_ros.vehicle_files.wanted import Wanted
from quad_ident_ros.vehicle_files.ways import forms_of

Values = Mapping[str, float]
HEIGHTS_AT = dict(zip((*(one.name for one in ground_effect_curve.FORM.parameters), 'above'),
                      ground_effect_curve.HEIGHTS, strict=True))
# Of each form the lines that add to `gain` (n,) on the thrusts, `push` (n, 3) of the rotors, or
# `force` and `moment` (3,) on the body, in the order in which they act. `air` (3,) and `u` (n, 3)
# are velocities of the centre of mass and of the rotors against the air, `w` (n,) the speeds of
# the rotors over those at hover, all in body axes.
LINES: dict[tuple[str, str], Callable[[Values, int, float], str]] = {
    ('thrust_scale', 'exponent'): lambda p, n, r: (
        f'gain *= np.maximum(w, 0.05) ** {_one(p["exponent"] - 2.0)}'),
    ('thrust_scale', 'offset'): lambda p, n, r: (
        'least = np.maximum(w, 0.05)\n'
        f'gain *= (np.maximum(least + {_one(p["offset"])}, 0.0) '
        f'/ ({_one(1.0 + p["offset"])} * least)) ** 2'),
    ('thrust_scale', 'curve'): lambda p, n, r: (
        f'gain *= np.interp(w, {_row(SPEED_OF, tuple(SPEED_OF))}, '
        # The gears hold the factor at hover.
        f'{_row({**dict.fromkeys(SPEED_OF, 1.0), **p}, tuple(SPEED_OF), p.get("at_100", 1.0))})'),
    ('ground_effect', 'curve'): lambda p, n, r: (
        f'radii = np.maximum(height / {_one(max(r, 1e-12))}, '
        f'{_one(ground_effect_curve.HEIGHTS[0])})\n'
        f'known = np.log({_row(HEIGHTS_AT, tuple(HEIGHTS_AT))})\n'
        f'gain *= 1.0 + np.interp(np.log(radii), known, {_row(p, tuple(HEIGHTS_AT))})'),
    ('ground_effect', 'cheeseman_bennett'): lambda p, n, r: (
        f'square = 16.0 * np.maximum(height, {_one(0.5 * r)}) ** 2\n'
        f'gain *= square / (square - np.minimum({_one(p["strength"] * r * r)}, 0.75 * square))'),
    ('rotor_drag', 'by_speed'): lambda p, n, r: (
        f'push[:, :2] -= {_one(p["coefficient"] / n)} * w[:, None] * u[:, :2]'),
    ('rotor_drag', 'axes'): lambda p, n, r: f'force -= {_row(p, "xyz")} * air',
    ('rotor_drag', 'axes_by_speed'): lambda p, n, r: (
        f'push -= {_row(p, ("x_by_speed", "y_by_speed", "z_by_speed"), n)} * w[:, None] * u'),
    ('body_drag', 'planar'): lambda p, n, r: (
        f'force -= {_row(p, ("horizontal", "horizontal", "vertical"))} '
        '* np.linalg.norm(air) * air'),
    ('body_drag', 'axes'): lambda p, n, r: (
        f'force -= {_row(p, "xyz")} * np.linalg.norm(air) * air'),
    ('inflow', 'linear'): lambda p, n, r: (
        f'push[:, 2] += {_one(p.get("translational", 0.0) / n)} * (u[:, :2] ** 2).sum(axis=1)\n'
        f'push[:, 2] -= {_one(p.get("axial", 0.0) / n)} * w * u[:, 2]'),
    ('inflow', 'curve'): lambda p, n, r: (
        'across = np.linalg.norm(u[:, :2], axis=1)\n'
        f'push[:, 2] += {_one(p.get("edgewise", 0.0) / n)} * w * across\n'
        f'push[:, 2] += {_one(p.get("edgewise_square", 0.0) / n)} * across ** 2\n'
        f'push[:, 2] -= {_one(p.get("climb", 0.0) / n)} * w * u[:, 2]\n'
        f'push[:, 2] -= {_one(p.get("climb_square", 0.0) / n)} * u[:, 2] * np.abs(u[:, 2])'),
    ('inflow', 'overall'): lambda p, n, r: (
        f'push[:, 2] += {_one(p.get("translational_overall", 0.0) / n)} * (air[:2] @ air[:2])\n'
        f'push[:, 2] -= {_one(p.get("axial_overall", 0.0) / n)} * w * air[2]'),
    ('blade_flapping', 'hub_moment'): lambda p, n, r: (
        f'moment += {_one(p["coefficient"] / n)} * np.array([-w @ u[:, 1], w @ u[:, 0], 0.0])'),
    ('blade_flapping', 'damped_hub'): lambda p, n, r: (
        f'moment += {_one(p.get("hub_coefficient", 0.0) / n)} '
        '* np.array([-w @ u[:, 1], w @ u[:, 0], 0.0])\n'
        f'moment -= {_one(p.get("rate_damping", 0.0))} * rate * [1.0, 1.0, 0.0]'),
    ('blade_flapping', 'drag_centre'): lambda p, n, r: (
        'across = force[:2] + push[:, :2].sum(axis=0)\n'
        f'moment += {_one(p["arm"])} * np.array([-across[1], across[0], 0.0])'),
    ('blade_flapping', 'drag_point'): lambda p, n, r: (
        'drag = force + push.sum(axis=0) * [1.0, 1.0, 0.0]\n'
        f'moment += np.cross({_row(p, ("arm_x", "arm_y", "arm_z"))}, drag)')}
SAYS = 'has no number for'
TEXT = '''"""
What {model} ''' + SAYS + ''': {names}.

It stands beside the model, needs MuJoCo and NumPy, and acts once a process says:
    install(model)      # an mjModel of {model}; compile all models before this
{given_said}"""

import mujoco
import numpy as np

SITES = {sites}
ACTUATORS = np.array({actuators})
LIFT = np.array({lifts})    # N, thrust of each rotor at its speed at hover
WIND = np.array({wind})    # m/s, velocity of the air, world axes


def install(model):
    """Have MuJoCo call forces(model, data) in every step of the integration of this model."""
    own = model.nbody, model.nu, model.nq
    mujoco.set_mjcb_passive(lambda each, data: forces(each, data)
                            if (each.nbody, each.nu, each.nq) == own else None)


def limited(model, controls):
    """Return controls (n,) of the rotors within their range."""
    limits = np.where(model.actuator_ctrllimited[ACTUATORS, None],
                      model.actuator_ctrlrange[ACTUATORS], [-np.inf, np.inf])
    return np.clip(controls, *limits.T)


def thrusts(model, data):
    """Return the thrusts (n,) of the rotors as the actuators give them, N."""
    act = model.actuator_actadr[ACTUATORS]
    signal = limited(model, {signal})
    for k in np.flatnonzero(act >= 0):
        signal[k] = data.act[act[k]]
    gear = np.linalg.norm(model.actuator_gear[ACTUATORS, :3], axis=1)
    return np.maximum(gear * model.actuator_gainprm[ACTUATORS, 0] * signal, 0.0)


def forces(model, data):
    """Add the forces and moments on the vehicle to data.qfrc_passive."""
    sites = [model.site(name).id for name in SITES]
    body = model.body_rootid[model.site_bodyid[sites[0]]]
    axes, centre = data.xmat[body].reshape(3, 3), data.subtree_com[body]
    spin = np.zeros(6)    # rate and velocity of the body's origin, world axes
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, spin, 0)
    rate = axes.T @ spin[:3]
    air = axes.T @ (spin[3:] + np.cross(spin[:3], centre - data.xpos[body]) - WIND)
    arms, height = (data.site_xpos[sites] - centre) @ axes, data.site_xpos[sites, 2]
    u = air + np.cross(rate, arms)
    lift = thrusts(model, data)
    w = np.sqrt(lift / LIFT)
    gain, push, force, moment = np.ones(len(sites)), np.zeros((len(sites), 3)), np.zeros(3), 0.0
{lines}
    push[:, 2] += (gain - 1.0) * lift
    force = axes @ (force + push.sum(axis=0))
    moment = axes @ (moment + np.cross(arms, push).sum(axis=0))
    mujoco.mj_applyFT(model, data, force, moment, centre, body, data.qfrc_passive)
'''
CONTROLS = 'data.ctrl[ACTUATORS]'
DELAYED = """np.array([
        mujoco.mj_readCtrl(model, data, k, data.time, np.zeros((1, 1)), 0).item()
        for k in ACTUATORS])"""
LAG = '''

def lagging(model, data, controls):
    """Return controls (n,) with which the lag of the actuators is one of the rotors' speeds."""
    places = model.actuator_actadr[ACTUATORS]
    act = np.maximum(data.act[places], 0.0)
    now, then = np.sqrt(act), np.sqrt(np.maximum(limited(model, controls), 0.0))
    lag = np.where(then > now, {rise}, {fall})
    soon = then + (now - then) * np.exp(-model.opt.timestep / lag)
    done = 1.0 - np.exp(-model.opt.timestep / model.actuator_dynprm[ACTUATORS, 0])
    wanted = act + (soon ** 2 - act) / done
    given = limited(model, wanted)
    # Beyond the range of the controls, the actuators' own state makes up for the rest.
    data.act[places] = np.where(given == wanted, act, (soon ** 2 - given * done) / (1.0 - done))
    return given
'''
COMMANDS = '''

class Commands:
    """Commands that act {delay} s after they are given; one for an mjData."""

    def __init__(self):
        self.waiting, self.given = [], None

    def command(self, model, data, controls):
        """Give controls (n,), and write the mean of those of a step; call it before mj_step."""
        if self.given is None:
            self.given = data.ctrl[ACTUATORS].copy()
        self.waiting.append((data.time + {delay}, np.array(controls)))
        begin, end, mean = data.time, data.time + model.opt.timestep, 0.0
        while self.waiting and self.waiting[0][0] < end:
            then = max(self.waiting[0][0], begin)
            mean = mean + (then - begin) * self.given
            begin, self.given = then, self.waiting.pop(0)[1]
        mean = (mean + (end - begin) * self.given) / model.opt.timestep
        data.ctrl[ACTUATORS] = {given}
'''


@dataclass(frozen=True)
class Rotors:
    """The rotors of a model: sites, and where their actuators stand among all of it."""

    sites: tuple[str, ...]
    actuators: tuple[int, ...]

    @classmethod
    def of(cls, pushes: Sequence[Push], actuators: Sequence[int]) -> Rotors:
        """Return the Rotors of the lines in which the actuators of a model begin."""
        return cls(tuple(push.site for push in pushes),
                   tuple(list(actuators).index(push.element.start) for push in pushes))


def code(vehicle: Vehicle, wanted: Wanted, rotors: Rotors, model: str, lag: str,
         delayed: bool) -> Code | None:
    """
    Return the program beside a model, or None where it is to do nothing.

    Args: vehicle: with its effects, its speeds in the unit of the file; wanted: what the file
    holds of it; model: the name of the file; lag: the form of motor_lag by which the speeds of the
    rotors lag where the actuators of the file have their thrusts do so, or ''; delayed: whether
    the actuators of the file hold the delay of the commands.
    """
    count, radius = len(vehicle.rotors), vehicle.rotor_radius
    acting = {(effect, form): values for effect, form, values in forms_of(vehicle.effects)}
    lines = [f'{part} -= {_row(dict(zip("xyz", drag, strict=True)), "xyz")} * {speed}'
             for part, drag, speed in (('force', vehicle.linear_drag, 'air'),
                                       ('moment', vehicle.rotational_drag, 'rate * np.abs(rate)'))
             if any(drag)]
    forms = [key for key in LINES if key in acting]
    lines += [LINES[key](acting[key], count, radius) for key in forms]
    if ('wind', 'steady') in acting and lines:
        forms.append(('wind', 'steady'))
    delay = 0.0 if delayed else wanted.delay
    if delay:
        forms.append(('actuation_delay', 'pure_delay'))
    if lag:
        forms.append(('motor_lag', lag))
    constants = tuple(name for name in ('linear_drag', 'rotational_drag')
                      if any(getattr(vehicle, name)))
    if not forms and not constants:
        return None
    losses = wanted.losses if wanted.losses.max() < 1.0 else 0.0 * wanted.losses
    lifts = wanted.thrust * (1.0 - losses) * wanted.hover ** 2
    text = TEXT.format(
        model=model, names=', '.join(dict.fromkeys([*constants, *(name for name, _ in forms)])),
        given_said='and gives its commands by Commands().command.\n' if delay or lag else '',
        sites=list(rotors.sites), actuators=list(rotors.actuators),
        lifts=f'[{", ".join(map(_one, lifts))}]', wind=f'[{", ".join(map(_one, wanted.wind))}]',
        signal=DELAYED if delayed else CONTROLS, lines=indent('\n'.join(lines), '    '))
    if lag:
        text += LAG.format(rise=_one(wanted.rise), fall=_one(wanted.fall))
    if delay or lag:
        text += COMMANDS.format(
            delay=_one(delay), given='lagging(model, data, mean)' if lag else 'mean')
    return Code(text, tuple(forms), constants)


def _one(value: float) -> str:
    return shown([value])


def _row(values: Values, keys: Sequence[str], count: float = 1) -> str:
    """Return numbers by key as an array; count: what each is divided by."""
    return ('np.array([' + ', '.join(_one(values.get(key, 0.0) / count) for key in keys) + '])')
