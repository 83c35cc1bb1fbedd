# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights through the nodes as processes: what is lost, what it costs, how soon answers come."""

from dataclasses import dataclass, field
import json
import os
from pathlib import Path
import time

from geometry_msgs.msg import Vector3Stamped
import numpy as np
from rcl_interfaces.srv import GetParameters
from std_msgs.msg import Float64MultiArray, String
from std_srvs.srv import Trigger
import yaml

from quad_ident_ros.data.bag_file import read_bag_messages
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.table import record_from_table
from quad_ident_ros.data.topics import FLIGHT_TOPICS, RunNotice, stamp_ns
from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.qos import latched, STREAM

PATIENCE = 120.0     # s beyond the flight after which something is wrong
LAST_ACCOUNT = 3.0   # s after the last record in which recorders say what the middleware lost
BETWEEN_CALLS = 0.037   # s from a request to the next

AMPLITUDES = (0.5, 0.003, 0.003, 0.001)    # of U1..U4, N and N m: a tilt costs no lift
NOISE = {'noise.attitude': 0.0002, 'noise.altitude': 0.005}


def simulator(folder, period, seconds):
    """
    Return the parameters of a simulator of one flight with all four inputs at work.

    Cosines, at whose end no rate is left over: nothing but its own inputs holds the vehicle.
    """
    folder = Path(folder)
    t = period * np.arange(round(seconds / period) + 1)
    inputs = {f'u{channel}': amplitude * np.mean(
        [np.cos(2 * np.pi * frequency * (t + period / 2))
         for frequency in np.geomspace(0.3, 2.5, 6) + 0.03 * channel], axis=0)
        for channel, amplitude in enumerate(AMPLITUDES, 1)}
    write_csv(folder / 'inputs.csv', FlightRecord(t, inputs))
    (folder / 'flight.yaml').write_text(yaml.safe_dump({
        'name': 'flight', 'model': 'newton_euler', 'vehicle': 'paper_quadrotor',
        'period': period, 'trim': 'hover', 'altitude': 10.0,
        'runs': [{'name': 'flight', 'duration': seconds,
                  'inputs': {name.upper(): {'type': 'recorded', 'column': name,
                                            'file': str(folder / 'inputs.csv')}
                             for name in inputs},
                  'outputs': ['phi', 'theta', 'psi', 'z']}]}), encoding='utf-8')
    return {'experiment': str(folder / 'flight.yaml'), 'autostart': False, **NOISE}


@dataclass
class Vehicle:
    """
    What was heard of a vehicle: its run, the stamps (ns) of its records, the last account.

    began, landed: when the run and the record with its last sample were heard of, s.
    """

    run: RunNotice | None = None
    stamps: list = field(default_factory=list)
    account: dict = field(default_factory=dict)
    began: float | None = None
    landed: float | None = None

    @property
    def lacking(self):
        """Return the samples that are in no record."""
        return len(np.setdiff1d(even_stamps(self.run), np.concatenate(self.stamps)))

    @property
    def lost(self):
        """Messages that were published and not received, over all topics."""
        received = self.account['received'].values()
        return self.run.samples * len(received) - sum(received)

    @property
    def rate(self):
        """Messages per second that were received, over all topics."""
        return sum(self.account['received'].values()) / (self.landed - self.began)


def even_stamps(run):
    """Return the stamps of a run, ns (samples,)."""
    step = (run.stop_ns - run.start_ns) / (run.samples - 1)
    return run.start_ns + np.rint(step * np.arange(run.samples)).astype(np.int64)


@dataclass(frozen=True)
class Load:
    """What a flight gave: Vehicles, shares of a core by process, its first and last time, s."""

    vehicles: list
    shares: dict
    begin: float
    end: float


def fly(launched, namespaces, seconds, listen=lambda node: None):
    """
    Watch the launched nodes fly and return a Load.

    Args: namespaces of the vehicles, '' or with a slash first; seconds that a flight takes;
    listen: called with the node that watches.
    """
    vehicles = {name: Vehicle() for name in namespaces}
    with launched.watcher('bench') as (node, executor):
        for name, vehicle in vehicles.items():
            _listen(node, name, vehicle)
        listen(node)

        def spin_until(done, patience):
            last = time.monotonic() + patience
            while not done():
                executor.spin_once(timeout_sec=0.05)
                launched.check()
                if time.monotonic() > last:
                    raise InputError(f'after {patience:g} s still waiting for the flights')

        flights = vehicles.values()
        starts = [node.create_client(Trigger, f'{name}/simulator/start') for name in namespaces]
        spin_until(lambda: all(client.service_is_ready() for client in starts) and all(
            vehicle.account and node.count_publishers(f'{name}/parameters_json')
            for name, vehicle in vehicles.items()), PATIENCE)
        for client in starts:
            client.call_async(Trigger.Request())
        spin_until(lambda: all(vehicle.run for vehicle in flights), PATIENCE)
        begin, before = time.monotonic(), cpu_seconds(launched)
        spin_until(lambda: any(vehicle.landed for vehicle in flights), seconds + PATIENCE)
        end, after = time.monotonic(), cpu_seconds(launched)
        spin_until(lambda: all(vehicle.landed for vehicle in flights), PATIENCE)
        last = time.monotonic() + LAST_ACCOUNT
        spin_until(lambda: time.monotonic() > last, PATIENCE)
    shares = {name: (after[name] - before[name]) / (end - begin) for name in before}
    return Load(list(flights), shares, begin, end)


def _listen(node, name, vehicle):
    def on_run(message):
        vehicle.run, vehicle.began = RunNotice.from_json(message.data), time.monotonic()

    def on_record(message):
        record = record_from_table(message)
        vehicle.stamps.append(record.info['start_ns']
                              + np.rint(record.t * 1e9).astype(np.int64))
        if vehicle.landed is None and vehicle.stamps[-1][-1] >= vehicle.run.stop_ns:
            vehicle.landed = time.monotonic()

    def on_account(message):
        vehicle.account = json.loads(message.data)

    node.create_subscription(String, f'{name}/run', on_run, latched(32))
    node.create_subscription(Float64MultiArray, f'{name}/record', on_record, latched(16))
    node.create_subscription(String, f'{name}/recorder/statistics', on_account, latched())


def is_whole(bag, run):
    """Return whether a bag has each sample of a run on each topic once, in order."""
    stamps = {f'/{name}': [] for name in FLIGHT_TOPICS}
    for topic, _, message in read_bag_messages(bag, stamps):
        stamps[topic].append(stamp_ns(message))
    return all(np.array_equal(found, even_stamps(run)) for found in stamps.values())


class Answers:
    """How soon an identifier publishes and answers: call it with the node that watches."""

    def __init__(self):
        self._arrived, self._published, self._calls = {}, [], []
        self._asked = None

    def __call__(self, node):
        """Listen from now on, and ask for parameters again and again."""
        node.create_subscription(Vector3Stamped, 'attitude', self._on_sample, STREAM)
        node.create_subscription(String, 'parameters_json', self._on_result, latched())
        self._client = node.create_client(GetParameters, 'identifier/get_parameters')
        # Out of step with the windows, so that calls come at every moment of a fit.
        node.create_timer(BETWEEN_CALLS, self._ask)

    def delays(self):
        """Return the times from a window's newest sample to its result, s."""
        found = []
        for time_published, text in self._published:
            data = json.loads(text)
            newest = (data['records'][0]['start_ns'] * 1e-9
                      + (data['samples']['z'] - 1) * data['period']['z'])
            found.append(time_published - self._arrived[_milliseconds(newest)])
        return found

    def rate(self):
        """Return how many results came per second."""
        first, last = self._published[0][0], self._published[-1][0]
        return (len(self._published) - 1) / (last - first)

    def calls(self, begin, end):
        """Return how long the calls took that were made between two times, s."""
        return [took for asked, took in self._calls if begin <= asked <= end]

    def _on_sample(self, message):
        self._arrived[_milliseconds(stamp_ns(message) * 1e-9)] = time.monotonic()

    def _on_result(self, message):
        self._published.append((time.monotonic(), message.data))

    def _ask(self):
        if self._asked is None and self._client.service_is_ready():
            self._asked = time.monotonic()
            request = GetParameters.Request(names=['method'])
            self._client.call_async(request).add_done_callback(self._on_answer)

    def _on_answer(self, _):
        self._calls.append((self._asked, time.monotonic() - self._asked))
        self._asked = None


def _milliseconds(seconds):
    return round(1e3 * seconds)


def cpu_seconds(launched):
    """Return the CPU time of each process so far, s, with that of its threads."""
    ticks = os.sysconf('SC_CLK_TCK')
    found = {}
    for name, process in launched.processes.items():
        # Behind the name of the program, which may have blanks in it: fields 3 and on.
        fields = Path(f'/proc/{process.pid}/stat').read_text().rpartition(')')[2].split()
        found[name] = (int(fields[11]) + int(fields[12])) / ticks
    return found
