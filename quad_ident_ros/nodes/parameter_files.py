# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""For which nodes a parameter file is, and parameters as words of a command line."""

import json

EVERY_NODE = '/**'     # the name that -p has where no node is named


def names_in(data):
    """Return the names of nodes, which may have wild cards, in the data of a parameter file."""
    return [key for key, _ in _entries(data, '')]


def is_for(keys, name, full_name):
    """Return whether one of the keys of a parameter file is a node's, by its name."""
    return any(_matches(key, name, full_name) for key in keys)


def given_to(data, name, full_name):
    """Return the parameters {name: value} that the data of a file give a node, later ones last."""
    given = {}
    for key, parameters in _entries(data, ''):
        if _matches(key, name, full_name) and isinstance(parameters, dict):
            given |= parameters
    return given


def overriding(data, name, full_name, given):
    """
    Return the name in a parameter file whose values override given ones of -p, or ''.

    ROS 2 applies values by the name that they are for, in the order in which these names first
    occur, and the last one counts. The name of -p is /**.
    """
    behind = False
    for key, parameters in _entries(data, ''):
        if key == EVERY_NODE:
            behind = True
        elif behind and _matches(key, name, full_name) and isinstance(parameters, dict) \
                and not given.keys().isdisjoint(parameters):
            return key
    return ''


def words_for(parameters):
    """Return the ROS arguments that give a node parameters, {name: value}, at its start."""
    # As JSON, a text is a text to YAML too, whatever is in it.
    return [word for name, value in parameters.items()
            for word in ('-p', f'{name}:={json.dumps(value, ensure_ascii=False)}')]


def _entries(data, prefix):
    """Yield the name of each node, and what is below its ros__parameters."""
    for key, value in data.items():
        name = f'{prefix}/{str(key).strip("/")}'
        if isinstance(value, dict) and 'ros__parameters' in value:
            yield name, value['ros__parameters']
        elif isinstance(value, dict):
            yield from _entries(value, name)


def _matches(key, name, full_name):
    if key.endswith('/**'):
        return full_name.startswith(key[:-2])
    if '*' in key:
        return key.rsplit('/', 1)[-1] in (name, '*')
    return key == full_name
