# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What a node writes to disk, without a graph."""

import logging
from types import SimpleNamespace

from bag_files import header, Make, START, store, TF

from quad_ident_ros.data.bag_file import BagFile
from quad_ident_ros.nodes.on_disk import OnDisk

CLOCK = SimpleNamespace(ros_time_is_active=False)


def test_what_holds_for_the_whole_flight_waits_for_the_recording(tmp_path):
    """Transforms that do not change come as soon as their topic exists, before the others."""
    disk = OnDisk(str(tmp_path), '', CLOCK, logging.getLogger('test'))
    types = store()
    raw = bytes(types.serialize_cdr(Make(types)(TF, transforms=[{'header': header(START)}]), TF))
    disk.write('/tf_static', raw, holds=True)
    disk.write('/tf', raw)
    disk.open({'/tf': '/tf', '/tf_static': '/tf_static', 'run': '/run'},
              {'/tf': TF, '/tf_static': TF})
    disk.close()
    with BagFile(tmp_path / 'recording_1' / 'bag') as bag:
        assert {topic.name: topic.count for topic in bag.topics} == {
            '/tf': 0, '/tf_static': 1, '/run': 0}
