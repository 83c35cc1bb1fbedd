# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Work on many processes, by Dask: those of this machine, or an existing cluster."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, ExitStack, suppress
from dataclasses import dataclass
import faulthandler
from importlib.util import find_spec
from itertools import count, islice, repeat
import logging
from multiprocessing import resource_tracker
import os
import queue
import re
import signal
import threading
from time import monotonic
from typing import Any, Generic, TypeVar
import uuid

from quad_ident_ros.errors import InputError
from quad_ident_ros.memory import hand_back_large
from quad_ident_ros.resources import PACKAGE
from quad_ident_ros.schema import shown

Item = TypeVar('Item')
_Key = tuple[str, int]      # of a task

IN_FLIGHT = 2       # tasks of each worker: one is worked on while the next is on its way
AT_LEAST = 8        # tasks in flight where there are few workers, or none yet: more may join
MEMORY = 0.8        # share of the machine's memory that all local workers together may have
TICK = 0.25         # s, after which a caller hears again that the work goes on
GRACE = 3.0         # s from the end of a task's time to that of its process
NO_WORKERS = 20.0   # s without any worker, after which those of this machine are started anew:
                    # Dask itself gives one up that could not be restarted on a busy machine
FETCH = 5.0         # s for a result to come: its worker may have ended just after it was done
REMEMBERED = 20     # messages, with the work in them, that each connection keeps for developers
LOGGERS = 'distributed', 'distributed.client', 'distributed.gc', 'tornado.application'
"""Those of Dask that have a level of their own."""
TIMES = 'quad_ident_times'
"""The topic on which a worker says that the time of a task is over."""
_ADDRESS = re.compile(r'((tcp|tls|ws|wss|ucx)://)?(\[[\da-f:.]+\]|[^/:\s]+):\d+', re.IGNORECASE)


class TimeOver(Exception):
    """A task took more than its time."""


class WorkerDied(InputError):
    """Each worker process that began a task ended, for example because memory ran out."""

    def __init__(self) -> None:
        super().__init__('each worker process that began a certain part of the work ended: that '
                         'part may need more memory than a worker has')


@dataclass(frozen=True)
class Done(Generic[Item]):
    """What came of an item: the value of the function, or the error that ended it."""

    item: Item
    value: Any = None
    error: Exception | None = None


def is_installed() -> bool:
    """Return whether Dask is installed."""
    return find_spec('distributed') is not None


@contextmanager
def cluster(scheduler: str | None = None, workers: int | None = None,
            memory: int | None = None) -> Iterator[Any]:
    """
    Give a dask.distributed.Client of workers on this machine, or of a scheduler.

    Args: scheduler: address, tcp://HOST:PORT, of an existing cluster; else workers: how many
    processes (default: one for each core); memory: bytes of each (default: MEMORY of the
    machine's, shared). A process that takes more is ended and restarted.
    Raises InputError where Dask is not installed or the scheduler does not answer.
    """
    if not is_installed():
        raise InputError("Dask is not installed: pip install 'quad_ident_ros[fleet]'")
    import dask
    import distributed  # noqa: F401  first: what is set before it would take its defaults along
    for name in LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL)      # we say what matters
    with dask.config.set({'distributed.admin.low-level-log-length': REMEMBERED}):
        yield from _there(scheduler) if scheduler is not None else _here(workers, memory)


def _there(scheduler: str) -> Iterator[Any]:
    """Yield a Client of a running scheduler."""
    import distributed
    _check_address(scheduler, distributed.Security())
    try:
        client = distributed.Client(scheduler, timeout='10s', set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(f'--scheduler {scheduler}: no scheduler of Dask answers there '
                         f'({_first_line(error)}); `dask scheduler` prints its address'
                         ) from None
    with client:
        if max(client.ncores().values(), default=1) > 1:
            raise InputError(f'--scheduler {scheduler}: its workers have several threads; '
                             'start them with --nthreads 1, because what hangs is ended with '
                             'its process')
        _check_packages(client, scheduler)
        yield client


def _here(workers: int | None, memory: int | None) -> Iterator[Any]:
    """Yield a Client of processes of this machine."""
    import dask.system
    import distributed
    number = workers or dask.system.CPU_COUNT
    limit = memory or int(MEMORY * distributed.system.MEMORY_LIMIT / number)
    # A second worker is tried where one died: what is out of memory there is so everywhere.
    with dask.config.set({'distributed.scheduler.allowed-failures': 1,
                          'distributed.worker.profile.enabled': False,
                          # Nothing leaves this machine.
                          'distributed.admin.large-graph-warning-threshold': '1 GB',
                          }), ExitStack() as stack:
        with _without_interrupt():
            local = stack.enter_context(distributed.LocalCluster(
                n_workers=number, threads_per_worker=1, memory_limit=limit, host='127.0.0.1',
                dashboard_address='127.0.0.1:0', silence_logs=logging.CRITICAL))
            client = stack.enter_context(distributed.Client(local, set_as_default=False))
        yield client


def _check_address(scheduler: str, security: Any) -> None:
    """Raise InputError for what a Client takes for no address: when closed, it would hang."""
    if not _ADDRESS.fullmatch(scheduler):
        raise InputError(f'--scheduler {shown(scheduler)}: expected tcp://HOST:PORT, as '
                         '`dask scheduler` prints it')
    if (scheduler.lower().startswith('tls:')
            and security.get_connection_args('client').get('ssl_context') is None):
        raise InputError(f'--scheduler {scheduler}: TLS needs certificates; name them in the '
                         'configuration of Dask (distributed.comm.tls), or use tcp://')


def _check_packages(client: Any, scheduler: str) -> None:
    """Raise InputError where the scheduler or a worker has no such package: it would end."""
    known = {'the scheduler': client.run_on_scheduler(find_spec, PACKAGE),
             **client.run(find_spec, PACKAGE)}
    lacking = [name for name, spec in known.items() if spec is None]
    if lacking:
        raise InputError(f'--scheduler {scheduler}: {PACKAGE} is not installed for {lacking[0]}'
                         + (f' and {len(lacking) - 1} more' if len(lacking) > 1 else '')
                         + '; install the same version where scheduler and workers are started')


@contextmanager
def _without_interrupt() -> Iterator[None]:
    """
    Keep Ctrl-C from threads that are started meanwhile, and so from processes that these start.

    It reaches all processes in a terminal: workers are ended by the command, without tracebacks.
    """
    resource_tracker.ensure_running()   # it lets them through again in the thread that starts it
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def results(client: Any, function: Callable[[Item], Any], items: Iterable[Item],
            time_limit: float | None = None,
            on_tick: Callable[[], None] = lambda: None) -> Iterator[Done[Item]]:
    """
    Yield what a function makes of each item, in the order in which they are done.

    No more than a few items are in flight for each worker, so that memory does not grow with
    their number. A worker that dies takes none with it: its items are done elsewhere, and those
    that ended several workers are tried once more when nothing else is in flight. Args:
    time_limit: s of an item, after which its process is ended, and its error is a TimeOver;
    on_tick is called a few times per second. Raises InputError where the scheduler is lost.
    """
    suspects: list[Item] = []
    for done in _results(client, function, items, time_limit, on_tick):
        if isinstance(done.error, WorkerDied):
            suspects.append(done.item)
        else:
            yield done
    yield from _results(client, function, suspects, time_limit, on_tick, alone=True)


def values(client: Any, function: Callable[[Item], Any], items: Iterable[Item]
           ) -> Iterator[tuple[Item, Any]]:
    """
    Yield each item with what a function makes of it, in the order in which they are done.

    Raises the first error.
    """
    for done in results(client, function, items):
        if done.error is not None:
            raise done.error
        yield done.item, done.value


def _results(client: Any, function: Callable[[Item], Any], items: Iterable[Item],
             time_limit: float | None, on_tick: Callable[[], None], alone: bool = False
             ) -> Iterator[Done[Item]]:
    news: queue.SimpleQueue = queue.SimpleQueue()
    flying: dict[_Key, tuple[Item, Any]] = {}
    waiting = iter(items)
    topic = f'{TIMES}-{id(flying)}-{client.id}'
    # One group of tasks, whatever their number: the scheduler never forgets a group.
    keys = zip(repeat(f'work-{uuid.uuid4().hex}'), count())
    client.subscribe_topic(topic, lambda event: news.put((event[1], True)))
    more, most, looked, seen = True, 1, -float('inf'), monotonic()
    try:
        while more or flying:
            if monotonic() - looked > TICK:
                looked, workers = monotonic(), len(client.ncores())
                seen = looked if workers else seen
                if looked - seen > NO_WORKERS and client.cluster is not None:
                    client.cluster.scale(len(client.cluster.worker_spec))
                    seen = looked
                most = 1 if alone else max(AT_LEAST, IN_FLIGHT * workers)
                on_tick()
            for item in islice(waiting, max(0, most - len(flying))):
                future = client.submit(_limited, function, item, time_limit, topic, key=next(keys),
                                       pure=False)
                flying[future.key] = item, future
                future.add_done_callback(lambda one: news.put((one.key, False)))
            more = more and len(flying) >= most
            ended = {key: late for key, late in _all_of(news) if key in flying}
            done = _done({key: (*flying[key], late) for key, late in ended.items()})
            for key in ended.keys() - done.keys():      # it is being done again, elsewhere
                flying[key][1].add_done_callback(lambda one: news.put((one.key, False)))
            for key in done:
                del flying[key]
            yield from done.values()
            if client.status == 'closed':
                raise InputError('the connection to the scheduler was lost; start the command '
                                 'again: it continues where it stopped')
    finally:
        client.unsubscribe_topic(topic)
        for _, future in flying.values():
            future.cancel()


def _all_of(news: queue.SimpleQueue) -> Iterator[Any]:
    """Yield what is in a queue, once there is something, or nothing after a TICK."""
    with suppress(queue.Empty):
        yield news.get(timeout=TICK)
        while True:
            yield news.get_nowait()


def _done(ended: dict[_Key, tuple[Item, Any, bool]]) -> dict[_Key, Done[Item]]:
    """
    Return {key: Done} of {key: (item, future, whether it was late)}.

    What is lost with a worker that ended just after it is not done: Dask does it again, once there
    is a worker, which the caller has to see to meanwhile.
    """
    from distributed.scheduler import KilledWorker
    found: dict[_Key, Done[Item]] = {}
    for key, (item, future, late) in ended.items():
        if not late and future.status == 'finished':
            try:
                found[key] = Done(item, future.result(timeout=FETCH))
            except Exception:       # it is lost, or its worker does not answer
                break               # the others remain for the next time
    for key, (item, future, late) in ended.items():
        if late:
            future.cancel()
            found[key] = Done(item, error=TimeOver())
        elif future.status == 'error':
            error = future.exception()
            found[key] = Done(item, error=WorkerDied() if isinstance(error, KilledWorker)
                              else error)
        elif future.status == 'cancelled':
            raise InputError('the scheduler has lost the work; start the command again: it '
                             'continues where it stopped')
    return found


def _limited(function: Callable[[Item], Any], item: Item, seconds: float | None, topic: str
             ) -> Any:
    """
    Return function(item), in a worker; its process is ended where that takes longer.

    Nothing else ends what hangs in a library. Where it holds Python's lock, the C library does.
    """
    hand_back_large()
    if seconds is None:
        return function(item)
    from distributed import get_worker
    worker = get_worker()
    key = worker.get_current_task()

    def expire() -> None:
        worker.log_event(topic, key)
        over.wait(GRACE)        # for the message to be on its way
        if not over.is_set():
            os._exit(1)

    over = threading.Event()
    timer = threading.Timer(seconds, expire)
    timer.daemon = True
    timer.start()
    with open(os.devnull, 'w') as nowhere:
        faulthandler.dump_traceback_later(seconds + 2.0 * GRACE, exit=True, file=nowhere)
        try:
            return function(item)
        finally:
            faulthandler.cancel_dump_traceback_later()
            over.set()
            timer.cancel()


def _first_line(error: BaseException) -> str:
    return str(error).strip().partition('\n')[0] or type(error).__name__
