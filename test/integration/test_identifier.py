# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Node identifier: when it fits what, how it is steered, and what it says."""

from array import array
import json
import threading
import time

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from graph import ENDLESS, flights, Graph, Vehicle
import numpy as np
import pytest
from rcl_interfaces.srv import GetParameters, ListParameters
from std_msgs.msg import Float64MultiArray, MultiArrayDimension, String

from quad_ident_ros.data.record import FlightRecord
from quad_ident_ros.identify.identify import identify, Settings
from quad_ident_ros.identify.methods import METHODS
from quad_ident_ros.identify.result import parameter_table
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.messages import record_message
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.recorder import Recorder


def publish(publisher, records):
    for record in records:
        publisher.publish(record_message(record))


@pytest.fixture(scope='module')
def hover():
    return flights()


class Bench:
    """An identifier, a publisher of records for it, and all that it says."""

    def __init__(self, graph, parameters=None):
        self.graph = graph
        self.json, self.best, _ = graph.results()
        self.progress = graph.listen(String, 'identifier/progress', 100)
        self.diagnostics = graph.listen(DiagnosticArray, '/diagnostics')
        if parameters is not None:
            self.node = graph.start(Identifier, parameters)
        self.publisher = graph.advertise(Float64MultiArray, 'record', latched(16))

    def feed(self, records):
        publish(self.publisher, records)

    def await_results(self, count):
        self.graph.spin_until(lambda: len(self.json) >= count and len(self.best) >= count,
                              f'{count} results')
        assert len(self.json) == count
        return self.json.data()[-1]

    def await_status(self, level, *parts):
        """Wait for diagnostics of a level with a text, and return its values."""
        def found():
            return [m.status[0] for m in self.diagnostics if m.status[0].level == level
                    and all(part in m.status[0].message for part in parts)]

        status = self.graph.spin_until(found, f'diagnostics {level} with {parts}')[-1]
        assert (status.name, status.hardware_id) == ('identifier', 'quad_ident_ros')
        return {entry.key: entry.value for entry in status.values}

    def await_progress(self):
        count = len(self.progress)
        self.graph.spin_until(lambda: len(self.progress) > count, 'progress')


@pytest.fixture
def bench(graph):
    """Make a Bench for parameters."""
    return lambda parameters: Bench(graph, parameters)


def test_it_waits_for_the_whole_experiment(bench, hover):
    bench = bench({'method': 'ls'})
    bench.await_status(DiagnosticStatus.OK, 'waiting for a record')
    bench.feed(hover[:3])
    bench.feed([hover[1]])    # one of them again
    bench.graph.spin_for(0.5)
    assert not bench.json
    bench.feed(hover[3:])
    data = bench.await_results(1)
    assert sorted(info['run'] for info in data['records']) == ['phi', 'psi', 'theta', 'z']
    expected = identify(hover, Settings(methods=('ls',)))
    table = np.reshape(bench.best[0].data, (4, 3))
    np.testing.assert_array_equal(table, parameter_table(expected.methods['ls']))


def test_mode_once_fits_again_on_demand_only(bench, hover):
    bench = bench({'method': 'ls'})
    bench.feed(hover)
    assert bench.await_results(1)['samples']['z'] == 501
    heard = bench.graph.listen(Float64MultiArray, 'record', latched(16))
    bench.feed(flights(session=2))
    bench.graph.spin_until(lambda: len(heard) == 8, 'the records')
    bench.graph.spin_for(0.5)
    assert len(bench.json) == 1
    response = bench.graph.trigger('identifier/identify')
    assert (response.success, response.message) == (True, 'fitting 4 records')
    assert {info['session'] for info in bench.await_results(2)['records']} == {2}


def test_mode_continuous_fits_each_window(graph, tmp_path):
    """The recorder's windows overlap; each gives a result, the last one of the newest window."""
    bench = Bench(graph, {'method': 'ls', 'mode': 'continuous', 'initial_state': 'free'})
    recorder = graph.start(Recorder, {'topics': ['attitude', 'altitude', 'input'],
                                      'window_samples': 200, 'overlap': 0.5})
    vehicle = Vehicle(graph, ('attitude', 'altitude', 'input'))
    for k in range(400):    # no flight that could be, but an input in each window
        vehicle.send(10 ** 9 + k * 10 ** 7, np.sin(0.05 * k))
        graph.executor.spin_once(timeout_sec=0.0)
    graph.spin_until(lambda: recorder.counts.joined == 400, 'the flight')
    graph.spin_until(lambda: bench.json and bench.json.data()[-1]['records'][0]['start_ns']
                     == 10 ** 9 + 200 * 10 ** 7, 'the fit of the last window')
    assert 2 <= len(bench.json) <= 3    # a window that came during a fit is skipped by a newer one
    assert {data['samples']['z'] for data in bench.json.data()} == {200}
    # Nothing new, no new result.
    count = len(bench.json)
    graph.spin_for(0.5)
    assert len(bench.json) == count


def test_window_fits_the_end_of_a_record(bench, hover):
    bench = bench({'method': 'ls', 'window': 2.0})
    bench.feed(hover)
    data = bench.await_results(1)
    assert data['samples'] == dict.fromkeys(('phi', 'theta', 'psi', 'z'), 201)
    # The window does not begin at rest, and the fit does not take it to.
    assert all('starts_at_rest' not in info for info in data['records'])
    fit = data['methods']['ls']['outputs']['z']
    assert fit['K'] == pytest.approx(1 / 0.65, rel=1e-3)
    assert fit['initial'][1] > 1.0    # the rate that it had by then


@pytest.mark.parametrize('method', ['pso', 'ls'])
def test_one_method_is_run_alone(bench, hover, method):
    bench = bench({'method': method, 'seed': 5})
    each = {name: bench.graph.listen(Float64MultiArray, f'parameters/{name}', latched())
            for name in METHODS}
    bench.feed(hover)
    data = bench.await_results(1)
    bench.graph.spin_until(lambda: all(each.values()), 'the topics of the methods')
    assert data['best'] == method and list(data['methods']) == [method]
    expected = identify(hover, Settings(methods=(method,), seed=5)).methods[method]
    for name, messages in each.items():
        table = np.reshape(messages[0].data, (4, 3))
        if name == method:
            np.testing.assert_array_equal(table, parameter_table(expected))
        else:    # a method that was not run says so
            assert np.isnan(table).all()


def test_changed_parameters_hold_for_the_next_fit(bench, hover):
    bench = bench({'method': 'pso'})
    bench.feed(hover)
    first = bench.await_results(1)
    changes = {'seed': 7, 'method': 'cs', 'generations': 3, 'population': 50,
               'pole_bounds': [-1.0, 12.0], 'poles': 'real', 'window': 3.0}
    for name, value in changes.items():
        assert bench.graph.set_parameter('identifier', name, value).successful
    assert bench.graph.trigger('identifier/identify').success
    second = bench.await_results(2)
    assert (first['settings']['seed'], second['settings']['seed']) == (0, 7)
    assert (list(first['methods']), list(second['methods'])) == (['pso'], ['cs'])
    assert second['settings']['swarm']['generations'] == 3
    assert second['settings']['poles'] == 'real'
    assert second['settings']['bounds']['z']['poles'] == [-1.0, 12.0]
    assert (second['settings']['mode'], second['settings']['window']) == ('once', 3.0)
    assert second['samples']['z'] == 301
    assert second['methods']['cs']['evaluations'] == 4 * (50 + 2 * 3 * 50)
    # The same as the library gives with these.
    assert bench.graph.set_parameter('identifier', 'window', 0.0).successful
    assert bench.graph.trigger('identifier/identify').success
    third = bench.await_results(3)
    swarm = type(Settings().swarm)(population=50, generations=3)
    expected = identify(hover, Settings(methods=('cs',), seed=7, swarm=swarm, poles='real',
                                        pole_bounds=(-1.0, 12.0)))
    assert third['methods']['cs']['cost'] == expected.methods['cs'].cost


def test_identify_without_records_says_so(bench):
    bench = bench({})
    response = bench.graph.trigger('identifier/identify')
    assert not response.success
    assert 'no record yet' in response.message and '~/flush' in response.message
    response = bench.graph.trigger('identifier/cancel')
    assert (response.success, response.message) == (False, 'no fit is running')


def test_progress_rises_to_one(bench, hover):
    bench = bench({'evaluations': 1_000_000, 'method': 'all'})
    bench.feed(hover)
    bench.await_results(1)
    bench.graph.spin_until(
        lambda: bench.progress and bench.progress.data()[-1]['fraction'] == 1.0, 'the end')
    news = bench.progress.data()
    shares = [entry['fraction'] for entry in news]
    assert len(shares) >= 5
    assert shares == sorted(shares) and shares[0] < 0.2
    assert {entry['method'] for entry in news} >= {'pso', 'cs', 'pso_cs'}
    assert {entry['output'] for entry in news} >= {'phi', 'theta', 'psi', 'z', ''}


def test_a_fit_can_be_cancelled(bench, hover):
    bench = bench(ENDLESS)
    bench.feed(hover)
    bench.await_progress()
    bench.await_status(DiagnosticStatus.OK, 'fitting')
    response = bench.graph.trigger('identifier/identify')
    assert (response.success, response.message) == (True, 'a fit is running; another follows')
    response = bench.graph.trigger('identifier/cancel')
    assert (response.success, response.message) == (True, 'cancelled')
    bench.await_status(DiagnosticStatus.WARN, 'the fit was cancelled')
    assert not bench.json
    # The one that was to follow is cancelled too, and the node takes up the next.
    bench.graph.spin_for(0.3)
    assert bench.graph.trigger('identifier/cancel').message == 'no fit is running'
    for name, value in {'method': 'ls', 'evaluations': 0}.items():
        assert bench.graph.set_parameter('identifier', name, value).successful
    assert bench.graph.trigger('identifier/identify').success
    assert list(bench.await_results(1)['methods']) == ['ls']


def test_a_fit_that_was_asked_for_during_another_follows(bench, hover):
    bench = bench({'method': 'pso', 'evaluations': 100_000, 'seed': 1})
    bench.feed(hover)
    bench.await_progress()
    assert bench.graph.set_parameter('identifier', 'seed', 2).successful
    response = bench.graph.trigger('identifier/identify')
    assert (response.success, response.message) == (True, 'a fit is running; another follows')
    bench.await_results(2)
    assert [data['settings']['seed'] for data in bench.json.data()] == [1, 2]


def test_a_node_that_ends_during_a_fit_does_not_wait_for_it(bench, hover):
    bench = bench(ENDLESS)
    bench.feed(hover)
    bench.await_progress()
    started = time.monotonic()
    bench.graph.stop(bench.node)
    assert time.monotonic() - started < 1.0


def test_services_are_answered_during_a_fit(domain, graph, processes, hover):
    """As a process, with a fit that does not end: 50 ms, by the clock of who asks."""
    processes.start('identifier', ENDLESS)
    bench = Bench(graph)
    bench.feed(hover)
    bench.await_progress()
    calls = {'get_parameters': (GetParameters, GetParameters.Request(names=['method', 'seed'])),
             'list_parameters': (ListParameters, ListParameters.Request())}
    caller = Graph(domain)
    took = {}
    try:
        for name, (kind, request) in calls.items():
            client = caller.probe.create_client(kind, f'identifier/{name}')
            caller.spin_until(client.service_is_ready, name)
            took[name] = []
            caller.answer(client, request)
            for _ in range(100):
                started = time.monotonic()
                future = client.call_async(request)
                caller.spin_until(future.done, f'{name} to answer')
                took[name].append(time.monotonic() - started)
    finally:
        caller.close()
    count = len(bench.progress)
    bench.await_progress()
    assert len(bench.progress) > count and not bench.json    # it is still fitting
    for name, seconds in took.items():
        print(f'{name}: median {1e3 * np.median(seconds):.2f} ms, '
              f'99 % {1e3 * np.quantile(seconds, 0.99):.1f} ms, max {1e3 * max(seconds):.1f} ms')
        assert np.quantile(seconds, 0.99) < 0.05


def test_what_is_not_excited_is_no_number_and_a_warning(bench, hover):
    bench = bench({'method': 'ls'})
    bench.feed(flights(run_count=1)[2:3])
    data = bench.await_results(1)
    assert list(data['methods']['ls']['outputs']) == ['psi']
    table = np.reshape(bench.best[0].data, (4, 3))
    assert np.isfinite(table[2]).all() and np.isnan(table[[0, 1, 3]]).all()
    values = bench.await_status(DiagnosticStatus.WARN, 'not excited: phi, theta, z')
    assert float(values['fit_percent/psi']) > 99


def test_a_good_fit_is_ok(bench, hover):
    bench = bench({'method': 'ls'})
    bench.feed(hover)
    bench.await_results(1)
    values = bench.await_status(DiagnosticStatus.OK, 'best method ls, cost')
    assert values['best'] == 'ls' and values['dropped_samples'] == '0'
    assert float(values['fit_percent/z']) > 99.9


def test_dropped_samples_are_a_warning(bench):
    bench = bench({'method': 'ls'})
    bench.feed(flights(dropped=2))
    assert bench.await_results(1)['dropped_samples'] == 8
    assert bench.await_status(DiagnosticStatus.WARN, 'best method ls')['dropped_samples'] == '8'


def test_complex_poles_are_not_published_as_real_ones(bench):
    t = 0.01 * np.arange(600)
    y = 1 - np.exp(-0.5 * t) * (np.cos(3 * t) + np.sin(3 * t) / 6)
    zero = np.zeros_like(t)
    columns = dict.fromkeys(('u1', 'u3', 'u4', 'phi', 'theta', 'psi'), zero)
    record = FlightRecord(t, {**columns, 'u2': 1 + zero, 'phi': y, 'pz': zero},
                          {'trim': [0.0] * 4, 'starts_at_rest': True})
    bench = bench({'method': 'all'})
    bench.feed([record])
    data = bench.await_results(1)
    fit = data['methods'][data['best']]['outputs']['phi']
    assert fit['form'] == 'complex' and fit['pair']['imaginary'] == pytest.approx(3, rel=0.02)
    row = np.reshape(bench.best[0].data, (4, 3))[0]
    assert row[0] == pytest.approx(9.25, rel=0.02) and np.isnan(row[1:]).all()
    bench.await_status(DiagnosticStatus.WARN, 'complex poles, so a and b are not published: phi')


def test_moments_of_a_real_vehicle_become_inputs_by_the_vehicle(bench, hover):
    """A vehicle that announces no runs says no arm length: the parameter vehicle knows it."""
    arm = load_vehicle('paper_quadrotor').arm_length
    names = {'u2': 'moment_x', 'u3': 'moment_y'}
    records = [FlightRecord(record.t, {
        names.get(name, name): arm * values if name in names else values
        for name, values in record.columns.items()}, record.info) for record in hover]
    bench = bench({'method': 'ls', 'vehicle': 'paper_quadrotor'})
    bench.feed(records)
    bench.await_results(1)
    expected = parameter_table(identify(hover, Settings(methods=('ls',))).methods['ls'])
    np.testing.assert_allclose(np.reshape(bench.best[-1].data, (4, 3)), expected, rtol=1e-6)
    assert bench.graph.set_parameter('identifier', 'vehicle', '').successful
    bench.graph.trigger('identifier/identify')
    data = bench.await_results(2)
    assert np.isnan(np.reshape(bench.best[-1].data, (4, 3))[:2]).all()
    assert any('name the vehicle' in remark for remark in data['remarks'])


def test_a_window_without_samples_is_an_error(bench, hover):
    bench = bench({'window': 0.001})
    bench.feed(hover)
    bench.await_status(DiagnosticStatus.ERROR, '1 sample')


def test_data_without_excitation_are_an_error(bench):
    t = 0.01 * np.arange(100)
    bench = bench({})
    bench.feed([FlightRecord(t, dict.fromkeys(
        ('u1', 'u2', 'u3', 'u4', 'phi', 'theta', 'psi', 'pz'), 0 * t), {})])
    bench.await_status(DiagnosticStatus.ERROR, 'no input deviates from its trim')
    assert not bench.json


def test_a_record_with_a_gap_names_a_parameter_and_no_option(bench, hover):
    bench = bench({'method': 'ls'})
    record = hover[0]
    late = np.where(np.arange(len(record)) < len(record) // 2, 0.0, 5.0)
    bench.feed([FlightRecord(record.t + late, record.columns, {**record.info, 'run_count': 1})])
    bench.await_status(DiagnosticStatus.ERROR, 'the record has a gap of 5', 'leave out what is '
                       'before it: set the parameter window to the seconds at the end')
    assert not [one for one in bench.diagnostics if '--' in one.status[0].message]


def test_a_vehicle_file_that_is_gone_by_now_does_not_end_the_node(bench, hover, tmp_path):
    """It was there when the parameter was set, and is read again for each fit."""
    path = tmp_path / 'vehicle.yaml'
    write_vehicle(path, load_vehicle('paper_quadrotor'))
    bench = bench({'method': 'ls', 'vehicle': str(path)})
    path.unlink()
    bench.feed(hover)
    bench.await_status(DiagnosticStatus.ERROR, 'vehicle.yaml: there is no such file')
    bench.graph.set_parameter('identifier', 'vehicle', '')
    assert bench.graph.trigger('identifier/identify').success
    assert bench.await_results(1)['methods']


def broken_messages():
    """Make messages that are no records, and one that looks like one but cannot be fitted."""
    good = flights()[0]

    def table(*labels, sizes, values):
        message = Float64MultiArray(data=array('d', values))
        message.layout.dim = [MultiArrayDimension(label=label, size=size)
                              for label, size in zip(labels, sizes, strict=True)]
        return message

    def with_info(text):
        message = record_message(good)
        message.layout.dim[2].label = text
        return message

    yield Float64MultiArray()
    yield Float64MultiArray(data=array('d', [1.0, 2.0]))
    yield table('samples', 't,u1', 'x', sizes=(2, 2, 1), values=[0.0, 1.0, 2.0, 3.0])
    yield table('samples', 't', '{}', sizes=(0, 1, 1), values=[])
    yield table('samples', 't,u1', '{}', sizes=(2, 2, 1), values=[0.0, np.nan, 1.0, 3.0])
    yield table('samples', 't,u1', '{}', sizes=(2, 2, 1), values=[0.0, 1.0, 1.0, 3.0])
    yield with_info('[1, 2]')
    yield with_info('"text"')
    for change in ({'run_index': [1]}, {'run_count': 'two'}, {'trim': 'hover'}, {'trim': [1.0]},
                   {'initial': 5}, {'outputs': 5}, {'outputs': ['nonsense']}, {'dropped': 'many'},
                   {'session': {}}, {'starts_at_rest': [[]]}):
        yield with_info(json.dumps({**good.info, 'run_count': 1, **change}))


def test_malformed_records_do_no_harm(bench, hover):
    bench = bench({'method': 'ls', 'mode': 'continuous'})
    for message in broken_messages():
        bench.publisher.publish(message)
        bench.graph.executor.spin_once(timeout_sec=0.05)
    bench.await_status(DiagnosticStatus.ERROR)
    bench.graph.spin_until(lambda: 'fitting' not in bench.diagnostics[-1].status[0].message,
                           'the end of fits')
    bench.feed(flights(session='the good one'))
    bench.graph.spin_until(
        lambda: bench.json and len(bench.json.data()[-1]['records']) == 4, 'the result')
    data = bench.json.data()[-1]
    assert {info['session'] for info in data['records']} == {'the good one'}
    assert data['methods']['ls']['outputs']['z']['K'] == pytest.approx(1 / 0.65, rel=1e-3)


@pytest.mark.parametrize('change', [{'start_ns': 10 ** 30}, {'start_ns': -10 ** 30},
                                    {'start_ns': (2 ** 31 - 1) * 10 ** 9}])
def test_a_record_whose_time_no_stamp_can_have_is_left_aside(bench, hover, capfd, change):
    bench = bench({'method': 'ls', 'mode': 'continuous'})
    good = flights()[0]
    bench.feed([FlightRecord(good.t, good.columns, {**good.info, **change, 'run_count': 1})])
    said = 'a record is ignored whose time is none that a stamp can have'
    bench.graph.spin_until(lambda: said in capfd.readouterr().err, said)
    assert not bench.json
    bench.feed([good])
    bench.graph.spin_until(lambda: bench.json, 'the result')


def test_no_thread_is_left(graph, hover):
    before = threading.active_count()
    bench = Bench(graph, {'method': 'ls'})
    bench.feed(hover)
    bench.await_results(1)
    bench.graph.spin_until(lambda: threading.active_count() == before, 'the fit to end')
