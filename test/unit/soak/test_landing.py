# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A simulator that computes a flight is not asked for another, or it would never fly."""

from soak.landing import BEGINS, is_over, is_time_to_ask, LANDED


def test_a_flight_is_over_when_no_sample_has_come_for_a_while():
    assert not is_over(100.0 + 0.9 * LANDED, 100.0)
    assert is_over(100.0 + 1.1 * LANDED, 100.0)


def test_while_a_flight_is_computed_it_is_asked_for_once():
    """For ten times as long as samples are missed when a flight is over."""
    asked, requests = 0.0, 0
    for now in range(round(BEGINS) + 1, round(BEGINS) + 1 + round(10 * LANDED)):
        if is_time_to_ask(float(now), 0.0, asked):
            asked, requests = float(now), requests + 1
    assert requests == 1


def test_who_flies_is_not_asked_and_who_never_began_is_asked_again():
    assert not is_time_to_ask(500.0, 499.0, 0.0)
    assert is_time_to_ask(500.0, 400.0, 499.0 - BEGINS)
