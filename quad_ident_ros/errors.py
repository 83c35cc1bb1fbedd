# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What is raised by bad input and by cancelled work, and how errors of libraries are worded."""

from pathlib import Path
import struct

# What parsers stumble over in a damaged file: these messages are about their code.
_STUMBLES = (ArithmeticError, AssertionError, AttributeError, LookupError, RecursionError,
             StopIteration, TypeError, UnicodeError, struct.error)
_LONGEST = 100      # characters of a library's message


class InputError(ValueError):
    """Input that cannot be used; the message says what, where and how to mend it."""


class Cancelled(Exception):
    """The caller has cancelled the work; raised in on_progress."""


class Reason(Exception):
    """What is wrong with a file, in our words; the line that refuses the file takes it up."""


def reason_of(error: Exception, path: str | Path) -> str:
    """
    Return why a library could not read a file, in one short line that does not name the file.

    The line that this goes into names it.
    """
    if isinstance(error, Reason):
        return ' '.join(str(error).split())     # it may quote a name of a damaged file
    if isinstance(error, MemoryError):
        return 'it is damaged and claims more than fits into memory'
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    text = ' '.join(str(error).replace(f'{path}/', '').replace(str(path), '').split())
    # Beyond the first colon libraries quote what they stumbled over.
    text = text.partition(':')[0].strip(' .')
    told = 0 < len(text) <= _LONGEST and 'Error' not in text and not isinstance(error, _STUMBLES)
    return text if told else 'it is damaged'
