# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Node `recorder`: joins the topics of a flight into records, keeps and publishes them."""

import json
import math
import sys
import time

from diagnostic_msgs.msg import DiagnosticArray
import geometry_msgs.msg
from rclpy._rclpy_pybind11 import RCLError, RMWError
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.serialization import deserialize_message
from std_msgs.msg import String, UInt64
from std_srvs.srv import Trigger

from quad_ident_ros.data.flight_joiner import FlightJoiner
from quad_ident_ros.data.frame_watch import FrameWatch
from quad_ident_ros.data.stream_joiner import StreamJoiner
from quad_ident_ros.data.topics import (
    FLIGHT_TOPICS,
    JOINED_TOPIC,
    raw_columns,
    RUN_TOPIC,
    RunNotice,
    stamp_ns,
    unusable,
)
from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes import process
from quad_ident_ros.nodes.health import Health
from quad_ident_ros.nodes.mapped import message_class
from quad_ident_ros.nodes.messages import diagnostics_message, type_name
from quad_ident_ros.nodes.node import PackageNode, TwoTypes
from quad_ident_ros.nodes.on_disk import FLUSH_PERIOD, OnDisk
from quad_ident_ros.nodes.other_types import one_topic_for_two
from quad_ident_ros.nodes.outlets import outlets_of
from quad_ident_ros.nodes.parameters import help_text, NodeParameters
from quad_ident_ros.nodes.qos import KEPT, latched, LOSSLESS
from quad_ident_ros.nodes.recorder_parameters import mapped_topics, SPECS, validate
from quad_ident_ros.nodes.subscriptions import Subscriptions
from quad_ident_ros.nodes.unjoined import Unjoined

QUIET = 0.5          # s after the last message when the middleware is asked what it lost
ACKNOWLEDGED = 10    # rows after which the publishers hear how far the joining is
GONE = 2.0           # s after the last message when nothing more is to come, and
IDLE = 15.0          # s when something may, after which what is incomplete is given up; lost
                     # messages are sent again every 3 s
ENDING = 8.0         # s for what waits when the node is asked to end: `ros2 launch` gives 10
PARTING = 1.0        # s for listeners to take the last account before the node is gone

HELP = f"""recorder: joins the topics of a flight into records, keeps and publishes them.

  ros2 run quad_ident_ros recorder --ros-args -p output:=flights
  ros2 run quad_ident_ros recorder --ros-args -p output:=flights -p vehicle_name:=seven
  ros2 run quad_ident_ros recorder --ros-args -p mapping:=topics.yaml
  ros2 run quad_ident_ros recorder --ros-args -p topics:="[odometry, imu, actuators]" \\
    -r odometry:=/odom -r imu:=/imu/data -r actuators:=/command/motor_speed
  ros2 run quad_ident_ros recorder --ros-args -p window_seconds:=1.5 -p overlap:=0.9 \\
    -p windows:="['record_long=30,0.5']"
  ros2 service call /recorder/flush std_srvs/srv/Trigger

Subscribes (as the publisher offers, reliable first): attitude, altitude, pose, twist, input (types
as the simulator publishes them), run (std_msgs/String, announces runs; not needed). Or odometry
(nav_msgs/Odometry), imu (sensor_msgs/Imu) and actuators (actuator_msgs/Actuators), or any topics
that a mapping names, which are joined at the stamps of the pose (else of the first state), or of
commands that are faster. So are the first five where their stamps are seldom equal.
Publishes:
  record        std_msgs/Float64MultiArray (latched, 16 deep)  samples x columns, see the labels;
                and the topics of the parameter windows
  ~/statistics  std_msgs/String (latched)                      JSON: received, joined, dropped,
                late, duplicated, out of order, NaN, lost, unreadable, unread,
                recordings
  joined_until  std_msgs/UInt64                                stamp (ns) of the last joined row
  /diagnostics  diagnostic_msgs/DiagnosticArray, also wrong frames: a twist or pose that is not
                in ENU and FLU
A record is complete when an announced run ends, when the window is full, or on the service.
Services: ~/flush (std_srvs/Trigger)

Parameters (--ros-args -p NAME:=VALUE):
{help_text(SPECS)}"""


class Recorder(PackageNode):
    """Buffers a flight and hands out records."""

    def __init__(self, **kwargs):
        super().__init__('recorder', **kwargs)
        self._config = NodeParameters(self, SPECS, validate)
        parameters = self._config
        self._mapped = mapped_topics(parameters)
        self._told = set()      # notes on the stamps
        if self._mapped is None:
            self._topics = tuple(parameters['topics'])
            self._joiner = FlightJoiner(self._topics, parameters['gap'])
            columns = raw_columns(self._topics)
        else:
            self._check_names()
            self._topics = tuple(self._mapped.streams)
            self._joiner = StreamJoiner(self._mapped.streams, parameters['gap'])
            columns = ()
        self._outlets = outlets_of(self, columns, parameters)
        self._buffer = self._outlets[0].buffer
        self._last_message = None
        self._frames = FrameWatch()
        self._unjoined = Unjoined(self, self._topics, self._joiner, self._mapped,
                                  parameters['gap'], self._now())
        self._health = Health(self._topics, self._unjoined.apart, self._unjoined.silent)
        self._announced = None
        self._disk = OnDisk(parameters['output'], parameters['vehicle_name'], self.get_clock(),
                            self.get_logger())
        self._unreadable = None
        self._statistics = self.create_publisher(String, '~/statistics', latched())
        self._joined = self.create_publisher(UInt64, JOINED_TOPIC, 10)
        self._unacknowledged = 0
        self._diagnostics = self.create_publisher(DiagnosticArray, '/diagnostics', 10)
        self._inputs = Subscriptions(self)
        self._types = {}
        if self._mapped is None:
            for name in self._topics:
                self._subscribe(name)
        self._runs = self.create_subscription(String, RUN_TOPIC, self._on_run, latched(32),
                                              raw=True)
        if self._mapped is not None:
            self._look_for_topics()
        elif parameters['output']:
            self._open_recording()
        self.create_service(Trigger, '~/flush', self._on_flush)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(FLUSH_PERIOD, self._on_flush_timer, clock=steady)
        self.create_timer(1.0, self._report, clock=steady)
        self._report()

    def ready(self):
        """Say what is joined, and where it goes."""
        return f'joins {", ".join(self._topics)}; {self._config["output"] or "in memory only"}'

    @property
    def busy(self):
        """Whether anything of a flight came."""
        return self._last_message is not None or any(self.counts.received.values())

    @property
    def counts(self):
        """Return the account of the messages (data.joiner.Counts)."""
        return self._joiner.counts

    def close(self):
        """Finish the files on disk and publish the last account."""
        self.counts.unread += self._inputs.take_waiting(ENDING)
        # There is room for messages again: none is lost just now, which Losses asks for.
        self._count_lost()
        self._keep(self._joiner.drain())
        self._count_left(end=True)
        self._buffer.complete()
        self.counts.missing = self._buffer.missing
        self._disk.close()
        self._report()
        self._statistics.wait_for_all_acked(Duration(seconds=PARTING))
        if problems := self.counts.problems():
            self.get_logger().warning('ends; problems with the messages: ' + ', '.join(
                f'{count} {name}' for name, count in problems.items()))
        self._inputs.close()

    def _open_recording(self):
        self._disk.open({**self._inputs.topics, RUN_TOPIC: self._runs.topic_name},
                        self._types or None)

    def _check_names(self):
        """Raise InputError for a name in the mapping that no topic can have."""
        for name in self._mapped.topics:
            try:
                self.resolve_topic_name(name)
            except RCLError:
                raise InputError(
                    f'{self._config["mapping"]}: topics: {name!r} is not the name of a topic; '
                    'letters, digits, _ and / make one, no digit first and no / last, as `ros2 '
                    'topic list` shows it') from None

    def _look_for_topics(self):
        """Subscribe to the topics of the mapping that exist by now: only they have a type."""
        missing = [name for name in self._mapped.topics if name not in self._types]
        if not missing:
            return
        there, wrong = dict(self.get_topic_names_and_types()), []
        for name in missing:
            kinds = there.get(self.resolve_topic_name(name), ())
            if len(kinds) > 1:
                wrong.append(f'{name}: has several types ({", ".join(kinds)}); publish one')
            elif kinds:
                try:
                    message_class(kinds[0])
                except InputError as error:
                    wrong.append(f'{name}: {error}')
                    continue
                self._types[name] = kinds[0]
                self._subscribe(name)
                if beside := self._mapped.beside(name, kinds[0]):
                    self._types[beside] = kinds[0]
                    self._subscribe(beside, KEPT)
        if wrong:       # in one line: of several, the throttle would leave the first one only
            self.get_logger().error('; '.join(wrong), throttle_duration_sec=10.0)
        if self._config['output'] and all(name in self._types for name in self._mapped.topics):
            self._open_recording()

    def _subscribe(self, name, quality=LOSSLESS):
        if self._mapped is None:
            topic = FLIGHT_TOPICS[name]
            kind = getattr(geometry_msgs.msg, topic.type.rsplit('/', 1)[1])

            def on_message(raw):
                self._on_message(topic, kind, raw)
        else:
            kind = message_class(self._types[name])

            def on_message(raw):
                self._on_mapped(name, kind, raw)

        try:
            self._inputs.add(name, kind, on_message, quality)
        except TwoTypes as error:
            if self._mapped is not None:
                raise
            raise InputError(one_topic_for_two(self, name, self._topics) or str(error)) from None

    def _on_message(self, topic, kind, raw):
        now = self._last_message = self._now()
        sample = topic.read(raw)
        if sample is None:
            message = self._message(topic.name, kind, raw)
            if message is None:
                return
            sample = stamp_ns(message), topic.values(message)
        stamp, values = sample
        self._disk.write(topic.name, raw)
        if why := unusable(topic.name, values):
            self._say_unreadable(why)
            values = (math.nan,) * len(values)
        joiner, counts = self._joiner, self.counts
        restarts, interpolated = counts.restarts, joiner.interpolates
        rows = joiner.add(topic.name, stamp, values)
        if joiner.interpolates and not interpolated:
            self.get_logger().warning(self._unjoined.between())
        self._keep(rows)
        if counts.restarts != restarts and counts is self.counts:
            self.get_logger().warning('the clock of the messages went back: a new record begins')
        self._disk.flush_when_due(now)

    def _on_mapped(self, name, kind, raw):
        now = self._last_message = self._now()
        message = self._message(name, kind, raw)
        if message is None:
            return
        self._disk.write(name, raw, holds=name not in self._mapped.topics)
        self._disk.flush_when_due(now)
        try:
            samples = self._mapped.samples(name, self._types[name],
                                           self.get_clock().now().nanoseconds, message)
        except InputError as error:
            self._say_unreadable(str(error))
            return
        if self._mapped.refused:
            self._say_unreadable(self._mapped.refused)
        for note in self._mapped.notes():
            if note not in self._told:
                self._told.add(note)
                self.get_logger().warning(note)
        restarts = self.counts.restarts
        for role, stamp, values in samples:
            rows = self._joiner.add(role, stamp, values)
            if self.counts.restarts != restarts:
                restarts = self.counts.restarts
                self.get_logger().warning('the clock of the messages went back: a new record '
                                          'begins')
            self._keep(rows)

    def _message(self, name, kind, raw):
        """Return a message, or None where the bytes of it are none of its kind."""
        try:
            return deserialize_message(raw, kind)
        except RMWError:
            self.counts.unreadable += 1
            self._say_unreadable(
                f'{self.resolve_topic_name(name)}: a message is no {type_name(kind)} as it is '
                'defined here; source the package in the version that its publisher has')
            return None

    def _say_unreadable(self, why):
        self._health.trouble = self._unreadable = why
        self.get_logger().error(why, throttle_duration_sec=10.0)

    def _on_run(self, raw):
        message = self._message(RUN_TOPIC, String, raw)
        if message is None:
            return
        self._disk.write(RUN_TOPIC, raw)
        try:
            notice = RunNotice.from_json(message.data)
        except InputError as error:
            self.get_logger().error(str(error), throttle_duration_sec=10.0)
            return
        self._announced = notice.stop_ns
        self._disk.add_run(notice)
        self._publish(lambda buffer: buffer.add_run(notice))

    def _keep(self, rows):
        if rows:
            columns = None if self._mapped is None else self._joiner.raw_columns()
            if columns is not None:
                for outlet in self._outlets:
                    outlet.buffer.columns = columns
            self._health.note_rows(self._now())
            self._unjoined.note_rows()
            self._frames.add(rows)
            self._unacknowledged += len(rows)
            if self._unacknowledged >= ACKNOWLEDGED:
                self._unacknowledged = 0
                self._joined.publish(UInt64(data=rows[-1][0]))
            self._disk.add_rows(rows, columns)
            self._publish(lambda buffer: buffer.add_rows(rows))

    def _publish(self, step):
        """Publish the records that a step (a function of a RecordBuffer) completes; return all."""
        complete = [(outlet, step(outlet.buffer)) for outlet in self._outlets]
        self.counts.missing = self._buffer.missing
        found = [record for _, records in complete for record in records]
        if found:
            more = {'problems': self.counts.problems(),
                    **(self._mapped.info if self._mapped else {})}
            for outlet, records in complete:
                outlet.publish(records, more)
            self._report()
        return found

    def _on_flush(self, _, response):
        if self._silence() > QUIET:
            self._keep(self._joiner.drain())
        # Else a flight goes on: rows that still wait for a topic belong to the next record.
        records = self._publish(lambda buffer: buffer.complete())
        response.success = bool(records)
        response.message = (f'published a record of {max(map(len, records))} samples'
                            if records else
                            self._health.trouble or 'there are fewer than two samples to publish')
        return response

    def _on_flush_timer(self):
        silence = self._silence()
        if silence > QUIET:
            self._count_lost()
        if silence > self._patience():
            self._last_message = None
            self._keep(self._joiner.drain())
            if self._buffer.run_name:
                self._publish(lambda buffer: buffer.complete(run_over=True))
        self._disk.flush()
        self.counts.incompatible_qos += self._inputs.adapt()
        if self._mapped is not None:
            self._look_for_topics()

    def _now(self):
        return time.monotonic()

    def _silence(self):
        """Return the time since the last message, s; 0 before the first, or once given up."""
        return 0.0 if self._last_message is None else self._now() - self._last_message

    def _count_lost(self):
        self.counts.lost += self._inputs.count_lost()

    def _count_left(self, end=False):
        if self._mapped is not None:
            self.counts.add(self._mapped.left_out(end))

    def _patience(self):
        if self._announced is not None and self._joiner.has_reached(self._announced):
            return GONE
        alive = any(map(self.count_publishers, self._inputs.topics.values()))
        return IDLE if alive else GONE

    def _report(self):
        now = self._now()
        self._count_left()
        trouble = self._health.look(now, self.counts.received, self._unreadable)
        self._unreadable = None
        if awaited := self._unjoined.awaited(now):
            self.get_logger().warning(awaited)
        if wrong := self._unjoined.another_type() or self._frames.look(self._buffer.columns):
            self._health.blame(now, wrong)
            self.get_logger().error(wrong, throttle_duration_sec=10.0)
        elif trouble:
            self.get_logger().warning(trouble, throttle_duration_sec=10.0)
        folder = str(self._disk.folder) if self._disk.folder else None
        data = {**vars(self.counts), 'records': self._outlets[0].count,
                'buffered': len(self._buffer), 'run': self._buffer.run_name,
                'recording': folder, 'disk_error': self._disk.error}
        self._statistics.publish(String(data=json.dumps(data)))
        level, text = self._health.status(now, self.counts, self._unjoined.between(),
                                          self._disk.error)
        self._diagnostics.publish(diagnostics_message(self, level, text, data))


def main(args=None):
    """Run the node; returns the exit code."""
    return process.run(Recorder, HELP, args, process.FastExecutor)


if __name__ == '__main__':
    sys.exit(main())
