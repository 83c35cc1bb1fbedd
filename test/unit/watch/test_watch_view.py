# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The live view in a terminal of Textual's own, without ROS."""

import asyncio
from collections import defaultdict
from html import unescape
import re

from published import account, diagnosis, identification, published
import pytest

from quad_ident_ros.report.verdict import verdict_line
from quad_ident_ros.watch.state import (
    Event,
    NODES,
    State,
    with_change,
    with_diagnosis,
    with_event,
    with_fit,
    with_health,
    with_progress,
    with_statistics,
)

pytest.importorskip('textual', reason="Textual is not installed: pip install '.[watch]'")
from quad_ident_ros.watch.view import WatchApp  # noqa: E402, I100

NEVER_SILENT = 1e12     # steady time of a node that has just been heard, s
SIZES = [(80, 24), (120, 40)]


class Still:
    """A Source that does not change; requests: the names of those that came."""

    namespace, where = '/uav1', 'ROS domain 5'

    def __init__(self, state):
        self.state = state
        self.requests = []

    def request(self, name):
        self.requests.append(name)
        self.state = with_event(self.state, Event('12:00:00', name, f'{name} was asked'))


def all_there():
    """Return a state with everything in it."""
    state = State()
    for node in NODES:
        state = with_health(state, node, 0, f'{node} is well', NEVER_SILENT)
    state = with_statistics(state, account(100), 1.0)
    state = with_statistics(state, account(300, lost=7), 3.0)
    state = with_fit(state, identification())
    state = with_diagnosis(state, published(diagnosis()))
    return with_change(state, 63_200_000_000, 'phi', 'phi changed: K 4.35 -> 3.3')


def seen(state, *keys, size=(80, 24)):
    """Return the lines of the screen after some keys, the Source and whether the view ended."""
    source = Still(state)
    app = WatchApp(source)

    async def look():
        async with app.run_test(size=size) as pilot:
            while not app.query('FooterKey') and app.is_running:    # it comes after the panels
                await pilot.pause()
            await pilot.press(*keys)
            app.show()
            await pilot.pause()
            ended = not app.is_running or app._exit
            return lines_of(app.export_screenshot()), ended

    lines, ended = asyncio.run(look())
    return lines, source, ended


def lines_of(picture):
    """Return the words of each line of a picture (SVG) of the screen, one space between them."""
    rows = defaultdict(list)
    for y, text in re.findall(r'<text [^>]*? y="([0-9.]+)"[^>]*>([^<]*)</text>', picture):
        rows[float(y)].append(unescape(text))   # with no-break spaces, which split() takes, too
    return [' '.join(' '.join(rows[y]).split()) for y in sorted(rows)]


@pytest.mark.parametrize('size', SIZES)
def test_before_anything_is_heard_it_says_what_starts_it(size):
    screen = '\n'.join(seen(State(), size=size)[0])
    assert 'Not heard yet on ROS domain 5' in screen and '/uav1' in screen
    for node in NODES:
        assert re.search(f'quad_ident node {node} .*-r __ns:=/uav1', screen)


@pytest.mark.parametrize('size', SIZES)
def test_all_of_it_is_on_the_screen(size):
    lines, _, _ = seen(all_there(), size=size)
    screen = ' '.join(lines)
    assert 'Not heard' not in screen
    assert 'attitude 100 Hz' in screen and '7 lost' in screen
    rows = {line.split()[0]: line for line in lines if line}
    for name, output in identification()['methods']['ls']['outputs'].items():
        assert float(rows[name].split()[1]) == pytest.approx(output['K'], rel=1e-3)
    assert '63.20 s' in rows['phi'] and '63.20 s' not in rows['theta']
    assert verdict_line(diagnosis()) in screen
    for name, value in (('before', '0.115'), ('after', '0.0331'), ('noise', '0.0375')):
        assert rows[name].split()[1:] == [value] * 4
    assert 'phi changed: K 4.35 -> 3.3' in screen
    for key in ('i identify', 'd diagnose', 'f flush', 'q quit'):
        assert key in lines[-1]
    assert '…' not in screen    # nothing is cut


def test_keys_ask_the_nodes_and_what_they_say_is_shown():
    lines, source, ended = seen(all_there(), 'i', 'd', 'f', 'x')
    assert source.requests == ['identify', 'diagnose', 'flush'] and not ended
    newest = next(number for number, line in enumerate(lines) if 'flush was asked' in line)
    assert 'diagnose was asked' in lines[newest + 1]


@pytest.mark.parametrize('key', ['q', 'ctrl+c'])
def test_it_ends_by_a_key(key):
    assert seen(State(), key)[2]


def test_work_under_way_is_a_bar_and_a_node_that_went_is_silent():
    state = with_progress(with_health(State(), 'diagnoser', 0, 'diagnosing', NEVER_SILENT),
                          'diagnoser', {'fraction': 0.42})
    state = with_health(state, 'recorder', 0, '100 samples joined', -100.0)
    screen = '\n'.join(seen(state)[0])
    assert re.search(r'diagnoser OK █+░+ 42 % diagnosing', screen)
    assert re.search(r'recorder silent for \d+ s', screen)


def test_signs_of_markup_in_a_message_are_shown_as_they_are():
    text = '[/tmp/no] cannot be written: [bold]'
    state = with_health(State(), 'recorder', 2, text, NEVER_SILENT)
    assert text in '\n'.join(seen(state)[0])
