# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Several nodes of a kind, each in a namespace of its own, on one executor in one process."""

import signal
import sys

import rclpy
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.process import FastExecutor, is_wanted
from quad_ident_ros.nodes.recorder import Recorder
from quad_ident_ros.nodes.simulator import Simulator

NODES = {'simulator': Simulator, 'recorder': Recorder, 'identifier': Identifier}


def main(args):
    """Run nodes until told to stop; args: ROS arguments for all, kind and namespaces."""
    stop = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.append(True))
    rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    _, kind, *namespaces = remove_ros_args(args)
    nodes = [NODES[kind](namespace=namespace) for namespace in namespaces]
    executor = FastExecutor()
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
