# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Run long runs and faults: `./run soak [CASE ...] [--short]`."""

import argparse
import sys

from benchmarks.tables import markdown
from quad_ident_ros.errors import InputError
from quad_ident_ros.warm_up import warm_up, warm_up_diagnosis
from soak import busy, disks, hours, kills, parameters, streams
from soak.rig import Finding

CASES = {'disks': disks.run, 'streams': streams.run, 'parameters': parameters.run,
         'kills': kills.run, 'busy': busy.run, 'hours': hours.run}
SHORT = ('disks', 'streams', 'parameters', 'kills')     # what holds however loaded a machine is
KILLS, SECONDS = 5, 120.0
SHORT_KILLS, SHORT_SECONDS, SHORT_RATES = 1, 20.0, (100,)


def main(arguments: list[str] | None = None) -> int:
    """Run the cases that are asked for and print a table; returns 1 where one does not hold."""
    parser = argparse.ArgumentParser(
        prog='./run soak', description='Kill, flood, fill and confuse the nodes, and say what '
        'held. By default ten minutes or so; docs/reliability.md has the commands for longer.')
    parser.add_argument('cases', nargs='*', metavar='CASE',
                        help=f'one of {", ".join(CASES)}; by default all')
    parser.add_argument('--kills', type=int, help=f'kills of each node at each rate ({KILLS})')
    parser.add_argument('--seconds', type=float,
                        help=f'of the long flight, and at most a minute of the busy one '
                        f'({SECONDS:g}); 3600 for an hour')
    parser.add_argument('--count', type=int, default=parameters.COUNT,
                        help='inputs to parameters (%(default)s)')
    parser.add_argument('--seed', type=int, default=0, help='of these (%(default)s)')
    parser.add_argument('--short', action='store_true',
                        help=f'two minutes of {", ".join(SHORT)}: {SHORT_KILLS} kill at '
                        f'{SHORT_RATES[0]} Hz, {parameters.SHORT_COUNT} inputs; on a loaded '
                        'machine it takes longer, and holds')
    options = parser.parse_args(arguments)
    for name in options.cases:
        if name not in CASES:
            parser.error(f'{name}: no such case, expected one of {", ".join(CASES)}')
    kills_ = options.kills or (SHORT_KILLS if options.short else KILLS)
    seconds = options.seconds or (SHORT_SECONDS if options.short else SECONDS)
    if kills_ < 1 or options.count < 1 or not 10.0 <= seconds <= 3600.0:
        parser.error('expected at least one kill and one input, and 10 to 3600 seconds')
    # Else the nodes would compile while they are looked at.
    warm_up()
    warm_up_diagnosis()
    findings = []
    rates = SHORT_RATES if options.short else kills.RATES
    for name in options.cases or (SHORT if options.short else CASES):
        print(f'{name} ...', file=sys.stderr, flush=True)
        try:
            for each in CASES[name](kills=kills_, seconds=seconds, rates=rates,
                                    count=options.count, seed=options.seed, short=options.short):
                findings.append(each)
                print(f'  {"holds" if each.held else "does not hold"}: {each.done}: '
                      f'{each.result}', file=sys.stderr, flush=True)
        except InputError as error:     # what it had before is a result all the same
            findings.append(Finding(name, 'it could not go on', str(error), False))
    print(markdown(('case', 'what was done', 'what came of it', 'holds'), [
        (each.case, each.done, each.result, 'yes' if each.held else '**no**')
        for each in findings]))
    return 0 if all(each.held for each in findings) else 1


if __name__ == '__main__':
    sys.exit(main())
