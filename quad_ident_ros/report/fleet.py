# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A fleet's insight in the terminal: what to look at first, then the tables."""

from typing import TextIO

from quad_ident_ros.effects.registry import titled
from quad_ident_ros.fleet.insight import Insight
from quad_ident_ros.report.fleet_words import (
    listed,
    nothing_line,
    of_vehicles,
    points,
    rows_of,
    summary_line,
    whole_gap_line,
    with_configuration,
)
from quad_ident_ros.report.screen import console, say, table_of

POINTS = ('', 'vehicle', 'why', 'what')
EFFECTS_HEAD = ('effect', 'vehicles', 'probability', 'contribution', 'which')
GAPS = ('vehicle', 'groups', 'before', 'after', 'noise')
SHOWN = 0.02        # mean probability from which on an effect has a row


def show_insight(found: Insight, stream: TextIO) -> None:
    """Print an Insight to a stream."""
    screen = console(stream)
    say(screen, summary_line(found))
    some = points(found)
    say(screen, 'what to look at first' if some else nothing_line(found), 'bold')
    if some:
        screen.print(table_of(POINTS, rows_of(some), ('',)))
    rows = effect_rows(found)
    if rows:
        say(screen, 'effects in the fleet: most of the verdicts of so many vehicles name them')
        screen.print(table_of(EFFECTS_HEAD, rows, EFFECTS_HEAD[1:4]))
    if found.gaps:
        say(screen, 'gap of the velocity half a second ahead, m/s: median of the groups')
        screen.print(table_of(GAPS, gap_rows(found), GAPS[1:]))
        if found.gap.before['velocity'] is not None:
            say(screen, whole_gap_line(found))


def effect_rows(found: Insight) -> list[list[str]]:
    """Return a row for each effect that is at all probable."""
    return [[titled(one.effect),
             of_vehicles(one), f'{one.probability:.2f}',
             '' if one.contribution is None else f'{100 * one.contribution:.0f} %',
             'most: the model is wrong' if one.shared else listed(one.having)]
            for one in found.present if one.having or one.probability >= SHOWN]


def gap_rows(found: Insight) -> list[list[str]]:
    """Return a row of the gap of the velocity for each vehicle."""
    return [[with_configuration(one.vehicle, one.configuration), str(one.groups), *(
        '' if stage['velocity'] is None else f'{stage["velocity"][0]:.3g}'
        for stage in (one.before, one.after, one.noise))] for one in found.gaps]
