# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""
Excitations of U1..U4, one file each.

An excitation is a function of the sample times t (N,) s and of keyword parameters that returns
the deviation from trim (N,), in the unit of its input. To add one, write its file and its line
in EXCITATIONS.
"""

import inspect

import numpy as np

from quad_ident_ros import schema
from quad_ident_ros.errors import InputError
from quad_ident_ros.excitation.chirp import chirp
from quad_ident_ros.excitation.doublet import doublet
from quad_ident_ros.excitation.multisine import multisine
from quad_ident_ros.excitation.prbs import prbs
from quad_ident_ros.excitation.recorded import recorded
from quad_ident_ros.excitation.step import step

EXCITATIONS = {'step': step, 'doublet': doublet, 'prbs': prbs, 'multisine': multisine,
               'chirp': chirp, 'recorded': recorded}


def excite(where, spec, t):
    """
    Return the excitation that a mapping {type: ..., parameter: value, ...} describes, (N,).

    Raises InputError that begins with `where` for an unknown type, an unknown or missing
    parameter or a bad value.
    """
    if not isinstance(spec, dict) or 'type' not in spec:
        raise InputError(f'{where}: expected {{type: NAME, ...}} with NAME one of '
                         f'{", ".join(EXCITATIONS)}')
    function = EXCITATIONS[schema.choice(f'{where}: type', spec['type'], tuple(EXCITATIONS))]
    given = {key: value for key, value in spec.items() if key != 'type'}
    parameters = list(inspect.signature(function).parameters.values())[1:]
    schema.check_keys(f'{where}: {spec["type"]}', given, [p.name for p in parameters],
                      [p.name for p in parameters if p.default is p.empty])
    try:
        signal = np.asarray(function(t, **given), float)
    except InputError as error:
        raise InputError(f'{where}: {spec["type"]}: {error}') from None
    return signal
