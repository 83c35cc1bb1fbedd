# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Definitions of messages that bags of older recorders hold without a definition.

PACKAGE/NAME.msg has the fields of a message of now, PACKAGE/NAME-VERSION.msg those of another
version, and PACKAGE/NAME-start.msg the fields with which all versions begin.
"""

from functools import cache
from importlib import resources
from typing import TYPE_CHECKING

from rosbags.typesys import get_types_from_msg

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Typesdict

START = 'start'


@cache
def layouts(msgtype: str) -> tuple[tuple[str, 'Typesdict'], ...]:
    """
    Return the definitions that ship of a message type: (version, field definitions) of each.

    The version is '' for the usual one, which comes first, and START for one after which more
    fields follow. The field definitions are those of rosbags, of this type alone.
    """
    package, _, name = msgtype.partition('/msg/')
    folder = resources.files(__name__) / package
    if not (name.isidentifier() and package.isidentifier() and folder.is_dir()):
        return ()
    found = []
    for file in folder.iterdir():
        base, _, version = file.name.removesuffix('.msg').partition('-')
        if base == name:
            found.append((version, get_types_from_msg(file.read_text('utf-8'), msgtype)))
    return tuple(sorted(found, key=lambda one: (one[0] == START, one[0] != '', one[0])))
