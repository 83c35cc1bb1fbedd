# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is known of effects before looking: learnt from a fleet, kept in a file, used if asked."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
import math
from pathlib import Path
from typing import Any

import yaml

from quad_ident_ros import resources, schema
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.errors import InputError
from quad_ident_ros.whole_file import write_whole

SCHEMA = 'quad_ident/priors/2'
LEAST, MOST = 1e-3, 0.999
"""Probabilities of being present, at least and at most: a fleet never rules an effect out."""


@dataclass(frozen=True)
class EffectPrior:
    """
    What a fleet knows of an effect.

    present: the probability that a vehicle has it; forms {form: share, of those that have it};
    sizes {parameter: how far it usually is from no effect, SI}; form_error: the relative error of
    its formula, or None where that is not known.
    """

    present: float
    forms: Mapping[str, float] = field(default_factory=dict)
    sizes: Mapping[str, float] = field(default_factory=dict)
    form_error: float | None = None


Priors = dict[str, EffectPrior]
"""{effect: EffectPrior}."""


def load_priors(path: str | Path) -> Priors:
    """Return the priors in a file; raises InputError where it has none."""
    data = resources.read_yaml(path)
    schema.check_keys(str(path), data, ('schema', 'vehicles', 'effects'))
    if data.get('schema') != SCHEMA:
        raise InputError(f'{path}: schema: expected {SCHEMA}; give a file that `quad_ident fleet '
                         '--out-priors` has written')
    entries = data.get('effects')
    schema.check_keys(f'{path}: effects', entries, EFFECTS)
    return {name: _prior(f'{path}: {name}', name, entry) for name, entry in entries.items()}


def write_priors(path: str | Path, priors: Priors, vehicles: int) -> None:
    """Write priors that so many vehicles have taught; raises InputError."""
    data = {'schema': SCHEMA, 'vehicles': vehicles, 'effects': {
        name: {key: _rounded(value) for key, value in asdict(prior).items() if value}
        for name, prior in sorted(priors.items())}}
    try:
        write_whole(path, yaml.safe_dump(data, sort_keys=False))
    except OSError as error:
        raise InputError(f'{path}: cannot be written: {error.strerror}') from None


def bounded(present: float) -> float:
    """Return a probability of being present that is neither certain nor excluded."""
    return min(max(present, LEAST), MOST)


def log_odds(probability: float) -> float:
    """Return the logarithm of the odds of a probability."""
    return math.log(probability / (1.0 - probability))


def _prior(where: str, name: str, entry: object) -> EffectPrior:
    schema.check_keys(where, entry, ('present', 'forms', 'sizes', 'form_error'))
    assert isinstance(entry, dict)
    effect = EFFECTS[name]
    present = bounded(schema.number(f'{where}: present', entry.get('present'), 0.0, 1.0))
    forms, sizes = entry.get('forms') or {}, entry.get('sizes') or {}
    schema.check_keys(f'{where}: forms', forms, [form.name for form in effect.forms])
    schema.check_keys(f'{where}: sizes', sizes, [one.name for one in effect.parameters])
    form_error = entry.get('form_error')
    return EffectPrior(
        present,
        {form: schema.number(f'{where}: forms: {form}', share, 0.0, 1.0, exclusive=True)
         for form, share in forms.items()},
        {key: schema.number(f'{where}: sizes: {key}', size, 0.0, exclusive=True)
         for key, size in sizes.items()},
        None if form_error is None else schema.number(f'{where}: form_error', form_error, 0.0,
                                                      1.0))


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(one) for key, one in value.items()}
    return float(f'{value:.4g}')
