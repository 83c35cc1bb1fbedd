# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Several nodes of a kind, each in a namespace of its own, on one executor in one process."""

import signal
import sys

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.process import FastExecutor, is_wanted
from quad_ident_ros.nodes.recorder import Recorder
from quad_ident_ros.nodes.simulator import Simulator

# Each on the executor that it has when it is alone.
NODES = {'simulator': (Simulator, FastExecutor), 'recorder': (Recorder, FastExecutor),
         'identifier': (Identifier, SingleThreadedExecutor)}


def main(args):
    """Run nodes until told to stop; args: ROS arguments for all, kind and namespaces."""
    stop = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.append(True))
    rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    _, kind, *namespaces = remove_ros_args(args)
    node_class, executor_class = NODES[kind]
    nodes = [node_class(namespace=namespace) for namespace in namespaces]
    executor = executor_class()
    for node in nodes:
        executor.add_node(node)
    while not stop and is_wanted():
        executor.spin_once(timeout_sec=0.1)
    for node in nodes:
        node.close()
        executor.remove_node(node)
    executor.shutdown()
    for node in nodes:
        node.destroy_node()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main(sys.argv)
