# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Dictionaries of numbers in a Python file, read without running it."""

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass
import math
import operator
from typing import Any
import warnings

import numpy as np

from quad_ident_ros.errors import InputError

_BINARY: dict[type[ast.operator], Callable[..., Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul,
    ast.Div: operator.truediv, ast.Pow: operator.pow}
_SIGNS: dict[type[ast.unaryop], Callable[..., Any]] = {
    ast.UAdd: operator.pos, ast.USub: operator.neg}
_CONSTANTS = {'pi': math.pi, 'e': math.e}
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    'array': lambda *values: _array(values[0]), 'sqrt': np.sqrt,
    'sin': np.sin, 'cos': np.cos, 'tan': np.tan, 'deg2rad': np.deg2rad,
    'radians': np.deg2rad, 'float': float, 'dict': dict, 'zeros': np.zeros}
_LIBRARIES = ('np', 'numpy', 'math', 'copy')
_CHANGING = ('update', 'setdefault', 'pop', 'popitem', 'clear')    # methods of a dictionary
_MOST = 1e12        # of a power or a whole number: what takes longer is no parameter
_ENTRIES = 10_000   # of an array: a vehicle has some ten rotors with three places each


@dataclass(frozen=True)
class Table:
    """A dictionary of a Python file: its name, values, the line of each key, its expression."""

    name: str
    values: Mapping[str, Any]
    lines: Mapping[str, int]
    node: ast.expr


class _Unreadable(Exception):
    """An expression that is no number, with its line."""

    def __init__(self, node: ast.AST) -> None:
        super().__init__(getattr(node, 'lineno', 0), ast.unparse(node)[:60])


def tables_of(path: str, text: str, keys: tuple[str, ...]) -> list[Table]:
    """
    Return the dictionaries that a Python file gives names to and that have all of some keys.

    Only numbers, lists, arithmetic and a few functions of NumPy are taken; nothing is run.
    Raises InputError with the line for a value of such a dictionary that is neither.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')     # of the style of a file that is not ours
            tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        line = f', line {error.lineno}' if isinstance(error, SyntaxError) else ''
        raise InputError(f'{path}{line}: is not Python that can be parsed') from None
    names: dict[str, Any] = {}
    found: dict[str, Table] = {}
    for statement in tree.body:
        name = _name_given_by(statement)
        value = _value_given_by(statement, names, path, keys) if name else None
        for other in _changed_by(statement):
            names.pop(other, None)
            if found.pop(other, None) and other != name:
                raise InputError(f'{path}, line {statement.lineno}: {other} is changed here, '
                                 'which is not followed; write its numbers where it begins')
        if value is not None:
            names[name] = value
        if isinstance(value, dict) and value.keys() >= set(keys):
            given: Any = statement
            found[name] = Table(name, value, _lines_of(given.value, given.lineno, value),
                                given.value)
    return list(found.values())


def _value_given_by(statement: Any, names: Mapping[str, Any], path: str, keys: tuple[str, ...]
                    ) -> Any:
    """Return the value of a statement that gives it a name, None where that is no number."""
    try:
        with np.errstate(all='ignore'):
            return _value(statement.value, names)
    except (_Unreadable, ArithmeticError, TypeError, ValueError, LookupError,
            RecursionError) as error:
        if _keys_of(statement.value, names) >= set(keys):
            line, said = (error.args if isinstance(error, _Unreadable) else
                          (statement.lineno, 'a value'))
            raise InputError(f'{path}, line {line}: {said} is not a number that can be read '
                             'without running the file; write it as one') from None
        return None


def _name_given_by(statement: ast.stmt) -> str:
    """Return the one name that a statement gives to a value, or ''."""
    targets: list[ast.expr] = []
    if isinstance(statement, ast.AnnAssign) and statement.value is not None:
        targets = [statement.target]
    elif isinstance(statement, ast.Assign):
        targets = statement.targets
    return targets[0].id if len(targets) == 1 and isinstance(targets[0], ast.Name) else ''


def _changed_by(statement: ast.stmt) -> set[str]:
    """Return the names whose values a statement replaces or changes."""
    if isinstance(statement, ast.FunctionDef | ast.ClassDef):
        return {statement.name}     # what it does to others when it is called is its user's
    found = set()
    for node in ast.walk(statement):
        holder = node
        while isinstance(holder, ast.Subscript | ast.Attribute):
            holder = holder.value
        if isinstance(holder, ast.Name) and (
                not isinstance(getattr(node, 'ctx', ast.Load()), ast.Load)
                or isinstance(node, ast.Attribute) and node.attr in _CHANGING):
            found.add(holder.id)
    return found


def _keys_of(node: ast.expr, names: Mapping[str, Any]) -> set[str]:
    """Return the keys of a dictionary, with those of others that it is made of."""
    if isinstance(node, ast.Name):
        value = names.get(node.id)
        return {key for key in value if isinstance(key, str)} if isinstance(value, dict) else set()
    parts: list[ast.expr] = []
    found: set[str] = set()
    if isinstance(node, ast.Dict):
        found = {key.value for key in node.keys
                 if isinstance(key, ast.Constant) and isinstance(key.value, str)}
        parts = [value for key, value in zip(node.keys, node.values, strict=True) if key is None]
    elif isinstance(node, ast.Call):
        found = {keyword.arg for keyword in node.keywords if keyword.arg}
        parts = [*node.args, *(keyword.value for keyword in node.keywords if not keyword.arg),
                 *([node.func.value] if isinstance(node.func, ast.Attribute) else [])]
    elif isinstance(node, ast.BinOp):
        parts = [node.left, node.right]
    return found.union(*(_keys_of(part, names) for part in parts))


def _lines_of(node: ast.expr, usual: int, value: Mapping[str, Any]) -> dict[str, int]:
    lines = dict.fromkeys(value, usual)
    if isinstance(node, ast.Dict):
        lines.update({key.value: key.lineno for key in node.keys
                      if isinstance(key, ast.Constant) and isinstance(key.value, str)})
    return lines


def _value(node: ast.expr, names: Mapping[str, Any]) -> Any:
    """Return what an expression stands for; raises _Unreadable."""
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float | str | None):
        return node.value
    if isinstance(node, ast.Name) and node.id in names:
        return names[node.id]
    if isinstance(node, ast.List | ast.Tuple):
        return [_value(each, names) for each in node.elts]
    if isinstance(node, ast.Dict):
        made: dict[Any, Any] = {}
        for key, value in zip(node.keys, node.values, strict=True):
            made.update(_table(value, names) if key is None else
                        {_value(key, names): _value(value, names)})
        return made
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitOr):
        return _table(node.left, names) | _table(node.right, names)
    if isinstance(node, ast.UnaryOp) and type(node.op) in _SIGNS:
        return _SIGNS[type(node.op)](_number(node.operand, names))
    if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        one, other = _number(node.left, names), _number(node.right, names)
        if isinstance(node.op, ast.Pow) and np.max(np.abs(other)) * math.log10(
                max(float(np.max(np.abs(one))), 10.0)) > math.log10(_MOST):
            raise _Unreadable(node)
        result = _BINARY[type(node.op)](one, other)
        if isinstance(result, int) and abs(result) > _MOST:
            raise _Unreadable(node)
        return result
    if isinstance(node, ast.Attribute) and _library(node.value) and node.attr in _CONSTANTS:
        return _CONSTANTS[node.attr]
    if isinstance(node, ast.Subscript):
        holder = _value(node.value, names)
        return holder[_value(node.slice, names)]
    if isinstance(node, ast.Call):
        return _called(node, names)
    raise _Unreadable(node)


def _called(node: ast.Call, names: Mapping[str, Any]) -> Any:
    function = node.func
    name = (function.attr if isinstance(function, ast.Attribute) and _library(function.value) else
            function.id if isinstance(function, ast.Name) else '')
    if isinstance(function, ast.Attribute) and not _library(function.value) and (
            function.attr == 'copy' and not node.args and not node.keywords):
        return dict(_table(function.value, names))
    if name == 'deepcopy' and len(node.args) == 1:
        return dict(_table(node.args[0], names))
    if name not in _FUNCTIONS or (name == 'zeros' and _value(node.args[0], names) not in (3, 4)):
        raise _Unreadable(node)
    if name == 'dict':
        if len(node.args) > 1:
            raise _Unreadable(node)
        parts = [_table(each, names) for each in node.args]
        parts += [{keyword.arg: _value(keyword.value, names)} if keyword.arg else
                  _table(keyword.value, names) for keyword in node.keywords]
        return {key: value for part in parts for key, value in part.items()}
    return _FUNCTIONS[name](*(_value(each, names) for each in node.args))


def _table(node: ast.expr, names: Mapping[str, Any]) -> dict[Any, Any]:
    """Return the dictionary that an expression stands for; raises _Unreadable."""
    value = _value(node, names)
    if not isinstance(value, dict):
        raise _Unreadable(node)
    return value


def _array(values: Any) -> np.ndarray:
    """Return numbers in lists as an array; ValueError where lists in lists make too many."""
    waiting, count = [values], 0
    while waiting:
        one = waiting.pop()
        count += one.size if isinstance(one, np.ndarray) else 1
        if count > _ENTRIES or isinstance(one, list) and len(one) > _ENTRIES:
            raise ValueError
        waiting += one if isinstance(one, list) else []
    return np.array(values, float)


def _number(node: ast.expr, names: Mapping[str, Any]) -> Any:
    """Return a number or an array of them; lists and text are repeated, not multiplied."""
    value = _value(node, names)
    if isinstance(value, bool) or not isinstance(value, int | float | np.ndarray):
        raise _Unreadable(node)
    return value


def _library(node: ast.expr) -> bool:
    return isinstance(node, ast.Name) and node.id in _LIBRARIES
