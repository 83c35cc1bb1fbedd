# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Compilation of the inner loops to machine code, kept on disk between starts."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
import fcntl
from functools import lru_cache
import hashlib
import os
from pathlib import Path
import stat
from typing import Any, overload, TypeVar

import numba

FOLDERS = ('effects', 'flight', 'greybox', 'identify', 'model')   # with compiled functions


def _stamp() -> str:
    """Return what changes with any file of these folders."""
    package = Path(__file__).parent
    files = sorted((str(path.relative_to(package)), path.stat().st_mtime_ns, path.stat().st_size)
                   for folder in FOLDERS for path in (package / folder).rglob('*.py'))
    return hashlib.sha256(repr(files).encode()).hexdigest()


# Numba rebuilds what it keeps on disk where the function's own file has changed, but not where
# that of a function or constant has which it uses: so every file counts.
STAMP = _stamp()


@lru_cache(maxsize=64)
def is_trusted(folder: str | Path) -> bool:
    """
    Return whether this user or root wrote what lies in a folder: it is executed as it is.

    The folder and the one that it lies in must be theirs, and not for everybody or a group to
    write to, but for the group of this user alone, and unless, as among temporary files, only the
    owner of a file can take it away.
    """
    try:
        real = os.path.realpath(folder)
        own, above = os.stat(real), os.stat(os.path.dirname(real))
    except OSError:
        return False
    users = {0, os.geteuid()} if hasattr(os, 'geteuid') else {own.st_uid, above.st_uid}
    return (own.st_uid in users and above.st_uid in users and not _others_write(own)
            and (not _others_write(above) or bool(above.st_mode & stat.S_ISVTX)))


def _others_write(status: os.stat_result) -> bool:
    """Return whether others than this user may write to what has a status."""
    if status.st_mode & stat.S_IWOTH:
        return True
    return bool(status.st_mode & stat.S_IWGRP) and not _is_own_group(status.st_gid)


def _is_own_group(gid: int) -> bool:
    """Return whether a group is this user's alone: it has the name of the user."""
    try:
        import grp
        import pwd
        return grp.getgrgid(gid).gr_name == pwd.getpwuid(os.geteuid()).pw_name
    except (ImportError, KeyError):     # no such group or user, or another system
        return False


def _keep_whole(cache: Any) -> None:
    """
    Have a cache of numba keep what belongs together, whoever else writes, also after a kill.

    Numba writes the index of a function before the code, under a number that it takes from the
    index: two processes at once take the same one, and after a change of the source the code of
    before has that number until the new one is written. It does not wait for the disk, either: it
    would read what a power cut leaves, empty or cut short, as it is. A full disk or a missing
    folder takes nothing, which is left out.
    """
    file, save, folder = cache._cache_file, cache.save_overload, cache.cache_path
    known, read, mine = file._load_index, file._load_data, Path(file._index_name).stem + '.'

    def index_if_whole() -> Any:
        # What is not whole, as after the power was cut, may raise whatever pickles may.
        with suppress(Exception):
            return known()
        return {}

    def code_if_whole(name: str) -> Any:
        try:
            return read(name)
        except Exception as error:
            raise FileNotFoundError(name) from error    # numba then compiles again

    def save_alone(*signature_and_code: Any) -> None:
        with suppress(OSError), _alone_in(folder):
            if not index_if_whole():
                for name in os.listdir(folder):
                    if name.startswith(mine):
                        os.remove(os.path.join(folder, name))
            save(*signature_and_code)

    file._load_index, file._load_data = index_if_whole, code_if_whole
    cache.save_overload = save_alone


@contextmanager
def _alone_in(folder: str) -> Iterator[None]:
    """Let one process at a time write to a folder, where its file system knows of locks."""
    os.makedirs(folder, exist_ok=True)
    handle = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        with suppress(OSError):     # a child that was forked meanwhile has the handle, too
            fcntl.flock(handle, fcntl.LOCK_UN)
        os.close(handle)


FUNCTIONS: list[Any] = []
"""What was made to be compiled, of which `signatures` has something where it can be called."""

Function = TypeVar('Function', bound=Callable[..., Any])


@overload
def compiled(function: Function) -> Function: ...


@overload
def compiled(function: None = None, *, fused: bool = False, reordered: bool = False,
             inlined: bool = False) -> Callable[[Function], Function]: ...


def compiled(function: Any = None, *, fused: bool = False, reordered: bool = False,
             inlined: bool = False) -> Any:
    """
    Compile a numerical function, without the interpreter's lock and with an on-disk cache.

    fused lets a product and a sum be one operation and division by zero give infinity, reordered
    lets sums be taken in another order, for kernels that the processor then does several elements
    at a time of; inlined makes it a part of the function that calls it. Not a number and infinity
    keep their meaning. Where no folder can be written, the disk is full, numba has another way of
    keeping, or the folder is one in which others can put code, the function is compiled again at
    each start.
    """
    if function is None:
        return lambda function: compiled(function, fused=fused, reordered=reordered,
                                         inlined=inlined)
    flags = {name for name, wanted in (('contract', fused), ('reassoc', reordered)) if wanted}
    # To raise an error at a division by zero is a branch, which keeps a loop from being widened.
    options = {'nogil': True, 'fastmath': flags, 'forceinline': inlined,
               'error_model': 'numpy' if fused else 'python'}
    try:
        made = numba.njit(cache=True, **options)(function)
        # There is no public way to say what a function was made from.
        file, folder = made._cache._cache_file, made._cache.cache_path
        if not is_trusted(folder) and Path(folder).parent != Path(function.__code__.co_filename
                                                                  ).parent:
            raise RuntimeError(f'others can write to {folder}')
        file._source_stamp = (file._source_stamp, STAMP)
        _keep_whole(made._cache)
    except (AttributeError, RuntimeError):
        made = numba.njit(**options)(function)
    FUNCTIONS.append(made)
    return made
