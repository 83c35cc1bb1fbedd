# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
How probable it is that a ranked effect is present: logistic regression on flights of development.

The weights that come out are `Rules.calibration` of the library. A further feature is a further
line of FEATURES.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from quad_ident_ros.diagnose.probability import relative_size
from withheld.score import column_of, findings_of, named_in, reliability, TITLES

Array = NDArray[np.float64]

# Of a row of the ranking, as the library takes them (diagnose/probability.py), in its order; with
# `relative`: its size over that of the greatest. The library has that in each round of the
# elimination, the ranking that of the round in which an effect is most probable.
FEATURES: dict[str, Callable[[dict], float]] = {
    'explained': lambda row: float(row.get('explained') or 0.0),
    'distance': lambda row: float(np.log1p(row.get('distance') or 0.0)),
    'lesser': lambda row: (1.0 - row['relative']) * float(np.log1p(row.get('distance') or 0.0)),
    'companions': lambda row: float(row.get('companions') or 0.0)}
# Where an effect is as probable as not: alone, explaining all that there is, two standard errors
# from none. Nearly all flights of development have an effect, and a user's need not: with
# their base rate less than two standard errors would suffice.
EVEN = {'explained': 1.0, 'distance': float(np.log1p(2.0))}
# Effects that act alike: where one is present, a probability of the other is not wrong.
ALIKE = ({'thrust_scale', 'mass_offset'}, {'actuation_delay', 'motor_lag'})
RIDGE = 0.01        # on the weights, in units of log likelihood: keeps what a few rows say finite


@dataclass(frozen=True)
class Rows:
    """
    What is regressed: x (N, F) features; present (N,) 0 or 1; groups (N,) columns of the cases.

    names: of the features.
    """

    names: tuple[str, ...]
    x: Array
    present: Array
    groups: tuple[str, ...]


@dataclass(frozen=True)
class Calibration:
    """
    The regression: constant, and weights {feature: (value, standard error)}.

    tables: {group: rows of the reliability table}, 'all' for all of them; loss: mean negative
    log likelihood, and that of the base rate.
    """

    constant: tuple[float, float]
    weights: dict[str, tuple[float, float]]
    tables: dict[str, list[dict[str, float]]]
    loss: float
    loss_of_base_rate: float


def rows_of(pairs: Iterable[tuple[dict, dict]], features: dict = FEATURES) -> Rows:
    """
    Return the rows of the rankings of (label, diagnosis) that say whether an effect is present.

    Those of the best set alone, which have a contribution; not those that are neither there nor
    not: what a label allows, and what acts like a present effect.
    """
    x, present, groups = [], [], []
    for label, found in pairs:
        if label['kind'] == 'hybrid':
            continue
        there = set(label['effects'])
        allowed = set(label.get('beside', ())) | set(label.get('instead', ()))
        ranked = [row for row in found.get('ranking') or ()
                  if row.get('contribution') is not None]
        most = max((row['contribution'] for row in ranked), default=0.0)
        for row in ranked:
            effect = row['effect']
            if effect not in there and (effect in allowed or _alike(effect, there, found)):
                continue
            known = row | {'relative': relative_size(row['contribution'], most)}
            x.append([value_of(known) for value_of in features.values()])
            present.append(float(effect in there))
            groups.append(column_of(label))
    return Rows(tuple(features), np.array(x, float).reshape(-1, len(features)),
                np.array(present), tuple(groups))


def _alike(effect: str, there: set, found: dict) -> bool:
    return named_in(effect, there, findings_of(found)) or any(
        effect in pair and pair & there for pair in ALIKE)


def fit(rows: Rows) -> Calibration:
    """
    Return the Calibration by maximum likelihood; raises ValueError where all or none are present.

    The constant follows from the weights, by EVEN. Standard errors are those of the inverse
    Hessian, of rows that are independent.
    """
    y = rows.present
    if not len(y) or y.min() == y.max():
        raise ValueError(f'{len(y)} effects, all or none of them present: nothing to fit')
    even = np.array([EVEN.get(name, 0.0) for name in rows.names])
    x = rows.x - even
    ridge = RIDGE * np.ones(x.shape[1])

    def cost(b: Array) -> tuple[float, Array]:
        z = x @ b
        value = np.sum(np.logaddexp(0.0, z) - y * z) + 0.5 * np.sum(ridge * b ** 2)
        return value, x.T @ (_logistic(z) - y) + ridge * b

    b = minimize(cost, np.zeros(x.shape[1]), jac=True, method='BFGS').x
    p = _logistic(x @ b)
    covariance = np.linalg.inv((x.T * (p * (1.0 - p))) @ x + np.diag(ridge))
    pairs = [(float(value), float(error))
             for value, error in zip(b, np.sqrt(np.diag(covariance)), strict=True)]
    constant = float(-b @ even), float(np.sqrt(even @ covariance @ even))
    groups = np.array(rows.groups)
    tables = {'all': reliability(p, y)} | {
        name: reliability(p[groups == name], y[groups == name]) for name in dict.fromkeys(groups)}
    base = y.mean()
    return Calibration(
        constant, dict(zip(rows.names, pairs, strict=True)), tables,
        float(np.mean(-y * np.log(p) - (1.0 - y) * np.log1p(-p))),
        float(-base * np.log(base) - (1.0 - base) * np.log1p(-base)))


def text_of(rows: Rows, made: Calibration) -> str:
    """Return coefficients and reliability tables as text."""
    lines = [f'{len(rows.present)} effects ranked, {int(rows.present.sum())} of them there; '
             f'loss {made.loss:.4f} (always the share there: {made.loss_of_base_rate:.4f})', '']
    lines += [f'  {name:<14}{value:8.3f} +- {error:.3f}' for name, (value, error) in (
        ('constant', made.constant), *made.weights.items())]
    values = [made.constant[0], *(value for value, _ in made.weights.values())]
    lines += ['', f'calibration = ({", ".join(f"{value:.3g}" for value in values)})']
    for name, table in made.tables.items():
        lines += ['', f'{TITLES.get(name, name)}:', '  probability    count  mean given  there']
        lines += [f'  {row["from"]:.2f} to {row["to"]:.2f}{row["count"]:8d}{row["given"]:12.3f}'
                  f'{row["present"]:7.3f}' for row in table]
    return '\n'.join(lines)


def _logistic(z: Array) -> Array:
    """Return 1 / (1 + exp(-z)), short of 0 and 1."""
    return np.clip(1.0 / (1.0 + np.exp(-np.clip(z, -500.0, 500.0))), 1e-12, 1.0 - 1e-12)
