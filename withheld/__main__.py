# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Fly realities, diagnose them blindly, open the labels: `./run withheld`."""

import argparse
import datetime
import json
import os
from pathlib import Path
import shutil
import subprocess
import sys
import tempfile

from withheld.cases import SETS
from withheld.page import keep
from withheld.processes import follow, key_from, progress, THREADS
from withheld.score import score
from withheld.seal import unseal
from withheld.table import markdown

ROOT = Path(__file__).resolve().parents[1]
DOCUMENT = ROOT / 'docs' / 'withheld.md'

DESCRIPTION = """\
Check the diagnosis on flights whose effects are withheld from it.

One process flies realities with rotorpy and seals what they were; a second one diagnoses the
flights and cannot open the seal; this one then opens it and prints how often the diagnosis was
right. The labels on disk are enciphered with a pad that only this process holds in its memory.

`calibrate` instead fits the probabilities of the diagnosis to flights of development. `in-mujoco`
says whether the gap falls in MuJoCo, once the effects are exported, by as much as was promised.
"""

EPILOG = """\
examples:
  ./run withheld --set development --count 12    a few cases, to see that it works
  ./run withheld --set ordinary --count 60       forms of ordinary vehicles, to develop with
  ./run withheld                                 the evaluation set; kept in docs/withheld.md
  ./run withheld --count 150 --jobs 2            the same kinds of cases in proportion, but fewer
  ./run withheld calibrate                       fly development; print Rules.calibration
  ./run withheld calibrate KEPT                  the same of a folder that --keep has written
  ./run withheld in-mujoco KEPT --count 40       diagnose against MuJoCo's model of the vehicle,
                                                 export, and compare the gaps there

There is no --scheduler: workers of a cluster are processes that others started, of which the check
cannot show that they know nothing of the labels. docs/withheld.md describes the seal.
"""


def main(arguments=None):
    """Run the check and return the exit code."""
    parser = argparse.ArgumentParser(
        prog='quad_ident withheld', description=DESCRIPTION, epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('action', nargs='?', choices=('calibrate', 'in-mujoco'), metavar='ACTION',
                        help='calibrate: fit the probabilities to flights of development; '
                             'in-mujoco: fly what is exported in MuJoCo')
    parser.add_argument('folders', nargs='*', metavar='FOLDER',
                        help='kept runs (default for calibrate: one that is flown now)')
    parser.add_argument('--set', choices=SETS,
                        help='which cases (default: evaluation, to be run once per release)')
    parser.add_argument('--count', type=_positive, metavar='N',
                        help='only so many cases, of each kind in proportion')
    parser.add_argument('--seed', type=_positive, metavar='S',
                        help='fly this draw again (default: one that nobody knows beforehand)')
    parser.add_argument('--jobs', type=_positive, default=os.cpu_count(), metavar='N',
                        help='processes that fly and that diagnose (default: one per core)')
    parser.add_argument('--keep', metavar='FOLDER',
                        help='keep flights, diagnoses and opened labels in this new folder')
    parser.add_argument('--table', metavar='FILE',
                        help='in-mujoco: write all cases as a page in Markdown')
    parser.add_argument('--json', metavar='FILE', help='write the score as data; - prints it')
    options = parser.parse_args(arguments)
    if options.keep and Path(options.keep).exists():
        parser.error(f'--keep {options.keep}: it exists already; name a new folder')
    if options.table and options.action != 'in-mujoco':
        parser.error('--table: it is of in-mujoco')
    if options.action == 'in-mujoco':
        return _in_mujoco(parser, options)
    if options.action:
        return _calibrate(parser, options)
    options.set = options.set or 'evaluation'
    work = Path(tempfile.mkdtemp(prefix='withheld-'))
    try:
        opened, found = run(options, work)
        result = score(opened['labels'], found) | {
            'set': options.set, 'seed': opened['seed'], 'version': _version(),
            'not_flown': opened['not_flown']}
        if options.keep:
            shutil.copytree(work, options.keep)
    finally:
        shutil.rmtree(work)
    if options.json != '-':
        print(markdown(result))
    if options.json == '-':
        print(json.dumps(result, indent=1))
    elif options.json:
        Path(options.json).write_text(json.dumps(result, indent=1), encoding='utf-8')
    if options.set == 'evaluation' and options.count is None:
        keep(DOCUMENT, result, datetime.date.today())
    return 0


def _in_mujoco(parser: argparse.ArgumentParser, options: argparse.Namespace) -> int:
    """Print how far gaps fall in MuJoCo; return 1 where one falls by less than promised."""
    from withheld.in_mujoco import falls_of, page, summary
    if not options.folders:
        parser.error('in-mujoco: name a folder that --keep has written')
    cases = [case for folder in map(Path, options.folders)
             for case in sorted((folder / 'flights').glob('*/vehicle.yaml'))][:options.count]
    if not cases:
        parser.error(f'in-mujoco {options.folders[0]}: there are no flights of a kept run')
    found = falls_of([case.parent for case in cases], options.jobs)
    said, fell_short = summary(found)
    print(said)
    if options.table:
        folders = ' '.join(Path(folder).name for folder in options.folders)
        count = f' --count {options.count}' if options.count else ''
        command = f'./run withheld in-mujoco {folders}{count}'
        Path(options.table).write_text(page(found, command, _version()), encoding='utf-8')
    return 1 if fell_short else 0


def _calibrate(parser: argparse.ArgumentParser, options: argparse.Namespace) -> int:
    """Fit the probabilities to kept runs, or to one that is flown now; return the exit code."""
    if options.set == 'evaluation':
        parser.error('calibrate: never on the evaluation, which would not count any more')
    from withheld.calibrate import fit, rows_of, text_of
    pairs = []
    for folder in map(Path, options.folders):
        try:
            kept = json.loads((folder / 'labels.json').read_text(encoding='utf-8'))
        except OSError as error:
            parser.error(f'calibrate {folder}: no kept run: {error}')
        if kept.get('set') == 'evaluation':
            parser.error(f'calibrate {folder}: a run of the evaluation')
        pairs += _paired(kept, diagnoses_in(folder / 'found'))
    if not options.folders:
        options.set = 'development'
        with tempfile.TemporaryDirectory(prefix='withheld-') as work:
            pairs = _paired(*run(options, Path(work)))
            if options.keep:
                shutil.copytree(work, options.keep)
    rows = rows_of(pairs)
    try:
        print(text_of(rows, fit(rows)))
    except ValueError as error:
        parser.error(str(error))
    return 0


def _paired(opened: dict, found: dict) -> list[tuple[dict, dict]]:
    return [(label, found.get(name, {})) for name, label in opened['labels'].items()]


def diagnoses_in(folder: Path) -> dict[str, dict]:
    """Return {case: diagnosis} of a folder that was written to blindly."""
    return {path.stem: json.loads(path.read_text(encoding='utf-8'))
            for path in folder.glob('*.json')}


def run(options, work):
    """Fly and diagnose in processes of their own; return the opened labels and the diagnoses."""
    flights, found = work / 'flights', work / 'found'
    flights.mkdir()
    found.mkdir()
    with tempfile.TemporaryDirectory(prefix='sealed-') as vault, progress() as bar:
        sealed = Path(vault) / 'labels'
        key = fly(options, flights, sealed, bar)
        diagnose(flights, found, bar, options.jobs)
        opened = unseal(sealed.read_bytes(), key)
    (work / 'labels.json').write_text(json.dumps(opened, indent=1), encoding='utf-8')
    return opened, diagnoses_in(found)


def fly(options, flights, sealed, bar):
    """Have the realities flown; return the key of the sealed labels."""
    command = [sys.executable, '-m', 'withheld.make', '--set', options.set, '--flights',
               str(flights), '--sealed', str(sealed), '--jobs', str(options.jobs)]
    for name in ('count', 'seed'):
        if getattr(options, name) is not None:
            command += [f'--{name}', str(getattr(options, name))]
    return key_from(command, bar)


def diagnose(flights, found, bar, jobs=1):
    """Have the flights diagnosed by a process that knows them and nothing else."""
    process = subprocess.Popen(
        [sys.executable, '-m', 'withheld.blind', str(flights), str(found), str(jobs)],
        stdout=subprocess.PIPE, text=True, cwd=flights, env={**os.environ, **THREADS})
    follow(process, bar, 'diagnosing them', sum(1 for _ in flights.iterdir()))


def _version():
    from quad_ident_ros import __version__
    done = subprocess.run(['git', '-C', str(ROOT), 'rev-parse', '--short', 'HEAD'],
                          capture_output=True, text=True)
    return f'{__version__} ({done.stdout.strip()})' if done.returncode == 0 else __version__


def _positive(text):
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f'{text} is less than 1')
    return value


if __name__ == '__main__':
    sys.exit(main())
