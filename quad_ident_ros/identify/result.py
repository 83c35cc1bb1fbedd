# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What an identification gives, and its form as data."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
import math
from typing import Any

import numpy as np

from quad_ident_ros.identify import metrics
from quad_ident_ros.identify.change import Change
from quad_ident_ros.identify.order import Alternative
from quad_ident_ros.identify.residuals import ResidualTests
from quad_ident_ros.identify.signals import GAIN_UNITS, INPUT_OF, OUTPUT_UNITS, OUTPUTS, Signal
from quad_ident_ros.identify.transfer import response, SecondOrder
from quad_ident_ros.identify.uncertainty import Errors, Uncertainty
from quad_ident_ros.identify.validity import Validity


@dataclass(frozen=True)
class OutputFit:
    """
    The fit of one output by one method.

    model is None where the method found none; response (N,) is the fitted output; cost is F;
    errors as in metrics.errors; remarks say how the model was found, findings what it means for
    itself and the data; disturbance is a constant beside K u; least_cost the cost of the
    least-squares fit, where the model is the most likely one for coloured noise instead; orders
    what models of other orders give (see order.Alternative).
    """

    output: str
    model: SecondOrder | None
    initial: tuple[float, float]
    response: np.ndarray | None
    cost: float
    errors: Errors
    uncertainty: Uncertainty
    evaluations: int
    remarks: tuple[str, ...] = ()
    findings: tuple[str, ...] = ()
    disturbance: float = 0.0
    residuals: ResidualTests = ResidualTests(None, None)
    least_cost: float | None = None
    orders: tuple[Alternative, ...] = ()

    @property
    def standard_errors(self) -> Errors:
        """Return standard errors by name, None where there is none."""
        return self.uncertainty.errors

    @property
    def rank(self) -> float:
        """F for comparing methods: with coloured noise the best model may not have the least F."""
        return self.cost if self.least_cost is None else min(self.cost, self.least_cost)


@dataclass(frozen=True)
class MethodFit:
    """All outputs fitted by one method."""

    method: str
    outputs: dict[str, OutputFit]
    seconds: float

    @property
    def evaluations(self) -> int:
        """Return the evaluations of F over all outputs."""
        return sum(fit.evaluations for fit in self.outputs.values())

    @property
    def cost(self) -> float:
        """Sum of F over the outputs; infinite where one has no model."""
        return sum(fit.cost for fit in self.outputs.values())


@dataclass(frozen=True)
class Identification:
    """
    The results of all methods on one set of signals.

    signals maps output to Signal; changes are those of the vehicle that a tracker found;
    validity maps output to whether the linear model holds (see validity.Validity).
    """

    methods: dict[str, MethodFit]
    signals: dict[str, Signal]
    settings: dict[str, Any]
    remarks: tuple[str, ...] = ()
    provenance: dict[str, Any] = field(default_factory=dict)
    changes: tuple[Change, ...] = ()
    validity: dict[str, Validity] = field(default_factory=dict)

    @property
    def best(self) -> str:
        """Name of the method with the smallest cost (see OutputFit.rank)."""
        return self._least(lambda method: sum(fit.rank for fit in method.outputs.values()))

    def best_of(self, output: str) -> str:
        """Return the name of the method that is best for one output."""
        return self._least(lambda method: method.outputs[output].rank)

    def _least(self, cost: Callable[[MethodFit], float]) -> str:
        # Methods that reach the same optimum differ by rounding: of those the last one has it.
        return min(reversed(self.methods),
                   key=lambda name: float(f'{cost(self.methods[name]):.8g}'))


def parameter_table(fit: MethodFit) -> np.ndarray:
    """
    Return K, a, b (4, 3) in the order phi, theta, psi, z of a MethodFit.

    Not a number stands for outputs without a model and for a and b of a complex pair: its real
    part alone would be a wrong answer that looks right.
    """
    table = np.full((4, 3), np.nan)
    for i, name in enumerate(OUTPUTS):
        model = fit.outputs[name].model if name in fit.outputs else None
        if model is not None:
            table[i, 0] = model.gain
            if model.form != 'complex':
                table[i, 1:] = model.a, model.b
    return table


def error_table(fit: MethodFit) -> np.ndarray:
    """Return the standard errors of parameter_table (4, 3); NaN where there is none."""
    table = np.full((4, 3), np.nan)
    for i, name in enumerate(OUTPUTS):
        model = fit.outputs[name].model if name in fit.outputs else None
        if model is not None and model.form != 'complex':
            table[i] = [np.nan if fit.outputs[name].standard_errors[key] is None
                        else fit.outputs[name].standard_errors[key] for key in ('K', 'a', 'b')]
        elif model is not None and fit.outputs[name].standard_errors['K'] is not None:
            table[i, 0] = fit.outputs[name].standard_errors['K']
    return table


def as_data(identification: Identification) -> dict[str, Any]:
    """Return an Identification as JSON-able data: NaN and infinities become None."""
    return clean({
        'schema': 'quad_ident/identification/1',
        'best': identification.best,
        'methods': {name: _method(fit) for name, fit in identification.methods.items()},
        'samples': {name: len(signal.y) for name, signal in identification.signals.items()},
        'period': {name: signal.period for name, signal in identification.signals.items()},
        'settings': identification.settings,
        'remarks': list(identification.remarks),
        'linear_model': {name: vars(one) for name, one in identification.validity.items()},
        'changes': [vars(change) for change in identification.changes],
        **identification.provenance})


def _method(fit: MethodFit) -> dict[str, Any]:
    return {'seconds': fit.seconds, 'evaluations': fit.evaluations, 'cost': fit.cost,
            'outputs': {name: _output(output) for name, output in fit.outputs.items()}}


def _output(fit: OutputFit) -> dict[str, Any]:
    model = fit.model
    unit = OUTPUT_UNITS[fit.output]
    units = {'K': GAIN_UNITS[fit.output], 'a': '1/s', 'b': '1/s', 'c1': '1/s', 'c0': '1/s^2',
             'output': unit, **{key: text.replace('unit', unit)
                                for key, text in metrics.UNITS.items()}}
    data = {'input': INPUT_OF[fit.output], 'units': units, 'cost': fit.cost,
            'errors': fit.errors, 'standard_errors': fit.standard_errors,
            'correlations': _correlations(fit.uncertainty),
            'not_identifiable': list(fit.uncertainty.unidentifiable),
            'residuals': {'white_p': fit.residuals.white,
                          'independent_of_input_p': fit.residuals.independent,
                          'noise_model': list(fit.residuals.noise)},
            'least_cost': fit.least_cost,
            'orders': [{**vars(other), 'denominator': list(other.denominator),
                        'is_better': other.is_better} for other in fit.orders],
            'evaluations': fit.evaluations, 'remarks': list(fit.remarks),
            'findings': list(fit.findings),
            'initial': list(fit.initial), 'disturbance': fit.disturbance,
            'form': None, 'stability': None}
    if model is None:
        return {**data, 'K': None, 'a': None, 'b': None, 'c1': None, 'c0': None}
    data.update(form=model.form, stability=model.stability, K=model.gain, c1=model.c1,
                c0=model.c0)
    if model.form == 'complex':
        return {**data, 'a': None, 'b': None,
                'pair': {'real': model.a.real, 'imaginary': model.a.imag}}
    return {**data, 'a': model.a, 'b': model.b}


def _correlations(sure: Uncertainty) -> dict[str, Any] | None:
    if sure.correlations is None:
        return None
    return {'names': list(sure.names), 'matrix': sure.correlations.tolist()}


def clean(value: Any) -> Any:
    """Return a value as JSON-able data: NaN and infinities become None."""
    if isinstance(value, dict):
        return {str(key): clean(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [clean(entry) for entry in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, complex):
        return {'real': clean(value.real), 'imaginary': clean(value.imag)}
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def from_data(data: Mapping[str, Any], signals: dict[str, Signal]) -> Identification:
    """
    Return the Identification that as_data described.

    Args: signals: the Signals it was fitted to, by output; the fitted responses are computed
    again from the models.
    """
    methods = {}
    for name, method in data['methods'].items():
        outputs = {output: _output_from(output, fit, signals[output])
                   for output, fit in method['outputs'].items()}
        methods[name] = MethodFit(name, outputs, method['seconds'])
    known = ('schema', 'best', 'methods', 'samples', 'period', 'settings', 'remarks', 'changes',
             'linear_model')
    provenance = {key: value for key, value in data.items() if key not in known}
    held = {name: Validity(**one) for name, one in data.get('linear_model', {}).items()}
    return Identification(methods, signals, data['settings'], tuple(data['remarks']), provenance,
                          validity=held)


def _output_from(output: str, data: Mapping[str, Any], signal: Signal) -> OutputFit:
    model = fitted = None
    if data['form'] == 'complex':
        pair = complex(data['pair']['real'], data['pair']['imaginary'])
        model = SecondOrder(data['K'], pair, pair.conjugate())
    elif data['form']:
        model = SecondOrder(data['K'], data['a'], data['b'])
    if model is not None:
        fitted = response(model, signal.u, signal.period, data['initial'], data['disturbance'])
    correlations = data['correlations'] or {'names': (), 'matrix': None}
    matrix = correlations['matrix']
    sure = Uncertainty(data['standard_errors'], tuple(correlations['names']),
                       None if matrix is None else np.array(matrix),
                       tuple(data['not_identifiable']))
    tests = ResidualTests(data['residuals']['white_p'],
                          data['residuals']['independent_of_input_p'],
                          tuple(data['residuals']['noise_model']))
    return OutputFit(output, model, tuple(data['initial']), fitted,
                     math.inf if data['cost'] is None else data['cost'], data['errors'],
                     sure, data['evaluations'], tuple(data['remarks']), tuple(data['findings']),
                     data['disturbance'],
                     tests, data['least_cost'], tuple(
                         Alternative(other['name'], other['nrmse_percent'], other['advantage'],
                                     tuple(other['denominator'])) for other in data['orders']))
