# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Work on Dask: everything is done once, whatever becomes of the processes that do it."""

from operator import length_hint
import os
import re
import resource
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from quad_ident_ros.cluster import cluster, Done, results, TimeOver, values, WorkerDied
from quad_ident_ros.errors import InputError
from quad_ident_ros.memory import LIBRARY

pytest.importorskip('distributed', reason="Dask is not installed: pip install '.[fleet]'")
pytestmark = [pytest.mark.slow, pytest.mark.xdist_group('dask')]

DYING = 0.2     # s from the beginning of a deadly task to its end
LIMIT = 3.0     # s of a task; the others take milliseconds, and one fills the memory of a worker
MEMORY = 400 * 2 ** 20


def square(number):
    return number * number


def trouble(number):
    """Do something else than return for some numbers."""
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    if number == 5:
        time.sleep(1e6)
    if number == 7:
        raise InputError('seven is no number here')
    if number == 11:
        held = []
        while True:
            held.append(bytearray(10 ** 7))
    return number


def die_often(item):
    """Note the time in a file, and end the process for some numbers that are neighbours."""
    path, number = item
    if 3 <= number < 5:
        with open(path, 'a') as notes:
            notes.write(f'{number} {time.time()}\n')
        time.sleep(DYING)
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def faults_of_arrays(number):
    """Return how many pages the system maps for arrays of 1 MB, one after the other."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(number):
        np.ones(2 ** 17)
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before


def hang_with_the_lock(number):
    """Hang where no other Python thread gets a turn."""
    return re.match('(a+)+$', 'a' * 60 + 'b') if number else number


@pytest.fixture(scope='module')
def client():
    with cluster(workers=2, memory=MEMORY) as client:
        yield client


def test_no_other_machine_reaches_the_processes_of_this_one(client):
    """Whoever reaches a scheduler of Dask can run code in it."""
    import psutil  # comes with Dask
    here = psutil.Process()
    open_to = {one.laddr.ip for process in (here, *here.children(recursive=True))
               for one in process.net_connections('tcp') if one.status == psutil.CONN_LISTEN}
    assert open_to == {'127.0.0.1'}


def test_every_item_is_done_once(client):
    found = sorted(done.value for done in results(client, square, range(100)))
    assert found == [number * number for number in range(100)]


def test_items_are_taken_as_they_are_needed(client):
    """So that memory does not grow with their number."""
    left = iter(range(60))
    most = 0
    for count, _ in enumerate(results(client, square, left), 1):
        most = max(most, 60 - length_hint(left) - count)
    assert count == 60 and most <= 8


@pytest.mark.skipif(not hasattr(LIBRARY, 'mallopt'), reason='the C library has no such option')
def test_workers_use_the_memory_of_freed_arrays_again(client):
    """Dask has them give all of it back, and 256 pages of 4 KB are mapped for each array then."""
    (done,) = results(client, faults_of_arrays, [200])
    assert done.value < 256 * 200 / 10


def test_what_ends_hangs_or_fills_a_worker_does_not_stop_the_rest(client):
    found = {done.item: done for done in results(client, trouble, range(20), LIMIT)}
    errors = {number: type(done.error) for number, done in found.items() if done.error}
    assert errors == {3: WorkerDied, 5: TimeOver, 7: InputError, 11: WorkerDied}
    assert str(found[7].error) == 'seven is no number here'
    assert 'may need more memory than a worker has' in str(found[3].error)
    assert all(found[number] == Done(number, number) for number in range(20)
               if number not in errors)


def test_what_ended_several_workers_is_tried_again_alone(client, tmp_path):
    """Else it would take along what waits behind it, which is counted as deadly, too."""
    path = tmp_path / 'notes'
    found = list(results(client, die_often, ((path, number) for number in range(12))))
    assert {done.item[1] for done in found if done.error} == {3, 4}
    assert sorted(done.item[1] for done in found) == list(range(12))
    begun = {number: [] for number in (3, 4)}
    for line in path.read_text().splitlines():
        begun[int(line.split()[0])].append(float(line.split()[1]))
    last = sorted(time for times in begun.values() for time in sorted(times)[-2:])
    assert len(last) == 4 and np.diff(last).min() > DYING


def test_values_come_with_their_items_and_the_first_error_is_raised(client):
    assert dict(values(client, square, range(20))) == {number: number ** 2 for number in range(20)}
    with pytest.raises(InputError, match='seven is no number here'):
        dict(values(client, trouble, [7]))


def test_what_hangs_with_the_lock_of_python_is_ended_too(client):
    found = {done.item: done for done in results(client, hang_with_the_lock, range(2), LIMIT)}
    assert found[0].value == 0
    assert isinstance(found[1].error, WorkerDied | TimeOver)


def test_a_result_whose_worker_does_not_answer_holds_up_nothing(monkeypatch):
    """The worker may have ended just after it, and the last one of all: others are started."""
    monkeypatch.setattr('quad_ident_ros.cluster.FETCH', 0.5)
    with cluster(workers=1) as client:
        [pid] = client.run(os.getpid).values()
        fetched, late = [], []

        def stopped(future):
            os.kill(pid, signal.SIGSTOP)
            threading.Timer(3.0, os.kill, (pid, signal.SIGCONT)).start()

        def tick():
            late.append(time.monotonic())

        submit = client.submit

        def stop_once_done(*args, **options):
            future = submit(*args, **options)
            if not fetched:
                fetched.append(future)
                future.add_done_callback(stopped)
            return future

        monkeypatch.setattr(client, 'submit', stop_once_done)
        assert [done.value for done in results(client, square, [3], on_tick=tick)] == [9]
    # The caller was heard of all the time, so it could have started workers.
    assert len(late) >= 3 and np.diff(late).max() < 1.5


def test_work_goes_on_where_no_worker_could_be_restarted(monkeypatch):
    """As on a machine so busy that a new process takes longer than its parent waits for it."""
    import dask
    monkeypatch.setattr('quad_ident_ros.cluster.NO_WORKERS', 2.0)
    with dask.config.set({'distributed.deploy.lost-worker-timeout': '1s'}), \
            cluster(workers=1, memory=MEMORY) as alone:
        for parent in list(alone.cluster.workers.values()):
            alone.cluster.sync(parent.close)
        assert dict(values(alone, square, range(3))) == {0: 0, 1: 1, 2: 4}


def test_a_scheduler_that_is_not_there_is_said_in_one_line():
    with pytest.raises(InputError, match=r'tcp://127\.0\.0\.1:1: no scheduler') as caught, \
            cluster('tcp://127.0.0.1:1'):
        pass
    assert '\n' not in str(caught.value)


def test_a_scheduler_that_is_lost_is_said_in_one_line():
    """It is killed while work waits; no traceback of Dask comes with it."""
    env = {**os.environ, 'PYTHONPATH': os.pathsep.join(sys.path)}
    made = subprocess.run([sys.executable, '-c', LOST], capture_output=True, text=True, env=env)
    assert (made.returncode, made.stderr) == (0, '')
    assert made.stdout.endswith('start the command again: it continues where it stopped\n')
    assert made.stdout.count('\n') == 1


LOST = """
from subprocess import PIPE, Popen
import sys
from quad_ident_ros.cluster import cluster, results
from quad_ident_ros.errors import InputError
with Popen([sys.executable, '-m', 'distributed.cli.dask_scheduler', '--host', '127.0.0.1',
            '--port', '0', '--no-dashboard'], stderr=PIPE, text=True) as scheduler:
    address = next(line.split()[-1] for line in scheduler.stderr if 'Scheduler at:' in line)
    with cluster(address) as client:
        try:
            list(results(client, abs, [1], on_tick=scheduler.kill))
        except InputError as error:
            print(error)
"""


def test_one_cluster_leaves_the_settings_of_dask_to_the_next():
    """In a process that has not imported Dask yet."""
    made = subprocess.run([sys.executable, '-c', ONE_AFTER_THE_OTHER], capture_output=True,
                          text=True)
    assert made.returncode == 0, made.stderr


ONE_AFTER_THE_OTHER = """
from contextlib import suppress
from quad_ident_ros.cluster import cluster
from quad_ident_ros.errors import InputError
for _ in range(2):
    with suppress(InputError), cluster('no address'):
        pass
"""


@pytest.mark.parametrize('address', ['10.0.0.5', 'tcp://', 'tcp://host', 'http://host:8786', '',
                                     'tcp://host:8786/status', 'scheduler.json'])
def test_what_is_no_address_of_a_scheduler_is_refused_at_once(address):
    with pytest.raises(InputError, match='expected tcp://HOST:PORT'), cluster(address):
        pass


def test_tls_without_certificates_is_refused_at_once():
    with pytest.raises(InputError, match='TLS needs certificates'), cluster('tls://host:8786'):
        pass


def test_a_cluster_without_the_package_is_refused(client, monkeypatch):
    """Its workers would end one after the other, and the run would wait for others."""
    with cluster(client.scheduler.address):
        pass
    monkeypatch.setattr('quad_ident_ros.cluster.PACKAGE', 'a_package_that_nobody_has')
    with pytest.raises(InputError, match=r'not installed for the scheduler and \d more'), \
            cluster(client.scheduler.address):
        pass
