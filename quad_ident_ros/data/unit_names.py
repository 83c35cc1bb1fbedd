# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""Units as tables of others spell them."""

import re

from quad_ident_ros.data.mapping import UNITS

_OTHER = {'dps': 'deg/s', 'volt': 'V', 'volts': 'V', 'v': 'V',
          'mv': 'mV', "g's": 'g',
          'u/min': 'rpm', 'tr/min': 'rpm', '1/min': 'rpm', 'min^-1': 'rpm', 'rev/min': 'rpm',
          'r/min': 'rpm', 'grad': 'deg', 'grad/s': 'deg/s', 'sekunden': 's', 'stunden': 'h',
          'minute': 'min', 'minutes': 'min', 'hour': 'h', 'hours': 'h', 'hr': 'h', 'hrs': 'h',
          'inch': 'in', 'inches': 'in', 'feet': 'ft', 'feet/s': 'ft/s', 'fps': 'ft/s',
          'kmh': 'km/h', 'kph': 'km/h', 'mi/h': 'mph', 'kt': 'kn', 'knots': 'kn',
          'hz': 'Hz', 'rps': 'Hz', 'rev/s': 'Hz', 'u/s': 'Hz', 'tr/s': 'Hz'}
_SPELT = ((r'^(m?rad|deg)(?:_|_?p)(?:s|sec)$', r'\1/s'),
          (r'^([mc]?m)[_p]s$', r'\1/s'), (r'^([mc]?m)[_p]?s_?2$', r'\1/s^2'),
          (r'[µμ]|\bmicro', 'u'), (r'\bmilli', 'm'), (r'\bcenti', 'c'), (r'\bnano', 'n'),
          (r'met(?:er|re)s?\b', 'm'), (r'sec(?:ond)?s?\b', 's'), (r'°|\bdegrees?\b', 'deg'),
          (r'\bradians?\b|\brads\b', 'rad'), (r'²|\*\*2', '^2'), (r'/s2$|/s/s$', '/s^2'),
          (r'[ .*·]s\^?-1$', '/s'), (r'[ .*·]s\^?-2$', '/s^2'))
"""Words and signs in units, and what stands for them, one after the other."""

_KNOWN = {one for units in UNITS.values() for one in units} | {'pwm', '%', '1', '-', 'n'}


def unit_by(said: str) -> str:
    """Return the unit that small letters say, as data.mapping writes it where it is known."""
    for pattern, short in _SPELT:
        said = re.sub(pattern, short, said)
    return _OTHER.get(said, said)


def is_unit(said: str) -> bool:
    """Return whether small letters are a unit of the quantities of a flight."""
    return unit_by(said) in _KNOWN
