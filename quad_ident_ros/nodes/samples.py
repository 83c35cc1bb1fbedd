# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The messages of one sample of a flight."""

from geometry_msgs.msg import (
    PointStamped,
    PoseStamped,
    TwistStamped,
    Vector3Stamped,
    WrenchStamped,
)
import numpy as np
from rosgraph_msgs.msg import Clock

from quad_ident_ros.data.record import ARM
from quad_ident_ros.model.attitude import rotation_matrix

WORLD_FRAME, BODY_FRAME = 'world', 'base_link'


def samples_of(record):
    """
    Return the rows that the messages take: plain floats, fast to assign.

    Args: record of a flight whose info says the arm length, by which U2 and U3 are moments.
    """
    world = record.stack('vx', 'vy', 'vz')
    quaternion = record.stack('qw', 'qx', 'qy', 'qz')
    body = np.einsum('nji,nj->ni', rotation_matrix(quaternion), world)
    wrench = record.inputs() * [1.0, record.info[ARM], record.info[ARM], 1.0]
    return np.hstack([record.euler(), record.stack('px', 'py', 'pz'), quaternion, body,
                      record.stack('wx', 'wy', 'wz'), wrench]).tolist()


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
        """Write a stamp (ns) and a row of samples_of into the messages."""
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
