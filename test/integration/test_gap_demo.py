# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The demo of the gap: the hidden effect is named, and the truth printed last."""

from concurrent.futures import ThreadPoolExecutor
import json
from pathlib import Path
import re
import subprocess
import sys

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
import pytest
from rcl_interfaces.msg import Log
from std_msgs.msg import Float64MultiArray, String

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.replay import read_bag
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.nodes.demo import prepared, Watcher
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.recorder import Recorder

SEED = '4'      # a drag of the rotors
ROOT = Path(__file__).parents[2]


def run(*words):
    return subprocess.run([sys.executable, '-m', 'quad_ident_ros', 'demo', '--gap', *words],
                          capture_output=True, text=True, timeout=180)


@pytest.fixture(scope='module')
def demo(tmp_path_factory):
    """Return the folder of a finished demo, what it printed, and the data that it wrote."""
    folder = tmp_path_factory.mktemp('gap')
    done = run('--seed', SEED, '-o', str(folder), '--json', str(folder / 'out.json'))
    assert done.returncode == 0, done.stderr
    return folder / 'run_1', done.stdout, json.loads((folder / 'out.json').read_text())


def test_the_hidden_effect_is_named_and_the_truth_printed_last(demo):
    folder, said, data = demo
    truth = load_vehicle(folder / 'reality.yaml').effects
    assert data['effects'] == truth and data['found']
    assert data['diagnosis']['verdict'] == list(truth)
    assert [row['effect'] for row in data['diagnosis']['ranking']
            if row['probability'] > 0.5] == list(truth)
    assert data['closed'] == data['diagnosis']['gap']['closed'] > 0.9
    verdict, truth_at = said.index('verdict: '), said.index('truth: ')
    assert verdict < truth_at < said.index('to repeat: --seed')
    assert f'({list(truth)[0]}), ' in said[truth_at:]
    assert f'flight_*.csv --vehicle {folder / "nominal.yaml"} --report' in said


@pytest.mark.parametrize('page', ['README.md', 'docs/diagnosis.md'])
def test_a_page_prints_what_it_prints(demo, page):
    """The names of flights differ between a demo and files, and columns with the terminal."""
    def parts(text):
        verdict = re.search(r'^verdict: .*$', text, re.M)[0]
        row = re.search(rf'^ {name} .*$', text, re.M)[0]
        rest = re.search(r'^probability of effects not in the table: .*$', text, re.M)[0]
        return verdict, re.split(r' {2,}', row.strip())[:4], rest.strip()

    _, said, data = demo
    name = list(data['effects'])[0]
    assert parts((ROOT / page).read_text(encoding='utf-8')) == parts(said)


def test_the_diagnosing_process_was_not_told(demo):
    folder, _, data = demo
    assert load_vehicle(folder / 'nominal.yaml').effects == {}
    name = list(data['effects'])[0]
    records = read_bag(folder / 'recording_1' / 'bag')
    assert len(records) == 4
    for record in records:      # all that came over ROS
        assert name not in json.dumps(record.info)
    for log in ('simulator', 'recorder'):
        assert name not in (folder / 'log' / f'{log}.txt').read_text()


def test_everything_of_a_run_is_in_a_folder_that_no_other_run_has(demo, tmp_path):
    """Two at a time shared the file of the reality: one printed the truth of the other."""
    folder, _, _ = demo
    assert sorted(path.name for path in folder.parent.iterdir()) == ['out.json', 'run_1']
    assert {'log', 'nominal.yaml', 'reality.yaml', 'recording_1'} <= {
        path.name for path in folder.iterdir()}
    with ThreadPoolExecutor(8) as pool:
        folders = list(pool.map(lambda _: prepared(tmp_path), range(40)))
    assert len(set(folders)) == 40 and all((one / 'log').is_dir() for one in folders)


@pytest.mark.parametrize('words, said', [
    (['--experiment', 'hover_single_axis'], '--gap needs flights in closed loop'),
    (['--seed', '-1'], 'must not be negative')])
def test_what_cannot_be_is_refused_in_one_line(tmp_path, capsys, words, said):
    assert main(['demo', '--gap', *words, '-o', str(tmp_path)]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert line.startswith('quad_ident demo: error: ') and said in line
    assert not list(tmp_path.iterdir())


def test_what_the_diagnoser_refuses_is_what_the_demo_ends_with():
    """The flights of a demo are long enough: its watcher hears of a refusal."""
    watcher = Watcher(1, 'diagnoser', 'diagnosis', lambda text, share: None)
    for name, values in (('recorder', []), ('diagnoser', [KeyValue(key='closed', value='0')])):
        watcher._on_status(DiagnosticArray(status=[DiagnosticStatus(
            name=name, level=DiagnosticStatus.ERROR, message='unknown', values=values)]))
        assert watcher.refusal is None
    watcher._on_status(DiagnosticArray(status=[DiagnosticStatus(
        name='diagnoser', level=DiagnosticStatus.ERROR, message='3 s are too short')]))
    assert watcher.refusal == '3 s are too short' and not watcher.done


def test_what_no_node_of_a_run_sends_does_not_end_it(graph):
    """It hears of others a moment later, by their publishers, and says so."""
    watcher = Watcher(1, 'diagnoser', 'diagnosis', lambda text, share: None)
    watcher.subscribe(graph.probe)
    other = graph.start(Recorder)      # the second publisher
    for topic in ('run', 'recorder/statistics', 'diagnoser/progress', 'diagnosis'):
        publisher = graph.advertise(String, topic, latched(32))
        for text in ('no JSON', '{}', '[' * 100_000, 'null', '{"info": {}}'):
            publisher.publish(String(data=text))
    graph.advertise(Float64MultiArray, 'record', latched(16)).publish(Float64MultiArray())
    graph.spin_for(0.5)
    assert not watcher.records and not watcher.done and other.counts.joined == 0
    with pytest.raises(InputError, match='other nodes publish /'):
        watcher.refuse_others(graph.probe)


def test_what_others_compile_is_no_news_of_a_run():
    """Each line of a node in a namespace would reset its patience."""
    watcher = Watcher(1, 'diagnoser', 'diagnosis', lambda text, share: None)
    counts = []
    for name in ('uav1.diagnoser', 'identifier', 'simulator', 'diagnoser'):
        watcher._on_log(Log(name=name, msg='compiling: 3 of at most 90 functions, 12 s'))
        counts.append(watcher.news)
    assert counts == [0, 0, 1, 2]
