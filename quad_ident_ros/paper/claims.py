# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the paper claims, and what of it holds by the numbers of a reproduction."""

from dataclasses import dataclass

import numpy as np

from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.signals import OUTPUTS
from quad_ident_ros.paper.printed import BOX, CPU_SECONDS, DURATION, ERRORS, TABLE_2, TABLE_3
from quad_ident_ros.paper.ranking import between
from quad_ident_ros.paper.study import PAPERS, SWARMS
from quad_ident_ros.paper.table3 import EXCHANGED, table_3, TOLERANCE

HOLDS, IN_PART, FAILS, OPEN = 'holds', 'holds in part', 'does not hold', 'undecided'

GOOD = 1.0          # % of range: a model whose NRMSE is below describes its response
NEAR = 0.1          # relative difference up to which a gain counts as that of Table 2
OURS = 'vp'         # the project's own method, where it is among METHODS


@dataclass(frozen=True)
class Claim:
    """A claim: short text, where the paper makes it, its verdict, and the numbers that say so."""

    text: str
    where: str
    verdict: str
    numbers: str


def claims(reproduction):
    """Return the Claims that the experiments of a Reproduction can say something about."""
    found = [_model_class(reproduction), _equations(reproduction), _duration(reproduction),
             _inputs(reproduction), _box(), _table_2(reproduction), _table_3(reproduction),
             _smallest_in_table_3(reproduction)]
    found += _rankings(reproduction)
    found += [_ls_formulas(reproduction), _time(reproduction), _ours(reproduction)]
    return [claim for claim in found if claim is not None]


def _all_verdict(good, total):
    """Return the verdict of a claim that one counterexample refutes."""
    return HOLDS if good == total else FAILS


def _share_verdict(good, total):
    """Return the verdict of a claim that is true in `good` of `total` cases."""
    if good == total:
        return HOLDS
    return IN_PART if good else FAILS


def _unit_steps(reproduction):
    return [name for name in reproduction.presets if name.startswith('paper_unit_steps')]


def _best_nrmse(study, output):
    """Return the smallest NRMSE, %, of an output by any method, seed and effort."""
    found = [fit.outputs[output].errors['nrmse_percent'] for by_method in study.fits.values()
             for fits in by_method.values() for fit in fits if fit.outputs[output].model]
    return min(found, default=np.inf)


def _model_class(reproduction):
    names = _unit_steps(reproduction)
    if not names:
        return None
    best = {name: {output: _best_nrmse(reproduction.studies[name], output) for output in OUTPUTS}
            for name in names}
    good = sum(value < GOOD for values in best.values() for value in values.values())
    texts = [f'{name.removeprefix("paper_unit_steps_")}: '
             + ', '.join(f'{output} {value:.2g} %' for output, value in values.items())
             for name, values in best.items()]
    return Claim('Four models K/((s+a)(s+b)) represent the responses to unit steps',
                 'sections 3, 7', _share_verdict(good, len(names) * len(OUTPUTS)),
                 f'best NRMSE of any method, below {GOOD:g} % for {good} of '
                 f'{len(names) * len(OUTPUTS)}: {"; ".join(texts)}')


def _equations(reproduction):
    cases = reproduction.cases
    wrong = [case for case in cases if case.status != case.derived]
    return Claim('Equations (13)-(18) are the motion of eqs. (1)-(12)', 'section 2',
                 _all_verdict(len(cases) - len(wrong), len(cases)),
                 f'{len(wrong)} of {len(cases)} runs of the printed equations diverge, where the '
                 'equations derived from (1)-(12) do not')


def _duration(reproduction):
    long = [case for case in reproduction.cases if case.duration == DURATION]
    lasting = sum(case.status == 'complete' for case in long)
    times = ', '.join(f'{case.end_time:.3g} s' for case in long)
    return Claim(f'Equations (13)-(18) under unit steps have responses over {DURATION:g} s',
                 'section 6',
                 _share_verdict(lasting, len(long)),
                 f'the printed equations last {DURATION:g} s in {lasting} of {len(long)} step '
                 f'sizes; they end at {times}')


def _inputs(reproduction):
    problems = [reproduction.presets[name].infeasible for name in _unit_steps(reproduction)]
    if not problems:
        return None
    return Claim('U1 = U2 = U3 = U4 = 1 is an input of this quadrotor', 'section 3',
                 _share_verdict(problems.count(None), len(problems)),
                 problems[0] or 'rotor speeds exist that give it')


def _box():
    values = [value for models in TABLE_2.values() for model in models.values()
              for value in model]
    inside = sum(BOX[0] <= value <= BOX[1] for value in values)
    return Claim(f'The search space [{BOX[0]:g}, {BOX[1]:g}] contains all solutions',
                 'section 4.4', _all_verdict(inside, len(values)),
                 f'{inside} of the {len(values)} values of Table 2 lie in it')


def _table_2(reproduction):
    names = _unit_steps(reproduction)
    if not names:
        return None
    near, texts = set(), []
    for name in names:
        study = reproduction.studies[name].pick('median')
        best = [min((fits.outputs[output] for fits in study.methods.values()),
                    key=lambda fit: fit.cost) for output in study.signals]
        for fit in best:
            wanted = TABLE_2[fit.output]['pso_cs'][0]
            if fit.model and abs(fit.model.gain / wanted - 1) <= NEAR:
                near.add(fit.output)
        texts.append(f'{name.removeprefix("paper_unit_steps_")}: '
                     + ', '.join(f'{fit.output} {fit.model.gain:.4g}' for fit in best
                                 if fit.model))
    printed = ', '.join(f'{output} {TABLE_2[output]["pso_cs"][0]:.4g}' for output in OUTPUTS)
    which = f' ({", ".join(sorted(near))})' if near else ''
    return Claim('The gains of Table 2 are those of this quadrotor under unit steps', 'Table 2',
                 _share_verdict(len(near), len(OUTPUTS)),
                 f'{len(near)} of {len(OUTPUTS)} outputs{which} within {NEAR:.0%} of PSO-CS '
                 f'in any experiment. Printed K: {printed}. Found: {"; ".join(texts)}')


def _table_3(reproduction):
    cells = reproduction.cells
    good = sum(cell.agrees for cell in cells)
    as_labelled = sum(cell.agrees for cell in table_3(exchanged=()))
    return Claim('Table 3 gives the errors of the models of Table 2', 'Table 3',
                 _share_verdict(good, len(cells)),
                 f'{good} of {len(cells)} cells within {TOLERANCE:.0%} when PSO and PSO-CS are '
                 f'exchanged for {" and ".join(EXCHANGED)}, {as_labelled} as labelled; as plain '
                 'sums without powers of ten, not as integrals')


def _smallest(table):
    """Return in how many columns PSO-CS is smallest; table: value by (output, method, error)."""
    return sum(min(PAPERS, key=lambda method: table[output, method, error]) == 'pso_cs'
               for output in OUTPUTS for error in ERRORS)


def _smallest_in_table_3(reproduction):
    total = len(OUTPUTS) * len(ERRORS)
    printed = _smallest({(output, method, error): value for output in OUTPUTS
                         for method, row in TABLE_3[output].items()
                         for error, value in zip(ERRORS, row, strict=True)})
    computed = _smallest({(cell.output, cell.method, cell.error): cell.computed
                          for cell in table_3(exchanged=())})
    return Claim('All errors are smallest with PSO-CS', 'section 6, Table 3',
                 _all_verdict(computed, total),
                 f'{printed} of {total} errors as Table 3 prints them, {computed} of {total} by '
                 'the models that Table 2 calls PSO-CS')


def _rankings(reproduction):
    """Return the claims on which method is better than which."""
    if not reproduction.studies:
        return []
    budgets = {'at 20 generations': ('per_output', 'joint'),
               'at equal evaluations': ('per_output_equal', 'joint_equal')}
    found = []
    for pairs, text in (((('pso_cs', 'pso'),), 'PSO-CS is better than PSO'),
                        ((('pso', 'cs'), ('pso_cs', 'cs')), 'PSO and PSO-CS are better than CS')):
        found += [_versus(reproduction, f'{text}, {label}', 'sections 6, 7', pairs, efforts)
                  for label, efforts in budgets.items()]
    worst = tuple((method, 'ls') for method in SWARMS)
    for effort, label in (('per_output', 'gain solved for, one search per output'),
                          ('joint', 'one search over 12 parameters')):
        found.append(_versus(reproduction, f'LS is worse than PSO, CS and PSO-CS ({label})',
                             'section 6', worst, (effort,)))
    return found


def _versus(reproduction, text, where, pairs, efforts):
    """Return the Claim that the first method of each pair is better in all experiments."""
    entries = [(name, effort, between(study, effort, *pair))
               for name, study in reproduction.studies.items()
               for effort in efforts for pair in pairs]
    better = sum(entry.verdict == 'better' for _, _, entry in entries)
    worse = sum(entry.verdict == 'worse' for _, _, entry in entries)
    verdict = _share_verdict(better, len(entries))
    if not better and not worse:
        verdict = OPEN
    shares = []
    for effort in efforts:
        values = [entry.probability for _, found, entry in entries if found == effort]
        shares.append(f'{effort.replace("_equal", "").replace("_", " ")} {min(values):.0%} to '
                      f'{max(values):.0%}')
    return Claim(text, where, verdict,
                 f'so in {better}, the opposite in {worse}, undecided in '
                 f'{len(entries) - better - worse} of {len(entries)} comparisons at 95 %; '
                 f'probability by experiment: {"; ".join(shares)}')


def _ls_formulas(reproduction):
    trips = reproduction.trips
    printed = sum(trip.printed_restores for trip in trips)
    right = sum(trip.right_restores for trip in trips)
    return Claim('Equations (36), (37) lead from K, a, b to a0, a1, b0, b1 and back', 'section 5',
                 _share_verdict(printed, len(trips)),
                 f'{printed} of the {len(trips)} models of Table 2 come back as printed, {right} '
                 'with the formulas put right')


def _time(reproduction):
    if not reproduction.studies:
        return None
    spent, seconds = {}, {}
    for name in ('pso', 'pso_cs'):
        fits = [fit for study in reproduction.studies.values()
                for fit in study.fits['per_output'][name]]
        spent[name] = np.mean([fit.evaluations for fit in fits])
        seconds[name] = np.sum([fit.seconds for fit in fits])
    ratio = seconds['pso_cs'] / seconds['pso']
    return Claim('PSO-CS takes more time than PSO', 'sections 6, 7',
                 HOLDS if ratio > 1 else FAILS,
                 f'{ratio:.1f} times (printed: {CPU_SECONDS["pso_cs"] / CPU_SECONDS["pso"]:.2f}), '
                 f'for {spent["pso_cs"] / spent["pso"]:.2f} times the evaluations')


def _ours(reproduction):
    if OURS not in METHODS or not reproduction.studies:
        return None
    rivals = [between(study, effort, OURS, method)
              for study in reproduction.studies.values() for effort in study.fits
              for method in PAPERS]
    worse = sum(entry.verdict == 'worse' for entry in rivals)
    better = sum(entry.verdict == 'better' for entry in rivals)
    return Claim(f'No method of the paper is better than {METHODS[OURS].label}', 'this project',
                 _share_verdict(len(rivals) - worse, len(rivals)),
                 f'{METHODS[OURS].label} is better in {better}, equal or undecided in '
                 f'{len(rivals) - better - worse}, worse in {worse} of {len(rivals)} comparisons')
