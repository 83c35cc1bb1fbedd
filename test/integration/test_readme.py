# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The recipes of the README and of the pages on ROS 2 work as they are printed."""

from pathlib import Path
import re
import shlex

from graph import DEADLINE
import pytest

from quad_ident_ros.nodes.mapped import message_class
from quad_ident_ros.nodes.qos import latched

ROOT = Path(__file__).parents[2]
PAGES = ('README.md', 'docs/nodes.md', 'docs/continuous.md')
# Flights of one-off recipes are flown as fast as they can be; the other has to be followed.
FAST = ['-p', 'real_time_factor:=0.0']


def recipes():
    """Return [(nodes, topics)] of the blocks that run nodes: [[name, words...]] and [topic]."""
    found = []
    text = '\n'.join((ROOT / page).read_text(encoding='utf-8') for page in PAGES)
    for block in re.findall(r'(?:^    .*\n)+', text, re.M):
        lines = [shlex.split(line) for line in block.replace('\\\n', ' ').splitlines()]
        nodes = [words[3:] for words in lines if words[:3] == 'ros2 run quad_ident_ros'.split()]
        topics = [words[3] for words in lines if words[:3] == ['ros2', 'topic', 'echo']]
        if nodes and (nodes, topics) not in found:
            found.append((nodes, topics))
    return found


RECIPES = recipes()


def test_the_pages_have_recipes():
    assert [len(nodes) for nodes, _ in RECIPES] == [3, 3, 3, 3]
    assert [topics for _, topics in RECIPES] == [['/diagnosis'], ['/parameters'], [], ['/change']]


@pytest.mark.parametrize('nodes, topics', RECIPES,
                         ids=['-'.join(topics) or 'windows' for _, topics in RECIPES])
def test_a_recipe_works_as_printed(graph, processes, tmp_path, nodes, topics):
    started = []
    for name, *words in nodes:
        words = [word.replace('output:=flights', f'output:={tmp_path}') for word in words]
        if name == 'simulator' and topics != ['/change']:
            words += FAST
        started.append(processes.run(name, *words))
    for process in started:
        graph.spin_until(lambda p=process: 'ready: ' in p.errors() or not p.running(),
                         f'{process.node} to be ready', 12 * DEADLINE)
    for topic in topics:
        kinds = graph.spin_until(
            lambda t=topic: dict(graph.probe.get_topic_names_and_types()).get(t), topic)
        heard = graph.listen(message_class(kinds[0]), topic, latched())
        graph.spin_until(lambda h=heard: h, f'a message on {topic}', 6 * DEADLINE)
        if topic == '/change':
            assert [status.name for status in heard[0].status] == ['z']
    assert [process.stop() for process in started] == [0] * len(started)
    assert not any('Traceback' in process.errors() for process in started)
