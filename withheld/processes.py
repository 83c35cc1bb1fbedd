# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The processes of a check, that of the truth and that of the verdicts, and how far they are."""

from concurrent.futures import ThreadPoolExecutor
import os
import subprocess

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

THREADS = dict.fromkeys(('OMP_NUM_THREADS', 'OPENBLAS_NUM_THREADS', 'MKL_NUM_THREADS'), '1')


def key_from(command, bar):
    """Run a command with `--key` and a pipe of its own; return what it writes there."""
    read, write = os.pipe()
    process = subprocess.Popen([*command, '--key', str(write)], stdout=subprocess.PIPE, text=True,
                               pass_fds=(write,), env={**os.environ, **THREADS})
    os.close(write)
    # A pipe holds less than the key of many labels: it is read while the process goes on.
    with os.fdopen(read, 'rb') as pipe, ThreadPoolExecutor(1) as reader:
        key = reader.submit(pipe.read)
        follow(process, bar, 'flying realities')
        return key.result()


def follow(process, bar, title, total=None):
    """Show the lines of a process as progress; raises CalledProcessError where it fails."""
    task = bar.add_task(title, total=total)
    with process:
        for count, line in enumerate(process.stdout, 1):
            parts = line.split()
            bar.update(task, completed=count, total=total or int(parts[-1]))
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, title)


def progress():
    """Return a progress bar on standard error."""
    return Progress(TextColumn('{task.description}'), BarColumn(),
                    TextColumn('{task.completed} of {task.total}'), TimeElapsedColumn(),
                    console=Console(stderr=True))
