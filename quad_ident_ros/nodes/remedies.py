# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What messages on a flight recommend, for a node: it has parameters, and no options."""

import re

_TIME = r'-?\d+(?:\.\d+)?'
_WINDOW = 'set the parameter window to the seconds at the end of a record that are to be taken'
_ANEW = 'fly again, or begin another record with ~/flush of the recorder'
_WAYS = tuple((re.compile(options), instead) for options, instead in (
    (f'what is after it, --to {_TIME}, or before it, --from {_TIME}',
     f'what is before it: {_WINDOW}'),
    (f'(?:--from {_TIME} )?--to {_TIME}', _ANEW),
    (f'--from {_TIME}', _WINDOW),
    ('(?:--segment, )?--from and --to choose another part', 'the parameter window takes a part'),
    ('--hold-out FLIGHT holds out another flight', 'of several flights the last one is held out'),
    # Some messages name the parameter beside the option.
    ('--vehicle(?!, or)', 'the parameter vehicle'),
    ('--mapping', 'the parameter mapping of the recorder'),
))


def for_a_node(text):
    """Return a message, or several as JSON, with parameters in the place of options."""
    for options, instead in _WAYS:
        text = options.sub(instead, text)
    return text
