# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The layouts for Foxglove and PlotJuggler draw what is in a bag of a demo."""

from functools import reduce
import math

from layout_files import foxglove_paths, foxglove_topics
import pytest
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import get_typestore, Stores
import yaml

from quad_ident_ros.nodes.diagnoser import Diagnoser
from quad_ident_ros.nodes.identifier import Identifier
from quad_ident_ros.nodes.mapped import message_class
from quad_ident_ros.nodes.qos import latched
from quad_ident_ros.nodes.recorder import Recorder
from quad_ident_ros.nodes.simulator import Simulator
from quad_ident_ros.warm_up import warm_up_diagnosis

TYPES = get_typestore(Stores.ROS2_JAZZY)
PATIENCE = 180.0    # s for two flights and a diagnosis, all in this thread, on a busy machine


@pytest.fixture
def bag(graph, tmp_path):
    """Return the folder of a bag with a message of each topic of a demo."""
    warm_up_diagnosis()
    experiment = tmp_path / 'two.yaml'
    experiment.write_text(yaml.safe_dump({
        'name': 'two', 'model': 'closed_loop', 'vehicle': 'hummingbird', 'period': 0.01,
        'runs': [{'name': name, 'duration': 8.0, 'trajectory': name, 'sensors': 'mocap_imu'}
                 for name in ('figure8', 'circle')]}), encoding='utf-8')
    wanted = {topic for topic, *_ in foxglove_paths()} | foxglove_topics()
    graph.start(Recorder)
    graph.start(Identifier, {'method': 'vp', 'vehicle': 'hummingbird'})
    graph.start(Diagnoser, {'vehicle': 'hummingbird', 'effects': ['rotor_drag']})
    graph.start(Simulator, {
        'experiment': str(experiment), 'effects': ['rotor_drag:coefficient=0.3'],
        'real_time_factor': 0.0})
    heard, listening = {}, {}
    for topic, (kind, *_) in graph.probe.get_topic_names_and_types():
        if kind in TYPES.fielddefs:
            durable = any(info.qos_profile.durability == latched().durability
                          for info in graph.probe.get_publishers_info_by_topic(topic))
            heard[topic] = kind, []
            listening[topic] = graph.probe.create_subscription(
                message_class(kind), topic, heard[topic][1].append,
                latched(16) if durable else 100, raw=True)

    def finished():
        for topic in [topic for topic in listening if heard[topic][1]]:
            graph.probe.destroy_subscription(listening.pop(topic))     # one message is enough
        return not wanted & set(listening)

    graph.spin_until(finished, 'a message of each topic', PATIENCE)
    folder = tmp_path / 'bag'
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for topic, (kind, messages) in heard.items():
            connection = writer.add_connection(topic, kind, typestore=TYPES)
            for message in messages[:1]:
                writer.write(connection, 0, message)
    return folder


def test_what_the_layouts_name_is_a_number_in_a_bag_of_the_demo(bag):
    drawn, shown = foxglove_paths(), foxglove_topics()
    with AnyReader([bag]) as reader:
        first = {}
        for connection, _, data in reader.messages():
            if connection.topic not in first:
                first[connection.topic] = reader.deserialize(data, connection.msgtype)
    assert shown and shown <= set(first)
    assert len(drawn) > 50
    for topic, *fields in drawn:
        number = float(reduce(getattr, fields, first[topic]))
        # a and b of complex poles, and what has no standard error, are not a number
        assert math.isfinite(number) or topic.startswith('/outputs/')
