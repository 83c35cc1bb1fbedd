# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Write the tables of docs/effects.md: `.venv/bin/python -m docs.effects`."""

from pathlib import Path

import numpy as np

from benchmarks.tables import keep, markdown
from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.effects.registry import EFFECTS, vector
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.model.dynamics import Course, course_of, predict, states_of
from quad_ident_ros.model.vehicle import load_vehicle

FLIGHTS = Path(__file__).resolve().parents[1] / 'test' / 'data' / 'rotorpy'
NAMES = ('crazyflie', 'hummingbird')
FINER = (1, 4, 10, 100)


def effects_table():
    """Return what each effect is, what shows it, and what resembles it."""
    lines = ['| effect | what it is | forms | what a flight must do to show it | looks like |',
             '| --- | --- | --- | --- | --- |']
    for effect in EFFECTS.values():
        alike = ', '.join(f'`{name}`' for name in effect.confused_with) or '–'
        forms = ', '.join(f'`{form.name}`' for form in effect.forms)
        lines.append(f'| `{effect.name}` | {effect.title} | {forms} | {effect.excitation} | '
                     f'{alike} |')
    return '\n'.join(lines)


def forms_table():
    """Return the forms of each effect, the usual one first: what they are, formula and source."""
    lines = ['| effect | form | formula and source |', '| --- | --- | --- |']
    for effect in EFFECTS.values():
        for k, form in enumerate(effect.forms):
            lines.append(f'| {f"`{effect.name}`" if k == 0 else ""} | `{form.name}` | '
                         f'**{form.title}**: {_escaped(form.source)} |')
    return '\n'.join(lines)


def parameters_table():
    """Return the parameters of all forms: unit, value without effect, bounds and meaning."""
    lines = ['| effect | form | parameter | unit | none | bounds | usual | what |',
             '| --- | --- | --- | --- | --: | --: | --: | --- |']
    for effect in EFFECTS.values():
        for form in effect.forms:
            parameters = form.parameters
            if effect.per_rotor:
                first, last = parameters[0], parameters[-1]
                rows = [(first, f'`{first.name}` … `{last.name}`',
                         first.description.replace('rotor 1', 'the rotor of this number'))]
            else:
                rows = [(each, f'`{each.name}`', each.description) for each in parameters]
            for k, (parameter, name, what) in enumerate(rows):
                whose = f'`{effect.name}`' if k == 0 and form is effect.forms[0] else ''
                lines.append(f'| {whose} | {f"`{form.name}`" if k == 0 else ""} | {name} | '
                             f'{parameter.unit} | {parameter.null:g} | {parameter.lower:g} to '
                             f'{parameter.upper:g}{_identified(parameter)} | '
                             f'{parameter.size:g} | {what} |')
    return '\n'.join(lines)


def _identified(parameter):
    most = parameter.identified
    return '' if np.isinf(most) else f'; identified {-most:g} to {most:g}'


def _escaped(text):
    return text.replace('|', r'\|').replace('*', r'\*')


def flown(name):
    """Return the vehicle and the record of a flight of rotorpy."""
    return load_vehicle(FLIGHTS / f'{name}.yaml'), read_csv(FLIGHTS / f'{name}.csv')


def differences(vehicle, record, finer=1, theta=None):
    """
    Return how far a prediction ends from the record, (4,): m, m/s, rad, rad/s.

    Args: finer: parts into which each sample is divided; theta (P,): by default the vehicle's.
    """
    course, states = course_of(record, vehicle), states_of(record)
    t = np.linspace(course.t[0], course.t[-1], (len(course.t) - 1) * finer + 1)
    commands = np.repeat(course.commands, finer, axis=0)[:len(t)]
    theta = vector(vehicle.effects, vehicle) if theta is None else theta
    last = predict(vehicle, theta, Course(t, commands, np.zeros(len(t))), states[:1], [0],
                   len(t) - 1)[0, -1]
    turn = rotation_matrix(last[6:10]).T @ rotation_matrix(states[-1, 6:10])
    skew = turn - turn.T
    angle = np.arcsin(np.linalg.norm([skew[2, 1], skew[0, 2], skew[1, 0]]) / 2)
    return np.array([np.linalg.norm(last[:3] - states[-1, :3]),
                     np.linalg.norm(last[3:6] - states[-1, 3:6]), angle,
                     np.linalg.norm(last[10:] - states[-1, 10:])])


def rotorpy_table():
    """Return the differences from rotorpy over its flights, by the step of the integration."""
    rows = []
    for name in NAMES:
        vehicle, record = flown(name)
        for finer in FINER:
            step = min(record.period() / finer, 0.01) * 1e3
            found = differences(vehicle, record, finer)
            rows.append((name, f'{step:g}', *(f'{value:.0e}' for value in found)))
    return markdown(('vehicle', 'step, ms', 'position, m', 'velocity, m/s', 'attitude, rad',
                     'rate, rad/s'), rows)


def main():
    """Write the tables into the page."""
    for name, table in (('effects', effects_table()), ('forms', forms_table()),
                        ('parameters', parameters_table()), ('rotorpy', rotorpy_table())):
        keep('effects.md', name, table)


if __name__ == '__main__':
    main()
