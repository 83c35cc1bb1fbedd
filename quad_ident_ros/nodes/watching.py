# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The nodes of a vehicle watched over ROS 2, from a thread of its own: `quad_ident watch`."""

from collections.abc import Callable
from functools import partial
import json
import os
import threading
import time

from diagnostic_msgs.msg import DiagnosticArray
import rclpy
from rclpy.exceptions import InvalidNamespaceException
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String
from std_srvs.srv import Trigger

from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.process import ensure_log_folder
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.stamped import KEPT_CHANGES
from quad_ident_ros.watch.panels import start_command
from quad_ident_ros.watch.state import (
    after_message,
    Event,
    NODES,
    State,
    time_text,
    with_change,
    with_diagnosis,
    with_event,
    with_fit,
    with_health,
    with_progress,
    with_statistics,
)

SERVICES = {'identify': 'identifier', 'diagnose': 'diagnoser', 'flush': 'recorder'}
PATIENCE = 5.0      # s for an answer: the nodes answer at once, and FastDDS sometimes drops one


class Watching:
    """
    A Source (watch.view) fed by the nodes of one namespace; to be used with `with`.

    Args: namespace: '' or 'uav1'; domain: of ROS, by default that of the environment. Raises
    InputError where the namespace is invalid.
    """

    def __init__(self, namespace: str = '', domain: int | None = None) -> None:
        ensure_log_folder()
        self.state = State()
        self._lock = threading.Lock()
        self._stop = threading.Event()
        self._asked: dict[str, float] = {}      # steady time of each open request, s
        self._context = rclpy.Context()
        try:
            rclpy.init(context=self._context, domain_id=domain,
                       signal_handler_options=SignalHandlerOptions.NO)
        except Exception as error:
            raise InputError(f'ROS 2 does not start: {str(error).splitlines()[0]}') from None
        try:
            self._node = rclpy.create_node('watch', namespace=namespace, context=self._context,
                                           enable_rosout=False, start_parameter_services=False)
        except InvalidNamespaceException:
            self._context.try_shutdown()
            raise InputError(f'--namespace {namespace!r}: expected letters, digits, _ and /, no '
                             'digit first, for example uav1') from None
        self.namespace = self._node.get_namespace()
        self.where = f'ROS domain {self._context.get_domain_id()}'
        if os.environ.get('ROS_AUTOMATIC_DISCOVERY_RANGE') == 'LOCALHOST':
            self.where += ', this machine only'
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._clients = {name: self._node.create_client(Trigger, f'{node}/{name}')
                         for name, node in SERVICES.items()}
        self._subscribe()
        self._thread = threading.Thread(target=self._spin, name='watch')

    def __enter__(self) -> 'Watching':
        """Begin to listen."""
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """Stop listening."""
        self.close()

    def close(self) -> None:
        """Stop listening and leave the graph."""
        self._stop.set()
        self._thread.join()
        self._executor.remove_node(self._node)
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()

    def request(self, name: str) -> None:
        """Ask a node, by the name of its service; what comes of it is an event."""
        node, client = SERVICES[name], self._clients[name]
        if name in self._asked:
            return
        if not client.service_is_ready():
            self._tell(name, f'there is no {node} to ask; start it: '
                       f'{start_command(node, self.namespace)}')
            return
        self._asked[name] = time.monotonic()
        client.call_async(Trigger.Request()).add_done_callback(partial(self._on_answer, name))

    def _subscribe(self) -> None:
        listen = self._node.create_subscription
        listen(DiagnosticArray, '/diagnostics', self._on_status, 10)
        listen(DiagnosticArray, 'change', self._on_change, latched(KEPT_CHANGES))
        for node in ('identifier', 'diagnoser'):
            self._listen_to_json(f'{node}/progress', 10, partial(_progress, node))
        self._listen_to_json('recorder/statistics', latched(),
                             lambda state, data: with_statistics(state, data, time.monotonic()))
        self._listen_to_json('parameters_json', latched(), with_fit)
        self._listen_to_json('diagnosis', latched(), with_diagnosis)

    def _listen_to_json(self, topic: str, quality: object,
                        step: Callable[[State, dict], State]) -> None:
        def on_message(message: String) -> None:
            self._apply(topic, lambda state: step(state, json.loads(message.data)))

        self._node.create_subscription(String, topic, on_message, quality)

    def _on_status(self, message: DiagnosticArray) -> None:
        names = {f'{self.namespace}/{node}'.strip('/'): node for node in NODES}
        for status in message.status:
            if status.name in names:
                level = int.from_bytes(status.level, 'little')
                self._apply('/diagnostics', partial(
                    with_health, node=names[status.name], level=level, text=status.message,
                    now=time.monotonic()))

    def _on_change(self, message: DiagnosticArray) -> None:
        stamp = message.header.stamp.sec * 10 ** 9 + message.header.stamp.nanosec
        for status in message.status:
            self._apply('change', partial(with_change, stamp_ns=stamp, output=status.name,
                                          text=status.message))

    def _on_answer(self, name: str, future: rclpy.Future) -> None:
        if self._asked.pop(name, None) is not None:
            answer = future.result()
            self._tell(name, answer.message if answer.success else f'refused: {answer.message}')

    def _spin(self) -> None:
        while not self._stop.is_set():
            self._executor.spin_once(timeout_sec=0.1)
            for name, since in list(self._asked.items()):
                if time.monotonic() - since > PATIENCE:
                    self._asked.pop(name, None)
                    self._tell(name, f'no answer within {PATIENCE:g} s; press the key again')

    def _tell(self, about: str, text: str) -> None:
        self._apply(about, partial(with_event,
                                   event=Event(time_text(time.time_ns()), about, text)))

    def _apply(self, topic: str, step: Callable[[State], State]) -> None:
        # The view asks from its thread, messages come in ours.
        with self._lock:
            self.state = after_message(self.state, topic, step)


def _progress(node: str, state: State, data: dict) -> State:
    return with_progress(state, node, data)
