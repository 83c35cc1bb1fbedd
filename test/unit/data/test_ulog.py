# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Flights in the logs of PX4."""

import sys

from flightmaker import flight, px4_samples, ulog, VEHICLE
import numpy as np
import pytest
from reader_checks import ALL_TOPICS, CMD, log, refused, SMALL

from quad_ident_ros.cli.main import main
import quad_ident_ros.data
from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.load import load
from quad_ident_ros.data.mapping import load_mapping, mapping_from
from quad_ident_ros.data.quality import findings

PX4 = mapping_from({'actuators': {'kind': 'pwm', 'order': [1, 4, 2, 3]}}, 'm')


def test_a_px4_log_gives_the_flight_in_enu_and_flu(tmp_path):
    pwm = 1000 + 1000 * (SMALL.stack(*CMD) - 100) / 1600
    path = log(tmp_path, ulog(px4_samples(SMALL, outputs=pwm[:, [0, 2, 3, 1]])))
    read = load(path, PX4, VEHICLE)
    assert read.info['start_ns'] == 5_000_000_000
    np.testing.assert_allclose(read.t, SMALL.t, atol=1e-12)
    for names, bound in ((('px', 'py', 'pz', 'vx', 'vy', 'vz'), 2e-7),
                         (('wx', 'wy', 'wz'), 1e-7), (('ax', 'ay', 'az'), 1e-6), (CMD, 1e-3)):
        np.testing.assert_allclose(read.stack(*names), SMALL.stack(*names), atol=bound)
    q, truth = read.stack('qw', 'qx', 'qy', 'qz'), SMALL.stack('qw', 'qx', 'qy', 'qz')
    np.testing.assert_allclose(np.abs(np.sum(q * truth, axis=1)), 1.0, atol=1e-12)


@pytest.mark.slow
def test_a_converted_px4_log_has_no_faults(tmp_path):
    """A clean flight stays one through frames, units, motor order and single precision."""
    record = flight()
    thrust = (record.stack(*CMD) ** 2 - 100 ** 2) / (1700 ** 2 - 100 ** 2)
    path = log(tmp_path, ulog(px4_samples(record, motors=thrust)))
    mapping = mapping_from({'actuators': {'kind': 'normalised', 'curve': 'thrust'}}, 'm')
    assert findings(load(path, mapping, VEHICLE), VEHICLE) == ()


def test_streams_at_other_rates_are_interpolated(tmp_path):
    outputs = 1500 + np.zeros((len(SMALL), 4))
    read = load(log(tmp_path, ulog(px4_samples(SMALL, outputs=outputs, every=4))), PX4, VEHICLE)
    assert len(read) == 97   # up to the last position
    np.testing.assert_allclose(read.columns['px'], SMALL.columns['px'][:97], atol=5e-4)
    assert np.abs(np.diff(read.columns['px'], 2)).max() > 1e-5


def test_without_a_mapping_outputs_are_kept_as_they_are(tmp_path):
    outputs = 1500 + np.arange(4) + np.zeros((len(SMALL), 4))
    read = load(log(tmp_path, ulog(px4_samples(SMALL, outputs=outputs))))
    assert not read.has('cmd1')
    np.testing.assert_array_equal(read.stack('output1', 'output4')[0], [1500, 1503])


def test_an_instance_is_chosen_by_the_mapping(tmp_path):
    samples = px4_samples(SMALL, outputs=1500 + np.zeros((len(SMALL), 4)))
    for topic, _, stamp, values in list(samples):
        if topic == 'actuator_outputs':
            samples.append((topic, 1, stamp, [*np.full(4, 1700.0), *values[4:]]))
    path = log(tmp_path, ulog(samples))
    data = {'actuators': {'kind': 'pwm'}, 'instances': {'actuator_outputs': 1}}
    second = load(path, mapping_from(data, 'm'), VEHICLE)
    assert second.columns['cmd1'][0] == pytest.approx(100 + 0.7 * 1600)
    assert load(path, PX4, VEHICLE).columns['cmd1'][0] == pytest.approx(900)
    data['instances'] = {'actuator_outputs': 3}
    refused(path, 'actuator_outputs 3', '0, 1', mapping=mapping_from(data, 'm'), vehicle=VEHICLE)


def test_bad_logs_are_refused(tmp_path):
    whole = ulog(px4_samples(SMALL, outputs=1500 + np.zeros((len(SMALL), 4))))
    refused(log(tmp_path, whole[:8]), 'cannot be read')
    refused(log(tmp_path, whole[:200]), 'vehicle_attitude')
    refused(log(tmp_path, b'ULog'), 'cannot be read')
    refused(log(tmp_path, ulog([s for s in px4_samples(SMALL) if s[0] != 'vehicle_attitude'])),
            'vehicle_attitude')
    refused(log(tmp_path, ulog(px4_samples(SMALL))), 'actuator_outputs', mapping=PX4,
            vehicle=VEHICLE)
    refused(log(tmp_path, whole), 'speeds', mapping=PX4)
    refused(log(tmp_path, whole), 'only instances and actuators',
            mapping=mapping_from(ALL_TOPICS, 'm'))


def test_without_pyulog_a_log_says_what_is_missing(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, 'pyulog', None)
    monkeypatch.delitem(sys.modules, 'quad_ident_ros.data.ulog', raising=False)
    monkeypatch.delattr(quad_ident_ros.data, 'ulog', raising=False)
    refused(log(tmp_path, ulog(px4_samples(SMALL))), 'pip install pyulog')


def test_a_log_whose_parser_would_never_end_is_refused(tmp_path):
    """An unknown message longer than the rest sends pyulog back before where it was."""
    cut = b'ULog\x01\x125\x01' + bytes(8) + b'\x00\x00\x00' * 4 + b'\xff\xff\x00' + b'ab'
    refused(log(tmp_path, cut), 'damaged')


def test_a_log_with_a_format_without_end_is_refused(tmp_path):
    formats = {'vehicle_attitude': ('uint64_t timestamp', 'vehicle_attitude[60000] q')}
    data = bytearray(ulog([], formats))
    body = b'\x00\x00\x00vehicle_attitude'
    data += len(body).to_bytes(2, 'little') + b'A' + body
    refused(log(tmp_path, bytes(data)), 'vehicle_attitude')


def test_convert_takes_mapping_and_vehicle_files(tmp_path):
    outputs = 1500 + np.zeros((len(SMALL), 4))
    path = log(tmp_path, ulog(px4_samples(SMALL, outputs=outputs)))
    (tmp_path / 'm.yaml').write_text('actuators: {kind: pwm, order: [1, 2, 3, 4]}\n')
    assert load_mapping(tmp_path / 'm.yaml').actuators.order == (1, 2, 3, 4)
    assert main(['convert', str(path), str(tmp_path / 'f.csv'), '--mapping',
                 str(tmp_path / 'm.yaml'), '--vehicle', 'paper_quadrotor']) == 0
    assert read_csv(tmp_path / 'f.csv').columns['cmd1'][0] == pytest.approx(500.0)
