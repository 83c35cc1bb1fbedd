# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A fleet on one worker and two, what a flight costs beside its diagnosis, and memory."""

from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
import os
from pathlib import Path
import tempfile
from time import perf_counter
from unittest.mock import patch

from benchmarks.tables import markdown, number, targets
from quad_ident_ros.cluster import cluster
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.flight.fly import fly_closed_loop
from quad_ident_ros.flight.measure import SENSORS
from quad_ident_ros.model.vehicle import load_vehicle
from quad_ident_ros.warm_up import warm_up_diagnosis

EFFICIENCY, OVERHEAD, GROWTH = 0.9, 0.02, 0.1   # share of the ideal, s of a flight, share
VEHICLE = 'hummingbird'
SECONDS = 10.0      # of a flight, at 100 Hz
LIGHT = 40          # samples of a flight that is refused at once, as too short
ONE_THREAD = {'OMP_NUM_THREADS': '1', 'OPENBLAS_NUM_THREADS': '1', 'MKL_NUM_THREADS': '1'}
"""What Dask sets for its workers, too."""
EARLY = 0.1         # share of the light flights after which memory should grow no more


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    heavy, light = size.fleet_flights, size.light_flights
    with tempfile.TemporaryDirectory() as folder, bar('fleet', 6) as advance:
        top = Path(folder)
        make(top / 'heavy', heavy)
        make_light(top / 'light', light)
        advance()
        times, plain = {}, {}
        for workers in (1, 2):
            times[workers] = timed(top / 'heavy', top / f'out_{workers}', workers)[0]
            advance()
            plain[workers] = without_dask(top / 'heavy', top / f'plain_{workers}', workers)
            advance()
        wall, memory = timed(top / 'light', top / 'out_light', 2)
        from quad_ident_ros.fleet.store import read_table
        table = read_table(top / 'out_light', 'groups', ['seconds'])
        work = sum(table['seconds'].to_pylist()) / light
        stored = {name: bytes_in(top / name) / count for name, count in
                  (('out_1', heavy), ('out_light', light))}
        advance()
    share, limit = (each[1] / (2.0 * each[2]) for each in (times, plain))
    overhead = wall / light
    growth = {who: after / before - 1.0 for who, (before, after) in memory.items()}
    goals = [
        (f'from one worker to two, {heavy} flights of {SECONDS:g} s: share of the ideal',
         f'≥ {100 * EFFICIENCY:.0f} %', f'{100 * share:.1f} %', share >= EFFICIENCY),
        (f'time for each of {light:,} light flights', f'≤ {1e3 * OVERHEAD:.0f} ms',
         f'{1e3 * overhead:.1f} ms', overhead <= OVERHEAD),
        *((f'memory of the {who}, from {int(EARLY * light):,} to {light:,} light flights',
           f'≤ + {100 * GROWTH:.0f} %', f'{100 * growth[who]:+.1f} %', growth[who] <= GROWTH)
          for who in memory)]
    rows = [
        ('one worker: s for each flight', number(times[1] / heavy)),
        ('two workers: s for each flight', number(times[2] / heavy)),
        ('the diagnoses alone, in one process without Dask: s for each', number(plain[1] / heavy)),
        ('the same in two processes', number(plain[2] / heavy)),
        ('share of the ideal that two processes without Dask reach', f'{100 * limit:.1f} %'),
        ('light flights: ms of each that are the work of a worker', number(1e3 * work)),
        ('kB on disk for each flight, in a group of its own', number(stored['out_1'] / 1e3)),
        ('kB on disk for each light flight', number(stored['out_light'] / 1e3)),
        *((f'memory of the {who}, MB', ' to '.join(f'{value:.0f}' for value in both))
          for who, both in memory.items())]
    return f'{targets(goals)}\n\n{markdown(("what", "measured"), rows)}'


def timed(flights, out, workers):
    """Return s of a run on so many workers, and {who: MB (early, at the end)}."""
    from quad_ident_ros.fleet.plan import planned
    from quad_ident_ros.fleet.run import DIAGNOSING, run_fleet
    seen = {}
    with cluster(workers=workers) as client:
        client.run(warm_up_diagnosis)

        def tell(progress):
            if (progress.stage == DIAGNOSING and not seen
                    and progress.done >= EARLY * progress.total):
                seen.update(resident(client))

        begun = perf_counter()
        run_fleet(client, planned([str(flights)], vehicle=VEHICLE), out, tell=tell)
        seconds = perf_counter() - begun
        after = resident(client)
    return seconds, {who: (seen[who], after[who]) for who in after}


def without_dask(flights, out, processes):
    """Return s of the diagnoses alone in processes that share nothing but the machine."""
    from quad_ident_ros.fleet.grouping import groups_of
    from quad_ident_ros.fleet.look import look
    from quad_ident_ros.fleet.plan import planned
    from quad_ident_ros.fleet.store import prepare
    from quad_ident_ros.fleet.work import work
    plan = planned([str(flights)], vehicle=VEHICLE)
    looked = [look(one, plan.mapping) for one in plan.flights]
    groups, _ = groups_of(zip(plan.flights, looked, strict=True), plan.nominal_of, plan.mapping,
                          plan.rules)
    prepare(out)
    apart = get_context('spawn')
    with patch.dict(os.environ, ONE_THREAD), ProcessPoolExecutor(
            processes, apart, _warm_together, [apart.Barrier(processes)]) as pool:
        for started in [pool.submit(int) for _ in range(processes)]:    # one process each
            started.result()
        begun = perf_counter()
        list(pool.map(partial(work, out=out), groups))
        return perf_counter() - begun


def _warm_together(everyone):
    warm_up_diagnosis()
    everyone.wait()


def resident(client):
    """Return {who: MB} of the command with its scheduler and of the largest worker."""
    return {'command': _resident(), 'largest worker': max(client.run(_resident).values())}


def _resident():
    import psutil  # comes with Dask
    return psutil.Process().memory_info().rss / 1e6


def make(folder, count):
    """Fly as many vehicles, each once."""
    vehicle = load_vehicle(VEHICLE)
    for seed in range(count):
        write_csv(folder / f'vehicle_{seed}' / 'flight.csv', fly_closed_loop(
            vehicle, {'rotor_drag': {'coefficient': 0.2}}, 'lissajous', duration=SECONDS,
            seed=seed, noise=SENSORS['mocap_imu']))


def make_light(folder, count):
    """Write as many flights that are too short, each of a vehicle and content of its own."""
    record = fly_closed_loop(load_vehicle(VEHICLE), {}, 'hover', duration=SECONDS).slice(0, LIGHT)
    write_csv(folder / 'first.csv', record)
    text = (folder / 'first.csv').read_text(encoding='utf-8')
    (folder / 'first.csv').unlink()
    for number_of_it in range(count):
        place = folder / f'vehicle_{number_of_it}' / '2026-05-14'
        place.mkdir(parents=True)
        lines = text.splitlines(keepends=True)
        # One sample less or more at another place makes another content.
        del lines[1 + number_of_it % (len(lines) - 2)]
        (place / f'{number_of_it}.csv').write_text(
            ''.join(lines) + f'# {number_of_it}\n', encoding='utf-8')


def bytes_in(folder):
    """Return the bytes that the files of a folder take on the disk."""
    return sum(512 * path.stat().st_blocks for path in folder.rglob('*') if path.is_file())
