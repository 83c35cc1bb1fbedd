# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Whether a vehicle changed within a window: a payload picked up, a rotor that weakens.

One model for the whole window is compared with one before and another after each of a few
instants, by the Bayesian information criterion (the generalised likelihood ratio of A. S. Willsky
and H. L. Jones, IEEE Trans. Automatic Control 21(1), 1976). The better description must also have
parameters that differ by more than their errors. Where the model leaves dynamics out, two models
are always better than one: what they are better by in the windows before is the measure then.
"""

from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.identify.order import independent_count
from quad_ident_ros.identify.uncertainty import disturbance_error, uncertainty
from quad_ident_ros.identify.vp import residual_of, vp

PLACES = 12          # instants within a window that are tried
FINER = 5            # steps in which an instant that was found is narrowed down
SHORTEST = 40        # samples that a part needs
STRONG = 20.0        # advantage of two models that counts as evidence,
UNUSUAL = 3.0        # and as how many times what it was before
BEYOND_NOISE = 4.0   # standard errors by which a parameter has moved
WATCHED = ('K', 'c1', 'c0', 'disturbance')


@dataclass(frozen=True)
class Change:
    """
    A change of a vehicle: the output that shows it, and when, in s of the window and as a stamp.

    advantage: of two models over one, by the criterion; moved: for each parameter beyond its noise
    its value before and after. 'disturbance' is the constant beside K u: weight that the trim does
    not carry.
    """

    output: str
    time: float
    advantage: float
    moved: dict
    stamp_ns: int | None = None


def find_change(signal, fitted, usual=0.0):
    """
    Return the Change within a signal, or None, and the advantage of two models over one.

    Args: fitted: the Fitted of the whole; usual: the advantage in windows without a change.
    """
    samples = len(signal.y)
    if samples < 2 * SHORTEST:
        return None, 0.0
    one = residual_of(signal, fitted)[signal.measured]
    latest = samples - SHORTEST
    places = np.unique(np.linspace(SHORTEST, latest, PLACES).astype(int))
    best = _best_place(signal, places, fitted.model)
    if best is None:
        return None, 0.0
    before, after, place = best
    two = np.concatenate([residual_of(*part)[part[0].measured] for part in (before, after)])
    count = independent_count(two)
    # The second model, its state at the start and the instant: what the criterion charges for.
    extra = 3 + after[0].unknowns + 1
    better = max(one @ one, 1e-300) / max(two @ two, 1e-300)
    advantage = float(count * np.log(better) - extra * np.log(count))
    if advantage < max(STRONG, UNUSUAL * usual):
        return None, advantage
    gap = -(-(latest - SHORTEST) // (PLACES - 1))
    near = np.linspace(max(place - gap, SHORTEST), min(place + gap, latest), 2 * FINER + 1)
    *parts, place = _best_place(signal, np.unique(near.astype(int)), fitted.model)
    # What it became may be far from what it was: searched for, not stepped to.
    moved = _moved(*((part, vp(part)) for part, _ in parts))
    return (Change(signal.output, float(signal.t[place]), advantage, moved) if moved else None,
            advantage)


def _best_place(signal, places, model):
    """Return the parts, (Signal, Fitted) each, that leave the least, and where; or None."""
    found = [(*parts, place) for place in places
             if (parts := _parts(signal, place, model)) is not None]
    return min(found, key=lambda entry: _power(*entry[:2]), default=None)


def _part(signal, start, stop):
    part = slice(start, stop)
    return replace(signal, t=signal.t[part] - signal.t[part][0], u=signal.u[part],
                   y=signal.y[part], measured=signal.measured[part],
                   at_rest=signal.at_rest and start == 0)


def _parts(signal, place, model):
    """Return (Signal, Fitted) before and after a place, or None where one has no model."""
    pairs = []
    for part in (_part(signal, 0, place), _part(signal, place, None)):
        fitted = vp(part, near=model)
        if not np.isfinite(fitted.cost):
            return None
        pairs.append((part, fitted))
    return pairs


def _power(*parts):
    return sum(float(np.sum(residual_of(*part)[part[0].measured] ** 2)) for part in parts)


def _moved(before, after):
    """Return the parameters that differ by more than their noise, with both values."""
    # Residuals that hang together count as fewer, and the errors as larger.
    samples = np.concatenate([residual_of(*part)[part[0].measured] for part in (before, after)])
    inflation = np.sqrt(len(samples) / independent_count(samples))
    values, errors = [], []
    for part, fitted in (before, after):
        model = fitted.model
        values.append({'K': model.gain, 'c1': model.c1, 'c0': model.c0,
                       'disturbance': fitted.disturbance})
        errors.append({**uncertainty(part, fitted).errors,
                       'disturbance': disturbance_error(part, fitted)})
    moved = {}
    for name in WATCHED:
        spread = [error[name] for error in errors]
        if None in spread:
            continue
        if abs(values[1][name] - values[0][name]) > BEYOND_NOISE * inflation * np.hypot(*spread):
            moved[name] = (values[0][name], values[1][name])
    return moved
