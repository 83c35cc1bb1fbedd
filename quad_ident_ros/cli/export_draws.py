# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""`quad_ident export --randomise`: vehicles as far apart as flights leave one open."""

import argparse
from pathlib import Path

from quad_ident_ros import schema
from quad_ident_ros.cli.options import flights_with_bar
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import Vehicle
from quad_ident_ros.report.data import write_json
from quad_ident_ros.report.draws import rows_of, show_draws
from quad_ident_ros.report.export import show_fates
from quad_ident_ros.report.screen import console, progress_bar, say
from quad_ident_ros.vehicle_files.draws import draw
from quad_ident_ros.vehicle_files.export import export, mean_left
from quad_ident_ros.vehicle_files.source import Source
from quad_ident_ros.vehicle_files.write_draws import ARRAY, check_place, write_array, write_folder


def run_draws(options: argparse.Namespace, vehicle: Vehicle, source: Source | None) -> None:
    """Draw vehicles, write them, and show in which numbers they differ; raises InputError."""
    count = schema.integer('--randomise', options.randomise, 1)
    seed = schema.integer('--seed', options.seed or 0, 0)
    array = Path(options.output).suffix == ARRAY
    if array and (options.to or options.flight):
        raise InputError(f'{options.output}: an array has the numbers of the vehicle, whatever '
                         'the simulator; leave --to, --base and --flight out, or name a folder')
    if options.to is None and (source is not None or options.flight):
        raise InputError('--to is missing: --base and --flight are for files of a simulator')
    check_place(options.output)
    with progress_bar() as bar:
        task = bar.add_task('', total=None)
        records = flights_with_bar(options.flight or [], vehicle, bar, task)
        sag = mean_left(vehicle, records) if records else None
        middle = None if options.to is None else export(vehicle, options.to, source, sag)

        def tell(share: float) -> None:
            bar.update(task, total=1.0, completed=share)

        bar.update(task, description='drawing vehicles')
        draws = draw(vehicle, count, seed, tell)
        bar.update(task, description=f'writing {options.output}', completed=0.0)
        if array:
            write_array(options.output, draws, tell)
            files = [Path(options.output).name]
        else:
            files = write_folder(options.output, draws, options.to, source, records, tell)
    if options.json != '-':
        show_draws(draws)
        if middle is not None:
            show_fates(middle)
        several = f'{files[0]} to {files[-1]}' if len(files) > 1 else files[0]
        say(console(), f'{options.output}: {count} vehicle{"s" * (count != 1)}'
                       + ('' if array else f', {several}') + f'; seed {seed}')
    if options.json:
        write_json(options.json, {
            'schema': 'quad_ident/draws/1', 'vehicle': options.vehicle, 'to': options.to,
            'base': options.base, 'output': options.output, 'files': files, 'count': count,
            'seed': seed, 'numbers': rows_of(draws), 'cut': draws.cut,
            'cut_because': draws.why or None})
