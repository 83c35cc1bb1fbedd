# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Disks that fill up, folders that cannot be written, in each command that writes."""

import os
from pathlib import Path
import resource
import subprocess
import sys
import tempfile

from soak.rig import Finding

LIMIT = 8 * 1024    # bytes that fit on the disk: less than each command writes
FLIGHT = 'flight.csv'
# What each command writes, and its words; {out} is the file.
COMMANDS = {
    'fly': ('csv', 'fly lissajous --vehicle hummingbird --duration 10 -o {out}'),
    'convert to CSV': ('csv', f'convert {FLIGHT} {{out}}'),
    'convert to a bag': ('mcap', f'convert {FLIGHT} {{out}}'),
    'convert to gzip': ('csv.gz', f'convert {FLIGHT} {{out}}'),
    'diagnose --json': ('json', f'diagnose {FLIGHT} --vehicle hummingbird --json {{out}}'),
    'diagnose --report': ('html', f'diagnose {FLIGHT} --vehicle hummingbird --report {{out}}'),
}
KEPT = 'what was there before\n'


SHORT = ('fly', 'convert to CSV', 'convert to a bag')


def run(short: bool = False, **_: object) -> list[Finding]:
    """Return a Finding for each command, on a full disk and where the folder is gone."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made = _quad_ident(f'fly lissajous --vehicle hummingbird --duration 10 -o {FLIGHT}',
                           folder)
        if made.returncode:
            return [Finding('disk', 'a flight', made.stderr.strip(), False)]
        (folder / 'file').write_text('x')
        return [finding for title, (ending, words) in COMMANDS.items()
                if not short or title in SHORT for finding in (
            _full(title, words, folder, f'out.{ending}'),
            _gone(title, words, folder, f'file/out.{ending}'))]


def _full(title: str, words: str, folder: Path, out: str) -> Finding:
    (folder / out).write_text(KEPT)
    done = _quad_ident(words.format(out=out), folder, full=True)
    kept = (folder / out).is_file() and (folder / out).read_text('utf-8', 'replace') == KEPT
    (folder / out).unlink(missing_ok=True)
    return _finding('disk full', title, done, kept)


def _gone(title: str, words: str, folder: Path, out: str) -> Finding:
    """Name a file below a regular file, into which not even root can write."""
    return _finding('folder gone', title, _quad_ident(words.format(out=out), folder), True)


def _finding(case: str, title: str, done: subprocess.CompletedProcess, kept: bool) -> Finding:
    lines = [line for line in done.stderr.splitlines() if line.strip()]
    one = done.returncode != 0 and len(lines) == 1 and 'Traceback' not in done.stderr
    said = lines[-1][-90:] if lines else 'nothing was said'
    return Finding(case, title, f'exit code {done.returncode}, {len(lines)} lines: {said}'
                   + ('' if kept else '; the file that was there is gone'), one and kept)


def _quad_ident(words: str, folder: Path, full: bool = False) -> subprocess.CompletedProcess:
    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT, LIMIT))

    root = str(Path(__file__).resolve().parents[1])
    # What is compiled has to be kept elsewhere: it would not fit either.
    return subprocess.run([sys.executable, '-m', 'quad_ident_ros', *words.split()], cwd=folder,
                          env={**os.environ, 'PYTHONPATH': root}, capture_output=True, text=True,
                          preexec_fn=limit if full else None, check=False)
