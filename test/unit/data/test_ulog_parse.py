# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A log whose samples are taken at once is what pyulog makes of it, sample by sample."""

import contextlib
import io
import random
import struct

from flightmaker import px4_samples, ulog
import numpy as np
from px4_files import controls, esc, landed, log_of, parameters, status
import pytest
from pyulog import ULog
from reader_checks import log, SMALL
from real import SHARED

from quad_ident_ros.data.load import load
from quad_ident_ros.data.ulog import CUT_OFF, STATES, TOPICS
from quad_ident_ros.data.ulog_parse import parse
from quad_ident_ros.data.ulog_walk import walk
from quad_ident_ros.errors import InputError

WANTED = (*TOPICS, *STATES)
WHOLE = log_of(SMALL, [status(5_000_000), landed(5_000_000, True), landed(5_020_000, False),
                       esc(5_001_000, [500.0] * 4), esc(5_090_000, [500.0] * 4)],
               motors=controls(SMALL), named=parameters(THR_MDL_FAC=0.3))


def by_pyulog(data):
    with contextlib.redirect_stdout(io.StringIO()):
        return ULog(io.BytesIO(data), list(WANTED))


def assert_same(one, other):
    assert one.data_list == other.data_list
    for name in ('initial_parameters', 'msg_info_dict', 'file_corruption'):
        assert getattr(one, name) == getattr(other, name)
    assert len(one.dropouts) == len(other.dropouts)


def message(kind, body):
    return struct.pack('<HB', len(body), kind[0]) + body


@pytest.mark.parametrize('tail', [
    b'', message(b'O', struct.pack('<H', 7)), message(b'O', b'\0') + WHOLE[-60:],
    message(b'R', b'\0\0'), message(b'L', b'6' + bytes(8) + b'armed'), WHOLE[-60:-20],
    message(b'D', b'\0'), message(b'D', b'\xff\xff' + bytes(20)), bytes(40),
    message(b'A', b'\0\0\0vehicle_attitude')], ids=range(10))
def test_what_follows_the_samples_changes_nothing(tmp_path, tail):
    for data in (WHOLE + tail, WHOLE + tail + WHOLE[-60:]):
        assert_same(parse(log(tmp_path, data), WANTED), by_pyulog(data))


@pytest.mark.parametrize('kept', [0.5, 0.7, 0.9, 0.99])
def test_a_log_that_ends_within_a_message_says_so(tmp_path, kept):
    """And is read up to there; one that ends between two messages is as whole as any."""
    inside = round(kept * len(WHOLE))
    last = int(np.max(walk(WHOLE[:inside]).data))
    whole = last + struct.unpack_from('<H', WHOLE, last - 3)[0]
    between, within = (load(log(tmp_path, WHOLE[:end])) for end in (whole, whole + 2))
    assert len(between) == len(within) < len(SMALL)
    assert within.info['notes'] == [CUT_OFF, *between.info['notes']]


@pytest.mark.slow
def test_damaged_logs_are_what_pyulog_makes_of_them(tmp_path):
    chance, read = random.Random(7), 0
    for _ in range(300):
        data = bytearray(WHOLE)
        for _ in range(chance.choice((1, 1, 2, 5))):
            at = chance.randrange(16, len(data))
            if chance.random() < 0.3:
                del data[at:at + chance.choice((1, 3, 40, 10_000))]
            else:
                data[at] = chance.randrange(256)
        try:
            found = parse(log(tmp_path, bytes(data)), WANTED)
        except InputError:
            continue
        assert_same(found, by_pyulog(bytes(data)))
        read += 1
    assert read > 200


def test_a_sample_is_of_its_own_instance_and_length(tmp_path):
    samples = px4_samples(SMALL, outputs=1500 + np.zeros((len(SMALL), 4)))
    samples += [(topic, 1, stamp, [*np.full(4, 1700.0), *values[4:]])
                for topic, _, stamp, values in samples if topic == 'actuator_outputs']
    data = ulog(samples)
    assert_same(parse(log(tmp_path, data), WANTED), by_pyulog(data))


@pytest.mark.skipif(SHARED is None, reason='the logs of PX4 are not there')
@pytest.mark.parametrize('path', sorted(SHARED.glob('px4_logs/*.ulg')
                                        if SHARED else []), ids=lambda path: path.stem)
def test_logs_of_others(path):
    assert_same(parse(path, WANTED), by_pyulog(path.read_bytes()))
