# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A node as a process: start, signals, errors in one line, a clean end."""

import json
import os
import signal
import sys
import tempfile
import threading

import rclpy
from rclpy._rclpy_pybind11 import RCLError
from rclpy.exceptions import NameValidationException, ParameterException
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rclpy.utilities import remove_ros_args

from quad_ident_ros import resources
from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.parameter_files import is_for, names_in
from quad_ident_ros.nodes.shared_memory import free_abandoned, HearingWatch, keep_to_oneself
from quad_ident_ros.nodes.start_news import StartNews
from quad_ident_ros.nodes.watchdog import watchdog

try:
    from rclpy.experimental.events_executor import EventsExecutor as FastExecutor
except ImportError:   # early releases of Jazzy
    FastExecutor = SingleThreadedExecutor

LETTING_GO = 5       # s that the middleware has to take a node down
PARENT = 'QUAD_IDENT_PARENT'   # a process whose death ends the node
STARTS = 'QUAD_IDENT_STARTS'   # how often a node has started once more by itself, and
MOST_STARTS = 3                # how often it may
CHANGED = 'QUAD_IDENT_CHANGED'  # parameters, JSON, that were set before it did


def run(node_class, help_page, args=None, executor_class=SingleThreadedExecutor,
        warm_up=None):
    """
    Run a node until it is asked to stop, and return the exit code.

    Args: node_class: called without arguments, its `close()` is called at the end; help_page:
    printed for --help; args: the command line, by default that of the process; warm_up: a function
    that `warm_up` of the node runs while the node exists. Bad input gives one line on standard
    error and exit code 2. Where the middleware does not let go of a closed node, the process ends
    without it, with exit code 1 where the node had failed. A node that turns out to be deaf just
    after its start, without work yet, starts once more, with the parameters that were set since.
    """
    name = node_class.__name__.lower()
    args = [name, *(sys.argv[1:] if args is None else args)]
    try:
        plain = _plain_arguments(args)
        if '-h' in plain or '--help' in plain:
            print(help_page)
            return 0
        if plain:
            raise InputError(f'{plain[0]!r} is not an option here: parameters are given as '
                             '--ros-args -p NAME:=VALUE; --help lists them')
        return _run(node_class, args, executor_class, warm_up)
    except InputError as error:
        print(f'{name}: error: {error}', file=sys.stderr)
        return 2


def _plain_arguments(args):
    """Return the words that are not for ROS; raises InputError for ROS arguments that fail."""
    for path in _parameter_files(args):     # before ROS 2 reads them, which may wait for ever
        resources.read_yaml(path)
    try:
        return remove_ros_args(args)[1:]
    except Exception as error:
        raise InputError('the ROS arguments cannot be used (expected --ros-args -p NAME:=VALUE): '
                         f'{_first_line(error)}') from None


def _run(node_class, args, executor_class, warm_up):
    ensure_log_folder()
    free_abandoned()
    stop, deaf, changed = [], False, {}
    previous = {number: signal.signal(number, lambda *_: stop.append(True))
                for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        # rclpy's own handlers shut the context down under the running node, which then fails.
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
    except Exception as error:
        raise InputError(f'the ROS arguments cannot be used: {_first_line(error)}') from None
    node = executor = None
    try:
        try:
            node = node_class()
        except ParameterException as error:
            raise InputError(f'a parameter cannot be used: {_first_line(error)}') from None
        except (RCLError, NameValidationException) as error:
            raise InputError('the node cannot be made; check its namespace, and the names that -r '
                             f'and parameters give topics: {_first_line(error)}') from None
        _check_parameter_files(args, node)
        executor = executor_class()
        executor.add_node(node)
        if warm_up is not None:
            node.warm_up(warm_up)
        begun = node.values()
        _change(node)
        news = StartNews(node)
        hearing = HearingWatch(node.get_logger().error,
                               lambda: _starts() < MOST_STARTS and not node.busy)
        while not stop and not deaf and is_wanted():
            news.tell()
            deaf = hearing.look()
            executor.spin_once(timeout_sec=0.1)
        changed = {name: value for name, value in node.values().items() if value != begun[name]}
    finally:
        if node is not None:
            node.close()
        # FastDDS can deadlock when peers leave at once (its issue 6502), with the interpreter
        # locked. All is saved by now, so the process may end in the middle of it.
        sys.stdout.flush()
        well = sys.exc_info()[1] is None and (stop or not deaf)
        with watchdog(LETTING_GO, 0 if well else 1):
            if executor is not None:
                executor.remove_node(node)
                executor.shutdown()
            if node is not None:
                node.destroy_node()
            rclpy.try_shutdown()
        for number, handler in previous.items():
            signal.signal(number, handler)
    if deaf and not stop:
        _start_anew(changed)
    _leave_compilation()
    return 0


def _starts():
    """Return how often this node has started once more by itself."""
    try:
        return int(os.environ.get(STARTS, '0'))
    except ValueError:      # somebody else's
        return 0


def _change(node):
    """Set the parameters again that were set before this node started once more by itself."""
    try:
        values = json.loads(os.environ.pop(CHANGED, '{}')).items()
        changed = [Parameter(name, value=value) for name, value in values
                   if node.has_parameter(name)]
    except (ValueError, TypeError, AttributeError):     # somebody else's
        return
    result = node.set_parameters_atomically(changed)
    if not result.successful:
        node.get_logger().error(f'parameters that were set are lost: {result.reason}')


def _start_anew(changed):
    """Become the program that this process was at its beginning, with the parameters changed."""
    # As words of the command line an empty list would not take the place of another.
    os.environ[CHANGED] = json.dumps(changed)
    os.environ[STARTS] = str(_starts() + 1)
    keep_to_oneself()
    sys.stdout.flush()
    sys.stderr.flush()
    os.execv(sys.executable, [sys.executable, *sys.orig_argv[1:]])


def _leave_compilation():
    """
    End the process where a thread of it still compiles: nothing can interrupt that.

    All else is closed by now, and a function that is not kept whole is compiled again.
    """
    if any(thread.daemon and thread.is_alive() for thread in threading.enumerate()
           if thread is not threading.current_thread()):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(0)


def is_wanted():
    """Return whether the process that started the node, if it said so, still lives."""
    parent = os.environ.get(PARENT)
    return parent is None or parent == str(os.getppid())


def ensure_log_folder():
    """Give rclpy a folder for its log where it would find none."""
    if 'ROS_LOG_DIR' not in os.environ and 'ROS_HOME' not in os.environ:
        home = os.environ.get('HOME')
        if not home or not os.access(home, os.W_OK):
            os.environ['ROS_LOG_DIR'] = tempfile.mkdtemp(prefix='quad_ident_ros_log_')


def _parameter_files(args):
    return [args[i + 1] for i, word in enumerate(args[:-1]) if word == '--params-file']


def _check_parameter_files(args, node):
    """Raise InputError for a parameter file that says nothing to this node: ROS 2 is silent."""
    full_name = node.get_fully_qualified_name()
    for path in _parameter_files(args):
        keys = names_in(resources.read_yaml(path))
        if not is_for(keys, node.get_name(), full_name):
            raise InputError(f'{path}: nothing in it is for this node, {full_name}; it is for '
                             f'{", ".join(keys) or "none"}: use the name of the node or /**')


def _first_line(error):
    return str(error).splitlines()[0] if str(error) else type(error).__name__
