# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Identification of a set of flight records by one or more methods."""

from dataclasses import dataclass, field, replace
import time

import numpy as np

from quad_ident_ros import __version__
from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.metrics import errors, UNITS
from quad_ident_ros.identify.objective import Fitted, Objective
from quad_ident_ros.identify.result import Identification, MethodFit, OutputFit
from quad_ident_ros.identify.search import Search, SwarmSettings
from quad_ident_ros.identify.signals import OUTPUTS, signals
from quad_ident_ros.identify.space import find_space, literal_space, REFITTED, SIZE
from quad_ident_ros.identify.transfer import response, SecondOrder
from quad_ident_ros.identify.uncertainty import standard_errors

FIRST_SAMPLE = ('the level at rest is taken from the first sample, whose noise enters the fit: '
                'an initial state that is free is estimated')
POOR = 50.0   # fit %
UNDETERMINED = 'these data do not determine K, a and b: the information matrix is singular'
OVERFLOW = 'no model was found that stays finite over the record'


@dataclass(frozen=True)
class Settings:
    """
    How to identify.

    methods: names in METHODS; seed of the searches; search 'per_output' (gain solved for, the
    default) or 'joint' (the paper's literal 12 dimensions in one search); box 'scaled' or
    'literal' (see space); poles 'auto', 'real' or 'any' (see space.COMPLEX_PENALTY);
    pole_bounds, gain_bounds: (low, high) or None for bounds from the data; initial_state 'auto',
    'rest' or 'free'; trim: U1..U4 or None for the record's.
    """

    methods: tuple = tuple(METHODS)
    seed: int = 0
    swarm: SwarmSettings = field(default_factory=SwarmSettings)
    search: str = 'per_output'
    box: str = 'scaled'
    poles: str = 'auto'
    pole_bounds: tuple | None = None
    gain_bounds: tuple | None = None
    initial_state: str = 'auto'
    trim: tuple | None = None


def collect(records, settings):
    """
    Return the signals of records, one per output (the last record that excites it), and remarks.

    Raises InputError where no record excites any input.
    """
    found, remarks = {}, []
    for record in records:
        pairs, said = signals(record, trim=settings.trim, initial_state=settings.initial_state)
        found.update({pair.output: pair for pair in pairs})
        remarks += said
        if settings.initial_state == 'rest' and 'initial' not in record.info:
            remarks.append(FIRST_SAMPLE)
    if not found:
        raise InputError('no input deviates from its trim in these data, so there is nothing to '
                         'identify: excite U1..U4, or state the trim (the option '
                         '--trim hover, or the parameter trim)')
    return ({name: found[name] for name in OUTPUTS if name in found},
            list(dict.fromkeys(remarks)))


def identify(records, settings=None, *, on_progress=lambda method, output, share: None):
    """
    Fit K/((s+a)(s+b)) to each excited output of flight records by each method.

    Args: records: FlightRecords, for instance one per axis; settings: Settings;
    on_progress: called with method, output and the share done (0 to 1) of that fit; what it
    raises (search.Cancelled) ends the identification.
    Returns an Identification. The same records, settings and seed give the same numbers.
    Raises InputError for data that cannot be identified.
    """
    settings = settings or Settings()
    pairs, remarks = collect(records, settings)
    objectives, spaces = {}, {}
    for name, signal in pairs.items():
        space = find_space(Objective(signal), settings.poles, settings.pole_bounds,
                           settings.gain_bounds)
        if settings.box == 'literal':
            space = literal_space(settings.poles)
        limited = settings.gain_bounds is not None or settings.box == 'literal'
        objectives[name] = Objective(signal, space.gain) if limited else Objective(signal)
        spaces[name] = space
    results = {}
    for number, name in enumerate(settings.methods):
        method = METHODS[name]
        random = np.random.default_rng([settings.seed, number])
        started = time.perf_counter()
        if method.direct:
            fits = {output: _direct(method, objectives[output], spaces[output], output)
                    for output in pairs}
        elif settings.search == 'joint':
            fits = _joint(method, objectives, spaces, settings, random, on_progress)
        else:
            fits = {output: _search(method, objectives[output], spaces[output], output,
                                    settings, random, on_progress) for output in pairs}
        on_progress(name, '', 1.0)
        results[name] = MethodFit(name, fits, time.perf_counter() - started)
    return Identification(results, pairs, _described(settings, spaces), tuple(remarks),
                          _provenance(records))


def _direct(method, objective, space, output):
    fitted, remarks = method.direct(objective, space)
    if np.isfinite(objective.gain_bounds).all():
        remarks = [*remarks, 'bounds are for the searches: this method knows none']
    return _finish(objective.signal, output, fitted, 0, remarks)


def _search(method, objective, space, output, settings, random, on_progress):
    search = Search(lambda points: space.cost(objective, points), 2, settings.swarm, random,
                    lambda share: on_progress(method.name, output, share))
    method.search(search)
    if not np.isfinite(search.best_cost):
        return _finish(objective.signal, output, None, search.spent, [OVERFLOW])
    mean, half = space.mean_and_half(search.best[None])
    found = objective.fit(mean[0], half[0])
    fitted = space.settle(objective, found)
    return _finish(objective.signal, output, fitted, search.spent,
                   [] if fitted is found else [REFITTED])


def _joint(method, objectives, spaces, settings, random, on_progress):
    for signal in (objective.signal for objective in objectives.values()):
        if not signal.at_rest:
            raise InputError('search: joint needs records that start at rest (it does not '
                             'estimate initial states); use per_output, or initial_state rest')

    def models(points, output, space):
        i = 3 * list(objectives).index(output)
        low = np.array([space.gain[0], space.poles[0], space.poles[0]])
        high = np.array([space.gain[1], space.poles[1], space.poles[1]])
        gain, a, b = (low + (high - low) * points[:, i:i + 3] / SIZE).T
        return gain, a, b

    def cost(points):
        total = np.zeros(len(points))
        for output, objective in objectives.items():
            gain, a, b = models(points, output, spaces[output])
            total += objective.of_models(gain, a + b, a * b)
        return total

    search = Search(cost, 3 * len(objectives), settings.swarm, random,
                    lambda share: on_progress(method.name, 'all', share))
    method.search(search)
    if not np.isfinite(search.best_cost):
        return {output: _finish(objective.signal, output, None, search.spent, [OVERFLOW])
                for output, objective in objectives.items()}
    fits = {}
    for output, objective in objectives.items():
        gain, a, b = (values[0] for values in models(search.best[None], output, spaces[output]))
        fitted = Fitted(SecondOrder.from_poles(gain, a, b), (0.0, 0.0),
                        float(objective.of_models([gain], [a + b], [a * b])[0]))
        fits[output] = _finish(objective.signal, output, fitted, search.spent)
    return fits


def _finish(signal, output, fitted, evaluations, remarks=()):
    """Return the OutputFit of a Fitted model, or of none."""
    if fitted is not None:
        model = fitted.model
        fit = response(model, signal.u, signal.period, fitted.initial)
        if not (np.isfinite(fit).all() and np.isfinite(fitted.cost)):
            fitted, remarks = None, [OVERFLOW]
    if fitted is None:
        return OutputFit(output, None, (0.0, 0.0), None, np.inf, dict.fromkeys(UNITS),
                         dict.fromkeys(('K', 'a', 'b', 'c1', 'c0')), evaluations, tuple(remarks))
    deviations = standard_errors(signal, fitted)
    if deviations['K'] is None:
        remarks = (*remarks, UNDETERMINED)
    if model.form == 'real' and deviations['a'] and deviations['a'] > model.a - model.b:
        remarks = (*remarks, 'a and b are closer than their errors: the data determine only '
                             f'a + b = {model.c1:.4g} ± {deviations["c1"]:.1g} and '
                             f'a b = {model.c0:.4g} ± {deviations["c0"]:.1g}')
    found = errors(signal.t, signal.y, fit)
    if not found['fit_percent'] > POOR:
        remarks = (*remarks, 'the model explains little of the response (fit '
                             f'{found["fit_percent"]:.0f} %)')
    return OutputFit(output, model, fitted.initial, fit, fitted.cost,
                     found, deviations, evaluations, tuple(remarks))


def _described(settings, spaces):
    swarm = {name: getattr(settings.swarm, name) for name in settings.swarm.__dataclass_fields__}
    return {'methods': list(settings.methods), 'seed': settings.seed, 'search': settings.search,
            'box': settings.box, 'poles': settings.poles, 'initial_state': settings.initial_state,
            'swarm': swarm,
            'bounds': {name: {'poles': list(space.poles), 'gain': list(space.gain),
                              'evaluations': space.evaluations}
                       for name, space in spaces.items()}}


def _provenance(records):
    dropped = sum(int(record.info.get('dropped', 0)) for record in records)
    return {'version': __version__, 'dropped_samples': dropped,
            'records': [dict(record.info) for record in records]}


def with_budget(settings, evaluations):
    """Return settings in which every search may spend the same count of evaluations."""
    return replace(settings, swarm=replace(settings.swarm, evaluations=evaluations))
