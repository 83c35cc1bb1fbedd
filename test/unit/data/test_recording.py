# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests of a recording on disk and of what is read back from it."""

import json

from full_disk import file_size_limit
import numpy as np
import pytest
from rosbags.typesys import get_typestore, Stores

from quad_ident_ros.data.bag import BagWriter
from quad_ident_ros.data.bag_file import read_bag_messages
from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.load import load_all
from quad_ident_ros.data.recording import Recording
from quad_ident_ros.data.replay import read_bag
from quad_ident_ros.data.topics import FLIGHT_TOPICS, RUN_TYPE, RunNotice
from quad_ident_ros.errors import InputError

STORE = get_typestore(Stores.ROS2_JAZZY)
MS = 1_000_000
NAMES = {'attitude': '/attitude', 'altitude': '/altitude', 'run': '/run'}


def cdr(topic, stamp, *values):
    """Return a serialized message of attitude or altitude."""
    types = STORE.types
    header = types['std_msgs/msg/Header'](
        stamp=types['builtin_interfaces/msg/Time'](*divmod(stamp * MS, 10 ** 9)), frame_id='world')
    kind = FLIGHT_TOPICS[topic].type
    if topic == 'attitude':
        message = types[kind](header=header, vector=types['geometry_msgs/msg/Vector3'](*values))
    else:
        message = types[kind](header=header, point=types['geometry_msgs/msg/Point'](0, 0, *values))
    return bytes(STORE.serialize_cdr(message, kind))


def run_cdr(notice):
    message = STORE.types[RUN_TYPE](data=notice if isinstance(notice, str) else notice.to_json())
    return bytes(STORE.serialize_cdr(message, RUN_TYPE))


def notice(start, stop, **info):
    return RunNotice(start * MS, stop * MS, (stop - start) // 10 + 1, info)


def rows(start, stop):
    """Return rows of attitude and altitude, with values made from the time."""
    return [(t * MS, (t * 1e-3, -t * 1e-3, 0.1, t / 7)) for t in range(start, stop, 10)]


def record(recording, start, stop, offset=10 ** 15):
    """Write messages and rows as a recorder does."""
    for t, values in rows(start, stop):
        recording.write('attitude', offset + t, cdr('attitude', t // MS, *values[:3]))
        recording.write('altitude', offset + t, cdr('altitude', t // MS, values[3]))
    recording.add_rows(rows(start, stop))


def announce(recording, run, offset=10 ** 15):
    recording.write('run', offset + run.start_ns, run_cdr(run))
    recording.add_run(run)


def check(flight, start, stop):
    """Check a record that was read against the rows that were written."""
    expected = rows(start, stop)
    np.testing.assert_allclose(flight.t, [(t - start * MS) * 1e-9 for t, _ in expected],
                               atol=1e-12)
    np.testing.assert_array_equal(flight.stack('phi', 'theta', 'psi', 'pz'),
                                  [values for _, values in expected])


def test_each_run_is_a_csv_file_and_a_record(tmp_path):
    recording = Recording(tmp_path, NAMES)
    for start in (1000, 3000):
        announce(recording, notice(start, start + 500, run=f'run at {start}'))
        record(recording, start, start + 510)
    recording.close()
    assert recording.folder == tmp_path / 'recording_1'
    assert sorted(path.name for path in recording.folder.iterdir()) == ['bag', 'flight_1.csv',
                                                                        'flight_2.csv']
    flights = read_bag(recording.folder / 'bag')
    assert [flight.info['run'] for flight in flights] == ['run at 1000', 'run at 3000']
    for k, start in enumerate((1000, 3000)):
        check(flights[k], start, start + 510)
        check(read_csv(recording.folder / f'flight_{k + 1}.csv'), start, start + 510)
        assert flights[k].info['dropped'] == 0
        assert flights[k].info['source'] == str(recording.folder / 'bag')


def test_messages_are_kept_under_their_full_names(tmp_path):
    recording = Recording(tmp_path, {'altitude': '/quad/height', 'run': '/quad/run'})
    recording.write('altitude', 5, cdr('altitude', 1000, 2.5))
    recording.close()
    [(topic, stamp, message)] = read_bag_messages(recording.folder / 'bag')
    assert (topic, stamp, message.point.z) == ('/quad/height', 5, 2.5)


def test_a_clock_that_begins_anew_begins_a_file(tmp_path):
    recording = Recording(tmp_path, NAMES)
    record(recording, 5000, 6000)
    record(recording, 0, 500, offset=2 * 10 ** 15)
    recording.close()
    check(read_csv(recording.folder / 'flight_1.csv'), 5000, 6000)
    check(read_csv(recording.folder / 'flight_2.csv'), 0, 500)
    for flight, part in zip(read_bag(recording.folder / 'bag'), [(5000, 6000), (0, 500)],
                            strict=True):
        check(flight, *part)


def test_rows_between_announced_runs_have_a_file_of_their_own(tmp_path):
    recording = Recording(tmp_path, NAMES)
    announce(recording, notice(1000, 1500))
    record(recording, 1000, 2000)
    recording.close()
    check(read_csv(recording.folder / 'flight_1.csv'), 1000, 1510)
    check(read_csv(recording.folder / 'flight_2.csv'), 1510, 2000)


def test_what_was_flushed_is_there_before_the_end(tmp_path):
    recording = Recording(tmp_path, NAMES)
    record(recording, 0, 500)
    recording.flush()
    check(read_csv(recording.folder / 'flight_1.csv'), 0, 500)
    [flight] = read_bag(recording.folder / 'bag')
    check(flight, 0, 500)
    record(recording, 500, 700)
    check(read_csv(recording.folder / 'flight_1.csv'), 0, 500)
    recording.flush()
    check(read_csv(recording.folder / 'flight_1.csv'), 0, 700)
    recording.close()


def test_a_recording_that_was_killed_within_a_flush_is_read_and_says_so(tmp_path):
    recording = Recording(tmp_path, NAMES)
    record(recording, 0, 500)
    recording.flush()
    path = recording.folder / 'bag/bag.mcap'
    before = path.read_bytes()
    record(recording, 500, 700)
    recording.flush()
    after = path.read_bytes()
    begin = next(k for k, (one, other) in enumerate(zip(before, after, strict=False))
                 if one != other)
    path.write_bytes(after[:begin + 2000])
    [flight] = load_all(recording.folder)
    check(flight, 0, 500)
    assert flight.info['notes'][-1].startswith('the bag has no end')
    path.write_bytes(after)
    [flight] = load_all(recording.folder)
    check(flight, 0, 700)
    assert 'notes' not in flight.info
    path.write_bytes(after[:begin + 1000] + b'damaged' + after[begin + 1007:])
    [flight] = load_all(recording.folder)
    check(flight, 0, 500)
    assert flight.info['notes'] == ['damaged parts (chunks) of the bag were left out, with all '
                                    'their messages: 1']
    recording.close()


def test_recordings_are_numbered(tmp_path):
    folders = []
    for _ in range(3):
        recording = Recording(tmp_path / 'new' / 'folder', NAMES)
        folders.append(recording.folder.name)
        recording.close()
    assert folders == ['recording_1', 'recording_2', 'recording_3']


def test_a_home_folder_is_found(tmp_path, monkeypatch):
    monkeypatch.setenv('HOME', str(tmp_path))
    recording = Recording('~/flights', NAMES)
    recording.close()
    assert recording.folder == tmp_path / 'flights/recording_1'


def test_a_folder_that_cannot_be_is_an_os_error(tmp_path):
    (tmp_path / 'file').write_text('x')
    with pytest.raises(OSError):
        Recording(tmp_path / 'file' / 'flights', NAMES)


def test_a_full_disk_keeps_what_was_written(tmp_path):
    recording = Recording(tmp_path, NAMES)
    record(recording, 0, 500)
    recording.flush()
    with file_size_limit(30_000):
        with pytest.raises(OSError):
            for start in range(500, 20_000, 500):
                record(recording, start, start + 500)
                recording.flush()
        try:
            recording.close()
        except OSError:
            pass   # what matters is on disk
    flight = read_csv(recording.folder / 'flight_1.csv')
    assert len(flight) >= 50
    check(flight, 0, 10 * len(flight))
    [flight] = read_bag(recording.folder / 'bag')
    assert len(flight) >= 50
    check(flight, 0, 10 * len(flight))


def test_a_bag_of_another_recorder_needs_no_announcement(tmp_path):
    """As `ros2 bag record` would write it, topics in no order, with other ones among them."""
    kind = FLIGHT_TOPICS['altitude'].type
    text = STORE.types[RUN_TYPE](data='no flight')
    with BagWriter(tmp_path / 'bag', [('/altitude', kind), ('/chatter', RUN_TYPE)]) as writer:
        for k in range(50):
            writer.write('/altitude', k, cdr('altitude', 10 * k, float(k)))
            writer.write('/chatter', k, bytes(STORE.serialize_cdr(text, RUN_TYPE)))
    [flight] = read_bag(tmp_path / 'bag')
    np.testing.assert_array_equal(flight.columns['pz'], np.arange(50.0))
    assert list(flight.columns) == ['pz']


def test_a_bag_tells_what_it_lacks(tmp_path):
    recording = Recording(tmp_path, NAMES)
    announce(recording, notice(0, 490, name='gaps'))
    for t, values in rows(0, 450):   # cut off before the end
        recording.write('attitude', t, cdr('attitude', t // MS, *values[:3]))
        if t // MS % 100:
            recording.write('altitude', t, cdr('altitude', t // MS, values[3]))
    recording.close()
    [flight] = read_bag(recording.folder / 'bag')
    assert (len(flight), flight.info['dropped']) == (40, 10)


@pytest.mark.parametrize('topics, said', [
    ([('/a/altitude', FLIGHT_TOPICS['altitude'].type),
      ('/b/altitude', FLIGHT_TOPICS['altitude'].type)], r'several vehicles \(2 namespaces\)'),
    ([('/chatter', RUN_TYPE)], 'has none of the topics attitude, altitude'),
    ([('/altitude', FLIGHT_TOPICS['altitude'].type)], 'no message on them yet'),
])
def test_a_bag_without_a_flight_is_refused(tmp_path, topics, said):
    with BagWriter(tmp_path / 'bag', topics) as writer:
        for name, _ in topics if len(topics) == 2 else ():
            writer.write(name, 1, cdr('altitude', 1000, 1.0))
    with pytest.raises(InputError, match=said) as caught:
        read_bag(tmp_path / 'bag')
    assert str(tmp_path / 'bag') in str(caught.value)


def test_a_bag_whose_topics_do_not_meet_is_refused(tmp_path):
    recording = Recording(tmp_path, NAMES)
    for t in range(0, 500, 10):
        recording.write('attitude', t, cdr('attitude', t, 0.0, 0.0, 0.0))
        recording.write('altitude', t, cdr('altitude', t + 5, 0.0))
    recording.close()
    with pytest.raises(InputError, match='share no stamps'):
        read_bag(recording.folder / 'bag')


NOTICE = {'start_ns': 1, 'stop_ns': 4, 'samples': 3, 'info': {'name': 'x'}}


def test_a_notice_reads_back():
    assert RunNotice.from_json(RunNotice(1, 4, 3, {'name': 'x'}).to_json()) \
        == RunNotice.from_json(json.dumps(NOTICE)) == RunNotice(1, 4, 3, {'name': 'x'})


@pytest.mark.parametrize('text', [
    '', 'no JSON', '[]', '{}', '3', 'null', '"text"', json.dumps({**NOTICE, 'info': 3}),
    json.dumps({**NOTICE, 'info': 'abc'}), json.dumps({**NOTICE, 'start_ns': 'soon'}),
    json.dumps({**NOTICE, 'start_ns': None}), json.dumps({**NOTICE, 'stop_ns': float('inf')}),
    json.dumps({**NOTICE, 'samples': float('nan')}), '[' * 100_000,
    json.dumps({**NOTICE, 'samples': 10 ** 30}), json.dumps({**NOTICE, 'samples': -1}),
    json.dumps({**NOTICE, 'info': {'run_index': [1]}}),
    json.dumps({**NOTICE, 'info': {'run_count': 'two'}})])
def test_what_announces_no_run_is_refused(text, tmp_path):
    with pytest.raises(InputError, match='announces no run'):
        RunNotice.from_json(text)
    # A bag with such a message still has its flight: `run` may be anybody's topic.
    recording = Recording(tmp_path, NAMES)
    recording.write('run', 1, run_cdr(text))
    record(recording, 0, 500)
    recording.close()
    [flight] = read_bag(recording.folder / 'bag')
    check(flight, 0, 500)


def test_topics_of_other_programs_are_left_alone(tmp_path):
    """The names are common: topics of another type and notices for others do not count."""
    altitude = FLIGHT_TOPICS['altitude'].type
    topics = [('/quad/altitude', altitude), ('/quad/pose', RUN_TYPE), ('/input', RUN_TYPE),
              ('/run', RUN_TYPE)]
    with BagWriter(tmp_path / 'bag', topics) as writer:
        writer.write('/run', 0, run_cdr(notice(0, 490, name='of another')))
        for k in range(50):
            writer.write('/quad/altitude', k, cdr('altitude', 10 * k, float(k)))
            writer.write('/quad/pose', k, run_cdr('here'))
            writer.write('/input', k, run_cdr('more'))
    [flight] = read_bag(tmp_path / 'bag')
    assert list(flight.columns) == ['pz'] and len(flight) == 50
    assert 'name' not in flight.info


def test_topics_of_no_flight_are_not_decoded(tmp_path):
    """Damaged messages of others do not matter."""
    altitude = FLIGHT_TOPICS['altitude'].type
    with BagWriter(tmp_path / 'bag', [('/altitude', altitude), ('/chatter', RUN_TYPE)]) as writer:
        for k in range(50):
            writer.write('/altitude', k, cdr('altitude', 10 * k, float(k)))
            writer.write('/chatter', k, b'not CDR at all')
    assert len(read_bag(tmp_path / 'bag')[0]) == 50


def test_notices_of_runs_that_are_over_are_not_kept_nor_needed(tmp_path):
    recording = Recording(tmp_path, NAMES)
    for start in range(0, 50_000, 1000):
        announce(recording, notice(start, start + 500))
        recording.add_rows(rows(start, start + 500))
        recording.flush()
    assert len(recording._runs) == 1
    # The clock restarts: its notice comes before the last rows of the old time are written.
    recording.add_rows(rows(49_500, 49_510))    # the last of its run
    announce(recording, notice(0, 500))
    recording.flush()
    recording.add_rows(rows(0, 500))
    recording.close()
    assert len(list(recording.folder.glob('flight_*.csv'))) == 51
