# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Results as JSON files."""

import json
from pathlib import Path
import sys

from quad_ident_ros.errors import InputError


def write_json(path, data):
    """Write data to a JSON file, or to standard output for '-'; raises InputError."""
    text = json.dumps(data, indent=2, allow_nan=False) + '\n'
    if str(path) == '-':
        sys.stdout.write(text)
        return
    try:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        Path(path).write_text(text, encoding='utf-8')
    except OSError as error:
        raise InputError(f'{path}: cannot be written: {error.strerror}') from None
