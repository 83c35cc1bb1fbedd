# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The whole reproduction: all experiments, methods and tables in one result."""

from dataclasses import dataclass

from quad_ident_ros import __version__
from quad_ident_ros.identify.result import as_data as identification_data
from quad_ident_ros.identify.result import clean, Identification
from quad_ident_ros.paper import divergence, printed_ls, table2, table3
from quad_ident_ros.paper.presets import load_preset
from quad_ident_ros.paper.ranking import comparisons
from quad_ident_ros.paper.study import EFFORTS, in_turn, steps, study
from quad_ident_ros.warm_up import warm_up


@dataclass(frozen=True)
class Reproduction:
    """
    What was computed: presets and studies by name, the others as in the modules named.

    printed_fits: PrintedFits by preset; cells: table3.Cells; trips: printed_ls.RoundTrips; cases:
    divergence.Cases; printed: Table 2 as an Identification of the responses of Table 3.
    """

    seeds: int
    presets: dict
    studies: dict
    printed_fits: dict
    cells: list
    trips: list
    cases: list
    printed: Identification


def reproduce(names, seeds, on_progress=lambda text, share: None, each=in_turn):
    """
    Return the Reproduction for presets by name.

    Args: names in presets.PRESETS; seeds: count of seeds of the searches; on_progress: called with
    what is being done and the share done; each: as study.in_turn, does what is done for each seed.
    """
    on_progress('compiling', 0.0)
    warm_up()
    total, done = steps(seeds) * len(names) + 1, 0

    def step():
        nonlocal done
        done += 1
        on_progress(text, done / total)

    presets, studies = {}, {}
    for name in names:
        text = name
        on_progress(text, done / total)
        presets[name] = load_preset(name)
        studies[name] = study(presets[name].records, seeds, step, each)
    text = 'the equations as printed'
    on_progress(text, done / total)
    cases = divergence.cases()
    step()
    fits = {name: [printed_ls.printed_fit(signal) for signal in found.signals.values()]
            for name, found in studies.items()}
    return Reproduction(seeds, presets, studies, fits, table3.table_3(),
                        printed_ls.round_trips(), cases,
                        table2.printed_identification())


def as_data(reproduction, claims):
    """Return a Reproduction and its claims as JSON-able data."""
    return clean({
        'schema': 'quad_ident/paper/1', 'version': __version__, 'seeds': reproduction.seeds,
        'claims': [vars(claim) for claim in claims],
        'presets': {name: _preset(reproduction, name) for name in reproduction.presets},
        'table_2': {method: {output: {'K': fit.model.gain, 'a': fit.model.a, 'b': fit.model.b,
                                      'nrmse_percent': fit.errors['nrmse_percent']}
                             for output, fit in fits.outputs.items()}
                    for method, fits in reproduction.printed.methods.items()},
        'table_3': [{**vars(cell), 'ratio': cell.ratio, 'agrees': cell.agrees,
                     'listed': cell.listed} for cell in reproduction.cells],
        'round_trips': [{**vars(trip), 'printed_restores': trip.printed_restores,
                         'right_restores': trip.right_restores} for trip in reproduction.trips],
        'printed_equations': [vars(case) for case in reproduction.cases]})


def _preset(reproduction, name):
    preset, found = reproduction.presets[name], reproduction.studies[name]
    outputs = (None, *found.signals)
    ranking = {effort: {output or 'all': [{**vars(entry), 'probability': entry.probability,
                                           'verdict': entry.verdict}
                                          for entry in comparisons(found, effort, output)]
                        for output in outputs} for effort in EFFORTS}
    return {
        'title': preset.title, 'duration': preset.duration, 'infeasible': preset.infeasible,
        'references': [vars(entry) for entry in preset.references], 'truth': preset.truth,
        **{rank: {effort: identification_data(found.pick(rank, effort)) for effort in EFFORTS}
           for rank in ('median', 'worst')},
        'costs': {effort: {method: {output or 'all': found.costs(effort, method, output).tolist()
                                    for output in outputs} for method in fits}
                  for effort, fits in found.fits.items()},
        'ranking': ranking,
        'ls_as_printed': [vars(fit) for fit in reproduction.printed_fits[name]]}
