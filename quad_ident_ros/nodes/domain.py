# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A ROS domain of one's own, so that runs on one machine do not hear one another."""

import socket

from quad_ident_ros.errors import InputError

FIRST_PORT = 28400   # port FIRST_PORT + id stands for domain id


def claim_domain():
    """
    Return a free ROS domain id (1 to 100) and the socket that holds it until it is closed.

    A domain counts as taken while somebody holds the loopback port that stands for it. Raises
    InputError where all are taken.
    """
    for number in range(1, 101):
        holder = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        try:
            holder.bind(('127.0.0.1', FIRST_PORT + number))
        except OSError:
            holder.close()
            continue
        return number, holder
    raise InputError('all ROS domains from 1 to 100 are taken by other runs on this machine')
