# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Every flight is in the data set once, whatever happens to the processes that make it."""

from collections import Counter
import hashlib
import json
import os
from pathlib import Path
import re
import shutil
import signal
import subprocess
import sys

import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle

pytest.importorskip('distributed', reason="Dask is not installed: pip install '.[fleet]'")
from quad_ident_ros.cluster import cluster  # noqa: E402, I100
from quad_ident_ros.fleet.store import read_table  # noqa: E402, I100

pytestmark = [pytest.mark.slow, pytest.mark.xdist_group('dask')]

ROOT = Path(__file__).resolve().parents[3]
FLIGHTS, LONGEST = 4, 400.0     # s for a run, on a machine that does something else, too


@pytest.fixture(scope='module')
def folder(tmp_path_factory):
    """Give a folder with a flight of each of some vehicles."""
    top = tmp_path_factory.mktemp('flights')
    vehicle = load_vehicle('hummingbird')
    for number in range(FLIGHTS):
        effects = {'thrust_scale': {'factor': 1.0 - 0.02 * number}} if number else {}
        write_csv(top / f'vehicle_{number}' / '2026-05-14' / 'flight.csv', fly_closed_loop(
            vehicle, effects, 'lissajous', duration=6.0, seed=number,
            noise=SENSORS['mocap_imu']))
    return top


@pytest.fixture(scope='module')
def idle():
    """Give the address of a scheduler whose workers no test ends: each start takes seconds."""
    with cluster(workers=2) as client:
        yield client.scheduler.address


class Runs:
    """Processes that a test starts; those that are left at the end are killed."""

    def __init__(self, folder, out):
        self.folder, self.out = folder, out
        self._all = []

    def start(self, *arguments, **options):
        """Start Python with arguments; give the process."""
        env = {**os.environ, 'PYTHONPATH': os.pathsep.join([str(ROOT), *sys.path])}
        process = subprocess.Popen([sys.executable, *arguments], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True, env=env, **options)
        self._all.append(process)
        return process

    def fleet(self, *arguments, **options):
        """Start `quad_ident fleet` on the flights."""
        return self.start('-m', 'quad_ident_ros', 'fleet', str(self.folder), '--vehicle',
                          'hummingbird', '-o', str(self.out), '--json', '-', *arguments, **options)

    def again(self, scheduler, capsys):
        """Run `quad_ident fleet` in this process; return what `ended` does."""
        capsys.readouterr()
        code = main(['fleet', str(self.folder), '--vehicle', 'hummingbird', '-o', str(self.out),
                     '--json', '-', '--scheduler', scheduler])
        said, errors = capsys.readouterr()
        return code, json.loads(said.splitlines()[-1]) if said else None, errors

    def close(self):
        """Kill the processes that remain."""
        for process in self._all:
            process.kill()
            process.communicate()


@pytest.fixture
def runs(folder, tmp_path):
    runs = Runs(folder, tmp_path / 'fleet')
    yield runs
    runs.close()


def lines_of(process):
    """Yield what a run prints, as data."""
    for line in process.stdout:
        yield json.loads(line)


def ended(process):
    """Return (exit code, last line as data, what was said) of a run."""
    said, errors = process.communicate(timeout=LONGEST)
    return process.returncode, json.loads(said.splitlines()[-1]) if said else None, errors


def check_complete(folder, out):
    """Check that each flight occurs once, diagnosed, with its values."""
    contents = {hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.rglob('*.csv')}
    assert len(contents) == FLIGHTS
    for table in ('flights', 'covariances'):
        assert Counter(read_table(out, table)['flight'].to_pylist()) == Counter(contents)
    groups = read_table(out, 'groups').to_pylist()
    assert len({group['group'] for group in groups}) == len(groups) == FLIGHTS
    assert {group['status'] for group in groups} == {'diagnosed'}
    verdicts = {group['vehicle']: group['verdict'] for group in groups}
    assert verdicts['vehicle_0'] == ['none']
    assert verdicts[f'vehicle_{FLIGHTS - 1}'] == ['thrust_scale']
    assert not list((Path(out) / '.unfinished').iterdir())


def test_a_worker_and_the_client_are_killed_and_no_flight_is_lost(runs, folder, tmp_path,
                                                                  capsys):
    where = tmp_path / 'scheduler.json'
    runs.start('-m', 'distributed.cli.dask_scheduler', '--port', '0', '--no-dashboard',
               '--scheduler-file', str(where))
    workers = [runs.start('-m', 'distributed.cli.dask_worker', '--scheduler-file', str(where),
                          '--nthreads', '1', '--no-nanny', '--no-dashboard') for _ in range(2)]
    first = runs.start('-c', SCHEDULER_OF, str(where))
    address = first.communicate(timeout=LONGEST)[0].strip()
    assert address.startswith('tcp://')
    run = runs.fleet('--scheduler', address)
    next(lines_of(run))
    workers[0].send_signal(signal.SIGKILL)
    next(lines_of(run))
    run.send_signal(signal.SIGKILL)
    run.communicate()
    code, whole, errors = runs.again(address, capsys)
    assert code == 0, errors
    assert whole['groups']['diagnosed'] == FLIGHTS and whole['before'] >= 2
    check_complete(folder, runs.out)


SCHEDULER_OF = """
import distributed, sys, time
while True:
    try:
        with distributed.Client(scheduler_file=sys.argv[1], timeout=5) as client:
            client.wait_for_workers(2)
            print(client.scheduler.address)
            break
    except (OSError, ValueError):
        time.sleep(0.2)     # it is not written yet
"""


def test_two_runs_at_once_do_every_flight_once(runs, folder):
    one, other = (runs.fleet('--workers', '1') for _ in range(2))
    for code, whole, errors in map(ended, (one, other)):
        assert code == 0, errors
        assert whole['groups']['diagnosed'] == FLIGHTS
    check_complete(folder, runs.out)


def test_ctrl_c_ends_a_run_in_one_line(runs):
    # What is started in the background of a shell without a terminal ignores SIGINT.
    run = runs.fleet('--workers', '2', start_new_session=True,
                     preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
    next(lines_of(run))
    os.killpg(run.pid, signal.SIGINT)   # a terminal sends it to all processes
    _, errors = run.communicate(timeout=LONGEST)
    assert run.returncode == 130 and errors.splitlines()[-1] == 'quad_ident fleet: interrupted'
    assert 'Traceback' not in errors


def test_a_full_disk_is_said_in_one_line_and_the_run_goes_on_later(runs, folder, idle,
                                                                   capsys):
    full = runs.start('-c', LIMITED, str(folder), str(runs.out))
    code, _, errors = ended(full)
    assert code == 2 and 'Traceback' not in errors
    assert 'flights' in errors.splitlines()[-1] and 'File too large' in errors.splitlines()[-1]
    code, whole, errors = runs.again(idle, capsys)
    assert code == 0, errors
    check_complete(folder, runs.out)


LIMITED = """
import os, resource, sys
# Python 3.11 keeps bytecode that is cut short; workers ask the environment.
os.environ['PYTHONDONTWRITEBYTECODE'], sys.dont_write_bytecode = '1', True
resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))
if __name__ == '__main__':
    from quad_ident_ros.cli.main import main
    sys.exit(main(['fleet', sys.argv[1], '--vehicle', 'hummingbird', '-o', sys.argv[2],
                   '--workers', '1']))
"""


def test_a_disk_that_fills_up_in_the_middle_is_said_and_the_run_goes_on_later(runs, folder,
                                                                              tmp_path):
    """On a disk of its own, in memory, that only root may mount; later it has more room."""
    if not shutil.which('unshare') or subprocess.run(
            ['unshare', '-m', 'true'], capture_output=True, check=False).returncode:
        pytest.skip('only root may mount a disk')
    disk, first, second = (tmp_path / name for name in ('disk', 'first', 'second'))
    disk.mkdir()
    runs.out = disk / 'fleet'
    kept = tmp_path / 'kept'
    words = [sys.executable, '-m', 'quad_ident_ros', 'fleet', str(folder), '--vehicle',
             'hummingbird', '-o', str(runs.out), '--workers', '1']
    env = {**os.environ, 'PYTHONPATH': os.pathsep.join([str(ROOT), *sys.path])}
    done = subprocess.run(['unshare', '-m', 'sh', '-c', DISK, 'sh', disk, kept, first, second,
                           *words], capture_output=True, text=True, env=env, check=False,
                          timeout=2 * LONGEST)
    assert done.returncode == 0, done.stderr + second.read_text()
    code, *said = first.read_text().splitlines()
    assert code == '2' and 'Traceback' not in first.read_text()
    assert said[-1].endswith('No space left on device')
    check_complete(folder, kept)
    assert re.search(rf'\(([1-{FLIGHTS}]) of them before\)', second.read_text())


DISK = """
disk=$1 kept=$2 first=$3 second=$4
shift 4
mount -t tmpfs -o size=120k none "$disk" || exit 98
"$@" 2> "$first.errors"
{ echo $?; cat "$first.errors"; } > "$first"
mount -o remount,size=64m "$disk" || exit 98
"$@" > "$second" 2>&1 && cp -r "$disk/fleet" "$kept"
"""


def test_what_takes_too_long_is_recorded_and_tried_again(runs, tmp_path, idle, capsys):
    # What is done within the grace of a few seconds counts as done: eight minutes take longer.
    runs.folder = tmp_path / 'long'
    for seed in range(4):
        write_csv(runs.folder / 'vehicle_0' / '2026-05-14' / f'flight_{seed}.csv', fly_closed_loop(
            load_vehicle('hummingbird'), {}, 'lissajous', duration=120.0, seed=seed,
            noise=SENSORS['mocap_imu']))
    code, whole, errors = ended(runs.fleet('--workers', '1', '--time-limit', '0.5'))
    assert code == 3, errors
    assert whole['groups']['timeout'] == 1
    reasons = read_table(runs.out, 'groups', ['reason'])['reason'].to_pylist()
    assert reasons == ['it took more than 0.5 s (--time-limit)']
    code, whole, errors = runs.again(idle, capsys)
    assert code == 0, errors
    assert read_table(runs.out, 'groups', ['status'])['status'].to_pylist() == ['diagnosed']


def test_what_is_done_is_not_done_again_and_new_flights_are(runs, folder, tmp_path, idle, capsys):
    some = [str(path) for path in sorted(folder.rglob('*.csv'))]
    manifest = tmp_path / 'manifest.csv'

    def run(paths):
        manifest.write_text('path,vehicle,temperature_c\n' + ''.join(
            f'{path},{Path(path).parts[-3]},{20 + number}\n'
            for number, path in enumerate(paths)), encoding='utf-8')
        runs.folder = manifest
        code, whole, errors = runs.again(idle, capsys)
        assert code == 0, errors
        return whole

    assert run(some[:1])['before'] == 0
    assert run(some[:2])['before'] == 1
    assert run(some[:2])['before'] == 2
    rows = read_table(runs.out, 'flights').to_pylist()
    assert sorted(dict(row['covariates'])['temperature_c'] for row in rows) == [20.0, 21.0]
    assert {row['date'].isoformat()[:10] for row in rows} == {'2026-05-14'}
