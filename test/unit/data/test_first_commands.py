# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What somebody types first, on each kind of file: no traceback, one line with a way out."""

from bag_files import esc_status, imu, lists, MAV, odometry, px4, write1, write2, write_old
from blackbox_files import blackbox, rows_of
from dataflash_files import copter, dataflash
from flightmaker import flight
import numpy as np
from px4_files import controls, FORMATS, log_of, parameters
import pytest
from table_files import others, table
from usd_files import crazyflie_events, usdlog

from quad_ident_ros.cli.main import main
from quad_ident_ros.data.csv import write_csv
from quad_ident_ros.data.export import save
from quad_ident_ros.data.load import load
from quad_ident_ros.data.mapping import load_mapping

FLIGHT = flight(seconds=3.0, rate=100.0)
OUTPUTS = 1500 + np.zeros((len(FLIGHT), 4)) + FLIGHT.stack('cmd1', 'cmd2', 'cmd3', 'cmd4') / 100
SPEEDS = FLIGHT.stack('cmd1', 'cmd2', 'cmd3', 'cmd4')


def parquet(path):
    pyarrow = pytest.importorskip('pyarrow', reason='pyarrow is not installed')
    from pyarrow import parquet as writer
    writer.write_table(pyarrow.table({name: pyarrow.array(values) for name, values in
                                      others(FLIGHT).items()}), path)


FILES = {
    'px4': lambda path: path.write_bytes(log_of(FLIGHT, motors=controls(FLIGHT))),
    'px4_pwm': lambda path: path.write_bytes(log_of(FLIGHT, outputs=OUTPUTS)),
    'px4_bare': lambda path: path.write_bytes(log_of(FLIGHT, formats=FORMATS, named={})),
    'px4_vtol': lambda path: path.write_bytes(log_of(
        FLIGHT, motors=controls(FLIGHT), named={**parameters(), 'MAV_TYPE': 22})),
    'ardupilot': lambda path: path.write_bytes(dataflash(copter(FLIGHT, OUTPUTS))),
    'betaflight': lambda path: path.write_bytes(blackbox(rows_of(FLIGHT, OUTPUTS))),
    'crazyflie': lambda path: path.write_bytes(usdlog(crazyflie_events(FLIGHT, 20 * OUTPUTS))),
    'ours': lambda path: write_csv(path.with_suffix('.csv'), FLIGHT),
    'our_bag': lambda path: save(path, FLIGHT),
    'ros2': lambda path: write2(path, [
        *odometry(FLIGHT), *imu(FLIGHT),
        *lists(FLIGHT, MAV, '/command/motor_speed', 'angular_velocities', SPEEDS)]),
    'ros2_two': lambda path: write2(path, [
        *odometry(FLIGHT), *odometry(FLIGHT, '/other/odom'), *imu(FLIGHT)]),
    'ros2_none': lambda path: write2(path, esc_status(FLIGHT, SPEEDS.astype(int))),
    'px4_bag': lambda path: write_old(path, px4(FLIGHT, SPEEDS / 2000)),
    'ros1': lambda path: write1(path, [*odometry(FLIGHT), *imu(FLIGHT)]),
    'table': lambda path: table(path.parent, others(FLIGHT), name=path.name),
    'table_no_time': lambda path: table(path.parent, {
        name: values for name, values in others(FLIGHT).items() if name != 'timestamp'},
        name=path.name),
    'parquet': parquet,
}


@pytest.mark.slow
@pytest.mark.parametrize('kind', FILES)
def test_what_is_typed_first_ends_in_no_traceback(tmp_path, monkeypatch, capsys, kind):
    """`info`, with a vehicle, with a mapping that it wrote itself, and `diagnose` without any."""
    path = tmp_path / kind
    FILES[kind](path)
    path = path if path.exists() else path.with_suffix('.csv')
    before = sorted(tmp_path.iterdir())

    def typed(*words):
        code = main([words[0], str(path), *words[1:]])
        out, error = capsys.readouterr()
        assert code in (0, 2, 3), (words, error)
        named = error.replace(f'{path}_vehicle.yaml', 'its vehicle file')
        assert code != 2 or (error.count('\n') == 1 and (
            named.count(str(path)) == 1 or 'its vehicle file' in named)), error
        return code, f'{out}{error}'

    code, said = typed('info')
    unread = '[unread]' in said
    assert (code == 3) == ('error: ' in said)
    assert typed('info', '--vehicle', 'iris')[0] in (0, 3)
    mapping = tmp_path / 'map.yaml'
    assert typed('info', '--write-mapping', str(mapping))[0] == code
    again, said = typed('info', '--mapping', str(mapping))
    assert again in (0, 3) and ('[unread]' in said) <= unread, said
    if kind == 'ours':      # a mapping of what says itself what it is changes nothing
        mapped = load(path, load_mapping(mapping))
        np.testing.assert_allclose(mapped.stack('t', 'qz', 'cmd2'), load(path).stack(
            't', 'qz', 'cmd2'), atol=1e-9)
    code, said = typed('diagnose')
    assert code == 2 and '--vehicle' in said
    typed('info', '--vehicle', 'auto')
    code, said = typed('diagnose', '--vehicle', 'auto')
    assert code == 2
    assert set(before) <= set(tmp_path.iterdir())
