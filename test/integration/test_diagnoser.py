# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Node diagnoser: it finds what the simulator's vehicle has, and says so to whom it concerns."""

from dataclasses import replace
import json
import time

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import Vector3Stamped
from graph import flights, stamp_of
import numpy as np
import pytest
from rcl_interfaces.srv import ListParameters
from std_msgs.msg import Float64MultiArray, String
import yaml

from quad_ident_ros.data.commands import with_commands
from quad_ident_ros.data.record import EULER, FlightRecord, QUATERNION
from quad_ident_ros.errors import InputError
from quad_ident_ros.experiment import fly, load_experiment
from quad_ident_ros.model.attitude import rotate
from quad_ident_ros.model.motors import motors_from, MOTORS_OFF
from quad_ident_ros.model.vehicle import load_vehicle, write_vehicle
from quad_ident_ros.nodes.diagnoser import Diagnoser
from quad_ident_ros.nodes.messages import record_message
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.recorder import Recorder
from quad_ident_ros.nodes.simulator import Simulator
from quad_ident_ros.warm_up import warm_up_diagnosis

NOMINAL = 'hummingbird'
DRAG = {'rotor_drag': {'coefficient': 0.25}}
PATIENCE = 60.0     # s for a whole diagnosis on a busy machine


@pytest.fixture(scope='module', autouse=True)
def compiled():
    """Compile beforehand, as the node does."""
    warm_up_diagnosis()


@pytest.fixture(scope='module')
def experiment(tmp_path_factory):
    """Return the path of an experiment with two short flights in closed loop."""
    path = tmp_path_factory.mktemp('experiment') / 'two.yaml'
    path.write_text(yaml.safe_dump({
        'name': 'two', 'model': 'closed_loop', 'vehicle': NOMINAL, 'period': 0.01,
        'runs': [{'name': name, 'duration': 10.0, 'trajectory': name, 'sensors': 'mocap_imu'}
                 for name in ('figure8', 'circle')]}), encoding='utf-8')
    return str(path)


@pytest.fixture(scope='module')
def draggy(experiment):
    """Return the records of the flights of a vehicle with drag."""
    flown = load_experiment(experiment).with_effects(DRAG)
    records = [fly(flown, run).record for run in flown.runs]
    return [FlightRecord(record.t, record.columns,
                         {**record.info, 'session': 1, 'run_index': k, 'run_count': 2})
            for k, record in enumerate(records)]


def in_world(record):
    """Return the velocity that the recorder makes of a twist in the axes of the world."""
    names = ('vx', 'vy', 'vz')
    return dict(zip(names, rotate(record.stack(*QUATERNION), record.stack(*names)).T,
                    strict=True))


class Bench:
    """A diagnoser, a publisher of records for it, and all that it says."""

    def __init__(self, graph, parameters):
        self.graph = graph
        self.diagnoses = graph.listen(String, 'diagnosis', latched())
        self.progress = graph.listen(String, 'diagnoser/progress', 100)
        self.statuses = graph.listen(DiagnosticArray, '/diagnostics')
        graph.start(Diagnoser, {'vehicle': NOMINAL, **parameters})
        self.publisher = graph.advertise(Float64MultiArray, 'record', latched(16))

    def feed(self, records):
        for record in records:
            self.publisher.publish(record_message(record))

    def await_diagnosis(self):
        self.graph.spin_until(lambda: self.diagnoses, 'a diagnosis', PATIENCE)
        return self.diagnoses.data()[-1]

    def await_status(self, level, part):
        def found():
            return [status for message in self.statuses for status in message.status
                    if status.name == 'diagnoser' and status.level == level
                    and part in status.message]

        return self.graph.spin_until(found, f'{part!r} in the diagnostics', PATIENCE)[-1]


def test_outputs_of_motors_are_taken_by_the_motors_of_the_vehicle_file(graph, tmp_path, draggy):
    """As those of a file are: here normalised signals to more motors than there are."""
    vehicle = load_vehicle(NOMINAL)
    speeds = {'kind': 'normalised', 'speed': {'offset': 50, 'gain': 1100}}
    write_vehicle(tmp_path / 'v.yaml', replace(vehicle, motors=motors_from('v', speeds)))
    bench = Bench(graph, {'vehicle': str(tmp_path / 'v.yaml'),
                          'effects': ['rotor_drag', 'motor_lag', 'thrust_scale']})
    records = []
    for record in draggy:
        columns = {name: values for name, values in with_commands(record, vehicle).columns.items()
                   if name not in ('u1', 'u2', 'u3', 'u4')}
        columns |= {f'output{k}': (columns.pop(f'cmd{k}') - 50) / 1100 for k in range(1, 5)}
        columns['output5'] = np.full(len(record), MOTORS_OFF)
        records.append(FlightRecord(record.t, columns, {
            **record.info, 'actuators': {'kind': 'normalised', 'curve': 'linear'}}))
    bench.feed(records)
    data = bench.await_diagnosis()
    assert data['verdict'] == ['rotor_drag']
    first = data['ranking'][0]['parameters']['coefficient']
    assert abs(first['value'] - 0.25) < 4 * first['std']


def test_it_finds_the_effect_of_the_simulated_vehicle(graph, tmp_path, experiment):
    reality = tmp_path / 'reality.yaml'
    write_vehicle(reality, replace(load_vehicle(NOMINAL), effects=DRAG))
    statuses = graph.listen(DiagnosticArray, '/diagnostics')
    diagnoses = graph.listen(String, 'diagnosis', latched())
    graph.start(Recorder)
    graph.start(Diagnoser, {'vehicle': NOMINAL})
    graph.start(Simulator, {'experiment': experiment, 'vehicle': str(reality),
                            'real_time_factor': 0.0})
    graph.spin_until(lambda: diagnoses, 'a diagnosis', PATIENCE)
    [data] = diagnoses.data()
    assert data['verdict'] == ['rotor_drag'] and data['dropped_samples'] == 0
    first = data['ranking'][0]['parameters']['coefficient']
    assert abs(first['value'] - 0.25) < 4 * first['std']
    assert data['held_out'] == 'two/circle' and data['flights'] == ['two/figure8']
    graph.spin_until(lambda: any('rotor_drag' in status.message for message in statuses
                                 for status in message.status), 'the verdict in the diagnostics')
    # Who comes late hears it, too.
    late = {name: graph.listen(kind, name, latched()) for name, kind in (
        ('diagnosis', String), ('gap', Float64MultiArray), ('where', Float64MultiArray),
        ('gap/velocity', Vector3Stamped), ('where/force', Vector3Stamped))}
    graph.spin_until(lambda: all(late.values()), 'the latched results')
    assert late['diagnosis'].data() == [data]
    assert [dim.label for dim in late['gap'][0].layout.dim] == [
        'position,velocity,attitude,rate', 'before,after,noise']
    before, after, noise = np.reshape(late['gap'][0].data, (4, 3))[1]
    assert (before, after, noise) == tuple(data['gap'][stage]['velocity']
                                           for stage in ('before', 'after', 'noise'))
    # What noise with a memory makes is known to a tenth or so.
    assert 0.8 * noise < after < 1.5 * noise < before
    assert late['where'][0].layout.dim[0].label == 'Fx,Fy,Fz,Mx,My,Mz'
    shares = np.array(late['where'][0].data)
    assert shares.sum() == pytest.approx(1.0) and shares[:2].sum() > 0.8
    # The same for plots, with the time of the data.
    for name, values in (('gap/velocity', (before, after, noise)), ('where/force', shares[:3])):
        [message] = late[name]
        assert stamp_of(message) == data['span_ns'][1]
        assert (message.vector.x, message.vector.y, message.vector.z) == tuple(values)


def test_it_answers_while_it_diagnoses_and_can_be_cancelled(graph, draggy):
    bench = Bench(graph, {})
    assert graph.trigger('diagnoser/diagnose').message.startswith('there is no record yet')
    assert graph.trigger('diagnoser/cancel').message == 'no diagnosis is running'
    bench.feed(draggy)
    graph.spin_until(lambda: bench.progress, 'progress', PATIENCE)
    client = graph.probe.create_client(ListParameters, 'diagnoser/list_parameters')
    graph.spin_until(client.service_is_ready, 'the service')
    assert 'vehicle' in graph.answer(client, ListParameters.Request()).result.names
    assert not bench.diagnoses      # it did not wait for the end
    answer = graph.trigger('diagnoser/cancel')
    assert (answer.success, answer.message) == (True, 'cancelled')
    bench.await_status(DiagnosticStatus.WARN, 'the diagnosis was cancelled')
    assert not bench.diagnoses
    answer = graph.trigger('diagnoser/diagnose')
    assert (answer.success, answer.message) == (True, 'diagnosing 2 records')
    assert bench.await_diagnosis()['verdict'] == ['rotor_drag']
    assert json.loads(bench.progress[-1].data)['fraction'] <= 1.0
    values = {entry.key: entry.value for entry in bench.await_status(
        DiagnosticStatus.WARN, 'verdict: drag of the rotors (rotor_drag), ').values}
    assert float(values['probability/rotor_drag']) > 0.5


def test_each_window_is_diagnosed_in_continuous_mode(graph, draggy):
    """A window of a single flight, of which half of the blocks are held out."""
    bench = Bench(graph, {'mode': 'continuous', 'window': 8.0, 'effects': ['rotor_drag', 'wind']})
    bench.feed(draggy[:1])
    first = bench.await_diagnosis()
    assert (first['span_ns'][1] - first['span_ns'][0]) == pytest.approx(8e9, abs=2e7)
    assert {row['effect'] for row in first['ranking']} == {'rotor_drag', 'wind'}
    bench.feed(draggy[1:])
    graph.spin_until(lambda: len(bench.diagnoses) == 2, 'the second window', PATIENCE)
    [name] = bench.diagnoses.data()[1]['flights']
    assert name.startswith('two/circle ')


@pytest.mark.parametrize('spoil, said', [
    (lambda record: {name: values for name, values in record.columns.items()
                     if name not in (*QUATERNION, *EULER)}, 'qw'),
    (lambda record: {name: values for name, values in record.columns.items()
                     if not name.startswith(('u', 'cmd', 'rotor'))}, 'cmd1'),
    (lambda record: {**record.columns, 'cmd1': record.columns['cmd2'],
                     'cmd2': record.columns['cmd1']}, 'cmd'),
    (lambda record: {**record.columns, **in_world(record)}, 'world')])
def test_records_that_bear_no_verdict_are_refused_in_one_line(graph, draggy, spoil, said):
    bench = Bench(graph, {})
    bench.feed([FlightRecord(record.t, spoil(record), record.info) for record in draggy])
    status = bench.await_status(DiagnosticStatus.ERROR, said)
    assert '\n' not in status.message
    graph.spin_for(0.1)
    assert not bench.diagnoses


def test_a_fault_of_a_record_names_a_parameter_and_no_option(graph, draggy):
    bench = Bench(graph, {})
    good = np.arange(len(draggy[0])) > 100
    bench.feed([FlightRecord(record.t, {**record.columns, **{
        name: np.where(good, record.columns[name], 0.0) for name in QUATERNION}}, record.info)
        for record in draggy])
    status = bench.await_status(DiagnosticStatus.ERROR, 'leave them out: set the parameter window')
    assert '--' not in status.message


def test_it_ends_while_it_diagnoses(graph, draggy):
    bench = Bench(graph, {})
    bench.feed(draggy)
    graph.spin_until(lambda: bench.progress, 'progress', PATIENCE)
    node = next(node for node in graph.nodes if isinstance(node, Diagnoser))
    began = time.monotonic()
    graph.stop(node)
    assert time.monotonic() - began < 10.0


def test_a_vehicle_that_cannot_be_used_is_refused_in_one_line(graph, tmp_path):
    path = tmp_path / 'drone.urdf'
    path.write_text('<robot name="empty"/>')
    for vehicle, said in (('hummingbrd', "'hummingbrd' is not among the vehicles"),
                          (str(path), 'drone.urdf')):
        with pytest.raises(InputError) as caught:
            graph.start(Diagnoser, {'vehicle': vehicle})
        assert said in str(caught.value) and '\n' not in str(caught.value)


def test_flights_that_are_too_short_are_refused_in_one_line(graph):
    """Steps, as the identifier has them, but cut."""
    bench = Bench(graph, {'vehicle': 'paper_quadrotor'})
    bench.feed([record.slice(0, 300) for record in flights()])
    bench.await_status(DiagnosticStatus.ERROR, 's are too short for a diagnosis; at least 4 s')
    assert not bench.diagnoses


def test_the_short_end_of_a_flight_is_left_aside_in_continuous_mode(graph, draggy):
    bench = Bench(graph, {'mode': 'continuous', 'effects': ['rotor_drag']})
    bench.feed([draggy[0].slice(0, 300), draggy[1]])
    [name] = bench.await_diagnosis()['flights']
    assert name.startswith('two/circle ')
    assert len(bench.diagnoses) == 1
