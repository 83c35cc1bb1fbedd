# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""How well numbers of a vehicle are known together: the section `covariance` of its file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError
from quad_ident_ros.model import quantities

DIGITS = 9          # of a correlation in a file: 0.999999999 still differs from 1
ROUNDED = 1e-6      # how far off what people round to six digits is from symmetric or positive


@dataclass(frozen=True)
class Covariance:
    """
    Standard deviations (P,) of numbers of a vehicle, and their correlation (P, P).

    names: of model.quantities, in whose units the deviations are.
    """

    names: tuple[str, ...]
    stds: tuple[float, ...]
    correlation: tuple[tuple[float, ...], ...]

    @property
    def matrix(self) -> np.ndarray:
        """Return the covariance (P, P), in products of the units."""
        return np.array(self.correlation) * np.outer(self.stds, self.stds)


def covariance_of_matrix(names: Iterable[str], matrix: np.ndarray) -> Covariance:
    """Return the Covariance of numbers by its matrix (P, P), rounding errors taken out."""
    stds = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    scale = np.where(stds > 0.0, stds, 1.0)
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T) / np.outer(scale, scale))
    table = (vectors * np.maximum(values, 0.0)) @ vectors.T
    np.fill_diagonal(table, np.where(stds > 0.0, np.diag(table), 1.0))
    scale = np.sqrt(np.diag(table))
    table = np.round(table / np.outer(scale, scale), DIGITS)
    np.fill_diagonal(table, 1.0)
    return Covariance(tuple(names), tuple(stds.tolist()), tuple(map(tuple, table.tolist())))


def covariance_from(where: str, data: Any, rotor_count: int) -> Covariance:
    """Return the Covariance that a section of a vehicle file describes; raises InputError."""
    schema.check_keys(where, data, ('parameters', 'correlation'), ('parameters', 'correlation'))
    known, given = quantities.units(rotor_count), data['parameters']
    schema.check_keys(f'{where}: parameters', given, known)
    stds = []
    for name, entry in given.items():
        here = f'{where}: parameters: {name}'
        schema.check_keys(here, entry, ('std', 'unit'), ('std', 'unit'))
        if entry['unit'] != known[name] and str(entry['unit']) != known[name]:
            raise InputError(f'{here}: unit: {schema.shown(entry["unit"])} is not the unit of '
                             f'{name}; give the std in {known[name]}')
        stds.append(schema.number(f'{here}: std', entry['std'], 0.0))
    table = _correlation(f'{where}: correlation', data['correlation'], tuple(given))
    return Covariance(tuple(given), tuple(stds), table)


def covariance_to_mapping(covariance: Covariance, rotor_count: int) -> dict[str, Any]:
    """Return the section of a vehicle file that covariance_from reads back."""
    known = quantities.units(rotor_count)
    return {'parameters': {name: {'std': std, 'unit': known[name]} for name, std in
                           zip(covariance.names, covariance.stds, strict=True)},
            'correlation': [list(row) for row in covariance.correlation]}


def _correlation(where: str, rows: Any, names: Sequence[str]) -> tuple[tuple[float, ...], ...]:
    """Return the rows of a matrix of correlation; raises InputError where it can be none."""
    count = len(names)
    if not isinstance(rows, list) or len(rows) != count:
        raise InputError(f'{where}: expected {count} rows, one for each of the parameters, got '
                         f'{len(rows) if isinstance(rows, list) else schema.shown(rows)}')
    table = np.array([schema.numbers(f'{where}[{k}]', row, count, -1.0)
                      for k, row in enumerate(rows)]).reshape(count, count)
    for k, j in np.argwhere(table > 1.0 + ROUNDED).tolist():
        raise InputError(f'{where}[{k}][{j}]: {table[k, j]:g} is not a correlation; they are '
                         'between -1 and 1')
    for k in np.flatnonzero(np.diag(table) < 1.0 - ROUNDED).tolist():
        raise InputError(f'{where}[{k}][{k}]: {table[k, k]:g} is that of {names[k]} with itself; '
                         'it is 1')
    for k, j in np.argwhere(np.abs(table - table.T) > ROUNDED).tolist():
        raise InputError(f'{where}: {names[k]} and {names[j]} have {table[k, j]:g} in row '
                         f'{k + 1} and {table[j, k]:g} in row {j + 1}: it is not symmetric')
    least = float(np.linalg.eigvalsh(table).min(initial=0.0))
    if least < -ROUNDED * max(count, 1):
        raise InputError(f'{where}: numbers cannot be correlated so: the least eigenvalue is '
                         f'{least:.2g}, expected none below 0; copy it as `diagnose '
                         '--out-vehicle` wrote it')
    return tuple(map(tuple, table.tolist()))
