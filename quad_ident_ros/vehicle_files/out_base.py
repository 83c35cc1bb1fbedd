# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The file that a vehicle goes into: what it says now, and what it is to say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from quad_ident_ros.effects.registry import Values
from quad_ident_ros.vehicle_files.reading import Draft
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.wanted import Wanted


@dataclass(frozen=True)
class Base:
    """A base file: its Source, the Draft and the effects that were read of it, what is Wanted."""

    source: Source
    draft: Draft
    effects: Values
    wanted: Wanted

    @property
    def mass(self) -> float:
        """Return the mass of the file, kg."""
        return float(self.draft.data['mass'])

    @property
    def inertia(self) -> np.ndarray:
        """Return the matrix of inertia of the file, (3, 3) kg m^2."""
        values = np.array(self.draft.data['inertia'], float)
        return np.diag(values) if values.ndim == 1 else values

    @property
    def shifts(self) -> np.ndarray:
        """Return how far the rotors of the file move, (n, 3) m, or (0, 3) where it has none."""
        places = [rotor['position'] for rotor in self.constant('rotors') or ()]
        return np.array(places).reshape(-1, 3) * (self.wanted.arms - 1.0)

    def constant(self, key: str) -> Any:
        """Return what the file has of a key of the vehicle file, or None."""
        return self.draft.data.get(key)

    def effect(self, name: str, parameter: str) -> float:
        """Return a parameter of an effect that the file has by itself, 0 where it has none."""
        return self.effects.get(name, {}).get(parameter, 0.0)
