# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What `quad_ident fleet` takes and says, without the work itself."""

from contextlib import nullcontext
from dataclasses import replace
import datetime
import io
import json
from types import SimpleNamespace

from full_disk import file_size_limit
import pytest
from rich.console import Console

from quad_ident_ros import cluster
from quad_ident_ros.cli.main import main, parser
from quad_ident_ros.errors import InputError

pytest.importorskip('pyarrow', reason="pyarrow is not installed: pip install '.[fleet]'")
from quad_ident_ros.fleet import run  # noqa: E402, I100
from quad_ident_ros.fleet.run import COMPARING, DIAGNOSING, Progress, Summary  # noqa: E402, I100
from quad_ident_ros.fleet.store import prepare  # noqa: E402, I100
from quad_ident_ros.report.fleet_run import (  # noqa: E402, I100
    dashboard,
    line,
    Reporter,
    seconds_left,
    summary_text,
    workers,
)
from quad_ident_ros.report.screen import progress_bar  # noqa: E402, I100

HALF = Progress(DIAGNOSING, total=100, done=50, here=20)


def test_a_line_says_how_much_is_done_how_fast_and_what_went_wrong():
    assert line(replace(HALF, refused=3, failed=1), 60.0) == (
        'diagnosing: 50 of 100 groups, 30 per minute, 1 min 40 s left, 3 refused, 1 failed')
    assert line(Progress(DIAGNOSING, 100, 20, 20), 5.0) == 'diagnosing: 20 of 100 groups'
    assert line(Progress(COMPARING, 40, 10), 5.0) == (
        'comparing: 10 of 40 parameters of vehicles, 120 per minute, 15 s left')


def test_a_line_has_no_power_of_ten():
    assert '2917 per minute' in line(Progress(DIAGNOSING, 10000, 2917), 60.0)


@pytest.mark.parametrize('width', [40, 80])
def test_no_end_of_the_line_is_cut_on_a_narrow_terminal(width):
    text = line(Progress(DIAGNOSING, 1000, 500, 20, refused=30, failed=12), 6000.0)
    bar = progress_bar()
    bar.add_task(text, total=1000)
    screen = Console(width=width, file=io.StringIO())
    screen.print(bar.get_renderable())
    shown = screen.file.getvalue()
    assert set(text.split()) <= set(shown.split()) and '0 %' in shown


def test_the_time_left_counts_what_was_done_in_this_run_alone():
    assert seconds_left(HALF, 60.0) == pytest.approx(100.0)     # 30 in 60 s, 50 to go
    assert seconds_left(replace(HALF, done=100), 60.0) == 0.0
    assert seconds_left(Progress(DIAGNOSING, 100, 20, 20), 60.0) is None


def test_the_end_says_what_became_of_all_groups_and_what_to_do():
    groups = {'diagnosed': 7, 'refused': 2, 'failed': 1, 'timeout': 0}
    text = summary_text(Summary(12, groups, 4, ('b.csv',)), 'out')
    assert text.splitlines() == [
        '12 flights in 10 groups: 7 diagnosed, 2 refused, 1 failed (4 of them before)',
        '1 file left out, whose content is that of another: b.csv',
        'the same command tries again what failed; the reasons are in the column reason of '
        'out/groups']


def test_the_end_says_which_results_stay_without_their_flights():
    groups = {'diagnosed': 7, 'refused': 0, 'failed': 0, 'timeout': 0}
    text = summary_text(Summary(12, groups, 7, (), kept=('/disk/b.csv',)), 'out')
    assert text.splitlines()[1] == (
        '1 group not counted: its result stays, but flights cannot be read any more: /disk/b.csv; '
        'bring them back, or no longer name them')


def test_the_end_says_which_flights_left_the_data_set():
    groups = {'diagnosed': 7, 'refused': 0, 'failed': 0, 'timeout': 0}
    text = summary_text(Summary(12, groups, 6, (), removed=('/card/1.bin has other content now',)),
                        'out')
    assert text.splitlines()[1] == (
        '1 flight removed from the data set: /card/1.bin has other content now; to keep a flight, '
        'give its file a name of its own and leave it there')


def test_the_end_says_which_groups_failed_and_left_older_results():
    groups = {'diagnosed': 7, 'refused': 0, 'failed': 0, 'timeout': 1}
    text = summary_text(
        Summary(12, groups, 7, (), stayed=('seven, 2026-05-14: it took long',)), 'out')
    assert text.splitlines()[1] == (
        '1 group failed, and the older results of its flights stay until there are new ones: '
        'seven, 2026-05-14: it took long')
    assert text.splitlines()[2] == 'the same command tries again what failed'


def test_the_end_says_which_folders_are_taken_for_those_of_one_vehicle():
    groups = {'diagnosed': 1, 'refused': 0, 'failed': 0, 'timeout': 0}
    text = summary_text(Summary(2, groups, 0, (), together=('logs: a/logs, b/logs',)), 'out')
    assert text.splitlines()[1] == (
        'taken for flights of one vehicle, by the names of folders: logs: a/logs, b/logs; if they '
        'are of several, name the folder that the folders of the vehicles are in, or a manifest '
        'with a column vehicle')


def test_the_end_says_which_flights_nothing_dates_but_their_files():
    groups = {'diagnosed': 7, 'refused': 0, 'failed': 0, 'timeout': 0}
    text = summary_text(Summary(12, groups, 7, (), undated=tuple('abcd')), 'out')
    assert text.splitlines()[1] == (
        '4 flights without a date in manifest, log or name, dated by the last change of the file, '
        'which a copy may not keep: a, b, c ...; write dates into a manifest or into the names')


def test_the_end_says_which_groups_have_no_values_of_single_flights():
    groups = {'diagnosed': 7, 'refused': 0, 'failed': 0, 'timeout': 0}
    assert summary_text(Summary(12, groups, 0, (), ('it took long',) * 2), 'out').splitlines() == [
        '12 flights in 7 groups: 7 diagnosed', '2 groups without values of single flights: it '
        'took long; the same command tries again']


def run_of(summary, tmp_path, monkeypatch):
    """Return the exit code of the command, and its last line of JSON, where a run ends so."""
    client = SimpleNamespace(scheduler_info=lambda **_: {'workers': {}}, ncores=dict)

    def run_fleet(client, plan, out, **_):
        prepare(out)
        return summary

    monkeypatch.setattr(cluster, 'cluster', lambda *_: nullcontext(client))
    monkeypatch.setattr(run, 'run_fleet', run_fleet)
    (tmp_path / 'a.csv').write_text('t,px\n0,1\n0.1,2\n')
    code = main(['fleet', str(tmp_path / 'a.csv'), '--vehicle', 'hummingbird', '-o',
                 str(tmp_path / 'out'), '--json', str(tmp_path / 'run.json')])
    return code, json.loads((tmp_path / 'run.json').read_text().splitlines()[-1])


def test_the_end_says_which_groups_gave_way_and_the_command_ends_with_3(tmp_path, monkeypatch):
    groups = {'diagnosed': 1, 'refused': 0, 'failed': 0, 'timeout': 0}
    summary = Summary(3, groups, 0, (), gave_way=('c.csv: another run has diagnosed it',))
    assert summary_text(summary, 'out').splitlines() == [
        '3 flights in 1 group: 1 diagnosed',
        '1 group without a result: c.csv: another run has diagnosed it']
    code, last = run_of(summary, tmp_path, monkeypatch)
    assert code == 3 and last['gave_way'] == list(summary.gave_way)


@pytest.mark.parametrize('before', [0, 2])
def test_where_all_is_refused_the_command_says_so_and_ends_with_3(
        tmp_path, monkeypatch, capsys, before):
    """A pipeline has to see that there is no diagnosis, also where it looks a second time."""
    groups = {'diagnosed': 0, 'refused': 2, 'failed': 0, 'timeout': 0}
    code, _ = run_of(Summary(3, groups, before, ()), tmp_path, monkeypatch)
    lines = capsys.readouterr().out.splitlines()
    assert code == 3
    assert lines[1] == (
        f'no flight could be diagnosed; the column reason of {tmp_path}/out/flights says what is '
        'wrong with each of those refused: mend them, or name other flights')


@pytest.mark.parametrize('summary', [
    Summary(3, {'diagnosed': 1, 'refused': 2, 'failed': 0, 'timeout': 0}, 0, ()),
    Summary(3, {'diagnosed': 3, 'refused': 0, 'failed': 0, 'timeout': 0}, 3, ()),
    Summary(1, {'diagnosed': 0, 'refused': 1, 'failed': 0, 'timeout': 0}, 0, (), kept=('b.csv',)),
    Summary(0, {'diagnosed': 0, 'refused': 0, 'failed': 0, 'timeout': 0}, 0, (), kept=('b.csv',))],
    ids=['some refused', 'diagnosed before', 'older results stay', 'nothing is new'])
def test_where_there_is_a_diagnosis_the_command_ends_with_0(
        tmp_path, monkeypatch, capsys, summary):
    assert run_of(summary, tmp_path, monkeypatch)[0] == 0
    assert 'no flight could be diagnosed' not in capsys.readouterr().out


@pytest.mark.parametrize('elsewhere', [
    {'gave_way': ('c.csv: another run has diagnosed it',)}, {'stayed': ('seven: it hung',)}])
def test_a_diagnosis_of_another_run_or_of_before_is_not_denied(elsewhere):
    """These runs end with 3 as well, and say why by themselves."""
    groups = {'diagnosed': 0, 'refused': 1, 'failed': 0, 'timeout': 0}
    assert 'could be diagnosed' not in summary_text(Summary(2, groups, 0, (), **elsewhere), 'out')


@pytest.mark.parametrize('drawn, said', [
    (object(), "Dask's dashboard: http://10.0.0.5:8787/status"),
    (None, '')])
def test_the_dashboard_is_named_where_the_scheduler_can_draw_it(drawn, said):
    client = SimpleNamespace(dashboard_link='http://10.0.0.5:8787/status',
                             run_on_scheduler=lambda *words: drawn)
    assert dashboard(client) == said


@pytest.mark.parametrize('limits, said', [
    ([2e9, 4e9], '2 workers, each up to 2 GB of memory'), ([2e9, 0], 'memory is not bounded'),
    ([], 'waiting for a worker to join')])
def test_it_is_said_whether_the_memory_of_the_workers_is_bounded(limits, said):
    found = {str(number): {'memory_limit': limit} for number, limit in enumerate(limits)}
    assert said in workers(SimpleNamespace(scheduler_info=lambda **_: {'workers': found}))


def reporter_of(path):
    """Return a Reporter of a cluster without workers, and what a run ends with."""
    client = SimpleNamespace(scheduler_info=lambda **_: {'workers': {}}, ncores=dict)
    return Reporter(client, path.parent, path), Summary(
        0, dict.fromkeys(('diagnosed', 'refused', 'failed', 'timeout'), 0), 0, ())


def test_the_reasons_of_the_first_flights_that_are_refused_are_said(tmp_path, capsys):
    reporter, summary = reporter_of(tmp_path / 'lines.json')
    day = datetime.date(2026, 5, 14)
    with reporter:
        for number in range(5):
            group = SimpleNamespace(key=str(number), vehicle='one', configuration='', date=day)
            outcome = SimpleNamespace(status='refused', reason=f'{number}.csv: the file is empty',
                                      seconds=0.1)
            reporter.tell(Progress(DIAGNOSING, 5, number + 1, refused=number + 1,
                                   last=(group, outcome)))
        reporter.end(summary)
    said = [one for one in capsys.readouterr().err.splitlines() if one.startswith('refused')]
    assert said == [*(f'refused: {number}.csv: the file is empty' for number in range(3)),
                    f'refused: 2 more; the column reason of {tmp_path}/flights says why']


def test_lines_for_a_machine_go_into_a_folder_that_is_made(tmp_path):
    path = tmp_path / 'new' / 'lines.json'
    reporter, summary = reporter_of(path)
    with reporter:
        reporter.end(summary)
    line, = path.read_text(encoding='utf-8').splitlines()
    assert json.loads(line)['schema'] == 'quad_ident/fleet_run/1'
    assert list(path.parent.iterdir()) == [path]


def test_on_a_full_disk_the_lines_of_the_run_before_stay(tmp_path, capsys):
    path = tmp_path / 'lines.json'
    path.write_text('before')
    reporter, summary = reporter_of(path)
    with file_size_limit(64), pytest.raises(OSError, match='File too large') as raised, reporter:
        reporter.end(summary)
    assert raised.value.filename == str(path)
    assert path.read_text() == 'before' and list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize('error, kept', [(InputError('a worker cannot write'), False),
                                         (OSError(28, 'full', 'fleet/groups'), False),
                                         (KeyboardInterrupt(), True)])
def test_the_lines_of_a_run_that_fails_do_not_take_the_place_of_others(tmp_path, error, kept):
    path = tmp_path / 'lines.json'
    path.write_text('before')
    reporter, summary = reporter_of(path)
    with pytest.raises(type(error)) as raised, reporter:
        reporter.end(summary)
        raise error
    assert raised.value is error
    assert getattr(error, 'filename', None) in (None, 'fleet/groups')
    assert (path.read_text() != 'before') == kept and list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize('text, size', [('2GB', 2e9), ('500MB', 5e8), ('1.5 GiB', 1.5 * 2 ** 30)])
def test_sizes_of_memory(text, size):
    options = parser(['fleet'])[0].parse_args(['fleet', 'flights', '--memory', text])
    assert options.memory == size


@pytest.mark.parametrize('words, said', [
    (['--memory', 'much'], "expected a size from 100MB on, such as 2GB, got 'much'"),
    (['--memory', '5'], 'expected a size from 100MB on'),
    (['--workers', '0'], 'expected a whole number from 1 on'),
    (['--time-limit', '-1'], 'expected seconds above 0')])
def test_bad_options_are_refused(words, said, capsys):
    with pytest.raises(SystemExit):
        main(['fleet', 'flights', *words])
    assert said in capsys.readouterr().err


def test_bad_input_is_said_before_any_worker_is_started(tmp_path, capsys):
    (tmp_path / 'a.csv').write_text('t,px\n0,1\n', encoding='utf-8')
    for words, said in (([str(tmp_path / 'none')], 'no such file or folder'),
                        ([str(tmp_path)], 'no nominal vehicle is named'),
                        ([str(tmp_path), '--vehicle', 'humingbird'], 'did you mean')):
        assert main(['fleet', *words]) == 2
        error, = capsys.readouterr().err.splitlines()
        assert said in error


def test_options_of_local_workers_do_not_go_with_a_scheduler(capsys):
    assert main(['fleet', 'flights', '--scheduler', 'tcp://127.0.0.1:1', '--workers', '2']) == 2
    assert '--workers, --memory: they are for processes on this machine' in (
        capsys.readouterr().err)
