# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The live view in the terminal: panels that follow a state, and keys that ask the nodes."""

import asyncio
import signal
import time
from typing import ClassVar, Protocol

from textual.app import App, ComposeResult
from textual.binding import BindingType
from textual.containers import VerticalScroll
from textual.widgets import Footer, Static

from quad_ident_ros.watch.panels import (
    diagnoser_panel,
    history_panel,
    identifier_panel,
    recorder_panel,
    waiting_panel,
)
from quad_ident_ros.watch.state import State

LOOK = 0.25     # s between two looks at the state: soon enough to the eye, little for a slow line
ALIVE = 1.0     # s after which the clock and the silences are rewritten
REQUESTS = ('identify', 'diagnose', 'flush')


class Source(Protocol):
    """What is watched: its state now, and requests to its nodes, whose answers are events."""

    state: State
    namespace: str
    where: str

    def request(self, name: str) -> None:
        """Ask the node that offers one of REQUESTS."""


class WatchApp(App[None]):
    """Shows the state of a Source until q or Ctrl-C."""

    TITLE = 'quad_ident watch'
    ENABLE_COMMAND_PALETTE = False
    CSS = """
    #top { height: 1; text-style: reverse; }
    #waiting, #recorder, #identifier, #diagnoser { height: auto; }
    .-tall #waiting, .-tall #recorder, .-tall #identifier, .-tall #diagnoser { margin-bottom: 1; }
    #title { height: 1; text-style: bold; }
    #events { height: 1fr; min-height: 3; }
    Screen { overflow-y: auto; }
    """
    VERTICAL_BREAKPOINTS = [(0, '-short'), (30, '-tall')]
    BINDINGS: ClassVar[list[BindingType]] = [
        *((name[0], f'request("{name}")', name) for name in REQUESTS), ('q', 'quit', 'quit'),
        ('ctrl+c', 'quit', '')]

    def __init__(self, source: Source) -> None:
        super().__init__(ansi_color=True)   # the terminal's own colours, none with NO_COLOR
        self.theme = 'ansi-dark'
        self._source = source
        self._shown: tuple[State | None, float] = (None, 0.0)

    def compose(self) -> ComposeResult:
        """Give the panels from top to bottom."""
        for name in ('top', 'waiting', 'recorder', 'identifier', 'diagnoser'):
            yield Static(id=name, markup=False)
        yield Static('history', id='title')
        with VerticalScroll(id='events'):
            yield Static(id='history', markup=False)
        yield Footer()

    def on_mount(self) -> None:
        """Begin to follow the state, and end at a signal as at a key."""
        loop = asyncio.get_running_loop()
        for number in (signal.SIGINT, signal.SIGTERM):
            loop.add_signal_handler(number, self.exit)
        self.set_interval(LOOK, self.show)
        self.show()

    def on_resize(self) -> None:
        """Lay out the tables again."""
        self._shown = (None, 0.0)
        self.show()

    def show(self) -> None:
        """Update the panels where there is news."""
        state, now = self._source.state, time.monotonic()
        before, then = self._shown
        if state is before and now - then < ALIVE:
            return
        self._shown = (state, now)
        where, width = self._source.where, self.size.width
        title, clock = f'quad_ident watch  {self._source.namespace}  {where}', time.strftime('%X')
        panels = {
            'top': f'{title:{max(width - len(clock), 0)}}{clock}',
            'waiting': waiting_panel(state, self._source.namespace, where),
            'recorder': recorder_panel(state, now),
            'identifier': identifier_panel(state, now, width),
            'diagnoser': diagnoser_panel(state, now),
            'history': history_panel(state)}
        for name, panel in panels.items():
            self.query_one(f'#{name}', Static).update(panel)
        for name in ('recorder', 'identifier', 'diagnoser'):
            self.query_one(f'#{name}').display = name in state.health
        self.query_one('#waiting').display = len(state.health) < 3

    def action_request(self, name: str) -> None:
        """Ask a node; its answer comes as an event."""
        self._source.request(name)
