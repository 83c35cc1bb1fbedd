# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Files that are written whole or not at all."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
import os
from pathlib import Path


def write_whole(path: str | Path, text: str) -> None:
    """
    Write a text file, into a new folder if needed; the old file stays if that fails.

    What is no regular file, such as a pipe, is written to as it is. What is no Unicode in the name
    of a file is written by its code. Raises OSError.
    """
    path = Path(path)
    if path.exists() and not path.is_file():
        path.write_text(text, encoding='utf-8', errors='backslashreplace')
        return
    with replacing(path) as temporary:
        temporary.write_text(text, encoding='utf-8', errors='backslashreplace')


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """
    Give a path to write to, of the same ending, which takes the place of a file at the end.

    Missing folders are made. If the block fails, the old file stays. Raises OSError with
    the name of that file.
    """
    place = Path(path).resolve()    # of a link, the file that it leads to
    temporary = place.with_name(f'.{os.getpid()}.{place.name}')
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        temporary.replace(place)
    except OSError as error:
        error.filename, error.filename2 = str(path), None   # the one that was asked for
        raise
    finally:
        with suppress(OSError):     # on a disk that has become read-only, it stays
            temporary.unlink(missing_ok=True)
