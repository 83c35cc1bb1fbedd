# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Parts of a file: --segment, --from and --to, wherever flights are read."""

from dataclasses import replace
from datetime import datetime
import json
import struct

from bag_files import imu, odometry, write1, write2
from blackbox_files import blackbox, rows_of
from dataflash_files import copter, dataflash
from flightmaker import changed, flight, px4_samples, ulog
import numpy as np
from px4_files import controls, FORMATS, log_of, parameters
import pytest
from table_files import others, table

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import read_csv, write_csv
from quad_ident_ros.data.load import load_all
from quad_ident_ros.data.quality.fleet import days, vehicles
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.selection import selected, Selection
from quad_ident_ros.data.split import joined, split
from quad_ident_ros.diagnose.intake import take_in
from quad_ident_ros.diagnose.rules import RULES
from quad_ident_ros.errors import InputError
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.model.dynamics import course_of
from quad_ident_ros.model.vehicle import load_vehicle

WHOLE = flight(seconds=20.0)


@pytest.fixture
def jumped(tmp_path):
    """Return the path of a flight whose position jumps at 8 s: a file of two segments."""
    path = tmp_path / 'f.csv'
    write_csv(path, changed(WHOLE, px=WHOLE.columns['px'] + 2.5 * (WHOLE.t > 7.995)))
    return path


def test_times_keep_the_samples_between_them():
    [kept] = selected('f', [WHOLE], Selection(begin=3.2, end=18.4))
    assert kept.t[0] == pytest.approx(3.2) and kept.t[-1] == pytest.approx(18.4)
    np.testing.assert_array_equal(kept.columns['px'], WHOLE.columns['px'][320:1841])
    assert 't = 3.200 to 18.400 s of 0.000 to 19.990 s' in kept.info['notes'][-1]
    [exact] = selected('f', [changed(WHOLE, t=WHOLE.t - 1e-12)], Selection(begin=3.2, end=3.4))
    assert len(exact) == 21
    [early] = selected('f', [WHOLE], Selection(end=5.0))
    assert early.t[0] == 0.0 and 'began' not in early.info
    assert selected('f', [WHOLE], Selection()) == [WHOLE]
    assert selected('f', [WHOLE], Selection(begin=-3.0, end=90.0)) == [WHOLE]


def test_the_battery_has_been_emptying_since_the_record_began():
    """What falls with time counts from the first sample of the file, however often it is cut."""
    vehicle = load_vehicle('iris')
    [late] = selected('f', [WHOLE], Selection(begin=6.0))
    [later] = selected('f', [late], Selection(begin=9.0))
    assert course_of(later, vehicle).t[0] == pytest.approx(9.0)
    known = type(WHOLE)(WHOLE.t, WHOLE.columns, {'start_ns': 7, 'starts_at_rest': True})
    [late] = selected('f', [known], Selection(begin=6.0))
    assert late.info['start_ns'] == 7 + 6_000_000_000 and 'starts_at_rest' not in late.info


def test_a_segment_is_taken_by_its_number(jumped):
    pieces = load_all(jumped)
    [second] = selected(jumped, pieces, Selection(segment=2))
    np.testing.assert_array_equal(second.t, pieces[1].t)
    assert 'segment 2 of 2' in second.info['notes'][-1]
    [rest] = selected(jumped, pieces, Selection(end=6.0))   # nothing is left of the other
    assert rest.t[-1] == pytest.approx(6.0)
    assert len(selected(jumped, pieces, Selection(begin=2.0, end=18.0))) == 2


@pytest.mark.parametrize(('selection', 'words'), [
    (Selection(begin=35.0, end=65.0), ['--from 35 --to 65', 't = 0.00 to 19.99 s']),
    (Selection(end=-1.0), ['--to -1', 'leaves nothing', 't = 0.00 to 19.99 s']),
    (Selection(segment=3), ['--segment 3', 'one segment']),
])
def test_where_nothing_is_left_the_span_is_told(selection, words):
    with pytest.raises(InputError) as caught:
        selected('f.csv', [WHOLE], selection)
    assert all(word in str(caught.value) for word in ['f.csv', *words])
    assert str(caught.value).count('\n') == 0


def test_many_segments_are_told_in_one_short_line():
    pieces = [WHOLE.slice(100 * k, 100 * k + 90) for k in range(20)]
    with pytest.raises(InputError, match='20 segments, 1: t = 0.00 to 0.89 s, 2:') as caught:
        selected('f.csv', pieces, Selection(segment=21))
    assert len(str(caught.value)) < 400


@pytest.mark.parametrize(('options', 'words'), [
    (['--from', '9', '--to', '9'], '--from 9 --to 9'), (['--from', 'nan'], '--from nan'),
    (['--to', 'inf'], '--to inf'), (['--segment', '0'], '--segment 0')])
def test_what_no_file_can_meet_is_refused_at_once(options, words, capsys):
    assert main(['info', 'none.csv', *options]) == 2
    said = capsys.readouterr().err
    assert words in said and said.count('\n') == 1


@pytest.mark.slow
def test_info_lists_the_segments_and_shows_one(jumped, capsys):
    assert main(['info', str(jumped)]) == 0
    said = capsys.readouterr().out
    assert '2 segments' in said and '--segment N' in said and '11.99' in said
    assert main(['info', str(jumped), '--segment', '2', '--json', '-']) == 0
    data = json.loads(capsys.readouterr().out)
    assert [one['number'] for one in data['segments']] == [1, 2]
    assert data['segments'][1]['start_s'] == data['time']['start_s'] == pytest.approx(8.0)
    assert main(['info', str(jumped), '--segment', '5']) == 2
    assert 'has 2 segments, 1: t = 0.00 to 7.99 s' in capsys.readouterr().err


@pytest.mark.slow
def test_convert_writes_the_part(jumped, tmp_path):
    out = tmp_path / 'part.csv'
    assert main(['convert', str(jumped), str(out), '--segment', '2', '--from', '9',
                 '--to', '15']) == 0
    record = read_csv(out)
    assert record.t[0] == pytest.approx(9.0) and record.t[-1] == pytest.approx(15.0)


@pytest.mark.slow
def test_every_command_that_reads_flights_takes_a_part(jumped, capsys):
    """One that leaves nothing shows that it is heeded, before anything is computed."""
    calls = [['info', jumped], ['convert', jumped, jumped.with_name('o.csv')],
             ['identify', jumped, '--vehicle', 'iris'],
             ['fit', jumped, '--vehicle', 'iris', '--free', 'mass'],
             ['diagnose', jumped, '--vehicle', 'iris'],
             ['diagnose', jumped, '--vehicle', 'iris', '--hold-out', jumped]]
    for call in calls:
        assert main([*map(str, call), '--from', '70']) == 2
        assert '--from 70 leaves nothing' in capsys.readouterr().err


def test_the_parts_of_one_recording_are_one_flight_again(jumped):
    """With a gap between them, over which nothing is taken; its time goes on."""
    pieces = load_all(jumped)
    [whole] = joined(pieces)
    assert len(whole) > len(WHOLE) - 20
    assert 0.099 < np.diff(whole.t).max() < 0.2 and whole.info['source'] == str(jumped)
    assert whole.info['name'] == 'f (2 parts)'
    assert '2 parts of one recording are one flight' in whole.info['notes'][-1]
    [cut] = whole.info['cuts']
    assert cut == pytest.approx(8.1, abs=0.03)
    again = joined([whole])
    assert again == [whole]


def test_flights_of_several_recordings_stay_apart(jumped, tmp_path):
    other = tmp_path / 'g.csv'
    write_csv(other, WHOLE)
    names = [one.info['name'] for one in joined([*load_all(jumped), *load_all(other)])]
    assert names == ['f (2 parts)', 'g']
    unnamed = [changed(WHOLE.slice(0, 500)), changed(WHOLE.slice(500))]
    assert len(joined(unnamed)) == 2


def known(name, **hardware):
    return FlightRecord(WHOLE.t, WHOLE.columns, {'name': name, 'hardware': hardware})


def test_flights_of_several_vehicles_are_told_apart():
    one, other = ({'board': 'PX4_FMU_V5', 'id': f'00020{k}'} for k in (1, 2))
    assert vehicles([known('a', **one), known('b', **one), known('c')]) == []
    [caution] = vehicles([known('a', **one), known('b', **other), known('c', **one), known('d')])
    assert caution['code'] == 'vehicles' and caution['severity'] == 'warning'
    assert caution['message'] == ('they come from 2 vehicles: a, c of PX4_FMU_V5 000201; '
                                  'b of PX4_FMU_V5 000202')


def test_what_only_one_log_knows_tells_no_vehicles_apart():
    assert vehicles([known('a', board='X', id='1'), known('b', board='X')]) == []
    assert len(vehicles([known('a', board='X', id='1'), known('b', board='Y')])) == 1
    # The third has what distinguishes the first two.
    assert len(vehicles([known('a', board='X'), known('b', id='1'), known('c', board='Z')])) == 1


@pytest.mark.slow
def test_logs_know_their_vehicle(tmp_path):
    px4 = tmp_path / 'log.ulg'
    px4.write_bytes(log_of(WHOLE, info={'ver_hw': 'PX4_FMU_V5', 'sys_uuid': '0002af'}))
    assert load_all(px4)[0].info['hardware'] == {'board': 'PX4_FMU_V5', 'id': '0002af'}
    px4.write_bytes(log_of(WHOLE))
    assert load_all(px4)[0].info['hardware'] == {}


def test_logs_of_ardupilot_know_their_board(tmp_path):
    pytest.importorskip('pymavlink', reason='pymavlink is not installed')
    path = tmp_path / 'f.BIN'
    messages = copter(WHOLE.slice(0, 500), np.full((500, 4), 1500.0))
    path.write_bytes(dataflash([*messages[:1], (
        'MSG', (messages[0][1][0], 'CubeBlack 0034003C 31355104 33393633')), *messages[1:]]))
    assert load_all(path)[0].info['hardware'] == {'board': 'CubeBlack',
                                                  'id': '0034003C 31355104 33393633'}


def test_logs_of_betaflight_know_their_craft(tmp_path):
    pytest.importorskip('orangebox', reason='orangebox is not installed')
    path, part = tmp_path / 'f.bbl', WHOLE.slice(0, 300)
    path.write_bytes(blackbox(rows_of(part, np.full((300, 4), 900)),
                              **{'Board information': 'SPBE F405', 'Craft name': 'five inch'}))
    assert load_all(path)[0].info['hardware'] == {'board': 'SPBE F405', 'craft': 'five inch'}


def dated(name, text, clock='start_ns'):
    stamp = int(datetime.fromisoformat(f'{text}+00:00').timestamp()) * 10 ** 9
    return FlightRecord(WHOLE.t, WHOLE.columns, {'name': name, clock: stamp})


def test_flights_of_several_days_are_told_apart():
    flights = [dated('a', '2026-05-12T23:59:00'), dated('b', '2026-05-13T00:01:00', 'utc_ns'),
               dated('c', '2026-05-12T08:00:00')]
    assert days(flights[::2]) == []
    [told] = days(flights)
    assert told['code'] == 'days' and told['severity'] == 'info'
    assert told['message'] == 'they come from 2 days (UTC): a, c of 2026-05-12; b of 2026-05-13'


def test_stamps_since_a_start_tell_no_day():
    flights = [FlightRecord(WHOLE.t, WHOLE.columns, {'name': 'a', 'start_ns': start})
               for start in (0, 3 * 86400 * 10 ** 9)]
    assert days([*flights, dated('c', '2026-05-12T08:00:00')]) == []


@pytest.mark.parametrize('stamp', [2 ** 72, -1, 1e300, 'today', True])
def test_a_stamp_that_is_no_date_tells_no_day(stamp):
    odd = FlightRecord(WHOLE.t, WHOLE.columns, {'name': 'a', 'utc_ns': stamp})
    assert days([odd, dated('c', '2026-05-12T08:00:00')]) == []


@pytest.mark.slow
def test_logs_of_px4_know_their_day(tmp_path):
    path, utc = tmp_path / 'log.ulg', 1778659200 * 10 ** 6
    times = ((100, 0), (600_100, utc), (700_100, utc + 100_000), (800_100, 2 ** 62))
    fixes = [('vehicle_gps_position', 0, stamp, struct.pack('<Q', value))
             for stamp, value in times]
    path.write_bytes(log_of(WHOLE, fixes, {
        **FORMATS, 'vehicle_gps_position': ('uint64_t timestamp', 'uint64_t time_utc_usec')}))
    [record] = load_all(path)
    assert record.info['utc_ns'] - record.info['start_ns'] == (utc - 600_100) * 1000
    path.write_bytes(log_of(WHOLE))
    assert load_all(path)[0].info['utc_ns'] is None


@pytest.mark.slow
def test_a_diagnosis_warns_of_several_vehicles():
    hummingbird = load_vehicle('hummingbird')
    flights = [fly_closed_loop(hummingbird, {}, 'lissajous', duration=8.0, seed=seed)
               for seed in (1, 2)]
    flights = [replace(flight, info={**flight.info, 'hardware': {'id': str(number)}})
               for number, flight in enumerate(flights)]
    found = take_in(flights, hummingbird, None, RULES)
    assert 'vehicles' in {one['code'] for one in found.findings}


@pytest.mark.slow
def test_a_diagnosis_says_which_part_is_used():
    hummingbird = load_vehicle('hummingbird')
    whole = fly_closed_loop(hummingbird, {}, 'lissajous', duration=14.0, seed=1)
    cut = selected('f', split(whole, [(6.0, 6.01, 'it was reset')]), Selection(begin=1.0))
    cut = [replace(one, info={**one.info, 'whole': ['f', 'f.csv']}) for one in cut]
    intake = take_in(cut, hummingbird, None, RULES)
    [finding] = [one for one in intake.findings if one['code'] == 'kept']
    assert finding['severity'] == 'info' and finding['flight'] == 'f (2 parts)'
    assert finding['where'] == 't = 1.00 to 6.00 s and t = 6.10 to 14.00 s'
    assert 'half of' in intake.names[0] and 'the other half of' in intake.names[1]
    [blocks] = [one for one in intake.findings if one['code'] == 'blocks']
    for begin, end in blocks['spans']:
        assert f'{begin:.2f} to {end:.2f}' in blocks['where'] and 1.0 <= begin < end <= 14.0
    assert not [one for one in take_in([whole], hummingbird, None, RULES).findings
                if one['code'] == 'kept']


def faulty_table(tmp_path, **cells):
    """Return the path of WHOLE as a table in which cells (column: {sample: text}) are others."""
    path = tmp_path / 'faulty.csv'
    write_csv(path, WHOLE)
    head, *rows = path.read_text().splitlines()
    names, rows = head.split(','), [row.split(',') for row in rows]
    for name, texts in cells.items():
        for sample, text in texts.items():
            rows[sample][names.index(name)] = text
    path.write_text('\n'.join([head, *map(','.join, rows)]) + '\n')
    return path


@pytest.mark.parametrize('cells', [
    {'px': {1500: 'nan'}}, {'t': {1500: 'nan'}}, {'t': {1500: '3.0'}},
    {'px': {1999: 'inf'}, 'vz': {1700: 'nan'}}])
@pytest.mark.parametrize('command', ['info', 'convert'])
def test_what_is_wrong_outside_the_times_does_not_refuse_a_table(tmp_path, capsys, cells,
                                                                 command):
    path = faulty_table(tmp_path, **cells)
    words = [command, str(path), *([str(tmp_path / 'out.csv')] if command == 'convert' else [])]
    assert main([*words, '--from', '2', '--to', '12']) == 0
    if command == 'convert':
        kept = read_csv(tmp_path / 'out.csv')
        np.testing.assert_array_equal(kept.t, WHOLE.t[200:1201])
        assert (tmp_path / 'out.csv').unlink() is None
    capsys.readouterr()
    assert main([*words, '--from', '2', '--to', '19.995']) != 0     # inside
    said = ''.join(capsys.readouterr())
    assert 'line ' in said and f'take a part: --to {"16.99" if "vz" in cells else "14.99"}' in said
    assert main(words) != 0


def test_what_is_wrong_in_another_segment_does_not_refuse_one(tmp_path):
    far = {k: repr(float(WHOLE.columns['px'][k] + 2.5)) for k in range(800, len(WHOLE))}
    path = faulty_table(tmp_path, px=far, vx={300: 'nan'})
    pieces = load_all(path, in_part=True)
    assert [len(piece) for piece in pieces] == [799, len(WHOLE) - 800]
    [second] = selected(path, pieces, Selection(segment=2))
    assert second.t[0] == WHOLE.t[800] and 'spoilt' not in second.info
    with pytest.raises(InputError, match='line 302, column .vx.: nan'):
        selected(path, pieces, Selection(segment=1))
    [late] = selected(path, pieces, Selection(segment=1, begin=3.5))
    assert late.t[0] == pytest.approx(3.5)


def test_tables_of_others_hold_gaps_where_a_number_is_none(tmp_path):
    path = table(tmp_path, others(WHOLE) | {'pos_x': np.where(
        WHOLE.t > 15.0, np.nan, WHOLE.columns['px'])})
    [kept] = selected(path, load_all(path, in_part=True), Selection(end=12.0))
    assert kept.t[-1] == pytest.approx(12.0, abs=0.011)


@pytest.mark.slow
@pytest.mark.parametrize('write', [write1, write2])
def test_an_attitude_that_is_none_outside_the_times_does_not_refuse_a_bag(tmp_path, write):
    """As motion capture writes it where it has lost the vehicle."""
    rows = [*odometry(WHOLE), *imu(WHOLE)]
    for k in range(1500, 1600):
        rows[k][3]['pose']['pose']['orientation'] = {}
    path = write(tmp_path / ('f.bag' if write is write1 else 'f'), rows)
    with pytest.raises(InputError, match='message 1501.*not have length 1.*--from'):
        load_all(path)
    pieces = load_all(path, in_part=True)
    [kept] = selected(path, pieces, Selection(end=12.0))
    assert kept.t[-1] == pytest.approx(12.0) and len(kept) == 1201
    with pytest.raises(InputError, match='message 1501'):
        selected(path, pieces, Selection(end=15.5))


@pytest.mark.parametrize('bad', [0.0, float('nan'), 3.0])
def test_an_attitude_that_is_none_outside_the_times_does_not_refuse_a_log(tmp_path, bad):
    path = tmp_path / 'f.ulg'
    lost = 5_000_000 + 15_000_000
    samples = [(topic, which, stamp, [bad] * 4 if topic == 'vehicle_attitude' and stamp > lost
                else values)
               for topic, which, stamp, values in px4_samples(WHOLE, motors=controls(WHOLE))]
    path.write_bytes(ulog(samples, FORMATS, parameters()))
    [kept] = selected(path, load_all(path, in_part=True), Selection(end=12.0))
    assert kept.t[-1] == pytest.approx(12.0, abs=0.011)
