# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the integration tests; nothing of them leaves this host."""

from pathlib import Path

from graph import Graph, Processes
import pytest

from quad_ident_ros.nodes.domain import claim_domain
from quad_ident_ros.nodes.process import FastExecutor
from quad_ident_ros.warm_up import warm_up


def pytest_collection_modifyitems(items):
    here = Path(__file__).parent
    for item in items:
        if here in item.path.parents:
            item.add_marker(pytest.mark.ros)
            item.add_marker(pytest.mark.slow)
            item.add_marker(pytest.mark.xdist_group('ros'))


@pytest.fixture(scope='session', autouse=True)
def compiled():
    """Compile before anything has a deadline: on a busy machine it takes longer than that."""
    warm_up()


@pytest.fixture(scope='session')
def claim(tmp_path_factory):
    """Claim a ROS domain and hold it to the end of the session; give its number and holder."""
    number, holder = claim_domain()
    with holder, pytest.MonkeyPatch.context() as patch:
        patch.setenv('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
        patch.setenv('ROS_LOG_DIR', str(tmp_path_factory.mktemp('ros_log')))
        patch.delenv('ROS_LOCALHOST_ONLY', raising=False)
        yield number, holder


@pytest.fixture(scope='session')
def domain(claim):
    """Give the number of the claimed ROS domain."""
    return claim[0]


@pytest.fixture
def graph(domain):
    """Give a graph whose nodes share a SingleThreadedExecutor."""
    graph = Graph(domain)
    yield graph
    graph.close()


@pytest.fixture
def fast_graph(domain):
    """Give a graph on the executor that the recorder runs on as a process."""
    graph = Graph(domain, FastExecutor)
    yield graph
    graph.close()


@pytest.fixture
def processes(claim, tmp_path):
    """Start nodes as processes; those that are left at the end are killed."""
    processes = Processes(*claim, tmp_path)
    yield processes
    processes.close()
