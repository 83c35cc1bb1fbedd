# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""metadata.yaml of a rosbag2 folder, rewritten many times while the bag grows."""

from collections.abc import Iterable, Mapping

from rosbags.interfaces import Connection, ConnectionExtRosbag2
from rosbags.rosbag2.metadata import dump_qos_v9
import yaml

_TOP = 'rosbag2_bagfile_information'
_TOTAL, _BEGIN, _SPAN, _COUNT = 'TOTAL!', 'BEGIN!', 'SPAN!', 'COUNT{}!'    # no topics


def metadata_template(name: str, connections: Iterable[Connection]) -> str:
    """
    Return the text of metadata.yaml (version 9) with marks in the place of counts and times.

    Args: name of the MCAP file; connections: rosbags' Connections.
    """
    begin, span = {'nanoseconds_since_epoch': _BEGIN}, {'nanoseconds': _SPAN}
    topics = [_topic(one) for one in connections]
    return yaml.dump({_TOP: {
        'version': 9, 'storage_identifier': 'mcap', 'relative_file_paths': [name],
        'duration': dict(span), 'starting_time': dict(begin), 'message_count': _TOTAL,
        'topics_with_message_count': topics, 'compression_format': '', 'compression_mode': '',
        'files': [{'path': name, 'starting_time': dict(begin), 'duration': dict(span),
                   'message_count': _TOTAL}],
        'custom_data': None, 'ros_distro': 'jazzy'}}, Dumper=_Plain, sort_keys=False,
        width=10 ** 6)


def _topic(connection: Connection) -> dict[str, object]:
    assert isinstance(connection.ext, ConnectionExtRosbag2)
    return {'topic_metadata': {
        'name': connection.topic, 'type': connection.msgtype,
        'serialization_format': connection.ext.serialization_format,
        'offered_qos_profiles': dump_qos_v9(connection.ext.offered_qos_profiles),
        'type_description_hash': connection.digest},
        'message_count': _COUNT.format(connection.id)}


def metadata_text(template: str, counts: Mapping[int, int], first: int, last: int) -> str:
    """Return metadata.yaml: counts of messages by the id of a connection; times in ns."""
    values = {_TOTAL: sum(counts.values()), _BEGIN: first, _SPAN: max(0, last - first),
              **{_COUNT.format(key): count for key, count in counts.items()}}
    for mark, value in values.items():
        template = template.replace(mark, str(value))
    return template


def inner_metadata(text: str) -> str:
    """Return what the MCAP file itself keeps of metadata.yaml."""
    return '\n'.join(line[2:] for line in text.splitlines()[1:])


class _Plain(yaml.SafeDumper):
    """A dumper that has each QoS written out: the readers of ROS know no anchors."""

    def ignore_aliases(self, data: object) -> bool:
        """Return True: nothing is written as a reference."""
        return True
