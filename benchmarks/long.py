# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights of 20 minutes, as a log, a table and a bag: time and memory of info and diagnose."""

import os
from pathlib import Path
import re
import subprocess
import sys
import tempfile

import numpy as np

from benchmarks.tables import markdown, number, targets
from quad_ident_ros.model.vehicle import write_vehicle

ROOT = Path(__file__).resolve().parents[1]
MOST_INFO, MOST_DIAGNOSE = 10.0, 60.0    # s of CPU time
MOST_MEMORY = 500.0                      # MB
TRUTH = {'rotor_drag': {'coefficient': 0.15}}   # kg/s, of a vehicle of half a kilogram
RATES = {'log.ulg': 250.0, 'table.csv': 100.0, 'bag': 100.0}    # Hz of what is fastest
COURSE = 'lissajous'
MAPPING = """\
topics:
  pose: {topic: /odom}
  velocity: {topic: /odom}
  rate: {topic: /imu}
  specific_force: {topic: /imu}
  commands: {topic: /motors, field: data}
actuators: {kind: speed}
"""


def run(size, bar):
    """Return the results as Markdown; size: a Size; bar: makes progress bars."""
    rows, goals = [], []
    with tempfile.TemporaryDirectory() as folder, bar('long flights', 3 * len(RATES)) as advance:
        for name in RATES:
            # By another process: what this one takes would count as memory of those it starts.
            _spent([sys.executable, '-m', 'benchmarks.long', name, folder,
                    str(size.long_flight)], folder)
            advance()
            file = Path(folder, name)
            options = ['--vehicle', str(Path(folder, 'vehicle.yaml'))]
            if name == 'bag':
                options += ['--mapping', str(Path(folder, 'mapping.yaml'))]
            found = {}
            for command in ('info', 'diagnose'):
                found[command] = _spent([sys.executable, '-m', 'quad_ident_ros', command,
                                         str(file), *options], folder)
                advance()
            seconds, memory, verdict = zip(*found.values(), strict=True)
            rows.append((f'`{name}`, {size.long_flight / 60:.3g} min, {RATES[name]:g} Hz',
                         f'{_bytes(file) / 1e6:.0f}', *map(number, seconds),
                         *(f'{value:.0f}' for value in memory), verdict[1]))
            goals += [
                (f'`{name}`: `info`, CPU time', f'≤ {MOST_INFO:g} s', f'{number(seconds[0])} s',
                 seconds[0] <= MOST_INFO),
                (f'`{name}`: `diagnose`, CPU time', f'≤ {MOST_DIAGNOSE:g} s',
                 f'{number(seconds[1])} s', seconds[1] <= MOST_DIAGNOSE),
                (f'`{name}`: memory, the larger', f'≤ {MOST_MEMORY:g} MB',
                 f'{max(memory):.0f} MB', max(memory) <= MOST_MEMORY)]
            for path in Path(folder).glob('**/*.*'):
                if path.suffix in ('.ulg', '.csv', '.mcap'):
                    path.unlink()
    head = ('file', 'MB', 'info, CPU s', 'diagnose, CPU s', 'info, MB', 'diagnose, MB', 'effects')
    return f'{targets(goals)}\n\n{markdown(head, rows)}'


def _spent(command, folder):
    """Return CPU time s, highest memory MB and, of a diagnosis, the effects that it names."""
    out = Path(folder, 'out.txt')
    with open(out, 'wb') as file:
        process = subprocess.Popen(command, cwd=ROOT, stdout=file, stderr=subprocess.STDOUT,
                                   env={**os.environ, 'PYTHONPATH': str(ROOT)})
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    text = out.read_text(encoding='utf-8', errors='replace')
    if process.returncode:
        raise SystemExit(f'{" ".join(command)}: exit code {process.returncode}\n{text}')
    lines = [line for line in text.splitlines() if line.startswith('verdict')]
    return (usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024,
            ', '.join(re.findall(r'\((\w+)\), ', lines[0])) if lines else '')


def _bytes(path):
    return sum(file.stat().st_size for file in ([path] if path.is_file() else path.iterdir()))


def make(name, folder, seconds):
    """Fly a vehicle and write its record as a file of this name into a folder."""
    sys.path[:0] = [str(ROOT / 'test' / 'helpers')]
    from flightmaker import changed, VEHICLE

    from quad_ident_ros.data.csv import write_csv
    from quad_ident_ros.flight.fly import fly_closed_loop
    from quad_ident_ros.flight.measure import SENSORS
    write_vehicle(Path(folder, 'vehicle.yaml'), VEHICLE)
    record = fly_closed_loop(VEHICLE, TRUTH, COURSE, duration=seconds, rate=RATES[name],
                             noise=SENSORS['mocap_imu'])
    # A battery of as many flights as this one is long, beside one of four minutes.
    share = min(1.0, 240.0 / seconds)
    voltage = record.columns['vbat']
    record = changed(record, vbat=voltage[0] + share * (voltage - voltage[0]))
    if name == 'table.csv':
        write_csv(Path(folder, name), record)
    elif name == 'bag':
        Path(folder, 'mapping.yaml').write_text(MAPPING, encoding='utf-8')
        write_foreign_bag(Path(folder, name), record)
    else:
        Path(folder, name).write_bytes(px4_log(record))


def px4_log(record):
    """Return the bytes of a PX4 log of a record, all streams at its rate but the position."""
    from flightmaker import frd, ned, ned_attitude, ulog
    from px4_files import controls, FORMATS, landed, parameters, status
    stamps = np.round(record.t * 1e6).astype(int) + 5_000_000
    rates, force = frd(record.stack('wx', 'wy', 'wz')), frd(record.stack('ax', 'ay', 'az'))
    none = np.full((len(record), 8), np.nan)
    tables = {
        'vehicle_attitude': (1, ned_attitude(record.stack('qw', 'qx', 'qy', 'qz'))),
        'vehicle_angular_velocity': (1, rates), 'sensor_combined': (1, np.hstack([rates, force])),
        'actuator_motors': (1, np.hstack([controls(record), none])),
        'vehicle_local_position': (2, np.hstack([ned(record.stack('px', 'py', 'pz')),
                                                 ned(record.stack('vx', 'vy', 'vz'))])),
        'battery_status': (50, record.stack('vbat'))}
    tables = {name: (every, values.astype('<f4')) for name, (every, values) in tables.items()}

    def samples():
        yield status(stamps[0])
        yield landed(stamps[0], False)
        for k, stamp in enumerate(stamps.tolist()):
            for name, (every, values) in tables.items():
                if k % every == 0:
                    yield name, 0, stamp, values[k].tobytes()

    return ulog(samples(), FORMATS, parameters())


def write_foreign_bag(path, record):
    """Write a bag as other programs do: /odom (Odometry), /imu (Imu), /motors (an array)."""
    from flightmaker import header, world_velocity_in_body, xyz

    from quad_ident_ros.data.bag import BagWriter, serialize
    odometry, imu = 'nav_msgs/msg/Odometry', 'sensor_msgs/msg/Imu'
    array, none = 'std_msgs/msg/Float32MultiArray', np.zeros(9)
    place, body = record.stack('px', 'py', 'pz'), world_velocity_in_body(record)
    q, rate = record.stack('qw', 'qx', 'qy', 'qz'), record.stack('wx', 'wy', 'wz')
    force = record.stack('ax', 'ay', 'az')
    commands = record.stack('cmd1', 'cmd2', 'cmd3', 'cmd4').astype(np.float32)
    with BagWriter(path, [('/odom', odometry), ('/imu', imu), ('/motors', array)]) as writer:
        for k, ns in enumerate((np.round(record.t * 1e9).astype(int) + 10 ** 12).tolist()):
            turn = dict(zip('wxyz', map(float, q[k]), strict=True))
            writer.write('/odom', ns, serialize(odometry, {
                'header': header(ns), 'child_frame_id': 'base_link',
                'pose': {'pose': {'position': xyz(place[k]), 'orientation': turn},
                         'covariance': np.zeros(36)},
                'twist': {'twist': {'linear': xyz(body[k]), 'angular': xyz(rate[k])},
                          'covariance': np.zeros(36)}}))
            writer.write('/imu', ns, serialize(imu, {
                'header': header(ns), 'orientation': turn, 'orientation_covariance': none,
                'angular_velocity': xyz(rate[k]), 'angular_velocity_covariance': none,
                'linear_acceleration': xyz(force[k]), 'linear_acceleration_covariance': none}))
            writer.write('/motors', ns, serialize(array, {
                'layout': {'dim': [], 'data_offset': 0}, 'data': commands[k]}))


if __name__ == '__main__':
    make(sys.argv[1], sys.argv[2], float(sys.argv[3]))
