# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The models of Table 2 on the responses that Table 3 implies: the paper's Figures 4-7."""

from quad_ident_ros.identify.metrics import errors
from quad_ident_ros.identify.objective import Objective
from quad_ident_ros.identify.result import Identification, MethodFit, OutputFit
from quad_ident_ros.identify.signals import signals
from quad_ident_ros.identify.transfer import response, SecondOrder
from quad_ident_ros.identify.uncertainty import KEYS, Uncertainty
from quad_ident_ros.paper.presets import load_preset
from quad_ident_ros.paper.printed import TABLE_2


def printed_identification():
    """Return the Identification whose models are those of Table 2; it has no standard errors."""
    pairs, _ = signals(*load_preset('paper_table3').records)
    methods = next(iter(TABLE_2.values()))
    return Identification({
        method: MethodFit(method, {signal.output: _fit(signal, TABLE_2[signal.output][method])
                                   for signal in pairs}, 0.0)
        for method in methods}, {signal.output: signal for signal in pairs}, {})


def _fit(signal, parameters):
    model = SecondOrder.from_poles(*parameters)
    fitted = response(model, signal.u, signal.period)
    cost = Objective(signal).of_models([model.gain], [model.c1], [model.c0])[0]
    return OutputFit(signal.output, model, (0.0, 0.0), fitted, float(cost),
                     errors(signal.t, signal.y, fitted),
                     Uncertainty(dict.fromkeys(KEYS)), 0)
