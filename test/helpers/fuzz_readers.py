# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Fuzz the readers: mutated files of every format, each within limits of time and memory.

  PYTHONPATH=. .venv/bin/python test/helpers/fuzz_readers.py --inputs 20000    # of each format

Every input is read by a process of its own kind that the system ends where it takes too long: what
is in it, as `info` shows it, and its flights. An input is refused (one line that names the file),
read, or a failure; failures are kept in --keep. A folder in memory makes it faster (TMPDIR).
"""

import argparse
from collections import Counter
from copy import deepcopy
from dataclasses import replace
from functools import lru_cache
import gzip
import json
from pathlib import Path
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings

from bag_files import esc_status, imu, lists, MAV, odometry, px4, transforms, write1, write_old
from blackbox_files import blackbox, rows_of
from dataflash_files import copter, dataflash
from flightmaker import copy_bag, flight, others_bag, px4_samples, ulog, VEHICLE
import numpy as np
from px4_files import controls, esc, landed, log_of, parameters, status
from rich.progress import Progress
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from ruamel.yaml import YAML
from table_files import others, table
from usd_files import crazyflie_events, usdlog

from quad_ident_ros import resources
from quad_ident_ros.data.export import save, write_bag
from quad_ident_ros.data.load import contents_of, load_all
from quad_ident_ros.data.mapping import load_mapping, mapping_from
from quad_ident_ros.data.record import FlightRecord, QUATERNION
from quad_ident_ros.data.topics import EXACT_TOPIC
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import load_experiment
from quad_ident_ros.model.vehicle import load_vehicle, vehicle_text
from quad_ident_ros.vehicle_files.load import load_any_vehicle
from quad_ident_ros.vehicle_files.targets import TARGETS

SECONDS = 10        # of computing for one input
WAITING = 300       # s for one input in all: a busy machine is no hang
MEGABYTES = 1024    # for one input, beyond what the process has when it begins
AT_ONCE = 10_000    # inputs of one process, which takes seconds to start
NAMES = {'csv': 'f.csv', 'csv_gz': 'f.csv.gz', 'mcap': 'f.mcap', 'mcap_topics': 'f.mcap',
         'mcap_mapped': 'f.mcap', 'sqlite3': 'f.db3', 'metadata': 'bag', 'ulog': 'f.ulg',
         'crazyflie': 'log00', 'ardupilot': 'f.BIN', 'betaflight': 'f.bbl',
         'px4': 'f.ulg', 'table': 'f.csv', 'table_mapped': 'f.csv', 'parquet': 'f.parquet',
         'mapping': 'f.yaml', 'ros1': 'f.bag', 'ros1_lz4': 'f.bag', 'px4_bag': 'f.db3',
         'transforms': 'f.bag', 'vehicle': 'f.yaml', 'experiment': 'f.yaml', 'gazebo': 'f.sdf',
         'mujoco': 'f.xml', 'urdf': 'f.urdf', 'rotorpy': 'f.py', 'crazyflow': 'f.toml',
         'px4_sih': 'f.params'}
"""File that each kind of input is written to."""
DESCRIPTIONS = ('vehicle', 'experiment', *TARGETS)
"""Kinds that are no flights."""

TOPICS = mapping_from({'topics': {
    'pose': {'topic': '/odom'}, 'velocity': {'topic': '/odom'}, 'rate': {'topic': '/imu'},
    'specific_force': {'topic': '/imu'}, 'commands': {'topic': '/motors'}}}, 'mapping')
OUTPUTS = mapping_from({'actuators': {'kind': 'pwm', 'order': [1, 3, 4, 2]}}, 'mapping')
COLUMNS = mapping_from({'actuators': {'kind': 'pwm'}, 'columns': {
    't': {'column': 'timestamp', 'unit': 'us'}, 'q': ['q_w', 'q_x', 'q_y', 'q_z'],
    'px': {'column': 'pos_x', 'unit': 'mm'}, 'py': 'pos_y', 'pz': 'pos_z',
    'vx': {'column': 'vel_x', 'frame': 'body'}, 'vy': 'vel_y', 'vz': 'vel_z',
    'wx': 'gyro_x', 'wy': 'gyro_y', 'wz': 'gyro_z', 'output1': 'm1', 'output2': 'm2',
    'output3': 'm3', 'output4': 'm4', 'vbat': 'vbat'}}, 'mapping')
MAPPING = """\
world: NED
topics:
  pose: {topic: /odom}
  velocity: {topic: /odom, frame: world}
  commands: {topic: /motors, field: data}
instances: {actuator_outputs: 1}
actuators:
  {order: [1, 3, 4, 2], kind: pwm, minimum: 1e3, maximum: 2000, speeds: [0, 9e2], curve: thrust}
"""


def valid_inputs(folder):
    """Return the bytes of a small valid input of each kind."""
    record = flight(seconds=0.12, noise=0.0)
    outputs = 1500 + np.zeros((len(record), 4))
    found = {}
    for kind in ('csv', 'csv_gz', 'mcap'):
        save(folder / NAMES[kind], record)
        found[kind] = (folder / NAMES[kind]).read_bytes()
    found['mcap'] = _without_checksums(found['mcap'])
    write_bag(folder / 'ours', record)
    others_bag(folder / 'others', record, outputs)
    found['mcap_topics'] = _mcap(folder, 'topics', folder / 'ours', {EXACT_TOPIC})
    found['mcap_mapped'] = _without_checksums(next((folder / 'others').glob('*.mcap'))
                                              .read_bytes())
    copy_bag(folder / 'ours', folder / 'sql', StoragePlugin.SQLITE3, {EXACT_TOPIC})
    found['sqlite3'] = next((folder / 'sql').glob('*.db3')).read_bytes()
    # Two topics: the time goes by the length of the text, and each further topic has the same.
    poses = {name: record.columns[name] for name in ('px', 'py', 'pz', *QUATERNION)}
    write_bag(folder / 'poses', FlightRecord(record.t, poses, record.info))
    found['metadata'] = (folder / 'poses' / 'metadata.yaml').read_bytes()
    found['ulog'] = ulog(px4_samples(record, outputs=outputs, motors=0 * outputs))
    found['crazyflie'] = usdlog(crazyflie_events(record, 20 * outputs))
    found['ardupilot'] = dataflash(copter(record, outputs))
    found['betaflight'] = blackbox(rows_of(record, outputs))
    first = 5_000_000
    found['px4'] = log_of(record, [
        status(first), landed(first, True), landed(first + 20_000, False),
        esc(first + 1000, [500.0] * 4), esc(first + 90_000, [500.0] * 4)],
        motors=controls(record), named=parameters(THR_MDL_FAC=0.3))
    found['table'] = table(folder, others(record), separator=';', comma=True).read_bytes()
    found['table_mapped'] = table(folder, others(record)).read_bytes()
    found['parquet'] = _parquet(folder, record)
    found['mapping'] = MAPPING.encode()
    return found | _bags(folder, record)


def valid_descriptions():
    """Return the bytes of a valid vehicle file of each kind, and of an experiment."""
    effects = {'rotor_drag': {'coefficient': 0.2}, 'motor_lag': {'time_constant': 0.03}}
    whole = replace(load_vehicle('iris'), effects=effects)
    shipped = resources.find('experiments', 'payload_in_flight')
    return {'vehicle': vehicle_text(whole).encode(), 'experiment': shipped.read_bytes(),
            **{name: target.new(load_vehicle('iris')).encode()
               for name, target in TARGETS.items()}}


def _bags(folder, record):
    """Return the bytes of bags of ROS 1, and of one with px4_msgs but without definitions."""
    speeds = record.stack('cmd1', 'cmd2', 'cmd3', 'cmd4')
    rows = [*odometry(record), *imu(record), *transforms(record, ['a']),
            *esc_status(record, speeds.astype(int)),
            *lists(record, MAV, '/command/motor_speed', 'angular_velocities', speeds)]
    return {'ros1': write1(folder / 'plain', rows).read_bytes(),
            'ros1_lz4': write1(folder / 'lz4', rows, Writer1.CompressionFormat.LZ4).read_bytes(),
            'transforms': write1(folder / 'tf', _chain(record)).read_bytes(),
            'px4_bag': write_old(folder / 'px4', px4(record, speeds / 2000)).read_bytes()}


def _chain(record):
    """Return messages of transforms along a chain, of which the upper one comes more seldom."""
    upper = [(topic, kind, ns, {'transforms': [
        {**one, 'child_frame_id': 'odom'} for one in fields['transforms']]})
        for topic, kind, ns, fields in transforms(record, ['odom'])[::3]]
    lower = [(topic, kind, ns, {'transforms': [
        {**one, 'header': {**one['header'], 'frame_id': 'odom'}} for one in fields['transforms']]})
        for topic, kind, ns, fields in transforms(record, ['base_link'])]
    fixed = [('/tf_static', kind, ns, {'transforms': [
        {**one, 'header': {**one['header'], 'frame_id': 'world'}, 'child_frame_id': 'map'}
        for one in fields['transforms']]}) for _, kind, ns, fields in upper[:1]]
    return [*fixed, *sorted([*upper, *lower], key=lambda one: one[2]), *imu(record)]


def _parquet(folder, record):
    import pyarrow
    from pyarrow import parquet
    parquet.write_table(pyarrow.table({name: pyarrow.array(values) for name, values in
                                       others(record).items()}), folder / 'p.parquet')
    return (folder / 'p.parquet').read_bytes()


def _mcap(folder, name, source, left_out):
    copy_bag(source, folder / name, StoragePlugin.MCAP, left_out)
    return _without_checksums(next((folder / name).glob('*.mcap')).read_bytes())


def _without_checksums(data):
    """Return an MCAP file whose chunks say that they have none, so that mutations get further."""
    data, at = bytearray(data), 8
    while at + 9 <= len(data) - 8:
        size = int.from_bytes(data[at + 1:at + 9], 'little')
        if data[at] == 0x06:
            data[at + 33:at + 37] = bytes(4)
        at += 9 + size
    return bytes(data)


SPECIAL = (b'nan', b'inf', b'-', b',', b'\n', b'"', b'1e999', b'\0', b'\xff' * 4, b'\xff' * 8,
           b'\x7f' + b'\xff' * 3, bytes(8), b'[65535]', b': ', b'[', b'{', b'!!', b'&a ', b'*a',
           b'uint64_t', b'9' * 30, b'\x80', b'\xe2\x80\xa8', b'qw')


def mutate(data, chance, others):
    """Return a mutated copy of bytes: a few random changes of the kinds that parsers trip over."""
    data = bytearray(data)
    for _ in range(chance.choice((1, 1, 1, 2, 3, 8))):
        at = chance.randrange(len(data) + 1)
        size = chance.choice((1, 2, 4, 8, 30, 200))
        what = chance.randrange(9)
        if what == 0 and data:
            data[at % len(data)] ^= 1 << chance.randrange(8)
        elif what == 1:
            data[at:at + 1] = bytes([chance.randrange(256)])
        elif what == 2:
            special = chance.choice(SPECIAL)
            data[at:at + len(special)] = special
        elif what == 3:
            data[at:at] = chance.choice(SPECIAL)
        elif what == 4:
            del data[at:at + size]
        elif what == 5:
            data[at:at] = data[at:at + size] * chance.choice((1, 2, 20))
        elif what == 6:
            width = chance.choice((1, 2, 4, 8))
            number = chance.choice((0, 1, 2 ** (8 * width) - 1, 2 ** (8 * width - 1),
                                    chance.randrange(2 ** (8 * width))))
            data[at:at + width] = number.to_bytes(width, 'little')
        elif what == 7 and chance.random() < 0.3:
            del data[at:]
        else:
            other = chance.choice(others)
            begin = chance.randrange(len(other))
            data[at:at + size] = other[begin:begin + size]
    return bytes(data)


def readings(kind, path):
    """Yield what reads an input of a kind: its contents, and its flights; or the one reader."""
    if kind in DESCRIPTIONS:
        yield lambda: (load_experiment if kind == 'experiment' else load_any_vehicle)(path)
        return
    if kind == 'mapping':
        yield lambda: load_mapping(path)
        return
    mapping = {'mcap_mapped': TOPICS, 'table_mapped': COLUMNS, 'ulog': OUTPUTS,
               'crazyflie': OUTPUTS, 'ardupilot': OUTPUTS, 'betaflight': OUTPUTS}.get(kind)
    yield lambda: contents_of(path)
    yield lambda: load_all(path, mapping, VEHICLE)


def parse_yaml_once():
    """
    Let rosbags parse a text of YAML once, though it does so whenever a bag is opened.

    Most inputs of MCAP have the QoS of the valid file, and those of metadata.yaml are opened
    several times: this was nine tenths of the time.
    """
    load = YAML.load
    parse = lru_cache(maxsize=64)(lambda text: load(YAML(typ='safe'), text))
    YAML.load = lambda _, text: deepcopy(parse(text))


def work(kind, first, count, seed, keep):
    """Read inputs first..first + count - 1 of a kind; print a line of JSON for each."""
    warnings.simplefilter('error')
    parse_yaml_once()
    base = _peak()
    limit = int((base + MEGABYTES) * 2 ** 20) + _virtual()
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        valid = valid_descriptions() if kind in DESCRIPTIONS else valid_inputs(folder)
        path = folder / NAMES[kind]
        if kind == 'metadata':
            path.mkdir()
            for file in (folder / 'poses').glob('*.mcap'):
                (path / file.name).write_bytes(file.read_bytes())
        for number in range(first, first + count):
            chance = random.Random(f'{seed} {kind} {number}')
            packed = kind == 'csv_gz' and chance.random() < 0.8
            data = mutate(valid['csv' if packed else kind], chance, list(valid.values()))
            if packed:   # a change inside, which the checksum does not give away
                data = gzip.compress(data, 1)
            (path / 'metadata.yaml' if kind == 'metadata' else path).write_bytes(data)
            print(json.dumps({'begun': number}), flush=True)
            outcome, text, took, peak = attempt(kind, path)
            if outcome not in ('refused', 'read') and keep:
                Path(keep).mkdir(parents=True, exist_ok=True)
                (Path(keep) / f'{kind}_{number}').write_bytes(data)
            print(json.dumps({'number': number, 'outcome': outcome, 'text': text, 'took': took,
                              'peak': peak}), flush=True)


def attempt(kind, path):
    """Return outcome, text, seconds and MB over the start of reading one input."""
    before = _reset_peak()
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    signal.alarm(WAITING)
    began = time.process_time()
    outcome, text = 'read', ''
    for reading in readings(kind, path):
        try:
            reading()
        except InputError as error:
            text = str(error)
            outcome = 'refused' if good(text, path) else 'no good line'
        except BaseException:
            outcome, text = 'traceback', traceback.format_exc()
        if outcome not in ('read', 'refused'):
            break
    took = time.process_time() - began
    signal.setitimer(signal.ITIMER_PROF, 0)
    signal.alarm(0)
    return outcome, text if outcome != 'read' else '', took, _peak() - before


def good(text, path):
    """Return whether the text of an error is one line that names the file, once."""
    return len(text.splitlines()) == 1 and text.count(str(path)) == 1 and len(text) < 1000


def _status(name):
    for line in Path('/proc/self/status').read_text().splitlines():
        if line.startswith(name):
            return int(line.split()[1]) / 1024
    return 0.0


def _peak():
    return _status('VmHWM')


def _virtual():
    return int(_status('VmSize') * 2 ** 20)


def _reset_peak():
    """Reset the peak to what the process has now, and return that in MB."""
    Path('/proc/self/clear_refs').write_text('5')
    return _status('VmRSS')


def fuzz(kind, count, seed, keep, advance):
    """Return the account of one kind: outcomes, slowest s, largest MB, and failures."""
    outcomes, slowest, largest, failures = Counter(), 0.0, 0.0, []
    number = 0
    while number < count:
        worker = subprocess.Popen(
            [sys.executable, __file__, '--work', kind, str(number),
             str(min(count - number, AT_ONCE)), '--seed', str(seed), '--keep', keep],
            stdout=subprocess.PIPE, text=True)
        end = number + min(count - number, AT_ONCE)
        begun = None
        for line in worker.stdout:
            data = json.loads(line)
            if 'begun' in data:
                begun = data['begun']
                continue
            begun, number = None, data['number'] + 1
            outcomes[data['outcome']] += 1
            slowest, largest = max(slowest, data['took']), max(largest, data['peak'])
            if data['outcome'] not in ('refused', 'read'):
                failures.append({'kind': kind, 'number': data['number'], 'text': data['text']})
            advance()
        code = worker.wait()
        if begun is not None:
            name = 'hang' if -code in (signal.SIGALRM, signal.SIGPROF) else 'crash'
            outcomes[name] += 1
            failures.append({'kind': kind, 'number': begun, 'text': f'{name}, code {code}'})
            number = begun + 1
            advance()
        elif number < end:
            raise SystemExit(f'{kind}: the process that reads ended with code {code}')
    return {'inputs': count, **{name: outcomes[name] for name in
                                ('refused', 'read', 'traceback', 'no good line', 'hang',
                                 'crash')}, 'slowest_s': slowest, 'largest_MB': largest}, failures


def main():
    """Fuzz all kinds and print the table."""
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--inputs', type=int, default=1000, help='of each kind (default 1000)')
    parser.add_argument('--seed', type=int, default=0)
    parser.add_argument('--kind', action='append', choices=tuple(NAMES), help='default: all')
    parser.add_argument('--keep', default='', metavar='FOLDER', help='keep inputs that fail here')
    parser.add_argument('--json', metavar='FILE', help='write the account and failures as data')
    parser.add_argument('--work', nargs=3, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.work:
        kind, first, count = options.work
        work(kind, int(first), int(count), options.seed, options.keep)
        return
    kinds = options.kind or list(NAMES)
    account, failures = {}, []
    with Progress(disable=not sys.stderr.isatty(), transient=True) as bar:
        task = bar.add_task('fuzzing', total=len(kinds) * options.inputs)
        for kind in kinds:
            account[kind], failed = fuzz(kind, options.inputs, options.seed, options.keep,
                                         lambda: bar.advance(task))
            failures += failed
            if options.json:
                Path(options.json).write_text(json.dumps(
                    {'account': account, 'failures': failures}, indent=2) + '\n')
    columns = ('inputs', 'refused', 'read', 'traceback', 'no good line', 'hang', 'crash',
               'slowest_s', 'largest_MB')
    print(f'| format | {" | ".join(columns)} |\n| --- |{" --: |" * len(columns)}')
    for kind, row in account.items():
        cells = (f'{row[name]:,}' if isinstance(row[name], int) else f'{row[name]:.2f}'
                 for name in columns)
        print(f'| `{kind}` | {" | ".join(cells)} |')
    for failure in failures[:20]:
        print(f'{failure["kind"]} {failure["number"]}: {failure["text"][-400:]}')


if __name__ == '__main__':
    main()
