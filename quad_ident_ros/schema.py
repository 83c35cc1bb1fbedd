# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Checks of values that come from files, parameters and the command line."""

from collections.abc import Collection, Iterable, Sequence
import difflib
import math
import reprlib
from typing import TypeVar

from quad_ident_ros.errors import InputError

Option = TypeVar('Option')
NAME_LENGTH = 100   # characters, well within the 255 bytes that file systems allow a file name


class _Short(reprlib.Repr):
    """A short form of any value, of whole numbers that Python does not print too."""

    def repr_int(self, x: int, level: int) -> str:
        """Return a whole number, or how long it is."""
        if abs(x) < 10 ** 40:
            return super().repr_int(x, level)
        return f'a whole number of about {int(x.bit_length() * 0.30103) + 1} digits'


_short = _Short()
_short.maxlevel = 1
_short.maxstring = _short.maxother = 60


def shown(value: object) -> str:
    """Return a value as one short line for a message."""
    return _short.repr(value)


def suggestion(key: object, known: Collection[str]) -> str:
    """Return "did you mean ...?" with the nearest known name, or nothing if none is near."""
    lower = {str(name).lower(): name for name in known}
    near = difflib.get_close_matches(shown(key).strip("'").lower(), list(lower), n=1)
    return f'did you mean {lower[near[0]]!r}?' if near else ''


def unknown_key(where: str, key: object, known: Collection[str]) -> InputError:
    """Return the InputError for a key that is not known, with the nearest known one."""
    hint = suggestion(key, known) or f'known are {", ".join(sorted(known))}'
    return InputError(f'{where}: {shown(key)} is not known here; {hint}')


def check_keys(where: str, mapping: object, known: Collection[str],
               required: Iterable[str] = ()) -> None:
    """Raise InputError if `mapping` is not one, has no required key or has an unknown one."""
    if not isinstance(mapping, dict):
        raise InputError(f'{where}: expected `key: value` lines, got {shown(mapping)}')
    for key in mapping:
        if key not in known:
            raise unknown_key(where, key, known)
    for key in required:
        if key not in mapping:
            raise InputError(f'{where}: {key!r} is missing')


def number(where: str, value: object, minimum: float = -math.inf, maximum: float = math.inf,
           exclusive: bool = False) -> float:
    """Return a finite float within bounds, or raise InputError that says where and what."""
    if value is None:
        raise InputError(f'{where}: expected a number, it is empty')
    # YAML 1.1 reads 1e-3 (no dot) as text; it is a number to everybody else.
    if isinstance(value, str):
        try:
            value = float(value)
        except ValueError:
            raise InputError(f'{where}: expected a number, got {shown(value)}') from None
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f'{where}: expected a number, got {shown(value)}')
    try:
        value = float(value)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise InputError(f'{where}: expected a finite number, got {value}')
    low = value <= minimum if exclusive else value < minimum
    if low or value > maximum:
        sign = '>' if exclusive else '>='
        limits = [f'{sign} {minimum:g}'] if minimum > -math.inf else []
        limits += [f'<= {maximum:g}'] if maximum < math.inf else []
        raise InputError(f'{where}: {value:g} is out of range, expected {" and ".join(limits)}')
    return value


def numbers(where: str, value: object, count: int, minimum: float = -math.inf,
            maximum: float = math.inf) -> tuple[float, ...]:
    """Return a tuple of `count` floats, each checked as `number` does."""
    return tuple(number(f'{where}[{i}]', entry, minimum, maximum)
                 for i, entry in enumerate(_list_of(where, value, count)))


def uncertain(where: str, value: object, minimum: float = -math.inf, exclusive: bool = False
              ) -> tuple[float, float | None]:
    """
    Return a number, checked as `number` does, and its standard deviation.

    Args: value: a number, whose deviation is None, or {value: 0.5, std: 0.005}.
    """
    if not isinstance(value, dict):
        return number(where, value, minimum, exclusive=exclusive), None
    check_keys(where, value, ('value', 'std'), ('value', 'std'))
    return (number(f'{where}: value', value['value'], minimum, exclusive=exclusive),
            number(f'{where}: std', value['std'], 0.0, exclusive=True))


def uncertain_numbers(where: str, value: object, count: int, minimum: float = -math.inf,
                      exclusive: bool = False
                      ) -> tuple[tuple[float, ...], tuple[float | None, ...]]:
    """Return `count` numbers and their standard deviations, each as `uncertain` does."""
    pairs = [uncertain(f'{where}[{i}]', entry, minimum, exclusive)
             for i, entry in enumerate(_list_of(where, value, count))]
    return tuple(value for value, _ in pairs), tuple(std for _, std in pairs)


def _list_of(where: str, value: object, count: int) -> Sequence[object]:
    """Return a list of `count` entries, or raise InputError."""
    if not isinstance(value, list | tuple) or len(value) != count:
        raise InputError(f'{where}: expected a list of {count} numbers, got {shown(value)}')
    return value


def choice(where: str, value: object, options: Collection[Option]) -> Option:
    """Return the option that `value` is, or raise InputError that lists them."""
    # True == 1, but who writes `spin: yes` means something else.
    if isinstance(value, bool) or value not in options:
        raise InputError(f'{where}: {shown(value)} is not one of {", ".join(map(str, options))}')
    return next(option for option in options if option == value)


def name(where: str, value: object) -> str:
    """Return a name, of text or a number, that can be part of a file name, or raise InputError."""
    short = not isinstance(value, int) or abs(value) < 10 ** 99
    text = str(value) if short and isinstance(value, str | int | float) else ''
    if not text.strip() or not text.isprintable() or '/' in text or len(text) > NAME_LENGTH:
        raise InputError(f'{where}: expected a name, one line of text without /, got '
                         f'{shown(value)}')
    return text


def lengthened(text: str, ending: str) -> str:
    """Return a name with an ending, cut before it where both are longer than a name may be."""
    return text[:NAME_LENGTH - len(ending)] + ending


def integer(where: str, value: object, minimum: int) -> int:
    """Return a whole number of at least `minimum`, or raise InputError."""
    if isinstance(value, bool) or not isinstance(value, int) or value < minimum:
        raise InputError(f'{where}: expected a whole number of at least {minimum}, got '
                         f'{shown(value)}')
    return value
