# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Dictionaries of numbers in a Python file, read without running it."""

import ast
from collections.abc import Callable, Mapping
from dataclasses import dataclass
import math
import operator
from typing import Any

import numpy as np

from quad_ident_ros.errors import InputError

_BINARY: dict[type[ast.operator], Callable[..., Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul,
    ast.Div: operator.truediv, ast.Pow: operator.pow}
_SIGNS: dict[type[ast.unaryop], Callable[..., Any]] = {
    ast.UAdd: operator.pos, ast.USub: operator.neg}
_CONSTANTS = {'pi': math.pi, 'e': math.e}
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    'array': lambda *values: np.array(values[0], float), 'sqrt': np.sqrt,
    'sin': np.sin, 'cos': np.cos, 'tan': np.tan, 'deg2rad': np.deg2rad,
    'radians': np.deg2rad, 'float': float, 'dict': dict, 'zeros': np.zeros}
_LIBRARIES = ('np', 'numpy', 'math')
_MOST = 1e12        # of a power: what takes longer is no parameter


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
    Raises InputError with the line for a value of such a dictionary that is none of these.
    """
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        line = f', line {error.lineno}' if isinstance(error, SyntaxError) else ''
        raise InputError(f'{path}{line}: is no Python that can be parsed') from None
    names: dict[str, Any] = {}
    found = []
    for statement in tree.body:
        if not isinstance(statement, ast.Assign | ast.AnnAssign) or statement.value is None:
            continue
        targets = (statement.targets if isinstance(statement, ast.Assign) else
                   [statement.target])
        name = targets[0].id if isinstance(targets[0], ast.Name) else ''
        try:
            with np.errstate(all='ignore'):
                value = _value(statement.value, names)
        except (_Unreadable, ArithmeticError, TypeError, ValueError, LookupError,
                RecursionError) as error:
            if _keys_of(statement.value) >= set(keys):
                line, said = (error.args if isinstance(error, _Unreadable) else
                              (statement.lineno, 'a value'))
                raise InputError(f'{path}, line {line}: {said} is no number that can be read '
                                 'without running the file; write it as one') from None
            continue
        names[name] = value
        if isinstance(value, dict) and value.keys() >= set(keys):
            found.append(Table(name, value, _lines_of(statement.value, statement.lineno, value),
                               statement.value))
    return found


def _keys_of(node: ast.expr) -> set[str]:
    if isinstance(node, ast.Dict):
        return {key.value for key in node.keys
                if isinstance(key, ast.Constant) and isinstance(key.value, str)}
    if isinstance(node, ast.Call):
        return {keyword.arg for keyword in node.keywords if keyword.arg}
    return set()


def _lines_of(node: ast.expr, usual: int, value: Mapping[str, Any]) -> dict[str, int]:
    lines = dict.fromkeys(value, usual)
    if isinstance(node, ast.Dict):
        lines.update({key.value: key.lineno for key in node.keys
                      if isinstance(key, ast.Constant) and isinstance(key.value, str)})
    return lines


def _value(node: ast.expr, names: Mapping[str, Any]) -> Any:
    """Return what an expression stands for; raises _Unreadable."""
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float | str):
        return node.value
    if isinstance(node, ast.Name) and node.id in names:
        return names[node.id]
    if isinstance(node, ast.List | ast.Tuple):
        return [_value(each, names) for each in node.elts]
    if isinstance(node, ast.Dict) and all(key is not None for key in node.keys):
        return {_value(key, names): _value(value, names)    # type: ignore[arg-type]
                for key, value in zip(node.keys, node.values, strict=True)}
    if isinstance(node, ast.UnaryOp) and type(node.op) in _SIGNS:
        return _SIGNS[type(node.op)](_number(node.operand, names))
    if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        one, other = _number(node.left, names), _number(node.right, names)
        if isinstance(node.op, ast.Pow) and np.max(np.abs(other)) * math.log10(
                max(float(np.max(np.abs(one))), 10.0)) > math.log10(_MOST):
            raise _Unreadable(node)
        return _BINARY[type(node.op)](one, other)
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
    if name not in _FUNCTIONS or (name == 'zeros' and _value(node.args[0], names) not in (3, 4)):
        raise _Unreadable(node)
    if name == 'dict':
        return {keyword.arg: _value(keyword.value, names) for keyword in node.keywords}
    return _FUNCTIONS[name](*(_value(each, names) for each in node.args))


def _number(node: ast.expr, names: Mapping[str, Any]) -> Any:
    """Return a number or an array of them; lists and text are repeated, not multiplied."""
    value = _value(node, names)
    if isinstance(value, bool) or not isinstance(value, int | float | np.ndarray):
        raise _Unreadable(node)
    return value


def _library(node: ast.expr) -> bool:
    return isinstance(node, ast.Name) and node.id in _LIBRARIES
