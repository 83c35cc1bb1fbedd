# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""A class in a user's Python file: made, called, and its errors reported."""

from collections.abc import Callable
from contextlib import redirect_stdout
import importlib.util
import inspect
from pathlib import Path
import sys
import traceback
from types import ModuleType
from typing import Any

import numpy as np

from quad_ident_ros.errors import InputError

LONGEST = 160       # characters of an error that is not ours


class UserClass:
    """
    An instance, `made`, of the class that FILE.py:NAME names.

    Raises InputError for all that is wrong with the file, in one line that says where; option:
    the one that was used.
    """

    def __init__(self, spec: str, option: str) -> None:
        path, _, self.name = spec.rpartition(':')
        if not path.endswith('.py') or not self.name.isidentifier():
            raise InputError(f'{option} {spec}: expected FILE.py:NAME, a class in a Python file')
        try:
            self.path = Path(path).expanduser().resolve()
            there = self.path.is_file()
        except (OSError, RuntimeError):     # no such user, or what is no name of a file
            there = False
        if not there:
            raise InputError(f'{path}: there is no such file; give that of {option}')
        self._kind = self.call('reading it', getattr, self._module(), self.name, None)
        if not isinstance(self._kind, type):
            raise InputError(f'{path}: it has no class {self.name}; give FILE.py:NAME')
        self.made = self.call('making it', self._kind)

    def method(self, name: str, needs: str) -> Callable:
        """Return a method; InputError where there is none, needs: what the class needs."""
        found = self.optional(name)
        if found is None:
            raise InputError(f'{self.path}, line {line_of(self._kind)}: {self.name} has no method '
                             f'{name}; it needs {needs}')
        return found

    def optional(self, name: str) -> Callable | None:
        """Return a method, or None where there is none."""
        found = self.call(name, getattr, self.made, name, None)     # a property may raise
        return found if callable(found) else None

    def call(self, what: str, function: Callable, *args: Any) -> Any:
        """
        Return what a function of the user's file returns; InputError for what it raises.

        What it prints goes to the standard error: the output may be data (--json -).
        """
        try:
            with redirect_stdout(sys.stderr):
                return function(*args)
        except (Exception, SystemExit) as error:
            lines = [entry.lineno for entry in traceback.extract_tb(error.__traceback__)
                     if Path(entry.filename) == self.path]
            if isinstance(error, SyntaxError) and error.filename == str(self.path):
                lines = [error.lineno]
            where = f'{self.path}, line {lines[-1]}' if lines else str(self.path)
            text = ' '.join(_in_words(error).split())[:LONGEST]
            raise InputError(f'{where}: {what} of {self.name} raises {type(error).__name__}'
                             + (f': {text}' if text else '')) from None

    def returns(self, what: str, function: Callable) -> str:
        """Return the beginning of messages about what a method returns."""
        return f'{self.path}, line {line_of(function)}: {what} of {self.name} returns'

    def array(self, what: str, function: Callable, made: Any, expected: str) -> np.ndarray:
        """Return what a method returned as an array of floats; InputError says the expected."""
        kind = type(made).__name__
        try:
            found = np.asarray(made)
            if not np.iscomplexobj(found):
                return found.astype(float, copy=False)
            kind = 'complex numbers'
        except OverflowError:
            kind = 'numbers beyond what a float holds'
        except Exception:       # an object of the user's may raise anything
            pass
        raise InputError(f'{self.returns(what, function)} {kind}; expected {expected}')

    def _module(self) -> ModuleType:
        """Return what the file defines, run as Python runs a file: beside its neighbours."""
        made = importlib.util.spec_from_file_location(f'user_file_{self.path.stem}', self.path)
        assert made is not None and made.loader is not None
        module = importlib.util.module_from_spec(made)
        sys.modules[module.__name__] = module
        if str(self.path.parent) not in sys.path:
            sys.path.insert(0, str(self.path.parent))
        self.call('reading it', made.loader.exec_module, module)
        return module


def _in_words(error: BaseException) -> str:
    """Return what an error says, or nothing where even that raises."""
    try:
        return str(error)
    except Exception:
        return ''


def line_of(thing: Any) -> int:
    """Return the line at which a class or function is defined, or 1 where none is known."""
    try:
        return inspect.getsourcelines(thing)[1]
    except (OSError, TypeError):
        return 1
