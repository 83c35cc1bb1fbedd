# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""The info of a record or a run from files and topics of anybody: what its entries may hold."""

from collections.abc import Callable, Mapping
from typing import Any

LARGEST = 1e50      # of a number: what is computed of larger ones is soon no number any more

Check = Callable[[object], bool]


def _number(value: object) -> bool:
    return (isinstance(value, int | float) and not isinstance(value, bool)
            and abs(value) <= LARGEST)


def _whole(value: object) -> bool:
    return isinstance(value, int)


def _text(value: object) -> bool:
    return isinstance(value, str)


def _anything(value: object) -> bool:
    return True


def _row(*checks: Check) -> Check:
    """Return a check for a list of that many entries, each with its own check."""
    return lambda value: (isinstance(value, list) and len(value) == len(checks)
                          and all(check(one) for check, one in zip(checks, value, strict=True)))


def _list(check: Check) -> Check:
    return lambda value: isinstance(value, list) and all(map(check, value))


def _named(check: Check) -> Check:
    return lambda value: isinstance(value, dict) and all(map(check, value.values()))


def _motors(value: object) -> bool:
    """Whether a value is what data.motor_order.about_motors makes."""
    return (isinstance(value, dict) and _list(_row(*[_number] * 4))(value.get('rotors', []))
            and all(_text(value.get(name, '')) for name in ('source', 'kind'))
            and ('source' in value or not value.get('rotors'))
            and _named(_number)(value.get('curve', {})))


CHECKS: dict[str, Check] = {
    'run_index': _whole, 'run_count': _whole, 'start_ns': _whole, 'dropped': _whole,
    'notes': _list(_anything), 'outputs': _list(_text),
    'trim': _row(*[_number] * 4), 'initial': _named(_number),
    'began': _number, 'full_speed': _number, 'linear_in': _list(_row(_text, _number, _number)),
    'modes': _list(_row(_number, _text)), 'spoilt': _list(_row(_number, _text)),
    'cuts': _list(_number), 'whole': _row(_anything, _anything), 'resets': _text,
    'commands': _list(_text), 'logging': _list(_text), 'summed': _list(_text),
    'differentiated': _list(_text), 'differences': _list(_text),
    'motors': _motors, 'hardware': _named(_text)}
"""By name of an entry, whether a value is one that those who read it can use."""


def unusable_entry(info: Mapping[str, Any]) -> str:
    """Return the name of the first entry of an info that holds something else, or ''."""
    return next((name for name, check in CHECKS.items()
                 if name in info and not check(info[name])), '')
