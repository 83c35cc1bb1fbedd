# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Input that attacked the programs: each is read, or refused in one line that loses no text."""

import json
import time
import tracemalloc

from flightmaker import flight, VEHICLE
import numpy as np
import pytest

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.differentiated import with_motion
from quad_ident_ros.data.quality import findings
from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.data.split import jumps
from quad_ident_ros.model.vehicle import write_vehicle
from quad_ident_ros.report.data import write_json

FLIGHT = flight()


def stamped(t):
    """Return the flight with other stamps (N,), its values stretched over them."""
    share = np.linspace(0.0, 1.0, len(t))
    given = np.linspace(0.0, 1.0, len(FLIGHT))
    return FlightRecord(t, {name: np.interp(share, given, values)
                            for name, values in FLIGHT.columns.items()})


def bursts(count, of=10, apart=1e-6, silence=0.1):
    """Return stamps (N,) s of samples that come several at once."""
    k = np.arange(count)
    return (k // of) * silence + (k % of) * apart


def checked(record):
    """Return codes of the findings on a record, and bytes that they take."""
    tracemalloc.start()
    codes = [finding.code for finding in findings(record, VEHICLE)]
    jumps(record)
    with_motion(FlightRecord(record.t, {name: values for name, values in record.columns.items()
                                        if name[0] not in 'vw'}))
    memory = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return codes, memory


@pytest.mark.slow
@pytest.mark.parametrize('t', [
    bursts(1200), bursts(1200, apart=1e-10), bursts(1200, of=100), bursts(1200, apart=2e-5),
    1e-9 * np.arange(1200), 1e-6 * np.arange(1200),
    np.append(0.01 * np.arange(1199), 1e9), np.sort(np.append(
        1e-9 * np.arange(600), 1.0 + 0.01 * np.arange(600)))],
    ids=['us', 'ps', 'hundred', '20 us', 'dense', '1 MHz', 'one far', 'half'])
def test_bursty_and_dense_stamps_take_little_memory(t):
    # The first of these took minutes and 3 GB, the second asked for 28 GiB.
    assert checked(stamped(t))[1] < 2e8


@pytest.mark.slow
def test_memory_of_the_checks_grows_with_the_rows():
    some, many = (checked(stamped(bursts(count)))[1] for count in (1000, 4000))
    assert many < 2 * 4 * some


@pytest.mark.slow
def test_time_of_the_checks_grows_with_the_rows():
    def took(count):
        record, times = stamped(bursts(count)), []
        for _ in range(3):
            begin = time.process_time()
            findings(record, VEHICLE)
            jumps(record)
            times.append(time.process_time() - begin)
        return min(times)

    # Sixteen times, where it grows with the square: what took minutes. Some of it is for any row.
    assert took(40_000) < 2 * 4 * took(10_000)


@pytest.mark.slow
def test_bursts_are_told_and_gaps_and_even_samples_are_none():
    assert 'bursts' in checked(stamped(bursts(1200)))[0]
    assert 'bursts' not in checked(FLIGHT)[0]


@pytest.mark.slow
@pytest.mark.parametrize('rows', [60, 99, 150, 600])
def test_pauses_between_takes_are_gaps_and_no_bursts(rows):
    for count in (2 * rows, 8 * rows):
        paused = 0.01 * np.arange(count) + 11.0 * (np.arange(count) // rows)
        codes, _ = checked(stamped(paused))
        assert 'gap' in codes and 'bursts' not in codes


def run(capsys, *words):
    """Run a command; return its exit code, what it printed, and its one line of error."""
    code = main(list(map(str, words)))
    out, error = capsys.readouterr()
    assert error.count('\n') == (1 if code == 2 else 0)
    return code, out, error


NAMES = ['[/]', '[bold]x', ':smile:', r'\[/]', '$x_{$', '[red]y[/red]']


@pytest.mark.slow
def test_names_with_markup_are_shown_as_they_are(tmp_path, capsys):
    folder = tmp_path / '['
    folder.mkdir()
    path = folder / '] :smile: [bold]$x_{$.csv'
    write_csv(path, FlightRecord(FLIGHT.t, {**FLIGHT.columns, **dict.fromkeys(NAMES, FLIGHT.t)}))
    code, out, _ = run(capsys, 'info', path, '--vehicle', 'paper_quadrotor')
    assert code in (0, 3) and str(path) in out.replace('\n', '')
    table = [line.split()[0] for line in out.splitlines() if line.strip()]
    assert set(NAMES) <= set(table)


@pytest.mark.slow
def test_a_json_file_has_null_for_what_is_no_number(tmp_path, capsys):
    write_json(tmp_path / 'x.json', {'a': [np.inf, (1.0, float('nan'))], 'b': np.float64('-inf')})
    assert json.loads((tmp_path / 'x.json').read_text()) == {'a': [None, [1.0, None]], 'b': None}
    columns = {**FLIGHT.columns, 'extra': np.full(len(FLIGHT), np.inf),
               'none': np.full(len(FLIGHT), np.nan)}
    write_csv(tmp_path / 'f.csv', FlightRecord(FLIGHT.t, columns))
    code, out, _ = run(capsys, 'info', tmp_path / 'f.csv', '--json', '-')
    assert code in (0, 3) and 'Infinity' not in out and 'NaN' not in out
    json.loads(out)


def test_a_flight_of_some_milliseconds_is_refused_in_a_line(tmp_path, capsys):
    short = FlightRecord(1e-3 * np.arange(7), {name: values[:7] for name, values in
                                               FLIGHT.columns.items()})
    write_csv(tmp_path / 'f.csv', short)
    quad = tmp_path / 'quad.yaml'
    write_vehicle(quad, VEHICLE)
    for words in (['fit', '--free', 'inertia'], ['diagnose'], ['identify']):
        code, _, error = run(capsys, words[0], tmp_path / 'f.csv', *words[1:], '--vehicle',
                             quad)
        assert code == 2 and ('too short' in error or 'at least' in error)


@pytest.mark.parametrize('factor', [0.0, 1e300], ids=['zeros', 'huge'])
@pytest.mark.parametrize('words', [['info'], ['fit', '--free', 'inertia'], ['diagnose']],
                         ids=' '.join)
def test_zeros_and_huge_values_are_refused_in_a_line(tmp_path, capsys, factor, words):
    names = FLIGHT.columns if factor == 0.0 else ('px', 'vx')
    write_csv(tmp_path / 'f.csv', FlightRecord(FLIGHT.t, {
        name: values * factor if name in names else values
        for name, values in FLIGHT.columns.items()}))
    code, _, _ = run(capsys, words[0], tmp_path / 'f.csv', *words[1:], '--vehicle',
                     'paper_quadrotor')
    assert code == (3 if words == ['info'] else 2)
