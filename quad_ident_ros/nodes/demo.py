# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The demo: three nodes as processes on a domain of their own, watched until they are done."""

from contextlib import suppress
from dataclasses import dataclass
import json
import os
from pathlib import Path
import signal
import time

from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Log
from std_msgs.msg import Float64MultiArray, String

from quad_ident_ros.data.recording import make_next
from quad_ident_ros.data.table import record_from_table
from quad_ident_ros.data.topics import FLIGHT_TOPICS, JOINED_TOPIC
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import load_experiment
from quad_ident_ros.identify.identify import collect, Settings
from quad_ident_ros.identify.result import from_data, Identification
from quad_ident_ros.nodes.launched import Launched
from quad_ident_ros.nodes.messages import ERROR
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.start_news import COMPILING

PATIENCE = 60.0      # s without any news after which the demo gives up

# What a motion capture system leaves: 2 mrad and 5 mm.
NOISE = {'attitude': 0.002, 'altitude': 0.005}


@dataclass(frozen=True)
class Outcome:
    """What the demo gave: the identification, folders of run and recording, seconds, counts."""

    identification: Identification
    folder: str
    recording: str
    seconds: float
    samples: int
    dropped: int


def run_demo(options, on_progress):
    """
    Fly an experiment through three processes and return the Outcome.

    Args: options with experiment, seed, real_time_factor and output; on_progress: called with a
    text and the share done. Raises InputError where a node fails; its log says more.
    """
    started = time.monotonic()
    experiment = load_experiment(options.experiment)
    folder = prepared(options.output)
    noise = {f'noise.{channel}': value for channel, value in NOISE.items()}
    nodes = {
        'recorder': {'output': str(folder.resolve())},
        'identifier': {'seed': options.seed},
        'simulator': {'experiment': os.path.abspath(options.experiment)
                      if os.path.isfile(options.experiment) else options.experiment,
                      'real_time_factor': float(options.real_time_factor),
                      'seed': options.seed, **noise}}
    watcher = Watcher(len(experiment.runs), 'identifier', 'parameters_json', on_progress)
    watch(watcher, nodes, folder.resolve() / 'log')
    pairs, _ = collect(watcher.records, Settings())
    recording = recording_of(watcher.statistics, folder)
    return Outcome(from_data(watcher.result, pairs), str(folder), str(recording),
                   time.monotonic() - started, watcher.statistics['joined'],
                   watcher.statistics['missing'])


def recording_of(account, folder):
    """
    Return the path of the recording that the account of a recorder names, in a folder.

    Raises InputError where the disk refused it.
    """
    if account['recording'] is None:
        raise InputError(account['disk_error'])
    return folder / Path(account['recording']).name


def prepared(output):
    """
    Return a new folder for one run, with one for its logs in it; raises InputError.

    It is run_1, run_2, ... of a folder in which others may run at the same time.
    """
    try:
        folder = make_next(Path(output), 'run')
        (folder / 'log').mkdir()
    except OSError as error:
        raise InputError(f'{output}: cannot be written: {error.strerror}') from None
    return folder


class Watcher:
    """
    Collects what the nodes publish and reports how far they are.

    Args: runs: how many there are; worker: the node that works on their records; topic: of what
    it publishes, JSON, at last; on_progress: see run_demo.
    """

    def __init__(self, runs, worker, topic, on_progress):
        self.records, self.statistics, self.result = [], {}, None
        self.refusal = None
        self._topics = []
        self.news = 0
        self._runs, self._worker, self._topic = runs, worker, topic
        self._loggers = ('simulator', 'recorder', worker)
        self._on_progress = on_progress

    def subscribe(self, node):
        """Listen with a node."""
        heard = [node.create_subscription(kind, topic, _without_those_of_others(take), quality)
                 for kind, topic, take, quality in (
            (String, 'run', self._on_run, latched(32)),
            (Float64MultiArray, 'record', self._on_record, latched(16)),
            (String, 'recorder/statistics', self._on_statistics, latched()),
            (String, f'{self._worker}/progress', self._on_work, 10),
            (String, self._topic, self._on_result, latched()))]
        node.create_subscription(DiagnosticArray, '/diagnostics', self._on_status, 10)
        node.create_subscription(Log, '/rosout', self._on_log, 10)
        # The recorder and the simulator hear these.
        self._topics = [one.topic_name for one in heard] + [
            node.resolve_topic_name(name) for name in (*FLIGHT_TOPICS, JOINED_TOPIC)]

    def refuse_others(self, node):
        """Raise InputError where others publish what only the nodes of this run should."""
        for topic in self._topics:
            if node.count_publishers(topic) > 1:
                raise InputError(
                    f'other nodes publish {topic}, too, on ROS domain '
                    f'{node.context.get_domain_id()}, which this run uses: their '
                    'messages cannot be distinguished from its own; start them on another '
                    'ROS_DOMAIN_ID, and start this again')

    @property
    def done(self):
        """Whether all has come."""
        return (self.result is not None and len(self.records) == self._runs
                and self.statistics.get('records') == self._runs)

    def _tell(self, text, share):
        self.news += 1
        self._on_progress(text, share)

    def _on_log(self, message):
        # A node that compiles has no other news; nodes of others, in a namespace, do not count.
        self.news += message.name in self._loggers and message.msg.startswith(COMPILING)

    def _on_run(self, message):
        info = json.loads(message.data)['info']
        self._tell(f'flying {info["run"]}', 0.1 + 0.5 * info['run_index'] / self._runs)

    def _on_record(self, message):
        self.records.append(record_from_table(message))
        self._tell(f'recorded {self.records[-1].info.get("run", "")}',
                   0.1 + 0.5 * len(self.records) / self._runs)

    def _on_statistics(self, message):
        news = json.loads(message.data)
        self.news += news != self.statistics
        self.statistics = news

    def _on_work(self, message):
        data = json.loads(message.data)
        what = f'fitting {data["method"]} {data["output"]}' if 'method' in data else 'diagnosing'
        self._tell(what, 0.6 + 0.4 * data['fraction'])

    def _on_result(self, message):
        self.result = json.loads(message.data)
        self._tell('done', 1.0)

    def _on_status(self, message):
        for status in message.status:
            # A grave result has values; without any there is no result.
            if status.name == self._worker and status.level == ERROR and not status.values:
                self.refusal = status.message


def _without_those_of_others(take):
    """Return a callback that leaves aside what no node of a run sends: refuse_others tells it."""
    def on_message(message):
        with suppress(ArithmeticError, LookupError, RecursionError, TypeError, ValueError):
            take(message)

    return on_message


def watch(watcher, nodes, logs):
    """
    Run nodes as processes until the Watcher is done.

    Args: nodes: {node: {parameter: value}}; logs: the folder of their logs. Raises InputError
    where one of them fails, or refuses what it got.
    """
    # The nodes must not outlive a demo that is asked to end or whose terminal is closed.
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, _end)
    with Launched(logs) as launched:
        for name, parameters in nodes.items():
            launched.start(name, parameters)
        with launched.watcher('demo') as (node, executor):
            watcher.subscribe(node)
            news, since = -1, time.monotonic()
            while not watcher.done:
                executor.spin_once(timeout_sec=0.1)
                launched.check()
                watcher.refuse_others(node)
                if watcher.news != news:
                    news, since = watcher.news, time.monotonic()
                elif watcher.refusal and watcher.result is None:
                    raise InputError(watcher.refusal)
                elif time.monotonic() - since > PATIENCE:
                    raise InputError(f'nothing has happened for {PATIENCE:g} s; the logs are in '
                                     f'{logs}; if one of them compiles, let `quad_ident warm-up` '
                                     'do that before')


def _end(number, _):
    raise SystemExit(128 + number)
