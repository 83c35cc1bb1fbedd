# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the paper claims, and what of it holds by the numbers of a reproduction."""

from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.signals import OUTPUTS
from quad_ident_ros.paper.printed import BOX, CPU_SECONDS, DURATION, ERRORS, TABLE_2, TABLE_3
from quad_ident_ros.paper.ranking import between
from quad_ident_ros.paper.study import EFFORTS, PAPERS, SWARMS
from quad_ident_ros.paper.table3 import EXCHANGED, table_3, TOLERANCE

HOLDS, IN_PART, FAILS, OPEN = 'holds', 'holds in part', 'does not hold', 'undecided'

GOOD = 1.0          # % of range: a model whose NRMSE is below describes its response
NEAR = 0.1          # relative difference up to which a gain counts as that of Table 2
FEW = 4             # cases that are named one by one
OURS = 'vp'         # the project's own method, where it is among METHODS


@dataclass(frozen=True)
class Claim:
    """
    A claim: short text, where the paper makes it, its verdict, and the numbers that say so.

    One about everything (_claim: refutable) does not hold when a single case refutes it.
    score: in how many cases it is so, or the number that decides.
    """

    text: str
    where: str
    verdict: str
    score: str
    numbers: str


def claims(reproduction):
    """Return the Claims that the experiments of a Reproduction can say something about."""
    found = [_equations(reproduction), _duration(reproduction), _box(), _table_3(reproduction),
             _smallest_in_table_3(), _ls_formulas(reproduction)]
    names = [name for name in reproduction.presets if name.startswith('paper_unit_steps')]
    if names:
        found = [_model_class(reproduction, names), _inputs(reproduction, names),
                 _table_2(reproduction, names), *found]
    found += [*_rankings(reproduction), _time(reproduction)]
    return [*found, _ours(reproduction)] if OURS in METHODS else found


def _claim(text, where, good, total, numbers, refutable=False):
    """Return the Claim of what is so in `good` of `total` cases; refutable: by a single one."""
    part = FAILS if refutable or not good else IN_PART
    return Claim(text, where, HOLDS if good == total else part, f'{good} of {total}', numbers)


def _model_class(reproduction, names):
    best = {name: {output: _best_nrmse(reproduction.studies[name], output) for output in OUTPUTS}
            for name in names}
    good = sum(value < GOOD for values in best.values() for value in values.values())
    texts = [f'{_short(name)}: '
             + ', '.join(f'{output} {value:.2g} %' for output, value in values.items())
             for name, values in best.items()]
    return _claim('Models K/((s+a)(s+b)) represent the responses to unit steps', 'sections 3, 7',
                  good, len(names) * len(OUTPUTS),
                  f'Best NRMSE of any method, which must be below {GOOD:g} %: {"; ".join(texts)}')


def _best_nrmse(study, output):
    """Return the smallest NRMSE, %, of an output by any method, seed and effort."""
    found = [fit.outputs[output].errors['nrmse_percent'] for by_method in study.fits.values()
             for fits in by_method.values() for fit in fits if fit.outputs[output].model]
    return min(found, default=np.inf)


def _short(name):
    return name.removeprefix('paper_unit_steps_')


def _inputs(reproduction, names):
    problems = [reproduction.presets[name].infeasible for name in names]
    return _claim('U1 = U2 = U3 = U4 = 1 is an input of this quadrotor', 'section 3',
                  problems.count(None), len(problems),
                  problems[0] or 'rotor speeds exist that give it')


def _table_2(reproduction, names):
    near, printed_only, texts = set(), set(), []
    for name in names:
        study = reproduction.studies[name].pick('median', 'per_output')
        best = [min((fits.outputs[output] for fits in study.methods.values()),
                    key=lambda fit: fit.cost) for output in study.signals]
        best = [fit for fit in best if fit.model]
        agreeing = {fit.output for fit in best
                    if abs(fit.model.gain / TABLE_2[fit.output]['pso_cs'][0] - 1) <= NEAR}
        (printed_only if 'printed' in name else near).update(agreeing)
        texts.append(f'{_short(name)}: '
                     + ', '.join(f'{fit.output} {fit.model.gain:.4g}' for fit in best))
    printed = ', '.join(f'{output} {TABLE_2[output]["pso_cs"][0]:.4g}' for output in OUTPUTS)
    which = f'{", ".join(sorted(near))}: ' if near else ''
    also = (f' In the printed equations alone: {", ".join(sorted(printed_only))}.'
            if printed_only else '')
    return _claim('The gains of Table 2 are those of this quadrotor under unit steps', 'Table 2',
                  len(near), len(OUTPUTS),
                  f'{which}K within {100 * NEAR:.0f} % of that of PSO-CS, by the equations '
                  f'derived from (1)-(12).{also} '
                  f'Printed: {printed}. Found by the best method: {"; ".join(texts)}')


def _equations(reproduction):
    cases = reproduction.cases
    wrong = sum(case.status != case.derived for case in cases)
    return _claim('Equations (13)-(18) are the motion of eqs. (1)-(12)', 'section 2',
                  len(cases) - wrong, len(cases),
                  f'{wrong} of {len(cases)} runs of the printed equations diverge, where the '
                  'equations derived from (1)-(12) do not', refutable=True)


def _duration(reproduction):
    long = [case for case in reproduction.cases if case.duration == DURATION]
    times = ', '.join(f'{case.end_time:.3g} s' for case in long)
    return _claim(f'Equations (13)-(18) under unit steps have responses over {DURATION:g} s',
                  'section 6', sum(case.status == 'complete' for case in long), len(long),
                  f'With three sizes of the integration step they end at {times}')


def _box():
    values = [value for models in TABLE_2.values() for name, model in models.items()
              if name in SWARMS for value in model]
    return _claim(f'The search space [{BOX[0]:g}, {BOX[1]:g}] contains all solutions',
                  'section 4.4', sum(BOX[0] <= value <= BOX[1] for value in values), len(values),
                  'Values of the search methods in Table 2 that lie within it', refutable=True)


def _table_3(reproduction):
    cells = reproduction.cells
    as_labelled = sum(cell.agrees for cell in table_3(exchanged=()))
    return _claim('Table 3 gives the errors of the models of Table 2', 'Table 3',
                  sum(cell.agrees for cell in cells), len(cells),
                  f'Cells within {100 * TOLERANCE:.0f} %, as plain sums without powers of ten, '
                  f'not as integrals, and with PSO and PSO-CS exchanged for '
                  f'{" and ".join(EXCHANGED)}; {as_labelled} as labelled')


def _smallest_in_table_3():
    printed = _smallest({(output, method, error): value for output in OUTPUTS
                         for method, row in TABLE_3[output].items()
                         for error, value in zip(ERRORS, row, strict=True)})
    computed = _smallest({(cell.output, cell.method, cell.error): cell.computed
                          for cell in table_3(exchanged=())})
    total = len(OUTPUTS) * len(ERRORS)
    return _claim('All errors are smallest with PSO-CS', 'section 6, Table 3', computed, total,
                  f'With the models that Table 2 calls PSO-CS; {printed} of {total} with the '
                  'errors that Table 3 prints', refutable=True)


def _smallest(table):
    """Return in how many columns PSO-CS is smallest; table: value by (output, method, error)."""
    return sum(min(PAPERS, key=lambda method: table[output, method, error]) == 'pso_cs'
               for output in OUTPUTS for error in ERRORS)


def _rankings(reproduction):
    """Return the claims on which method is better than which."""
    budgets = {'at 20 generations': ('per_output', 'joint'),
               'at equal evaluations': ('per_output_equal', 'joint_equal')}
    found = []
    for pairs, text in (((('pso_cs', 'pso'),), 'PSO-CS is better than PSO'),
                        ((('pso', 'cs'), ('pso_cs', 'cs')), 'PSO and PSO-CS are better than CS')):
        found += [_versus(reproduction, f'{text}, {label}', 'sections 6, 7', pairs, efforts)
                  for label, efforts in budgets.items()]
    worst = tuple((method, 'ls') for method in SWARMS)
    for effort, label in (('per_output', 'one search per output'),
                          ('joint', 'one search for all outputs')):
        found.append(_versus(reproduction, f'LS is worse than PSO, CS and PSO-CS, {label}',
                             'section 6', worst, (effort,)))
    return found


def _versus(reproduction, text, where, pairs, efforts):
    """Return the Claim that the first method of each pair is better in all experiments."""
    entries = [(name, effort, between(study, effort, *pair))
               for name, study in reproduction.studies.items()
               for effort in efforts for pair in pairs]
    better = sum(entry.verdict == 'better' for _, _, entry in entries)
    worse = sum(entry.verdict == 'worse' for _, _, entry in entries)
    shares = []
    for effort in efforts:
        values = [100 * entry.probability for _, used, entry in entries if used == effort]
        shares.append(f'{_kind(effort)} {min(values):.0f} to {max(values):.0f} %')
    against = '; '.join(f'{_short(name)}, {_kind(effort)}: {METHODS[entry.first].label} before '
                        f'{METHODS[entry.second].label} {100 * entry.probability:.0f} %'
                        for name, effort, entry in entries if entry.verdict == 'worse')
    claim = _claim(text, where, better, len(entries),
                   f'The opposite in {worse}, undecided in {len(entries) - better - worse}. '
                   f'Probabilities: {"; ".join(shares)}'
                   + (f'. The opposite: {against}' if 0 < worse <= FEW else ''))
    claim = replace(claim, score=claim.score + (f', opposite in {worse}' if worse else ''))
    return claim if better or worse else replace(claim, verdict=OPEN)


def _kind(effort):
    return EFFORTS[effort].search.replace('_', ' ')


def _ls_formulas(reproduction):
    trips = reproduction.trips
    return _claim('Equations (36), (37) lead from K, a, b to a0, a1, b0, b1 and back', 'section 5',
                  sum(trip.printed_restores for trip in trips), len(trips),
                  'Models of Table 2 that are the same after both; with the formulas corrected '
                  f'{sum(trip.right_restores for trip in trips)} of {len(trips)}')


def _time(reproduction):
    spent, seconds = {}, {}
    for name in ('pso', 'pso_cs'):
        fits = [fit for study in reproduction.studies.values()
                for fit in study.fits['per_output'][name]]
        spent[name] = sum(fit.evaluations for fit in fits)
        seconds[name] = sum(fit.seconds for fit in fits)
    ratio = seconds['pso_cs'] / seconds['pso']
    return Claim('PSO-CS takes more time than PSO', 'sections 6, 7',
                 HOLDS if ratio > 1 else FAILS, f'{ratio:.1f} times',
                 f'For {spent["pso_cs"] / spent["pso"]:.2f} times the evaluations; printed: '
                 f'{CPU_SECONDS["pso_cs"] / CPU_SECONDS["pso"]:.2f} times the time')


def _ours(reproduction):
    rivals = [between(study, effort, OURS, method)
              for study in reproduction.studies.values() for effort in study.fits
              for method in PAPERS if METHODS[method].search or effort == 'per_output']
    worse = sum(entry.verdict == 'worse' for entry in rivals)
    better = sum(entry.verdict == 'better' for entry in rivals)
    good = sum(entry.is_not_worse for entry in rivals)
    label = METHODS[OURS].label
    claim = _claim(f'No method of the paper is better than {label}', 'this project', good,
                   len(rivals), f'{label} is better in {better}, and as good or better in '
                   f'{good - better} more; worse in {worse}, undecided in '
                   f'{len(rivals) - good - worse}', refutable=True)
    return replace(claim, verdict=OPEN) if good < len(rivals) and not worse else claim
