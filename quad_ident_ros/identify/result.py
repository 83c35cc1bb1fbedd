# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What an identification gives, and its form as data."""

from dataclasses import dataclass, field
import math

import numpy as np

from quad_ident_ros.identify import metrics
from quad_ident_ros.identify.signals import GAIN_UNITS, INPUT_OF, OUTPUT_UNITS, OUTPUTS
from quad_ident_ros.identify.transfer import response, SecondOrder


@dataclass(frozen=True)
class OutputFit:
    """
    The fit of one output by one method.

    model is None where the method found none; response (N,) is the fitted output; cost is F;
    errors as in metrics.errors; standard_errors as in uncertainty.standard_errors.
    """

    output: str
    model: SecondOrder | None
    initial: tuple
    response: np.ndarray | None
    cost: float
    errors: dict
    standard_errors: dict
    evaluations: int
    remarks: tuple = ()


@dataclass(frozen=True)
class MethodFit:
    """All outputs fitted by one method."""

    method: str
    outputs: dict
    seconds: float

    @property
    def evaluations(self):
        """Evaluations of F over all outputs."""
        return sum(fit.evaluations for fit in self.outputs.values())

    @property
    def cost(self):
        """Sum of F over the outputs; infinite where one has no model."""
        return sum(fit.cost for fit in self.outputs.values())


@dataclass(frozen=True)
class Identification:
    """The results of all methods on one set of signals; signals maps output to Signal."""

    methods: dict
    signals: dict
    settings: dict
    remarks: tuple = ()
    provenance: dict = field(default_factory=dict)

    @property
    def best(self):
        """Name of the method with the smallest cost."""
        return min(self.methods, key=lambda name: self.methods[name].cost)


def parameter_table(fit):
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


def as_data(identification):
    """Return an Identification as JSON-able data: numbers that are none become None."""
    return clean({
        'schema': 'quad_ident/identification/1',
        'best': identification.best,
        'methods': {name: _method(fit) for name, fit in identification.methods.items()},
        'samples': {name: len(signal.y) for name, signal in identification.signals.items()},
        'period': {name: signal.period for name, signal in identification.signals.items()},
        'settings': identification.settings,
        'remarks': list(identification.remarks),
        **identification.provenance})


def _method(fit):
    return {'seconds': fit.seconds, 'evaluations': fit.evaluations, 'cost': fit.cost,
            'outputs': {name: _output(output) for name, output in fit.outputs.items()}}


def _output(fit):
    model = fit.model
    unit = OUTPUT_UNITS[fit.output]
    units = {'K': GAIN_UNITS[fit.output], 'a': '1/s', 'b': '1/s', 'c1': '1/s', 'c0': '1/s^2',
             'output': unit, **{key: text.replace('unit', unit)
                               for key, text in metrics.UNITS.items()}}
    data = {'input': INPUT_OF[fit.output], 'units': units, 'cost': fit.cost,
            'errors': fit.errors, 'standard_errors': fit.standard_errors,
            'evaluations': fit.evaluations, 'remarks': list(fit.remarks),
            'initial': list(fit.initial), 'form': None, 'stability': None}
    if model is None:
        return {**data, 'K': None, 'a': None, 'b': None, 'c1': None, 'c0': None}
    data.update(form=model.form, stability=model.stability, K=model.gain, c1=model.c1,
                c0=model.c0)
    if model.form == 'complex':
        return {**data, 'a': None, 'b': None,
                'pair': {'real': model.a.real, 'imaginary': model.a.imag}}
    return {**data, 'a': model.a, 'b': model.b}


def clean(value):
    """Return a value as JSON-able data: numbers that are none become None."""
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


def from_data(data, signals):
    """
    Return the Identification that as_data described.

    Args: signals: the Signals it was fitted to, by output; the fitted responses are computed
    anew from the models.
    """
    methods = {}
    for name, method in data['methods'].items():
        outputs = {output: _output_from(output, fit, signals[output])
                   for output, fit in method['outputs'].items()}
        methods[name] = MethodFit(name, outputs, method['seconds'])
    known = ('schema', 'best', 'methods', 'samples', 'period', 'settings', 'remarks')
    provenance = {key: value for key, value in data.items() if key not in known}
    return Identification(methods, signals, data['settings'], tuple(data['remarks']), provenance)


def _output_from(output, data, signal):
    model = fitted = None
    if data['form'] == 'complex':
        pair = complex(data['pair']['real'], data['pair']['imaginary'])
        model = SecondOrder(data['K'], pair, pair.conjugate())
    elif data['form']:
        model = SecondOrder(data['K'], data['a'], data['b'])
    if model is not None:
        fitted = response(model, signal.u, signal.period, data['initial'])
    return OutputFit(output, model, tuple(data['initial']), fitted,
                     math.inf if data['cost'] is None else data['cost'], data['errors'],
                     data['standard_errors'], data['evaluations'], tuple(data['remarks']))
