# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A ROS domain of one's own, so that runs on one machine do not hear one another."""

import socket

from quad_ident_ros.errors import InputError

FIRST_PORT = 28400   # port FIRST_PORT + id stands for domain id
# Of discovery over DDS (RTPS 2.5, 9.6.2.3): first port, ports a domain, of multicast, and of
# unicast of participants 0 to 9, as far as others are looked for.
DISCOVERY, EACH = 7400, 250
OFFSETS = (0, *range(10, 30, 2))


def claim_domain():
    """
    Return a free ROS domain id (1 to 100) and the socket that holds it until it is closed.

    A domain counts as taken while somebody holds the loopback port that stands for it, or listens
    on this machine on a port by which nodes of that domain find one another, whoever started them.
    Raises InputError where all are taken.
    """
    for number in range(1, 101):
        if _is_in_use(number):
            continue
        holder = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        try:
            holder.bind(('127.0.0.1', FIRST_PORT + number))
        except OSError:
            holder.close()
            continue
        return number, holder
    raise InputError('all ROS domains from 1 to 100 are taken by other runs on this machine')


def _is_in_use(number):
    """Whether a node of a domain is on this machine."""
    for offset in OFFSETS:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(('', DISCOVERY + EACH * number + offset))
            except OSError:
                return True
    return False
