# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What the nodes that work on the records of the recorder have in common."""

from dataclasses import dataclass

from diagnostic_msgs.msg import DiagnosticArray
from rclpy.clock import Clock, ClockType
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Trigger

from quad_ident_ros.data.table import record_from_table
from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.job import Job
from quad_ident_ros.nodes.messages import diagnostics_message, ERROR, OK, WARN
from quad_ident_ros.nodes.node import PackageNode
from quad_ident_ros.nodes.parameters import NodeParameters
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.records import Records
from quad_ident_ros.nodes.remedies import for_a_node

NEWS = 10.0     # s between two lines of log on records that are left aside, windows come fast
LATEST = 2 ** 31 - 1     # s of a stamp of ROS, of 1970: results have that of the last sample
GETTING_READY = 'getting ready: loads or compiles its inner loops, and keeps records that arrive'


@dataclass(frozen=True)
class Words:
    """What the work is called: its service (identify), and in sentences (fit, fitting, fitted)."""

    service: str
    noun: str
    doing: str
    done: str


class RecordWorker(PackageNode):
    """
    A node that works on records, in a thread of its own so that the executor stays free.

    Mode once: on the first complete experiment, then only when its service is called;
    continuous: on each new record. A node of this kind says with `_unfit` which records it leaves
    aside, with `_prepare` what is to be done, and with `_publish` what came of it, where it sets
    `_status`: (level, text, values) for /diagnostics.
    """

    def __init__(self, name, specs, validate, words, **kwargs):
        super().__init__(name, **kwargs)
        self._config = NodeParameters(self, specs, validate)
        self._words = words
        self._records = Records()
        self._worked = False
        self._status = (OK, 'waiting for a record', {})
        self._diagnostics = self.create_publisher(DiagnosticArray, '/diagnostics', 10)
        self._job = Job(self, self._begin, self._on_end,
                        f'topic record: these records cannot be {words.done}')
        self.create_service(Trigger, f'~/{words.service}', self._on_request)
        self.create_service(Trigger, '~/cancel', self._on_cancel)
        self.create_timer(1.0, self._report, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.create_subscription(Float64MultiArray, 'record', self._on_record, latched(16))

    def ready(self):
        """Say what is worked on, and when."""
        topic = self.resolve_topic_name('record')
        return f'{self._words.doing} what comes on {topic}, mode {self._config["mode"]}'

    @property
    def is_ready(self):
        """Whether the node can work at once: what comes before is kept and worked on then."""
        return not self._job.warming_up

    @property
    def busy(self):
        """Whether there is a record to work on."""
        return bool(self._records)

    def warm_up(self, function):
        """Run a function before the first work, beside the executor."""
        self._job.warm_up(function)

    def close(self):
        """End the work that is being done."""
        self._job.close()

    @property
    def _continuous(self):
        return self._config['mode'] == 'continuous'

    def _on_record(self, message):
        try:
            record = record_from_table(message)
        except InputError as error:
            self.get_logger().error(str(error))
            return
        why = _beyond_all_time(record) or self._unfit(record)
        if why:
            self.get_logger().warning(why, throttle_duration_sec=NEWS)
            return
        if self._records.add(record, longest=not self._continuous):
            self._on_session()
        if self._continuous or self._records.complete and not self._worked:
            self._job.request()

    def _taken(self):
        """Return the records that are worked on."""
        return self._records.all()

    def _on_session(self):
        """Forget what was found in the records of another session."""

    def _on_request(self, _, response):
        if not self._records:
            response.message = 'there is no record yet: is a recorder running? (~/flush)'
            return response
        busy = self._job.busy
        self._job.request()
        response.success = True
        response.message = (
            f'the node is still getting ready; a {self._words.noun} '
            'follows' if not self.is_ready else
            f'a {self._words.noun} is running; another follows' if busy else
            f'{self._words.doing} {len(self._taken())} records')
        return response

    def _on_cancel(self, _, response):
        response.success = self._job.cancel()
        response.message = 'cancelled' if response.success else (
            f'no {self._words.noun} is running')
        return response

    def _begin(self):
        self._worked = True
        return self._prepare()

    def _on_end(self, outcome):
        if outcome is None:
            self._status = (WARN, f'the {self._words.noun} was cancelled', {})
            self.get_logger().warning(self._status[1])
        elif isinstance(outcome, InputError):
            self._status = (ERROR, for_a_node(str(outcome)), {})
            self.get_logger().error(self._status[1])
        else:
            self._publish(outcome)
        self._publish_status()

    def _report(self):
        # A trigger that is lost, as was seen once in some thousand fits, delays a result at most.
        self._job.collect()
        self._publish_status()

    def _publish_status(self):
        level, text, values = self._status
        if not self.is_ready:
            level, text = OK, GETTING_READY
        elif self._job.busy:
            level, text = OK, self._words.doing
        self._diagnostics.publish(diagnostics_message(self, level, text, values))


def _beyond_all_time(record):
    """Return why no stamp can be that of a record, or None."""
    start = record.info.get('start_ns', 0)
    if 0 <= start and start * 1e-9 + float(record.t[-1] - record.t[0]) < LATEST:
        return None
    return ('topic record: a record is ignored whose time is none that a stamp can have '
            f'(start_ns, t): from 0 to {LATEST} s')
