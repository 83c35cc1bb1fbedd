# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident warm-up`: compile the inner loops, so that the first real start need not."""

from concurrent.futures import as_completed, ProcessPoolExecutor
import time

from quad_ident_ros.report.screen import progress_bar
from quad_ident_ros.warm_up import warm_up, warm_up_diagnosis


def add(commands, summary):
    """Add the command to the parser; summary: what it does."""
    parser = commands.add_parser('warm-up', help=summary)
    parser.set_defaults(run=run)


def run(options):
    """Compile what is not compiled yet, and say when that is done."""
    began = time.monotonic()
    # Where there is no terminal there is no bar.
    print('compiling the inner loops: minutes the first time, seconds later', flush=True)
    # They share little of what is compiled, and each takes a core.
    with ProcessPoolExecutor(2) as pool:
        parts = [pool.submit(warm_up), pool.submit(warm_up_diagnosis)]
        with progress_bar() as bar:
            task = bar.add_task('a small identification and a small diagnosis', total=len(parts))
            for part in as_completed(parts):
                part.result()
                bar.advance(task)
    print(f'everything is compiled, after {time.monotonic() - began:.0f} s')
