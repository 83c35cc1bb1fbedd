# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What compressed files may unpack to: a few kB may unpack to any size."""

from pathlib import Path

PART = 1 << 26      # bytes that a chunk or a message of a bag may have; usual are 1 to 4 MB
SHARE = 100         # times its own size that a whole file may unpack to, and
SMALL = 1 << 28     # bytes that it may have besides


def most(packed: int) -> int:
    """Return the bytes that a file of so many may unpack to: measurements pack to a tenth."""
    return SMALL + SHARE * packed


def size_on_disk(path: Path) -> int:
    """Return the bytes of a file, or of the files in a folder."""
    files = path.iterdir() if path.is_dir() else [path]
    return sum(file.stat().st_size for file in files if file.is_file())
