# Copyright 2026 quad_ident_ros contributors
# SPDX-License-Identifier: Apache-2.0
"""What messages on flights recommend, in the words of a node."""

import numpy as np
import pytest

from quad_ident_ros.data.cutting import without
from quad_ident_ros.nodes.remedies import for_a_node

T = np.arange(0.0, 20.0, 0.01)


@pytest.mark.parametrize('bad, said', [
    (T < 2.0, 'leave them out: set the parameter window to the seconds at the end of a record '
     'that are to be taken, or log it'),
    (T > 18.0, 'leave them out: fly again, or begin another record with ~/flush of the recorder, '
     'or log it'),
    (np.abs(T - 10.0) > 8.0, 'leave them out: fly again, or begin another record with ~/flush of '
     'the recorder, or log it')])
def test_samples_are_left_out_by_what_a_node_has(bad, said):
    assert for_a_node(without(T, bad, 'log it')) == said


@pytest.mark.parametrize('text, said', [
    ('nothing to do; --segment, --from and --to choose another part',
     'nothing to do; the parameter window takes a part'),
    ('name the vehicle that flew with --vehicle', 'name the vehicle that flew with the parameter '
     'vehicle'),
    ('nothing to do; --hold-out FLIGHT holds out another flight',
     'nothing to do; of several flights the last one is held out'),
    ('(--vehicle, or the parameter vehicle)', '(--vehicle, or the parameter vehicle)'),
    ('in a mapping (--mapping)', 'in a mapping (the parameter mapping of the recorder)')])
def test_options_become_parameters(text, said):
    assert for_a_node(text) == said
