# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The topics of a flight: the messages of one sample, and their publishers."""

from geometry_msgs.msg import (
    PointStamped,
    PoseStamped,
    TwistStamped,
    Vector3Stamped,
    WrenchStamped,
)
from rclpy._rclpy_pybind11 import RCLError
from rosgraph_msgs.msg import Clock

WORLD_FRAME, BODY_FRAME = 'world', 'base_link'


class SampleMessages:
    """The messages of one sample, made once and filled for each; prefix: of the body's frame."""

    def __init__(self, prefix=''):
        self.attitude, self.altitude, self.pose = Vector3Stamped(), PointStamped(), PoseStamped()
        self.twist, self.input, self.clock = TwistStamped(), WrenchStamped(), Clock()
        for message in (self.attitude, self.altitude, self.pose):
            message.header.frame_id = WORLD_FRAME
        for message in (self.twist, self.input):
            message.header.frame_id = prefix + BODY_FRAME

    def fill(self, stamp_ns, row):
        """Write a stamp (ns) and a row of playback.rows_of into the messages."""
        seconds, nanoseconds = divmod(stamp_ns, 1_000_000_000)
        for message in (self.attitude, self.altitude, self.pose, self.twist, self.input):
            message.header.stamp.sec = seconds
            message.header.stamp.nanosec = nanoseconds
        self.clock.clock.sec, self.clock.clock.nanosec = seconds, nanoseconds
        vector, point, pose = self.attitude.vector, self.altitude.point, self.pose.pose
        vector.x, vector.y, vector.z = row[0:3]
        pose.position.x, pose.position.y, pose.position.z = row[3:6]
        point.z = row[5]
        orientation = pose.orientation
        orientation.w, orientation.x, orientation.y, orientation.z = row[6:10]
        twist = self.twist.twist
        twist.linear.x, twist.linear.y, twist.linear.z = row[10:13]
        twist.angular.x, twist.angular.y, twist.angular.z = row[13:16]
        wrench = self.input.wrench
        wrench.force.z = row[16]
        wrench.torque.x, wrench.torque.y, wrench.torque.z = row[17:20]
        return self


class SampleStreams:
    """
    The publishers of the topics of a flight, in order: one that is stuck holds up the others.

    Args: node; quality of service; prefix of the body's frame; with_clock: /clock, too.
    """

    def __init__(self, node, quality, prefix='', with_clock=False):
        messages = SampleMessages(prefix)
        self._messages = messages
        self.flight = [node.create_publisher(type(message), name, quality) for name, message in (
            ('attitude', messages.attitude), ('altitude', messages.altitude),
            ('pose', messages.pose), ('twist', messages.twist), ('input', messages.input))]
        self._all = list(zip(self.flight, (messages.attitude, messages.altitude, messages.pose,
                                           messages.twist, messages.input), strict=True))
        if with_clock:
            self._all.append((node.create_publisher(Clock, '/clock', 10), messages.clock))
        self._next = 0

    def publish(self, stamp_ns, row):
        """
        Publish a sample, or what remains of it; return the publisher whose reader is too slow.

        None where the sample is out. Call it again with the same sample otherwise.
        """
        self._messages.fill(stamp_ns, row)
        for publisher, message in self._all[self._next:]:
            try:
                publisher.publish(message)
            except RCLError:
                return publisher
            self._next += 1
        self._next = 0
        return None

    def start_over(self):
        """Forget what remains of a sample."""
        self._next = 0
