# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a simulator sends when, without ROS."""

import numpy as np
import pytest

from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.model.attitude import rotation_matrix
from quad_ident_ros.playback import AHEAD, BATCH, Playback, rows_of

EXPERIMENT = load_experiment('hover_single_axis')
FLIGHT = fly(EXPERIMENT, EXPERIMENT.runs[0])
PERIOD = round(EXPERIMENT.period * 1e9)
START = 5 * 10 ** 9


def playing(factor, now=START):
    """Return a Playback whose first run has begun at now, and the notice of that run."""
    playback = Playback(EXPERIMENT, factor)
    playback.next_run()
    notice = playback.load(FLIGHT, now)
    playback.begin(now)
    return playback, notice


def send(playback, count):
    """Send samples and return their stamps, and whether the run is over."""
    stamps, over = [], False
    for _ in range(count):
        stamps.append(playback.sample()[0])
        over = playback.sent()
    return stamps, over


@pytest.mark.parametrize('factor', [0.5, 1.0, 4.0])
def test_samples_are_due_in_their_time_and_have_their_stamps(factor):
    playback, notice = playing(factor)
    sent = []
    for k in range(len(FLIGHT.record)):
        now = START + int(np.ceil(k * PERIOD / factor))
        assert playback.due(now - 2) == (k == 0)     # the first is due at once
        stamps, over = send(playback, playback.due(now))
        sent += stamps
    assert over and len(sent) == notice.samples == len(FLIGHT.record)
    assert (sent[0], sent[-1]) == (notice.start_ns, notice.stop_ns) and sent[0] == START
    np.testing.assert_allclose(np.diff(sent), PERIOD)
    assert playback.due(START + 10 ** 12) == 0


def test_who_is_late_sends_what_was_due():
    playback, _ = playing(1.0)
    assert playback.due(START + 10 * PERIOD) == 11
    assert playback.due(START + 10 ** 15) == playback.length


def test_at_full_speed_readers_are_at_most_so_far_behind():
    playback, notice = playing(0.0)
    assert playback.due(0) == BATCH
    stamps, _ = send(playback, 3 * BATCH)
    assert playback.due(0, notice.start_ns - 1) == AHEAD - 3 * BATCH
    assert playback.due(0, stamps[4]) == 5 + AHEAD - 3 * BATCH < BATCH
    assert playback.due(0, stamps[-1]) == playback.due(0) == BATCH


def test_stamps_never_go_back_from_run_to_run():
    playback, first = playing(1.0)
    assert not playback.is_first and playback.waiting == len(EXPERIMENT.runs) - 1
    playback.next_run()
    second = playback.load(FLIGHT, now=0)     # as if it had been flown before the first
    assert second.start_ns > first.stop_ns
    assert [notice.info['run_index'] for notice in (first, second)] == [0, 1]
    assert first.info['session'] == second.info['session'] == first.start_ns
    again = Playback(EXPERIMENT, 1.0, playback.epoch)
    again.next_run()
    assert again.load(FLIGHT).start_ns > second.stop_ns


def test_stamps_do_not_fall_behind_the_time_that_flights_took_to_compute():
    playback, notice = playing(1.0)
    for _ in EXPERIMENT.runs[1:]:
        playback.next_run()
        now = notice.stop_ns + 10 ** 9
        notice = playback.load(FLIGHT, now)
        assert notice.start_ns == now


def test_each_run_comes_once():
    playback = Playback(EXPERIMENT, 1.0)
    runs = [playback.next_run() for _ in EXPERIMENT.runs]
    assert tuple(runs) == EXPERIMENT.runs and playback.next_run() is None


def test_a_run_that_ends_before_its_time_says_what_was_sent():
    playback, notice = playing(1.0)
    stamps, _ = send(playback, 7)
    cut = playback.cut_short()
    assert cut.cuts_short(notice) and cut.samples == 7 and cut.stop_ns == stamps[-1]
    assert cut.info['end_time'] == pytest.approx(7 * EXPERIMENT.period)
    assert playback.cut_short() is None


def test_a_run_that_is_over_or_has_not_begun_is_not_cut_short():
    playback, _ = playing(1.0)
    assert playback.cut_short() is None
    playback, _ = playing(1.0)
    assert send(playback, playback.length)[1] and playback.cut_short() is None


def test_rows_hold_the_flight_in_the_frames_of_the_topics():
    record = FLIGHT.record
    rows = np.array(rows_of(record))
    np.testing.assert_array_equal(rows[:, 3:6], record.stack('px', 'py', 'pz'))
    world = np.einsum('nij,nj->ni', rotation_matrix(rows[:, 6:10]), rows[:, 10:13])
    np.testing.assert_allclose(world, record.stack('vx', 'vy', 'vz'), atol=1e-12)
    arm = EXPERIMENT.vehicle.arm_length
    np.testing.assert_allclose(rows[:, 16:], record.inputs() * [1.0, arm, arm, 1.0])
