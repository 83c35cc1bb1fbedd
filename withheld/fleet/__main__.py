# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Make a fleet, look at it blindly, open its truth: `./run withheld fleet`."""

import argparse
import json
import os
from pathlib import Path
import shutil
import subprocess
import sys
import tempfile

from rich.progress import Progress

from withheld.fleet import gain
from withheld.fleet.score import numbers_of, passed, score, text_of
from withheld.fleet.truth import TOGETHER
from withheld.processes import follow, key_from, progress, THREADS
from withheld.seal import unseal

DESCRIPTION = """\
Check what `quad_ident fleet` reports, on a fleet whose truth is withheld from it.

One process flies a fleet in simulation, with changes, a drift, odd vehicles and wrong logs, and
seals what it did; `quad_ident fleet` diagnoses the logs; this process then opens the seal and
prints what was found, how it was dated, and what is false. It ends with 1 where something was
missed or is false.

`priors` instead learns priors from vehicles of one make and compares the verdicts on others of it
with and without them; it ends with 1 where exact sets or probabilities get worse.
"""


def main(arguments: list[str] | None = None) -> int:
    """Run the check and return the exit code."""
    parser = argparse.ArgumentParser(prog='quad_ident withheld fleet', description=DESCRIPTION,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('action', nargs='?', choices=('priors',), metavar='ACTION',
                        help='priors: what the priors of a fleet change')
    parser.add_argument('--vehicles', type=int, default=20, metavar='N',
                        help='vehicles, of `priors` that teach and that are tried, each '
                             '(default: %(default)s)')
    parser.add_argument('--flights', type=int, default=30, metavar='N',
                        help='flights of each (default: %(default)s)')
    parser.add_argument('--seed', type=int, metavar='S',
                        help='make this fleet again (default: one that nobody knows beforehand)')
    parser.add_argument('--workers', type=int, metavar='N',
                        help='processes that diagnose (default: one for each core)')
    parser.add_argument('--keep', metavar='FOLDER',
                        help='keep logs, data set, insight and opened truth in this new folder')
    parser.add_argument('--json', metavar='FILE', help='write the score as data; - prints it')
    options = parser.parse_args(arguments)
    if options.keep and Path(options.keep).exists():
        parser.error(f'--keep {options.keep}: it exists already; name a new folder')
    work = Path(tempfile.mkdtemp(prefix='withheld-fleet-'))
    try:
        run, text, good = ((_run_priors, gain.text_of, gain.no_worse) if options.action
                           else (_run, text_of, passed))
        result = run(options, work)
        if options.keep:
            shutil.copytree(work, options.keep)
    except subprocess.CalledProcessError as error:      # it has said why
        print(f'quad_ident withheld fleet: error: {error.cmd}: a process ended with '
              f'{error.returncode}', file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print('quad_ident withheld fleet: interrupted', file=sys.stderr)
        return 130
    finally:
        shutil.rmtree(work)
    if options.json == '-':
        print(json.dumps(result, indent=1))
    else:
        print(text(result))
        if options.json:
            Path(options.json).write_text(json.dumps(result, indent=1), encoding='utf-8')
    return 0 if good(result) else 1


def _run(options: argparse.Namespace, work: Path) -> dict:
    """Make a fleet, have it looked at, and return the score."""
    logs, out, told = work / 'logs', work / 'fleet', work / 'insight.json'
    with tempfile.TemporaryDirectory(prefix='sealed-') as vault, progress() as bar:
        sealed = Path(vault) / 'truth'
        command = [sys.executable, '-m', 'withheld.fleet.make', '--folder', str(logs), '--sealed',
                   str(sealed), '--vehicles', str(options.vehicles), '--flights',
                   str(options.flights)]
        if options.seed is not None:
            command += ['--seed', str(options.seed)]
        key = key_from(command, bar)
        _look(options, logs / 'manifest.csv', out, bar,
              options.vehicles * -(-options.flights // TOGETHER),
              '--vehicle', str(logs / 'vehicle.yaml'))
        subprocess.run([sys.executable, '-m', 'withheld.fleet.blind', str(out), str(told)],
                       check=True)
        truth = unseal(sealed.read_bytes(), key)
    (work / 'truth.json').write_text(json.dumps(truth, indent=1), encoding='utf-8')
    return score(truth, json.loads(told.read_text(encoding='utf-8')), numbers_of(logs))


def _run_priors(options: argparse.Namespace, work: Path) -> dict:
    """Learn priors from one part of a make, try them on the other, and return the comparison."""
    logs, priors = work / 'logs', work / 'priors.yaml'
    with tempfile.TemporaryDirectory(prefix='sealed-') as vault, progress() as bar:
        sealed = Path(vault) / 'truth'
        command = [sys.executable, '-m', 'withheld.fleet.sisters', '--folder', str(logs),
                   '--sealed', str(sealed), '--vehicles', str(options.vehicles)]
        if options.seed is not None:
            command += ['--seed', str(options.seed)]
        key = key_from(command, bar)
        for part, out, more in (('taught', 'taught', ('--out-priors', str(priors))),
                                ('tried', 'without', ()),
                                ('tried', 'with', ('--priors', str(priors)))):
            _look(options, logs / part, work / out, bar, options.vehicles, *more)
        truth = unseal(sealed.read_bytes(), key)
    (work / 'truth.json').write_text(json.dumps(truth, indent=1), encoding='utf-8')
    return gain.compared(truth['tried'], gain.verdicts_of(work / 'without'),
                         gain.verdicts_of(work / 'with')) | {'seed': truth['seed']}


def _look(options: argparse.Namespace, flights: Path, out: Path, bar: Progress, groups: int,
          *more: str) -> None:
    """Have `quad_ident fleet` diagnose flights into a data set; it knows nothing else."""
    command = [sys.executable, '-m', 'quad_ident_ros', 'fleet', str(flights), '--out', str(out),
               '--json', '-', *more]
    if options.workers:
        command += ['--workers', str(options.workers)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=out.parent,
                               env={**os.environ, **THREADS})
    follow(process, bar, 'diagnosing them', groups)


if __name__ == '__main__':
    sys.exit(main())
