# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What may be named as a cause, and which columns of the parameter vector that frees."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from quad_ident_ros.diagnose.rules import Rules
from quad_ident_ros.effects.base import Effect, Form
from quad_ident_ros.effects.registry import EFFECTS
from quad_ident_ros.greybox.flights import Flight, inertial
from quad_ident_ros.greybox.nuisances import Nuisance, nuisances
from quad_ident_ros.greybox.parameters import FACTORS, INDEX
from quad_ident_ros.model.vehicle import Vehicle

SCALES = tuple(INDEX[name] for name in (*FACTORS['thrust_coefficient'], 'mass_offset.mass'))
"""Columns that scale thrust over mass."""


@dataclass(frozen=True)
class Candidate:
    """
    An effect in one of its forms, perhaps of one rotor, and its columns.

    form: the name of the form; rotor: the number of the one that it is of, 0 where it is of all;
    usual: whether the form is that of the vehicle file, or else the one that most know; plain:
    whether it has no more parameters than that; share: its part of the effect's prior probability;
    apart: those of its columns that do what another effect does; nuisance: the
    greybox.nuisances.Nuisance that it is instead of an effect, or None.
    """

    effect: str
    label: str
    columns: tuple[int, ...]
    form: str = ''
    rotor: int = 0
    usual: bool = True
    plain: bool = True
    share: float = 1.0
    apart: tuple[int, ...] = ()
    nuisance: Nuisance | None = None

    @property
    def terms(self) -> tuple[tuple[int, ...], ...]:
        """Return the columns of each term of the formula: the effect's, and those of others."""
        whole = tuple(column for column in self.columns if column not in self.apart)
        return (whole, *((column,) for column in self.apart))

    def __hash__(self) -> int:      # of sets of them there are thousands: that of all is slow
        return hash((self.label, self.form))


def candidates(flights: list, vehicle: Vehicle, rules: Rules,
               effects: list[str] | None = None) -> tuple[Candidate, ...]:
    """
    Return the Candidates, in the order of the registry; effects: names, by default all.

    Where the weight set the scale of the commands, none changes thrust over mass by a constant
    factor alone.
    """
    found = []
    voltage = any(np.ptp(flight.course.volt_drop) > rules.voltage for flight in flights)
    known = SCALES if any(flight.levelled for flight in flights) else ()
    for name, effect in EFFECTS.items():
        if effects is not None and name not in effects:
            continue
        forms = [form for form in _known_first(effect, vehicle)
                 if not (form.without_voltage if voltage else form.needs_voltage)
                 and not (inertial(flights) and (form.needs_reference or form.without_voltage))
                 and not (_without_height(flights) and form.needs_height)]
        for form in forms:
            columns = tuple(
                column for parameter in effect.parameters_of(form, len(vehicle.rotors))
                if (column := INDEX[f'{name}.{parameter.name}']) not in known)
            if not columns:
                continue
            one = Candidate(name, f'{name} {form.name}', columns, form.name, 0, form is forms[0],
                            len(form.parameters) <= len(forms[0].parameters),
                            _share(name, form, forms, rules),
                            tuple(column for parameter in form.apart
                                  if (column := INDEX[f'{name}.{parameter}']) in columns))
            found += _of_each_rotor(one) if effect.per_rotor else [one]
    return tuple(found)


def _of_each_rotor(form: Candidate) -> list[Candidate]:
    """Return the Candidates of single rotors of a form that has a column for each."""
    return [replace(form, label=f'{form.label} {j}', columns=(column,), rotor=j,
                    share=form.share / len(form.columns))
            for j, column in enumerate(form.columns, 1)]


def usual_forms(causes: Iterable[Candidate]) -> dict[tuple[str, int], Candidate]:
    """Return {(effect, rotor): the Candidate of its usual form}; rotor as of Candidate."""
    return {(cause.effect, cause.rotor): cause for cause in causes if cause.usual}


def _known_first(effect: Effect, vehicle: Vehicle) -> list[Form]:
    """Return the forms of an effect, first the law that the vehicle file has, else the usual."""
    known = vehicle.effects.get(effect.name, {})
    return sorted(effect.forms, key=lambda form: not any(parameter.name in known
                                                         for parameter in form.parameters))


def unobservable(flights: Sequence[Flight]) -> tuple[str, ...]:
    """Return the names of the effects of which such flights show no form."""
    return tuple(name for name, effect in EFFECTS.items()
                 if inertial(flights) and all(form.needs_reference for form in effect.forms)
                 or _without_height(flights) and all(form.needs_height for form in effect.forms))


def _without_height(flights: Sequence[Flight]) -> bool:
    """Return whether the height over ground is not known."""
    return any('position' in flight.summed for flight in flights)


def _share(name: str, form: Form, forms: Sequence[Form], rules: Rules) -> float:
    """Return a form's part of the prior probability of its effect, of the forms that it has."""
    if len(forms) == 1:
        return 1.0
    shares = [rules.usual_form if one is forms[0]
              else (1.0 - rules.usual_form) / (len(forms) - 1) for one in forms]
    known = rules.priors[name].forms if name in rules.priors else {}
    if known:
        shares = [known.get(one.name, share / rules.forms_seen)
                  for one, share in zip(forms, shares, strict=True)]
        shares = [share / sum(shares) for share in shares]
    return shares[forms.index(form)]


def nuisance_candidates(vehicle: Vehicle, tracks: list, differ: Collection[str] = (),
                        gusty: bool = False) -> tuple[Candidate, ...]:
    """
    Return the Candidates for the nuisances of Tracks, which are not effects.

    differ: names of those by which flights only differ.
    """
    kinds = (kind.differing if kind.name in differ else kind
             for kind in nuisances(vehicle, tracks, gusty))
    return tuple(Candidate(kind.name, kind.name, kind.columns, nuisance=kind) for kind in kinds)
