# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Disks that fill up, folders that cannot be written, in each command that writes."""

from collections.abc import Iterator
from dataclasses import replace
import errno
from itertools import product
import os
from pathlib import Path
import re
import resource
import shutil
import subprocess
import sys
import tempfile

from quad_ident_ros.model.covariance import Covariance
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from soak.rig import Finding

# Bytes that fit on the disk: less than each command writes of much, and of little.
LIMIT, LITTLE = 8 * 1024, 64
FLIGHT, VEHICLE = 'flight.csv', 'real.yaml'
# What each command writes, and its words; {out} is the file.
COMMANDS = {
    'fly': ('csv', 'fly lissajous --vehicle hummingbird --duration 10 -o {out}'),
    'convert to CSV': ('csv', f'convert {FLIGHT} {{out}}'),
    'convert to a bag': ('mcap', f'convert {FLIGHT} {{out}}'),
    'convert to gzip': ('csv.gz', f'convert {FLIGHT} {{out}}'),
    'diagnose --json': ('json', f'diagnose {FLIGHT} --vehicle hummingbird --json {{out}}'),
    'diagnose --report': ('html', f'diagnose {FLIGHT} --vehicle hummingbird --report {{out}}'),
    'fleet --report': ('html', f'fleet {FLIGHT} --vehicle hummingbird --workers 1 -o fleet '
                       '--report {out}'),
}
# What a fleet and a demo say while they work.
PROGRESS = re.compile(r"data set: |Dask's dashboard |\w+: \d+ of \d+ |\[\d+/\d+\] |.* \.\.\.$")
SMALL = {
    'diagnose --out-vehicle': ('yaml', f'diagnose {FLIGHT} --vehicle hummingbird '
                               '--out-vehicle {out}'),
    'fit --out-vehicle': ('yaml', f'fit {FLIGHT} --vehicle hummingbird --free mass '
                          '--out-vehicle {out}'),
    'identify --json': ('json', f'identify {FLIGHT} --vehicle hummingbird --method ls '
                        '--json {out}'),
    'identify --picture': ('png', f'identify {FLIGHT} --vehicle hummingbird --method ls '
                           '--picture {out}'),
    'vehicle': ('yaml', f'vehicle {VEHICLE} -o {{out}}'),
    'export': ('py', f'export {VEHICLE} --to rotorpy -o {{out}}'),
    **{f'export --to {target}': (ending, f'export {VEHICLE} --to {target} -o {{out}}')
       for target, ending in (('gazebo', 'sdf'), ('mujoco', 'xml'), ('urdf', 'urdf'),
                              ('crazyflow', 'toml'))},
    'fit --json': ('json', f'fit {FLIGHT} --vehicle hummingbird --free mass --json {{out}}'),
    'info --json': ('json', f'info {FLIGHT} --json {{out}}'),
    'vehicle --json': ('json', f'vehicle {VEHICLE} --json {{out}}'),
    'export --randomise to an array': ('npz', f'export {VEHICLE} --randomise 5 -o {{out}}'),
}
ROOT = str(Path(__file__).resolve().parents[1])
KEPT = 'what was written before\n'
# What each command writes into the folder `in`, and the file that exists before.
WRITTEN = {
    **{title: (f'in/out.{ending}', words.format(out=f'in/out.{ending}'))
       for title, (ending, words) in (COMMANDS | SMALL).items()},
    'export --randomise': ('in/kept', f'export {VEHICLE} --randomise 5 -o in/out'),
    'info --write-mapping': ('in/kept', f'info {FLIGHT} --write-mapping in/out.yaml'),
    'simulate': ('in/kept', 'simulate small_angle -o in'),
    'paper': ('in/paper.html', 'paper --preset paper_table3 --seeds 1 -o in'),
    'fleet': ('in/kept', f'fleet {FLIGHT} --vehicle hummingbird --workers 1 -o in/out'),
    'demo': ('in/kept', 'demo -o in'),
    'demo --gap': ('in/kept', 'demo --gap -o in'),
}
# The same of files that are written after others, which are whole by then.
LATER = {
    **{f'{title} --json': ('in/out.json', f'{words} --json in/out.json') for title, words in {
        'fly': 'fly lissajous --vehicle hummingbird --duration 10 -o out.csv',
        'convert': f'convert {FLIGHT} out.csv',
        'export': f'export {VEHICLE} --to rotorpy -o out.py',
        'export --randomise': f'export {VEHICLE} --randomise 5 -o out',
        'simulate': 'simulate small_angle -o out',
        'paper': 'paper --preset paper_table3 --seeds 1 -o out',
        'fleet': f'fleet {FLIGHT} --vehicle hummingbird --workers 1 -o out',
        'demo': 'demo -o out',
        'demo --gap': 'demo --gap --seed 1 -o out'}.items()},
    'paper, its data': ('in/paper.json', 'paper --preset paper_table3 --seeds 1 -o in'),
    'fleet --out-priors': ('in/out.yaml', f'fleet {FLIGHT} --vehicle hummingbird --workers 1 '
                           '-o out --out-priors in/out.yaml'),
}
# Runs a command, which meets what happens just when it opens or renames its first file in `in`,
# or the one of a name, after it has tried whether it may.
CHILD = """
import os
import resource
import shutil
import subprocess
import sys

place, event, what, most, file = sys.argv[1:6]
tried = happened = False

def fill():
    with open(f'{place}/filled', 'wb', buffering=0) as rest:
        for size in (1 << 20, 1 << 12):
            try:
                while rest.write(bytes(size)) == size:
                    pass
            except OSError:
                pass

def hook(name, values):
    global happened
    if not tried or happened or name != event or not isinstance(values[0], str | os.PathLike):
        return
    if name == 'open' and not values[2] & (os.O_WRONLY | os.O_RDWR):
        return
    path = os.path.abspath(values[0])
    if path.startswith(f'{place}/in/') and path.endswith(file):
        happened = True
        if what == 'gone':
            shutil.rmtree(f'{place}/in')
        elif what == 'full':
            fill()
        elif what == 'limit':
            sys.dont_write_bytecode = True     # it would be cut short, and kept
            resource.setrlimit(resource.RLIMIT_FSIZE, (int(most), int(most)))
        else:
            subprocess.run(['mount', '-o', 'remount,ro', place], check=True)

def check_outputs(options):
    global tried
    check(options)
    tried = True

sys.addaudithook(hook)
from quad_ident_ros.cli import outputs
from quad_ident_ros.cli.main import main
check, outputs.check_outputs = outputs.check_outputs, check_outputs
code = main(sys.argv[6:])
sys.exit(code if happened else 99)
"""
# On a disk in memory of its own: its content is all that is said on standard output.
MOUNTED = """
mount -t tmpfs -o size=64m none "$1" && cp "$2" "$3" "$1" && cd "$1" && mkdir in \
  && printf %s "$5" > "$4" || exit 98
kept=$4
shift 5
"$@" > /dev/null
code=$?
cat "$kept" 2> /dev/null
exit $code
"""


SHORT = ('fly', 'convert to CSV', 'convert to a bag')
SHORT_LATER = ('export --json',)
# Of the first file that does not fit: a picture of a report is drawn beside it before.
FULL = rf'\S+\.\w+: .*{os.strerror(errno.EFBIG)}'
ERRORS = {'full': errno.ENOSPC, 'read-only': errno.EROFS, 'gone': errno.ENOENT}


def run(short: bool = False, **_: object) -> Iterator[Finding]:
    """Give a Finding for each command, on a full disk and where the folder is gone."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        made = _quad_ident(f'fly lissajous --vehicle hummingbird --duration 10 -o {FLIGHT}',
                           folder)
        if made.returncode:
            yield Finding('disk', 'a flight', made.stderr.strip(), False)
            return
        (folder / 'file').write_text('x')
        write_vehicle(folder / VEHICLE, replace(
            load_vehicle('hummingbird'), covariance=Covariance(('mass',), (0.01,), ((1.0,),))))
        for title, (ending, words) in (COMMANDS | SMALL).items():
            if not short or title in SHORT:
                yield _full(title, words, folder, f'out.{ending}',
                            LIMIT if title in COMMANDS else LITTLE)
                yield _gone(title, words, folder, f'file/out.{ending}')
        for title, (file, words) in LATER.items():
            if not short or title in SHORT_LATER:
                yield _full_later(title, file, words, folder)
        if subprocess.run(['unshare', '-m', 'true'], capture_output=True, check=False).returncode:
            return    # only root may mount
        for title, (file, words) in (WRITTEN | LATER).items():
            if short and title != SHORT[0]:
                continue
            for event, what in (('open', 'full'), *product(('open', 'os.rename'),
                                                           ('read-only', 'gone'))):
                # A demo renames nothing itself, a bag only what is open, which keeps a disk from
                # becoming read-only.
                if event == 'open' or not (title == 'demo' or (title, what) == (
                        'convert to a bag', 'read-only')):
                    yield _halfway(title, file, words, folder, event, what)


def _halfway(title: str, file: str, words: str, folder: Path, event: str,
             what: str) -> Finding:
    """Have the disk become full or read-only, or the folder go, while a command writes."""
    place = folder / 'mounted'
    place.mkdir(exist_ok=True)
    done = subprocess.run(
        ['unshare', '-m', 'sh', '-c', MOUNTED, 'sh', str(place),
         *(str(folder / name) for name in (FLIGHT, VEHICLE)), file, KEPT,
         *_child(title, file, words, place, event, what)],
        env={**os.environ, 'PYTHONPATH': ROOT}, capture_output=True, text=True, check=False)
    return _finding(f'{what} at {event}', title, done, what == 'gone' or done.stdout == KEPT,
                    os.strerror(ERRORS[what]))


def _child(title: str, file: str, words: str, place: Path, event: str, what: str) -> list[str]:
    """Return the words that start a command to which something happens."""
    return [sys.executable, '-c', CHILD, str(place), event, what, str(LITTLE),
            Path(file).name if title in LATER else '', *words.split()]


def _full_later(title: str, file: str, words: str, folder: Path) -> Finding:
    """Have the disk become full when a file is opened that others come before."""
    place = folder / 'later'
    (place / 'in').mkdir(parents=True)
    for name in (FLIGHT, VEHICLE):
        shutil.copy(folder / name, place)
    (place / file).write_text(KEPT)
    done = subprocess.run(_child(title, file, words, place, 'open', 'limit'), cwd=place,
                          env={**os.environ, 'PYTHONPATH': ROOT}, capture_output=True, text=True,
                          check=False)
    kept = (place / file).read_text('utf-8', 'replace') == KEPT
    shutil.rmtree(place)
    return _finding('disk full', title, done, kept, FULL)


def _full(title: str, words: str, folder: Path, out: str, limit: int) -> Finding:
    (folder / out).write_text(KEPT)
    done = _quad_ident(words.format(out=out), folder, limit)
    kept = (folder / out).is_file() and (folder / out).read_text('utf-8', 'replace') == KEPT
    (folder / out).unlink(missing_ok=True)
    return _finding('disk full', title, done, kept, FULL)


def _gone(title: str, words: str, folder: Path, out: str) -> Finding:
    """Name a file below a regular file, into which not even root can write."""
    done = _quad_ident(words.format(out=out), folder)
    return _finding('folder gone', title, done, True, f'{out}: file is a file')


def _finding(case: str, title: str, done: subprocess.CompletedProcess, kept: bool,
             why: str) -> Finding:
    """Return what came of a command that is to say why (a pattern), in one line."""
    lines = [line for line in done.stderr.splitlines() if line.strip()
             and not PROGRESS.match(line)]
    one = done.returncode == 2 and len(lines) == 1 and re.search(why, lines[0]) is not None
    said = lines[-1][-90:] if lines else 'nothing was said'
    return Finding(case, title, f'exit code {done.returncode}, {len(lines)} lines: {said}'
                   + ('' if kept else '; the old file is gone'), one and kept)


def _quad_ident(words: str, folder: Path, most: int | None = None) -> subprocess.CompletedProcess:
    """Run a command in a folder; most: bytes of a file on its disk."""
    def limit() -> None:
        if most is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

    # What is compiled has to be kept elsewhere: it would not fit either.
    return subprocess.run([sys.executable, '-m', 'quad_ident_ros', *words.split()], cwd=folder,
                          env={**os.environ, 'PYTHONPATH': ROOT,
                               'PYTHONDONTWRITEBYTECODE': '1'},
                          capture_output=True, text=True, preexec_fn=limit, check=False)
