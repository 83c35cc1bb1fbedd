# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Known truths through simulator, recorder and identifier, in one process and in three."""


from diagnostic_msgs.msg import DiagnosticArray
from graph import DEADLINE, STREAMS
import numpy as np
import pytest
from std_msgs.msg import Float64MultiArray, String

from quad_ident_ros import __version__
from quad_ident_ros.data.csv import read_csv
from quad_ident_ros.data.replay import read_bag
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.result import parameter_table
from quad_ident_ros.identify.signals import OUTPUTS
from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.qos import latched, LOSSLESS
from quad_ident_ros.nodes.recorder import Recorder
from quad_ident_ros.nodes.simulator import Simulator

SEED = 3
# K of hover_single_axis per unit of input, by an independent optimisation; z is 1/m exactly.
GAINS = {'phi': 35.41, 'theta': 35.41, 'psi': 1091.0, 'z': 1 / 0.65}
TOLERANCE = {'phi': 0.005, 'theta': 0.005, 'psi': 0.01, 'z': 0.001}


def table_of(message):
    """Return the 4 x 3 table of a message as any user of the layout reads it."""
    rows, columns = message.layout.dim
    assert message.layout.data_offset == 0
    assert (rows.label, rows.size, rows.stride) == ('phi,theta,psi,z', 4, 12)
    assert (columns.label, columns.size, columns.stride) == ('K,a,b', 3, 3)
    return np.array([[message.data[i * columns.stride + j] for j in range(columns.size)]
                     for i in range(rows.size)])


def by_library(noise=None, vehicle=None, **settings):
    experiment = load_experiment('hover_single_axis', vehicle)
    records = [fly(experiment, run, noise=noise, seed=SEED).record for run in experiment.runs]
    return identify(records, Settings(seed=SEED, **settings))


class Results:
    """Everything that an identifier publishes as its result."""

    def __init__(self, graph):
        self.json, self.best, self.records = graph.results()
        self.each = {name: graph.listen(Float64MultiArray, f'parameters/{name}', latched())
                     for name in METHODS}
        self._graph = graph

    def wait(self, deadline=DEADLINE):
        self._graph.spin_until(lambda: self.json and self.best and all(self.each.values()),
                               'the result', deadline)

    def check(self, expected):
        """Compare with an Identification by the library."""
        data = self.json.data()[0]
        assert data['best'] == expected.best
        for name, fit in expected.methods.items():
            np.testing.assert_allclose(table_of(self.each[name][0]), parameter_table(fit),
                                       rtol=1e-6, atol=1e-8)
        np.testing.assert_array_equal(table_of(self.best[0]), table_of(self.each[data['best']][0]))
        return data


def check_physics(table, outputs=OUTPUTS):
    for row, name in zip(table, outputs, strict=True):
        assert row[0] == pytest.approx(GAINS[name], rel=TOLERANCE[name])
        assert row[1] >= row[2]


def check_data(data, samples):
    """Check that parameters_json has everything."""
    assert data['schema'] == 'quad_ident/identification/1'
    assert data['version'] == __version__
    assert data['settings']['seed'] == SEED
    assert data['dropped_samples'] == 0
    assert data['samples'] == dict.fromkeys(OUTPUTS, samples)
    assert [info['run'] for info in data['records']] == list(OUTPUTS)
    assert set(data['methods']) == set(METHODS)
    for name, method in data['methods'].items():
        assert method['seconds'] > 0
        assert name == 'vp' or method['evaluations'] == {
            'pso': 4 * 4200, 'cs': 4 * 8200, 'pso_cs': 4 * 8200, 'ls': 0}[name]
        for output, fit in method['outputs'].items():
            assert fit['units']['K'] == {'phi': 'rad/s^2/N', 'theta': 'rad/s^2/N',
                                         'psi': 'rad/s^2/(N m)', 'z': 'm/s^2/N'}[output]
            assert (fit['units']['a'], fit['units']['b']) == ('1/s', '1/s')
            assert fit['K'] is not None and fit['form'] in ('real', 'equal', 'complex')
            assert set(fit['standard_errors']) == {'K', 'a', 'b', 'c1', 'c0'}
            assert set(fit['errors']) >= {'iae', 'ise', 'itae', 'itse', 'fit_percent'}


def test_known_truth_in_one_process(graph):
    recorder = graph.start(Recorder)
    graph.start(Identifier, {'seed': SEED})
    results = Results(graph)
    graph.start(Simulator, {'real_time_factor': 0.0, 'seed': SEED})
    results.wait()
    data = results.check(by_library())
    check_physics(table_of(results.best[0]))
    check_data(data, 501)
    assert recorder.counts.joined == 4 * 501
    assert recorder.counts.problems() == {}


def test_known_truth_as_three_processes(graph, processes, tmp_path):
    noise = {'attitude': 0.002, 'altitude': 0.005}
    results = Results(graph)
    nodes = [processes.start('recorder', {'output': str(tmp_path / 'flights')}),
             processes.start('identifier', {'seed': SEED}),
             processes.start('simulator', {
                 'real_time_factor': 0.0, 'seed': SEED,
                 **{f'noise.{channel}': value for channel, value in noise.items()}})]
    results.wait(2 * DEADLINE)
    expected = by_library(noise=noise)
    data = results.check(expected)
    assert data['dropped_samples'] == 0
    graph.spin_until(lambda: len(results.records) == 4, 'four records')
    assert [node.stop() for node in nodes] == [0, 0, 0], nodes[0].errors()
    for node in nodes:
        assert 'Traceback' not in node.errors()

    # What is on disk is what was published, and gives the same result.
    folder = tmp_path / 'flights/recording_1'
    from_bag = read_bag(folder / 'bag')
    from_csv = [read_csv(folder / f'flight_{k}.csv') for k in range(1, 5)]
    for published, bag, csv in zip(results.records.records(), from_bag, from_csv, strict=True):
        for read in (bag, csv):
            np.testing.assert_allclose(read.t, published.t, rtol=0, atol=1e-12)
            assert list(read.columns) == list(published.columns)
            for name, values in published.columns.items():
                # An angle's last digit depends on how many are computed from quaternions at once.
                np.testing.assert_allclose(read.columns[name], values, rtol=1e-14, atol=1e-16)
    again = identify(from_bag, Settings(seed=SEED))
    for name, fit in again.methods.items():
        np.testing.assert_allclose(parameter_table(fit), table_of(results.each[name][0]),
                                   rtol=1e-6, atol=1e-8)


def test_two_vehicles_at_once_do_not_mix(graph):
    vehicles = {'red': 'paper_quadrotor', 'blue': 'paper_quadrotor_izz_corrected'}
    heard = {}
    for name in vehicles:
        heard[name] = graph.results(f'{name}/')
        graph.start(Recorder, namespace=name)
        graph.start(Identifier, {'method': 'ls'}, namespace=name)
    for name, vehicle in vehicles.items():
        graph.start(Simulator, {'real_time_factor': 0.0, 'vehicle': vehicle}, namespace=name)
    graph.spin_until(lambda: all(json and best for json, best, _ in heard.values()),
                     'both results', 2 * DEADLINE)
    tables = {name: table_of(best[0]) for name, (_, best, _) in heard.items()}
    for name, vehicle in vehicles.items():
        data = heard[name][0].data()[0]
        assert {info['vehicle'] for info in data['records']} == {vehicle}
        assert data['samples'] == dict.fromkeys(OUTPUTS, 501)
        assert data['dropped_samples'] == 0
        expected = by_library(vehicle=vehicle, methods=('ls',)).methods['ls']
        np.testing.assert_allclose(tables[name], parameter_table(expected), rtol=1e-6, atol=1e-8)
    # They differ in Izz by a factor of ten, and in nothing else.
    assert tables['red'][2, 0] > 5 * tables['blue'][2, 0]
    np.testing.assert_allclose(tables['red'][[0, 1, 3]], tables['blue'][[0, 1, 3]], rtol=1e-6,
                               atol=1e-8)


def test_simulated_time_in_all_nodes(graph):
    """The clock stands still after the flight: nobody may wait for it then."""
    graph.start(Recorder, {'use_sim_time': True})
    graph.start(Identifier, {'use_sim_time': True, 'method': 'ls'})
    json, best, records = graph.results()
    diagnostics = graph.listen(DiagnosticArray, '/diagnostics')
    graph.start(Simulator, {'publish_clock': True, 'real_time_factor': 0.0})
    graph.spin_until(lambda: json and best and len(records) == 4, 'the result')
    data = json.data()[0]
    assert [info['start_ns'] for info in data['records']] == [k * 51 * 10 ** 8 for k in range(4)]
    assert data['dropped_samples'] == 0
    check_physics(table_of(best[0])[[0, 1, 3]], ('phi', 'theta', 'z'))
    # Stamps are simulated ones, none later than the end of the flight.
    assert max(message.header.stamp.sec for message in diagnostics) <= 21


def test_a_result_is_there_for_those_who_come_late(graph):
    recorder = graph.start(Recorder)
    graph.start(Simulator, {'real_time_factor': 0.0})
    graph.spin_until(lambda: recorder.counts.joined == 4 * 501, 'the flight')
    # The identifier comes after the flight, and gets the records all the same.
    graph.start(Identifier, {'method': 'ls'})
    early = graph.listen(String, 'parameters_json', latched())
    graph.spin_until(lambda: early, 'the result')
    assert early.data()[0]['samples'] == dict.fromkeys(OUTPUTS, 501)
    # And so does a listener that comes after the fit.
    json, best, records = graph.results()
    each = graph.listen(Float64MultiArray, 'parameters/ls', latched())
    graph.spin_until(lambda: json and best and each and len(records) == 4, 'the latched results')
    assert json[0] == early[0]
    np.testing.assert_array_equal(table_of(best[0]), table_of(each[0]))


@pytest.mark.parametrize('lossy', [('attitude',), tuple(STREAMS)], ids=['one topic', 'all topics'])
def test_lost_messages_are_told_and_do_not_matter(graph, lossy):
    """A relay drops every tenth message: the record says so, and the fit bridges the gaps."""
    every = 10

    def relay(topic):
        count = 0

        def forward(message):
            nonlocal count
            count += 1
            if count % every:
                publisher.publish(message)

        publisher = graph.probe.create_publisher(STREAMS[topic], topic, LOSSLESS)
        graph.probe.create_subscription(STREAMS[topic], f'raw/{topic}', forward, LOSSLESS)

    recorder = graph.start(Recorder)
    graph.start(Identifier, {'method': 'ls'})
    json, best, records = graph.results()
    for topic in lossy:
        relay(topic)
    words = [word for topic in lossy for word in ('-r', f'{topic}:=raw/{topic}')]
    graph.start(Simulator, {'real_time_factor': 0.0}, arguments=words)
    graph.spin_until(lambda: json and best and len(records) == 4, 'the result', 2 * DEADLINE)
    lost = 4 * 501 // every
    assert recorder.counts.joined == 4 * 501 - lost
    assert recorder.counts.problems() == {'missing': lost, **(
        {'dropped': lost} if len(lossy) == 1 else {})}
    assert [record.info['dropped'] for record in records.records()] == [50] * 4
    data = json.data()[0]
    assert data['dropped_samples'] == lost
    assert data['samples'] == dict.fromkeys(OUTPUTS, 501)    # with their places
    assert [remark for remark in data['remarks'] if '50 of 501 samples are missing' in remark]
    whole = by_library(methods=('ls',)).methods['ls']
    table, expected = table_of(best[0]), parameter_table(whole)
    np.testing.assert_allclose(table[:, 0], expected[:, 0], rtol=0.02)
    check_physics(table[[0, 1, 3]], ('phi', 'theta', 'z'))
