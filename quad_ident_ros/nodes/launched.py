# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Nodes as processes on a ROS domain of their own, and a node here that watches them."""

import contextlib
import os
from pathlib import Path
import signal
import subprocess
import sys
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions

from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.domain import claim_domain
from quad_ident_ros.nodes.parameter_files import words_for
from quad_ident_ros.nodes.process import PARENT

STOPPING = 10.0      # s that the nodes have to end when asked to
# Exit codes of a node that ended when asked; the last where it took longer than STOPPING.
ENDINGS = (0, -signal.SIGKILL)


class Launched:
    """
    Processes of nodes that hear one another and nobody else, and end with this one.

    Args: folder: an existing one for their logs. To be used with `with`.
    """

    def __init__(self, folder):
        self._folder = Path(folder)
        self._domain, self._holder = claim_domain()
        self.processes = {}
        root = str(Path(__file__).resolve().parents[2])
        self._environment = {
            **os.environ, PARENT: str(os.getpid()), 'ROS_DOMAIN_ID': str(self._domain),
            'ROS_LOG_DIR': str(folder), 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
            'PYTHONPATH': os.pathsep.join(
                filter(None, [root, os.environ.get('PYTHONPATH', '')]))}

    def __enter__(self):
        """Return the launched processes themselves."""
        return self

    def __exit__(self, kind, *_):
        """End the processes; raises InputError where one fails and nothing else has."""
        with self._holder:
            codes = self._stop()
        for name, code in codes.items():
            if code not in ENDINGS and kind is None:
                raise InputError(f'{name} ended with exit code {code}: {self._last_line(name)}')

    def start(self, node, parameters, *, module=None, name=None, arguments=()):
        """
        Start a node of this package, or a module that stands for it.

        Args: node, e.g. 'recorder'; parameters: by name; name: of the process, by default that of
        the node; arguments: further ROS arguments.
        """
        name = name or node
        with open(self._log(name), 'w', encoding='utf-8') as log:
            self.processes[name] = subprocess.Popen(
                [sys.executable, '-m', module or f'quad_ident_ros.nodes.{node}', '--ros-args',
                 *words_for(parameters), *arguments],
                stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                env=self._environment, start_new_session=True,
                # A domain is taken as long as a node lives on it.
                pass_fds=[self._holder.fileno()])

    def check(self):
        """Raise InputError where a process has ended."""
        for name, process in self.processes.items():
            if process.poll() is not None:
                raise InputError(f'{name} ended early: {self._last_line(name)}')

    @contextlib.contextmanager
    def watcher(self, name):
        """Give a node of this process among them, and its executor."""
        os.environ.setdefault('ROS_LOG_DIR', str(self._folder))
        os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=self._domain,
                   signal_handler_options=SignalHandlerOptions.NO)
        node = rclpy.create_node(name, context=context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        try:
            yield node, executor
        finally:
            executor.shutdown()
            node.destroy_node()
            context.try_shutdown()

    def _stop(self):
        codes = {}
        for process in self.processes.values():
            process.send_signal(signal.SIGINT)
        end = time.monotonic() + STOPPING
        for name, process in self.processes.items():
            try:
                codes[name] = process.wait(max(0.0, end - time.monotonic()))
            except subprocess.TimeoutExpired:
                process.kill()
                codes[name] = process.wait()
        return codes

    def _log(self, name):
        return self._folder / f'{name}.txt'

    def _last_line(self, name):
        text = self._log(name).read_text(encoding='utf-8')
        lines = [line for line in text.splitlines() if line.strip()]
        return f'{lines[-1].strip() if lines else "it said nothing"} (log: {self._log(name)})'
