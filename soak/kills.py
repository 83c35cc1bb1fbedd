# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""kill -9 of each node at random moments: what is on disk, and whether all goes on."""

from collections.abc import Iterator
from pathlib import Path
import random
import tempfile
import time

from std_srvs.srv import Trigger

from benchmarks import load
from quad_ident_ros.errors import InputError
from quad_ident_ros.nodes.launched import Launched
from soak.landing import BEGINS, is_over, is_time_to_ask
from soak.loss import lost
from soak.rig import Finding, slowness, Watch

NODES = ('recorder', 'identifier', 'diagnoser', 'simulator')
RATES = (100, 1000)     # Hz
LOSS = 1.0              # s of what the recorder joined that a kill may cost
AGAIN = 60.0            # s within which a node that was started again is ready, if nobody else
                        # keeps the machine busy
FLIES = 2 * BEGINS      # s until it flies again, likewise
HEARS = 20.0            # s within which it joins samples, likewise
STARTS = 3              # of a recorder, each of which may hear nothing
BUSY = 1.5              # times longer that computing takes where others keep the machine busy
ON_ITS_WAY = 0.3        # s in which a watcher hears what was said before a kill
FLIGHT = 120.0          # s; it is flown again when it is over


def run(kills: int, rates: tuple[int, ...] = RATES, **_: object) -> Iterator[Finding]:
    """Give a Finding for each node and rate, Hz."""
    for rate in rates:
        yield from _killed(rate, kills)


def _killed(rate: int, kills: int) -> Iterator[Finding]:
    random.seed(rate)
    with tempfile.TemporaryDirectory() as name, Launched(name) as launched:
        parameters = {
            'recorder': {'output': name, 'window_seconds': 2.0, 'overlap': 0.5},
            'identifier': {'method': 'vp', 'mode': 'continuous'},
            'diagnoser': {'mode': 'continuous'},
            'simulator': {**load.simulator(Path(name), 1 / rate, FLIGHT),
                          'autostart': True, 'wait_for_subscribers': False}}
        with launched.watcher('soak') as pair:
            watch = Watch(*pair)
            for node in NODES:
                launched.start(node, parameters[node])
            watch.until(lambda: watch.heard.keys() >= set(NODES), 'all nodes', 10 * AGAIN)
            for node in NODES:
                yield _victim(watch, launched, Path(name), node, parameters[node], rate, kills)


def _victim(watch: Watch, launched: Launched, folder: Path, victim: str, parameters: dict,
            rate: int, kills: int) -> Finding:
    """Kill one of the nodes again and again, while the others go on; folder: of their logs."""
    worst, behind, back, deaf, unreadable = 0.0, 0.0, 0.0, 0, []
    for _ in range(kills):
        joined = watch.account['joined']
        watch.until(lambda j=joined: flies(watch) and watch.account['joined'] > j, 'the flight',
                    FLIES)
        watch.wait(random.uniform(0.6, 1.6))
        recording, before = watch.account['recording'], watch.account
        launched.processes[victim].kill()
        launched.processes[victim].wait()
        if victim == 'recorder':
            newest = watch.newest
            watch.wait(ON_ITS_WAY)
            behind = max(behind, (newest - watch.joined) * 1e-9)
            try:
                worst = max(worst, lost(Path(recording), watch.joined))
            except InputError as error:
                unreadable.append(str(error))
        for again in range(STARTS):
            begin = time.monotonic()
            launched.start(victim, parameters)
            if victim == 'simulator':
                watch.asked = begin     # it flies by itself
            if _works(watch, folder / f'{victim}.txt', victim, recording, again + 1 == STARTS):
                break
            launched.processes[victim].kill()
            launched.processes[victim].wait()
            deaf += 1
        back = max(back, time.monotonic() - begin)
    text = f'at work again within {back:.1f} s'
    if deaf:
        text += f'; after {deaf} of the kills it heard nothing, and was started once more'
    held = not unreadable and not deaf and worst <= LOSS
    if victim == 'recorder':
        why = f' ({unreadable[0]})' if unreadable else ''
        text = (f'{len(unreadable)} recordings unreadable{why}, at most {worst:.2f} s lost of '
                f'what it had joined, which was {behind:.2f} s behind the wire at most; {text}')
    elif victim != 'simulator':
        others = {key: watch.account[key] - before[key] for key in ('lost', 'dropped', 'late')
                  if watch.account[key] > before[key]}
        slower = slowness()
        text += f'; the recorder lost {others or "nothing"}'
        if others:
            text += f', which it counted; computing took {slower:.1f} times what it takes'
        # Where others keep the machine busy, it is they that cost something.
        held = held and (not others or slower > BUSY)
    return Finding('kill -9', f'{victim}, {kills} times at {rate} Hz', text, held)


def _works(watch: Watch, log: Path, victim: str, recording: str, last: bool) -> bool:
    """
    Return whether a node that was started again is ready, and a recorder joins samples.

    FastDDS may hand a process nothing that follows a killed one. Raises InputError where that is
    so of the last one that is started, or where the node is not ready.
    """
    watch.until(lambda: 'ready: ' in log.read_text('utf-8', 'replace'), f'{victim} again', AGAIN)
    try:
        watch.until(lambda: victim != 'recorder' or (
            flies(watch) and watch.account['recording'] != recording
            and watch.account['joined'] > 0), 'samples', HEARS)
    except InputError:
        if last:
            raise
        return False
    return True


def flies(watch: Watch) -> bool:
    """Return whether the simulator flies; where it has landed, it is asked to fly again."""
    now = time.monotonic()
    if is_time_to_ask(now, watch.flown, watch.asked) and watch.start.service_is_ready():
        watch.asked = now
        watch.start.call_async(Trigger.Request())
    return not is_over(now, watch.flown)
