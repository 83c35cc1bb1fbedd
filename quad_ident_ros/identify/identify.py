# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Identification of a set of flight records by one or more methods."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
import time
from typing import Any, TypeAlias

import numpy as np

from quad_ident_ros import __version__
from quad_ident_ros.arguments import flight_records
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.identify.findings import findings_of, order_finding
from quad_ident_ros.identify.methods import Direct, Method, METHODS
from quad_ident_ros.identify.metrics import errors, UNITS
from quad_ident_ros.identify.objective import Fitted, Objective
from quad_ident_ros.identify.order import alternatives
from quad_ident_ros.identify.residuals import examine
from quad_ident_ros.identify.result import Identification, MethodFit, OutputFit
from quad_ident_ros.identify.search import Search, SwarmSettings
from quad_ident_ros.identify.signals import OUTPUTS, Signal, signals
from quad_ident_ros.identify.space import (
    check_bounds,
    find_space,
    literal_space,
    no_space,
    SIZE,
    Space,
)
from quad_ident_ros.identify.transfer import response, SecondOrder
from quad_ident_ros.identify.uncertainty import KEYS, Uncertainty, uncertainty
from quad_ident_ros.identify.validity import validity

FIRST_SAMPLE = ('search joint: the level at rest is taken from the first sample, whose noise '
                'enters the fit')
LEVEL_UNKNOWN = ('unlike a bag of the recorder, the record does not say at which level it rests: '
                 'the level is estimated with K, a and b. If the vehicle is not of this class, '
                 'the level absorbs part of the misfit, and a record that has it gives different '
                 'numbers')
POOR = 50.0   # fit %
FEWEST_FOR_ORDERS = 30   # samples
OVERFLOW = 'no model was found that stays finite over the record'

Progress: TypeAlias = Callable[[str, str, float], None]     # method, output, share done


@dataclass(frozen=True)
class Settings:
    """
    How to identify.

    methods: names in METHODS; seed of the searches; search 'per_output' (gain solved for, the
    default) or 'joint' (the paper's literal 12 dimensions in one search); box 'scaled' or
    'literal' (see space); poles 'auto', 'real' or 'any' (see vp.COMPLEX_PENALTY);
    pole_bounds, gain_bounds: (low, high) or None for bounds from the data; initial_state 'auto',
    'rest' or 'free'; trim: U1..U4 or None for the record's; compare_orders: whether `vp` also
    looks at models of other orders (see order.alternatives).
    """

    methods: tuple[str, ...] = tuple(METHODS)
    seed: int = 0
    swarm: SwarmSettings = field(default_factory=SwarmSettings)
    search: str = 'per_output'
    box: str = 'scaled'
    poles: str = 'auto'
    pole_bounds: tuple[float, float] | None = None
    gain_bounds: tuple[float, float] | None = None
    initial_state: str = 'auto'
    trim: tuple[float, ...] | None = None
    compare_orders: bool = True


def collect(records: Sequence[FlightRecord], settings: Settings
            ) -> tuple[dict[str, Signal], list[str]]:
    """
    Return the signals of records, one per output (the last record that excites it), and remarks.

    Of several that excite an output a remark says which was taken.
    Raises InputError where no record excites any input.
    """
    found: dict[str, Signal] = {}
    sources: dict[str, list[str]] = {}
    remarks: list[str] = []
    for number, record in enumerate(records, 1):
        pairs, said = signals(record, trim=settings.trim, initial_state=settings.initial_state)
        found.update({pair.output: pair for pair in pairs})
        for pair in pairs:
            source = record.info.get('source') or f'flight {number}'
            sources.setdefault(pair.output, []).append(source)
        remarks += said
    for output, (*others, taken) in sources.items():
        if others:
            remarks.append(f'{output}: taken from {taken}; {len(others)} other '
                           f'flight{"s" if len(others) > 1 else ""} that excited it not used')
    still = [remark for remark in remarks if 'does not move' in remark]
    if not found and still:
        raise InputError('; '.join(dict.fromkeys(still)))
    if not found:
        raise InputError('no input deviates from its trim in these data, so there is nothing to '
                         'identify: excite U1..U4, or state the trim (the option '
                         '--trim hover, or the parameter trim)')
    return ({name: found[name] for name in OUTPUTS if name in found},
            list(dict.fromkeys(remarks)))


def identify(records: Sequence[FlightRecord], settings: Settings | None = None, *,
             on_progress: Progress = lambda method, output, share: None,
             near: Mapping[str, SecondOrder] | None = None) -> Identification:
    """
    Fit K/((s+a)(s+b)) to each excited output of flight records by each method.

    Args: records: FlightRecords, for instance one per axis; settings: Settings;
    on_progress: called with method, output and the share done (0 to 1) of that fit; what it
    raises (errors.Cancelled) ends the identification; near: models by output near which the best
    ones are expected.
    Returns an Identification. The same records, settings and seed give the same numbers.
    Raises InputError for data that cannot be identified.
    """
    records = flight_records('records', records)
    settings = settings or Settings()
    check_bounds(settings.pole_bounds, settings.gain_bounds)
    pairs, remarks = collect(records, settings)
    if settings.search == 'joint':
        if not all(signal.at_rest for signal in pairs.values()):
            raise InputError('search: joint needs records that start at rest (it does not '
                             'estimate initial states); use per_output, or initial_state rest')
        if not all(signal.level_known for signal in pairs.values()):
            remarks.append(FIRST_SAMPLE)
        pairs = {name: replace(signal, level_known=True) for name, signal in pairs.items()}
    elif any(signal.unknowns == 1 for signal in pairs.values()):
        remarks.append(LEVEL_UNKNOWN)
    objectives, spaces = {}, {}
    for name, signal in pairs.items():
        searching = any(METHODS[method].search for method in settings.methods)
        if not searching:
            space = no_space(settings.poles, (near or {}).get(name))
        elif settings.box == 'literal':
            space = literal_space(settings.poles)
        else:
            space = find_space(Objective(signal), settings.poles, settings.pole_bounds,
                               settings.gain_bounds, (near or {}).get(name))
        limited = searching and (settings.gain_bounds is not None or settings.box == 'literal')
        objectives[name] = Objective(signal, space.gain) if limited else Objective(signal)
        spaces[name] = space
    results = {}
    for number, name in enumerate(settings.methods):
        method = METHODS[name]
        random = np.random.default_rng([settings.seed, number])
        started = time.perf_counter()
        if method.direct is not None:
            fits = {output: _direct(method.direct, objectives[output], spaces[output], output)
                    for output in pairs}
            if method.name == 'vp' and settings.compare_orders:
                fits = {output: _with_orders(fit, pairs[output]) for output, fit in fits.items()}
        elif settings.search == 'joint':
            fits = _joint(method, objectives, spaces, settings, random, on_progress)
        else:
            fits = {output: _search(method, objectives[output], spaces[output], output,
                                    settings, random, on_progress) for output in pairs}
        on_progress(name, '', 1.0)
        results[name] = MethodFit(name, fits, time.perf_counter() - started)
    held = {name: validity(signal) for name, signal in pairs.items()}
    remarks += [f'{name}: {one.why}' for name, one in held.items() if one.holds is False]
    return Identification(results, pairs, _described(settings, spaces), tuple(remarks),
                          _provenance(records), validity=held)


def _direct(direct: Direct, objective: Objective, space: Space, output: str) -> OutputFit:
    fitted, spent, remarks = direct(objective, space)
    if fitted is not None and not space.holds(fitted.model):
        remarks = [*remarks, 'beyond the bounds: these are for the searches; this method has none']
    return _finish(objective.signal, output, fitted, spent, remarks)


def _with_orders(fit: OutputFit, signal: Signal) -> OutputFit:
    """Return the OutputFit with what other orders give, and a word where one is better."""
    if fit.model is None or signal.samples < FEWEST_FOR_ORDERS:
        return fit
    found = alternatives(signal, fit.model)
    return replace(fit, orders=found, findings=(*fit.findings, *(
        said for said in map(order_finding, found) if said)))


def _search(method: Method, objective: Objective, space: Space, output: str, settings: Settings,
            random: np.random.Generator, on_progress: Progress) -> OutputFit:
    search = Search(lambda points: space.cost(objective, points), 2, settings.swarm, random,
                    lambda share: on_progress(method.name, output, share))
    assert method.search is not None
    method.search(search)
    if not np.isfinite(search.best_cost):
        return _finish(objective.signal, output, None, search.spent, [OVERFLOW])
    mean, half = space.mean_and_half(search.best[None])
    return _finish(objective.signal, output, objective.fit(mean[0], half[0]), search.spent,
                   bounds=_bounded(space, objective))


def _joint(method: Method, objectives: Mapping[str, Objective], spaces: Mapping[str, Space],
           settings: Settings, random: np.random.Generator, on_progress: Progress
           ) -> dict[str, OutputFit]:
    def models(points: np.ndarray, output: str, space: Space
               ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        i = 3 * list(objectives).index(output)
        low = np.array([space.gain[0], space.poles[0], space.poles[0]])
        high = np.array([space.gain[1], space.poles[1], space.poles[1]])
        gain, a, b = (low + (high - low) * points[:, i:i + 3] / SIZE).T
        return gain, a, b

    def cost(points: np.ndarray) -> np.ndarray:
        total = np.zeros(len(points))
        for output, objective in objectives.items():
            gain, a, b = models(points, output, spaces[output])
            total += objective.of_models(gain, a + b, a * b)
        return total

    search = Search(cost, 3 * len(objectives), settings.swarm, random,
                    lambda share: on_progress(method.name, 'all', share))
    assert method.search is not None
    method.search(search)
    if not np.isfinite(search.best_cost):
        return {output: _finish(objective.signal, output, None, search.spent, [OVERFLOW])
                for output, objective in objectives.items()}
    fits = {}
    for output, objective in objectives.items():
        gain, a, b = (values[0] for values in models(search.best[None], output, spaces[output]))
        fitted = Fitted(SecondOrder.from_poles(gain, a, b), (0.0, 0.0),
                        float(objective.of_models([gain], [a + b], [a * b])[0]))
        fits[output] = _finish(objective.signal, output, fitted, search.spent,
                               bounds=spaces[output])
    return fits


def _bounded(space: Space, objective: Objective) -> Space:
    """Return the space with the bounds of the gain that the objective keeps: it may have none."""
    return replace(space, gain=objective.gain_bounds)


def _finish(signal: Signal, output: str, fitted: Fitted | None, evaluations: int,
            remarks: Sequence[str] = (), bounds: Space | None = None) -> OutputFit:
    """Return the OutputFit of a Fitted model, or of none; bounds: the Space it was searched in."""
    if fitted is not None:
        model = fitted.model
        fit = response(model, signal.u, signal.period, fitted.initial, fitted.disturbance)
        if not (np.isfinite(fit).all() and np.isfinite(fitted.cost)):
            fitted, remarks = None, [OVERFLOW]
    if fitted is None:
        return OutputFit(output, None, (0.0, 0.0), None, np.inf, dict.fromkeys(UNITS),
                         Uncertainty(dict.fromkeys(KEYS)), evaluations, tuple(remarks))
    sure = uncertainty(signal, fitted)
    tests = examine(signal, signal.y - fit, fitted.noise)
    found = errors(signal.t[signal.measured], signal.y[signal.measured], fit[signal.measured])
    findings = list(findings_of(signal, model, sure, tests, bounds))
    if not found['fit_percent'] > POOR:
        findings.append('the model explains little of the response (fit '
                        f'{found["fit_percent"]:.0f} %)')
    return OutputFit(output, model, fitted.initial, fit, fitted.cost, found, sure, evaluations,
                     tuple(remarks), tuple(findings), fitted.disturbance, tests,
                     fitted.least_cost)


def _described(settings: Settings, spaces: Mapping[str, Space]) -> dict[str, Any]:
    swarm = {name: getattr(settings.swarm, name) for name in settings.swarm.__dataclass_fields__}
    return {'methods': list(settings.methods), 'seed': settings.seed, 'search': settings.search,
            'box': settings.box, 'poles': settings.poles, 'initial_state': settings.initial_state,
            'trim': settings.trim and list(settings.trim), 'swarm': swarm,
            'requested_bounds': {name: bounds and list(bounds) for name, bounds in (
                ('poles', settings.pole_bounds), ('gain', settings.gain_bounds))},
            'bounds': {name: {'poles': list(space.poles), 'gain': list(space.gain),
                              'evaluations': space.evaluations}
                       for name, space in spaces.items()}}


def _provenance(records: Sequence[FlightRecord]) -> dict[str, Any]:
    dropped = sum(int(record.info.get('dropped', 0)) for record in records)
    return {'version': __version__, 'dropped_samples': dropped,
            'records': [dict(record.info) for record in records]}


def with_budget(settings: Settings, evaluations: int | None) -> Settings:
    """Return settings in which every search may spend the same count of evaluations."""
    return replace(settings, swarm=replace(settings.swarm, evaluations=evaluations))
