# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Text files that are written whole or not at all."""

import os
from pathlib import Path


def write_whole(path: str | Path, text: str) -> None:
    """
    Write a text file into a folder that is there; where it fails, what was there before stays.

    What is no regular file, such as a pipe, is written to as it is. Raises OSError.
    """
    path = Path(path).resolve()   # of a link, the file that it leads to
    if path.exists() and not path.is_file():
        path.write_text(text, encoding='utf-8')
        return
    temporary = path.with_name(f'.{path.name}.{os.getpid()}.tmp')
    try:
        temporary.write_text(text, encoding='utf-8')
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
