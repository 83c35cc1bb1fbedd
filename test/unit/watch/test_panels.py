# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Panels of the live view, as text."""

from dataclasses import replace

from rich.console import Console

from quad_ident_ros.watch.panels import identifier_panel
from quad_ident_ros.watch.state import Fit, Model, State


def text_of(panel):
    console = Console(width=100)
    with console.capture() as capture:
        console.print(panel)
    return capture.get()


def test_a_pole_without_a_value_is_left_empty():
    """A model may have a gain alone, as where one of its poles is faster than the samples."""
    model = Model('phi', (4.25, 1.5, None), (0.125, 0.25, None), None, 91.0)
    said = text_of(identifier_panel(replace(State(), fit=Fit('ls', (model,))), 0.0, 100))
    [row] = [line for line in said.splitlines() if 'phi' in line]
    assert '4.25' in row and '1.50' in row and 'None' not in row
