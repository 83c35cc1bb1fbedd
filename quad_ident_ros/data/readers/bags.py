# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is in a bag of ROS 1 or ROS 2, topic by topic."""

from pathlib import Path

from quad_ident_ros.data.bag_file import BagFile
from quad_ident_ros.data.message_roles import could_be
from quad_ident_ros.data.readers.base import Content, content_of


def topics_of(path: str | Path) -> list[Content]:
    """
    Return the Content of each topic of a bag, by the stamps of receipt.

    Messages are not deserialized. Raises InputError where the bag cannot be read.
    """
    if (Path(path) / 'bag' / 'metadata.yaml').exists():   # a recording of the recorder
        path = Path(path) / 'bag'
    with BagFile(path) as bag:
        stamps = bag.stamps()
        origin = min((int(times.min()) for times in stamps.values()), default=0)
        fields = {topic: bag.fields(topic) for topic in bag.topics}
        return [content_of(topic.name, topic.type, stamps.get((topic.name, topic.type), ()),
                           origin, fields[topic],
                           could_be(topic.name, topic.type, fields[topic])[0])
                for topic in bag.topics]
