# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Every method on one experiment, over many seeds: at the paper's budget and at equal ones."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from quad_ident_ros.identify.identify import identify, Settings, with_budget
from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.result import Identification, MethodFit
from quad_ident_ros.identify.search import SwarmSettings

SWARMS = tuple(name for name, method in METHODS.items() if method.search)
DIRECT = tuple(name for name, method in METHODS.items() if method.direct)
PAPERS = ('pso', 'cs', 'pso_cs', 'ls')

# What CS and PSO-CS spend in the paper's generations: the first points, then two per nest.
EQUAL_BUDGET = SwarmSettings.population * (1 + 2 * SwarmSettings.generations)


@dataclass(frozen=True)
class Effort:
    """How to search: 'per_output' or 'joint', with how many evaluations (None: generations)."""

    name: str
    label: str
    search: str
    evaluations: int | None


GENERATIONS = f'{SwarmSettings.generations} generations'
EFFORTS = {effort.name: effort for effort in (
    Effort('per_output', f'per output, {GENERATIONS}', 'per_output', None),
    Effort('per_output_equal', f'per output, {EQUAL_BUDGET} evaluations', 'per_output',
           EQUAL_BUDGET),
    Effort('joint', f'joint, {GENERATIONS}', 'joint', None),
    Effort('joint_equal', f'joint, {EQUAL_BUDGET} evaluations', 'joint', EQUAL_BUDGET),
)}


@dataclass(frozen=True)
class Study:
    """
    The fits of all methods to the signals of one preset.

    fits: MethodFits by effort and method, one per seed, or a single one for a method that draws no
    random numbers; settings and remarks as in Identification.
    """

    signals: dict
    fits: dict
    settings: dict
    remarks: tuple
    provenance: dict

    def costs(self, effort, method, output=None):
        """Return F (n,) of one output, or of all together, by seed or alone."""
        return np.array([fit.cost if output is None else fit.outputs[output].cost
                         for fit in self.fits[effort][method]])

    def nrmse(self, effort, method):
        """Return the rms over the outputs of their NRMSE (n,), %, by seed or alone."""
        return 100 * np.sqrt(2 * self.costs(effort, method) / len(self.signals))

    def pick(self, rank, effort):
        """
        Return the Identification of the 'median' or 'worst' seed, per method and output, by cost.

        Of an even count the median is the better of the two in the middle.
        """
        methods = {}
        for name, fits in self.fits[effort].items():
            outputs = {}
            for output in self.signals:
                ordered = sorted((fit.outputs[output] for fit in fits), key=lambda fit: fit.cost)
                outputs[output] = middle(ordered) if rank == 'median' else ordered[-1]
            methods[name] = MethodFit(name, outputs, float(np.median([f.seconds for f in fits])))
        return Identification(methods, self.signals, self.settings, self.remarks, self.provenance)


def middle(ordered):
    """Return the median of sorted values: of an even count, the lower of the two in the middle."""
    return ordered[(len(ordered) - 1) // 2]


def in_turn(function, items):
    """Yield each item with what a function makes of it; cluster.values does so on workers."""
    for item in items:
        yield item, function(item)


def study(records, seeds, on_progress=lambda: None, each=in_turn):
    """
    Fit records by all methods with each effort, and return the Study.

    Args: records: FlightRecords from rest; seeds: count of seeds, from 0; on_progress: called
    steps(seeds) times; each: as in_turn, which seeds of a cluster share. The poles are real, as in
    the paper.
    """
    # One evaluation of a search is enough to learn its bounds.
    first = identify(records, with_budget(Settings(
        methods=(SWARMS[0], *DIRECT), poles='real', compare_orders=False), 1))
    on_progress()
    drawn = {}
    for seed, found in each(partial(_of_seed, records), range(seeds)):
        drawn[seed] = found
        on_progress()
    fits = {name: {method: tuple(drawn[seed][name][method] for seed in range(seeds))
                   if method in SWARMS else (first.methods[method],) for method in METHODS}
            for name in EFFORTS}
    return Study(first.signals, fits, {**first.settings, 'methods': list(METHODS),
                                       'seeds': seeds}, first.remarks, first.provenance)


def steps(seeds):
    """Return how often study reports its progress."""
    return 1 + seeds


def _of_seed(records, seed):
    """Return the MethodFits of the searches with a seed, {effort: {method: MethodFit}}."""
    fits = {}
    for name, effort in EFFORTS.items():
        # What the paper's generations have spent already need not be searched for again.
        known = {} if effort.evaluations is None else {
            method: fit for method, fit in fits[effort.search].items()
            if _spent(fit) == effort.evaluations}
        missing = tuple(method for method in SWARMS if method not in known)
        fits[name] = known | (_search(records, seed, effort, missing) if missing else {})
    return fits


def _search(records, seed, effort, methods):
    settings = Settings(methods=methods, seed=seed, poles='real', search=effort.search)
    return identify(records, with_budget(settings, effort.evaluations)).methods


def _spent(fit):
    """Return the evaluations of each search of a MethodFit, the same for all its outputs."""
    return next(iter(fit.outputs.values())).evaluations
