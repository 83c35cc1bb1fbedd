# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the soak counts as lost of a recording: neither more nor less than is not on disk."""

import numpy as np
import pytest
from rosbags.typesys import get_typestore, Stores

from quad_ident_ros.data.recording import Recording
from quad_ident_ros.data.topics import FLIGHT_TOPICS, RUN_TYPE, RunNotice
from quad_ident_ros.errors import InputError
from soak.loss import lost

STORE = get_typestore(Stores.ROS2_JAZZY)
STEP = 10_000_000   # ns
START = 10 ** 18
HEIGHTS = 10.0 + 0.005 * np.random.default_rng(3).standard_normal(1000)


def altitude(stamp, height):
    types = STORE.types
    message = types[FLIGHT_TOPICS['altitude'].type](
        header=types['std_msgs/msg/Header'](
            stamp=types['builtin_interfaces/msg/Time'](*divmod(stamp, 10 ** 9)), frame_id=''),
        point=types['geometry_msgs/msg/Point'](0.0, 0.0, height))
    return bytes(STORE.serialize_cdr(message, message.__msgtype__))


def announce(recording, k):
    notice = RunNotice(START, START + 999 * STEP, 1000, {})
    message = STORE.types[RUN_TYPE](data=notice.to_json())
    recording.write('run', START + k * STEP, bytes(STORE.serialize_cdr(message, RUN_TYPE)))
    recording.add_run(notice)


def write(recording, begin, end, messages=True, rows=True):
    for k in range(begin, end):
        stamp, height = START + k * STEP, float(HEIGHTS[k])
        if messages:
            recording.write('altitude', stamp, altitude(stamp, height))
        if rows:
            recording.add_rows([(stamp, (height,))])


@pytest.fixture
def recording(tmp_path):
    made = Recording(tmp_path, {'altitude': '/altitude', 'run': '/run'})
    yield made
    made.close()


def seconds_lost(recording, newest):
    recording.flush()
    return lost(recording.folder, START + newest * STEP)


def test_a_notice_that_comes_late_is_no_loss(recording):
    """The rows before it are in a table of their own, and in the same flight of the bag."""
    write(recording, 0, 150)
    recording.flush()
    announce(recording, 150)
    write(recording, 150, 300)
    assert seconds_lost(recording, 299) == 0.0


@pytest.mark.parametrize('lacks', ['rows', 'messages'])
def test_what_bag_or_table_lacks_is_lost(recording, lacks):
    announce(recording, 0)
    write(recording, 0, 250)
    write(recording, 250, 300, **{lacks: False})
    assert seconds_lost(recording, 299) == pytest.approx(0.5)


def test_a_table_of_another_flight_is_told(recording):
    write(recording, 0, 100, rows=False)
    write(recording, 100, 200, messages=False)
    with pytest.raises(InputError, match='has no row of the bag'):
        seconds_lost(recording, 200)
