# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The content of files, by its checksum."""

import hashlib
from pathlib import Path

from quad_ident_ros.errors import InputError

_CHUNK = 1 << 20    # bytes


def files_in(path: Path) -> list[Path]:
    """Return a file, or all files in a folder, sorted; none for a pipe, which is read once."""
    if path.is_dir():
        return sorted(file for file in path.rglob('*') if file.is_file())
    return [path] if path.is_file() else []


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file in hex; raises InputError where it cannot be read."""
    whole = hashlib.sha256()
    try:
        if not path.stat().st_size:     # reading such a file of the system may wait for ever
            return whole.hexdigest()
        with open(path, 'rb') as file:
            while chunk := file.read(_CHUNK):
                whole.update(chunk)
    except OSError as error:
        raise InputError(f'{path}: cannot be read: {error.strerror}') from None
    return whole.hexdigest()
