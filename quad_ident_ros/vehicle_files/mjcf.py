# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""MJCF models of MuJoCo."""

from collections.abc import Sequence
from dataclasses import replace
import math

import numpy as np

from quad_ident_ros.effects.registry import Values
from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.bodies import Body, combined, spun
from quad_ident_ros.vehicle_files.mjcf_bodies import is_free, Part, parts_of, vehicles_of
from quad_ident_ros.vehicle_files.mjcf_defaults import Model, model_of
from quad_ident_ros.vehicle_files.mjcf_include import parsed
from quad_ident_ros.vehicle_files.mjcf_thrust import common, Push, pushes_of
from quad_ident_ros.vehicle_files.reading import Draft, thrusts_as_commands, UNLIMITED
from quad_ident_ros.vehicle_files.rotor_axes import check_axis
from quad_ident_ros.vehicle_files.source import one_of, Source
from quad_ident_ros.vehicle_files.weak_rotors import faults_of, note_losses, SAME
from quad_ident_ros.vehicle_files.xml_tree import Element, root_of

GRAVITY = (0.0, 0.0, -9.81)     # m/s^2, of MuJoCo
OF_JOINTS = 'damping', 'stiffness', 'frictionloss', 'armature'


def recognises(text: str) -> bool:
    """Whether a text is an MJCF model."""
    return root_of(text) == 'mujoco'


def read(source: Source) -> Draft:
    """Return the Draft of an MJCF model; raises InputError."""
    model = model_of(parsed(source))
    body, inherited = flying_body(source, model)
    draft = Draft(source.path, body.get('name') or model.root.get('model') or source.stem)
    parts = list(parts_of(model, body, inherited))
    sites = {name: site for part in parts for name, site in part.sites.items()}
    pushes = pushes_of(model, sites)
    whole = _take_bodies(draft, model, parts, {push.site for push in pushes if push.pushes})
    _take_gravity(draft, model)
    _take_rotors(draft, model, parts, pushes, whole)
    _say_air(draft, model, whole)
    _say_left_out(draft, parts)
    return draft


def flying_body(source: Source, model: Model) -> tuple[Element, str]:
    """Return the <body> of a model that flies, with the childclass that holds there."""
    bodies = vehicles_of(model)
    free = {name: found for name, found in bodies.items() if is_free(found[0])} or bodies
    pushed = {name: found for name, found in free.items() if _pushes(model, found)} or free
    return one_of(source, pushed, 'body that flies')


def _pushes(model: Model, found: tuple[Element, str]) -> bool:
    """Whether an actuator acts at a site of a body."""
    names = {site.get('name') for site in found[0].walk() if site.tag == 'site'} - {''}
    return any(child.get('site') in names for holder in model.root.all('actuator')
               for child in holder.children)


def bodies_of(draft: Draft, parts: Sequence[Part], pushed: set[str]) -> list[Body]:
    """Return the Body of each part, of a rotor as it is over a turn; pushed: sites of rotors."""
    bodies = []
    for part in parts:
        body, where = part.body, part.element.place()
        if part.remark:
            draft.assumed.append(f'{where}: {part.remark}')
        moving = [joint for joint in part.joints if part is not parts[0]]
        if moving and moving[0].get('type', 'hinge') == 'hinge' and pushed & part.sites.keys():
            stated = moving[0].numbers('axis', 3, (0.0, 0.0, 1.0))
            if not np.linalg.norm(stated) > 1e-9:
                raise InputError(f'{moving[0].where}: zeros are not an axis; correct it')
            axis = part.pose.rotation @ stated
            body = spun(body, axis)
            draft.assumed.append(f'{where}: its inertia is the mean over a turn')
        elif moving:
            draft.assumed.append(f'{where}: it moves by a joint, and is taken as fixed where it '
                                 'starts')
        if body.mass > 0.0:
            draft.note(f'body {part.element.get("name") or part.element.line}', body.mass, 'kg',
                       f'{where}, {part.source}')
        bodies.append(body)
    return bodies


def _take_bodies(draft: Draft, model: Model, parts: Sequence[Part], pushed: set[str]) -> Body:
    """Enter mass and inertia of all bodies of a vehicle, and return them as one."""
    bodies = bodies_of(draft, parts, pushed)
    if not sum(body.mass for body in bodies) > 0.0:
        raise InputError(f'{parts[0].element.where}: it has no mass above 0; give it '
                         'an <inertial> with one')
    whole = combined(bodies)
    [total] = model.setting('settotalmass', (-1.0,))
    if total > 0.0:
        whole = replace(whole, mass=total, inertia=total / whole.mass * whole.inertia)
        draft.assumed.append(f'mass and inertia are scaled to settotalmass, {total:g} kg, as if '
                             'nothing else in the model had a mass')
    said = f' with {len(parts) - 1} bodies in it' if len(parts) > 1 else ''
    draft.take_body(whole, parts[0].element.place() + said)
    return whole


def _take_gravity(draft: Draft, model: Model) -> None:
    gravity, place = np.array(GRAVITY), 'MuJoCo itself'
    for option in model.root.all('option'):
        if 'gravity' in option.attributes:
            gravity, place = option.numbers('gravity', 3), option.place('gravity')
        for flag in option.all('flag'):
            if flag.get('gravity') == 'disable':
                raise InputError(f'{flag.where}: without gravity no flight is in balance; take '
                                 'gravity="disable" out')
    draft.take_gravity(float(np.linalg.norm(gravity)), place)


def _take_rotors(draft: Draft, model: Model, parts: Sequence[Part], pushes: Sequence[Push],
                 whole: Body) -> None:
    """Enter the rotors and their thrusts."""
    thrusts = [push for push in pushes if push.pushes]
    moments = [push for push in pushes if not push.pushes]
    across = [push for push in moments if np.hypot(*push.moment[:2]) > abs(push.moment[2])]
    if across or not thrusts:
        reason = ('its controls are a thrust of all rotors and moments, of which '
                  f'{across[0].element.place()} is one' if across else
                  'no actuator of the model pushes at a site of the vehicle')
        for key in ('rotors', 'thrust_coefficient', 'torque_coefficient'):
            draft.reasons[key] = reason
        dynamics = _take_dynamics(draft, thrusts, moments) if thrusts else {}
        draft.effects = lambda _: dynamics
        return
    where = _lines_of(thrusts)
    turning = []
    for push in thrusts:
        axis = push.force / np.linalg.norm(push.force)
        check_axis(draft, axis, push.element.where)
        turning.append(float(axis @ push.moment))
        beside = push.moment - axis * turning[-1]
        if np.linalg.norm(beside) > 1e-9 * np.linalg.norm(push.force):
            draft.assumed.append(f'{push.element.place("gear")}: its moment across the thrust is '
                                 'left out')
    forces = [float(np.linalg.norm(push.force)) for push in thrusts]
    torques = [abs(torque) for torque in turning]
    faults = faults_of(forces, torques)
    if faults:      # the strongest one stands for all
        note_losses(draft, faults, len(thrusts), f'{where} gear')
        forces, torques = ([max(each)] * len(thrusts) for each in (forces, torques))
    size = common(thrusts, [torque / force for torque, force in
                            zip(torques, forces, strict=True)], 'torque over thrust')
    spins = [int(math.copysign(1, torque)) if size > 0.0 else None for torque in turning]
    draft.take_rotors([push.place - whole.centre for push in thrusts], spins, where)
    if size > 0.0:
        draft.note('torque over thrust', size, 'm', f'{where} gear')
    else:
        draft.reasons['torque_coefficient'] = draft.reasons['spins'] = (
            f'the torque of a rotor is a control of its own ({moments[0].element.place()})'
            if moments else 'the gear of the thrusts has no moment about z')
    _take_limits(draft, thrusts, common(thrusts, forces, 'thrust per control'), whole,
                 size or None, where)
    dynamics = _take_dynamics(draft, thrusts, moments)
    draft.effects = lambda _: {**dynamics, **faults}


def _take_dynamics(draft: Draft, thrusts: Sequence[Push], moments: Sequence[Push]) -> Values:
    """Enter lag and delay of the thrusts, and return them as effects; at least one thrust."""
    where = _lines_of(thrusts)
    lag = common(thrusts, [push.lag for push in thrusts], 'time constant')
    if lag > 0.0:
        draft.note('time constant of the thrust', lag, 's', f'{where} dynprm')
        draft.assumed.append(f'the lag of {lag:g} s is one of the thrust; it is taken as that of '
                             'the speed, which is the same for small changes')
    delay = common(thrusts, [push.delay for push in thrusts], 'delay')
    if delay > 0.0:
        draft.note('delay of the controls', delay, 's', f'{where} delay')
    for push in moments:
        draft.assumed += [f'{push.element.place()}: its {what} of {one:g} s is not that of the '
                          f'thrusts, {other:g} s, which is taken'
                          for what, one, other in (('lag', push.lag, lag),
                                                   ('delay', push.delay, delay))
                          if not math.isclose(one, other, rel_tol=SAME)]
    return {'motor_lag': {'time_constant': lag}, 'actuation_delay': {'delay': delay}}


def _lines_of(thrusts: Sequence[Push]) -> str:
    """Return where the actuators of the rotors stand, of each file that has some."""
    files: dict[str, list[str]] = {}
    for push in thrusts:
        files.setdefault(push.element.beside, []).append(str(push.element.line))
    return ', '.join(f'{file}{", " * bool(file)}line{"s" * (len(lines) > 1)} {", ".join(lines)}'
                     for file, lines in files.items()) + ': <actuator>'


def _take_limits(draft: Draft, thrusts: Sequence[Push], per_control: float, whole: Body,
                 ratio: float | None, where: str) -> None:
    """Enter what the controls stand for; per_control: N of a rotor."""
    low = common(thrusts, [max(push.limits[0], 0.0) for push in thrusts], 'least control')
    highs = [push.limits[1] for push in thrusts]
    if not all(map(math.isfinite, highs)):
        hover = whole.mass * draft.data['gravity'] / len(thrusts)
        highs = [UNLIMITED * hover / per_control] * len(thrusts)
        draft.assumed.append(f'controls without a range: {UNLIMITED:g} times the thrust at hover, '
                             f'{UNLIMITED * hover:.4g} N, is assumed as the highest')
    high = common(thrusts, highs, 'most control')
    if not high > low:
        raise InputError(f'{thrusts[0].element.where}: its controls from {low:g} to {high:g} '
                         'leave no thrust; correct ctrlrange')
    draft.note('highest thrust of a rotor', per_control * high, 'N', f'{where} ctrlrange x gear')
    thrusts_as_commands(draft, per_control * high, ratio, f'{where} ctrlrange x gear',
                        per_control * low, (low, high))


def _say_air(draft: Draft, model: Model, whole: Body) -> None:
    """Say that the drag of MuJoCo's fluid is left out, and how large it is."""
    density, viscosity = (max((option.number(name, 0.0) for option in model.root.all('option')),
                              default=0.0) for name in ('density', 'viscosity'))
    moments = np.linalg.eigvalsh(whole.inertia)
    sides = np.sqrt(np.maximum(6.0 * (moments.sum() - 2.0 * moments), 0.0) / whole.mass)
    if viscosity > 0.0:
        draft.assumed.append(
            f"MuJoCo's fluid (viscosity {viscosity:g} Pa s) is left out: a drag of "
            f'{3.0 * math.pi * viscosity * np.mean(sides):.2g} N at 1 m/s, with its speed')
    if density > 0.0:
        most = 0.5 * density * float(np.max(np.prod(sides) / np.maximum(sides, 1e-9)))
        draft.assumed.append(
            f"MuJoCo's fluid (density {density:g} kg/m3) is left out: a drag on the box of the "
            f'inertia, of at most {most:.2g} N at 1 m/s, with its square')


def _say_left_out(draft: Draft, parts: Sequence[Part]) -> None:
    """Say which forces of MuJoCo on the vehicle are left out."""
    draft.assumed += [f'{joint.place(name)}: this force on the joint is left out'
                      for joint in parts[0].joints for name in OF_JOINTS
                      if any(joint.numbers(name, len(joint.get(name).split()), (0.0,)))]
    draft.assumed += [f'{part.element.place("gravcomp")}: it is left out; the vehicle has all of '
                      'its weight' for part in parts if part.element.number('gravcomp', 0.0)]
