# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The diagnosing process: it is given a folder of flights and knows nothing else of them."""

import json
from pathlib import Path
import sys
import time

from quad_ident_ros.cluster import cluster, results
from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.diagnose.diagnosis import diagnose
from quad_ident_ros.errors import InputError
from quad_ident_ros.model.vehicle import load_vehicle


def diagnosis_of(folder):
    """
    Return the diagnosis (JSON) of the case in a folder; raises InputError where it is refused.

    All that the check knows of the library: the very function that the command line calls.
    """
    vehicle = load_vehicle(str(folder / 'vehicle.yaml'))
    records = [read_csv(path) for path in sorted(folder.glob('flight_*.csv'))]
    return diagnose(records, vehicle).as_data()


def write_diagnosis(folder: Path, target: Path) -> None:
    """Diagnose the case in a folder and write the answer into a file."""
    begin = time.process_time()
    try:
        data = diagnosis_of(folder)
    except InputError as error:
        data = {'refused': str(error)}
    except Exception as error:
        # A failure is a result too: it counts as wrong.
        data = {'failed': f'{type(error).__name__}: {error}'}
    data['seconds'] = time.process_time() - begin
    target.write_text(json.dumps(data), encoding='utf-8')


def main(flights, found, jobs='1'):
    """Diagnose every case in the folder `flights` and write {its name}.json into `found`."""
    folders = sorted(path for path in Path(flights).iterdir() if path.is_dir())
    every = [(folder, Path(found) / f'{folder.name}.json') for folder in folders]
    with cluster(workers=int(jobs)) as client:
        for done in results(client, _write, (one for one in every if not one[1].exists())):
            if done.error is not None:
                raise done.error
            print('done', flush=True)


def _write(one: tuple[Path, Path]) -> None:
    write_diagnosis(*one)


if __name__ == '__main__':
    from withheld import blind  # by the name that workers import it by
    blind.main(*sys.argv[1:])
