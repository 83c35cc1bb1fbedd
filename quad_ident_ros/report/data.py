# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Results as JSON files."""

import json
import math
from pathlib import Path
import sys
from typing import Any

from quad_ident_ros.errors import InputError
from quad_ident_ros.whole_file import write_whole


def write_json(path: str | Path, data: object) -> None:
    """
    Write data to a JSON file, or to standard output for '-'; raises InputError.

    JSON has neither infinity nor not-a-number: null stands for them.
    """
    text = json.dumps(finite(data), indent=2, allow_nan=False) + '\n'
    if str(path) == '-':
        sys.stdout.write(text)
        return
    try:
        write_whole(path, text)
    except OSError as error:
        raise InputError(f'{path}: cannot be written: {error.strerror}') from None


def finite(data: Any) -> Any:
    """Return data with None in place of numbers that are not finite."""
    if isinstance(data, dict):
        return {key: finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data
