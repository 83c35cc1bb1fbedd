# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""One way to read flights of every format: round trips, and the commands info and convert."""

import json

from flightmaker import changed, copy_bag, flight, px4_samples, ulog
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from reader_checks import CMD, FAST, refused, same, SMALL
from rosbags.rosbag2 import StoragePlugin
from rosbags.typesys import get_typestore, Stores

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.bag import BagWriter
from quad_ident_ros.data.bag_file import read_bag_messages
from quad_ident_ros.data.csv import read_csv, write_csv
from quad_ident_ros.data.export import save, write_bag
from quad_ident_ros.data.load import load
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.model.attitude import rotate


@pytest.mark.slow
@pytest.mark.parametrize('name', ['f.csv', 'f.csv.gz', 'f.mcap', 'folder'])
def test_what_is_saved_reads_back_bit_for_bit(tmp_path, name):
    save(tmp_path / name, flight())
    same(load(tmp_path / name), flight())


COLUMNS = st.lists(st.sampled_from(
    ['px', 'pz', 'qw', 'cmd1', 'rotor2', 'vbat', 'u1', 'phi', 'pwm1', 'note, with comma',
     'a "quote"', 'Höhe']), unique=True, min_size=1)


@pytest.mark.slow
@FAST
@given(names=COLUMNS, data=st.data())
def test_any_record_survives_every_format(tmp_path_factory, names, data):
    count = data.draw(st.integers(2, 6))
    steps = data.draw(st.lists(st.floats(1e-9, 1e3), min_size=count, max_size=count))
    t = data.draw(st.floats(-1e6, 1e6)) + np.cumsum(np.maximum(steps, 1e-8))
    columns = {name: data.draw(st.lists(
        st.floats(allow_nan=name.startswith('pwm'), allow_infinity=name.startswith('pwm')),
        min_size=count, max_size=count)) for name in names}
    if not (np.diff(t) > 0).all():
        return
    # Not a number is one value, whatever else its 64 bits hold: text has one word for it.
    record = FlightRecord(t, {name: np.where(np.isnan(values), np.nan, np.array(values) + 0.0)
                              for name, values in columns.items()})
    folder = tmp_path_factory.mktemp('any')
    last = record
    for step in ('a.csv', 'b.mcap', 'c.csv.gz', 'd', 'e.csv'):
        save(folder / step, last)
        last = load(folder / step)
        same(last, FlightRecord(record.t, dict(record.columns)))


def test_a_written_bag_has_the_topics_that_people_know(tmp_path):
    record = changed(SMALL, u1=SMALL.columns['az'], u4=SMALL.t,
                     moment_x=0 * SMALL.t, moment_y=0 * SMALL.t)
    write_bag(tmp_path / 'bag', record)
    found = {}
    for topic, stamp, message in read_bag_messages(tmp_path / 'bag'):
        found.setdefault(topic, []).append((stamp, message))
    assert set(found) == {'pose', 'twist', 'input', 'altitude', 'specific_force', 'command',
                          'flight_record'}
    stamp, pose = found['pose'][30]
    assert stamp == 300_000_000 == pose.header.stamp.nanosec
    assert pose.pose.position.z == record.columns['pz'][30]
    np.testing.assert_array_equal(found['command'][7][1].data, record.stack(*CMD)[7])
    twist = found['twist'][50][1].twist.linear
    np.testing.assert_allclose(
        rotate(record.stack('qw', 'qx', 'qy', 'qz')[50], [twist.x, twist.y, twist.z]),
        record.stack('vx', 'vy', 'vz')[50], atol=1e-12)


@pytest.mark.slow
def test_the_topics_alone_make_the_flight_too(tmp_path):
    """A bag of our topics, without the exact record, joins into the same flight."""
    experiment = load_experiment('small_angle')
    record = fly(experiment, experiment.runs[0], noise={'attitude': 1e-3}).record
    write_bag(tmp_path / 'whole', record)
    copy_bag(tmp_path / 'whole', tmp_path / 'topics', StoragePlugin.MCAP, {'flight_record'})
    read = load(tmp_path / 'topics', vehicle=experiment.vehicle)   # whose arm makes U2 and U3
    assert set(read.columns) == set(record.columns)
    np.testing.assert_allclose(read.t, record.t, atol=1e-9)
    for name, values in record.columns.items():
        np.testing.assert_allclose(read.columns[name], values, atol=1e-12, err_msg=name)


def test_sqlite3_reads_as_folder_and_as_file(tmp_path):
    write_bag(tmp_path / 'bag', SMALL)
    copy_bag(tmp_path / 'bag', tmp_path / 'sql', StoragePlugin.SQLITE3)
    same(load(tmp_path / 'sql'), SMALL)
    same(load(next((tmp_path / 'sql').glob('*.db3'))), SMALL)


def test_the_content_decides_not_the_name(tmp_path):
    save(tmp_path / 'f.mcap', SMALL)
    (tmp_path / 'f.csv').write_bytes((tmp_path / 'f.mcap').read_bytes())
    same(load(tmp_path / 'f.csv'), load(tmp_path / 'f.mcap'))
    (tmp_path / 'g.bin').write_bytes(ulog(px4_samples(SMALL)))
    assert load(tmp_path / 'g.bin').has('qw', 'px', 'wx', 'ax')


def test_times_that_no_stamp_can_hold_are_refused(tmp_path):
    record = FlightRecord(np.array([0.0, 1e10]), {'pz': np.zeros(2)})
    for name in ('bag', 'f.mcap'):
        with pytest.raises(InputError, match='do not fit'):
            save(tmp_path / name, record)
    assert list(tmp_path.iterdir()) == []


def test_other_endings_are_refused_for_writing(tmp_path):
    with pytest.raises(InputError, match='name one of these'):
        save(tmp_path / 'f.txt', SMALL)


@pytest.mark.slow
def test_a_bag_of_several_flights_is_split(tmp_path, capsys):
    experiment = load_experiment('small_angle')
    flights = [fly(experiment, run).record for run in experiment.runs[:2]]
    with BagWriter(tmp_path / 'bag', [('flight_record', 'std_msgs/msg/Float64MultiArray')]) as w:
        for k, record in enumerate(flights):
            write_bag(tmp_path / f'one{k}', record)
            for _, _, message in read_bag_messages(tmp_path / f'one{k}', {'flight_record'}):
                w.write('flight_record', k, bytes(get_typestore(Stores.ROS2_JAZZY).serialize_cdr(
                    message, message.__msgtype__)))
    refused(tmp_path / 'bag', '2 flights', 'convert')
    assert main(['convert', str(tmp_path / 'bag'), str(tmp_path / 'out.csv')]) == 0
    for k, record in enumerate(flights, 1):
        same(read_csv(tmp_path / f'out_{k}.csv'), record)


# --- the commands

def test_convert_says_what_it_wrote(tmp_path, capsys):
    write_csv(tmp_path / 'f.csv', SMALL)
    assert main(['convert', str(tmp_path / 'f.csv'), str(tmp_path / 'deep/g.mcap'),
                 '--json', '-']) == 0
    [done] = json.loads(capsys.readouterr().out)
    assert done['samples'] == len(SMALL) and done['columns'][:2] == ['t', 'px']
    same(load(done['file']), SMALL)


@pytest.mark.slow
@pytest.mark.parametrize('name', ['bag', 'f.mcap'])
def test_an_interrupted_conversion_leaves_nothing_and_can_be_repeated(tmp_path, name):
    def interrupt(share):
        if share > 0:
            raise KeyboardInterrupt
    with pytest.raises(KeyboardInterrupt):
        save(tmp_path / name, flight(), interrupt)
    assert list(tmp_path.iterdir()) == []
    save(tmp_path / name, flight())
    same(load(tmp_path / name), flight())


def test_a_folder_that_was_there_before_is_left_alone(tmp_path):
    (tmp_path / 'bag').mkdir()
    (tmp_path / 'bag' / 'mine').write_text('kept')
    with pytest.raises((InputError, OSError)):
        save(tmp_path / 'bag', SMALL)
    assert (tmp_path / 'bag' / 'mine').read_text() == 'kept'


@pytest.mark.slow
def test_a_last_line_that_is_left_out_is_said(tmp_path, capsys):
    cut = tmp_path / 'f.csv'
    write_csv(cut, flight())
    cut.write_bytes(cut.read_bytes()[:-1])
    assert main(['convert', str(cut), str(tmp_path / 'g.csv')]) == 0
    assert 'note: the last line of the file has no line end and was left out' in (
        capsys.readouterr().out)
    assert len(load(tmp_path / 'g.csv')) == len(flight()) - 1
    assert main(['info', str(cut), '--json', '-']) == 0
    [finding] = json.loads(capsys.readouterr().out)['findings']
    assert finding['code'] == 'truncated' and finding['severity'] == 'warning'


def test_info_shows_what_the_json_has(tmp_path, capsys):
    record = changed(flight(), wx=np.degrees(flight().columns['wx']),
                     wy=np.degrees(flight().columns['wy']), wz=np.degrees(flight().columns['wz']))
    write_csv(tmp_path / 'f.csv', record)
    assert main(['info', str(tmp_path / 'f.csv'), '--json', str(tmp_path / 'i.json')]) == 3
    shown = capsys.readouterr().out
    data = json.loads((tmp_path / 'i.json').read_text())
    assert data['time']['rate_hz'] == pytest.approx(100)
    assert data['columns']['vbat']['unit'] == 'V'
    assert data['columns']['pz']['maximum'] == record.columns['pz'].max()
    assert [finding['code'] for finding in data['findings']] == ['rate_in_degrees']
    assert 'they are in deg/s' in shown and '2000 samples' in shown and 'roll' in shown
    clock = data['clock']['attitude_against_gyro']
    assert abs(clock['offset_s']) < 4 * clock['std_s']


def test_info_takes_any_record(tmp_path, capsys):
    (tmp_path / 'f.csv').write_text('t,x\n0,1e308\n1,-1e308\n2,\n')
    assert main(['info', str(tmp_path / 'f.csv'), '--vehicle', 'paper_quadrotor', '--json',
                 '-']) == 3
    data = json.loads(capsys.readouterr().out)
    assert data['columns']['x']['missing'] == 1
    assert {finding['code'] for finding in data['findings']} == {'no_columns', 'lacking', 'slow'}
