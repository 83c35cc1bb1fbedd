# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Vehicles back into MJCF models of MuJoCo."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations
import math

import numpy as np
import scipy

from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.vehicle_files.bodies import Body, Pose
from quad_ident_ros.vehicle_files.edit_xml import EditedXml
from quad_ident_ros.vehicle_files.edits import differs, SAME, shown
from quad_ident_ros.vehicle_files.mjcf import bodies_of, flying_body
from quad_ident_ros.vehicle_files.mjcf_bodies import bounded, Part, parts_of
from quad_ident_ros.vehicle_files.mjcf_defaults import Model, model_of
from quad_ident_ros.vehicle_files.mjcf_include import parsed
from quad_ident_ros.vehicle_files.mjcf_thrust import Push, pushes_of, step_of
from quad_ident_ros.vehicle_files.mujoco_code import code as program
from quad_ident_ros.vehicle_files.mujoco_code import Rotors
from quad_ident_ros.vehicle_files.new_mjcf import new
from quad_ident_ros.vehicle_files.out_base import Base
from quad_ident_ros.vehicle_files.out_body import body_for, MOMENTS, PRODUCTS, told_by_body
from quad_ident_ros.vehicle_files.out_places import beside_others, lack_part
from quad_ident_ros.vehicle_files.reading import Draft
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.target import Code, Target
from quad_ident_ros.vehicle_files.ways import BODY, LAGS, why_not
from quad_ident_ros.vehicle_files.weak_rotors import losses_of
from quad_ident_ros.vehicle_files.xml_tree import Element

GENERAL = {'gainprm': '1', 'gaintype': 'fixed', 'biastype': 'none'}
"""What a <motor> is as a <general>."""
APART = 'the torque of a rotor is a control of its own in the file'
TURNS = 'quat', 'euler', 'axisangle', 'xyaxes', 'zaxis'


def write(base: Base) -> EditedXml:
    """Return the Edits that give an MJCF model what is wanted; raises InputError."""
    edited = EditedXml(base.source.text)
    model = model_of(parsed(base.source))
    parts, pushes, bodies = _layout(base.source, model)
    thrusts = [push for push in pushes if push.pushes]
    moving = _moving(edited, base, model, parts, thrusts)
    # The body itself, or where that is a mere frame the heaviest of those in it.
    main = 0 if bodies[0].mass > 0.0 else max(range(len(bodies)), key=lambda k: bodies[k].mass)
    other = next((one for one in (parts[main].element, *parts[main].element.all('inertial'),
                                  *(push.element for push in thrusts),
                                  *(one for one, _, _ in moving)) if one.beside), None)
    if other is not None:
        raise InputError(f'{base.source.path}: the vehicle stands in {other.path}, which it '
                         'includes; give that file as --base, or where it is a part of the '
                         'model alone, the whole model as `mj_saveLastXML` writes it')
    shifted = None
    if moving:
        for one, before, shift in moving:
            edited.attribute(one, 'pos', before + shift, 'm', base.wanted.sources['moments'],
                             usual=(0.0, 0.0, 0.0), size=1.0)
        there = replace(base.source, text=edited.result())
        shifted = _layout(there, model_of(parsed(there)))[2]
        del shifted[main]
    rest = [*bodies[:main], *bodies[main + 1:]]
    body = body_for(base, edited, parts[main].element.where, bodies[main], rest, shifted)
    if body is not bodies[main]:
        if 'settotalmass' in model.compiler:
            raise InputError(f'{base.source.path}: settotalmass of <compiler> scales every mass; '
                             'take it out and state the masses themselves')
        inside = body.placed(parts[main].pose.inverse)
        kept = bounded(model, parts[main].element, inside)
        if kept.mass > inside.mass or not np.allclose(
                kept.inertia, inside.inertia, rtol=0.0, atol=SAME * np.max(inside.inertia)):
            raise InputError(f'{base.source.path}: boundmass, boundinertia or balanceinertia of '
                             '<compiler> changes the mass or inertia of the vehicle; take it out')
        _write_body(edited, told_by_body(base, rest, shifted), model, parts[main], inside)
        edited.say_several(parts[main].element, len(bodies))
    edited.lack(['speed_max'], 'a command is a thrust here, and speeds are not of the file')
    _write_thrusts(edited, base, thrusts)
    _write_moments(edited, base, parts, pushes)
    # Moments that are controls of their own come from the same rotors.
    _write_lags(edited, base, thrusts, pushes, _filter(model))
    _write_delay(edited, base, thrusts, pushes, step_of(model))
    return edited


def _layout(source: Source, model: Model) -> tuple[list[Part], list[Push], list[Body]]:
    """Return the parts of a vehicle, what pushes at its sites, and the Body of each part."""
    parts = list(parts_of(model, *flying_body(source, model)))
    pushes = pushes_of(model, _sites(parts))
    return parts, pushes, bodies_of(Draft(source.path, ''), parts,
                                    {push.site for push in pushes if push.pushes})


def _sites(parts: Sequence[Part]) -> dict[str, tuple[Pose, Element]]:
    return {name: site for part in parts for name, site in part.sites.items()}


def _moving(edited: EditedXml, base: Base, model: Model, parts: Sequence[Part],
            thrusts: Sequence[Push]) -> list[tuple[Element, np.ndarray, np.ndarray]]:
    """
    Return elements that move with the rotors, their positions and shifts (3,), m, around them.

    It is the site of a rotor, or the body around it that turns: a site beside the axis would turn.
    Rotors that stand apart on one such body, as on a frame that tilts, move by their sites.
    """
    if not base.shifts.any():
        return []
    turning = {(part.element.path, part.element.start): (part, _sites_in(part.element))
               for part in parts[1:] if part.joints}
    shifts = {push.site: shift for push, shift in zip(thrusts, base.shifts, strict=True)}
    nearest = {site: [key for key, (_, within) in turning.items() if site in within][-1:]
               for site in shifts}      # a body comes after those around it
    sites = _sites(parts)
    found: dict[tuple[str, int], tuple[Element, np.ndarray, np.ndarray]] = {}
    moves: dict[tuple[str, int], np.ndarray] = {}
    above: dict[tuple[str, int], tuple[str, int]] = {}
    for site, shift in shifts.items():
        around = [key for key, (_, within) in turning.items() if site in within]
        alike = all(np.array_equal(shift, shifts[other]) for other in shifts
                    if nearest[other] == nearest[site])
        frame, one = sites[site]
        key = one.path, one.start
        if around and alike:
            key = around.pop()
            frame, one = turning[key][0].pose, turning[key][0].element
        if 'fromto' in one.attributes:
            lack_part(edited, base.wanted, 'arms', f'{one.place()} stands between two points')
            return []
        for inner, outer in zip([key, *reversed(around)], reversed(around), strict=False):
            above[inner] = outer
        found[key] = one, model.pose_of(one).position, frame.rotation @ model.rotation_of(one).T
        moves[key] = shift
    return [(one, position, axes.T @ beside) for (one, position, axes), beside in
            zip(found.values(), beside_others(moves, above).values(), strict=True)]


def _sites_in(body: Element) -> set[str]:
    """Return the names of the sites in a <body> and in those in it."""
    return {one.get('name') for one in body.walk() if one.tag == 'site'}


def code(vehicle: Vehicle, base: Base, name: str) -> Code | None:
    """Return the Code beside a model; see Target. None where it has no single rotors."""
    if base.constant('thrust_coefficient') is None:
        return None
    model = model_of(parsed(base.source))
    pushes = _layout(base.source, model)[1]
    places = [child.start for holder in model.root.all('actuator') for child in holder.children]
    return program(vehicle, base.wanted, Rotors.of([push for push in pushes if push.pushes],
                                                   places), name, _form_of_lag(vehicle, base),
                   _delay_in_file(base))


def _form_of_lag(vehicle: Vehicle, base: Base) -> str:
    """Return the form of a lag that a file has the nearest of, or '' where it has it as it is."""
    lag, wanted = vehicle.effects.get('motor_lag', {}), base.wanted
    if 'time_constant' in lag:
        same = not differs(base.effect('motor_lag', 'time_constant'), wanted.lag)
        return '' if same or not wanted.lag else 'first_order'
    return 'rise_fall' if {'rise', 'fall'} & lag.keys() and wanted.rise and wanted.fall else ''


def _write_thrusts(edited: EditedXml, base: Base, thrusts: list[Push]) -> None:
    """Have the gears of the rotors hold thrust and torque."""
    wanted = base.wanted
    thrust, torque = (base.constant(key) for key in ('thrust_coefficient', 'torque_coefficient'))
    if thrust is None:
        edited.lack(('thrust', 'losses', 'torque', 'torque_losses'),
                    'the file has no thrust of single rotors')
        return
    if torque is None:
        edited.lack(['torque'], APART)
        edited.nearest['torque_losses'] = f'its loss of thrust; {APART}'
    losses, torque_losses = wanted.losses, wanted.torque_losses
    if np.max(losses) >= 1.0:
        losses = torque_losses = np.zeros(len(losses))
        edited.lack(['losses'], 'a rotor without thrust is not a rotor; remove its actuator')
    moment = 1.0 if torque is None else wanted.torque / torque
    for push, loss, torque_loss, before, torque_before in zip(
            thrusts, losses, torque_losses, *losses_of(base.effects, len(thrusts)), strict=True):
        force = wanted.thrust * (1.0 - loss) / (thrust * (1.0 - before))
        turning = moment * (1.0 - torque_loss) / (1.0 - torque_before)
        words = push.element.get('gear', '1').split()
        stated = push.element.numbers('gear', len(words), (1.0,))
        factors = np.array([force] * 3 + [turning] * 3)[:len(words)]
        sources = {wanted.sources[key] for key, changed in (
            ('thrust', differs(thrust, wanted.thrust)), ('losses', differs(before, loss, 1.0)),
            ('torque', moment != 1.0),
            ('torque_losses', differs(torque_before, torque_loss, 1.0))) if changed}
        edited.attribute(push.element, 'gear', stated * factors, '1 or m',
                         ', '.join(sorted(sources)), usual=(1.0,))


def _write_moments(edited: EditedXml, base: Base, parts: Sequence[Part],
                   pushes: Sequence[Push]) -> None:
    """Have moments that are controls of their own be larger where those of the rotors are."""
    wanted, sites = base.wanted, _sites(parts)
    arms = wanted.arms if base.constant('rotors') is None else np.ones(3)
    factors = np.array([arms[1], arms[0], wanted.turning])
    moments = [push for push in pushes if not push.pushes]
    if not moments:
        reason = 'the file has no moments of its rotors'
        if base.constant('rotors') is None:
            lack_part(edited, wanted, 'arms', reason)
        if base.constant('torque_coefficient') is None:
            lack_part(edited, wanted, 'torque', reason)
    for push in moments if (factors != 1.0).any() else ():
        axes = sites[push.site][0].rotation
        words = push.element.get('gear', '1').split()
        stated = np.zeros(6)
        stated[:len(words)] = push.element.numbers('gear', len(words), (1.0,))
        gear = np.array([*stated[:3], *axes.T @ (factors * (axes @ stated[3:]))])
        size = float(np.max(np.abs(gear)))
        gear[np.abs(gear) <= SAME * size] = 0.0
        count = max([len(words), *(np.flatnonzero(gear) + 1)])
        edited.attribute(push.element, 'gear', gear[:count], '1 or m', wanted.sources['moments'],
                         usual=[0.0] * count, size=size)


def _filter(model: Model) -> str:
    """Return the dyntype of a lag: with filterexact, Runge-Kutta adds half a step to it."""
    methods = [option.get('integrator') for option in model.root.all('option')]
    return 'filter' if 'RK4' in methods else 'filterexact'


def _write_lags(edited: EditedXml, base: Base, thrusts: Sequence[Push], pushes: Sequence[Push],
                kind: str) -> None:
    """
    Have the dynamics of the actuators hold the lag.

    Args: pushes: the thrusts, and moments that are controls of their own; kind: dyntype where
    they have none.
    """
    lag = base.wanted.lag
    if base.wanted.rise != base.wanted.fall:
        edited.one_lag()
    now = thrusts[0].lag if thrusts else 0.0
    if lag == 0.0 and now > 0.0:
        edited.lack(LAGS, 'a filter of MuJoCo needs a time constant above 0; take out its dyntype')
    elif lag > 0.0 and not thrusts:
        edited.lack(LAGS, 'the file has no thrust of single rotors')
    elif lag > 0.0 and differs(now, lag):
        for push in pushes:
            stated = push.element.get('dynprm', '1').split() if push.lag else ['']
            edited.attribute(push.element, 'dynprm', [lag, *map(float, stated[1:])], 's',
                             base.wanted.sources['rise'], usual=(1.0,))
            if not push.lag:
                edited.word(push.element, 'dyntype', kind)
        _make_general(edited, [push.element for push in pushes if push.element.tag == 'motor'])


def _delay_in_file(base: Base) -> bool:
    """Whether a file holds the delay: where it has one, and the code does not lag behind it."""
    wanted = base.wanted
    lag_of_file = wanted.rise == wanted.fall and not differs(
        base.effect('motor_lag', 'time_constant'), wanted.lag)
    return base.effect('actuation_delay', 'delay') > 0.0 and lag_of_file


def _write_delay(edited: EditedXml, base: Base, thrusts: Sequence[Push],
                 pushes: Sequence[Push], step: float) -> None:
    """Have the actuators hold the delay of the commands; step: of the model, s."""
    delay = base.wanted.delay if _delay_in_file(base) else 0.0
    if base.wanted.delay > 0.0 and not delay:
        edited.lack(['delay'], why_not('actuation_delay'))
    now = base.effect('actuation_delay', 'delay')
    if base.wanted.delay > 0.0 and not delay and len(pushes) > len(thrusts):
        other = next(push for push in pushes if not push.pushes)
        edited.remarks.append(f'{other.element.place()} is a control of its own; delay it in what '
                              'sends it, as the code beside the file does the thrusts')
    if not now or not differs(now, delay):
        return
    for push in pushes:
        edited.attribute(push.element, 'delay', [delay], 's', base.wanted.sources['delay'],
                         usual=(0.0,))
        needed = math.ceil(delay / step * (1.0 - SAME))
        if push.element.number('nsample', 0.0) < needed:
            edited.word(push.element, 'nsample', str(needed))


def _make_general(edited: EditedXml, motors: Sequence[Element]) -> None:
    """Have <motor> elements be <general> ones, which have dynamics and are else the same."""
    for motor in motors:
        edited.renamed_tag(motor, 'general')
        for name, usual in GENERAL.items():
            if motor.get(name, usual) != usual:     # of a default class, not read for a <motor>
                edited.word(motor, name, usual)
    if motors:
        several = f' and {len(motors) - 1} more become' if len(motors) > 1 else ' becomes'
        edited.remarks.append(
            f'{motors[0].place()}{several} <general>, for a <motor> has no lag; thrusts begin at '
            'data.act, which is 0 after a reset')


def _write_body(edited: EditedXml, base: Base, model: Model, part: Part, body: Body) -> None:
    """Have a <body> hold a Body that is given in its axes."""
    wanted = base.wanted
    six = [float(body.inertia[at]) for at in (*MOMENTS, *PRODUCTS)]
    if part.source != 'inertial':
        if model.compiler.get('inertiafromgeom') == 'true':
            raise InputError(f'{part.element.where}: inertiafromgeom="true" takes its mass from '
                             'its shapes; take that out of <compiler>')
        _insert(edited, base, part, body, six)
        return
    inertial = part.element.first('inertial')
    assert inertial is not None
    edited.attribute(inertial, 'mass', [body.mass], 'kg', wanted.sources['mass'])
    edited.attribute(inertial, 'pos', body.centre, 'm', wanted.sources['centre'],
                     usual=(0.0, 0.0, 0.0), size=1.0)
    rotation = model.rotation_of(inertial)
    turned = rotation.T @ body.inertia @ rotation
    size = float(np.max(np.abs(turned)))
    if 'fullinertia' in inertial.attributes:
        edited.attribute(inertial, 'fullinertia',
                         [turned[at] for at in (*MOMENTS, *PRODUCTS)], 'kg m2',
                         wanted.sources['inertia'], size=size)
    elif max(abs(turned[at]) for at in PRODUCTS) <= SAME * size:
        edited.attribute(inertial, 'diaginertia', np.diag(turned), 'kg m2',
                         wanted.sources['inertia'], size=size)
    elif turn := next((name for name in TURNS if name in inertial.attributes), ''):
        axes, diagonal = _principal(turned)
        x, y, z, w = scipy.spatial.transform.Rotation.from_matrix(rotation @ axes).as_quat()
        if turn == 'quat':
            edited.attribute(inertial, 'quat', [w, x, y, z], '1', wanted.sources['inertia'],
                             size=1.0)
        else:       # as angles their numbers would depend on <compiler>
            edited.renamed(inertial, turn, 'quat', [w, x, y, z], '1', wanted.sources['inertia'])
        edited.attribute(inertial, 'diaginertia', diagonal, 'kg m2', wanted.sources['inertia'],
                         size=size)
    else:
        edited.renamed(inertial, 'diaginertia', 'fullinertia', six, 'kg m2',
                       wanted.sources['inertia'])


def _insert(edited: EditedXml, base: Base, part: Part, body: Body, six: list[float]) -> None:
    """Put an <inertial> into a <body> whose mass is that of its shapes."""
    wanted, where = base.wanted, part.element.place('inertial')
    edited.child(part.element, f'<inertial pos="{shown(body.centre)}" mass="{shown([body.mass])}" '
                               f'fullinertia="{shown(six)}"/>')
    before = part.body.placed(part.pose.inverse)
    edited.note(f'{where} mass', before.mass, body.mass, 'kg', wanted.sources['mass'])
    for k, axis in enumerate('xyz'):
        edited.note(f'{where} pos {axis}', float(before.centre[k]), float(body.centre[k]), 'm',
                    wanted.sources['centre'])
    for at, value in zip((*MOMENTS, *PRODUCTS), six, strict=True):
        edited.note(f'{where} fullinertia {"xyz"[at[0]]}{"xyz"[at[1]]}',
                    float(before.inertia[at]), value, 'kg m2', wanted.sources['inertia'])


def _principal(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the principal axes (3, 3), a rotation that is the smallest, and moments (3,)."""
    moments, axes = np.linalg.eigh(matrix)
    orders = np.array(list(permutations(range(3))))
    order = orders[np.argmax(np.abs(axes)[np.arange(3), orders].sum(axis=1))]
    axes, moments = axes[:, order], moments[order]
    axes = axes * np.sign(np.where(np.diag(axes) == 0.0, 1.0, np.diag(axes)))
    if np.linalg.det(axes) < 0.0:
        axes[:, int(np.argmin(np.abs(np.diag(axes))))] *= -1.0
    assert math.isclose(float(np.linalg.det(axes)), 1.0, rel_tol=1e-9)
    return axes, moments


TARGET = Target('mjcf', ('.xml', '.mjcf'),
                frozenset((*BODY, *LAGS, 'moments', 'thrust', 'losses', 'torque', 'torque_losses',
                           'delay')), write, new, code)
