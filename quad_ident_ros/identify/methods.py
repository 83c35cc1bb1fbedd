# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The methods. To add one, write its file and its line in METHODS."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from quad_ident_ros.identify.cs import cs
from quad_ident_ros.identify.ls import least_squares_fit
from quad_ident_ros.identify.objective import Fitted, Objective
from quad_ident_ros.identify.pso import pso
from quad_ident_ros.identify.pso_cs import pso_cs
from quad_ident_ros.identify.search import Search
from quad_ident_ros.identify.space import Space
from quad_ident_ros.identify.vp import vp_fit

Searching: TypeAlias = Callable[[Search], None]
Direct: TypeAlias = Callable[[Objective, Space], tuple[Fitted | None, int, list[str]]]


@dataclass(frozen=True)
class Method:
    """
    A way to fit a model.

    search: a function of a Search that minimises its cost, for methods that try candidates;
    direct: a function of (objective, space) that returns a Fitted or None, the evaluations of the
    cost, and remarks, for others.
    """

    name: str
    label: str
    search: Searching | None = None
    direct: Direct | None = None


METHODS = {method.name: method for method in (
    Method('pso', 'PSO', search=pso),
    Method('cs', 'CS', search=cs),
    Method('pso_cs', 'PSO-CS', search=pso_cs),
    Method('ls', 'LS', direct=least_squares_fit),
    Method('vp', 'VP', direct=vp_fit),
)}
