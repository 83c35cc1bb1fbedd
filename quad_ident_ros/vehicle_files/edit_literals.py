# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers that change in place, in a dictionary of a Python file."""

from __future__ import annotations

import ast
from collections.abc import Sequence
import re

from quad_ident_ros.errors import InputError
from quad_ident_ros.vehicle_files.edits import Edits, shown
from quad_ident_ros.vehicle_files.literals import Table
from quad_ident_ros.vehicle_files.source import Source


class EditedTable(Edits):
    """The text of a Python file, with the numbers of one of its dictionaries."""

    def __init__(self, source: Source, table: Table) -> None:
        """Find where the values stand; InputError where the dictionary is not written out."""
        super().__init__(source.text)
        self.table = table
        self._begins = [0, *(match.end() for match in re.finditer(rb'\r\n|\r|\n', self.data))]
        node = table.node
        if isinstance(node, ast.Dict) and None not in node.keys:
            self._values = {key.value: value for key, value in
                            zip(node.keys, node.values, strict=True)
                            if isinstance(key, ast.Constant)}
            self._entry, self._first = '{key!r}: {value}', self._span(
                next(key for key in node.keys if key is not None))[0]
        elif isinstance(node, ast.Call) and not node.args and all(
                keyword.arg for keyword in node.keywords):
            self._values = {keyword.arg: keyword.value for keyword in node.keywords
                            if keyword.arg}
            self._entry, self._first = '{key}={value}', self._span(node.keywords[0])[0]
        else:
            raise InputError(f'{source.path}, line {node.lineno}: {table.name} is not written '
                             f'out; write {table.name} = {{...}} with its numbers')

    def entry(self, key: str, new: float, unit: str, source: str, size: float = 0.0) -> None:
        """Have a key hold another number; one that is missing stands for 0."""
        if key in self._values:
            self.number(self._span(self._values[key]), f'line {self.table.lines[key]}: {key}',
                        float(self.table.values[key]), new, unit, source, size)
        elif any(self.enter(key, [0.0], [new], unit, source, size)):
            before = self.data[:self._first]
            indent = before[before.rfind(b'\n') + 1:]
            gap = '\n' + indent.decode() if not indent.strip() else ' '
            self.replace(self._first, self._first,
                         self._entry.format(key=key, value=shown([new])) + ',' + gap)

    def vectors(self, key: str, new: Sequence[Sequence[float]], unit: str, source: str) -> bool:
        """Have the vectors of a key hold other numbers; return whether they are written out."""
        node = self._values.get(key)
        inside = (node.values if isinstance(node, ast.Dict) else
                  node.elts if isinstance(node, ast.List | ast.Tuple) else [])
        if len(inside) != len(new):
            return False
        old = self.table.values[key]
        old = list(old.values()) if isinstance(old, dict) else old
        for k, (value, before, after) in enumerate(zip(inside, old, new, strict=True)):
            place = f'line {value.lineno}: {key}[{k}]'
            moved = self.enter(place, list(map(float, before)), after, unit, source, 1.0)
            array = next((each for each in ast.walk(value) if isinstance(each, ast.Call)
                          and ast.unparse(each.func).endswith('array')), None)
            plain = array.args[0] if array is not None and array is value else value
            if isinstance(plain, ast.List | ast.Tuple):
                for number, new_one, changed in zip(plain.elts, after, moved, strict=True):
                    if changed:
                        self.replace(*self._span(number), shown([new_one]))
            elif any(moved):    # a product, as of an arm and a direction
                text = '[' + ', '.join(shown([each]) for each in after) + ']'
                name = ast.unparse(array.func) if array else ''
                self.replace(*self._span(value), f'{name}({text})' if name else text)
        return True

    def _span(self, node: ast.expr | ast.keyword) -> tuple[int, int]:
        """Return from where to where an expression stands, in bytes."""
        assert node.end_lineno is not None and node.end_col_offset is not None
        return (self._begins[node.lineno - 1] + node.col_offset,
                self._begins[node.end_lineno - 1] + node.end_col_offset)
