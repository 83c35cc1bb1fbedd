# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is said of files of simulators that are refused."""

import pytest

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.load import read_vehicle
from quad_ident_ros.vehicle_files.source import Source


def refused(text, name):
    """Return the one line, which begins with the file's name, with which a text is refused."""
    with pytest.raises(InputError) as error:
        read_vehicle(Source(name, text))
    message = str(error.value)
    assert message.startswith(name) and '\n' not in message and len(message) < 400
    return message
