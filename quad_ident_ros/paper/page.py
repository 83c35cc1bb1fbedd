# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The page and the pictures of a reproduction."""

from functools import partial

from quad_ident_ros import __version__
from quad_ident_ros.paper import sections
from quad_ident_ros.paper.claims import FAILS, HOLDS, IN_PART, OPEN
from quad_ident_ros.paper.divergence import SHORT
from quad_ident_ros.paper.printed import DURATION
from quad_ident_ros.paper.study import EFFORTS, EQUAL_BUDGET
from quad_ident_ros.paper.table3 import EXCHANGED, OUTLIERS, PERIOD, POWERS, SAMPLES, TOLERANCE
from quad_ident_ros.report.html import details, join, Markup, markup, table, tag, write_page
from quad_ident_ros.report.picture import save_responses, save_spread
from quad_ident_ros.report.svg import Figure

TITLE = 'The paper, reproduced'
KINDS = {HOLDS: 'yes', IN_PART: 'part', FAILS: 'no', OPEN: ''}
FIGURES = 'figures_4_to_7'


def figures(reproduction):
    """Return {name: Figure} of a reproduction."""
    made = {FIGURES: Figure(
        partial(_save_fits, reproduction.printed,
                "Figures 4-7: the responses that Table 3 implies, and Table 2's models",
                'implied'),
        'Responses of Table 2 and those that Table 3 implies',
        'Figures 4 to 7 of the paper, drawn from its tables')}
    for name, study in reproduction.studies.items():
        made[f'responses_{name}'] = Figure(
            partial(_save_fits, study.pick('median', 'per_output'),
                    f'{name}: responses and fits', 'measured'),
            f'Responses and fits of {name}',
            f'Figures 4 to 7 for {name}: measured, fitted, and their difference (the run of '
            'median cost of each method)')
        made[f'ranking_{name}'] = Figure(
            partial(_save_ranking, study, f'{name}: {reproduction.seeds} seeds'),
            f'Errors of each method on {name}',
            f'Each dot is one seed. CS and PSO-CS spend {EQUAL_BUDGET} evaluations per search '
            'in the generations of the paper, PSO about half of that: the equal budget gives '
            'PSO more generations.')
    return made


def _save_fits(identification, title, given, path):
    save_responses(identification, path, title, given)


def _save_ranking(study, title, path):
    save_spread({effort.label: {method: study.nrmse(key, method) for method in study.fits[key]}
                 for key, effort in EFFORTS.items()}, path, title, 'NRMSE of all outputs, %')


def write(path, reproduction, claims, pictures):
    """
    Write the page; raises InputError where the file cannot be written.

    Args: pictures: {name: drawing of a page} of figures(reproduction).
    """
    body = [_introduction(reproduction), _contents(reproduction), _conclusions(claims)]
    body += [_preset(reproduction, name, pictures) for name in reproduction.presets]
    body += [_tables(reproduction, pictures), _least_squares(reproduction),
             _equations(reproduction)]
    write_page(path, TITLE, join(body))


def _heading(anchor, title):
    return Markup(f'<h2 id="{anchor}">{markup(title)}</h2>')


def _introduction(reproduction):
    return tag('p', 'Quadrotor Identification through the Cooperative Particle Swarm '
                    'Optimization-Cuckoo Search Approach (El gmili, Mjahed, El kari, Ayad, '
                    f'2019), recomputed by quad_ident_ros {__version__} with '
                    f'{reproduction.seeds} seeds of each search. Everything on this page, the '
                    'conclusions too, follows from the numbers of this run; paper.json has them.')


def _contents(reproduction):
    entries = [('conclusions', 'Conclusions'), *((name, name) for name in reproduction.presets),
               ('tables', 'Tables 1 to 3 as printed'), ('ls', 'Least squares as printed'),
               ('equations', 'The equations as printed')]
    return tag('p', join((Markup(f'<a href="#{anchor}">{markup(title)}</a>')
                          for anchor, title in entries), ' · '))


def _conclusions(claims):
    rows = [[Markup(f'<td class="prose">{markup(claim.text)}<br>'
                    f'{tag("span", claim.where, "second")}</td>'),
             tag('span', claim.verdict, f'tag {KINDS[claim.verdict]}'), claim.score,
             Markup(f'<td class="prose">{markup(claim.numbers)}</td>')] for claim in claims]
    return join([
        _heading('conclusions', 'Conclusions'),
        tag('p', 'A claim holds if it is true in all cases, holds in part if it is true in some, '
                 'and does not hold if it is true in none. A claim about everything (equations '
                 'that are the same, a space that contains all solutions, the smallest of all '
                 'errors, no better method) does not hold if a single case refutes it.'),
        tag('p', 'For claims that one method is better than another, each experiment, search and '
                 'pair of methods is a case; cases in which the opposite is true are counted as '
                 'well. A method is better if the 95 % interval of the probability that it ends '
                 'below the other lies above one half, where a tie counts half for each. A case '
                 'is undecided if the interval contains one half, and a claim is undecided if all '
                 'its cases are. That no method is better is decided in a case only if the 95 % '
                 'interval of the probability that the other ends below lies under one half; a '
                 'single case that is not decided leaves the claim undecided.'),
        table(['claim', 'verdict', 'score', 'the numbers'], rows,
              ('text', 'text', 'text', 'text'), caption='Claims of the paper')])


def _preset(reproduction, name, pictures):
    preset, study = reproduction.presets[name], reproduction.studies[name]
    parts = [_heading(name, name), tag('p', preset.title + '.')]
    if preset.infeasible:
        parts.append(tag('p', f'Not feasible: {preset.infeasible}.'))
    parts += [tag('p', f'Note: {remark}.') for remark in study.remarks]
    parts += [pictures[f'responses_{name}'],
              sections.spent(study, 'per_output'), sections.fits(study, 'per_output'),
              details('The same with one search over all 12 parameters, as in the paper',
                      join([sections.spent(study, 'joint'), sections.fits(study, 'joint')]))]
    if preset.references:
        parts += [tag('h3', 'The simulation against known results'),
                  sections.references(preset)]
    if preset.truth:
        parts.append(sections.truth(preset))
    parts += [tag('h3', 'Which method is better?'),
              pictures[f'ranking_{name}'],
              sections.ranking(study),
              details('The same for each output',
                      join(sections.ranking_by_output(study, effort) for effort in EFFORTS))]
    return join(parts)


def _tables(reproduction, pictures):
    cells = reproduction.cells
    good = sum(cell.agrees for cell in cells)
    powers = ', '.join(f'{name.upper()} {power:.0e}' for name, power in POWERS.items())
    return join([
        _heading('tables', 'Tables 1 to 3 as printed'),
        tag('h3', 'Table 1: the vehicle'), sections.table_1(),
        tag('h3', 'Table 2: parameters'),
        tag('p', 'The last column is the error of each model against the responses that Table 3 '
                 'implies (below).'),
        sections.table_2(reproduction.printed),
        pictures[FIGURES],
        tag('h3', 'Table 3: errors, computed from Table 2'),
        tag('p', f'Plain sums over {SAMPLES} samples, one each {PERIOD:g} s up to '
                 f'{DURATION:g} s, over a power of ten ({powers}); in {" and ".join(EXCHANGED)} '
                 'the rows PSO and PSO-CS of Table 3 are exchanged against the models in Table '
                 '2. The four responses were fitted to these sums, 8 numbers to 64. The sums are '
                 'not integrals; the tables of the experiments above have those.'),
        tag('p', f'{good} of {len(cells)} cells agree within {100 * TOLERANCE:.0f} %; the others '
                 f'are marked. {len(OUTLIERS)} are known: three values of ISE that are ten or a '
                 'hundred times too large in print, one of a single digit, and one that the '
                 'rounding of Table 2 leaves off.'),
        sections.table_3(cells)])


def _least_squares(reproduction):
    return join([
        _heading('ls', 'Least squares as printed'),
        tag('p', 'Equations (35) to (37) have wrong signs, a0 and a1 exchanged, and a factor '
                 'missing under the root. The table compares what they give with corrected least '
                 'squares.'),
        sections.ls_printed(reproduction),
        tag('p', 'The models of Table 2 through eq. (36), at 5 s, and back through eq. (37):'),
        sections.round_trips(reproduction.trips)])


def _equations(reproduction):
    return join([
        _heading('equations', 'The equations as printed'),
        tag('p', 'Equations (13) to (15) add energy where friction should remove it. A run ends '
                 'when a rate exceeds 1e6 rad/s. If only one axis turns, the time is known '
                 'exactly. The last column is the end of the same flight by the correctly derived '
                 f'equations; flights of {DURATION:.0f} s were flown with these for {SHORT:g} s '
                 'here, and to the end as an experiment above.'),
        sections.printed_equations(reproduction.cases)])
