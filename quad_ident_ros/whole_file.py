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
    place, temporary = _places(path)
    try:
        with _named(path):
            place.parent.mkdir(parents=True, exist_ok=True)
            yield temporary
            temporary.replace(place)
    finally:
        with suppress(OSError):     # on a disk that has become read-only, it stays
            temporary.unlink(missing_ok=True)


class Lines:
    """
    A text file of lines that takes the place of an older one at the end, if it is kept.

    What is no regular file, such as a pipe, is written to as it is. All raise OSError with the
    name of that file.
    """

    def __init__(self, path: str | Path) -> None:
        self._path = Path(path)
        whole = not self._path.exists() or self._path.is_file()
        self._place, self._temporary = _places(path) if whole else (None, self._path)
        with _named(path):
            if self._place:
                self._place.parent.mkdir(parents=True, exist_ok=True)
            self._file = open(self._temporary, 'w', encoding='utf-8')

    def write(self, line: str) -> None:
        """Add a line, at once."""
        with _named(self._path):
            self._file.write(f'{line}\n')
            self._file.flush()

    def keep(self) -> None:
        """End the file; it takes its place."""
        try:
            with _named(self._path):
                self._file.close()
                if self._place:
                    self._temporary.replace(self._place)
        except OSError:
            self.drop()
            raise

    def drop(self) -> None:
        """End the file; the old one stays."""
        with suppress(OSError):
            self._file.close()
        if self._place:
            with suppress(OSError):
                self._temporary.unlink(missing_ok=True)


def _places(path: str | Path) -> tuple[Path, Path]:
    """Return where a file is, of a link the one that it leads to, and where it is written."""
    place = Path(path).resolve()
    return place, place.with_name(f'.{os.getpid()}.{place.name}')


@contextmanager
def _named(path: str | Path) -> Iterator[None]:
    """Give errors the name of the file that was asked for."""
    try:
        yield
    except OSError as error:
        error.filename, error.filename2 = str(path), None
        raise
