# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Helpers of the integration tests: a graph in this process, nodes as processes, flights."""

import gc
import json
import os
from pathlib import Path
import signal
import subprocess
import sys
import threading
import time

from geometry_msgs.msg import (
    PointStamped,
    PoseStamped,
    TwistStamped,
    Vector3Stamped,
    WrenchStamped,
)
import numpy as np
import pytest
from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import SetParameters
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Float64MultiArray, String
from std_srvs.srv import Trigger
import yaml

import quad_ident_ros
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.table import record_from_table
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.nodes.process import PARENT
from quad_ident_ros.nodes.qos import latched, LOSSLESS

DEADLINE = 60.0   # s that anything may take before a test fails: others may load the machine
ASK_AGAIN = 4.0   # s without an answer of a service after which it is asked again

STREAMS = {'attitude': Vector3Stamped, 'altitude': PointStamped, 'pose': PoseStamped,
           'twist': TwistStamped, 'input': WrenchStamped}

# An identifier with a budget that no test waits for.
ENDLESS = {'method': 'pso', 'evaluations': 100_000_000}


class Heard(list):
    """The messages of a topic, as they came; `times` are those of receipt, steady, s."""

    def __init__(self):
        super().__init__()
        self.times = []
        self.subscription = None

    def take(self, message):
        self.times.append(time.monotonic())
        self.append(message)

    def data(self):
        """Return what the messages say as JSON."""
        return [json.loads(message.data) for message in self]

    def records(self):
        return [record_from_table(message) for message in self]


class Graph:
    """A context of its own with nodes on one executor, all in this thread."""

    def __init__(self, domain, executor_class=SingleThreadedExecutor):
        self._threads = set(threading.enumerate())
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=domain,
                   signal_handler_options=SignalHandlerOptions.NO)
        self.executor = executor_class(context=self.context)
        self.nodes = []
        self.probe = self._add(rclpy.create_node('probe', context=self.context))

    def start(self, node_class, parameters=None, *, arguments=(), namespace=None):
        """Make one of our nodes and let it take part."""
        overrides = [Parameter(name, value=value) for name, value in (parameters or {}).items()]
        return self._add(node_class(
            context=self.context, parameter_overrides=overrides, namespace=namespace,
            cli_args=['--ros-args', *arguments] if arguments else None))

    def _add(self, node):
        self.nodes.append(node)
        self.executor.add_node(node)
        return node

    def stop(self, node):
        """End a node as a process would."""
        self.nodes.remove(node)
        if node is not self.probe:
            node.close()
        self.executor.remove_node(node)
        node.destroy_node()

    def close(self):
        for node in list(self.nodes):
            self.stop(node)
        self.executor.shutdown()
        self.context.try_shutdown()
        gc.collect()   # nodes that refused to start
        left = [thread.name for thread in threading.enumerate()
                if thread not in self._threads and thread.is_alive()]
        assert not left, f'threads are left: {left}'

    def spin_until(self, predicate, what='', deadline=DEADLINE):
        """Spin until the predicate holds and return its value; fail after the deadline."""
        value = self.comes_true(predicate, deadline)
        if not value:
            pytest.fail(f'after {deadline:g} s still waiting for {what or predicate}')
        return value

    def comes_true(self, predicate, deadline):
        """Spin until the predicate holds or the deadline is over; return its value."""
        end = time.monotonic() + deadline
        while not (value := predicate()) and time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.05)
        return value

    def spin_for(self, seconds):
        """Spin for a time, to see that something does not happen."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.02)

    def listen(self, kind, topic, quality=LOSSLESS):
        """Subscribe and return the list that the messages come into."""
        heard = Heard()
        heard.subscription = self.probe.create_subscription(kind, topic, heard.take, quality)
        return heard

    def advertise(self, kind, topic, quality=LOSSLESS, listeners=1):
        """Return a publisher that the subscribers have found, and that they have found."""
        publisher = self.probe.create_publisher(kind, topic, quality)
        self.await_listeners(publisher, listeners)
        return publisher

    def await_listeners(self, publisher, listeners=1):
        def matched():
            here = [subscription for node in self.nodes for subscription in node.subscriptions
                    if subscription.topic_name == publisher.topic_name]
            return (publisher.get_subscription_count() >= listeners
                    and all(subscription.get_publisher_count() for subscription in here))

        self.spin_until(matched, f'{listeners} subscribers of {publisher.topic_name}')

    def call(self, kind, name, request=None, deadline=DEADLINE):
        """Call a service and return its response."""
        client = self.probe.create_client(kind, name)
        self.spin_until(client.service_is_ready, f'service {name}', deadline)
        return self.answer(client, request or kind.Request(), deadline)

    def answer(self, client, request, deadline=DEADLINE):
        """
        Ask a service that is ready, again where no answer comes, and return its response.

        FastDDS drops the answer to a client that the server has not discovered within 0.1 s,
        which happens on a busy machine: ready is what the client knows of the server.
        """
        asked = [client.call_async(request)]
        patience = time.monotonic() + ASK_AGAIN

        def answered():
            nonlocal patience
            if time.monotonic() > patience:
                asked.append(client.call_async(request))
                patience = time.monotonic() + ASK_AGAIN
            return any(future.done() for future in asked)

        self.spin_until(answered, f'an answer of {client.srv_name}', deadline)
        return next(future for future in asked if future.done()).result()

    def trigger(self, name):
        return self.call(Trigger, name)

    def set_parameter(self, node, name, value):
        """Set a parameter as `ros2 param set` does and return the result."""
        parameter = Parameter(name, value=value).to_parameter_msg()
        assert parameter.value.type != ParameterType.PARAMETER_NOT_SET
        request = SetParameters.Request(parameters=[parameter])
        return self.call(SetParameters, f'{node}/set_parameters', request).results[0]

    def results(self, namespace=''):
        """Return the lists of `parameters_json`, `parameters` and `record`."""
        return (self.listen(String, f'{namespace}parameters_json', latched()),
                self.listen(Float64MultiArray, f'{namespace}parameters', latched()),
                self.listen(Float64MultiArray, f'{namespace}record', latched(16)))


class Process:
    """A node as a process of its own, with its output in two files."""

    def __init__(self, node, words, environment, folder, holder, shell=''):
        self.node = node
        self.log = folder / f'{node}.err'
        self.printed = folder / f'{node}.out'
        command = [sys.executable, '-m', f'quad_ident_ros.nodes.{node}', *words]
        if shell:
            command = ['bash', '-c', f'{shell}; exec "$@"', 'bash', *command]
        with open(self.log, 'wb') as errors, open(self.printed, 'wb') as output:
            self._popen = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output,
                                           stderr=errors, env=environment,
                                           start_new_session=True,
                                           pass_fds=[holder.fileno()])

    @property
    def pid(self):
        return self._popen.pid

    def errors(self):
        return self.log.read_text('utf-8', 'replace')

    def output(self):
        return self.printed.read_text('utf-8', 'replace')

    def running(self):
        return self._popen.poll() is None

    def wait(self, seconds=DEADLINE):
        """Return the exit code; fail where the process does not end."""
        try:
            return self._popen.wait(seconds)
        except subprocess.TimeoutExpired:
            self.kill()
            pytest.fail(f'{self.node} did not end within {seconds:g} s:\n{self.errors()}')

    def send(self, number):
        self._popen.send_signal(number)

    def stop(self):
        """Interrupt the node as Ctrl-C does and return its exit code."""
        self.send(signal.SIGINT)
        return self.wait()

    def kill(self):
        self._popen.kill()
        self._popen.wait()


class Processes:
    """Nodes as processes on the tests' domain, which stays claimed as long as one of them runs."""

    def __init__(self, domain, holder, folder):
        self._holder, self._folder = holder, folder
        self._all = []
        root = str(Path(quad_ident_ros.__file__).resolve().parents[1])
        path = os.pathsep.join(filter(None, [root, os.environ.get('PYTHONPATH', '')]))
        # They end with the tests, however those end.
        self.environment = {**os.environ, 'ROS_DOMAIN_ID': str(domain), 'PYTHONPATH': path,
                            PARENT: str(os.getpid())}

    def start(self, node, parameters=None, arguments=(), shell='', **environment):
        """Start a node; arguments are ROS arguments, shell is run before it."""
        words = [word for name, value in (parameters or {}).items()
                 for word in ('-p', f'{name}:={_yaml(value)}')]
        return self.run(node, '--ros-args', *words, *arguments, shell=shell, **environment)

    def run(self, node, *words, shell='', **environment):
        folder = self._folder / f'process_{len(self._all)}'
        folder.mkdir()
        process = Process(node, words, {**self.environment, **environment}, folder,
                          self._holder, shell)
        self._all.append(process)
        return process

    def close(self):
        for process in self._all:
            process.kill()
            print(f'{process.node} said:\n{process.errors()}')   # shown where a test fails


def _yaml(value):
    return yaml.safe_dump(value, default_flow_style=True, width=10_000).split('\n')[0]


def write_experiment(path, runs, **values):
    """
    Write an experiment file and return its path.

    runs: {name: (seconds, {input: excitation or amplitude of a step})}.
    """
    def excitation(value):
        return value if isinstance(value, dict) else {'type': 'step', 'amplitude': value}

    data = {
        'name': path.stem, 'model': 'newton_euler', 'vehicle': 'paper_quadrotor', 'period': 0.01,
        'trim': 'hover', 'altitude': 10.0,
        'runs': [{'name': name, 'duration': seconds,
                  'inputs': {key: excitation(value) for key, value in inputs.items()},
                  'outputs': [{'U1': 'z', 'U2': 'phi', 'U3': 'theta', 'U4': 'psi'}[key]
                              for key in inputs]}
                 for name, (seconds, inputs) in runs.items()],
        **values}
    path.write_text(yaml.safe_dump(data), encoding='utf-8')
    return str(path)


def stamp_of(message):
    """Return the stamp of a message, ns."""
    return message.header.stamp.sec * 10 ** 9 + message.header.stamp.nanosec


def stamps_of(heard):
    return np.array([stamp_of(message) for message in heard])


def sample(topic, stamp, value=0.0):
    """Return a message of a flight topic; its numbers are made from value."""
    message = STREAMS[topic]()
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, 10 ** 9)
    if topic == 'attitude':
        message.vector.x, message.vector.y, message.vector.z = value, 2 * value, 3 * value
    elif topic == 'altitude':
        message.point.z = 4 * value
    elif topic == 'pose':
        message.pose.position.x, message.pose.position.y = 5 * value, 6 * value
        message.pose.position.z = 4 * value
        message.pose.orientation.w = 1.0
    elif topic == 'twist':
        message.twist.linear.x, message.twist.angular.z = 7 * value, 8 * value
    else:
        message.wrench.force.z, message.wrench.torque.z = 9 * value, 10 * value
    return message


class Vehicle:
    """Publishes crafted flights on the five topics."""

    def __init__(self, graph, topics=tuple(STREAMS), quality=LOSSLESS):
        self.publishers = {name: graph.advertise(STREAMS[name], name, quality)
                           for name in topics}

    def send(self, stamp, value=0.0, topics=None):
        for name in topics or self.publishers:
            self.publishers[name].publish(sample(name, stamp, value))

    def fly(self, count, first=10 ** 9, period=10 ** 7):
        """Publish samples with even stamps and rising values, and return the stamps."""
        stamps = [first + k * period for k in range(count)]
        for k, stamp in enumerate(stamps):
            self.send(stamp, 0.001 * k)
        return stamps


def flights(name='hover_single_axis', session=1, **changes):
    """Return the records of an experiment as a recorder would publish them."""
    experiment = load_experiment(name)
    records = []
    for k, run in enumerate(experiment.runs):
        record = fly(experiment, run).record
        info = {**record.info, 'session': session, 'run_index': k,
                'run_count': len(experiment.runs), 'dropped': 0, **changes}
        records.append(FlightRecord(record.t, record.columns, info))
    return records
