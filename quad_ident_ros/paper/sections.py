# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The tables of the page, one function each."""

import math

from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.signals import GAIN_UNITS, OUTPUT_UNITS, OUTPUTS
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.paper.printed import ERRORS, TABLE_2
from quad_ident_ros.paper.ranking import comparisons, same
from quad_ident_ros.paper.study import EFFORTS, middle, SWARMS
from quad_ident_ros.report.html import join, Markup, markup, table, tag
from quad_ident_ros.report.picture import NAMES

NONE = '–'
LARGE = 1e6     # from here on numbers are written with a power of ten


def number(value, digits=4):
    """Return a number as text; a dash for none."""
    if value is None or not math.isfinite(value):
        return NONE
    whole = 10 ** digits <= abs(value) < LARGE
    return (f'{value:.0f}' if whole else f'{value:.{digits}g}').replace('-', '−')


def both(upper, lower):
    """Return a cell of two lines, or of one where there is no lower."""
    if lower is None:
        return markup(upper)
    return join([markup(upper), Markup('<br>'), tag('span', lower, 'second')], '')


def fits(study, effort):
    """Return the table of K, a, b and the errors of all methods: Tables 2 and 3 of a preset."""
    median, worst = study.pick('median', effort), study.pick('worst', effort)
    rows = []
    for output in study.signals:
        found = {name: fit.outputs[output] for name, fit in median.methods.items()}
        best = min(fit.cost for fit in found.values())
        for place, (name, fit) in enumerate(found.items()):
            other = worst.methods[name].outputs[output] if name in SWARMS else None
            label = METHODS[name].label
            cells = [both(one, None if other is None else two)
                     for one, two in zip(_fit(fit), _fit(other or fit), strict=True)]
            rows.append([f'{NAMES[output]}' if place == 0 else '',
                         tag('span', label, 'best') if same(fit.cost, best) else label, *cells])
    units = ', '.join(f'{output} in {OUTPUT_UNITS[output]}, its K in {GAIN_UNITS[output]}'
                      for output in study.signals)
    return table(['output', 'method', 'K', 'a, 1/s', 'b, 1/s', 'IAE', 'ISE', 'ITAE', 'ITSE',
                  'NRMSE, %'], rows, ('text', 'text') + ('',) * 8, caption=(
                 'The run of median cost and, in grey beneath, the worst run; bold: the smallest '
                 'median cost, or equal to it. IAE to ITSE are integrals over time. Units: '
                 f'{units}.' + _remarks(median)))


def _remarks(identification):
    """Return how models were found, where there is something to say of it."""
    who = {}
    for name, fit in identification.methods.items():
        for output, entry in fit.outputs.items():
            for remark in entry.remarks:
                who.setdefault((METHODS[name].label, remark), []).append(NAMES[output])
    return ''.join(f' {label}, {", ".join(outputs)}: {remark}.'
                   for (label, remark), outputs in who.items())


def _fit(fit):
    if fit.model is None:
        return [NONE] * 8
    model = fit.model
    return [number(model.gain, 5), number(model.a.real), number(model.b.real),
            *[number(fit.errors[name], 3) for name in ERRORS],
            number(fit.errors['nrmse_percent'], 3)]


def spent(study, effort):
    """Return the table of evaluations, time and the total error of all methods."""
    median = study.pick('median', effort)
    bounds = sum(entry['evaluations'] for entry in study.settings['bounds'].values())
    rows = []
    for name, fit in median.methods.items():
        ordered = sorted(study.nrmse(effort, name))
        rows.append([METHODS[name].label, str(fit.evaluations) if fit.evaluations else NONE,
                     number(1e3 * fit.seconds, 3), number(middle(ordered), 3),
                     number(ordered[-1], 3) if name in SWARMS else NONE])
    return table(['method', 'evaluations', 'time, ms', 'NRMSE, % (median)', 'NRMSE, % (worst)'],
                 rows, caption=f'Searched {EFFORTS[effort].label}. NRMSE is the rms over the '
                 'outputs, evaluations are those of all outputs. Finding the bounds took '
                 f'another {bounds} evaluations, once for all methods.')


def references(preset):
    """Return the table of known facts about the responses of a preset."""
    rows = [[entry.output, number(entry.t), number(entry.expected, 10),
             number(entry.computed, 10), number(abs(entry.computed - entry.expected), 2),
             entry.source] for entry in preset.references]
    return table(['output', 't, s', 'must be', 'computed', 'difference', 'known from'], rows,
                 ('text', '', '', '', '', 'text'), caption='Values that are known exactly')


def truth(preset):
    """Return the table of the parameters that a preset was made from."""
    rows = [[output, *(number(value, 7) for value in model)]
            for output, model in preset.truth.items()]
    return table(['output', 'K', 'a, 1/s', 'b, 1/s'], rows,
                 caption='What the responses are made of')


def ranking(study):
    """Return the table of who is better than whom, for each effort, over the seeds."""
    head = ['first', 'second', *(entry.label for entry in EFFORTS.values())]
    columns = [comparisons(study, name) for name in EFFORTS]
    rows = [[METHODS[row[0].first].label, METHODS[row[0].second].label,
             *(_probability(entry) for entry in row)]
            for row in zip(*columns, strict=True)]
    return table(head, rows, ('text', 'text') + ('',) * len(EFFORTS), caption=(
                 'Probability that the first method ends below the second, by the cost of all '
                 'outputs, with its 95 % interval; green: better, red: worse, no colour: '
                 'undecided'))


def ranking_by_output(study, name):
    """Return the table of who is better than whom, for each output, of one effort."""
    columns = [comparisons(study, name, output) for output in study.signals]
    rows = [[METHODS[row[0].first].label, METHODS[row[0].second].label,
             *(_probability(entry) for entry in row)]
            for row in zip(*columns, strict=True)]
    return table(['first', 'second', *study.signals], rows,
                 ('text', 'text') + ('',) * len(study.signals),
                 caption=EFFORTS[name].label)


def _probability(entry):
    kind = {'better': 'yes', 'worse': 'no', 'undecided': ''}[entry.verdict]
    share = f'{100 * entry.probability:.0f} %'
    if entry.count > 1:
        share += f' [{100 * entry.low:.0f}, {100 * entry.high:.0f}]'
    return Markup(f'<td class="{kind}">{share}</td>')


def table_1():
    """Return Table 1: the vehicle, in the units that its values have."""
    vehicle = load_vehicle('paper_quadrotor')
    axes = 'xyz'
    rows = [[f'I{axis}', 'moment of inertia', number(value), 'kg m²', '']
            for axis, value in zip(axes, vehicle.inertia, strict=True)]
    rows[2][4] = 'a flat cross has Iz near Ix + Iy: 1.3e−2 with a dropped digit is likely'
    rows += [[f'Kfa{axis}', 'aerodynamic friction', number(value), 'N m s²/rad²',
              'printed in N/rad/s' if axis == 'x' else '']
             for axis, value in zip(axes, vehicle.rotational_drag, strict=True)]
    rows += [[f'Kft{axis}', 'drag', number(value), 'N s/m',
              'printed in N/rad/s' if axis == 'x' else '']
             for axis, value in zip(axes, vehicle.linear_drag, strict=True)]
    rows += [['g', 'gravity', number(vehicle.gravity), 'm/s²', 'printed in m/s'],
             ['Jr', 'inertia of a rotor', number(vehicle.rotor_inertia, 5), 'kg m²', ''],
             ['b', 'thrust coefficient', number(vehicle.thrust_coefficient, 5), 'N s²/rad²',
              'printed in kg m/rad²'],
             ['d', 'drag coefficient', number(vehicle.torque_coefficient), 'N m s²/rad²',
              'printed in kg m/rad²; enters the rotor speeds only'],
             ['m', 'mass', number(vehicle.mass), 'kg', ''],
             ['l', 'half span', number(vehicle.arm_length), 'm', '']]
    return table(['', 'meaning', 'value', 'unit', 'remark'], rows,
                 ('text', 'text', '', 'text', 'text'), caption='The vehicle as printed')


def table_2(printed):
    """Return Table 2, and how well its models fit the responses that Table 3 implies."""
    rows = []
    for output in OUTPUTS:
        for place, (method, model) in enumerate(TABLE_2[output].items()):
            nrmse = printed.methods[method].outputs[output].errors['nrmse_percent']
            rows.append([NAMES[output] if place == 0 else '', METHODS[method].label,
                         *(number(value, 6) for value in model), number(nrmse, 3)])
    return table(['output', 'method', 'K', 'a, 1/s', 'b, 1/s', 'implied NRMSE, %'], rows,
                 ('text', 'text', '', '', '', ''), caption='The models as printed')


def table_3(cells):
    """Return Table 3 as printed beside the sums that Table 2 gives."""
    head = ['output', 'method']
    for name in ERRORS:
        head += [name.upper(), 'ratio']
    rows, line = [], {}
    for cell in cells:
        line.setdefault((cell.output, cell.method), []).append(cell)
    for (output, method), found in line.items():
        row = [NAMES[output] if method == 'pso' else '', METHODS[method].label]
        for cell in found:
            kind = '' if cell.agrees else 'warn'
            row += [both(number(cell.printed, 5), number(cell.computed, 5)),
                    Markup(f'<td class="{kind}">{cell.ratio:.3f}</td>')]
        rows.append(row)
    return table(head, rows, ('text', 'text') + ('',) * (2 * len(ERRORS)), caption=(
                 'Printed and, in grey beneath, computed; ratio: computed over printed'))


def ls_printed(reproduction):
    """Return LS by the printed formulas beside LS by the right ones."""
    rows = []
    for name, found in reproduction.printed_fits.items():
        right = reproduction.studies[name].pick('median', 'per_output').methods['ls'].outputs
        for place, fit in enumerate(found):
            cells = [_complex(value) for value in fit.parameters or (None,) * 3]
            rows.append([name if place == 0 else '', fit.output, *cells,
                         number(fit.nrmse_percent, 2), *_fit(right[fit.output])[:3],
                         _fit(right[fit.output])[-1]])
    return table(['preset', 'output', 'K printed', 'a', 'b', 'NRMSE, %', 'K right', 'a', 'b',
                  'NRMSE, %'], rows, ('text', 'text') + ('',) * 8, caption=(
                 'NRMSE of the printed formulas: that of the real parts; a dash: no number at '
                 'all'))


def round_trips(trips):
    """Return the models of Table 2 through eqs. (36) and (37) and back."""
    rows = [[NAMES[trip.output] if trip.method == 'pso' else '', METHODS[trip.method].label,
             *(number(value, 6) for value in trip.model),
             *(_complex(value) for value in trip.printed or (None,) * 3),
             *(number(value, 6) for value in trip.right or (None,) * 3)] for trip in trips]
    return table(['output', 'method', 'K', 'a', 'b', 'K printed', 'a', 'b', 'K right', 'a', 'b'],
                 rows, ('text', 'text') + ('',) * 9,
                 caption="Table 2's models, through the printed formulas and the right ones")


def _complex(value):
    if value is None or not (math.isfinite(value.real) and math.isfinite(value.imag)):
        return NONE
    if value.imag == 0:
        return number(value.real, 3)
    return f'{number(value.real, 3)} {"−" if value.imag < 0 else "+"} ' \
           f'{number(abs(value.imag), 3)}j'


def printed_equations(cases):
    """Return how the runs of the printed equations ended."""
    rows = [[case.label, case.vehicle.removeprefix('paper_quadrotor').strip('_') or 'as printed',
             f'{case.duration:g}', Markup(f'<td class="text {_ended(case.status)}">'
                                          f'{case.status}</td>'),
             f'{case.end_time:.5g}' if case.status != 'complete' else NONE,
             number(case.expected, 5), case.source, case.derived] for case in cases]
    return table(['inputs', 'vehicle', 'flown, s', 'as printed', 'ended at, s', 'expected, s',
                  'known from', 'derived right'], rows,
                 ('text', 'text', '', 'text', '', '', 'text', 'text'),
                 caption='How the runs of the printed equations end')


def _ended(status):
    return 'yes' if status == 'complete' else 'no'
